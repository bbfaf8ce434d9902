"""How long may a time step be under each rolling model? A small bed slides round a channel over a plain and a convex
sample, whose front ends particles strike, with time steps of 0.1 to 0.6 of the Rayleigh time.

    python -m benchmarks.time_step_limits               # in the root of the repository
    python -m benchmarks.time_step_limits --forecast    # what is missing, and how long it takes
    python -m benchmarks.time_step_limits --finished    # while it runs, or after it was stopped: of the runs so far
    python -m benchmarks.time_step_limits --redraw

Runs stay in `--folder`, where a stopped one goes on; `--minutes` of processor time at most are spent. A model is done
before the next, a packing before the next. Where a verdict takes many packings, `--models`, `--surfaces`,
`--fractions` and `--packings` choose the runs. Writes into docs: time_step_limits.csv (every run in the folder), figure
and time_step_limits_results.md; `--redraw` makes the last two from the first.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Any

import pandas as pd

from benchmarks.command_line import at_least_one, command, output_folder, read_table
from benchmarks.plots.time_step_limits import changes_by_model
from benchmarks.rolling_case import MODELS
from benchmarks.runs import FIRST_SEED, attempted, changed, failure_file, is_simulated, shared_chain, simulated_run
from benchmarks.stiffness import (
    BED_THICKNESS,
    CASE,
    CONVEX,
    ELEMENT_SIZE,
    FRACTION,
    LIMIT,
    PERCENT,
    ROW,
    STUDY,
    VELOCITY,
)
from benchmarks.time_step_page import RESPONSES, answers, results_page
from benchmarks.window_case import PARTICLE_STEPS_PER_SECOND
from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.plots.style import save
from bulkwear.postproc.readers.load_ledger import read_ledger
from bulkwear.workflows.config.design import Run, load_study
from bulkwear.workflows.config.packings import SEED_SPACING
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.chain import Chain, total_steps

FRACTIONS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)  # -, time step over the Rayleigh time of the smallest particle
SURFACES, PACKINGS = (PLAIN, CONVEX), 3
TRAVEL = {"run_in_mm": 150, "travel_mm": 400, "cycles": 1}
MINUTES = 240.0  # of processor time
FILE, PAGE, FIGURE = "time_step_limits.csv", "time_step_limits_results.md", "time_step_limits.png"


@dataclass(frozen=True)
class Case:
    """A run: rolling model, seed of the packing, surface, time step over the Rayleigh time (-)."""

    model: str
    seed: int
    surface: str
    fraction: float

    @property
    def folder(self) -> str:
        """Name of its folder."""
        return f"{self.model}/seed_{self.seed}/{self.surface}_{self.fraction:g}"


def cases(
    models: Sequence[str],
    packings: int,
    surfaces: Sequence[str] = SURFACES,
    fractions: Sequence[float] = FRACTIONS,
) -> list[Case]:
    """Return all runs in the order in which they are done; of a packing and surface the longest steps, cheap, first."""
    seeds = range(FIRST_SEED, FIRST_SEED + SEED_SPACING * packings, SEED_SPACING)
    return [
        Case(model, seed, surface, fraction)
        for model in models
        for seed in seeds
        for surface in surfaces
        for fraction in sorted(fractions, reverse=True)
    ]


def run_of(case: Case, fraction: float) -> Run:
    """Return the study's run with what a case changes, at that time step, whatever the configuration allows."""
    solver = {**CASE["solver"], "rolling_friction": case.model}
    study = load_study(STUDY, overrides=CASE | {"sliding": TRAVEL, "solver": solver})
    change = {
        "bed": {"thickness_m": BED_THICKNESS, "seed": case.seed},
        **({"sample": {"element_size_m": ELEMENT_SIZE}} if case.surface == PLAIN else {}),
        "sliding": {"velocity_m_per_s": VELOCITY},
        "solver": {"rayleigh_fraction": fraction},
    }
    return changed(study.run(f"{ROW}_{case.surface}"), change)


def chain_of(case: Case, folder: Path) -> Chain:
    """Return the chain of a case; nothing is made but its folder.

    All runs of a packing under a model start from one bed, filled above the bumps with one time step.
    """
    study = load_study(STUDY, overrides=CASE)
    at_rest = [run_of(Case(case.model, case.seed, surface, FRACTION), FRACTION) for surface in SURFACES]
    (bed,) = study.case.beds(at_rest)[0].values()  # settled above the bumps
    return shared_chain(case.folder, folder, study.case, run_of(case, case.fraction), bed)


def simulated(case: Case, folder: Path) -> None:
    """Simulate a run from where it stopped, unless it is finished or failed before. Raises SolverStoppedError."""
    chain = chain_of(case, folder)
    attempted(lambda: simulated_run(chain, "bed"), failure_file(chain))


def is_done(case: Case, folder: Path) -> bool:
    """Return whether a run is finished, as it is asked for now, or failed."""
    if not (folder / case.folder).is_dir():
        return False
    chain = chain_of(case, folder)
    return failure_file(chain).exists() or is_simulated(chain)


