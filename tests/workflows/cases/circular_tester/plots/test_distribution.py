"""Figures of where a sample in the circular wear tester wears show what they are given, beside what is published."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.container import ErrorbarContainer
from matplotlib.patches import Rectangle

from bulkwear.workflows.cases.circular_tester.plots import distribution as tester
from tests.support import tester_study as study
from tests.support.tester_study import REMARKS, missing_words


def intervals(table, value, reach):
    return table.assign(packings=3, interval_low=table[value] - reach, interval_high=table[value] + reach)


def error_bars(figure):
    """Return how many pieces of error bars a figure has."""
    return sum(
        len(container.lines[2][0].get_segments())
        for axes in figure.axes
        for container in axes.containers
        if isinstance(container, ErrorbarContainer)
    )


def test_by_column(tmp_path):
    """Base and pattern on one another, a bar for each interval, and none where the scatter is unknown."""
    table = pd.DataFrame({"surface": np.repeat(["convex", "plain"], 5), "column": [1, 2, 3, 4, 5] * 2})
    table["base_mm3"], table["bumps_mm3"] = 44.0, [56.0] * 5 + [0.0] * 5
    table["total_mm3"] = table["base_mm3"] + table["bumps_mm3"]
    known = intervals(table, "total_mm3", 5.0)
    figure = tester.by_column(known, "mm3", "Worn volume (mm³)", "pattern 56 %; Yan 2022: 56 %", REMARKS)
    assert missing_words(figure, tmp_path / "a.png", ["convex: pattern 56 %; Yan 2022: 56 %", "base"]) == []
    assert error_bars(figure) == 10
    alone = intervals(table, "total_mm3", np.nan)
    assert error_bars(tester.by_column(alone, "mm3", "Worn volume (mm³)", "", REMARKS)) == 0


def test_by_bump(tmp_path):
    names = [f"C{row}{number}" for row in range(1, 6) for number in range(1, 6 - (row + 1) % 2)]
    rows = [int(name[1]) for name in names]
    table = pd.DataFrame({"bump": names, "row": rows, "volume_mm3": np.linspace(7.0, 30.0, len(names))})
    figure = tester.by_bump(intervals(table, "volume_mm3", 2.0), study.PUBLISHED, (4.0, 17.0), REMARKS)
    assert missing_words(figure, tmp_path / "a.png", ["over 17"]) == [] and error_bars(figure) == len(names)
    heights = [bar.get_height() for bar in figure.axes[0].patches if isinstance(bar, Rectangle)]
    assert heights == pytest.approx((table["volume_mm3"] / 4.0).tolist())


def test_mesh_size(tmp_path):
    table = pd.DataFrame({"surface": np.repeat(["plain", "convex"], 3), "element_size_mm": [0.1, 0.5, 1.0] * 2})
    table["relative_percent"] = [100.0, 99.0, 98.0, 56.0, 57.0, 58.0]
    figure = tester.mesh_size(intervals(table, "relative_percent", 1.0), study.PUBLISHED, REMARKS)
    words = ["97.9 %, deviation 1.8", "plain, 98 to 100 % over the meshes"]
    assert missing_words(figure, tmp_path / "a.png", words) == [] and error_bars(figure) == 6


def test_worn_contours(tmp_path):
    along = np.linspace(-10.0, 10.0, 41)
    parts = [
        pd.DataFrame({"bump": bump, "view": view, "along_mm": along, "name": name, "height_mm": height})
        for bump in ("C11", "C13")
        for view in ("side", "front")
        for name, height in (("pristine", 6.0), ("8", 5.5), ("17", 5.0))
    ]
    figure = tester.worn_contours(pd.concat(parts), "revolution", REMARKS)
    assert missing_words(figure, tmp_path / "a.png", ["C11, side", "17"]) == []
