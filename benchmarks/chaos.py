"""What becomes of studies, runs, files and configurations under faults: the page docs/chaos.md.

    make chaos                                # everything: some hours
    python -m benchmarks.chaos --quick        # a little of everything, printed only: minutes
    python -m benchmarks.chaos --share 0.1    # a tenth of the faults, with the page
    python -m benchmarks.chaos --seed 7       # other faults; --only files, runs or studies: a part of it

Writes docs/chaos.csv and .md, after each part its rows. Small disks, disks without write and a machine without a
network need root; without it they are left out.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from datetime import date
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks import chaos_files, chaos_runs, chaos_studies
from benchmarks.chaos_files import Outcome
from benchmarks.command_line import command
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.accounting import LEDGER
from bulkwear.workflows.engine.chain import Chain
from bulkwear.workflows.engine.inputs import inputs_digest
from bulkwear.workflows.engine.project import PACKAGE, Project
from bulkwear.workflows.report.markdown_text import markdown
from tests.support.own_solids import all_facets, write_binary, write_bodies

ROOT = Path(__file__).parents[1]
TABLE, PAGE = ROOT / "docs" / "chaos.csv", ROOT / "docs" / "chaos.md"
SEED = 27
WHOLE = {
    **{"kills": 50, "levels": 20, "hangs": 5, "stutters": 5, "flips": 500, "configurations": 10_000, "readers": 20_000},
    **{"meshes": 10_000, "cad": 60, "snakemakes": 20, "twins": 10, "clocks": 10},
}
QUICK = {
    **{"kills": 2, "levels": 1, "hangs": 1, "stutters": 1, "flips": 60, "configurations": 40, "readers": 200},
    **{"meshes": 200, "cad": 1, "snakemakes": 2, "twins": 1, "clocks": 1},
}
PARTS = ("files", "runs", "studies")
SAMPLES = ROOT / "tests" / "data"
BAD = ("lost", "wrong", "tracebacks", "hangs")
HEADS = {
    "what": "faults",
    "tried": "tried",
    "refused": "noticed, in a sentence",
    "unchanged": "ended as undisturbed",
    **{name: name for name in BAD},
}


def of_files(chain: Chain, folder: Path, counts: dict[str, int], chance: random.Random) -> Iterator[Outcome]:
    """Yield what came of flipped bits, mutated files and mutated configurations."""
    yield chaos_files.flipped_bits(chain.folder, inputs_digest(chain), counts["flips"], chance)
    of_runs, of_users, here = folder / "of_runs", folder / "of_users", folder / "reading"
    samples_of_run(chain, of_runs)
    samples_of_users(of_users)
    for samples in (of_runs, of_users):
        shutil.copytree(samples, here, dirs_exist_ok=True)
    cad = [of_users / name for name in chaos_files.CAD_MACHINES]
    for what, samples, count in (
        ("mutated files of runs, read", sorted(set(of_runs.iterdir()) - {of_runs / chaos_files.SPINS}), "readers"),
        ("mutated meshes and scans, read", sorted(set(of_users.iterdir()) - set(cad)), "meshes"),
        ("mutated CAD files, read", cad, "cad"),
    ):
        yield chaos_files.mutated_files(samples, here, counts[count], chance, what)
    project = spoilt_project(folder / "project")
    studies = chaos_files.files_of_studies(project)
    yield chaos_files.mutated_configurations(project, studies, counts["configurations"], chance)


def samples_of_run(chain: Chain, folder: Path) -> None:
    """Copy a small file of each kind that a run writes, of a finished one and of the tests' data."""
    folder.mkdir()
    cycle = state.cycle_folder(chain.folder, 1)
    sources = {name: cycle / name for name in ("run.restart", "surface.vtu", state.STATE, "log.liggghts", LEDGER)}
    sources |= {"loads.vtk": SAMPLES / "bed_loads.vtk", "contacts.dump": SAMPLES / "slide_contacts.dump"}
    for name, source in (sources | {chaos_files.SPINS: SAMPLES / "slide_spins.dump"}).items():
        shutil.copy(source, folder / name)


def samples_of_users(folder: Path) -> None:
    """Write a small file of each kind that users bring: the parts of a machine, and scans of a worn one."""
    folder.mkdir(exist_ok=True)
    for name in (*chaos_files.MACHINES, *chaos_files.CAD_MACHINES):
        write_bodies(folder / name)
    points, triangles, _ = all_facets()
    write_binary(folder / "points.stl", points, triangles)
    np.savetxt(folder / "points.xyz", points)
    cloud = [f"{x} {y} {z}" for x, y, z in points]
    head = ["ply", "format ascii 1.0", f"element vertex {len(cloud)}", *(f"property double {axis}" for axis in "xyz")]
    (folder / "points.ply").write_text("\n".join([*head, "end_header", *cloud, ""]))


