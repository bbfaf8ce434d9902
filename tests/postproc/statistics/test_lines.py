"""Lines and their crossings: exact points, another library's errors, and intervals that cover as often as they say."""

import math

import numpy as np
import pytest
from scipy import stats

from bulkwear.postproc.statistics.lines import CONFIDENCE, crossing, fitted_line, zero_of

SCALES = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0])
FEW = np.array([4.0, 6.0, 8.0])
ROUNDING = 1e-9  # relative
TRIALS = 4000
CHANCE = 4.0 * math.sqrt(CONFIDENCE * (1.0 - CONFIDENCE) / TRIALS)  # four standard errors of a coverage


def test_a_line_through_its_own_points_is_exact():
    """Points of the published convex line give it back, without error."""
    line = fitted_line(SCALES, -0.08 + 0.26 * SCALES)
    assert (line.intercept, line.slope) == pytest.approx((-0.08, 0.26), rel=ROUNDING)
    assert line.r_squared == pytest.approx(1.0) and line.slope_error < 1e-12


def test_errors_are_those_of_scipy():
    """Slope, intercept, their standard errors and R2 of scattered points."""
    y = 0.26 * SCALES + np.random.default_rng(1).normal(0.0, 0.1, len(SCALES))
    ours, theirs = fitted_line(SCALES, y), stats.linregress(SCALES, y)
    for one, other in (
        (ours.slope, theirs.slope),
        (ours.intercept, theirs.intercept),
        (ours.slope_error, theirs.stderr),
        (ours.intercept_error, theirs.intercept_stderr),
        (ours.error_at(0.0), theirs.intercept_stderr),
        (ours.r_squared, theirs.rvalue**2),
    ):
        assert one == pytest.approx(other, rel=ROUNDING)


def test_at_an_end_of_the_interval_zero_is_just_within_the_error():
    """Fieller's ends: the line there is its t-fold standard error away from zero."""
    line = fitted_line(SCALES, 0.26 * SCALES - 1.0 + np.random.default_rng(2).normal(0.0, 0.1, len(SCALES)))
    found = zero_of(line)
    allowed = stats.t.ppf(0.975, line.freedom)
    for end in (found.low, found.high):
        assert abs(line.at(end)) / line.error_at(end) == pytest.approx(allowed, rel=1e-6)
    assert found.low < found.value < found.high and line.at(found.value) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("places", "noise"), [(SCALES, 0.02), (SCALES, 0.15), (FEW, 0.05)])
def test_the_interval_covers_a_known_crossing_as_often_as_it_says(places, noise):
    """Published lines with added scatter cross at 4.160: 95 of 100 intervals hold it, whatever the scatter."""
    random, truth = np.random.default_rng(3), 1.09 / 0.262
    plain, convex = 1.01 - 0.002 * places, -0.08 + 0.26 * places
    covered = 0
    for _ in range(TRIALS):
        scatter = random.normal(0.0, noise, (2, len(places)))
        found = crossing(places, convex + scatter[0], plain + scatter[1])
        # an unbounded interval is a statement too; where it has a gap the truth is looked for in the line's error
        covered += found.low <= truth <= found.high
    assert covered / TRIALS >= CONFIDENCE - CHANCE
    if noise < 0.1 and len(places) > len(FEW):
        assert covered / TRIALS <= CONFIDENCE + CHANCE


def test_a_flat_difference_has_no_crossing():
    """Scatter alone excludes nothing: the interval is everything, and says so."""
    found = crossing(SCALES, np.random.default_rng(4).normal(0.0, 1.0, len(SCALES)), np.zeros(len(SCALES)))
    assert not found.bounded and found.low == -math.inf and found.high == math.inf


def test_scatter_that_both_share_cancels():
    """A packing that wears both samples more by the same does not widen the interval."""
    random = np.random.default_rng(5)
    own, shared = random.normal(0.0, 0.02, len(SCALES)), random.normal(0.0, 0.3, len(SCALES))
    convex, plain = -0.08 + 0.26 * SCALES + own, 1.01 - 0.002 * SCALES
    alone, both = crossing(SCALES, convex, plain), crossing(SCALES, convex + shared, plain + shared)
    assert both.high - both.low == pytest.approx(alone.high - alone.low, rel=ROUNDING)


@pytest.mark.parametrize(
    ("x", "found"), [([1.0, 2.0], "found 2 at 2 places"), ([2.0, 2.0, 2.0], "found 3 at 1 places")]
)
def test_too_few_points_are_refused(x, found):
    """Two points leave no error, equal places no slope."""
    with pytest.raises(ValueError, match=found):
        fitted_line(x, x)
