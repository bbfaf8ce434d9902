"""Where a ratio passes a level: known crossings, lack of fit against a textbook, and nothing beyond the places."""

import math

import numpy as np
import pytest
from scipy import stats

from bulkwear.postproc.statistics.crossing import FORMS, crossing, form_table, lack_of_fit, pure_error
from bulkwear.postproc.statistics.intervals import CONFIDENCE

PLACES = np.repeat([4.0, 6.0, 8.0, 9.0, 10.0, 12.0], 3)
TRUTH, SCATTER = 8.5, 0.03
TRIALS = 60
CHANCE = 4.0 * math.sqrt(CONFIDENCE * (1.0 - CONFIDENCE) / TRIALS)  # four standard errors of a coverage
GRID = 0.01  # of the places at which a form is looked at: 8 over 2000, and some
ROUNDING = 1e-9  # relative


def line(scale):
    return 1.0 + 0.12 * (scale - TRUTH)


def scattered(shape, seed, places=PLACES):
    return shape(places) * np.exp(np.random.default_rng(seed).normal(0.0, SCATTER, len(places)))


def test_exact_values_cross_where_they_do():
    """Every form that holds the truth finds its crossing; without repeated places there is no interval."""
    alone = np.unique(PLACES)
    found = form_table(alone, line(alone)).set_index("form")
    assert found.loc["ratio, line", "crossing"] == pytest.approx(TRUTH, abs=GRID)
    assert found["interval_low"].isna().all() and found["p_value"].isna().all()
    power = form_table(alone, (alone / TRUTH) ** 0.7).set_index("form")
    assert power.loc["ln ratio, power law", "crossing"] == pytest.approx(TRUTH, abs=GRID)
    assert "one packing" in crossing(alone, line(alone)).reason


def test_a_level_and_a_unit_do_not_matter():
    """Twice the ratio against twice the level is the same, and so is a place in another unit."""
    ratio = scattered(line, 1)
    found = crossing(PLACES, ratio)
    twice, metres = crossing(PLACES, 2.0 * ratio, 2.0), crossing(1e-3 * PLACES, ratio)
    assert (twice.value, twice.low, twice.high) == pytest.approx((found.value, found.low, found.high), rel=1e-6)
    ends = (1e3 * metres.value, 1e3 * metres.low, 1e3 * metres.high)
    assert ends == pytest.approx((found.value, found.low, found.high), abs=GRID)


def test_lack_of_fit_is_the_f_test():
    """Sums of squares between and within places, by hand; a form that misses is rejected, the true one is not."""
    place, y = np.repeat([1.0, 2.0, 3.0, 4.0], 2), np.array([1.0, 1.2, 2.1, 1.9, 3.9, 4.1, 8.2, 7.8])
    fitted = np.polynomial.Polynomial.fit(place, y, 1)(place)
    means = y.reshape(4, 2).mean(axis=1).repeat(2)
    pure, lack = ((y - means) ** 2).sum() / 4, ((means - fitted) ** 2).sum() / 2
    found = lack_of_fit(place, y, fitted, 2)
    assert found["lack_of_fit_F"] == pytest.approx(lack / pure, rel=ROUNDING)
    assert found["p_value"] == pytest.approx(stats.f.sf(lack / pure, 2, 4), rel=ROUNDING)
    assert pure_error(place, y) == pytest.approx(math.sqrt(pure), rel=ROUNDING)
    curved = form_table(PLACES, scattered(lambda s: np.exp(0.03 * (s - TRUTH) * np.abs(s - TRUTH)), 2))
    assert curved.set_index("form").loc["ratio, line", "rejected"]


@pytest.mark.verify
def test_intervals_hold_the_crossing():
    """Of a line, of its own form as often as it says, over all forms at least so."""
    one = several = answered = 0
    for seed in range(TRIALS):
        ratio = scattered(line, seed)
        row = form_table(PLACES, ratio).set_index("form").loc["ratio, line"]
        one += row["interval_low"] <= TRUTH <= row["interval_high"]
        found = crossing(PLACES, ratio)
        answered += not found.reason
        several += not found.reason and found.low <= TRUTH <= found.high
    assert one / TRIALS == pytest.approx(CONFIDENCE, abs=CHANCE)
    assert several / answered >= CONFIDENCE - CHANCE and answered / TRIALS > CONFIDENCE - CHANCE


def test_the_side_changes_between_places_that_tell_it_themselves():
    """Whatever the form: the next place on each side whose own packings exclude the level."""
    found = crossing(PLACES, scattered(line, 3))
    assert (found.below, found.above) == (8.0, 9.0) or (found.below < TRUTH < found.above)
    assert found.packings == 3 and 0 < found.forms <= found.tried == len(FORMS)


def test_nothing_is_extended_beyond_the_places():
    """A ratio that stays below has no crossing; one whose interval reaches the last place has an open end."""
    low = PLACES < 8.0
    found = crossing(np.repeat([2.0, 3.0, 4.0], 3), scattered(line, 4, np.repeat([2.0, 3.0, 4.0], 3)))
    assert found.reason == "none between the smallest and the largest" and math.isnan(found.value)
    assert crossing(PLACES[low], line(PLACES[low])).reason.startswith("2 places")
    near = np.repeat([6.0, 7.0, 8.0, 8.6], 3)
    assert crossing(near, scattered(line, 5, near)).high == math.inf


def test_what_no_form_describes_is_said():
    """Packings that hardly scatter round a step."""
    found = crossing(PLACES, scattered(lambda s: np.where(s < TRUTH, 0.5, 2.0), 6))
    assert found.forms == 0 and found.reason == "no form tried describes the wear" and not found.bounded
    assert (found.below, found.above) == (8.0, 9.0)


def test_values_that_are_none_are_left_out():
    """NaN and zero ratios."""
    ratio = scattered(line, 7)
    more = np.r_[PLACES, 5.0, 5.0], np.r_[ratio, math.nan, 0.0]
    assert crossing(*more) == crossing(PLACES, ratio)
