"""Run-ins, on broken lines whose corner is known."""

import numpy as np
import pytest

from bulkwear.postproc.statistics.change_point import ENDED, NONE_FOUND, NOT_ENDED, UNSAID, run_in

PLACES = np.arange(1.0, 25.0)
SCATTER = 0.02
SEEDS = 20
FEWEST = 16  # of SEEDS intervals at 95 % that hold the truth, and level series without a run-in: less has 1 of 600


def broken(seed, end, height=0.5):
    """A series that falls by a height to 1 at a place and stays there, with noise."""
    transient = np.maximum(end - PLACES, 0.0) / (end - PLACES[0]) if end > PLACES[0] else 0.0
    return 1.0 + height * transient + SCATTER * np.random.default_rng(seed).standard_normal(len(PLACES))


@pytest.mark.parametrize("height", [0.5, -0.3])
def test_the_corner_lies_in_its_interval(height):
    """Rising or falling, the end of a clear transient is found, near the truth and with it in the interval."""
    found = [run_in(PLACES, broken(seed, 9.0, height)) for seed in range(SEEDS)]
    assert all(each.answer == ENDED and abs(each.end - 9.0) <= 3.0 for each in found)
    assert sum(each.low <= 9.0 <= each.high for each in found) >= FEWEST
    assert np.median([each.change for each in found]) == pytest.approx(-height, rel=0.15)


def test_a_level_series_has_no_run_in():
    """Nothing is found in most level series, and nothing is said of where it would be."""
    found = [run_in(PLACES, broken(seed, 0.0)) for seed in range(SEEDS)]
    none = [each for each in found if each.answer == NONE_FOUND]
    assert len(none) >= FEWEST
    assert np.isnan([none[0].end, none[0].low, none[0].high]).all() and none[0].text("place") == NONE_FOUND


def test_a_straight_line_has_not_ended():
    """A series that falls to its last place has not run in; the interval reaches the last place."""
    found = run_in(PLACES, broken(1, PLACES[-1]))
    assert (found.answer, found.high) == (NOT_ENDED, PLACES[-1])
    assert found.text("place").startswith("not ended within the run (95 % interval")


def test_units_and_gaps_do_not_matter():
    """In other units the corner is the same place; NaN values are left out, a constant has no run-in."""
    series = broken(2, 9.0)
    first, other = run_in(PLACES, series), run_in(10.0 * PLACES, 1e-9 * series)
    assert (other.end, other.low, other.high) == (10.0 * first.end, 10.0 * first.low, 10.0 * first.high)
    gap = np.where(PLACES == 15.0, np.nan, series)
    assert run_in(PLACES, gap).answer == ENDED
    assert run_in(PLACES, np.full(len(PLACES), 3.0)).answer == NONE_FOUND


def test_few_values_say_nothing():
    """Of five values neither a run-in nor its absence is said."""
    assert run_in(PLACES[:5], broken(3, 3.0)[:5]).answer == UNSAID
