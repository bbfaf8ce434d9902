"""Draw the screw feeder of the study `screw` as STEP files: python meshes/screw/draw.py FOLDER

screw.step is a shaft with a right-handed flight; trough.step is a U with a lid, a hopper over its beginning and a
spout under its end, both open. Lengths are in mm; the axis is x, material goes to +x as the screw turns left-handed
about it, z is up.

Flight and trough are 1.5 mm apart, less than 0.3 radii of particles of 12 mm and more (the smallest of a 10 mm ore at
particle scale 1.5): none gets in between and jams. Above the flight there are 60 mm, 1.5 diameters of particles of 40
mm.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from bulkwear.meshes.drawing import write_step
from bulkwear.meshes.gmsh_model import gmsh_model

RADIUS, SHAFT_RADIUS = 100.0, 30.0  # mm, of flight and shaft
PITCH, TURNS = 160.0, 3  # mm, 0.8 diameters, as feeders have; turns of the flight
FLIGHT_THICKNESS = 10.0  # mm along the axis: a flight of heavy duty, so that two elements may stand back to back
FLIGHT_START = 16.5  # mm, x of the flight's middle where it begins: an element from the end of the shaft
SECTIONS_PER_TURN = 24  # of the loft: its edge stays within 2 um of a helix
CLEARANCE = 1.5  # mm between screw and trough, at the flight and at the ends of the shaft
LENGTH = 520.0  # mm, of the trough inside
LID = RADIUS + 60.0  # mm, z of its inner face
WALL = 10.0  # mm, thickness of the trough at least
HOPPER = (10.0, 190.0, 400.0)  # mm: x from, x to, z of its upper end; as wide as the trough
SPOUT = (400.0, LENGTH, -220.0)  # mm: x from, x to, z of its lower end; as wide as the trough, four particles long


def flight_section(gmsh, turn: float) -> int:
    """Tag of the flight's section, as a wire, that many turns after its beginning; it ends within the shaft."""
    occ, angle = gmsh.model.occ, 2.0 * math.pi * turn
    middle = FLIGHT_START + PITCH * turn
    points = [
        occ.addPoint(x, -radius * math.sin(angle), radius * math.cos(angle))
        for x, radius in (
            (middle - FLIGHT_THICKNESS / 2.0, 0.7 * SHAFT_RADIUS),
            (middle - FLIGHT_THICKNESS / 2.0, RADIUS),
            (middle + FLIGHT_THICKNESS / 2.0, RADIUS),
            (middle + FLIGHT_THICKNESS / 2.0, 0.7 * SHAFT_RADIUS),
        )
    ]
    return occ.addWire([occ.addLine(points[k], points[(k + 1) % 4]) for k in range(4)])


def draw_screw(gmsh) -> int:
    """Tag of the screw: shaft and flight in one body."""
    occ = gmsh.model.occ
    sections = [flight_section(gmsh, k / SECTIONS_PER_TURN) for k in range(TURNS * SECTIONS_PER_TURN + 1)]
    flight = [each for each in occ.addThruSections(sections, makeSolid=True) if each[0] == 3]
    shaft = occ.addCylinder(CLEARANCE, 0.0, 0.0, LENGTH - 2.0 * CLEARANCE, 0.0, 0.0, SHAFT_RADIUS)
    ((_, screw),), _ = occ.fuse([(3, shaft)], flight)
    return screw


def draw_trough(gmsh) -> int:
    """Tag of the trough with hopper and spout: a block less its room."""
    occ = gmsh.model.occ
    inside = RADIUS + CLEARANCE

    def box(x: tuple[float, float], z: tuple[float, float], wall: float) -> tuple[int, int]:
        width = 2.0 * (inside + wall)
        return 3, occ.addBox(x[0] - wall, -width / 2.0, z[0], x[1] - x[0] + 2.0 * wall, width, z[1] - z[0])

    (hopper_from, hopper_to, top), (spout_from, spout_to, bottom) = HOPPER, SPOUT
    outside = [box((hopper_from, hopper_to), (0.0, top), WALL), box((spout_from, spout_to), (bottom, 0.0), WALL)]
    room = [box((hopper_from, hopper_to), (0.0, top + 1.0), 0.0), box((spout_from, spout_to), (bottom - 1.0, 0.0), 0.0)]
    room += [box((0.0, LENGTH), (0.0, LID), 0.0), (3, occ.addCylinder(0.0, 0.0, 0.0, LENGTH, 0.0, 0.0, inside))]
    block, _ = occ.fuse([box((0.0, LENGTH), (-inside - WALL, LID + WALL), WALL)], outside)
    ((_, trough),), _ = occ.cut(block, room)
    return trough


def main(folder: Path) -> None:
    """Write all drawings into a folder, which is made if need be."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, draw in {"screw": draw_screw, "trough": draw_trough}.items():
        with gmsh_model() as gmsh:
            write_step(gmsh, folder / f"{name}.step", {draw(gmsh): name})


if __name__ == "__main__":
    main(Path(sys.argv[1]))
