"""Compare a scanned sample with its pristine surface and with simulated worn ones.

python -m bulkwear.workflows.report.scans scan.ply results/demo/R5_convex/surface.vtu \\
    R5=results/demo/R5_convex/worn_surface.vtu --leading-edge 12.5 -48 3

The scan may lie anywhere and have any axes; it is laid on the holder's features, which did not wear. What comes out,
in a folder of its own, and what it means: docs/scans.md.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import SurfaceMesh, read_surface
from bulkwear.postproc.plots import scan as plots
from bulkwear.postproc.plots.style import save
from bulkwear.postproc.readers.point_cloud import METRES, inside_box, point_blocks, random_points
from bulkwear.postproc.scans.comparison import (
    ThinnedScan,
    bump_sections,
    depth_cells,
    largest_losses,
    thinned_scan,
    volume_table,
)
from bulkwear.postproc.scans.registration import EVERYTHING, HOLDER, Registration, register
from bulkwear.postproc.tables.display import MICROMETRES, MILLIMETRES
from bulkwear.workflows.engine.job import Progress

REGISTERED_POINTS = 200_000  # of the scan, at random, that are laid on the surface
ACCURACY = 0.02  # mm, of the laser scanner of Yan 2022 (section 6.2.1)
CROP = 3.0  # mm
SHOWN_BUMPS = ("C11", "C13", "C15")  # Yan 2022, Fig 6.5
LABELS = ("part", "row", "column")
MOST_SURFACES = len(plots.SURFACE_COLOURS)


@dataclass(frozen=True)
class Compared:
    """All that a comparison says: where the scan lies, and its tables."""

    registration: Registration
    scan: ThinnedScan
    cells: pd.DataFrame
    sections: pd.DataFrame
    volumes: pd.DataFrame


def named_surfaces(texts: Sequence[str]) -> dict[str, Path]:
    """Return worn surfaces by name, from FILE (named by its stem) or NAME=FILE. Raises ValueError for equal names."""
    found: dict[str, Path] = {}
    for text in texts:
        name, _, path = text.rpartition("=")
        name = name or Path(path).stem
        if name in found or name in ("measured", "pristine"):
            raise ValueError(f"the worn surface '{text}' is called {name}, a name that is taken: call it NAME={path}")
        found[name] = Path(path)
    if len(found) > MOST_SURFACES:
        raise ValueError(f"found {len(found)} worn surfaces, allowed are {MOST_SURFACES} or fewer in one comparison")
    return found


def labelled_surface(path: Path) -> SurfaceMesh:
    """Read a surface. Raises ValueError when it has no labels."""
    mesh = read_surface(path)
    missing = [label for label in LABELS if label not in mesh.cell_data]
    if missing:
        raise ValueError(f"{path}: the surface has no label {missing[0]}, needed are {', '.join(LABELS)}")
    return mesh


def scanned(given: argparse.Namespace) -> Iterator[np.ndarray]:
    """Yield the points of the scan, in m, those in the box where one is given."""
    blocks = point_blocks(given.scan, given.unit)
    return blocks if given.box is None else inside_box(blocks, METRES[given.unit] * np.reshape(given.box, (3, 2)))


def compare(given: argparse.Namespace, pristine: SurfaceMesh, worn: dict[str, SurfaceMesh]) -> Compared:
    """Lay the scan on the pristine surface and compare it with all surfaces."""
    metres = METRES[given.unit]
    edge = None if given.leading_edge is None else metres * np.array(given.leading_edge)
    accuracy = given.accuracy / MILLIMETRES
    say = Progress("scan", 1).say
    say(f"reading {given.scan}")
    points, total = random_points(scanned(given), REGISTERED_POINTS)
    registration = register(points, pristine, accuracy, given.decided_by, edge, say)
    progress = Progress("scan", total)
    motion, crop = registration.motion, given.crop / MILLIMETRES
    scan = thinned_scan(scanned(given), motion, pristine, crop, lambda done: progress.update(done, "measuring"))
    say(f"{scan.on_sample} of {scan.total} points are the sample's, {len(scan.points)} of them are compared")
    cells = depth_cells(scan.points, pristine, worn)
    sections = bump_sections(scan.points, pristine, worn, accuracy)
    volumes = volume_table(cells, pristine, worn, accuracy)
    if len(sections):
        losses = largest_losses(sections).rename(columns={"bump": "of"})
        volumes = volumes.merge(losses.rename(columns=lambda name: name.replace("_um", "_largest_loss_um")), "left")
    return Compared(registration, scan, cells, sections, volumes)


def write(
    result: Compared, given: argparse.Namespace, pristine: SurfaceMesh, names: Sequence[str], folder: Path
) -> None:
    """Write tables, figures and the registration into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    found = result.registration
    content = {
        "scan": str(given.scan),
        "unit": given.unit,
        "rotation": found.motion.rotation.tolist(),
        "translation_m": found.motion.translation.tolist(),
        "decided_by": found.deciding,
        "points_that_decided": found.points,
        "spread_of_their_distances_m": found.spread,
        "position_uncertainty_m": found.uncertainty,
        "positions_that_look_the_same": found.symmetric,
        "scanned_points": result.scan.total,
        "points_on_the_sample": result.scan.on_sample,
    }
    (folder / "registration.json").write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    for name in ("cells", "sections", "volumes"):
        getattr(result, name).to_csv(folder / f"{name}.csv", index=False, float_format="%.6g")
    said = remarks(result, given)
    save(plots.depth_maps(result.cells, pristine, names, said), folder / "depth_maps.png")
    there = list(dict.fromkeys(result.sections["bump"]))
    shown = given.bumps or [bump for bump in SHOWN_BUMPS if bump in there] or there[:3]
    if shown:
        accuracy = given.accuracy * MICROMETRES / MILLIMETRES
        for name in ("bump_sections", "bump_losses"):
            save(getattr(plots, name)(result.sections, shown, names, accuracy, said), folder / f"{name}.png")


