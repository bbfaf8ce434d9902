"""Toe and shoulder of a charge that is known, in any machine, and the convention that published angles have."""

import numpy as np
import pytest

from bulkwear.postproc.flow.charge_angles import (
    BIN_DEG,
    charge_angles,
    polar_places,
    turning_frame,
)

RADIUS, BALL = 2.0, 0.025  # m, of shell and balls
TOE, SHOULDER = 128.0, 303.0  # degrees
KALALA_SLOPE = 34.68  # degrees, quoted beside his toe and shoulder
SCATTER = 6.0  # degrees: less than half of the widest bell's standard deviation
ROUNDED_END = 1.5 * BIN_DEG  # degrees: of intervals, and of balls that lie across the end


def charge(generator, count=40_000, toe=TOE, shoulder=SHOULDER, axis=(0.0, 1.0, 0.0), point=(0.0, 0.0, 0.0)):
    """Balls that fill the segment below the chord from toe to shoulder evenly, in a mill about any level axis."""
    top, ahead = turning_frame(np.array(axis))
    places = generator.uniform(-RADIUS, RADIUS, (8 * count, 2))  # forward, high
    ends = np.radians([toe, shoulder])
    (x0, x1), (z0, z1) = RADIUS * np.sin(ends), RADIUS * np.cos(ends)
    inside = np.hypot(*places.T) < RADIUS - BALL
    chord = np.sign((x1 - x0) * (-RADIUS - z0) - (z1 - z0) * (0.0 - x0))  # the side of 6 o'clock
    below = chord * ((x1 - x0) * (places[:, 1] - z0) - (z1 - z0) * (places[:, 0] - x0)) > 0.0
    forward, high = places[inside & below][:count].T
    along = generator.uniform(-0.1, 0.1, len(high))[:, None] * np.array(axis)
    return np.array(point) + forward[:, None] * ahead + high[:, None] * top + along


def angles(positions, axis=(0.0, 1.0, 0.0), point=(0.0, 0.0, 0.0)):
    return charge_angles(positions, np.full(len(positions), BALL), point, axis)


@pytest.mark.parametrize("axis", [(0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.6, -0.8, 0.0)])
@pytest.mark.parametrize(("toe", "shoulder"), [(128.0, 303.0), (150.0, 330.0), (100.0, 260.0)])
def test_the_ends_of_a_segment_are_found(toe, shoulder, axis):
    """Both ends, to an interval, wherever the axis points: a rotation the other way mirrors them."""
    point = (3.0, -2.0, 1.0)
    positions = charge(np.random.default_rng(1), toe=toe, shoulder=shoulder, axis=axis, point=point)
    found = angles(positions, axis, point)
    assert (found.toe_deg, found.shoulder_deg) == pytest.approx((toe, shoulder), abs=ROUNDED_END)
    other = angles(positions, tuple(-np.array(axis)), point)
    assert (other.toe_deg, other.shoulder_deg) == pytest.approx((360.0 - shoulder, 360.0 - toe), abs=ROUNDED_END)


def test_few_particles_scatter_and_do_not_mislead():
    """Of two thousand balls two hundred lie at the shell: over twenty fillings the ends are right in the mean."""
    found = [angles(charge(np.random.default_rng(seed), count=2000)) for seed in range(20)]
    off = np.array([(each.toe_deg - TOE, each.shoulder_deg - SHOULDER) for each in found])
    assert off.std(axis=0).max() < SCATTER
    assert np.abs(off.mean(axis=0)).max() < 3.0 * SCATTER / np.sqrt(len(found))


def test_particles_in_flight_do_not_move_the_toe():
    """A tenth of the balls spread evenly over the whole mill leave both ends where they are."""
    generator = np.random.default_rng(2)
    resting = charge(generator)
    radius, angle = RADIUS * np.sqrt(generator.uniform(size=4000)), generator.uniform(0.0, 2.0 * np.pi, 4000)
    flying = np.column_stack([radius * np.sin(angle), np.zeros(4000), radius * np.cos(angle)])
    found = angles(np.concatenate([resting, flying]))
    assert (found.toe_deg, found.shoulder_deg) == pytest.approx((TOE, SHOULDER), abs=ROUNDED_END)


