"""Draw the transfer chute of docs/tutorial_chute.md as STEP: python -m bulkwear.meshes.transfer.draw FOLDER

transfer.step has four bodies with names: an upright impact plate, a liner of 45 degrees and two side walls;
transfer_steep.step has the same with a steeper liner. Plate and liner are 30 mm thick. Lengths are in mm, z is up, the
belt throws along x from (-100, 0, 0).
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from bulkwear.meshes.drawing import prism, write_step
from bulkwear.meshes.gmsh_model import gmsh_model

THICKNESS = 30.0  # mm, of plate and liner
SLOPES = {"transfer.step": 1.0, "transfer_steep.step": 1.1}  # -, fall of the liner over its length


def draw(path: Path, slope: float) -> None:
    """Write the chute whose liner falls by `slope` per length."""
    s, c = (THICKNESS * f(math.atan(slope)) for f in (math.sin, math.cos))
    foot = 500.0 + 600.0 * slope
    with gmsh_model() as gmsh:
        plate = [(400, -490), (400 + THICKNESS, -490), (400 + THICKNESS, 150), (400, 150)]
        names = {prism(gmsh, plate, -250, 250): "impact_plate"}
        corners = [(432, -500), (432 + s, -500 - c), (-168 + s, -foot - c), (-168, -foot)]
        names[prism(gmsh, corners, -250, 250)] = "liner"
        for y, name in ((-271, "left_wall"), (251, "right_wall")):
            names[prism(gmsh, [(-200, -1200), (500, -1200), (500, 200), (-200, 200)], y, y + 20)] = name
        write_step(gmsh, path, names)


def main(folder: Path) -> None:
    """Write both drawings into a folder, which is made if need be."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, slope in SLOPES.items():
        draw(folder / name, slope)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
