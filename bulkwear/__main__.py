"""Make a project, or a surface for the solver of CAD and mesh files.

python -m bulkwear project DIR
python -m bulkwear mesh chute.step --unit mm --edge 10 -o chute.vtu
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bulkwear.meshes.own.mesh import OwnMesh

UNSAFE = r"[^\w.-]+"  # characters of a part's name that are none of a file's
LENGTHS = "lengths are in the unit of the files"


def main(words: list[str] | None = None) -> int:
    """Do what the command line says; 1, with a sentence, where it cannot be done."""
    given = _parser().parse_args(words)
    try:
        print(given.do(given))
    except (ValueError, FileNotFoundError) as fault:
        print(fault, file=sys.stderr)
        return 1
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m bulkwear", description=(__doc__ or "").splitlines()[0])
    commands = parser.add_subparsers(required=True)
    project = commands.add_parser("project", help="make a project: a folder with a small study that works")
    project.add_argument("folder", type=Path, metavar="DIR")
    project.set_defaults(do=_project)
    mesh = commands.add_parser("mesh", help="make a surface of CAD and mesh files", description=f"{LENGTHS}.")
    mesh.add_argument(
        "files", nargs="+", type=Path, metavar="FILE", help="STL, STEP, IGES, BREP, OBJ, PLY, VTK, VTU, MSH"
    )
    mesh.add_argument("--unit", required=True, help="of the files: m, cm, mm, um, in, ft")
    mesh.add_argument(
        "--edge", action="append", default=[], metavar="[PART=]LENGTH", help="target edge, of a part or all"
    )
    mesh.add_argument(
        "--ball",
        action="append",
        default=[],
        nargs=5,
        type=float,
        metavar=("X", "Y", "Z", "RADIUS", "EDGE"),
        help="where it shall be finer",
    )
    mesh.add_argument("--weld", type=float, metavar="LENGTH", help="points closer than that are one")
    mesh.add_argument("--angle", type=float, metavar="DEGREES", help="wanted smallest angle")
    mesh.add_argument("-o", "--output", type=Path, metavar="VTU", help="surface for a study")
    mesh.add_argument(
        "--stl",
        type=Path,
        metavar="STL",
        help="the same for LIGGGHTS, in m; a file per part where it refuses them together",
    )
    mesh.set_defaults(do=_mesh)
    return parser


def _project(given: argparse.Namespace) -> str:
    from bulkwear.workflows.environment.new_project import make_project

    return make_project(given.folder)


def _mesh(given: argparse.Namespace) -> str:
    """Write the surface that the command line asks for; its tables. A refused one is drawn beside it."""
    from bulkwear.meshes.own.mesh import own_mesh
    from bulkwear.meshes.own.refine import WANTED_ANGLE, Ball
    from bulkwear.meshes.own.solids import RefusedMeshError, metres_per
    from bulkwear.postproc.mesh import write_surface

    scale = metres_per(given.unit)
    balls = [Ball((x * scale, y * scale, z * scale), r * scale, edge * scale) for x, y, z, r, edge in given.ball]
    weld = None if given.weld is None else given.weld * scale
    angle = WANTED_ANGLE if given.angle is None else given.angle
    try:
        found = own_mesh(given.files, given.unit, _edges(given.edge, scale), balls, weld, angle)
    except RefusedMeshError as fault:
        from bulkwear.postproc.plots.fault import save_fault

        picture = (given.output or given.files[0]).with_suffix(".fault.png").name
        picture = (given.output.parent if given.output else Path()) / picture
        save_fault(picture, fault.surface, fault.faces, fault.place, str(fault))
        raise ValueError(f"{fault}. Its picture is {picture}") from fault
    if given.output:
        write_surface(given.output, found.surface)
    if given.stl:
        _write_stl(given.stl, found)
    return found.text()


def _write_stl(path: Path, found: OwnMesh) -> None:
    """Write a surface for the solver, a file per part where it would refuse them in one mesh."""
    from bulkwear.postproc.mesh import write_stl

    points, triangles, part = found.surface.points, found.surface.triangles, found.surface.cell_data["part"]
    if found.one_mesh:
        write_stl(path, points, triangles)
        return
    for number, each in enumerate(found.parts):
        name = f"{path.stem}_{re.sub(UNSAFE, '_', each.name)}"
        write_stl(path.with_name(name + path.suffix), points, triangles[part == number])


def _edges(words: list[str], scale: float) -> dict[str, float] | None:
    """Target edges (m) by part, from words `LENGTH` and `PART=LENGTH`."""
    result = {}
    for word in words:
        name, _, length = word.rpartition("=")
        try:
            result[name or "*"] = float(length) * scale
        except ValueError as fault:
            raise ValueError(f"--edge is '{word}', allowed is a length or a part's name, '=', and a length") from fault
    return result or None


if __name__ == "__main__":
    sys.exit(main())
