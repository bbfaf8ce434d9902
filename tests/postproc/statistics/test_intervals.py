"""Means with intervals over packings: closed forms, invariants, and how often they hold a known truth."""

import math

import numpy as np
import pytest
from scipy import stats

from benchmarks.interval_coverage import BEDS, NOMINAL, TRUTH, share
from bulkwear.postproc.statistics.intervals import (
    CONFIDENCE,
    UNKNOWN,
    Ends,
    Estimate,
    difference,
    error_of_mean,
    estimate,
    estimates,
    interval_table,
)

ROUNDING = 1e-12  # relative
TRIALS = 400
CHANCE = 4.0 * 100.0 * math.sqrt(CONFIDENCE * (1.0 - CONFIDENCE) / TRIALS)  # %, four standard errors of a coverage


def test_one_value_per_packing_is_students_interval():
    """Mean, error and ends of three packings are scipy's for a sample of three."""
    values = np.array([0.6, 0.65, 0.71])
    found = estimate(values)
    theirs = stats.ttest_1samp(values, 0.0).confidence_interval(CONFIDENCE)
    assert found.value == pytest.approx(values.mean(), rel=ROUNDING)
    assert found.interval() == pytest.approx((theirs.low, theirs.high), rel=ROUNDING)
    assert (found.packings, found.freedom) == (3, 2)


def test_blocks_count_through_the_means_of_their_packings():
    """More blocks of the same packings add no degree of freedom; packings with more blocks weigh no more."""
    few = estimate([1.0, 2.0, 3.0])
    many = estimate([0.5, 1.5, 2.0, 2.0, 2.0, 1.0, 5.0], ["a", "a", "b", "b", "b", "c", "c"])
    assert many == few


def test_logarithms_make_scatter_a_factor():
    """Ends are a factor from the geometric mean, and a ratio upside down has its interval upside down."""
    values = np.array([0.6, 0.65, 0.71])
    found, turned = estimate(values, log=True), estimate(1.0 / values, log=True)
    low, high = found.interval()
    assert found.value**2 == pytest.approx(low * high, rel=ROUNDING)
    assert turned.interval() == pytest.approx((1.0 / high, 1.0 / low), rel=ROUNDING)
    assert estimate(1e9 * values, log=True).width() == pytest.approx(found.width(), rel=ROUNDING)


def test_one_packing_has_no_interval():
    """However many blocks it has: its scatter is unknown, in numbers and in words."""
    found = estimate(np.linspace(0.5, 0.7, 20), np.zeros(20))
    assert not found.known and all(map(math.isnan, (*found.interval(), *found.bounds(0.05), *found.of_one_more())))
    assert found.text() == f"0.600 ({UNKNOWN})"
    assert found.value == pytest.approx(0.6)


def test_words_have_the_interval_and_the_packings():
    """Ends have the decimals of the mean, in display units."""
    assert estimate([0.62, 0.64, 0.66]).text(2) == "0.64 (95 % interval 0.59 to 0.69, 3 packings)"
    assert estimate([1e-9, 2e-9, 3e-9]).text(2, "mm³", 1e9).startswith("2.0 mm³ (95 % interval -0.5 to 4.5, 3")
    assert Ends(4.0, 3.5, math.inf, 3).text() == "4 (95 % interval 3.5 to inf)"


def test_missing_values_are_left_out():
    """NaN blocks, and of logarithms what is not above zero, are no packings."""
    assert estimate([1.0, math.nan, 3.0]).packings == 2
    assert estimate([1.0, 0.0, 3.0], log=True).packings == 2
    assert math.isnan(estimate([]).value) and estimate([]).text() == "no value"


def test_labels_of_another_number_are_refused():
    """One label per value."""
    with pytest.raises(ValueError, match="found 2 packings of 3 values"):
        estimate([1.0, 2.0, 3.0], [1, 2])


def test_a_difference_is_welchs():
    """Of independent packings with unequal scatter, as scipy has it; of logarithms it is a ratio."""
    first, second = np.array([1.0, 1.2, 1.1]), np.array([2.0, 3.0, 2.2, 2.9])
    found = difference(estimate(first), estimate(second))
    theirs = stats.ttest_ind(first, second, equal_var=False).confidence_interval(CONFIDENCE)
    assert found.interval() == pytest.approx((theirs.low, theirs.high), rel=1e-9)
    ratio = difference(estimate(first, log=True), estimate(second, log=True))
    assert ratio.value == pytest.approx(stats.gmean(first) / stats.gmean(second), rel=ROUNDING)
    assert not difference(estimate(first), estimate([2.0])).known
    with pytest.raises(ValueError, match="two of a kind"):
        difference(estimate(first), estimate(second, log=True))


def test_one_scatter_is_an_assumption_that_is_asked_for():
    """Pooled over settings that are repeated, exact for equal ones; a setting of one packing stays unknown."""
    settings, values = ["a", "a", "b", "b", "c"], [1.0, 3.0, 10.0, 14.0, 7.0]
    own, pooled = estimates(settings, values), estimates(settings, values, one_scatter=True)
    assert pooled["a"].error == pytest.approx(math.sqrt((2.0 + 8.0) / 2.0 / 2.0), rel=ROUNDING)
    assert pooled["a"].freedom == 2 and own["a"].freedom == 1
    assert not pooled["c"].known and list(pooled) == ["a", "b", "c"]
    table = interval_table(own)
    assert table["packings"].tolist() == [2, 2, 1] and table["interval_low"].isna().tolist() == [False, False, True]


@pytest.mark.parametrize("name", ["two packings", "three packings", "drift and correlation", "4 to 12 blocks"])
def test_intervals_hold_the_truth_as_often_as_they_say(name):
    """Whatever blocks do within a packing, drift and correlation included."""

    def holds(random):
        low, high = estimate(*BEDS[name].values(random), log=True).interval()
        return low <= TRUTH <= high

    assert share(holds, name, TRIALS)[0] == pytest.approx(NOMINAL, abs=CHANCE)


def test_correlated_values_have_a_larger_error():
    """Of AR(0.7) the error of a mean of 100 is 2.4 times that of independent values; constant ones have none."""
    random = np.random.default_rng(4)
    noise, errors = random.normal(size=(300, 100)), []
    series = np.zeros_like(noise)
    for k in range(1, 100):
        series[:, k] = 0.7 * series[:, k - 1] + math.sqrt(1.0 - 0.49) * noise[:, k]
    errors = [error_of_mean(one[10:]) for one in series]
    assert np.mean(errors) == pytest.approx(series[:, 10:].mean(axis=1).std(), rel=0.2)
    assert error_of_mean(np.ones(5)) == 0.0 and math.isnan(error_of_mean(np.ones(2)))


def test_one_further_packing_falls_wider():
    """The interval of a further packing is sqrt(n + 1) times that of the mean."""
    found = Estimate(1.0, 0.1, 2, 3)
    (low, high), (less, more) = found.interval(), found.of_one_more()
    assert (more - less) == pytest.approx(2.0 * (high - low), rel=ROUNDING)
