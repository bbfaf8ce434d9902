"""Draw the liner of the tumbling mill of the study `mill` as STEP: python meshes/mill/draw.py FOLDER

liner.step has one open shell, plates and lifters in one surface, of a slice of the mill: it ends with the slice,
which is periodic, and its back is not drawn. Lengths are in mm; the mill's axis is y, z is up, the slice lies about y
= 0.

The mill is that of the Lethabo power station in Kalala (2008), which Ansys Rocky's verification manual (2.3, Tumbling
Mill Wear Model) takes too: diameter 4,267 mm, balls of 50 mm, 15.7 rpm. Number and shape of its lifters were not
found in what is open. They are assumed after a guideline for cast liners of one wave, for balls of 50 mm and more
(911metallurgist.com, ball mill liners): 6.6 lifters per metre of diameter, plates of 50 to 65 mm, crests 60 to 75 mm
above them. Faces stand as on the new lifters of the Sarcheshmeh SAG mill (Yahyaei and Banisi 2010), both alike as the
mill may be turned either way.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from bulkwear.meshes.drawing import write_step
from bulkwear.meshes.gmsh_model import gmsh_model

RADIUS = 4267.0 / 2.0  # mm, of the faces of the shell plates
LIFTERS = 28  # -, 6.6 per metre of diameter
HEIGHT = 65.0  # mm, of a crest above the plates; as thick as a plate, so that one depth may be worn off both
CREST = 80.0  # mm, width of the flat top: more than a ball
FACE_ANGLE = math.radians(14.0)  # of a lifter's faces to the radius
SLICE = 200.0  # mm along the axis: four balls


def lifter_corners(number: int) -> list[tuple[float, float]]:
    """The four corners (x, z) of a lifter, in the sense of a rotation from z to x: foot, crest, crest, foot."""
    foot = CREST / 2.0 + HEIGHT * math.tan(FACE_ANGLE)
    inside = RADIUS - HEIGHT
    corners = [(math.sqrt(RADIUS**2 - foot**2), -foot), (inside, -CREST / 2.0)]
    corners += [(inside, CREST / 2.0), (math.sqrt(RADIUS**2 - foot**2), foot)]
    angle = 2.0 * math.pi * number / LIFTERS
    return [
        (out * math.sin(angle) + ahead * math.cos(angle), out * math.cos(angle) - ahead * math.sin(angle))
        for out, ahead in corners
    ]


def draw_profile(gmsh) -> list[int]:
    """Tags of the curves of the liner's section at the low end of the slice: lines round lifters, and arcs between."""
    occ = gmsh.model.occ
    middle = occ.addPoint(0.0, -SLICE / 2.0, 0.0)
    points = [[occ.addPoint(x, -SLICE / 2.0, z) for x, z in lifter_corners(k)] for k in range(LIFTERS)]
    curves = []
    for k, each in enumerate(points):
        curves += [occ.addLine(each[j], each[j + 1]) for j in range(3)]
        curves.append(occ.addCircleArc(each[3], middle, points[(k + 1) % LIFTERS][0]))
    return curves


def main(folder: Path) -> None:
    """Write all drawings into a folder, which is made if need be."""
    folder.mkdir(parents=True, exist_ok=True)
    with gmsh_model() as gmsh:
        gmsh.model.occ.extrude([(1, curve) for curve in draw_profile(gmsh)], 0.0, SLICE, 0.0)
        write_step(gmsh, folder / "liner.step", {})


if __name__ == "__main__":
    main(Path(sys.argv[1]))
