"""Draw the transfer chute of the study `chute` as STEP files: python meshes/chute/draw.py FOLDER

walls.step is a hood that is open below; impact_plate.step, liner_plain.step, liner_r5.step and liner_r9.step are what
wears. Each file has one body, which stands where it is drawn. Lengths are in mm; x is the travel of the belt that
throws the ore off, z is up, and the origin is the middle of the stream where it leaves the head pulley.

A stream of 420 x 300 mm flies 0.6 m to the impact plate, falls along it, and lands 1 m below the belt on a liner of
45 degrees, which turns it back: iron ore on steel (friction 0.38, an angle of 21 degrees) does not come to rest
there. Bodies are 0.3 mm apart: nothing touches, no particle gets in between. No edge of the walls stands out into the
flow, as one that ploughs the stream falsifies the wear beside it.

The patterns are R5 and R9 of Yan 2022 (Table 3.8), enlarged from the source's gravel to this ore, so that particle
over bump is what it was there: an equivalent size ratio (Eq 4.18) of 0.29 (R5) and 0.36 (R9) at particle scale 1. Not
enlarged it would be 1.1 and 1.4, where the source finds no gain, and with coarse grains several times that. Enlarged
it is 0.9 and 1.1 at scale 3, 1.4 and 1.8 at scale 5; in our own runs R5 helps up to about 2.5
(docs/particle_size.md).
"""

from __future__ import annotations

import math
import sys
from functools import partial
from pathlib import Path

from bulkwear.meshes.drawing import prism, write_step
from bulkwear.meshes.gmsh_model import gmsh_model

GAP = 0.3  # mm between two bodies: far below 0.3 radii of any particle, far above the weld tolerance
WIDTH = 500.0  # mm between the side walls: the stream and 40 mm to each side
WALL = 20.0  # mm, thickness of the walls, above any overlap of a particle with them
BACK, TOP, BOTTOM = -700.0, 350.0, -1950.0  # mm, inner faces: room for the stream that comes in, and below the liner
PLATE_FACE = 600.0  # mm, x of the impact plate: 0.2 s from the belt at 3 m/s
PLATE_TOP, PLATE_BOTTOM = 150.0, -700.0  # mm: the stream hits between -50 and -450
PLATE_THICKNESS = 30.0  # mm, as the liner: usual plates of wear-resistant steel are 12 to 40 mm
LINER_TOP = -1000.0  # mm, z of the liner's upper edge: 1 m below the belt
LINER_LENGTH, LINER_THICKNESS = 1000.0, 30.0  # mm, along the slope, and normal to it
LINER_ANGLE = math.radians(45.0)  # twice the angle of friction
ENLARGED = 10.0 / 2.65  # -, median diameters of the ore and of the source's gravel
PATTERNS = {  # mm, of the source: radius along the flow a, across it b, height h, columns d apart in a row
    "r5": (4.0, 8.0, 6.0, 60.0),
    "r9": (8.0, 2.0, 6.0, 20.0),
}
ROWS = 20.0  # mm, of the source: from one row to the next, the shifted one: c / 2 with c = 40 mm
RIM = 2.0  # mm left between a bump and the liner's rim, so that elements fit there


def bump_radii(pattern: str) -> tuple[float, float, float]:
    """Radii along and across the flow and height of a bump on the liner, mm."""
    along, across, height, _ = PATTERNS[pattern]
    return ENLARGED * along, ENLARGED * across, ENLARGED * height


def bump_places(pattern: str) -> list[tuple[float, float]]:
    """Middles of the bumps: way down the slope from the liner's upper edge and y, mm.

    Rows are centred in the length; their bumps stand a quarter column off the middle, in every second one to the other
    side, so that all rows have as many.
    """
    along, across, _ = bump_radii(pattern)
    column, row = ENLARGED * PATTERNS[pattern][3], ENLARGED * ROWS
    rows = 1 + math.floor((LINER_LENGTH - 2.0 * (along + RIM)) / row)
    room = WIDTH / 2.0 - GAP - RIM - across
    reach = math.ceil(room / column)
    places = []
    for k in range(rows):
        down = LINER_LENGTH / 2.0 + (k - (rows - 1) / 2.0) * row
        ys = [(j + (0.25 if k % 2 else -0.25)) * column for j in range(-reach, reach + 1)]
        places += [(down, y) for y in ys if abs(y) <= room]
    return places


