"""How much of a sample its bumps cover, by both readings of the distance c between rows; docs/decisions.md judges.

    python -m benchmarks.pattern_coverage    # in the root of the repository; seconds

Writes docs/pattern_coverage.csv: the patterns of the screening on its sample and that of the circular wear tester, at
paper fidelity, each by both readings.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial import cKDTree

from benchmarks.command_line import command
from bulkwear.meshes.lattice import Pattern, pattern_centres, pattern_rows
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.patterns import ROWS_PER_SPACING, pattern_of
from bulkwear.workflows.engine.state import digest

FILE = Path("docs/pattern_coverage.csv")
STUDIES = ("screening", "circular_tester")
CORNERS = 360  # of the polygon that stands for a bump's outline where distances are measured
STEP, FINEST = 1e-3, 1e-5  # m, of the grids on which the widest free place is looked for, first and last
REFINED = 0.2  # step of a grid over that of the one before, which is refined round its best place
PERCENT, MM = 100.0, 1e3


def covered_fraction(pattern: Pattern, width: float, length: float) -> float:
    """Return the share (-) of a sample of `width` by `length` m under its bumps, which do not overlap."""
    bumps = len(pattern_centres(pattern, width, length)[0])
    return bumps * math.pi * pattern.half_width * pattern.half_length / (width * length)


def outlines(pattern: Pattern, centres: np.ndarray) -> np.ndarray:
    """Return points (k, CORNERS, 2) m round bumps at centres (k, 2) m."""
    angle = np.linspace(0.0, 2.0 * math.pi, CORNERS, endpoint=False)
    foot = np.column_stack([pattern.half_width * np.cos(angle), pattern.half_length * np.sin(angle)])
    return centres[:, None] + foot


def neighbourhood(pattern: Pattern) -> np.ndarray:
    """Return the centres (k, 2) m of a lattice without rim round the origin, where the first of them stands."""
    row, column = (each.ravel() for each in np.meshgrid(np.arange(-4, 5), np.arange(-4, 5)))
    x = pattern.column_spacing * (column + pattern.row_offset * (row % 2))
    centres = np.column_stack([x, pattern.row_spacing * row])
    return centres[np.argsort(np.hypot(*centres.T), kind="stable")]


def narrowest_gap(pattern: Pattern) -> float:
    """Return the smallest distance (m) from one bump to another."""
    first, others = np.split(outlines(pattern, neighbourhood(pattern)), [1])
    return float(cKDTree(others.reshape(-1, 2)).query(first[0])[0].min())


def widest_free_circle(pattern: Pattern) -> float:
    """Return the diameter (m) of the largest circle of plane between bumps."""
    centres, foot = neighbourhood(pattern), (pattern.half_width, pattern.half_length)
    outline, bump = cKDTree(outlines(pattern, centres).reshape(-1, 2)), cKDTree(centres / foot)
    middle = half = np.array([pattern.column_spacing / 2.0, pattern.row_spacing])
    step = STEP
    while True:
        places = middle + np.stack(np.meshgrid(*(np.arange(-each, each + step, step) for each in half)), -1).reshape(
            -1, 2
        )
        room = np.where(bump.query(places / foot)[0] > 1.0, outline.query(places)[0], 0.0)
        if step <= FINEST:
            return 2.0 * float(room.max())
        middle, half, step = places[room.argmax()], np.full(2, 2.0 * step), REFINED * step


def patterns(reading: str) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Yield study, row and parameters (SI) of each pattern of the studies, by a reading of the row spacing."""
    for name in STUDIES:
        chosen = {"fidelity": "paper", "packings": 1, "pattern": {"row_spacing_between": reading}}
        study = load_study(name, overrides=chosen)
        seen = set()
        for run in study.runs:
            if run.parameters["pattern"] is not None and (shape := digest(run.parameters["pattern"])) not in seen:
                seen.add(shape)
                yield name, run.row, run.parameters


def coverage_table() -> pd.DataFrame:
    """Return a line for each pattern and reading; percentages of the sample, lengths in mm."""
    lines = []
    for reading in ROWS_PER_SPACING:
        for study, row, parameters in patterns(reading):
            pattern, sample = pattern_of(parameters["pattern"]), parameters["sample"]
            size = sample["width_m"], sample["length_m"]
            per_row = np.bincount(pattern_rows(pattern, *size))[1:]
            free = widest_free_circle(pattern)
            lines.append(
                {
                    "study": study,
                    "row": row,
                    "row_spacing_between": reading,
                    "sample_mm": MM * size[0],
                    "to_next_row_mm": MM * pattern.row_spacing,
                    "bumps": per_row.sum(),
                    "bumps_per_row": " ".join(map(str, per_row)),
                    "covered_percent": PERCENT * covered_fraction(pattern, *size),
                    "narrowest_gap_mm": MM * narrowest_gap(pattern),
                    "widest_free_circle_mm": MM * free,
                    "widest_free_circle_over_particle": free / parameters["particle"]["median_diameter_m"],
                }
            )
    return pd.DataFrame(lines)


def main() -> None:
    coverage_table().to_csv(FILE, index=False, float_format="%.3g")


if __name__ == "__main__":
    command(main)
