"""Check of drums with their drawings: they turn about an axis near their middle.

A drum is what goes all the way round a room in its middle: a mill's shell, a kiln. Nothing is said of other parts: a
hammer or a lifter that is drawn alone turns about an axis outside of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.wear.bodies import together
from bulkwear.workflows.cases.equipment.bodies import closed_faces, is_within
from bulkwear.workflows.cases.equipment.motions import stands_s
from bulkwear.workflows.cases.equipment.plane_cuts import SectionPlane, cut
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.config.run_checks import millimetres

TURNING = ("rotation", "turning_surface")  # kinds of motion about an axis for good
OFF_MIDDLE = 0.5  # -, of the way from a drum's middle to its outside: blenders of two legs turn a little off theirs
UPRIGHT = 0.7  # -, z of the unit axis: pots of a centrifuge go round such an axis outside of them
DIRECTIONS = 72  # in which a drum is looked for round its middle

Part = Mapping[str, Any]


def check_drums(parts: Sequence[Part], meshes: Sequence[SurfaceMesh]) -> None:
    """Raise ConfigError for a drum whose axis lies outside of it, or far off its middle.

    meshes: the surface of each part. Parts that move alike are one drum.
    """
    for named, mesh in _turning_together(parts, meshes):
        motion = named["motion"]
        axis = np.asarray(motion["axis"], dtype=np.float64) / np.linalg.norm(motion["axis"])
        if abs(axis[2]) > UPRIGHT:
            continue
        plane = _middle_plane(mesh, axis)
        off = plane.places(np.asarray(motion["point_m"]))
        away = float(np.linalg.norm(off))
        most = OFF_MIDDLE * float((plane.places(mesh.points) @ off).max()) / away if away else math.inf
        if away > most and _goes_round(mesh, plane):
            point, middle = (", ".join(f"{1e3 * x + 0.0:.6g}" for x in at) for at in (motion["point_m"], plane.place))
            raise ConfigError(
                f"parts.{named['name']}.motion.point_mm is ({point}) mm, {millimetres(away)} off the middle of"
                f" {named['file']}, allowed is an axis at most {millimetres(most)} off it, as through ({middle}) mm:"
                " a drum turns about its middle."
            )


def _turning_together(parts: Sequence[Part], meshes: Sequence[SurfaceMesh]) -> Iterator[tuple[Part, SurfaceMesh]]:
    """Yield parts that turn for good, those with one motion as one surface under the name of the first."""
    turning = [k for k, part in enumerate(parts) if part["motion"] and part["motion"]["kind"] in TURNING]
    turning = [k for k in turning if math.isinf(stands_s(parts[k]["motion"]))]
    while turning:
        alike = [k for k in turning if parts[k]["motion"] == parts[turning[0]]["motion"]]
        yield parts[turning[0]], together([meshes[k] for k in alike])
        turning = [k for k in turning if k not in alike]


def _middle_plane(mesh: SurfaceMesh, axis: np.ndarray) -> SectionPlane:
    """Return the plane square to a unit axis (3,) whose place is the middle of a surface."""
    along = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    along /= np.linalg.norm(along)
    frame = np.array([along, np.cross(axis, along), axis])
    seen = mesh.points @ frame.T
    return SectionPlane(0.5 * (seen.min(axis=0) + seen.max(axis=0)) @ frame, frame[0], frame[1])


def _goes_round(mesh: SurfaceMesh, plane: SectionPlane) -> bool:
    """Return whether a plane's place is no steel, and the surface is seen from there in all directions of the plane."""
    if is_within(mesh.points, mesh.triangles[closed_faces(mesh.triangles)], plane.place):
        return False
    lines = cut(mesh, plane)[0]
    begin, end = np.arctan2(lines[:, :, 1], lines[:, :, 0]).T
    turn = (end - begin + math.pi) % (2.0 * math.pi) - math.pi
    looks = np.linspace(-math.pi, math.pi, DIRECTIONS, endpoint=False)
    ahead = np.where(turn >= 0.0, looks[:, None] - begin, begin - looks[:, None]) % (2.0 * math.pi)
    return bool((ahead <= np.abs(turn)).any(axis=1).all())
