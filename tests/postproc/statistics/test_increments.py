"""Linearity and predictions from increments, on quantities whose rate is known."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.increments import (
    FARTHEST,
    FEWEST_BLOCKS,
    blocks_of,
    prediction,
    rate_trend,
)
from bulkwear.postproc.statistics.intervals import estimate

ROUNDING = 1e-9  # -, of least squares on a dozen values
TRAVEL = np.array([0.0, 1.0, 2.0, 4.0, 5.0, 7.0, 8.0])  # blocks of two lengths


def parabola(travel):
    """3 x + 0.25 x2: its rate is 3 + 0.5 x."""
    return 3.0 * travel + 0.25 * travel**2


def noisy(seed, count=12, change=0.0, scatter=0.05):
    """Places and sums of rates about 1 that change over the run and scatter independently."""
    rates = 1.0 + change * ((np.arange(count) + 0.5) / count - 0.5)
    rates += scatter * np.random.default_rng(seed).standard_normal(count)
    return np.arange(count + 1.0), np.append(0.0, np.cumsum(rates))


def three_packings(change=0.2):
    """Blocks of three packings with noise."""
    runs = [noisy(seed, change=change) for seed in (1, 2, 3)]
    labels = np.repeat(["a", "b", "c"], len(runs[0][0]))
    return blocks_of(*(np.concatenate(each) for each in zip(*runs, strict=True)), labels)


def test_blocks_lie_between_values():
    """Each block ends at a value, begins at the one before of its packing, and holds their difference."""
    table = blocks_of([0.0, 2.0, 3.0, 0.0, 1.0], [0.0, 4.0, 5.0, 0.0, 7.0], ["a", "a", "a", "b", "b"])
    assert table["start"].tolist() == [0.0, 2.0, 0.0]
    assert table["end"].tolist() == [2.0, 3.0, 1.0]
    assert table["increment"].tolist() == [4.0, 1.0, 7.0]
    with pytest.raises(ValueError, match="the travel does not increase"):
        blocks_of([0.0, 2.0, 1.0], [0.0, 1.0, 2.0])


def test_trend_of_a_parabola():
    """3 x + 0.25 x2 over blocks of any length: slope 0.5, quadratic term 0.25, rate 5 at the middle, change 0.8."""
    trend = rate_trend(blocks_of(TRAVEL, parabola(TRAVEL)))
    assert trend.slope.value == pytest.approx(0.5, rel=ROUNDING)
    assert trend.quadratic.value == pytest.approx(0.25, rel=ROUNDING)
    assert trend.rate.value == pytest.approx(5.0, rel=ROUNDING)
    assert trend.change.value == pytest.approx(0.8, rel=ROUNDING)
    assert trend.curved and not trend.constant_within(0.5)


def test_units_do_not_matter():
    """Other units of travel and quantity change neither the relative change nor its interval."""
    travel, sums = noisy(4, change=0.3)
    first, other = rate_trend(blocks_of(travel, sums)), rate_trend(blocks_of(1000.0 * travel, 1e-9 * sums))
    assert other.change.interval() == pytest.approx(first.change.interval(), rel=1e-6)
    assert other.slope.interval() == pytest.approx(tuple(1e-12 * end for end in first.slope.interval()), rel=1e-6)


def test_no_change_is_shown_where_the_scatter_is_small():
    """A constant rate is constant within 10 % at a scatter of 1 %, not shown to be at 30 %, and curved at neither."""
    calm, rough = (rate_trend(blocks_of(*noisy(5, scatter=scatter))) for scatter in (0.01, 0.3))
    assert calm.constant_within(0.1) and not rough.constant_within(0.1)
    assert not calm.curved and not rough.curved


def test_a_packing_of_few_blocks_has_no_error():
    """Fewer blocks than FEWEST_BLOCKS have a trend whose scatter is unknown: neither curved nor constant."""
    travel, sums = noisy(6, FEWEST_BLOCKS - 1)
    trend = rate_trend(blocks_of(travel, sums))
    assert np.isfinite(trend.slope.value) and not trend.slope.known
    assert trend.curved is None and trend.constant_within(0.1) is None
    assert "scatter unknown" in trend.change.text()


def test_one_run_says_that_it_is_one():
    """The interval of a run's own trend says so, and there is none for a further packing."""
    trend = rate_trend(blocks_of(*noisy(7)))
    assert trend.change.text().endswith("of this run)")
    assert np.isnan(trend.change.of_one_more()).all()


def test_over_packings_the_estimator_is_that_of_intervals():
    """One least-squares slope per packing, and the mean over them with t of packings less one."""
    blocks = three_packings()
    middles = 0.5 * (blocks["start"] + blocks["end"])
    slopes = [np.polyfit(middles[one.index], one["increment"], 1)[0] for _, one in blocks.groupby("packing")]
    trend, expected = rate_trend(blocks), estimate(slopes)
    assert trend.slope.value == pytest.approx(expected.value, rel=ROUNDING)
    assert trend.slope.error == pytest.approx(expected.error, rel=ROUNDING)
    assert (trend.slope.freedom, trend.slope.packings, trend.blocks) == (2, 3, 36)


def test_prediction_of_exact_growth():
    """A parabola goes on as one, a straight line as one; without scatter the interval is the value."""
    for order, sums, expected in ((1, parabola(TRAVEL), parabola(16.0)), (0, 3.0 * TRAVEL, 48.0)):
        found = prediction(blocks_of(TRAVEL, sums), 16.0, order)
        assert (found.value, found.low, found.high) == pytest.approx([expected] * 3, rel=ROUNDING)
        assert (found.packings, found.reason) == (1, "")


def test_prediction_widens_with_its_distance():
    """Of one run the interval is of what it would do further on, wider the farther, and none beyond FARTHEST."""
    blocks = blocks_of(*noisy(8, change=0.2))
    near, far = prediction(blocks, 13.0), prediction(blocks, 12.0 * FARTHEST)
    assert near.high - near.low < 0.5 * (far.high - far.low)
    beyond = prediction(blocks, 12.0 * FARTHEST + 1.0)
    assert np.isnan([beyond.value, beyond.low, beyond.high]).all()
    assert beyond.reason == "more than 2 times the travel of the run"


def test_prediction_over_packings_is_of_one_more():
    """Each packing is extrapolated; the interval is that of a further one, and unknown of too few blocks of one."""
    blocks = three_packings()
    lines = [np.polyfit(np.arange(12) + 0.5, one["increment"], 1) for _, one in blocks.groupby("packing")]
    sums = blocks.groupby("packing")["cumulated"].last()
    ends = estimate([last + 6.0 * np.polyval(line, 15.0) for last, line in zip(sums, lines, strict=True)])
    found = prediction(blocks, 18.0)
    assert found.packings == 3
    assert found.value == pytest.approx(ends.value, rel=ROUNDING)
    assert (found.low, found.high) == pytest.approx(ends.of_one_more(), rel=ROUNDING)
    few = prediction(blocks.head(2), 3.0)
    assert np.isfinite(few.value) and np.isnan(few.low) and "fewer than 4 blocks" in few.reason


def test_packings_of_a_factor_are_told_by_logarithms():
    """Predictions that differ by factors of two have a geometric mean."""
    travel = np.arange(6.0)
    blocks = pd.concat([blocks_of(travel, factor * travel, [factor] * 6) for factor in (1.0, 2.0, 4.0)])
    assert prediction(blocks, 10.0, log=True).value == pytest.approx(20.0, rel=ROUNDING)
