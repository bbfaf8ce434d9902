"""Four machines as LIGGGHTS' tutorials have them, scaled down to ten updates in a minute: parts, deck, time, wear."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bulkwear.meshes.own.mesh import own_mesh
from bulkwear.meshes.plate import closed_box, flat_plate
from bulkwear.postproc.mesh import SurfaceMesh, centroids
from bulkwear.postproc.motion import belt, combined, rotation, translation
from bulkwear.workflows.engine.own_machine import Part, part_of
from tests import REPOSITORY

DATA = REPOSITORY / "tests" / "data" / "machines"
DECKS = Path(__file__).parent


@dataclass(frozen=True, eq=False)
class Machine:
    """Parts of a machine, steps of a cycle and their length, wear coefficient (1/Pa), folder's deck by name."""

    name: str
    parts: tuple[Part, ...]
    cycle_steps: int
    time_step_s: float
    coefficient_per_pa: float

    @property
    def deck(self) -> Path:
        """The deck of the machine."""
        return DECKS / f"{self.name}.in"


def chute() -> Machine:
    """A curved chute, open, its facets as in the file."""
    surface = own_mesh(DATA / "chute.stl", "m").surface
    return Machine("chute", (part_of("chute", surface),), 2400, 2.5e-5, 1e-6)


def cascade() -> Machine:
    """A case with shelves, closed, drawn upside in mm: z of the machine is -y of the file."""
    surface = own_mesh(DATA / "cascade.stl", "mm", edges=0.06).surface
    points = surface.points[:, [0, 2, 1]] * [1.0, 1.0, -1.0]
    placed = SurfaceMesh(points, surface.triangles, surface.cell_data)
    return Machine("cascade", (part_of("cascade", placed),), 2000, 5e-5, 1e-6)


def bucket() -> Machine:
    """A bucket, closed, pushed down into the heap for 0.75 s and then turned about the y axis."""
    surface = own_mesh(DATA / "bucket.stl", "mm", edges=0.02).surface
    x, y, z = (surface.points * 2.0 - [0.1, 0.5, 0.0]).T
    placed = SurfaceMesh(np.column_stack([-y, z, -x]), surface.triangles, surface.cell_data)
    motion = combined(
        rotation((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), np.pi, start_s=0.75),
        translation((-0.5, 0.0, -0.3), stop_s=0.75),
    )
    return Machine("bucket", (part_of("bucket", placed, motion),), 1000, 2e-4, 1e-6)


def conveyor() -> Machine:
    """A running belt and an open box round it, two parts."""
    plate, case = flat_plate(0.6, 0.4, 0.04), closed_box(1.0, 0.4, 0.4, 0.08)
    carrying = SurfaceMesh(plate.points + np.array([0.2, 0.0, 0.0]), plate.triangles)
    points = case.points - np.array([0.0, 0.0, 0.2])
    below_lid = centroids(points, case.triangles)[:, 2] < 0.2 - 1e-9
    kept, triangles = np.unique(case.triangles[below_lid], return_inverse=True)
    box = SurfaceMesh(points[kept], triangles.reshape(-1, 3))
    parts = (part_of("box", box), part_of("belt", carrying, belt((-4.5, 0.0, 0.0))))
    return Machine("conveyor", parts, 1000, 1e-4, 1e-6)


MACHINES = {make.__name__: make for make in (chute, cascade, bucket, conveyor)}
