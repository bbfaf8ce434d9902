"""Service life: rules by hand, histories that reach a depth, and intervals that hold a known truth."""

import math

import numpy as np
import pytest

from bulkwear.postproc.statistics.block_means import mean_of_blocks
from bulkwear.postproc.statistics.intervals import Estimate, estimate, students_t
from bulkwear.postproc.statistics.worst_place import worst_place
from bulkwear.postproc.wear.service_life import (
    allowed_depth,
    allowed_volume,
    hour_reached,
    life,
    life_interval,
    throughput_mt,
)

EXACT = 1e-12  # -, of the same arithmetic
SURE = 4.0  # standard deviations of a counted share
REPEATS = 400
TRUTH, ALLOWED = 2e-6, 0.02  # m/h, m: 10,000 h
ALWAYS = 0.998  # -, of intervals so wide that they say nothing


# ---------------------------------------------------------------- rules


def test_allowed_depths():
    """What is above the thickness that remains, by millimetres, by a fraction, or through."""
    assert allowed_depth(0.03).tolist() == 0.03
    assert allowed_depth([0.03, 0.05], remaining_m=0.01) == pytest.approx([0.02, 0.04], rel=EXACT)
    assert allowed_depth([0.03, 0.05], remaining_fraction=0.4) == pytest.approx([0.018, 0.03], rel=EXACT)
    assert allowed_depth(0.03, 0.01, 0.5) == pytest.approx(0.015, rel=EXACT)  # the larger remains
    assert np.isnan(allowed_depth([math.nan, 0.01, 0.005], remaining_m=0.01)).all()


def test_the_mass_that_may_be_lost():
    """A third of the mass of one material is a third of its volume."""
    assert allowed_volume(0.3, 1.0 / 3.0) == pytest.approx(0.1, rel=EXACT)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: allowed_depth(0.03, remaining_m=-0.01), "the thickness that remains is -0.01 m, allowed is 0 or more"),
        (lambda: allowed_depth(0.03, remaining_fraction=1.0), "thickness that remains is 1, allowed is 0 to 1"),
        (lambda: allowed_volume(-0.3, 0.5), "the volume of the part is -0.3 m3, allowed is above 0"),
        (lambda: allowed_volume(0.3, 30.0), "the mass that is worn is 30, allowed is above 0 up to 1"),
        (lambda: life(estimate([1.0, 2.0]), 1.0, 0.01), "the wear coefficient is 1, allowed is 0 to less than 1"),
        (lambda: life(estimate([-1.0, -2.0]), 0.1, 0.01), "the rate of wear is -1.5 per hour, allowed is 0 or more"),
        (lambda: hour_reached([], [], 0.01), "found 0 hours and 0 depths, allowed is one depth per hour"),
        (lambda: hour_reached([0.0, 1.0], [0.0], 0.01), "found 2 hours and 1 depths, allowed is one depth per hour"),
        (lambda: hour_reached([0.0, 0.0], [0.0, 1.0], 0.01), "the hours of operation do not increase"),
    ],
)
def test_other_rules_are_refused(call, sentence):
    """One sentence that names what was found and what is allowed."""
    with pytest.raises(ValueError, match=sentence):
        call()


# ---------------------------------------------------------------- life


def test_a_life_is_allowed_over_rate():
    """Rates that are known to be TRUTH: 10,000 h; twice the rate or half of the thickness, half of the life."""
    sure = Estimate(TRUTH, 0.0, 5, 3, log=True)
    found = life(sure, 0.0, ALLOWED)
    assert (found.hours, found.low_h, found.high_h) == pytest.approx([1e4] * 3, rel=EXACT)
    assert life(Estimate(2.0 * TRUTH, 0.0, 5, 3, log=True), 0.0, ALLOWED).hours == pytest.approx(5e3, rel=EXACT)
    assert life(sure, 0.0, 0.5 * ALLOWED).hours == pytest.approx(5e3, rel=EXACT)
    assert math.isnan(found.scatter_share)


def test_without_scatter_the_interval_is_that_of_the_coefficient():
    """0.8 to 1.2 times the coefficient: 1/1.2 to 1/0.8 times the life."""
    found = life(Estimate(TRUTH, 0.0, 5, 3, log=True), 0.2, ALLOWED)
    assert (found.low_h, found.high_h) == pytest.approx((1e4 / 1.2, 1e4 / 0.8), rel=EXACT)
    assert found.scatter_share == 0.0


