"""A figure of heaps shows them whole, with their walls and the stretch of each slope that was fitted."""

import numpy as np
import pandas as pd

from bulkwear.postproc.flow.free_surface import Slope
from bulkwear.workflows.cases.calibration.plots.heaps import heaps

REMARKS = ["particles at scale 5"]
PARTICLES = pd.DataFrame({"x_m": [0.0, 0.01], "y_m": [0.0, 0.2], "z_m": [0.0, 0.14], "radius_m": [0.006, 0.007]})
SLOPE = Slope(np.arctan(0.7), 0.01, 0.03, 0.17, 0.12, -0.7, 0.0, 40)
WALLS = [((0.0, 0.0), (0.2, 0.0)), ((0.0, 0.0), (0.0, 0.25))]


def drawn():
    """Axes with one heap of two particles."""
    picture = {"title": "Shear box", "particles": PARTICLES, "slopes": [SLOPE], "walls": WALLS}
    return heaps([picture], REMARKS).axes[0]


def test_heaps_draw_the_stretch_that_was_fitted():
    """The line of a slope runs over its stretch, in mm, at its angle."""
    line = drawn().lines[-1]
    np.testing.assert_allclose(line.get_xdata(), [30.0, 170.0])
    np.testing.assert_allclose(line.get_ydata(), [120.0, 120.0 - 0.7 * 140.0])
    assert any("35.0 ± 0.6°" in text.get_text() for text in drawn().texts)


def test_heaps_are_drawn_whole():
    """No particle and no wall is cut off by the axes."""
    (left, right), (low, high) = drawn().get_xlim(), drawn().get_ylim()
    assert left < -6.0 and low < -6.0  # the edges of the first particle
    assert right > 207.0 and high > 250.0  # the edge of the second, the end of the wall
