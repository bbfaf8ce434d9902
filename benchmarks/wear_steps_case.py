"""One case of `benchmarks.wear_steps`, by whatever version of the project comes first on the path: seconds and digest.

PYTHONPATH=. python benchmarks/wear_steps_case.py stl [--quick]
"""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.command_line import command
from benchmarks.displacement import DOWN, SPACING, STEP, bumpy_sheet
from benchmarks.remesh import CELLS, JITTER, distorted_sheet
from bulkwear.meshes.pattern import ConvexPattern
from bulkwear.meshes.sample import sliding_sample
from bulkwear.postproc.mesh import SurfaceMesh, areas, unit_normals, worn_faces, write_stl
from bulkwear.postproc.wear.balance import lost_volume
from bulkwear.postproc.wear.caps import step_limit
from bulkwear.postproc.wear.mesh_faults import mesh_faults, with_target_edges
from bulkwear.postproc.wear.remesh import remesh
from bulkwear.postproc.wear.update import wear_update, with_depths

SEED = 20220317
LARGE, QUICK = 400, 24  # cells per side; two triangles each: 320,000
UPDATES, QUICK_UPDATES = 36, 3
WEAR = 6e-5  # m per update, times what a face is loaded more than others
LIMITS = 0.1, 0.01, 1.0  # of a step, see `postproc.wear.caps.step_limit`

Task = Callable[[], object]


def parts_of(found: object) -> Iterator[bytes]:
    """Yield all numbers of an outcome as bytes: of meshes, faults, records, arrays and texts."""
    if isinstance(found, np.ndarray):
        yield np.ascontiguousarray(found).tobytes()
    elif isinstance(found, dict):
        for name in sorted(found):
            yield from (name.encode(), *parts_of(found[name]))
    elif isinstance(found, (tuple, list)):
        for part in found:
            yield from parts_of(part)
    elif hasattr(found, "__dataclass_fields__"):
        for name in found.__dataclass_fields__:
            yield from parts_of(getattr(found, name))
    else:
        yield repr(found).encode()


def sheet(cells: int) -> tuple[SurfaceMesh, np.ndarray, np.ndarray]:
    """Return a bumpy sheet, its worn volumes (m3) and step limits (m)."""
    points, triangles = bumpy_sheet(cells, SPACING)
    volume = np.random.default_rng(SEED).random(len(triangles)) * STEP * SPACING**3
    mesh = SurfaceMesh(points, triangles, {"part": np.zeros(len(triangles), dtype=np.int64)})
    return with_target_edges(mesh, SPACING), volume, step_limit(points, triangles, *LIMITS)


def written(mesh: SurfaceMesh) -> str:
    """Return the digest of the mesh's STL."""
    with tempfile.TemporaryDirectory() as folder:
        write_stl(Path(folder, "surface.stl"), mesh.points, mesh.triangles)
        return hashlib.sha256(Path(folder, "surface.stl").read_bytes()).hexdigest()


def of_sheet(case: str, cells: int) -> Task:
    """Return a step of a wear update on a sheet, ready to be measured."""
    mesh, volume, limit = sheet(cells)
    if case in ("stl", "update"):
        return (lambda: written(mesh)) if case == "stl" else (lambda: wear_update(mesh, volume, limit, DOWN))
    worn, _ = wear_update(mesh, volume, limit, DOWN)
    tasks = {
        "depths": lambda: with_depths(worn, mesh),
        "faults": lambda: mesh_faults(worn),
        "balance": lambda: lost_volume(mesh, worn),
    }
    return tasks[case]


def remeshing_of_a_sample(updates: int) -> tuple[float, object]:
    """Return the processor time (s) of remeshing after each update, and the last surface and all faces changed."""
    pattern = ConvexPattern(8e-3, 4e-3, 4e-3, 30e-3, 30e-3, "along_travel", 0.5)
    mesh = with_target_edges(sliding_sample(60e-3, 60e-3, 4e-3, pattern, 1e-3, math.radians(3.0)))
    random, spent, changed = np.random.default_rng(SEED), 0.0, []
    for number in range(updates):
        place = mesh.points[mesh.triangles].mean(axis=1)[:, 0]
        facing = np.maximum(-unit_normals(mesh.points, mesh.triangles)[:, 0], 0.0)
        load = (0.7 + 3.0 * facing + 0.5 * np.sin(place * 400.0 + number)) * (0.5 + random.random(len(place)))
        volume = WEAR * load * worn_faces(mesh) * areas(mesh.points, mesh.triangles)
        worn, _ = wear_update(mesh, volume, step_limit(mesh.points, mesh.triangles, *LIMITS), DOWN)
        moved = (worn.points != mesh.points).any(axis=1)[worn.triangles].any(axis=1)
        start = time.process_time()
        outcome = remesh(worn, moved=moved)
        spent += time.process_time() - start
        mesh = outcome.mesh
        changed.append(outcome.faces_changed)
    return spent, (mesh, changed)


def run(case: str, quick: bool) -> tuple[float, object]:
    """Return the processor time (s) of a case and what it gave."""
    if case == "worn_sample":
        return remeshing_of_a_sample(QUICK_UPDATES if quick else UPDATES)
    if case in ("tenth", "all", "large"):
        cells = QUICK if quick else LARGE if case == "large" else CELLS
        mesh = distorted_sheet(cells, JITTER, 1.0 if case == "all" else 0.1)
        task: Task = partial(remesh, mesh)
    else:
        task = of_sheet(case, QUICK if quick else CELLS)
    start = time.process_time()
    found = task()
    return time.process_time() - start, found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case")
    parser.add_argument("--quick", action="store_true", help="tiny sizes")
    given = parser.parse_args()
    remesh(distorted_sheet(QUICK, JITTER, 1.0))  # compiles once
    if given.case not in ("tenth", "all", "large"):
        run(given.case, True)
    seconds, found = run(given.case, given.quick)
    digest = hashlib.sha256(b"".join(parts_of(found))).hexdigest()
    print(json.dumps({"seconds": seconds, "digest": digest}))


if __name__ == "__main__":
    command(main)
