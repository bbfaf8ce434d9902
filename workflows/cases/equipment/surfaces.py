"""The surface of a machine: all its parts as one, each in the frame it was drawn in."""

from __future__ import annotations

import math
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bulkwear.meshes.own.solids import NoSuchPartError
from bulkwear.postproc.mesh import SurfaceMesh, areas
from bulkwear.postproc.wear.bodies import body, together
from bulkwear.workflows.cases.equipment.drawings import check_solid, drawing
from bulkwear.workflows.cases.equipment.motions import motion_of, turn_s
from bulkwear.workflows.config.layers import ConfigError

if TYPE_CHECKING:
    from bulkwear.meshes.own.mesh import OwnMesh

POSES = 64  # of a moving part in a run, and in a turn, of which the room that it needs is made
ALIKE = 1e-6  # relative, areas of a part's two ends
FEED_CELLS = 8  # along each side of an inlet; still as large as a particle where it is eight particles wide
TOLD = ("facets turned round", "warning")  # repairs of a drawing that its owner should know of
PLACES = ("the whole of its motion", "where it stands")

Part = Mapping[str, Any]


def label_of(number: int, part: Part) -> int:
    """Return the label `part` of the faces of the part with that number: below 0 where it keeps its shape."""
    return number if part["wears"] else -1 - number


def machine_surface(parts: Sequence[Part]) -> SurfaceMesh:
    """Return all parts as one surface with cell data `part`, see `label_of`. Raises ConfigError.

    A body of a file that is several parts of the same unit and edge is meshed once.
    """
    from bulkwear.meshes.own.mesh import own_mesh  # slow to import, and few jobs make meshes

    meshed = cache(own_mesh)
    with tempfile.TemporaryDirectory() as folder:
        return together([part_surface(number, part, Path(folder), meshed) for number, part in enumerate(parts)])


def part_surface(number: int, part: Part, folder: Path, meshed: Callable[..., OwnMesh]) -> SurfaceMesh:
    """Return a part as the solver takes it; drawings that a script makes go into the folder. Raises ConfigError.

    meshed: `own_mesh`, or what remembers its meshes. Of the bodies of a drawing only the solid that is named is meshed.
    """
    name = f"parts.{part['name']}"
    try:
        found = meshed(drawing(part["file"], folder), part["unit"], part["edge_m"], solid=part.get("solid"))
    except NoSuchPartError as fault:
        check_solid(part, fault.names)
        raise
    except (ValueError, OSError) as fault:
        words = str(fault).removesuffix(".")
        raise ConfigError(f"{name}: {words}.") from fault
    surface = found.surface
    for repair in found.repairs:
        if repair.repair.startswith(TOLD):
            place = ", ".join(f"{1e3 * value:.4g}" for value in repair.place_m)
            words = f"{repair.repair}, {repair.count} times, the first at ({place}) mm"
            print(f"{name}: {part['file']}, {repair.part}: {words}.", file=sys.stderr)
    labels = np.full(len(surface.triangles), label_of(number, part), dtype=np.int64)
    return SurfaceMesh(surface.points, surface.triangles, {"part": labels})


def on_ends(surface: SurfaceMesh, run: Mapping[str, Any]) -> SurfaceMesh:
    """Return the surface with the nodes that are within the weld tolerance of an end of a slice put on it.

    Coordinates of single precision, as of binary STL, miss an end by their rounding.
    """
    if not run["periodic"]:
        return surface
    from bulkwear.meshes.own.weld import weld_tolerance  # slow to import, and few machines are slices

    points, axis = surface.points.copy(), "xyz".index(run["periodic"]["axis"])
    for number, part in enumerate(run["parts"]):
        nodes = np.unique(surface.triangles[faces_of(surface, number, part)])
        tolerance = weld_tolerance(points[nodes])
        for end in (run["periodic"]["low_m"], run["periodic"]["high_m"]):
            points[nodes[np.abs(points[nodes, axis] - end) <= tolerance], axis] = end
    return replace(surface, points=points)