def row_of(case: Case, folder: Path) -> dict[str, Any]:
    """Return what a run that is done found per metre of travel, NaN where the solver failed."""
    place, chain = folder / case.folder, chain_of(case, folder)
    travel = chain.parameters["sliding"]["travel_m"]
    row = {
        "model": case.model,
        "seed": case.seed,
        "surface": case.surface,
        "rayleigh_fraction": case.fraction,
        "time_step_s": chain.parameters["derived"]["time_step_s"],
        "particles": pd.read_csv(chain.bed_restart.with_name("cost.csv"))["particles"].iloc[0],
        "travel_m": travel,
    }
    if failure_file(chain).exists():
        return row | dict.fromkeys((*RESPONSES, "processor_s"), math.nan)
    ledger, cost = read_ledger(state.cycle_folder(place, 1)), pd.read_csv(place / "cost.csv")
    found = {name: ledger[name.removesuffix("_per_m")].sum() / travel for name in RESPONSES}
    return row | found | {"processor_s": cost["processor_s"].sum()}


def simulate(wanted: Sequence[Case], folder: Path, minutes: float) -> Iterator[Case]:
    """Simulate what is missing until the processor time (min) is spent; give each run as soon as it is done."""
    spent = 0.0
    for case in wanted:
        if is_done(case, folder):
            continue
        if spent > 60.0 * minutes:
            return
        simulated(case, folder)
        spent += row_of(case, folder)["processor_s"] if is_simulated(chain_of(case, folder)) else 0.0
        yield case


def table_of(folder: Path) -> pd.DataFrame:
    """Return the rows of all runs in the folder that are done; nothing is simulated."""
    packings = len({found.name for found in folder.glob("*/seed_*")})
    return pd.DataFrame([row_of(case, folder) for case in cases(MODELS, packings) if is_done(case, folder)])


def forecast(wanted: Sequence[Case], folder: Path) -> str:
    """Return in a phrase what is missing, and about how long a core takes for it."""
    missing = [chain_of(case, folder) for case in wanted if not is_done(case, folder)]
    steps = sum(chain.parameters["derived"]["bed_particles"] * total_steps(chain) for chain in missing)
    minutes = steps / PARTICLE_STEPS_PER_SECOND / 60.0
    return f"{len(missing)} of {len(wanted)} runs are missing: {steps:.2g} particle-steps, some {minutes:.0f} minutes"


def publish(output: Path, table: pd.DataFrame) -> str:
    """Write figure and page of the runs; return the page. table: as from `table_of`."""
    page = results_page(table)
    (output / PAGE).write_text(page, encoding="utf-8")
    packings = table.groupby(["model", "surface", "rayleigh_fraction"], sort=False)["seed"].nunique()
    ranges = packings.groupby("model", sort=False).agg(["min", "max"])
    counted = ", ".join(
        f"{model} {least}" + (f" to {most}" if most > least else "") for model, least, most in ranges.itertuples()
    )
    remarks = [
        f"against the shortest time step; packings: {counted}; bars: 95 % intervals; grey: up to {PERCENT * LIMIT:g} %",
        f"made by benchmarks/time_step_limits.py, {date.today():%Y-%m-%d}",
    ]
    save(changes_by_model(answers(table), RESPONSES, LIMIT, remarks), output / FIGURE)
    return page


def main() -> None:
    """Simulate what is missing, then write table, figure and page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=output_folder, default="docs")
    parser.add_argument("--folder", type=Path, default=Path("results/benchmarks/full/time_step_limits"))
    parser.add_argument("--models", nargs="+", choices=MODELS, default=list(MODELS), metavar="NAME")
    parser.add_argument("--surfaces", nargs="+", choices=SURFACES, default=list(SURFACES), metavar="NAME")
    parser.add_argument("--fractions", nargs="+", type=float, choices=FRACTIONS, default=list(FRACTIONS), metavar="F")
    parser.add_argument("--packings", type=at_least_one, default=PACKINGS, help=f"of each model, else {PACKINGS}")
    parser.add_argument("--minutes", type=float, default=MINUTES, help="processor time of the solver at most")
    parser.add_argument("--forecast", action="store_true", help="say what is missing, simulate nothing")
    parser.add_argument("--finished", action="store_true", help="simulate nothing, take the runs that are done")
    parser.add_argument("--redraw", action="store_true", help="from the table of an earlier run")
    given = parser.parse_args()
    wanted = cases(given.models, given.packings, given.surfaces, given.fractions)
    if given.forecast:
        print(forecast(wanted, given.folder))
        return
    if not given.redraw:
        if not given.finished:
            for case in simulate(wanted, given.folder, given.minutes):
                print(f"done: {case.folder}", flush=True)
        table = table_of(given.folder)
        if table.empty:
            parser.error(f"{given.folder}: no run is finished; without --finished they are simulated.")
        table.to_csv(given.output / FILE, index=False, float_format="%.6g")
    print(publish(given.output, read_table(given.output / FILE)), flush=True)


if __name__ == "__main__":
    command(main)
