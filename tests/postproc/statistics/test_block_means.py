"""Means over blocks: of several packings the estimator of all beds, of one packing the error of its own blocks."""

import math

import numpy as np
import pytest

from bulkwear.postproc.statistics.block_means import FEWEST_BLOCKS, change_of_blocks, mean_of_blocks
from bulkwear.postproc.statistics.intervals import error_of_mean, estimate, students_t

EXACT = 1e-12  # -, of the same arithmetic
SURE = 4.0  # standard deviations of a counted share


def series(random, count, correlation):
    """A series of mean 0 and deviation 1 whose neighbours are correlated."""
    noise, found = random.normal(size=count), np.empty(count)
    found[0] = noise[0]
    for k in range(1, count):
        found[k] = correlation * found[k - 1] + math.sqrt(1.0 - correlation**2) * noise[k]
    return found


def test_of_several_packings_it_is_the_one_estimator():
    """The blocks of a packing give no error where there are packings."""
    values, packings = np.random.default_rng(1).normal(5.0, 1.0, 12), np.repeat([0, 1, 2], 4)
    for log in (False, True):
        assert mean_of_blocks(values, packings, log) == estimate(values, packings, log)


def test_of_one_packing_its_blocks_give_the_error():
    """The error is that of a correlated series, with one packing told; freedom goes with the independent blocks."""
    values = 5.0 + series(np.random.default_rng(2), 30, 0.6)
    found = mean_of_blocks(values)
    naive = values.std(ddof=1) / math.sqrt(30)
    assert (found.packings, found.known) == (1, True)
    assert found.value == pytest.approx(values.mean(), rel=EXACT)
    assert found.error == pytest.approx(error_of_mean(values), rel=EXACT)
    assert found.error > 1.3 * naive
    assert found.freedom == pytest.approx(30.0 * (naive / found.error) ** 2 - 1.0, rel=EXACT)
    assert "of this run" in found.text()


def test_blocks_that_alternate_are_plain():
    """Without correlation to widen it: Student's t of k - 1."""
    values = [4.0, 6.0] * 5
    found = mean_of_blocks(values)
    error = np.std(values, ddof=1) / math.sqrt(10)
    assert found.interval()[1] == pytest.approx(5.0 + students_t(0.975, 9.0) * error, rel=EXACT)


def test_the_logarithm():
    """Of one packing its mean is that of the blocks, and the interval is a factor to both sides."""
    values = 5.0 + series(np.random.default_rng(3), 20, 0.0)
    plain, log = mean_of_blocks(values), mean_of_blocks(values, log=True)
    low, high = log.interval()
    assert log.value == pytest.approx(plain.value, rel=EXACT)
    assert log.error == pytest.approx(plain.error / plain.value, rel=EXACT)
    assert high / log.value == pytest.approx(log.value / low, rel=EXACT)


def test_few_blocks_tell_nothing():
    """Fewer than FEWEST_BLOCKS of one packing have no error; NaN do not count; equal blocks have the error 0."""
    assert not mean_of_blocks([1.0, 2.0, 3.0]).known
    assert not mean_of_blocks([1.0, 2.0, 3.0, math.nan]).known
    assert mean_of_blocks([1.0, 2.0, 3.0, math.nan, 4.0]).known
    assert mean_of_blocks(np.full(FEWEST_BLOCKS, 2.0)).interval() == (2.0, 2.0)
    assert mean_of_blocks([]).packings == 0
    assert mean_of_blocks([-1.0, 0.0, -2.0, 1.0], log=True).packings == 0
    with pytest.raises(ValueError, match="found 2 packings of 3 values, allowed is one label per value"):
        mean_of_blocks([1.0, 2.0, 3.0], ["a", "b"])


def test_a_packing_without_values_is_none():
    """What is left is one packing, with the error of its own blocks."""
    values = np.random.default_rng(5).normal(5.0, 1.0, 8)
    found = mean_of_blocks([*values, math.nan, math.nan], ["a"] * 8 + ["b"] * 2)
    assert found == mean_of_blocks(values)
    assert found.packings == 1


@pytest.mark.parametrize(("count", "correlation", "least"), [(8, 0.0, 0.95), (12, 0.2, 0.93), (30, 0.2, 0.93)])
def test_the_interval_holds_the_truth(count, correlation, least):
    """Of 1,000 runs as often as stated within four deviations of the count; blocks that are alike cost two points."""
    random, trials = np.random.default_rng(4), 1000
    held = 0
    for _ in range(trials):
        low, high = mean_of_blocks(series(random, count, correlation)).interval()
        held += low <= 0.0 <= high
    assert held / trials > least - SURE * math.sqrt(least * (1.0 - least) / trials)
    assert held / trials < 0.99  # intervals that hold it always say nothing


def test_a_ramp_changes_by_half_its_rise():
    """The halves of a straight line differ by half of what it rises over the whole window; units do not matter."""
    middles = (np.arange(10) + 0.5) / 10
    found = change_of_blocks(5.0 * (0.9 + 0.2 * middles))
    assert found.value == pytest.approx(0.1, rel=EXACT)
    assert found.error == pytest.approx(0.0, abs=EXACT)
    assert found.known
    low, high = (change_of_blocks(factor * np.array([4.0, 5.0, 5.0, 4.5, 5.5])) for factor in (1.0, -7.0))
    assert (low.value, low.error) == (pytest.approx(high.value), pytest.approx(high.error))


def test_few_blocks_have_no_error_of_a_change():
    """Of fewer than FEWEST_BLOCKS the change has no interval, of one block and of a mean of 0 there is none."""
    assert not change_of_blocks([1.0, 2.0, 3.0]).known
    assert change_of_blocks([1.0, 2.0]).value == pytest.approx(1.0 / 1.5)
    for values in ([], [1.0], [-1.0, 1.0, -1.0, 1.0]):
        assert math.isnan(change_of_blocks(values).value)


@pytest.mark.parametrize(("count", "correlation", "least"), [(8, 0.0, 0.94), (20, 0.0, 0.94), (20, 0.3, 0.89)])
def test_the_interval_holds_the_change(count, correlation, least):
    """Of 1,000 series with a ramp as often as measured within four deviations of the count, and not always."""
    random, trials = np.random.default_rng(6), 1000
    ramp, held = 0.2 * ((np.arange(count) + 0.5) / count - 0.5), 0
    for _ in range(trials):
        low, high = change_of_blocks(1.0 + ramp + 0.03 * series(random, count, correlation)).interval()
        held += low <= 0.1 <= high
    assert least - SURE * math.sqrt(least * (1.0 - least) / trials) < held / trials < 0.99
