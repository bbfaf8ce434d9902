"""The figure of a confirmation draws its table: predictions with intervals, simulated runs, and whether they agree."""

import numpy as np
import pandas as pd

from postproc.plots.style import remarks_of
from workflows.cases.sliding_sample.screening.plots.confirmation import confirmation

REMARKS = ["particles at scale 2"]


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
    figure = confirmation(table, REMARKS)
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
