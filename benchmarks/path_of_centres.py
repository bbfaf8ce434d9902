"""What Archard's law takes where the sliding path is that of the particles' centres, their spin left out.

Archard's law multiplies the normal force with the distance that the contact slides. The documentation of EDEM calls it
the tangential distance moved and does not say whether the spin of the particle is in it; here it is.

    python -m benchmarks.path_of_centres --cores 2    # in the root of the repository; half an hour
    python -m benchmarks.path_of_centres --only tester

Rows of the studies `tester_sensitivity` and `particle_size`, quick, one packing. Builds the solver with
`solver_programs/path_of_centres.cpp` in `--folder`, where its simulations stay too: both paths are summed in the same
run. Writes into docs: path_of_centres.csv, every run; those not asked for stay in it.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd

from benchmarks.changed_solver import Change, check_simulated, use
from benchmarks.command_line import at_least_one, command, output_folder
from benchmarks.critical_scale import said_beforehand, simulate_all
from benchmarks.runs import BY, FIRST_SEED, is_simulated, shared_chain, simulated_by, with_earlier
from benchmarks.scale_case import REFERENCE, SETTINGS, SURFACES, Case, chain_of
from bulkwear.postproc.mesh import PLAIN, read_surface, worn_faces
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.chain import Chain
from bulkwear.workflows.engine.cycles import WORN_SURFACE

CHANGE = Change("path_of_centres.cpp", "fix_load_ledger.cpp", "void FixLoadLedger::add_motion(Observed& seen) const")
TESTER, GRAVEL = "tester", "particle_size"  # which of the studies
TESTER_STUDY, TESTER_SCALE = "tester_sensitivity", 6
OF_TESTER = {"": "the study's reference, cdt", "rolling-": "own_spin"}  # beginning of a row's name
OF_GRAVEL = (REFERENCE, "rolling on relative spin", "one size, rolling on relative spin, time step 0.1")
SCALES = (8,)  # where particles roll most, beside what they slide
FILE, KEYS = "path_of_centres.csv", ["study", "particle_scale", "setting", "surface"]
Asked = tuple[dict[str, Any], Chain]


def of_tester(folder: Path) -> Iterator[Asked]:
    """Yield the runs of the tester: their KEYS, and each as the driver sees it."""
    for beginning, setting in OF_TESTER.items():
        for surface in SURFACES:
            row = f"{beginning}{surface}"
            study = load_study(TESTER_STUDY, overrides={"fidelity": "quick", "rows": [row], "packings": 1})
            (run,) = study.runs
            chain = shared_chain(run.name, folder / TESTER, study.case, run, study.beds[study.bed_of(run.name)])
            yield dict(zip(KEYS, (TESTER_STUDY, TESTER_SCALE, setting, surface), strict=True)), chain


def of_gravel(folder: Path) -> Iterator[Asked]:
    """Yield the runs of a sliding sample under coarse particles, likewise."""
    for scale in SCALES:
        for setting in OF_GRAVEL:
            for surface in SURFACES:
                chain = chain_of(Case(setting, surface, scale, FIRST_SEED), folder / GRAVEL, SETTINGS)
                yield dict(zip(KEYS, (GRAVEL, scale, setting, surface), strict=True)), chain


WHICH = {TESTER: of_tester, GRAVEL: of_gravel}


def run_row(told: dict[str, Any], chain: Chain) -> dict[str, Any]:
    """Return the row of a finished run: KEYS, normal force times sliding path (J) of the faces that wear, by the
    contacts and by the centres, and the code's version.

    Raises SolverError where another program than the changed one has simulated it.
    """
    check_simulated(chain.folder)
    surface = read_surface(chain.folder / WORN_SURFACE)
    worn = worn_faces(surface)
    contacts, centres = (float(surface.cell_data[f"{name}_work_J"][worn].sum()) for name in ("sliding", "rolling"))
    return told | {"of_contacts_J": contacts, "of_centres_J": centres, BY: simulated_by(chain.folder)}


def write_table(file: Path, asked: Sequence[Asked]) -> pd.DataFrame:
    """Write the rows of the runs that are finished, beside those of earlier ones; return them."""
    found = pd.DataFrame([run_row(*each) for each in asked if is_simulated(each[-1])])
    if len(found):
        with_earlier(file, found, KEYS).sort_values(KEYS).to_csv(file, index=False, float_format="%.6g")
    return found


def compared(runs: pd.DataFrame) -> pd.DataFrame:
    """Return by study, scale and setting: the path of the centres over that of the contacts on either surface, and
    convex over plain by either path.

    runs: as in the table; settings of one surface alone are left out
    """
    wide = runs.pivot(index=KEYS[:-1], columns="surface", values=["of_contacts_J", "of_centres_J"]).dropna()
    contacts, centres = wide["of_contacts_J"], wide["of_centres_J"]
    return pd.DataFrame(
        {
            **{f"centres over contacts, {surface}": centres[surface] / contacts[surface] for surface in SURFACES},
            "convex over plain by contacts": contacts["convex"] / contacts[PLAIN],
            "convex over plain by centres": centres["convex"] / centres[PLAIN],
        }
    )


def main() -> None:
    """Build the solver, simulate what is missing, write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=output_folder, default="docs")
    parser.add_argument("--only", choices=WHICH, nargs="+", default=list(WHICH), help="studies, else both")
    parser.add_argument("--folder", type=output_folder, default="results/benchmarks/full/path_of_centres")
    parser.add_argument("--cores", type=at_least_one, default=1, help="runs side by side")
    given = parser.parse_args()
    place = use(CHANGE, given.folder)
    asked = [each for name in dict.fromkeys(given.only) for each in WHICH[name](place)]
    chains, write = [chain for _, chain in asked], partial(write_table, given.output / FILE, asked)
    print(said_beforehand(chains), flush=True)
    simulate_all(chains, given.cores, write)
    if (found := write()).empty:
        parser.error(f"{given.folder}: no run came to its end, and why stands above.")
    print(compared(found).round(3).to_string(), flush=True)


if __name__ == "__main__":
    command(main)
