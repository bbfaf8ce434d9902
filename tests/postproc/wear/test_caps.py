"""Largest step of a node in one update."""

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.wear.caps import (
    AIMED_DEMAND,
    CAP_SHARES,
    HELD_BACK,
    LARGEST_CYCLE_FACTOR,
    MOST_TRIES,
    Caps,
    gap_closing_step,
    next_cycle_factor,
    step_limit,
    wanted_step,
)

ROUNDING = 1e-12  # relative: a handful of products


def test_edge_limit_is_the_fraction_of_the_shortest_edge():
    """With a long cycle only the geometry counts: fraction times the shortest edge at the node."""
    mesh = flat_plate(6.0, 4.0, 1.0)
    mesh.points[mesh.points[:, 0] == 3.0, 0] = 2.5  # the last column of cells is half as wide
    limit = step_limit(mesh.points, mesh.triangles, 0.1, 0.01, 1e6)
    narrow = mesh.points[:, 0] >= 2.0
    np.testing.assert_allclose(limit[narrow], 0.05, rtol=ROUNDING)
    np.testing.assert_allclose(limit[~narrow], 0.1, rtol=ROUNDING)


def test_time_limit_is_the_free_fall_of_that_fraction_of_the_cycle():
    """A particle falls d = g (f T)^2 / 2 in the time f T, so closing the gap takes the fraction f of T."""
    duration = 0.2
    limit = step_limit(*_plate(), 0.5, 0.01, duration)
    np.testing.assert_allclose(limit, 0.5 * 9.81 * 0.002**2, rtol=ROUNDING)
    fall = np.sqrt(2.0 * limit / 9.81)
    np.testing.assert_allclose(fall, 0.01 * duration, rtol=ROUNDING)


def test_gap_closing_step_grows_with_the_square_of_time():
    """Twice the cycle, four times the step."""
    assert gap_closing_step(0.01, 2.0, 9.81) == pytest.approx(4.0 * gap_closing_step(0.01, 1.0, 9.81), rel=ROUNDING)


def test_unused_node_gets_the_time_limit():
    """A node of no triangle has no edge: the time limit alone, never NaN or infinity."""
    points, triangles = _plate()
    limit = step_limit(np.vstack((points, [[9.0, 9.0, 9.0]])), triangles, 0.1, 0.01, 1.0)
    assert limit[-1] == gap_closing_step(0.01, 1.0, 9.81)


@pytest.mark.parametrize(
    ("numbers", "name"),
    [
        ((0.0, 0.01, 1.0, 9.81), "edge_fraction"),
        ((0.6, 0.01, 1.0, 9.81), "edge_fraction"),
        ((np.nan, 0.01, 1.0, 9.81), "edge_fraction"),
        ((0.1, 0.0, 1.0, 9.81), "gap_closing_time_fraction"),
        ((0.1, 0.01, -1.0, 9.81), "cycle_duration_s"),
        ((0.1, 0.01, 1.0, 0.0), "gravity"),
    ],
)
def test_numbers_out_of_range_are_named(numbers, name):
    """Each number outside its range is refused by name."""
    with pytest.raises(ValueError, match=f"{name} is"):
        step_limit(*_plate(), *numbers)


def _plate():
    mesh = flat_plate(6.0, 4.0, 1.0)
    return mesh.points, mesh.triangles


def test_wanted_step_is_what_was_taken_and_newly_held_back():
    """Volume carried from before is no demand of this cycle, applying it later neither; holder nodes want nothing."""
    step, area = np.array([1e-5, 2e-5, 0.0, 9.0]), np.array([1e-6, 1e-6, 1e-6, 0.0])
    before, after = np.array([0.0, 5e-12, 5e-12, 0.0]), np.array([3e-12, 0.0, 5e-12, 1.0])
    np.testing.assert_allclose(wanted_step(step, before, after, area), [1.3e-5, 1.5e-5, 0.0, 0.0], rtol=ROUNDING)


@pytest.mark.parametrize(("wanted", "factor"), [(4e-5, 2.0), (8e-5, 1.0), (1.6e-4, 0.5), (1e-2, 0.2), (0.0, 2.0)])
def test_next_cycle_aims_below_the_cap_from_the_edges(wanted, factor):
    """Where no gap has to close the step is scaled to 0.8 of the cap, within a fifth and twice the length."""
    assert next_cycle_factor(np.array([0.0, wanted]), np.full(2, 1e-4)) == pytest.approx(factor)


def test_next_cycle_is_not_shortened_where_the_gap_is_what_holds_back():
    """A shorter cycle gives gaps less time: where both caps bind, the length at which they meet is the best one."""
    limit, gap = 1e-7, gap_closing_step(0.01, 0.01, 9.81)
    factor = next_cycle_factor(np.array([1e-6]), np.array([limit]), gap)
    assert factor == pytest.approx(min(np.sqrt(AIMED_DEMAND * limit / gap), LARGEST_CYCLE_FACTOR))
    assert factor > 1.0


def test_caps_shrink_near_places_down_to_nothing_and_everywhere_down_to_the_last_share():
    """Three edges round a place; where that does not help, or after too many tries, all of them."""
    mesh = flat_plate(1.0, 1.0, 0.05)
    limit, place = np.full(len(mesh.points), 2.0), np.array([[0.5, 0.5, 0.0]])
    caps = Caps(limit, mesh)
    away = np.linalg.norm(mesh.points - place, axis=1) > (HELD_BACK + 1.0) * np.sqrt(2.0) / 20
    here = np.linalg.norm(mesh.points - place, axis=1) < 1.0 / 20
    for share in (*CAP_SHARES[1:], 0.0):
        assert caps.shrunk(place)
        assert (caps.cap[away] == 2.0).all() and (caps.cap[here] == 2.0 * share).all()
    for share in CAP_SHARES[1:]:
        assert caps.shrunk(place)
        assert (caps.cap[away] == 2.0 * share).all() and (caps.cap[here] == 0.0).all()
    assert not caps.shrunk(place) and not caps.shrunk(None)
    tired = Caps(limit, mesh)
    for turn in range(MOST_TRIES):
        tired.shrunk(mesh.points[[7 * turn]])
    assert (tired.cap == limit).any() and tired.shrunk(place) and (tired.cap < limit).all()
