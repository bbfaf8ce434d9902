"""Steady windows, on series whose steady part is known."""

import numpy as np
import pytest

from bulkwear.postproc.statistics.steady import (
    ABOVE,
    BELOW,
    DRIFTING,
    LARGEST_DRIFT,
    STEADY,
    UNSAID,
    common_start,
    steady_window,
    window_between,
)

TRAVEL = np.arange(0.005, 1.7, 0.01)  # m: middles of intervals of 10 mm
TRANSIENT = 0.1  # m, decay length of the synthetic transient
NOISE = 0.02
SURE = 4.0  # standard errors of a mean
ROUNDING = 1e-12  # -, of sums of numbers near 1


def approach(seed, level=0.5, start=3.0):
    """A measure that decays to its level, with noise."""
    noise = np.random.default_rng(seed).normal(0.0, NOISE * level, len(TRAVEL))
    return level * (1.0 + (start - 1.0) * np.exp(-TRAVEL / TRANSIENT)) + noise


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("start", [0.0, 3.0])
def test_a_transient_is_cut_off(seed, start):
    """The window starts where the transient has sunk into the noise, and its mean is the level within its error."""
    window = steady_window(TRAVEL, approach(seed, 0.5, start))
    assert window.steady
    assert 2.0 * TRANSIENT < window.start < 0.9
    error = NOISE * 0.5 / np.sqrt(window.values)
    assert abs(window.mean - 0.5) < SURE * error + 0.005 * 0.5  # what is left of the transient
    assert window.deviation == pytest.approx(NOISE * 0.5, rel=0.3)
    assert window.end == TRAVEL[-1]


def test_a_steady_series_is_kept():
    """Without a transient nearly all of the series is kept, wherever its mean lies."""
    for level in (1.0, 1e6):
        noise = np.random.default_rng(1).normal(0.0, 1e-3, len(TRAVEL))
        window = steady_window(TRAVEL, level + noise)
        assert window.steady
        assert window.start < 0.4


def test_a_constant_is_steady_from_the_start():
    """A series that does not change at all is steady as a whole."""
    window = steady_window(TRAVEL, np.full(len(TRAVEL), 3.0))
    assert (window.start, window.mean, window.deviation) == (TRAVEL[0], 3.0, 0.0)
    assert window.drift == pytest.approx(0.0, abs=ROUNDING)
    assert window.steady


def test_a_rising_series_is_not_steady():
    """A measure that rises all along is never steady, and its drift says by how much."""
    window = steady_window(TRAVEL, 1.0 + TRAVEL)
    assert not window.steady
    assert window.drift == pytest.approx((window.end - window.start) / window.mean)
    assert window.drift > LARGEST_DRIFT


@pytest.mark.parametrize(
    ("noise", "drift", "answer"),
    [
        (0.01, 0.0, STEADY),
        (0.01, 0.3, DRIFTING),
        (0.2, 0.0, UNSAID),  # what does not drift, but fluctuates too much to show it
        (0.2, 0.1, UNSAID),
        (0.01, LARGEST_DRIFT, UNSAID),
    ],
)
def test_three_answers(noise, drift, answer):
    """Steady and drifting are said where the interval of the drift is inside and outside; else nothing can be said."""
    rng, found = np.random.default_rng(9), []
    for _ in range(5):
        series = 1.0 + drift * (TRAVEL / np.ptp(TRAVEL) - 0.5) + noise * rng.standard_normal(len(TRAVEL))
        found.append(window_between(TRAVEL, series, 0.0, 1.7))
    assert [each.answer for each in found].count(answer) >= 4
    assert all(each.drift_low < each.drift < each.drift_high for each in found)


def test_correlated_values_are_less_sure():
    """The same values in an order in which neighbours are alike have a wider interval of drift."""
    values = np.random.default_rng(10).normal(1.0, 0.05, len(TRAVEL))
    alike = values.copy()
    for place in range(1, len(values)):
        alike[place] = 1.0 + 0.7 * (alike[place - 1] - 1.0) + 0.714 * (values[place] - 1.0)  # of the same deviation
    wide, narrow = (window_between(TRAVEL, each, 0.0, 1.7) for each in (alike, values))
    assert wide.drift_high - wide.drift_low > 1.5 * (narrow.drift_high - narrow.drift_low)


def test_fluctuation_against_a_limit():
    """A deviation of 5 % is below 7 % and above 3 % with its whole interval, and neither beside 5 %."""
    series = 1.0 + 0.05 * np.random.default_rng(11).standard_normal(len(TRAVEL))
    window = window_between(TRAVEL, series, 0.0, 1.7)
    assert [window.fluctuates(limit) for limit in (0.07, 0.03, 0.05)] == [BELOW, ABOVE, UNSAID]
    assert window.variation_low < window.deviation / window.mean < window.variation_high


def test_units_do_not_matter():
    """In other units the window is the same place."""
    series = approach(3)
    first, other = steady_window(TRAVEL, series), steady_window(1000.0 * TRAVEL, 1e9 * series)
    assert other.start == pytest.approx(1000.0 * first.start)
    assert other.mean == pytest.approx(1e9 * first.mean)
    assert other.steady == first.steady


def test_gaps_are_left_out():
    """NaN values do not count."""
    series = approach(4)
    series[10:13] = np.nan
    assert steady_window(TRAVEL, series).steady
    with pytest.raises(ValueError, match="found 5 values along the travel, allowed are 6 or more"):
        steady_window(TRAVEL[:5], np.ones(5))


def test_the_published_window():
    """The window of 1.0 to 1.7 m is taken as it is; a travel that ends before it has none."""
    window = window_between(TRAVEL, TRAVEL, 1.0, 1.7)
    assert window.mean == pytest.approx(1.35)
    assert (window.start, window.values) == (pytest.approx(1.005), 70)
    assert window_between(TRAVEL[:100], TRAVEL[:100], 1.0, 1.7) is None
    assert window_between(TRAVEL[:150], TRAVEL[:150], 1.0, 1.7) is None


def test_all_measures_together():
    """Both criteria of the source must hold: the latest start counts, and none if one measure is not steady."""
    early, late = steady_window(TRAVEL, approach(5)), steady_window(TRAVEL, approach(6, start=30.0))
    assert common_start([early, late]) == max(early.start, late.start)
    assert np.isnan(common_start([early, steady_window(TRAVEL, 1.0 + TRAVEL)]))
    assert np.isnan(common_start([]))
