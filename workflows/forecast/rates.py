"""The rates of the cost model on a machine: measured by `rate_benchmark.py` into results/cost_rates.json, or by default
those of config/cost_rates.json, which are another machine's.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.workflows.engine.machine import machine_facts
from bulkwear.workflows.engine.project import Project, current_project

MEASURED, DEFAULT = Path("results/cost_rates.json"), Path("config/cost_rates.json")
SOLVER_TERMS = (
    "decks",
    "triangles_read",
    "steps",
    "particle_steps",
    "moving_particle_steps",
    "particle_builds",
    "triangle_steps",
    "loaded_triangle_steps",
)
OUTSIDE_TERMS = ("jobs", "meshed_triangles", "cycles", "worn_triangles")
TERMS = (*SOLVER_TERMS, *OUTSIDE_TERMS)
Rates = Mapping[str, float]


class RatesError(ValueError):
    """A file of rates is damaged; the message names it and says what to do."""


@dataclass(frozen=True)
class MachineRates:
    """Rates (s per unit of each term of the cost model), where and when they were measured, and how well they fit.

    fit: {measurement: seconds by the model over measured ones}; side_by_side: copies of the benchmark that shared the
    machine, 1 in files that do not tell
    """

    rates: dict[str, float]
    machine: dict[str, Any]
    date: str
    fit: dict[str, float]
    side_by_side: int = 1
    measured_here: bool = True

    def said(self) -> str:
        """Return in one phrase where the numbers come from."""
        beside = f"by {self.side_by_side} processes side by side" if self.side_by_side > 1 else "by a single process"
        where = f"{self.machine['processor']}, {self.machine['cores']} cores, measured {self.date} {beside}"
        if not self.measured_here:
            return f"DEFAULT RATES OF ANOTHER MACHINE ({where}); `make rates` measures this one's in a minute or two"
        if self.machine != machine_facts():
            return f"RATES OF ANOTHER MACHINE ({where}); `make rates` measures this one's in a minute or two"
        return f"rates of this machine ({where})"


def rates_file(project: Project | None = None) -> Path:
    """Return the file of rates that forecasts in a project use, by default the current one: measured in it, or in the
    package, or else the default.
    """
    project = project or current_project()
    return Path(project.path(str(MEASURED if project.every(str(MEASURED)) else DEFAULT)))


def read_rates(path: Path) -> MachineRates:
    """Return the rates of a file. Raises RatesError."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        rates = MachineRates(**found, measured_here=path.parent.name != DEFAULT.parent.name)
        numbers = [float(rates.rates[term]) for term in TERMS]
        if missing := {"processor", "cores"} - set(dict(rates.machine)):
            raise ValueError(f"machine has no {', '.join(sorted(missing))}")
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as fault:
        raise RatesError(
            f"{path}: no file of rates ({fault}); remove it and `make rates` measures them anew."
        ) from fault
    if wrong := [number for number in numbers if not (math.isfinite(number) and number >= 0.0)]:
        raise RatesError(f"{path}: a rate is {wrong[0]:g} s, allowed is 0 or more; `make rates` measures them anew.")
    if not (isinstance(rates.side_by_side, int) and rates.side_by_side >= 1):
        raise RatesError(
            f"{path}: side_by_side is {rates.side_by_side!r}, allowed are whole numbers from 1 on; `make rates`"
            " measures them anew."
        )
    return rates


def damage_of(path: Path) -> str | None:
    """Return what is wrong with a file of rates, a sentence; None for a sound one."""
    try:
        read_rates(path)
    except RatesError as fault:
        return str(fault)
    return None


def write_rates(path: Path, rates: MachineRates) -> None:
    """Write rates, whole or not at all."""
    kept = {key: value for key, value in asdict(rates).items() if key != "measured_here"}
    part = path.with_suffix(".part")
    part.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    os.replace(part, path)


def seconds(work: pd.DataFrame, rates: Rates, terms: Sequence[str] = TERMS) -> np.ndarray:
    """Return the processor time (k,) s of k rows of work: the sum over terms of amount times rate.

    terms: what counts, e.g. `SOLVER_TERMS`. Raises KeyError for a term without a rate.
    """
    return work[list(terms)].to_numpy(float) @ np.array([rates[term] for term in terms])


def fitted_rates(work: pd.DataFrame, measured: Sequence[float], known: Rates | None = None) -> dict[str, float]:
    """Return the rates (s) of the columns of `work` that explain measured times (k,) s best, none of them negative.

    known: rates that are not looked for. Relative errors are made small, so that a short measurement counts as much as
    a long one (Lawson and Hanson, Solving Least Squares Problems, 1974: non-negative least squares). Raises ValueError
    where the measurements are too few or too alike to tell the rates apart, or a time is not above 0.
    """
    from scipy.optimize import nnls  # slow to import, and every study is forecast without it

    known, times = dict(known or {}), np.asarray(measured, float)
    if not (times > 0.0).all():
        raise ValueError(f"measured times must be above 0 s, found {times.min():g}")
    wanted = [term for term in work.columns if term not in known]
    matrix = work[wanted].to_numpy(float) / times[:, None]
    scale = np.linalg.norm(matrix, axis=0)
    if len(times) < len(wanted) or not scale.all() or np.linalg.matrix_rank(matrix / scale) < len(wanted):
        raise ValueError(f"{len(times)} measurements cannot tell the rates of {', '.join(wanted)} apart")
    rest = 1.0 - seconds(work, known, list(known)) / times if known else np.ones(len(times))
    found, _ = nnls(matrix / scale, rest)
    return known | dict(zip(wanted, (found / scale).tolist(), strict=True))
