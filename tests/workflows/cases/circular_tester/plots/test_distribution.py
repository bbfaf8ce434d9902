"""Figures of where a sample in the circular wear tester wears show what they are given, beside what is published."""

import numpy as np
import pandas as pd

from bulkwear.workflows.cases.circular_tester.plots import distribution as tester
from tests.support import tester_study as study
from tests.support.tester_study import REMARKS, missing_words


def test_by_column(tmp_path):
    table = pd.DataFrame({"run": np.repeat(["convex", "plain"], 5), "column": [1, 2, 3, 4, 5] * 2})
    table["base_mm3"], table["bumps_mm3"] = 44.0, [56.0] * 5 + [0.0] * 5
    figure = tester.by_column(table, "mm3", "Worn volume (mm³)", study.PUBLISHED, REMARKS)
    assert missing_words(figure, tmp_path / "a.png", ["pattern 56 % (Yan 2022: 56 %)", "base"]) == []
    forces = table.rename(columns={"base_mm3": "base_N", "bumps_mm3": "bumps_N"}).assign(deviation_N=5.0)
    assert (
        missing_words(
            tester.by_column(forces, "N", "Normal force (N)", study.PUBLISHED, REMARKS),
            tmp_path / "b.png",
            ["over 65 %"],
        )
        == []
    )


def test_by_bump(tmp_path):
    names = [f"C{row}{number}" for row in range(1, 6) for number in range(1, 6 - (row + 1) % 2)]
    rows = [int(name[1]) for name in names]
    table = pd.DataFrame({"bump": names, "row": rows, "volume_mm3": np.linspace(7.0, 30.0, len(names))})
    assert (
        missing_words(
            tester.by_bump(table, study.PUBLISHED, "after 17 revolutions", REMARKS), tmp_path / "a.png", ["after 17"]
        )
        == []
    )


def test_mesh_size(tmp_path):
    table = pd.DataFrame({"surface": np.repeat(["plain", "convex"], 3), "element_size_mm": [0.1, 0.5, 1.0] * 2})
    table["relative_percent"] = [100.0, 99.0, 98.0, 56.0, 57.0, 58.0]
    table["mean_percent"], table["deviation_percent"] = [99.0] * 3 + [57.0] * 3, 1.0
    assert (
        missing_words(tester.mesh_size(table, study.PUBLISHED, REMARKS), tmp_path / "a.png", ["97.9 ± 1.8", "99 ± 1 %"])
        == []
    )


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
