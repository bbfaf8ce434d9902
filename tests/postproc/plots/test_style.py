"""The look that figures share: labels that would be longer than their axes stand in two lines."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from bulkwear.postproc.plots.style import new_figure, save

LONG = "Wear volume over that of the plain sample (-)"


def test_a_figure_of_any_layout_is_saved(tmp_path):
    """Without an engine of its own, and with rows of different heights."""
    figure = Figure(figsize=(4.0, 2.0))
    upper, lower = figure.subplots(2, 1, height_ratios=np.array([9.0, 1.0]))
    for axes in (upper, lower):
        axes.set_ylabel("a label of words")
    save(figure, tmp_path / "figure.png")
    assert (upper.get_ylabel().count("\n"), lower.get_ylabel().count("\n")) == (1, 1)


@pytest.mark.parametrize(
    ("height", "panels", "label", "lines"),
    [
        *((5.0, 1, LONG, 1), (3.2, 1, LONG, 2), (5.0, 2, LONG, 2), (3.2, 1, "Force (N)", 1), (2.0, 1, "a" * 60, 1)),
        (2.5, 1, r"Spin of particles · $R\, /\, \sqrt{E^* / \rho}$ (-)", 1),
    ],
)
def test_a_label_longer_than_its_axes_is_folded(tmp_path, height, panels, label, lines):
    """No word of it is lost, and what cannot be folded stays; its text then lies within the figure."""
    figure = new_figure(["a remark"], height)
    axes = figure.subplots(panels, 1, squeeze=False)[0, 0]
    axes.set_ylabel(label)
    save(figure, tmp_path / "figure.png")
    assert axes.get_ylabel().split() == label.split() and axes.get_ylabel().count("\n") == lines - 1
    if lines == 2:
        extent = axes.yaxis.label.get_window_extent()
        assert extent.y0 >= 0.0 and extent.y1 <= figure.bbox.y1
