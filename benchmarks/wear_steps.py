"""Processor time of the Python steps of a wear update, by one core, in turn with those of an earlier commit.

Every case is a child process that has compiled before it is measured; both versions must give the same numbers, to the
last bit. The worn sample (60 x 60 mm, edges of 3 mm, three bumps) has 36 updates, each with a load of its own: the time
is that of remeshing alone. Sheets are those of `remesh` and `displacement`. In a copy without that commit nothing is
compared.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

from benchmarks.measure import Measure, in_turn, measured

BEFORE = "14e837e"  # the commit before remeshing was compiled
ROUNDS = 1  # of minutes each; processor time scatters by some per cent
CASES = {  # of wear_steps_case: what each is called
    "worn_sample": "remeshing of a sample, 36 updates",
    "tenth": "find and remesh, 100352 triangles, a tenth distorted",
    "all": "find and remesh, 100352 triangles, all distorted",
    "large": "find and remesh, 320000 triangles, a tenth distorted",
    "stl": "ASCII STL, 100352 triangles",
    "update": "wear update, 100352 triangles",
    "depths": "depths, 100352 triangles",
    "faults": "find faults, 100352 triangles",
    "balance": "lost volume, 100352 triangles",
}
HERE = Path(__file__).resolve().parent.parent


def earlier_version(folder: Path) -> Path | None:
    """Return the folder of the commit `BEFORE`, checked out below `folder`; None where the repository has it not."""
    tree = folder.resolve() / f"commit_{BEFORE}"
    if not tree.is_dir():
        folder.mkdir(parents=True, exist_ok=True)
        packed = subprocess.run(["git", "archive", BEFORE], cwd=HERE, capture_output=True)
        if packed.returncode:
            return None
        tree.mkdir()
        subprocess.run(["tar", "-x", "-C", str(tree)], input=packed.stdout, check=True)
    return tree


def seconds_of(tree: Path, case: str, quick: bool) -> tuple[float, str]:
    """Return the processor time (s) of a case by the version in a folder, and a digest of what it gave."""
    command = [sys.executable, str(HERE / "benchmarks" / "wear_steps_case.py"), case, *(["--quick"] if quick else [])]
    done = subprocess.run(
        command, env=os.environ | {"PYTHONPATH": str(tree)}, cwd=tree, stdout=subprocess.PIPE, text=True, check=True
    )
    found = json.loads(done.stdout)
    return found["seconds"], found["digest"]


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return the processor time of each case against that of the earlier version.

    Raises ValueError where the two do not give the same.
    """
    before, told = earlier_version(folder / "wear_steps"), []
    for case, name in CASES.items():
        ways = {"now": lambda case=case: seconds_of(HERE, case, quick)}
        if before is not None:
            ways["before"] = lambda case=case: seconds_of(before, case, quick)
        found = in_turn(ways, 1 if quick else ROUNDS)
        if len(digests := {digest for runs in found.values() for _, digest in runs}) > 1:
            raise ValueError(f"{name}: {len(digests)} outcomes of this version and commit {BEFORE}, allowed is one")
        times = {way: [seconds for seconds, _ in runs] for way, runs in found.items()}
        told.append(measured(name, "s", times["now"], f"commit {BEFORE}" if before else "", times.get("before")))
    return told
