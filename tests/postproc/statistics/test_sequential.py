"""When packings are enough: closed form of the number needed, steps, and intervals that stay honest."""

import math

import numpy as np
import pytest
from scipy import stats

from bulkwear.postproc.statistics.intervals import CONFIDENCE, estimate
from bulkwear.postproc.statistics.sequential import FEWEST, FURTHER, next_number, packings_needed

TRIALS = 300
CHANCE = 4.0 * math.sqrt(CONFIDENCE * (1.0 - CONFIDENCE) / TRIALS)  # four standard errors of a coverage
LEAST = CONFIDENCE - 0.02 - CHANCE  # what looking again and again may cost


def test_the_number_needed_is_the_first_that_students_t_allows():
    """Twice t s / sqrt(n) over the mean: that number is narrow enough, one packing less is not."""
    found = estimate([0.95, 1.0, 1.05, 1.02])
    number, deviation = packings_needed(found, 0.05, 100), found.error * math.sqrt(found.packings)

    def width(count):
        return 2.0 * stats.t.ppf(0.975, count - 1) * deviation / math.sqrt(count) / found.value

    assert width(number) <= 0.05 < width(number - 1)
    assert packings_needed(found, 0.05, 6) == 6
    with pytest.raises(ValueError, match="found 1 packing"):
        packings_needed(estimate([1.0]), 0.05, 6)


def test_steps_are_few_and_the_last_is_sure():
    """At least FEWEST, at most twice as many as there are, FURTHER after the goal, never more than the most."""
    assert next_number(estimate([1.0, 1.01, 0.99], log=True), 0.05, 20) == (FEWEST, False)
    wide, narrow = [0.8, 1.0, 1.25, 1.1], [1.0, 1.001, 0.999, 1.0]
    assert next_number(estimate(wide, log=True), 0.05, 20) == (8, False)
    assert next_number(estimate(wide, log=True), 0.05, 6) == (6, False)
    assert next_number(estimate(wide, log=True), 0.05, 4) == (4, True)
    assert next_number(estimate(narrow, log=True), 0.05, 20) == (4 + FURTHER, True)
    assert next_number(estimate(narrow, log=True), 0.05, 5) == (5, True)


def test_intervals_that_were_waited_for_hold_the_truth():
    """Packings that scatter by 4 %, an interval of 5 % asked for: coverage, and the width that came of it."""
    random, held, narrow = np.random.default_rng(5), 0, 0
    for _ in range(TRIALS):
        values, number, last = np.exp(random.normal(0.0, 0.04, 90)), FEWEST, False
        while not last:
            number, last = next_number(estimate(values[:number], log=True), 0.05, len(values))
        found = estimate(values[:number], log=True)
        held += found.interval()[0] <= 1.0 <= found.interval()[1]
        narrow += found.width() <= 0.05
    assert held / TRIALS >= LEAST
    assert narrow / TRIALS > 0.8
