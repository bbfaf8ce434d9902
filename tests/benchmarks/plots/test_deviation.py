"""The figure of numerical choices: every change with its interval, the limit, marked values."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.plots.deviation import Panel, deviation_figure
from postproc.plots.style import remarks_of

ROWS = pd.DataFrame(
    {
        "value": [0.1, 0.2, 0.4],
        "failed": [0, 0, 1],
        "change": [0.0, 0.03, np.nan],
        "change_low": [0.0, 0.01, np.nan],
        "change_high": [0.0, 0.05, np.nan],
    }
)


def test_changes_intervals_and_marks_are_drawn():
    """Per cent on the axis, the interval as a bar, a line where the solver failed and at each marked value."""
    figure = deviation_figure([Panel("Step (-)", ROWS, {"studies": 0.2})] * 2, "wear", 0.02, ["four layers"])
    assert len(figure.axes) == 2 and remarks_of(figure) == "four layers"
    axes = figure.axes[0]
    assert axes.get_ylabel() == "Change of wear (%)" and axes.get_xlabel() == "Step (-)"
    (bars,) = axes.containers
    assert bars.lines[0].get_ydata() == pytest.approx([0.0, 3.0])
    (spans,) = bars.lines[2]
    assert spans.get_segments()[1][:, 1] == pytest.approx([1.0, 5.0])
    upright = {float(line.get_xdata()[0]) for line in axes.get_lines() if len(set(line.get_xdata())) == 1}
    assert {0.2, 0.4} <= upright
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["studies", "a run failed"]
