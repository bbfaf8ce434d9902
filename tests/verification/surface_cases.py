"""What the tests of arbitrary surfaces share: a pressed sphere that slides on a wall of any attitude, and its wear."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import Delaunay
from scipy.spatial.transform import Rotation

from bulkwear.postproc.mesh import SurfaceMesh, stl_corners
from bulkwear.postproc.wear.ledger import columns_of_solver
from tests.verification.ledger_cases import DENSITY, LOAD, RADIUS, hertz_overlap, run_case

COEFFICIENT = 4e-10  # 1/Pa, Archard's volume over load and way: a few micrometres per pass
DOMAIN = "-0.06 0.06 -0.06 0.06 -0.06 0.06"


@dataclass(frozen=True)
class Attitude:
    """A frame of its own in space: x_space = rotation @ x + shift (m)."""

    rotation: np.ndarray
    shift: np.ndarray

    def points(self, points) -> np.ndarray:
        """Points (n, 3) m of the frame in space."""
        return np.asarray(points, dtype=np.float64) @ self.rotation.T + self.shift

    def direction(self, vector) -> np.ndarray:
        """A direction (3,) of the frame in space."""
        return self.rotation @ np.asarray(vector, dtype=np.float64)


def attitude(seed: int) -> Attitude:
    """An attitude along no axis: a random turn and a shift by some millimetres."""
    random = np.random.default_rng(seed)
    return Attitude(Rotation.random(random_state=random).as_matrix(), random.uniform(-0.005, 0.005, 3))


def slivers(width: float, length: float, count: int, stretch: float, seed: int) -> SurfaceMesh:
    """A bad triangulation of a rectangle (m) at z = 0, centred, normals up: `count` random nodes, long across y.

    The nodes are triangulated as if the rectangle were `stretch` times as long: acute and obtuse corners.
    """
    random = np.random.default_rng(seed)
    inner = random.uniform(-0.49, 0.49, (count, 2))
    steps = np.linspace(-0.5, 0.5, max(count // 8, 4))
    sides = [np.column_stack([np.full_like(steps, x), steps]) for x in (-0.5, 0.5)]
    ends = [np.column_stack([steps[1:-1:6], np.full_like(steps[1:-1:6], y)]) for y in (-0.5, 0.5)]
    plan = np.concatenate([inner, *sides, *ends]) * [width, length]
    triangles = Delaunay(plan * [1.0, stretch]).simplices.astype(np.int64)
    points = np.column_stack([plan, np.zeros(len(plan))])
    return SurfaceMesh(points, triangles)


def shell(radius: float, width: float, around: int, inside: bool) -> SurfaceMesh:
    """A facetted cylinder about the x axis, one quad wide (m), its nodes on the radius (m); normals out, or in."""
    angle = np.arange(around) * 2.0 * np.pi / around
    rim = np.column_stack([np.zeros(around), radius * np.cos(angle), radius * np.sin(angle)])
    side = np.array([width / 2, 0.0, 0.0])
    points = np.concatenate([rim - side, rim + side])
    here, there = np.arange(around), np.roll(np.arange(around), -1)
    quads = np.column_stack([here, here + around, there + around, there])
    quads[1::2] = np.roll(quads[1::2], -1, axis=1)
    triangles = quads[:, [0, 2, 1, 0, 3, 2]].reshape(-1, 3)
    normal = np.cross(*(points[triangles[0, k]] - points[triangles[0, 0]] for k in (1, 2)))
    outward = normal @ points[triangles[0]].mean(axis=0) > 0.0
    return SurfaceMesh(points, triangles[:, ::-1] if outward == inside else triangles)


def pressed_sphere(centre, velocity, outward) -> tuple[list[str], list[str]]:
    """Deck lines of a sphere (centre m, velocity m/s) that is pressed against `outward` (3,) and free only along it."""
    x, y, z = centre
    particles = [
        f"create_atoms 1 single {x:.17g} {y:.17g} {z:.17g} units box",
        f"set group all density {DENSITY} diameter {2 * RADIUS}",
        "velocity all set {:.17g} {:.17g} {:.17g} units box".format(*velocity),
    ]
    along = "+".join(f"f{axis}*({value:.17g})" for axis, value in zip("xyz", outward, strict=True))
    motion = [
        f"variable along atom {along}",
        *(f"variable guided_{a} atom v_along*({v:.17g})" for a, v in zip("xyz", outward, strict=True)),
        "fix load all addforce {:.17g} {:.17g} {:.17g}".format(*(-LOAD * np.asarray(outward))),
        "fix guide all setforce v_guided_x v_guided_y v_guided_z",
        "fix integrate all nve",
    ]
    return particles, motion


def height() -> float:
    """Height (m) of the sphere's centre over a flat wall that carries the load."""
    return RADIUS - hertz_overlap()


def slide(folder, mesh: SurfaceMesh, centre, velocity, outward, **rest) -> dict[str, np.ndarray]:
    """Ledger in the body's frame of a pressed sphere on a mesh, see `pressed_sphere` and `ledger_cases.write_case`."""
    particles, motion = pressed_sphere(centre, velocity, outward)
    ledger = run_case(folder, mesh, particles, motion, domain=DOMAIN, **rest)
    return columns_of_solver(ledger.columns, stl_corners(mesh.points, mesh.triangles))
