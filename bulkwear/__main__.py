"""Make a project, or a surface for the solver of CAD and mesh files; tell how far a study is.

python -m bulkwear project DIR
python -m bulkwear status [STUDY] [--page]
python -m bulkwear mesh chute.step --unit mm --edge 10 -o chute.vtu
"""

from __future__ import annotations

import argparse
import os
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np

    from bulkwear.meshes.own.mesh import OwnMesh
    from bulkwear.meshes.own.solids import RefusedMeshError
    from bulkwear.postproc.mesh import SurfaceMesh

UNSAFE = r"[^\w.-]+"  # characters of a part's name that are none of a file's
LENGTHS = "lengths are in the unit of the files"


def main(words: list[str] | None = None) -> int:
    """Do what the command line says; 1, with a sentence, where it cannot be done."""
    given = _parser().parse_args(words)
    try:
        print(given.do(given))
    except OSError as fault:  # ours have a sentence, the system's a reason
        reason = f"{fault.filename or 'a file'}: {fault.strerror}, allowed is what can be read and written"
        print(reason if fault.strerror else fault, file=sys.stderr)
        return 1
    except ValueError as fault:
        print(fault, file=sys.stderr)
        return 1
    except MemoryError:
        print("the memory is exhausted, allowed are surfaces of fewer triangles: a longer --edge", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("stopped by Ctrl-C, nothing was written; the same command begins again", file=sys.stderr)
        return 130
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m bulkwear", description=(__doc__ or "").splitlines()[0])
    commands = parser.add_subparsers(required=True)
    project = commands.add_parser("project", help="make a project: a folder with a small study that works")
    project.add_argument("folder", type=Path, metavar="DIR")
    project.set_defaults(do=_project)
    status = commands.add_parser("status", help="how far a study is: each run, and the time left of all of them")
    status.add_argument("study", nargs="?", metavar="STUDY", help="by default the one that last did something")
    status.add_argument("--cores", type=_cores, metavar="N", help="that it runs on, by default those that it uses now")
    status.add_argument("--page", action="store_true", help="write results/STUDY/live.html until the study has run")
    status.set_defaults(do=_status)
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


def _cores(word: str) -> int:
    if not (word.isdecimal() and int(word) > 0):
        raise argparse.ArgumentTypeError(f"it is '{word}', allowed is a whole number above 0")
    return int(word)


def _status(given: argparse.Namespace) -> str:
    """Return how far a study is; with `--page` write that again and again before."""
    from bulkwear.workflows.engine.project import work_here
    from bulkwear.workflows.forecast.status import latest_study, read_status, status_text

    work_here()
    study = given.study or latest_study()
    if not given.page:
        return status_text(read_status(study, given.cores))
    from bulkwear.workflows.results.live import write_until_over

    return write_until_over(study, given.cores)


def _mesh(given: argparse.Namespace) -> str:
    """Write the surface that the command line asks for; its tables. A refused one is drawn beside it."""
    from bulkwear.meshes.own.mesh import own_mesh
    from bulkwear.meshes.own.refine import WANTED_ANGLE, Ball
    from bulkwear.meshes.own.solids import RefusedMeshError, metres_per
    from bulkwear.postproc.mesh import write_stl, write_surface

    _check_written("-o", given.output, ".vtu", given.files)
    _check_written("--stl", given.stl, ".stl", given.files)
    scale = metres_per(given.unit)
    balls = [Ball((x * scale, y * scale, z * scale), r * scale, edge * scale) for x, y, z, r, edge in given.ball]
    weld = None if given.weld is None else given.weld * scale
    angle = WANTED_ANGLE if given.angle is None else given.angle
    try:
        found = own_mesh(given.files, given.unit, _edges(given.edge, scale), balls, weld, angle)
    except RefusedMeshError as fault:
        picture = (given.output or given.files[0]).with_suffix(".fault.png").name
        picture = (given.output.parent if given.output else Path()) / picture
        raise ValueError(f"{fault}. {_drawn(picture, fault)}") from fault
    _check_reached(given.ball, scale, found.surface)
    stls = _stl_files(given.stl, given.files, found) if given.stl else {}
    if given.output:
        write_surface(given.output, found.surface)
    for path, triangles in stls.items():
        write_stl(path, found.surface.points, triangles)
    return found.text()


def _check_reached(balls: list[list[float]], scale: float, surface: SurfaceMesh) -> None:
    """Raise ValueError for a ball (x, y, z, radius, edge, in the unit of the files) that no triangle reaches into."""
    import numpy as np

    from bulkwear.postproc.mesh import edge_lengths_per_triangle

    points, longest = surface.points, edge_lengths_per_triangle(surface.points, surface.triangles).max()
    for ball in balls:
        away = np.linalg.norm(points - scale * np.array(ball[:3]), axis=1).min() - scale * ball[3]
        if away > longest:
            ends = " to ".join(
                f"({', '.join(f'{x / scale:.4g}' for x in end)})" for end in (points.min(0), points.max(0))
            )
            said = " ".join(f"{value:g}" for value in ball)
            raise ValueError(f"--ball is '{said}', allowed is one that the surface reaches into, which is from {ends}")


def _check_written(option: str, path: Path | None, suffix: str, files: list[Path]) -> None:
    """Raise ValueError where a file that an option names cannot be written, or is one that is read."""
    if path is None:
        return
    folder = path.parent
    if path.suffix != suffix:
        raise ValueError(f"{option} is '{path}', allowed is a name that ends with {suffix}")
    if path.is_dir():
        raise ValueError(f"{option} is '{path}', which is a folder, allowed is a file")
    if not folder.is_dir():
        found = "a file" if folder.exists() else "not there"
        raise ValueError(f"{option} is '{path}', its folder '{folder}' is {found}, allowed is one that exists")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise ValueError(f"{option} is '{path}', its folder '{folder}' is read-only, allowed is one to write into")
    if os.path.realpath(path) in map(os.path.realpath, files):
        raise ValueError(f"{option} is '{path}', which is an input, allowed is another file")


def _drawn(picture: Path, fault: RefusedMeshError) -> str:
    """Draw a refused surface; where that is told."""
    from bulkwear.postproc.plots.fault import save_fault

    try:
        save_fault(picture, fault.surface, fault.faces, fault.place, str(fault))
    except Exception as reason:  # of a folder or of a renderer; what is wrong with the surface has to be told anyway
        return f"Its picture {picture} cannot be drawn ({' '.join(str(reason).split())})"
    return f"Its picture is {picture}"


def _stl_files(path: Path, files: list[Path], found: OwnMesh) -> dict[Path, np.ndarray]:
    """Files for the solver and their triangles (k, 3): a file per part where it would refuse them in one mesh."""
    from bulkwear.meshes.own.solids import distinct

    triangles, part = found.surface.triangles, found.surface.cell_data["part"]
    if found.one_mesh:
        return {path: triangles}
    names = distinct([f"{path.stem}_{re.sub(UNSAFE, '_', each.name)}" for each in found.parts])
    result = {path.with_name(name + path.suffix): triangles[part == k] for k, name in enumerate(names)}
    for each in result:
        _check_written("--stl", each, path.suffix, files)
    return result


def _edges(words: list[str], scale: float) -> dict[str, float] | None:
    """Target edges (m) by part, from words `LENGTH` and `PART=LENGTH`."""
    from bulkwear.meshes.own.solids import OTHERS

    result = {}
    for word in words:
        name, _, length = word.rpartition("=")
        try:
            edge = float(length) * scale
        except ValueError as fault:
            raise ValueError(f"--edge is '{word}', allowed is a length or a part's name, '=', and a length") from fault
        name = name or OTHERS
        if name in result:
            whose = "all parts" if name == OTHERS else f"part '{name}'"
            raise ValueError(f"--edge is given twice for {whose}, the second time '{word}', allowed is once")
        result[name] = edge
    return result or None


if __name__ == "__main__":
    sys.exit(main())