def open_ends(surface: SurfaceMesh, run: Mapping[str, Any]) -> SurfaceMesh:
    """Return the surface without the faces by which parts end at both ends of a slice: there they go on in its image.

    The solver takes such faces for one another's images and refuses them. A part that reaches one end only keeps its
    face there, which can be touched.
    """
    if not run["periodic"]:
        return surface
    from bulkwear.postproc.wear.directions import ON_END  # slow to import, and few machines are slices

    along = surface.points[surface.triangles][:, :, "xyz".index(run["periodic"]["axis"])]
    at_ends = [np.abs(along - run["periodic"][end]).max(axis=1) < ON_END for end in ("low_m", "high_m")]
    size, kept = areas(surface.points, surface.triangles), np.ones(len(along), dtype=bool)
    for number, part in enumerate(run["parts"]):
        ends = [faces_of(surface, number, part) & there for there in at_ends]
        low, high = (size[faces].sum() for faces in ends)
        if low > 0.0 and math.isclose(low, high, rel_tol=ALIKE):
            kept &= ~(ends[0] | ends[1])
    return surface if kept.all() else body(surface, kept)


def faces_of(surface: SurfaceMesh, number: int, part: Part) -> np.ndarray:
    """Return the mask (m,) of the faces of the part with that number."""
    return surface.cell_data["part"] == label_of(number, part)


def room_needed(points: np.ndarray, part: Part, duration_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest and the highest corner (3,) m of where a part is at any time up to the duration (s)."""
    motion = motion_of(part["motion"])
    placed = [motion.placed(points, time) for time in looks(part["motion"], duration_s)]
    return np.min([each.min(axis=0) for each in placed], axis=0), np.max([each.max(axis=0) for each in placed], axis=0)


def looks(given: Mapping[str, Any] | None, duration_s: float) -> np.ndarray:
    """Return times (s) at which a part is looked at: all along, and through its first turn or period at full speed."""
    if given is None:
        return np.zeros(1)
    begin = given.get("start_s", 0.0) + given.get("ramp_s", 0.0)
    turn = begin + turn_s(given) * np.linspace(0.0, 1.0, POSES)
    return np.concatenate([np.linspace(0.0, duration_s, POSES), turn[turn < duration_s]])


def feed_face(given: Mapping[str, Any], seed: int, cycle: int) -> SurfaceMesh:
    """Return an inlet as small triangles, in an order of its own for every seed and cycle.

    The solver draws a triangle and a place in it by random numbers that begin alike whenever it starts, whatever the
    seed of the feed is (LIGGGHTS 3.8.0, src/multi_node_mesh_I.h). In another order they are other places.
    """
    corners, rng = rectangle(given).points, np.random.default_rng([seed, cycle])
    across, along = np.meshgrid(*[np.linspace(0.0, 1.0, FEED_CELLS + 1)] * 2)
    sides = corners[[1, 3]] - corners[0]
    points = corners[0] + across.reshape(-1, 1) * sides[0] + along.reshape(-1, 1) * sides[1]
    first = (np.arange(FEED_CELLS)[:, None] * (FEED_CELLS + 1) + np.arange(FEED_CELLS)).reshape(-1, 1)
    cells = first + np.array([0, 1, FEED_CELLS + 2, 0, FEED_CELLS + 2, FEED_CELLS + 1])
    triangles = rng.permutation(cells.reshape(-1, 3))
    begin = (np.arange(3) + rng.integers(3, size=(len(triangles), 1))) % 3
    return SurfaceMesh(points, np.take_along_axis(triangles, begin, axis=1))


def rectangle(given: Mapping[str, Any]) -> SurfaceMesh:
    """Return the two triangles of an inlet or an outlet, which look whither the material goes.

    Its first side is horizontal; of a horizontal rectangle along x. Raises ValueError for a normal without length.
    """
    normal = np.asarray(given["normal"], dtype=np.float64)
    length = np.linalg.norm(normal)
    if not length > 0.0:
        raise ValueError("a normal of (0, 0, 0)")
    normal = normal / length
    first = np.cross((0.0, 0.0, 1.0), normal)
    first = np.array([1.0, 0.0, 0.0]) if np.linalg.norm(first) < 1e-9 else first / np.linalg.norm(first)
    second = np.cross(normal, first)
    half = 0.5 * np.asarray(given["size_m"])
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
    points = np.asarray(given["centre_m"]) + signs @ np.array([first, second])
    return SurfaceMesh(points, np.array([[0, 1, 2], [0, 2, 3]]))
