"""Pieces of the pages of results in docs, which commands write from finished studies."""

from __future__ import annotations

import argparse
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pandas as pd

from postproc.plots.style import save_small
from postproc.readers.cycle_folders import cycle_files
from postproc.readers.solver_log import solver_version
from workflows.config.design import Study, load_study
from workflows.report.page import commit, cost_totals, jobs_of
from workflows.report.remarks import figure_remarks
from workflows.report.text import number

SECONDS_PER_MINUTE = 60.0

LINE = 118  # characters of a line of prose


def markdown(table: pd.DataFrame, digits: int = 3) -> str:
    """Return a table in Markdown, numbers as people read them."""
    head = [str(name).replace("_", " ") for name in table]
    rows = [[number(value, digits) for value in row] for row in table.itertuples(index=False)]
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def prose(text: str) -> str:
    """Return a paragraph in lines of the usual length."""
    return textwrap.fill(text, LINE)


def bullet(text: str) -> str:
    """Return a point of a list in lines of the usual length."""
    return f"* {textwrap.fill(text, LINE - 2, subsequent_indent='  ')}"


def simulated_between(states: Iterable[Path]) -> str:
    """Return from when to when (UTC) files were written, which simulations leave at their end."""
    times = sorted(datetime.fromtimestamp(path.stat().st_mtime, UTC) for path in states)
    return f"{times[0]:%Y-%m-%d %H:%M} to {times[-1]:%Y-%m-%d %H:%M} UTC"


def solver_words(log: Path) -> str:
    """Return name and version of the solver that wrote a log."""
    said = solver_version(log) or "LIGGGHTS of unknown version"
    return said.removeprefix("Version ").partition(",")[0]


def picture(study: str, name: str) -> str:
    """Return the line that shows a picture of a page of results."""
    return f"\n![{name.replace('_', ' ')}]({picture_file(study, name)})\n"


def picture_file(study: str, name: str) -> str:
    """Return the file name of a study's picture beside its page of results."""
    return f"{study}_{name.removeprefix(f'{study}_')}.png"


def copy_pictures(figures: Path, docs: Path, study: str, names: Sequence[str]) -> None:
    """Put the pictures that a study has beside its page of results."""
    for name in names:
        if (figures / f"{name}.png").is_file():
            save_small(figures / f"{name}.png", docs / picture_file(study, name))


def study_arguments(description: str, folder: str) -> argparse.Namespace:
    """Return folder, docs and fidelity from the command line of a command that writes a page of results."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, nargs="?", default=Path(folder), help="of the study that was run")
    parser.add_argument("docs", type=Path, nargs="?", default=Path("docs"), help="where the page is written")
    parser.add_argument("--fidelity", default="quick", help="at which it was run")
    return parser.parse_args()


def write_page_of_rows(description: str, folder: str, write: Callable[[Path, Path, Study], None]) -> None:
    """Write the page of a study that was run, or of those of its rows that were, as the command line says.

    write: takes the folder of the study, that of the page, and the study
    """
    given = study_arguments(description, folder)
    rows = pd.read_csv(given.folder / "design.csv", dtype={"row": str})["row"].unique().tolist()
    write(given.folder, given.docs, load_study(given.folder.name, overrides={"fidelity": given.fidelity, "rows": rows}))


def provenance(folder: Path, study: Study) -> str:
    """Return when, by which versions and at which sizes the study was simulated."""
    states = [path for run in study.runs for path in cycle_files(folder / run.name, "state.json")]
    solver = solver_words(states[0].parent / "log.liggghts")
    said = (
        f"Simulated {simulated_between(states)} with {solver}, page written by {commit()}: {len(study.runs)} runs of "
        f"{len(study.design_rows)} rows. {'; '.join(figure_remarks(study))}."
    )
    return f"{prose(said)}\n"


def durations(folder: Path, page: Mapping[str, Any]) -> str:
    """Return what the solver's jobs took beside their forecast, and the totals of the study."""
    jobs = jobs_of(page, folder)
    totals = cost_totals(jobs)
    solving = jobs[jobs["solver_s"] > 0.0]
    table = solving[["job", "particles", "steps"]].assign(
        **{
            f"{name} (min)": solving[column] / SECONDS_PER_MINUTE
            for name, column in (("wall", "wall_s"), ("processor", "processor_s"), ("forecast", "forecast_s"))
        },
        **{"measured over forecast": solving["measured_over_forecast"]},
    )
    told = (
        f"All jobs together took {totals['wall_s'] / SECONDS_PER_MINUTE:.0f} minutes of wall time, "
        f"{totals['outside_percent']:.1f} % of it outside the solver; the solver's processor time is "
        f"{totals['measured_over_forecast']:.2f} of its forecast. What else the machine did lengthens wall times."
    )
    return f"{prose(told)}\n\n{markdown(table)}"
