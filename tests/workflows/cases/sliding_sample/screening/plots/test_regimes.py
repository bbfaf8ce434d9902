"""Figures by flow regime draw their tables: bars of convex and plain runs, best designs with their predictions."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.plots.style import remarks_of
from bulkwear.workflows.cases.sliding_sample.screening.plots.regimes import (
    confirmation,
    normal_force_by_regime,
    wear_by_regime,
)

REMARKS = ["particles at scale 2"]


@pytest.fixture
def table():
    """Two continuous rows, R2 of less convex wear, and a discontinuous one."""
    rows = [("R1", "continuous", 0.8, 1.0), ("R2", "continuous", 0.4, 0.6), ("R3", "discontinuous", 0.9, 1.0)]
    runs = [
        {"setting": row, "surface": surface, "regime": regime, "relative_wear": wear}
        for row, regime, *both in rows
        for surface, wear in zip(("convex", "plain"), both, strict=True)
    ]
    table = pd.DataFrame(runs)
    bumps = np.where(table["surface"] == "convex", 0.25, 0.0) * table["relative_wear"]
    table = table.assign(base_relative_wear=table["relative_wear"] - bumps, bump_relative_wear=bumps)
    table = table.assign(interval_low=[0.7] + [np.nan] * 5, interval_high=[1.2] + [np.nan] * 5)
    return table.assign(mean_normal_force_N=10.0 * table["relative_wear"])


def heights(axes):
    return sorted(round(bar.get_height(), 9) for bar in axes.patches)


def test_wear_bars_are_the_table(table):
    """Base and bumps of convex runs and the plain runs are bars of their values, rows of least wear first."""
    figure = wear_by_regime(table, REMARKS)
    left, right = figure.axes
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["continuous", "discontinuous"]
    assert heights(left) == pytest.approx(sorted([0.6, 0.3, 0.2, 0.1, 1.0, 0.6]))
    assert heights(right) == pytest.approx(sorted([0.675, 0.225, 1.0]))
    assert [label.get_text() for label in left.get_xticklabels()] == ["R2", "R1"]
    assert left.get_ylim()[1] > 1.2
    (segment,) = [each for bars in left.collections for each in bars.get_segments()]
    assert segment[:, 1].tolist() == pytest.approx([0.7, 1.2])
    assert left.get_ylabel() == "Wear over the largest of the regime (-)"
    assert remarks_of(figure) == "; ".join(REMARKS)


def test_force_bars_are_the_table(table):
    """A bar of the force per setting and surface, and an interval only where one is known."""
    table = table.assign(interval_low=10.0 * table["interval_low"], interval_high=10.0 * table["interval_high"])
    figure = normal_force_by_regime(table, REMARKS)
    assert figure.axes[0].get_ylim()[1] > 12.0
    assert heights(figure.axes[0]) == pytest.approx([4.0, 6.0, 8.0, 10.0])
    drawn = [len(bars.get_segments()) for axes in figure.axes for bars in axes.collections]
    assert sum(drawn) == 1
    assert figure.axes[0].get_ylabel() == "Normal force on the sample (N)"


def test_predictions_and_runs_are_as_tabled():
    """A line per regime with prediction, interval, convex and plain run; the unit carries a power of ten."""
    table = pd.DataFrame(
        {
            "row": ["continuous", "discontinuous"],
            "predicted_mm3_per_m": [2e-4, 1e-4],
            "run_low_mm3_per_m": [1e-4, 0.5e-4],
            "run_high_mm3_per_m": [4e-4, 2e-4],
            "simulated_mm3_per_m": [3e-4, 9e-4],
            "plain_mm3_per_m": [5e-4, 8e-4],
            "inside": [True, False],
            "over_predicted": [1.5, 9.0],
        }
    )
    figure = confirmation(table, "convex", REMARKS)
    (axes,) = figure.axes
    drawn = {line.get_label(): line.get_xdata() for line in axes.lines}
    np.testing.assert_array_equal(drawn["simulated, convex"], [3e-4, 9e-4])
    np.testing.assert_array_equal(drawn["simulated, plain"], [5e-4, 8e-4])
    ends = [segment[:, 0] for segment in axes.collections[0].get_segments()]
    np.testing.assert_allclose(ends, [[1e-4, 4e-4], [0.5e-4, 2e-4]])
    words = [text.get_text() for text in axes.texts]
    assert words == ["inside, 1.50 of the prediction", "outside, 9.00 of the prediction"]
    assert axes.get_xlabel() == "Wear per length of travel ($10^{-6}$ mm³/m)"
    assert [label.get_text() for label in axes.get_yticklabels()] == ["continuous", "discontinuous"]
    assert remarks_of(figure) == "; ".join(REMARKS)