def remarks(result: Compared, given: argparse.Namespace) -> list[str]:
    """Return what stands below the figures."""
    found = result.registration
    by = "the holder, which did not wear" if found.deciding == HOLDER else "all that was scanned: even wear is not seen"
    return [
        f"scan {Path(given.scan).name}, {result.scan.on_sample} of {result.scan.total} points on the sample",
        f"laid on it by {by}, {found.points} points with a spread of {MICROMETRES * found.spread:.2g} µm; position "
        f"known to {MICROMETRES * found.uncertainty:.2g} µm at the worst place, one standard deviation",
        f"accuracy of the scanner {1e3 * given.accuracy:.3g} µm",
    ]


def _arguments(words: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m bulkwear.workflows.report.scans",
        description="Compare a scanned sample with its pristine surface and with simulated worn ones.",
        epilog="What comes out and what it means: docs/scans.md.",
    )
    add = parser.add_argument
    add("scan", type=Path, help="point cloud: .ply, .stl, or text with x y z per line (.xyz .txt .csv .asc .pts)")
    add("pristine", type=Path, help="surface before the test, a .vtu with labels: surface.vtu of a run")
    add("worn", nargs="*", metavar="[NAME=]worn", help="worn surfaces of simulations, .vtu")
    add("--unit", default="mm", choices=METRES, help="of the scan (default mm)")
    add("--accuracy", type=_positive, default=ACCURACY, metavar="MM", help=f"of the scanner (default {ACCURACY} mm)")
    add(
        "--decided-by",
        default=HOLDER,
        choices=(HOLDER, EVERYTHING),
        help="what lays the scan on the surface: the holder, which did not wear (default), or all that is there",
    )
    add(
        "--leading-edge",
        nargs=3,
        type=float,
        metavar=("X", "Y", "Z"),
        help="a scanned point, in the scan's axes and unit, near the middle of the edge that meets the bed first; "
        "needed where the pristine sample looks the same after a turn",
    )
    add(
        "--box",
        nargs=6,
        type=float,
        metavar=("XMIN", "XMAX", "YMIN", "YMAX", "ZMIN", "ZMAX"),
        help="only what lies in this box, in the scan's axes and unit; where more is beside the sample than on it",
    )
    add(
        "--crop",
        type=_positive,
        default=CROP,
        metavar="MM",
        help=f"points farther from the pristine surface are none "
        f"of the sample's; more than the deepest wear (default {CROP:g} mm)",
    )
    add("--bumps", nargs="+", help=f"whose sections are drawn (default {' '.join(SHOWN_BUMPS)})")
    add("--output", type=Path, help="folder for what comes out (default results/scans/<name of the scan>)")
    return parser.parse_args(words)


def _positive(text: str) -> float:
    value = float(text)
    if not (np.isfinite(value) and value > 0.0):
        raise argparse.ArgumentTypeError(f"found {text}, allowed are numbers above 0")
    return value


def main(words: Sequence[str] | None = None) -> int:
    """Compare and write; returns the exit status. Faults are one sentence on stderr."""
    given = _arguments(words)
    folder = given.output or Path("results/scans") / given.scan.stem
    try:
        paths = named_surfaces(given.worn)
        pristine = labelled_surface(given.pristine)
        worn = {name: labelled_surface(path) for name, path in paths.items()}
        result = compare(given, pristine, worn)
        there = list(dict.fromkeys(result.sections["bump"]))
        unknown = [bump for bump in given.bumps or [] if bump not in there]
        if unknown:
            raise ValueError(f"--bumps: found {unknown[0]}, the sample has {', '.join(there) or 'none'}")
        write(result, given, pristine, list(worn), folder)
    except (ValueError, OSError) as error:
        print(f"{str(error).rstrip('.')}.", file=sys.stderr)
        return 1
    print(result.volumes.to_string(index=False, float_format=lambda value: f"{value:.4g}"))
    print(f"{folder}: registration.json, cells.csv, sections.csv, volumes.csv and figures.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
