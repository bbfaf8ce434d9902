"""How far a deep groove depends on the mesh: a pin dragged to and fro by LIGGGHTS over three meshes, worn two ways.

    python -m benchmarks.groove --output docs        # in the root of the repository
    python -m benchmarks.groove --output docs --redraw

Writes groove_strokes.csv (every stroke), groove_sections.csv, groove_convergence.csv and .png; `--redraw` makes the
last two from the first two. Takes a quarter of an hour of one core.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from datetime import date

import numpy as np
import pandas as pd

from benchmarks.command_line import command, output_folder, read_table
from benchmarks.plots.figures import groove_convergence
from bulkwear.postproc.plots.style import save
from tests.verification.groove_cases import (
    DEPTH,
    EDGES_PER_WIDTH,
    GROOVE_WIDTH,
    PASSES,
    PLATE,
    SECTIONS,
    TRACK,
    Groove,
    section_profile,
    worn_groove,
)
from tests.verification.ledger_cases import LOAD, PARTICLE_MODULUS, RADIUS, hertz_overlap

PLACES = np.linspace(-0.45, 0.45, 361) * PLATE[0]  # m, of the profiles in the table

FINEST = max(EDGES_PER_WIDTH)
# scheme, edges per width; by single triangles the finest mesh, first, decides how long the others go on
CASES = (
    *(("conserving", edges) for edges in EDGES_PER_WIDTH),
    *(("per_triangle", edges) for edges in reversed(EDGES_PER_WIDTH)),
    ("spread_once", FINEST),
)


def told(start: float):
    """Return what prints a line with the seconds since `start`."""
    return lambda line: print(f"{time.time() - start:7.1f} s  {line}", flush=True)


def tables(scheme: str, edges: int, groove: Groove) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the strokes of a groove, and its section in the middle of the track."""
    strokes = pd.DataFrame(groove.strokes)
    strokes.insert(0, "stroke", np.arange(1, len(strokes) + 1))
    depth = section_profile(groove.mesh, SECTIONS[len(SECTIONS) // 2], PLACES)
    section = pd.DataFrame({"x_mm": 1e3 * PLACES, "depth_um": 1e6 * depth})
    for table in (strokes, section):
        table.insert(0, "edges_per_width", edges)
        table.insert(0, "scheme", scheme)
    return strokes, section


def study() -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return strokes and sections of all grooves: conserving on every mesh, over the plain pressure on the finest.

    `per_triangle` goes up to the last stroke that every mesh survives.
    """
    tell = told(time.time())
    parts, survived = [], PASSES
    for scheme, edges in CASES:
        passes = survived if scheme == "per_triangle" else PASSES
        groove = worn_groove(GROOVE_WIDTH / edges, scheme, passes, tell=tell)
        if groove.stopped:
            tell(groove.stopped)
            survived = len(groove.strokes)
        parts.append(tables(scheme, edges, groove))
    strokes, sections = zip(*parts, strict=True)
    return pd.concat(strokes, ignore_index=True), pd.concat(sections, ignore_index=True)


def stroke_table(strokes: pd.DataFrame, shown: Sequence[tuple[str, int]]) -> pd.DataFrame:
    """Return one row per scheme, chosen stroke and mesh: depth, width and volumes after that many strokes.

    strokes: one row per `scheme`, `edges_per_width` and `stroke`; of this stroke `depth_m`, `width_m`, `work_J` and
        `load_times_distance_J`; since the start `removed_volume_m3`, `carried_volume_m3` and `law_volume_m3`
    shown: pairs of scheme and number of strokes, in the order of the rows, the coarsest mesh first
    """
    parts = [strokes[(strokes["scheme"] == scheme) & (strokes["stroke"] == number)] for scheme, number in shown]
    chosen = pd.concat([part.sort_values("edges_per_width") for part in parts], ignore_index=True)
    law = chosen["law_volume_m3"]
    return pd.DataFrame(
        {
            "scheme": chosen["scheme"],
            "strokes": chosen["stroke"],
            "edges_per_width": chosen["edges_per_width"],
            "depth_um": 1e6 * chosen["depth_m"],
            "width_mm": 1e3 * chosen["width_m"],
            "removed_over_archard": chosen["removed_volume_m3"] / law,
            "accounted_over_archard": (chosen["removed_volume_m3"] + chosen["carried_volume_m3"]) / law,
            "work_over_load_times_distance": chosen["work_J"] / chosen["load_times_distance_J"],
        }
    )


def largest_differences(table: pd.DataFrame) -> pd.DataFrame:
    """Return, per scheme and number of strokes, how far depth and width differ between meshes, largest over least - 1.

    table: as from `stroke_table`; columns `depth_difference` and `width_difference`, -
    """
    grouped = table.groupby(["scheme", "strokes"])[["depth_um", "width_mm"]]
    ratio = grouped.max() / grouped.min() - 1.0
    return ratio.set_axis(["depth_difference", "width_difference"], axis=1).reset_index()


def remarks(strokes: pd.DataFrame) -> list[str]:
    """Return what must be known about the figure."""
    survived = strokes.loc[strokes["scheme"] == "per_triangle", "stroke"].max()
    return [
        f"LIGGGHTS at reduced scale: pin of radius {1e3 * RADIUS:g} mm, {LOAD:g} N, {1e3 * TRACK:g} mm to and fro, "
        f"softened to {PARTICLE_MODULUS / 1e9:.3g} GPa (overlap {1e6 * hertz_overlap():.0f} µm on a flat plate); "
        f"wear coefficient chosen so that each stroke deepens a round groove by {1e6 * DEPTH / PASSES:g} µm",
        r"$\alpha W$: Archard's volume, $W$ the sliding work",
        f"per triangle, faces turn over on the finest mesh in stroke {survived + 1}",
        f"depth and width (holding 95 % of the area): mean of {len(SECTIONS)} sections, drawn is the one in the middle",
        f"made by benchmarks/groove.py, {date.today():%Y-%m-%d}",
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=output_folder, default="docs")
    parser.add_argument("--redraw", action="store_true", help="from the tables of an earlier run")
    given = parser.parse_args()
    files = [given.output / f"groove_{name}.csv" for name in ("strokes", "sections")]
    if not given.redraw:
        for file, table in zip(files, study(), strict=True):
            table.to_csv(file, index=False, float_format="%.12g" if "strokes" in file.name else "%.5g")
    strokes, sections = map(read_table, files)
    survived = strokes.loc[strokes["scheme"] == "per_triangle", "stroke"].max()
    shown = (("conserving", PASSES), ("spread_once", PASSES), ("conserving", survived), ("per_triangle", survived))
    table = stroke_table(strokes, shown)
    table.to_csv(given.output / "groove_convergence.csv", index=False, float_format="%.10g")
    save(groove_convergence(sections, table, remarks(strokes)), given.output / "groove_convergence.png")
    print(table.to_string(index=False), largest_differences(table).to_string(index=False), sep="\n")


if __name__ == "__main__":
    command(main)
