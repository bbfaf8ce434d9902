"""What the ratio of convex to plain wear is where the torque of `rvd` is constant, as its source writes it, and no time
step ends it. Particles of one size, one packing.

    python -m benchmarks.constant_torque --scales 8 --fractions 0.23    # in the root of the repository; minutes
    python -m benchmarks.constant_torque --cores 2    # all; hours, the shortest steps most of them

Builds the solver with `solver_programs/constant_torque.cpp` in `--folder`, where its simulations stay too. Writes into
docs: constant_torque.csv, every run; those not asked for stay in it. They are read beside those of
`benchmarks.critical_scale` in docs/particle_size.md.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

import pandas as pd

from benchmarks.changed_solver import Change, check_simulated, use
from benchmarks.command_line import at_least_one, command, number_within, output_folder
from benchmarks.critical_scale import MM3, said_beforehand, simulate_all
from benchmarks.runs import BY, FIRST_SEED, is_simulated, simulated_by, with_earlier
from benchmarks.scale_case import FRACTION_DIGITS, SETTINGS, SOURCE_STEP, SURFACES, Case, chain_of
from bulkwear.postproc.tables.summary import run_summary
from bulkwear.workflows.engine.chain import Chain

CANDIDATE = "one size, rolling as rvd"
FRACTIONS = {4: (0.4, 0.23), 6: (0.4, 0.23, 0.1), 8: (0.23,)}  # by scale, beside SOURCE_STEP: of the Rayleigh time
CHANGE = Change("constant_torque.cpp", "rolling/fix_turning_friction.cpp", "void FixTurningFriction::act()")
FILE, KEYS = "constant_torque.csv", ["particle_scale", "rayleigh_fraction", "surface", "seed"]


def fractions_of(scale: int, folder: Path) -> list[float]:
    """Return the time steps of a scale over the Rayleigh time (-): FRACTIONS, and what SOURCE_STEP is of it."""
    chain = chain_of(Case(CANDIDATE, SURFACES[0], scale, FIRST_SEED), folder, SETTINGS)
    of_source = SOURCE_STEP / chain.parameters["derived"]["rayleigh_time_s"]
    return [*FRACTIONS[scale], float(f"{of_source:{FRACTION_DIGITS}}")]


def asked_for(
    scales: Sequence[int], fractions: Sequence[float] | None, folder: Path
) -> Iterator[tuple[Case, float, Chain]]:
    """Yield the runs that are asked for, with their fractions of the Rayleigh time; fractions: None where all are."""
    for scale in scales:
        for fraction in fractions or fractions_of(scale, folder):
            place = folder / f"fraction_{fraction:{FRACTION_DIGITS}}"
            for surface in SURFACES:
                case = Case(CANDIDATE, surface, scale, FIRST_SEED)
                yield case, fraction, chain_of(case, place, SETTINGS, {"solver": {"rayleigh_fraction": fraction}})


def run_row(case: Case, fraction: float, chain: Chain) -> dict[str, object]:
    """Return the row of a finished run: KEYS, its wear per metre of counted travel (mm3/m) and the code's version.

    Raises SolverError where another program than the changed one has simulated it.
    """
    check_simulated(chain.folder)
    found = run_summary(pd.read_csv(chain.folder / "wear.csv"))
    wear = MM3 * found["worn_volume_m3"] / found["travel_m"]
    told = dict(zip(KEYS, (case.scale, fraction, case.surface, case.seed), strict=True))
    return told | {"wear_mm3_per_m": wear, BY: simulated_by(chain.folder)}


def write_table(file: Path, asked: Sequence[tuple[Case, float, Chain]]) -> pd.DataFrame:
    """Write the rows of the runs that are finished, beside those of earlier ones; return them."""
    found = pd.DataFrame([run_row(*each) for each in asked if is_simulated(each[-1])])
    if len(found):
        with_earlier(file, found, KEYS).sort_values(KEYS).to_csv(file, index=False, float_format="%.6g")
    return found


def main() -> None:
    """Build the solver, simulate what is missing, write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=output_folder, default="docs")
    parser.add_argument("--scales", type=int, nargs="+", choices=FRACTIONS, default=list(FRACTIONS))
    parser.add_argument(
        "--fractions", type=number_within(0.01, 0.6), nargs="+", help="of the Rayleigh time, else those of the table"
    )
    parser.add_argument("--folder", type=output_folder, default="results/benchmarks/full/constant_torque")
    parser.add_argument("--cores", type=at_least_one, default=1, help="runs side by side")
    given = parser.parse_args()
    asked = list(asked_for(given.scales, given.fractions, use(CHANGE, given.folder)))
    chains, write = [chain for _, _, chain in asked], partial(write_table, given.output / FILE, asked)
    print(said_beforehand(chains), flush=True)
    simulate_all(chains, given.cores, write)
    if (found := write()).empty:
        parser.error(f"{given.folder}: no run came to its end, and why stands above.")
    ratios = found.pivot(index=KEYS[:2], columns="surface", values="wear_mm3_per_m")
    print((ratios["convex"] / ratios["plain"]).rename("convex over plain").to_string(), flush=True)


if __name__ == "__main__":
    command(main)