def spoilt_project(folder: Path) -> Project:
    """Return a project that is a copy of the package's configuration, and has nothing behind it."""
    shutil.copytree(PACKAGE / "config", folder / "config")
    return Project(folder, package=folder)


def of_runs(
    chain: Chain, folder: Path, counts: dict[str, int], chance: random.Random, longest_s: float
) -> Iterator[Outcome]:
    """Yield what came of kills, full disks, and solvers that hang or stand still."""
    yield chaos_runs.killed(chain, folder, counts["kills"], chance, longest_s)
    yield chaos_runs.hanging(chain, folder, counts["hangs"])
    yield chaos_runs.stuttering(chain, folder, counts["stutters"], chance)
    if os.geteuid() == 0:
        for momentary in (False, True):
            yield chaos_runs.filled(chain, counts["levels"], momentary, chance, longest_s)


def table_of(part: str, outcomes: Sequence[Outcome], seed: int) -> pd.DataFrame:
    """Return a row per kind of fault of a part; its number is not that of another seed."""
    rows = [{name: asdict(each)[name] for name in HEADS} for each in outcomes]
    return pd.DataFrame([{"part": part, "seed": seed, "date": f"{date.today():%Y-%m-%d}", **row} for row in rows])


def with_part(table: pd.DataFrame, part: str, found: pd.DataFrame) -> pd.DataFrame:
    """Return a table whose rows of a part are those that were found; the parts keep their order."""
    joined = pd.concat([table[table["part"] != part], found], ignore_index=True)
    return joined.sort_values("part", key=lambda names: names.map(PARTS.index), kind="stable", ignore_index=True)


def page(table: pd.DataFrame) -> str:
    """Return docs/chaos.md."""
    rows = markdown(table.drop(columns="part").rename(columns=HEADS))
    return (
        "# Faults\n\n"
        "Generated by `make chaos`; not to be edited. What is promised is in [reliability.md](reliability.md). Kills"
        " and full disks strike a run of two wear cycles, or its study in Snakemake, at random moments; it is started"
        " again, and its table must be that of the undisturbed one, bit for bit. A flipped bit is noticed where its"
        " cycle does not count any more. A file or configuration is noticed where it is refused in one sentence.\n\n"
        f"{rows}\n\n[Table]({TABLE.name}).\n"
    )


def main(words: list[str] | None = None) -> int:
    """Do what the command line says; 1 where something was lost, wrong, hung or ended in a traceback."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--quick", action="store_true", help="a little of everything, printed only")
    parser.add_argument(
        "--share", type=float, default=1.0, help="of the faults of the whole, at least one of each kind"
    )
    parser.add_argument("--only", choices=PARTS)
    given = parser.parse_args(words)
    counts = QUICK if given.quick else {name: max(1, round(given.share * count)) for name, count in WHOLE.items()}
    bad = False
    with tempfile.TemporaryDirectory(prefix="chaos_") as name:
        folder, started = Path(name), time.monotonic()
        chain = chaos_runs.undisturbed(folder / "undisturbed")
        longest_s = time.monotonic() - started
        for part in PARTS if given.only is None else (given.only,):
            chance = random.Random(f"{given.seed} {part}")
            of_part = {
                "files": lambda chance: of_files(chain, folder, counts, chance),
                "runs": lambda chance: of_runs(chain, folder, counts, chance, longest_s),
                "studies": lambda chance: chaos_studies.studies(folder, counts, chance),
            }
            outcomes = []
            for outcome in of_part[part](chance):
                outcomes.append(outcome)
                print(f"{time.monotonic() - started:.0f} s: {outcome.what}, {outcome.tried} tried", file=sys.stderr)
                print(*outcome.said, sep="\n", end="", file=sys.stderr)
            table = table_of(part, outcomes, given.seed)
            print(table.to_string(index=False))
            bad |= bool(table[list(BAD)].to_numpy().any())
            if not given.quick:
                whole = with_part(pd.read_csv(TABLE), part, table)
                whole.to_csv(TABLE, index=False)
                PAGE.write_text(page(whole), encoding="utf-8")
    return int(bad)


if __name__ == "__main__":
    command(main)
