"""Proposals of a search, on closed forms that scatter, with a limit and designs that are not allowed."""

import numpy as np
import pytest

from bulkwear.postproc.inference.improvement import Tried, best_of
from bulkwear.postproc.inference.proposals import Search
from bulkwear.postproc.inference.ranges import (
    Range,
    each_once,
    first_values,
    points_of,
    spread_values,
    values_near,
    values_of,
    without,
)

RANGES = (Range("height", 1.0, 6.0, 0.25), Range("radius", 2.0, 10.0, 0.5), Range("rows", 2, 8, 1))
INITIAL, OF_ROUND, MOST, SEEDS = 8, 2, 20, range(1, 7)
NOISE, LIMITED_NOISE, LIMIT = 0.04, 0.02, 0.0
CHANCE = 0.8  # of keeping to the limit, asked of the best design
FOUND = 0.02  # of the response, whose range is 0.8; twenty designs at random come within 0.03 to 0.10
IN_MOST = 0.8  # of the seeds


def response(values):
    """A valley with its floor at height 4.5, radius 7, 6 rows; -0.7 there, about 0 far away."""
    x = points_of(RANGES, values)
    return -0.7 * np.exp(-3.0 * ((x - points_of(RANGES, np.array([[4.5, 7.0, 6]]))) ** 2).sum(axis=1)) + 0.1 * x[:, 0]


def limited(values):
    """Above 0, and so beyond the limit, where high bumps are thin: it cuts the floor of the valley off."""
    return values[:, 0] / values[:, 1] - 0.6


def allowed(values):
    """Bumps in many rows must be small."""
    return values[:, 1] * values[:, 2] < 46.0


def simulated(values, chance):
    """Both responses as simulations give them."""
    count = len(values)
    return (
        response(values) + NOISE * chance.standard_normal(count),
        limited(values) + LIMITED_NOISE * chance.standard_normal(count),
    )


def search_of(values, results, seed):
    found, keeps = results
    noise, limited_noise = (deviation**2 * np.eye(len(values)) for deviation in (NOISE, LIMITED_NOISE))
    tried = Tried(points_of(RANGES, values), found, noise, keeps, limited_noise, LIMIT, seed)
    return Search(RANGES, values, tried, allowed)


def searched(seed):
    """A whole search: the last one, and every value that it proposed."""
    chance = np.random.default_rng(seed)
    values = first_values(RANGES, allowed, INITIAL, seed)
    results = simulated(values, chance)
    while len(values) < MOST:
        more = search_of(values, results, seed).proposed(OF_ROUND)
        results = tuple(np.append(old, new) for old, new in zip(results, simulated(more, chance), strict=True))
        values = np.vstack([values, more])
    return search_of(values, results, seed)


@pytest.fixture(scope="module")
def searches():
    return [searched(seed) for seed in SEEDS]


@pytest.fixture(scope="module")
def least():
    """The least of the response that is allowed and keeps to the limit, over all values there are."""
    every = spread_values(RANGES, 16384, 1)
    every = every[allowed(every) & (limited(every) <= LIMIT)]
    return response(every).min()


@pytest.mark.verify
def test_most_searches_find_the_least_that_keeps_to_the_limit(searches, least):
    """In twenty simulations; the best of as many at random is farther off in each."""
    best = np.array([search.best_predicted(CHANCE) for search in searches])
    hits = (response(best) - least <= FOUND) & (limited(best) <= LIMIT + LIMITED_NOISE)
    assert hits.mean() >= IN_MOST
    at_random = [spread_values(RANGES, 64, 100 + seed) for seed in SEEDS]
    sound = [values[allowed(values) & (limited(values) <= LIMIT)][:MOST] for values in at_random]
    assert not any(response(values).min() - least <= FOUND for values in sound)


@pytest.mark.verify
def test_proposals_are_values_within_the_ranges_each_once(searches):
    """On the steps, allowed, and none that was tried before."""
    for search in searches:
        assert len(each_once(search.values)) == MOST and allowed(search.values).all()
        for column, each in zip(search.values.T, RANGES, strict=True):
            assert each.low <= column.min() and column.max() <= each.high
            steps = (column - each.low) / each.step
            assert np.allclose(steps, np.round(steps))


@pytest.mark.verify
def test_the_same_results_give_the_same_proposals(searches):
    """However often a search was interrupted; with another result they are others."""
    search = searches[0]
    results = search.tried.values, search.tried.limited
    again = search_of(search.values.copy(), tuple(each.copy() for each in results), search.tried.seed)
    assert np.array_equal(again.proposed(OF_ROUND), search.proposed(OF_ROUND))
    other = results[0].copy()
    other[np.argmax(other)] = other.min() - 0.5
    assert not np.array_equal(
        search_of(search.values, (other, results[1]), search.tried.seed).proposed(OF_ROUND), search.proposed(OF_ROUND)
    )


def test_a_limit_that_nothing_keeps_to_is_approached():
    """The best is then what keeps to it most likely."""
    points = np.array([[0.1], [0.4], [0.6], [0.9]])
    noise = 1e-4 * np.eye(4)
    tried = Tried(points, np.array([1.0, 2.0, 3.0, 4.0]), noise, np.array([4.0, 3.0, 2.0, 1.0]), noise, 0.0)
    assert best_of(tried, points, 0.5) == 3


@pytest.mark.verify
def test_the_interval_holds_the_response_of_most_designs(searches):
    """95 % of it, of designs that were tried; at least four in five of all seeds together."""
    held = []
    for search in searches:
        _, low, high = search.tried.interval(search.tried.points)
        held.append((low <= response(search.values)) & (response(search.values) <= high))
    assert np.mean(held) >= 0.8


def test_ranges_that_hold_too_few_designs_are_refused():
    """With how many there are."""
    with pytest.raises(ValueError, match="found 0 designs"):
        first_values(RANGES, lambda values: np.zeros(len(values), bool), 4, 1)
    with pytest.raises(ValueError, match="found 3 designs"):
        first_values((Range("rows", 1, 3, 1),), lambda values: np.ones(len(values), bool), 4, 1)


def test_values_and_points_are_each_others_inverse():
    """A point is the middle of its value's part of the unit interval, so that both ends are as likely as the others."""
    values = spread_values(RANGES, 256, 3)
    assert np.array_equal(values_of(RANGES, points_of(RANGES, values)), values)
    rows = spread_values((Range("rows", 1, 4, 1),), 8, 3)
    assert sorted(rows[:, 0]) == [1.0, 2.0, 3.0, 4.0]
    assert points_of((Range("rows", 1, 4, 1),), np.array([[1.0], [4.0]]))[:, 0] == pytest.approx([0.125, 0.875])


def test_values_near_others_stay_within_the_ranges():
    """Near: within four times the reach of their centre, a step for rounding added."""
    centre = np.array([[1.0, 10.0, 5]])
    near = values_near(RANGES, centre, 0.05, 50, 1)
    for column, middle, each in zip(near.T, centre[0], RANGES, strict=True):
        assert each.low <= column.min() and column.max() <= each.high
        assert np.abs(column - middle).max() <= 4 * 0.05 * (each.high - each.low) + 2 * each.step
    assert len(without(near, near)) == 0
    assert len(without(near, near[:2])) == len(near) - 2
