"""More ranks than this machine has: what the model makes of two ranks that were measured."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pandas as pd

from benchmarks.ledger_overhead import PARTICLE_SCALE
from benchmarks.ranks import ACROSS
from benchmarks.runs import RUN, case_study
from benchmarks.scaling_model import Bed, best_grid, deck_grid, efficiency, ghost_cost
from bulkwear.workflows.config.design import Run, Study, load_study
from bulkwear.workflows.engine.derived import neighbour_skin
from bulkwear.workflows.forecast.forecast import work_of
from bulkwear.workflows.forecast.rates import SOLVER_TERMS, rates_file, read_rates, seconds

RANKS = (2, 4, 8, 16, 32, 64)
FULL_SIZE: dict[str, tuple[str, dict[str, Any]]] = {  # name -> study and settings whose largest bed is modelled
    "demo": ("demo", {}),
    "screening": ("screening", {}),
    "screening, window 150 + 200": ("screening", {"bed": {"ends": "window", "ahead_mm": 150, "behind_mm": 200}}),
    "worn_bump": ("worn_bump", {}),
}
OF_TRIANGLES = ("triangle_steps", "loaded_triangle_steps")  # terms of the cost model


def bed_of(study: Study, run: Run) -> Bed:
    """Return the bed of a run; what its triangles take of the time is told by its forecast."""
    derived, particle = run.parameters["derived"], run.parameters["particle"]
    return Bed(
        width=run.parameters["bed"]["width_m"],
        length=derived["bed_length_m"],
        travel=derived["bed_travel_m"],
        layer=max(particle["diameters_m"]) + neighbour_skin(particle),
        sample_length=run.parameters["sample"]["length_m"],
        triangle_share=triangle_share(study, run),
    )


def triangle_share(study: Study, run: Run) -> float:
    """Return the share (-) of the solver's time that triangles take, by the forecast of a run."""
    (job,) = [job for job in work_of(study) if (job.rule, job.wildcards) == ("worn_run", (run.name,))]
    work = pd.DataFrame([stage.terms() for stage in job.stages])
    rates = read_rates(rates_file()).rates
    triangles, whole = (seconds(work, rates, terms).sum() for terms in (OF_TRIANGLES, SOLVER_TERMS))
    return float(triangles / whole)


def measured_cost(table: pd.DataFrame) -> float | None:
    """Return what a ghost costs by the lines of the benchmark of ranks, None without them."""
    lines = table[(table["benchmark"] == "ranks") & (table["name"] == ACROSS)]
    if lines.empty:
        return None
    study = case_study(PARTICLE_SCALE)
    return ghost_cost(bed_of(study, study.run(RUN)), float(lines["ratio"].iloc[0]))


def scaling_table(cost: float) -> pd.DataFrame:
    """Return a row per study and number of ranks: efficiency across the travel, of the grid that the decks choose, of
    the best one, and weak scaling.
    """
    rows = []
    for name, (study_name, settings) in FULL_SIZE.items():
        study = load_study(study_name, overrides={"fidelity": "paper", **settings})
        run = max(study.runs, key=lambda run: run.parameters["derived"]["bed_particles"])
        bed = bed_of(study, run)
        for ranks in RANKS:
            chosen, best = deck_grid(bed, ranks), best_grid(bed, cost, ranks)
            wider = replace(bed, width=bed.width * ranks / min(RANKS))
            rows.append(
                {
                    "study": name,
                    "particles": run.parameters["derived"]["bed_particles"],
                    "ranks": ranks,
                    "split_across": efficiency(bed, cost, ranks, 1),
                    "deck_grid": grid_text(chosen),
                    "of_decks": efficiency(bed, cost, *chosen),
                    "best_grid": grid_text(best),
                    "best": efficiency(bed, cost, *best),
                    "bed_as_wide_again": efficiency(wider, cost, ranks, 1),
                }
            )
    return pd.DataFrame(rows)


def grid_text(grid: tuple[int, int]) -> str:
    """Return a grid of ranks as people write it, across by along the travel."""
    return f"{grid[0]} x {grid[1]}"
