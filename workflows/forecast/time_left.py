"""Time left of a whole study while it runs: its forecast, set right by how long its finished jobs took."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterable

import pandas as pd

from bulkwear.workflows.config.design import Study
from bulkwear.workflows.engine.job import duration_text
from bulkwear.workflows.forecast.forecast import table_of_jobs, wall_hours
from bulkwear.workflows.forecast.rates import RatesError, rates_file, read_rates


class TimeLeft:
    """How many jobs of a study are done, and how long the others take.

    table: as from `forecast.forecast_table`, of the jobs that are to be done
    """

    def __init__(self, study: str, table: pd.DataFrame, cores: int, clock: Callable[[], float] = time.monotonic):
        self.study, self.table, self.cores, self.clock = study, table, cores, clock
        self.start, self.whole = clock(), wall_hours(table, cores)
        self.done: set[str] = set()

    def finished(self, job: str) -> str:
        """Return what is said when a job has ended."""
        self.done.add(job)
        rest = self.table[~self.table["job"].isin(self.done)]
        count = f"{self.study}: {len(self.table) - len(rest)} of {len(self.table)} jobs of the solver done"
        left = wall_hours(rest, self.cores)
        if rest.empty:
            return f"{count}; tables, figures and page follow"
        if left >= self.whole:  # jobs beside it take as long as all
            return count
        elapsed = self.clock() - self.start
        return f"{count}, about {duration_text(elapsed * left / (self.whole - left))} left"


def times_left(studies: Iterable[tuple[Study, Collection[str]]], cores: int) -> dict[str, TimeLeft]:
    """Return {name of a study: its time left}, of the jobs named; none where there are no rates to forecast by."""
    try:
        rates = read_rates(rates_file()).rates
    except RatesError:
        return {}
    return {study.name: TimeLeft(study.name, table_of_jobs(study, jobs, rates), cores) for study, jobs in studies}