def draw_bump(gmsh, radii: tuple[float, float, float]) -> tuple[int, int]:
    """A bump on the plane z = 0, x up the slope, of two halves: its crest gets nodes, and all bumps the same ones."""
    occ, right_angle = gmsh.model.occ, math.pi / 2.0
    halves = [(3, occ.addSphere(0.0, 0.0, 0.0, 1.0, angle3=right_angle)) for _ in range(2)]  # y above 0, poles on z
    occ.rotate(halves[1:], 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, right_angle)
    occ.rotate(halves, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, right_angle)  # z above 0, poles on y
    occ.rotate(halves, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, right_angle)
    gmsh.option.setNumber("Geometry.OCCUnionUnify", 0)  # keeps the edges along the crest
    (bump,), _ = occ.fuse(halves[:1], halves[1:])
    occ.dilate([bump], 0.0, 0.0, 0.0, *radii)
    return bump


def with_bumps(
    gmsh, plate: tuple[int, int], bump: tuple[int, int], places: list[tuple[float, float]]
) -> tuple[int, int]:
    """A plate whose top lies in z = 0, with copies of a bump on it: of their faces, as a union would take minutes."""
    occ, model = gmsh.model.occ, gmsh.model
    bumps = []
    for down, y in places:
        bumps += occ.copy([bump])
        occ.translate(bumps[-1:], -down, y, 0.0)
    occ.remove([bump], recursive=True)
    occ.synchronize()
    flat, kept, rims = [], [], []
    for solid in (plate, *bumps):
        faces = model.getBoundary([solid], oriented=False)
        level = [
            face for face in faces if abs(model.getBoundingBox(*face)[2]) + abs(model.getBoundingBox(*face)[5]) < GAP
        ]
        rims.append(occ.addCurveLoop([tag for _, tag in model.getBoundary(level, oriented=False)]))
        flat += level
        kept += [tag for _, tag in faces if (2, tag) not in level]
    occ.remove([plate, *bumps])
    occ.remove(flat)
    kept.append(occ.addPlaneSurface(rims))
    body = 3, occ.addVolume([occ.addSurfaceLoop(kept)])
    occ.remove([(2, face) for face in kept])
    return body


def draw_liner(gmsh, pattern: str | None) -> int:
    """Tag of the liner, plain or with the bumps of a pattern; its upper end is upright, along the front wall."""
    occ = gmsh.model.occ
    behind = LINER_THICKNESS * math.tan(LINER_ANGLE)  # the upper end leans over the back by this
    corners = [(0.0, 0.0), (-LINER_LENGTH, 0.0), (-LINER_LENGTH, -LINER_THICKNESS), (-behind, -LINER_THICKNESS)]
    half = WIDTH / 2.0 - GAP
    body = (3, prism(gmsh, corners, -half, half))  # flat, x up the slope, z normal to it
    if pattern is not None:
        body = with_bumps(gmsh, body, draw_bump(gmsh, bump_radii(pattern)), bump_places(pattern))
    occ.rotate([body], 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -LINER_ANGLE)
    occ.translate([body], PLATE_FACE + PLATE_THICKNESS, 0.0, LINER_TOP)
    return body[1]


def draw_walls(gmsh) -> int:
    """Tag of the hood; the impact plate hangs in a step of its front wall, a gap proud of the wall above."""
    behind = PLATE_FACE + PLATE_THICKNESS + GAP
    inside = [(BACK, BOTTOM - 1.0), (BACK, TOP), (PLATE_FACE + GAP, TOP), (PLATE_FACE + GAP, PLATE_TOP + GAP)]
    inside += [(behind, PLATE_TOP + GAP), (behind, BOTTOM - 1.0)]  # beyond the bottom: that side stays open
    outside = [(BACK - WALL, BOTTOM), (BACK - WALL, TOP + WALL), (behind + WALL, TOP + WALL), (behind + WALL, BOTTOM)]
    full = prism(gmsh, outside, -WIDTH / 2.0 - WALL, WIDTH / 2.0 + WALL)
    room = prism(gmsh, inside, -WIDTH / 2.0, WIDTH / 2.0)
    ((_, walls),), _ = gmsh.model.occ.cut([(3, full)], [(3, room)])
    return walls


def draw_plate(gmsh) -> int:
    """Tag of the impact plate."""
    half, height = WIDTH / 2.0 - GAP, PLATE_TOP - PLATE_BOTTOM
    return gmsh.model.occ.addBox(PLATE_FACE, -half, PLATE_BOTTOM, PLATE_THICKNESS, 2.0 * half, height)


def main(folder: Path) -> None:
    """Write all drawings into a folder, which is made if need be."""
    folder.mkdir(parents=True, exist_ok=True)
    bodies = {"walls": draw_walls, "impact_plate": draw_plate, "liner_plain": partial(draw_liner, pattern=None)}
    bodies |= {f"liner_{pattern}": partial(draw_liner, pattern=pattern) for pattern in PATTERNS}
    for name, draw in bodies.items():
        with gmsh_model() as gmsh:
            write_step(gmsh, folder / f"{name}.step", {draw(gmsh): name})


if __name__ == "__main__":
    main(Path(sys.argv[1]))