@pytest.mark.parametrize("lifters", [8, 24])
def test_lifters_do_not_end_the_charge(lifters):
    """Where lifters stand at every instant there are no balls: the charge goes on behind each of them."""
    positions = charge(np.random.default_rng(3))
    distance, angle = polar_places(positions, (0.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    away = np.abs((angle - 5.0 + 180.0 / lifters) % (360.0 / lifters) - 180.0 / lifters)
    kept = (away > 2.0) | (distance < RADIUS - 0.15)
    assert not kept.all()
    found = angles(positions[kept])
    assert (found.toe_deg, found.shoulder_deg) == pytest.approx((TOE, SHOULDER), abs=ROUNDED_END + 2.0)


def test_the_charge_may_go_over_the_top():
    """An arc that ends beyond 12 o'clock is one arc."""
    generator = np.random.default_rng(4)
    angle = np.radians(generator.uniform(120.0, 380.0, 20_000))
    positions = (RADIUS - BALL) * np.column_stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)])
    found = angles(positions)
    assert (found.toe_deg, found.shoulder_deg) == pytest.approx((120.0, 20.0), abs=ROUNDED_END)


def test_a_charge_that_centrifuges_has_no_ends():
    generator = np.random.default_rng(5)
    angle = generator.uniform(0.0, 2.0 * np.pi, 50_000)
    positions = (RADIUS - BALL) * np.column_stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)])
    found = angles(positions)
    assert np.isnan([found.toe_deg, found.shoulder_deg]).all()
    assert found.shell_m == pytest.approx(RADIUS, rel=1e-9)


def test_faults_are_told():
    with pytest.raises(ValueError, match="found none"):
        angles(np.zeros((0, 3)))
    with pytest.raises(ValueError, match="upright"):
        turning_frame((0.0, 0.0, 2.0))


# ---------------------------------------------------------------- the convention


def morrell(speed, filling):
    """Toe and shoulder in degrees from 3 o'clock by the fits of Morrell (1996); speed over the critical one."""
    limit = max(speed, 0.35 * (3.364 - filling))
    toe = 2.5307 * (1.2796 - filling) * (1.0 - np.exp(-19.42 * (limit - speed))) + 0.5 * np.pi
    down = (0.3386 + 0.1041 * speed) + (1.54 - 2.5673 * speed) * filling
    return np.degrees(toe), np.degrees(0.5 * np.pi - (toe - 0.5 * np.pi) * down) % 360.0


def test_published_angles_have_their_origin_at_12_oclock():
    """The chord of Kalala's charge has the slope that is quoted beside its ends, and Morrell's charge at that speed
    has like ends, only where the origin is 12 o'clock.
    """
    slope = (TOE + SHOULDER) / 2.0 - 180.0
    assert slope == pytest.approx(KALALA_SLOPE, abs=1.0)
    assert abs(slope - 90.0 - KALALA_SLOPE) > 45.0 and abs(slope + 90.0 - KALALA_SLOPE) > 45.0
    speed = 15.7 / (42.3 / np.sqrt(4.267 - 0.05))
    assert speed == pytest.approx(0.76, abs=0.01)
    published = (np.array([TOE, SHOULDER]) + 90.0) % 360.0  # from 3 o'clock, as Morrell has them
    fitted = np.array(morrell(speed, 0.3))
    assert np.abs(published - fitted).max() < 20.0  # degrees: the fits are of other liners and fillings
    assert np.abs(np.array([TOE, SHOULDER]) - fitted).min() > 60.0


def test_top_and_sides_of_a_mill():
    """About +y the top moves to +x: 0 is the top, 90 on the falling side, 180 the bottom, 270 on the rising side."""
    places = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]])
    distance, angle = polar_places(places, (0.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    np.testing.assert_allclose(angle, [0.0, 90.0, 180.0, 270.0], atol=1e-9)
    np.testing.assert_allclose(distance, 1.0)
    velocity = np.cross([0.0, 1.0, 0.0], places)
    assert velocity[3, 2] > 0.0 and velocity[1, 2] < 0.0
