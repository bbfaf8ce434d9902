"""Draw the test rig of the study `which_law` as STEP files: python meshes/which_law/draw.py FOLDER

A level stream hits an upright plate, plate_90.step to plate_15.step by the angle between stream and surface, and falls
on to a slope, slide.step, in a hood that is open below, walls.step. Upright plates keep no bed, whatever the angle.
Lengths are in mm; x is the direction of the stream, whose middle leaves the inlet at the origin, and z is up.
"""

from __future__ import annotations

import math
import sys
from functools import partial
from pathlib import Path

from bulkwear.meshes.drawing import prism, write_step
from bulkwear.meshes.gmsh_model import gmsh_model

ANGLES = (90, 60, 30, 15)  # degrees; Oka's law wears most near 30, Finnie's near 17
GAP = 0.3  # mm between two bodies
WALL = 20.0  # mm, thickness of the hood
BACK, FRONT, TOP, BOTTOM, SIDE = -300.0, 700.0, 200.0, -1200.0, 300.0  # mm, inner faces of the hood
PLATE_MIDDLE = 250.0  # mm from the inlet: 0.03 s at 8 m/s, in which the stream falls 5 mm
PLATE_LENGTH, PLATE_HEIGHT, PLATE_THICKNESS = 480.0, 300.0, 20.0  # mm; 80 mm of stream at 15 degrees hit 309 mm
SLIDE_TOP, SLIDE_LENGTH, SLIDE_THICKNESS = -400.0, 980.0, 20.0  # mm: its end leaves an opening
SLIDE_SLOPE = math.radians(45.0)  # twice the angle of friction of steel and ore


def draw_plate(gmsh, angle_deg: float) -> int:
    """Tag of the plate whose front face the stream hits at an angle (degrees)."""
    occ = gmsh.model.occ
    half = PLATE_LENGTH / 2.0
    body = occ.addBox(0.0, -half, -PLATE_HEIGHT / 2.0, PLATE_THICKNESS, PLATE_LENGTH, PLATE_HEIGHT)
    occ.rotate([(3, body)], 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, math.radians(angle_deg - 90.0))
    occ.translate([(3, body)], PLATE_MIDDLE, 0.0, 0.0)
    return body


def draw_slide(gmsh) -> int:
    """Tag of the slope, down from the front wall; its upper end is upright."""
    along, down = SLIDE_LENGTH * math.cos(SLIDE_SLOPE), SLIDE_LENGTH * math.sin(SLIDE_SLOPE)
    below = SLIDE_THICKNESS / math.cos(SLIDE_SLOPE)  # of the lower face, along z
    right = FRONT - GAP
    corners = [(right, SLIDE_TOP), (right - along, SLIDE_TOP - down)]
    corners += [(right - along, SLIDE_TOP - down - below), (right, SLIDE_TOP - below)]
    return prism(gmsh, corners, -SIDE + GAP, SIDE - GAP)


def draw_walls(gmsh) -> int:
    """Tag of the hood."""
    outer = [(BACK - WALL, BOTTOM), (BACK - WALL, TOP + WALL), (FRONT + WALL, TOP + WALL), (FRONT + WALL, BOTTOM)]
    inner = [(BACK, BOTTOM - 1.0), (BACK, TOP), (FRONT, TOP), (FRONT, BOTTOM - 1.0)]  # the lower side stays open
    full, room = prism(gmsh, outer, -SIDE - WALL, SIDE + WALL), prism(gmsh, inner, -SIDE, SIDE)
    ((_, walls),), _ = gmsh.model.occ.cut([(3, full)], [(3, room)])
    return walls


def main(folder: Path) -> None:
    """Write all drawings into a folder, which is made if need be."""
    folder.mkdir(parents=True, exist_ok=True)
    bodies = {"walls": draw_walls, "slide": draw_slide}
    bodies |= {f"plate_{angle}": partial(draw_plate, angle_deg=angle) for angle in ANGLES}
    for name, draw in bodies.items():
        with gmsh_model() as gmsh:
            write_step(gmsh, folder / f"{name}.step", {draw(gmsh): name})


if __name__ == "__main__":
    main(Path(sys.argv[1]))
