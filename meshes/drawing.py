"""What the drawing scripts of studies share: prisms, and STEP files whose bodies have names."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

DATE = re.compile(r"(FILE_NAME\([^)]*?)'\d{4}-\d\d-\d\dT[\d:]+'", re.DOTALL)
NAMELESS = (
    r"'Open CASCADE STEP translator [\d.]+ \d+{}'"  # as OpenCASCADE calls the only body, or the k-th of file n: n.k
)


def prism(gmsh, corners: Sequence[tuple[float, float]], low: float, high: float) -> int:
    """Tag of a prism: a polygon (x, z) from y = low to y = high, in the lengths of the drawing."""
    occ = gmsh.model.occ
    points = [occ.addPoint(x, low, z) for x, z in corners]
    lines = [occ.addLine(points[k - 1], points[k]) for k in range(len(points))]
    face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
    (body,) = (tag for dimension, tag in occ.extrude([(2, face)], 0.0, high - low, 0.0) if dimension == 3)
    return body


def write_step(gmsh, path: Path, names: Mapping[int, str]) -> None:
    """Write the bodies of the model as STEP, in mm, with their names by tag; equal drawings give equal files.

    What construction left beside them is dropped. Without bodies, faces are written, and no name is needed. Raises
    ValueError where a body has no name.
    """
    gmsh.model.occ.synchronize()
    bodies = sorted(tag for _, tag in gmsh.model.getEntities(3))
    if bodies != sorted(names):
        raise ValueError(f"{path}: the drawing has the bodies {bodies}, names are given for {sorted(names)}")
    shapes = path.with_suffix(".brep")
    gmsh.write(str(shapes))
    gmsh.model.add("bodies")
    gmsh.model.occ.importShapes(str(shapes), highestDimOnly=True)
    shapes.unlink()
    gmsh.model.occ.synchronize()
    gmsh.write(str(path))
    text = DATE.sub(r"\1'1970-01-01T00:00:00'", path.read_text(encoding="latin-1"))
    for number, tag in enumerate(bodies, start=1):
        place = rf"\.{number}" if len(bodies) > 1 else ""
        text = re.sub(NAMELESS.format(place), f"'{names[tag]}'", text)
    path.write_text(text, encoding="latin-1")
