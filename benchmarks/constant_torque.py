"""What the ratio of convex to plain wear is where the torque of `rvd` is constant, as its source writes it, and no time
step ends it. Particles of one size, one packing.

    python -m benchmarks.constant_torque --scales 8 --fractions 0.23    # in the root of the repository; minutes
    python -m benchmarks.constant_torque --cores 2    # all; hours, the shortest steps most of them

Builds the solver with `solver_programs/constant_torque.cpp` in `--folder`, where its simulations stay too; needs what
`make -C solver` needs. Writes into docs: constant_torque.csv, every run; those not asked for stay in it. They are read
beside those of `benchmarks.critical_scale` in docs/particle_size.md.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

import pandas as pd

from benchmarks.command_line import at_least_one, command, number_within, output_folder
from benchmarks.critical_scale import MM3, said_beforehand, simulate_all
from benchmarks.runs import BY, FIRST_SEED, is_simulated, simulated_by, with_earlier
from benchmarks.scale_case import FRACTION_DIGITS, SETTINGS, SOURCE_STEP, SURFACES, Case, chain_of
from bulkwear.postproc.tables.summary import run_summary
from bulkwear.workflows.engine import solver, state
from bulkwear.workflows.engine.chain import Chain
from bulkwear.workflows.engine.machine import program_hashes
from bulkwear.workflows.engine.project import PACKAGE
from bulkwear.workflows.engine.provenance import PROVENANCE

CANDIDATE = "one size, rolling as rvd"
FRACTIONS = {4: (0.4, 0.23), 6: (0.4, 0.23, 0.1), 8: (0.23,)}  # by scale, beside SOURCE_STEP: of the Rayleigh time
PROGRAM, CHANGED, FUNCTION = "constant_torque.cpp", "rolling/fix_turning_friction.cpp", "void FixTurningFriction::act()"
COMPILED, HASH_DIGITS = {".cpp", ".h"}, 12  # files of the solver; of a hash of them, in the name of a folder
FILE, KEYS = "constant_torque.csv", ["particle_scale", "rayleigh_fraction", "surface", "seed"]


def changed_source(source: str, function: str) -> str:
    """Return a C++ file with another text of its FUNCTION. Raises ValueError unless it has that once."""
    pattern = re.compile(rf"^{re.escape(FUNCTION)} \{{\n.*?^\}}\n", re.MULTILINE | re.DOTALL)
    new, count = pattern.subn(lambda _: function[function.index(FUNCTION) :], source)
    if count != 1:
        raise ValueError(f"{CHANGED}: found {FUNCTION} {count} times, allowed is once.")
    return new


def built(folder: Path) -> Path:
    """Return a solver program whose torque of `rvd` is constant, built unless it is there.

    The compiler's words go to standard error. Raises SolverError.
    """
    ours, function = PACKAGE / "solver", (Path(__file__).parent / "solver_programs" / PROGRAM).read_text("utf-8")
    sources = {str(path): path.read_text("utf-8") for path in sorted(ours.rglob("*")) if path.suffix in COMPILED}
    place = folder / f"solver_{state.digest({PROGRAM: function, **sources})[:HASH_DIGITS]}"
    if not (build := place / "build").is_dir():
        shutil.copytree(ours, place, ignore=shutil.ignore_patterns("build"), dirs_exist_ok=True)
        changed = changed_source((ours / CHANGED).read_text("utf-8"), function)
        (place / CHANGED).write_text(changed, encoding="utf-8")
        if code := subprocess.run(["make", "-C", place, "BUILD=unfinished"], stdout=subprocess.DEVNULL).returncode:
            raise solver.SolverError(f"{place}: make ended with code {code}, and why stands above.")
        (place / "unfinished").rename(build)
    return (build / Path(solver.LEDGER_EXECUTABLE).name).resolve()


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
    programs = state.read_state(chain.folder, 0)[PROVENANCE]["programs"]
    if not programs.items() >= program_hashes(solver.LEDGER_EXECUTABLE).items():
        raise solver.SolverError(f"{chain.folder}: not simulated by {solver.LEDGER_EXECUTABLE}, allowed is that alone.")
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
    solver.LEDGER_EXECUTABLE = str(program := built(given.folder))  # of all processes that this one starts
    asked = list(asked_for(given.scales, given.fractions, program.parents[1] / "runs"))
    chains, write = [chain for _, _, chain in asked], partial(write_table, given.output / FILE, asked)
    print(said_beforehand(chains), flush=True)
    simulate_all(chains, given.cores, write)
    if (found := write()).empty:
        parser.error(f"{given.folder}: no run came to its end, and why stands above.")
    ratios = found.pivot(index=KEYS[:2], columns="surface", values="wear_mm3_per_m")
    print((ratios["convex"] / ratios["plain"]).rename("convex over plain").to_string(), flush=True)


if __name__ == "__main__":
    command(main)