def test_without_an_error_of_the_coefficient_the_interval_is_that_of_the_rate():
    """The ends of the rate upside down, by Student's t in the logarithm."""
    rate = estimate([1.8e-6, 2.0e-6, 2.3e-6], log=True)
    found = life(rate, 0.0, ALLOWED)
    low, high = rate.interval()
    assert (found.low_h, found.high_h) == pytest.approx((ALLOWED / high, ALLOWED / low), rel=EXACT)
    assert found.scatter_share == 1.0
    assert life_interval(Estimate(found.hours, rate.error, rate.freedom, 3, log=True), 0.0) == pytest.approx(
        (found.low_h, found.high_h), rel=EXACT
    )


def test_both_are_added_as_squares():
    """Half widths in the logarithm of 3 and 4 make 5, and their shares are 9 and 16 of 25."""
    reach = 0.03
    error = math.tanh(0.04)  # the mean of both sides of which is 0.04 in the logarithm
    rate = Estimate(TRUTH, reach / students_t(0.975, 7.0), 7.0, 8, log=True)
    found = life(rate, error, ALLOWED)
    assert found.scatter_reach == pytest.approx(0.03, rel=EXACT)
    assert found.coefficient_reach == pytest.approx(0.04, rel=EXACT)
    assert found.scatter_share == pytest.approx(9.0 / 25.0, rel=EXACT)
    assert found.low_h == pytest.approx(1e4 * math.exp(-math.hypot(0.03, math.log1p(error))), rel=EXACT)
    assert found.high_h == pytest.approx(1e4 * math.exp(math.hypot(0.03, math.log1p(-error))), rel=EXACT)
    assert "scatter makes 36 % of its square and the wear coefficient 64 %" in found.said()
    assert (found.low_h, found.high_h) == life_interval(Estimate(1e4, rate.error, 7.0, 8, log=True), error)


def test_a_rate_that_is_not_of_the_logarithm():
    """Its half width over its value is taken in the logarithm, so that no end is below 0."""
    rate = estimate([1e-6, 2e-6, 3e-6])
    found = life(rate, 0.0, ALLOWED)
    assert rate.interval()[0] < 0.0 < found.low_h
    assert found.high_h / found.hours == pytest.approx(math.exp(rate.interval()[1] / TRUTH - 1.0), rel=EXACT)


def test_what_a_life_is_of():
    """Packings; this packing alone, by its blocks; or one packing with too few of them."""
    blocks = 2e-6 * (1.0 + 0.05 * np.random.default_rng(1).standard_normal(12))
    assert ", 3 packings" in life(mean_of_blocks(blocks, np.repeat([0, 1, 2], 4), log=True), 0.2, ALLOWED).said()
    alone = life(mean_of_blocks(blocks, log=True), 0.2, ALLOWED)
    assert alone.known
    assert "of this packing alone" in alone.said()
    short = life(mean_of_blocks(blocks[:2], log=True), 0.2, ALLOWED)
    assert not short.known
    assert short.hours > 0.0
    assert "one packing, scatter unknown" in short.said()


def test_hours_are_told_without_an_exponent():
    """Three digits, thousands apart by commas."""
    assert life(estimate([TRUTH]), 0.0, ALLOWED).said() == "10,000 h (one packing, scatter unknown)"
    found = life(Estimate(TRUTH, 0.02, 7.0, 8, log=True), 0.0, ALLOWED).said()
    assert found.startswith("10,000 h (95 % interval 9,540 to 10,500 h, 8 packings")


def test_what_does_not_wear_lasts():
    """Without a rate the life is infinite; of an unknown thickness or rate it is not known."""
    assert life(Estimate(0.0, 0.0, 5, 3), 0.2, ALLOWED).hours == math.inf
    for rate, allowed in ((0.0, math.nan), (TRUTH, math.nan), (math.nan, ALLOWED)):
        found = life(Estimate(rate, 0.1, 5, 3, log=True), 0.2, allowed)
        assert math.isnan(found.hours)
        assert not found.known


def test_other_units():
    """1,000 t/h for 10,000 h are 10 Mt; 5,000 h a year are two years."""
    found = life(Estimate(TRUTH, 0.1, 5, 3, log=True), 0.2, ALLOWED)
    assert found.throughput_mt(1000.0) == pytest.approx((10.0, found.low_h / 1000.0, found.high_h / 1000.0), rel=EXACT)
    assert found.years(5000.0) == pytest.approx((2.0, found.low_h / 5000.0, found.high_h / 5000.0), rel=EXACT)
    assert throughput_mt(1e4, 1000.0) == pytest.approx(10.0, rel=EXACT)


