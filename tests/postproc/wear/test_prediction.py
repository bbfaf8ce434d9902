"""Predictions: scatter of packings and error of the wear coefficient in one interval."""

import math

import numpy as np
import pytest

from bulkwear.postproc.statistics.intervals import Estimate, estimate, students_t
from bulkwear.postproc.wear.prediction import coefficient_reaches, joined, log_reach, predicted

EXACT = 1e-12  # -, of the same arithmetic
SURE = 4.0  # standard deviations of a counted share
REPEATS = 4000
LABORATORY = 1e-13 / 6.3e-13  # -, error over value of the source's steel


def rates(scale: float = 1.0) -> Estimate:
    """Rates of three packings."""
    return estimate(scale * np.array([1.8, 2.0, 2.3]), log=True)


def test_both_are_added_as_squares():
    """Half widths in the logarithm of 3 and 4 make 5, and their shares are 9 and 16 of 25."""
    error = math.tanh(0.04)  # the mean of both sides of which is 0.04 in the logarithm
    found = predicted(Estimate(2.0, 0.03 / students_t(0.975, 7.0), 7.0, 8, log=True), error)
    assert (found.scatter_reach, found.coefficient_reach) == pytest.approx((0.03, 0.04), rel=EXACT)
    assert found.scatter_share == pytest.approx(9.0 / 25.0, rel=EXACT)
    assert found.low == pytest.approx(2.0 * math.exp(-math.hypot(0.03, math.log1p(-error))), rel=EXACT)
    assert found.high == pytest.approx(2.0 * math.exp(math.hypot(0.03, math.log1p(error))), rel=EXACT)


def test_without_an_error_it_is_that_of_the_packings():
    """The interval is Student's, to the last digit that matters."""
    found = predicted(rates(), 0.0)
    assert (found.low, found.high) == pytest.approx(rates().interval(), rel=EXACT)
    assert found.scatter_share == 1.0


def test_without_scatter_it_is_that_of_the_coefficient():
    """6.3e-13 +- 1e-13 1/Pa: a volume of 6.3 is 5.3 to 7.3, and hours of 1/6.3 are 1/7.3 to 1/5.3."""
    sure = Estimate(6.3, 0.0, math.inf, 3, log=True)
    found = predicted(sure, LABORATORY)
    assert (found.low, found.high) == pytest.approx((5.3, 7.3), rel=EXACT)
    assert (found.coefficient_low, found.coefficient_high) == (found.low, found.high)
    assert found.scatter_share == 0.0
    hours = predicted(Estimate(1.0 / 6.3, 0.0, math.inf, 3, log=True), LABORATORY, inverse=True)
    assert (hours.low, hours.high) == pytest.approx((1.0 / 7.3, 1.0 / 5.3), rel=EXACT)


def test_hours_are_one_over_a_rate():
    """The interval of what is inverse is that of the rate, upside down."""
    rate = predicted(rates(), LABORATORY)
    hours = predicted(estimate(1.0 / np.array([1.8, 2.0, 2.3]), log=True), LABORATORY, inverse=True)
    assert (hours.value, hours.low, hours.high) == pytest.approx(
        (1.0 / rate.value, 1.0 / rate.high, 1.0 / rate.low), rel=EXACT
    )


def test_other_units_are_a_factor():
    """m3 and mm3: ends and value by the same factor, shares as they are."""
    one, other = (predicted(rates(scale), LABORATORY) for scale in (1.0, 1e9))
    assert (other.value, other.low, other.high) == pytest.approx((1e9 * one.value, 1e9 * one.low, 1e9 * one.high))
    assert other.scatter_share == pytest.approx(one.scatter_share, rel=1e-9)


def test_of_one_packing_the_scatter_is_unknown():
    """No interval; what the coefficient alone gives is told beside it, in words that say so."""
    found = predicted(estimate([6.3], log=True), LABORATORY)
    assert not found.known
    assert math.isnan(found.scatter_share)
    assert (found.coefficient_low, found.coefficient_high) == pytest.approx((5.3, 7.3), rel=EXACT)
    said = "6.3 mm³ (one packing, scatter unknown; the wear coefficient alone gives 5.3 to 7.3 mm³)"
    assert found.said("mm³") == said
    assert predicted(estimate([6.3], log=True), 0.0).said("mm³") == "6.3 mm³ (one packing, scatter unknown)"


def test_words():
    """Value, interval, packings and shares; small numbers with an exponent."""
    said = predicted(rates(), LABORATORY).said("mm per hour")
    assert said.startswith(
        "2.02 mm per hour (95 % interval 1.42 to 2.84 mm per hour, 3 packings, scatter makes 78 % of"
    )
    assert joined(2.0e-6, 0.1, 0.0, 3).said("m").startswith("2.00e-06 m (95 % interval 1.81e-06 to 2.21e-06 m")


def test_what_does_not_wear_has_no_interval():
    """Of nothing, and of an unknown rate, no logarithm is taken."""
    for value in (0.0, math.nan):
        assert math.isnan(log_reach(Estimate(value, 0.1, 5, 3)))
        assert not predicted(Estimate(value, 0.1, 5, 3), 0.1).known


@pytest.mark.parametrize("error", [-0.1, 1.0, math.nan])
def test_other_errors_are_refused(error):
    """One sentence with what was found and what is allowed."""
    with pytest.raises(ValueError, match=f"wear coefficient is {error:g}, allowed is 0 to less than 1"):
        coefficient_reaches(error)


@pytest.mark.parametrize("scatter", [0.1, *(pytest.param(each, marks=pytest.mark.verify) for each in (0.02, 0.4))])
def test_intervals_hold_the_truth_as_often_as_they_say(scatter):
    """Packings that scatter by a factor and a measured coefficient with an error of its own: 95 % or more."""
    chance, error = np.random.default_rng(7), LABORATORY
    measured = np.exp(chance.normal(0.0, 0.5 * (math.log1p(error) - math.log1p(-error)) / 1.96, REPEATS))
    packings = np.exp(chance.normal(0.0, scatter, (REPEATS, 3)))
    found = [predicted(estimate(one, log=True), error) for one in measured[:, None] * packings]
    held = np.mean([each.low <= 1.0 <= each.high for each in found])
    assert held >= 0.95 - SURE * math.sqrt(0.95 * 0.05 / REPEATS)
