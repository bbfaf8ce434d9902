"""What a study does just now: the state of each bed and run, and the time left of all of them.

    python -m bulkwear status [STUDY]

Read from results/<study> alone: its forecast, written when it starts, and what its jobs leave (job_states.py).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES
from bulkwear.workflows.config.design import list_studies
from bulkwear.workflows.config.validation import unknown_name
from bulkwear.workflows.engine.job import duration_text
from bulkwear.workflows.forecast.forecast import aligned, number_text, wall_hours
from bulkwear.workflows.forecast.job_states import (
    BED,
    DONE,
    FAILED,
    RUN,
    RUNNING,
    JobState,
    job_state,
    locked_files,
)

RESULTS, FORECAST, PAGE = "results", "forecast.csv", "report.html"
COLUMNS = ("job", "cores", "wall_h")  # of a forecast, that are looked at
HEADS = ("job", "state", "cycle", "worn volume", "time left")
SECONDS_PER_HOUR = 3600.0
MOST_IDLE = 3  # looks, between which one job may end and the next begin
LEAST_PACE = 1e-9  # h, of forecasts together: less is no work by which a pace could be told


class StatusError(ValueError):
    """There is nothing to tell of a study; the message says why, and what to do."""


@dataclass(frozen=True)
class Status:
    """A study as it stands.

    forecast: row per job, see `forecast.forecast_table`; jobs: their states in its order; left_h: (jobs,) of each alone
    cores: that it runs on; whole_h: of all jobs together
    """

    study: str
    folder: Path
    forecast: pd.DataFrame
    jobs: tuple[JobState, ...]
    left_h: tuple[float, ...]
    cores: int
    whole_h: float

    def count(self, *states: str) -> int:
        """Return how many jobs are in one of these states."""
        return sum(job.state in states for job in self.jobs)

    @property
    def is_over(self) -> bool:
        """Return whether no job is left."""
        return self.count(DONE) == len(self.jobs)


def read_status(study: str, cores: int | None = None, results: Path = Path(RESULTS)) -> Status:
    """Return how a study stands. Raises StatusError.

    cores: that it runs on, by default those of the jobs that run now
    """
    folder = results / study
    if not (folder / FORECAST).is_file():
        raise StatusError(_nothing(study, folder))
    forecast, locked = _forecast(folder / FORECAST), locked_files()
    jobs = tuple(job_state(folder, job, locked) for job in forecast["job"])
    running = forecast["cores"][[job.state == RUNNING for job in jobs]].sum()
    used = cores or max(int(running), 1)
    left = hours_left(forecast, jobs)
    return Status(study, folder, forecast, jobs, left, used, whole_hours(forecast, jobs, left, used))


def _forecast(path: Path) -> pd.DataFrame:
    """Return the table of a forecast. Raises StatusError where it is damaged."""
    try:
        table = pd.read_csv(path, keep_default_na=False)
    except ValueError:  # pandas' own of what is no table, and of what is no text
        table = pd.DataFrame()
    if lacking := [name for name in COLUMNS if name not in table]:
        raise StatusError(
            f"{path}: there is no column {lacking[0]} in it, allowed is the table of a forecast; `snakemake"
            f" {path.parent.name}` writes it again once it is deleted."
        )
    return table


def _nothing(study: str, folder: Path) -> str:
    """Return why there is nothing to tell of a study."""
    known = list_studies()
    if study not in known and not folder.is_dir():
        return unknown_name("status", "study", study, known)
    begun = "it has only begun" if (folder / "logs").is_dir() else "nothing of it was started here"
    return f"{folder / FORECAST}: there is no such file, {begun}; `snakemake {study}` starts it and writes this first."


def latest_study(results: Path = Path(RESULTS)) -> str:
    """Return the study that last did something. Raises StatusError where none was started."""
    logs = [path.parent / "logs" for path in results.glob(f"*/{FORECAST}")]
    found = {log: max((path.stat().st_mtime for path in log.glob("*.log")), default=0.0) for log in logs}
    if not found:
        raise StatusError(f"{results}: no study was started here; `snakemake <study>` starts one.")
    return max(found, key=found.__getitem__).parent.name


def hours_left(forecast: pd.DataFrame, jobs: Sequence[JobState]) -> tuple[float, ...]:
    """Return the wall time (h) that each job still takes: one that runs by its own word, else by the forecast at the
    pace of those that told one.
    """
    pace = pace_of(forecast, jobs)
    return tuple(_left(*pair, pace) for pair in zip(jobs, forecast.itertuples(), strict=True))


def _left(job: JobState, row: tuple, pace: float) -> float:
    if job.state == DONE:
        return 0.0
    if job.left_s is not None:
        return job.left_s / SECONDS_PER_HOUR
    share = (job.cycles or 0) / row.cycles if row.cycles else 0.0
    return pace * row.wall_h * max(1.0 - share, 0.0)


def whole_hours(forecast: pd.DataFrame, jobs: Sequence[JobState], left: Sequence[float], cores: int) -> float:
    """Return the wall time (h) of all jobs together, those first that run and have their cores."""
    table = forecast.assign(wall_h=left)
    running = [job.state == RUNNING for job in jobs]
    rest = [job.state not in (DONE, RUNNING) for job in jobs]
    return wall_hours(pd.concat([table[running], table[rest]]), cores)


def pace_of(forecast: pd.DataFrame, jobs: Sequence[JobState]) -> float:
    """Return how many times their forecast jobs take; 1 before any has told."""
    told = [
        (job.taken_s + (job.left_s or 0.0), hours)
        for job, hours in zip(jobs, forecast["wall_h"], strict=True)
        if job.taken_s is not None and (job.state == DONE or job.left_s is not None)
    ]
    expected = sum(hours for _, hours in told)
    return sum(seconds for seconds, _ in told) / (SECONDS_PER_HOUR * expected) if expected > LEAST_PACE else 1.0


# ---------------------------------------------------------------- told


def rows_of(status: Status) -> list[tuple[str, ...]]:
    """Return a row of text per job, see HEADS."""
    return [
        (job.name, job.state, _cycle(job, int(row.cycles)), _volume(job), _time(job, left))
        for job, row, left in zip(status.jobs, status.forecast.itertuples(), status.left_h, strict=True)
    ]


def _cycle(job: JobState, expected: int) -> str:
    """Return which wear cycle a run is in, or has finished; of adaptive ones the forecast tells how many there are."""
    if not job.job.startswith(RUN):
        return "filling" if job.job.startswith(BED) and job.state == RUNNING else ""
    if job.cycles is None:
        return "run-in" if job.state == RUNNING else ""
    number = job.cycles + (job.state == RUNNING)
    return f"{number} of {number if job.state == DONE else max(expected, number)}"


def _volume(job: JobState) -> str:
    if job.worn_m3 is None:
        return ""
    volume = job.worn_m3 * CUBIC_MILLIMETRES
    return f"{number_text(volume) if volume >= 1.0 else f'{volume:.3g}'} mm³"


def _time(job: JobState, left: float) -> str:
    return "" if job.state == DONE else f"about {duration_text(SECONDS_PER_HOUR * left)}"


def faults_of(status: Status) -> list[str]:
    """Return a sentence for each job that failed, with its log."""
    logs = status.folder / "logs"
    return [f"{job.name} failed: {job.said} ({logs / job.job}.log)" for job in status.jobs if job.state == FAILED]


def last_line(status: Status) -> str:
    """Return how far the whole study is, how long it takes still, and where its page is or will be."""
    page = status.folder / PAGE
    count = f"{status.study}: {status.count(DONE)} of {len(status.jobs)} jobs of the solver done"
    if status.is_over:
        there = _is_newer(page, status.folder)
        return f"{count}; its page is {page}" if there else f"{count}; tables, figures and the page {page} follow"
    left = f"about {duration_text(SECONDS_PER_HOUR * status.whole_h)} left"
    if status.count(RUNNING):
        cores = f"{status.cores} core{'s' * (status.cores > 1)}"
        return f"{count}, {left} on {cores}, then tables, figures and the page {page}"
    return f"{count}, none runs now; `snakemake {status.study}` goes on, {left}, then the page is {page}"


def _is_newer(page: Path, folder: Path) -> bool:
    """Return whether a page is as new as the last run."""
    runs = [path.stat().st_mtime for path in folder.glob("*/wear.csv")]
    return page.is_file() and page.stat().st_mtime >= max(runs, default=0.0)


def heading(status: Status) -> str:
    """Return of what the rows are, and when."""
    return time.strftime(f"{status.study}, fidelity {status.forecast['fidelity'].iloc[0]}, %Y-%m-%d %H:%M:%S")


def status_text(status: Status) -> str:
    """Return all that as lines for a terminal."""
    table = [line.rstrip() for line in aligned([HEADS, *rows_of(status)])]
    return "\n".join([heading(status), "", *table, "", *faults_of(status), last_line(status)])


def watch(study: str, cores: int | None, show: Callable[[Status, bool], None], wait: Callable[[], None]) -> str:
    """Show a study again and again until its jobs are over, or none has run for MOST_IDLE looks; return its last line.

    show: takes the status, and whether another one follows; wait: until then. Raises StatusError.
    """
    idle = 0
    while True:
        status = read_status(study, cores)
        idle = 0 if status.count(RUNNING) else idle + 1
        goes_on = not status.is_over and idle < MOST_IDLE
        show(status, goes_on)
        if not goes_on:
            return last_line(status)
        wait()
