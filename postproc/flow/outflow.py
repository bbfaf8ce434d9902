"""Outflow of a bulk test: mass against time from the solver's log, discharge time, and the count of particles."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.readers.solver_log import thermo_table

DISCHARGED = 0.99  # -, of the mass that flows out in the end; the last grains trickle
LEAST_OUTFLOW = 0.2  # -, of the particles: an upper box that keeps more is blocked, no slope is so steep
DISCHARGED_BAND = (0.98, 0.995)  # -, other readings of "has stopped"; half their distance in time is the uncertainty
NEEDED = ("Step", "Atoms", "opened", "out_kg", "out_n")  # columns of the log


class OutflowError(ValueError):
    """An outflow that cannot be trusted; the message names the log and what is wrong."""


class BlockedError(OutflowError):
    """An arch stands over the opening: this packing tells nothing, another one may flow."""


def outflow_curve(log: str | Path, time_step: float, spheres: int = 1) -> pd.DataFrame:
    """Return time_s since the opening, mass_kg and count that have flowed out by then, and the particles still there.

    log: of a bulk test, with the columns opened, out_kg and out_n, which counts clumps, not their spheres; time_step: s
    spheres: of a particle, which the solver has as so many. Raises OutflowError when nothing was opened, SolverLogError
    for a log without such a column.
    """
    printed = thermo_table(log)
    thermo = pd.DataFrame({name: printed[name] for name in NEEDED}).drop_duplicates("Step", keep="last")
    opened = thermo[thermo["opened"] == 1.0]
    if opened.empty:
        raise OutflowError(f"{log}: the box was never opened, allowed is the log of a test that was run to its end.")
    return pd.DataFrame(
        {
            "time_s": ((opened["Step"] - opened["Step"].iloc[0]) * time_step).to_numpy(),
            "mass_kg": (opened["out_kg"] - opened["out_kg"].iloc[0]).to_numpy(),
            "count": (opened["out_n"] - opened["out_n"].iloc[0]).to_numpy(),
            "particles": opened["Atoms"].to_numpy() / spheres,
        }
    )


def check_count(curve: pd.DataFrame, removed: bool, log: str | Path) -> None:
    """Raise OutflowError unless every particle is accounted for: still there, or, where outflow is removed, counted."""
    present = curve["particles"].iloc[-1] + (curve["count"].iloc[-1] if removed else 0.0)
    missing = int(curve["particles"].iloc[0] - present)
    if missing:
        raise OutflowError(f"{log}: {missing} particles left the domain uncounted, allowed are none.")


def check_not_blocked(curve: pd.DataFrame, log: str | Path) -> None:
    """Raise BlockedError when less than a fifth of the particles flowed out: an arch stands over the opening."""
    share = curve["count"].iloc[-1] / curve["particles"].iloc[0]
    if share < LEAST_OUTFLOW:
        raise BlockedError(
            f"{log}: {share:.0%} of the particles flowed out, allowed is {LEAST_OUTFLOW:.0%} or more; an arch blocks"
            " the opening, a wider one or smaller particles let it flow."
        )


def discharge_time(curve: pd.DataFrame) -> tuple[float, float]:
    """Return the time (s) from the opening until 99 % of the outflow has passed, and its uncertainty.

    The uncertainty is half the time between 98 and 99.5 %: how much the reading depends on what counts as stopped.
    Raises OutflowError when nothing flowed.
    """
    mass = curve["mass_kg"].to_numpy()
    if mass[-1] <= 0.0:
        raise OutflowError("nothing flowed out: the opening is blocked, allowed is a wider one or smaller particles.")
    share = np.maximum.accumulate(mass) / mass[-1]
    early, at, late = np.interp([DISCHARGED_BAND[0], DISCHARGED, DISCHARGED_BAND[1]], share, curve["time_s"])
    return float(at), float((late - early) / 2.0)