# ---------------------------------------------------------------- histories


HOURS, DEPTH = [0.0, 100.0, 300.0, 400.0], [0.0, 0.001, 0.002, 0.004]


@pytest.mark.parametrize(
    ("allowed", "hours", "extrapolated"),
    [
        (0.001, 100.0, False),
        (0.0015, 200.0, False),
        (0.003, 350.0, False),
        (0.004, 400.0, False),
        (0.005, 450.0, True),
        (0.0, 0.0, False),
    ],
)
def test_a_depth_is_reached(allowed, hours, extrapolated):
    """Between two entries on a straight line, beyond the last one at the last rate."""
    found = hour_reached(HOURS, DEPTH, allowed, 2e-5)
    assert found.hours == pytest.approx(hours, rel=EXACT)
    assert found.extrapolated == extrapolated


def test_what_is_lost_never_comes_back():
    """A depth that seems to fall stays; it is reached once, at the first time."""
    assert hour_reached([0.0, 100.0, 200.0, 300.0], [0.0, 0.002, 0.001, 0.003], 0.002) == (100.0, False)
    assert hour_reached([0.0, 100.0, 200.0], [0.0, 0.002, 0.001], 0.003, 1e-5).hours == pytest.approx(300.0)


def test_a_place_that_is_not_reached():
    """Without a rate never; where something is not known neither is the hour."""
    assert hour_reached(HOURS, DEPTH, 0.005, 0.0) == (math.inf, True)
    assert math.isnan(hour_reached(HOURS, DEPTH, 0.005).hours)
    assert math.isnan(hour_reached(HOURS, DEPTH, math.nan, 1e-5).hours)
    assert math.isnan(hour_reached(HOURS, DEPTH, math.nan, 0.0).hours)


def test_a_constant_rate_gives_the_life():
    """The history of a place that loses TRUTH all along is reached when `life` says, within it and beyond."""
    hours = np.linspace(0.0, 6000.0, 7)
    for allowed in (0.01, ALLOWED):
        told = life(Estimate(TRUTH, 0.0, 5, 3, log=True), 0.0, allowed).hours
        assert hour_reached(hours, TRUTH * hours, allowed, TRUTH).hours == pytest.approx(told, rel=EXACT)


# ---------------------------------------------------------------- coverage


EASIER = ((0.0, 1), (0.0, 60), (0.2, 1))  # error of the coefficient, alike places


def rates(random, packings, blocks, places, between, correlation=0.2):
    """Made-up rates (m/h) of alike places, and packing labels; neighbouring blocks are a little alike."""
    noise = random.standard_normal((packings, blocks, places))
    for k in range(1, blocks):
        noise[:, k] = correlation * noise[:, k - 1] + math.sqrt(1.0 - correlation**2) * noise[:, k]
    of_packings = np.exp(between * random.standard_normal((packings, 1, places)))
    values = TRUTH * of_packings * (1.0 + 0.1 * noise)
    return values.reshape(-1, places), np.repeat(np.arange(packings), blocks)


@pytest.mark.parametrize(("packings", "blocks"), [(3, 6), (5, 6), (1, 30)])
@pytest.mark.parametrize(
    ("error", "places"), [(0.2, 60), *(pytest.param(*each, marks=pytest.mark.verify) for each in EASIER)]
)
def test_the_interval_holds_the_life(packings, blocks, error, places):
    """At least 95 % of made-up runs within four deviations of the count, and not always: of one place, and of the worst
    of many alike ones; with a coefficient that is known to 20 %, off by one more factor.
    """
    random, inside = np.random.default_rng(2), 0
    for _ in range(REPEATS):
        values, labels = rates(random, packings, blocks, places, 0.05 * (packings > 1))
        assumed = math.exp(random.normal(0.0, math.atanh(error) / 1.96))
        found = worst_place(assumed * values, np.full(places, ALLOWED), labels)
        told = life(found.mean_load(), error, 1.0)
        inside += told.low_h <= ALLOWED / TRUTH <= told.high_h
    least = 0.95 if packings > 1 or places > 1 else 0.935  # of one packing with blocks that are a little alike
    assert least - SURE * math.sqrt(least * (1.0 - least) / REPEATS) < inside / REPEATS < ALWAYS
