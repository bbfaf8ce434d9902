"""More ranks than this machine has: what the model makes of two ranks that were measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import pandas as pd

from benchmarks.bed_case import RUN, STUDY
from benchmarks.ledger_overhead import PARTICLE_SCALE
from benchmarks.ranks import ACROSS
from postproc.analysis.scaling import Bed, best_grid, efficiency, ghost_cost
from workflows.derived import neighbour_skin
from workflows.design import load_study

RANKS = (2, 4, 8, 16, 32, 64)
FULL_SIZE = ("demo", "screening", "worn_bump")  # studies of which a bed at paper fidelity is modelled


def bed_of(parameters: Mapping[str, Any]) -> Bed:
    """Return the bed of a run's parameters."""
    derived, particle = parameters["derived"], parameters["particle"]
    layer = max(particle["diameters_m"]) + neighbour_skin(particle)
    return Bed(parameters["bed"]["width_m"], derived["bed_length_m"], derived["bed_travel_m"], layer)


def measured_cost(table: pd.DataFrame) -> float | None:
    """Return what a ghost costs by the lines of the benchmark of ranks, None without them."""
    lines = table[(table["benchmark"] == "ranks") & (table["name"] == ACROSS)]
    if lines.empty:
        return None
    parameters = (
        load_study(STUDY, overrides={"particle_scale": PARTICLE_SCALE, "fidelity": "quick"}).run(RUN).parameters
    )
    return ghost_cost(bed_of(parameters), float(lines["ratio"].iloc[0]))


def scaling_table(cost: float) -> pd.DataFrame:
    """Return a row per study and number of ranks: efficiency across the travel, of the best grid, and weak scaling."""
    rows = []
    for name in FULL_SIZE:
        parameters = max(
            (run.parameters for run in load_study(name, overrides={"fidelity": "paper"}).runs),
            key=lambda parameters: parameters["derived"]["bed_particles"],
        )
        bed = bed_of(parameters)
        for ranks in RANKS:
            across, along = best_grid(bed, cost, ranks)
            wider = replace(bed, width=bed.width * ranks / min(RANKS))
            rows.append(
                {
                    "study": name,
                    "particles": parameters["derived"]["bed_particles"],
                    "ranks": ranks,
                    "split_across": efficiency(bed, cost, ranks, 1),
                    "best_grid": f"{across} x {along}",
                    "best": efficiency(bed, cost, across, along),
                    "bed_as_wide_again": efficiency(wider, cost, ranks, 1),
                }
            )
    return pd.DataFrame(rows)
