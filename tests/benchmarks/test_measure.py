"""Measures: medians and ranges, ratios repeat by repeat, ways that take turns."""

import math

import pytest

from benchmarks.measure import Measure, in_turn, measured, processor_times


def test_ratios_are_those_of_the_same_round():
    """A machine that gets twice as slow in the second round changes the values, not the ratio."""
    found = measured("ours", "s", [1.1, 2.2, 1.1], "theirs", [1.0, 2.0, 1.0])
    assert (found.value, found.low, found.high, found.repeats) == (1.1, 1.1, 2.2, 3)
    assert (found.ratio, found.ratio_low, found.ratio_high) == pytest.approx((1.1, 1.1, 1.1), rel=1e-12)
    assert (found.against, found.unit) == ("theirs", "s")


def test_the_range_of_the_ratio_is_its_own():
    """Median, smallest and largest of 2, 1 and 4."""
    found = measured("ours", "s", [2.0, 1.0, 4.0], "theirs", [1.0, 1.0, 1.0])
    assert (found.ratio, found.ratio_low, found.ratio_high) == (2.0, 1.0, 4.0)


def test_nothing_is_compared_with_nothing():
    """Without others there is no ratio; unequal numbers of repeats are refused."""
    found = measured("ours", "MB/s", [3.0])
    assert isinstance(found, Measure) and found.against == "" and math.isnan(found.ratio)
    with pytest.raises(ValueError, match="ours: 2 values against 1 of theirs"):
        measured("ours", "s", [1.0, 2.0], "theirs", [1.0])


def test_every_way_is_first_once():
    """Three ways in three rounds: each comes first, second and third, and keeps its own results."""
    order = []
    ways = {name: (lambda name=name: order.append(name) or name) for name in "abc"}
    assert in_turn(ways, 3) == {name: [name] * 3 for name in "abc"}
    assert [order[place] for place in (0, 3, 6)] == ["a", "b", "c"]


def test_processor_time_is_told_per_call():
    """As many times as calls; what only sleeps costs nothing."""
    calls = []
    times = processor_times(lambda: calls.append(sum(range(10_000))), 3)
    assert len(times) == len(calls) == 3 and min(times) >= 0.0
