"""What a job asks of a cluster, minutes and memory, from its forecast.

Generously: who asks for too little is ended and resumed, who asks for too much waits a little longer. Every further
attempt of a job asks for more; a cluster's own limits cap all of it (`resources` in profiles/slurm).
"""

from __future__ import annotations

import math
from pathlib import Path

from workflows.config.design import Study
from workflows.forecast.forecast import forecast_table, work_of
from workflows.forecast.rates import rates_file, read_rates

TIME_MARGIN = 2.0  # -, over the forecast: ranks do not share all work evenly, and nodes differ
LEAST_MINUTES = 10  # Python, its libraries and a slow file system
MEMORY_MARGIN = 1.5  # -, over the forecast
LEAST_MEMORY_MB = 1000


def demands(study: Study, root: Path) -> dict[str, tuple[int, int]]:
    """Return the minutes and MB that the jobs of a study which call the solver ask for at first, by their names.

    Raises RatesError.
    """
    table = forecast_table(work_of(study), read_rates(rates_file(root)).rates)
    return {row["job"]: (minutes(row["wall_h"]), megabytes(row["memory_gb"])) for row in table.to_dict("records")}


def minutes(wall_hours: float) -> int:
    """Return the minutes to ask for, for work that is expected to take so long (h)."""
    return LEAST_MINUTES + math.ceil(60.0 * TIME_MARGIN * wall_hours)


def megabytes(gigabytes: float) -> int:
    """Return the MB to ask for, for work that is expected to need so many GB, of all ranks together."""
    return LEAST_MEMORY_MB + math.ceil(1e3 * MEMORY_MARGIN * gigabytes)
