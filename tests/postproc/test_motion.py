"""Poses of moving parts against closed forms, and the solver's lines, summed up as the solver does it."""

import math

import numpy as np
import pytest

from bulkwear.postproc.courses import Steady, Swinging
from bulkwear.postproc.motion import (
    AT_REST,
    Motion,
    angular_oscillation,
    belt,
    combined,
    oscillation,
    rotation,
    translation,
    turning_surface,
)

ROUND_OFF = 1e-14  # m and rad; numbers of order one in float64
SUMMED = 1e-10  # s or -; over a thousand steps, with arguments of sines up to 5,000 rad that are good to 1e-12
POINT, AXIS = (0.1, -0.2, 0.3), (1.0, 2.0, -2.0)
POINTS = np.random.default_rng(11).normal(size=(20, 3))


def turned(points, point, axis, angle):
    """Points (n, 3) turned about an axis through a point, by complex numbers in the plane across the axis."""
    axis = np.asarray(axis) / np.linalg.norm(axis)
    across = np.linalg.svd(axis[None])[2][1]
    third = np.cross(axis, across)
    offset = points - np.asarray(point)
    plane = (offset @ across + 1j * (offset @ third)) * np.exp(1j * angle)
    return np.outer(offset @ axis, axis) + np.outer(plane.real, across) + np.outer(plane.imag, third) + point


def test_rest_moves_nothing():
    """A part at rest stays bit for bit, and the deck holds no line of its motion."""
    assert np.array_equal(AT_REST.placed(POINTS, 7.3), POINTS)
    assert AT_REST.deck_lines("plate", 7.3) == ()
    assert AT_REST.mesh_words() == ""


def test_translation_is_velocity_times_time():
    """x = x0 + v t, and no turn."""
    motion = translation((1.0, -2.0, 0.5))
    assert motion.placed(POINTS, 3.0) == pytest.approx(POINTS + np.array([3.0, -6.0, 1.5]), abs=ROUND_OFF)
    assert np.array_equal(motion.pose(3.0)[0], np.eye(3))


@pytest.mark.parametrize("time", [0.0, 0.37, 12.0])
def test_rotation_is_right_handed_about_its_axis(time):
    """Points go round the axis by omega t, anticlockwise seen against it; the axis itself stays."""
    motion = rotation(POINT, AXIS, 0.7)
    assert motion.placed(POINTS, time) == pytest.approx(turned(POINTS, POINT, AXIS, 0.7 * time), abs=10 * ROUND_OFF)
    on_axis = np.asarray(POINT) + np.outer([-1.0, 0.0, 2.5], AXIS)
    assert motion.placed(on_axis, time) == pytest.approx(on_axis, abs=10 * ROUND_OFF)
    quarter = rotation((0.0, 0.0, 0.0), (0.0, 0.0, 5.0), math.pi / 2).placed([[1.0, 0.0, 0.0]], 1.0)
    assert quarter == pytest.approx(np.array([[0.0, 1.0, 0.0]]), abs=ROUND_OFF)


def test_poses_are_rigid():
    """Every pose is a rotation: orthogonal, of determinant 1."""
    motions = (
        rotation(POINT, AXIS, 3.0),
        angular_oscillation(POINT, AXIS, 0.4, 2.0),
        combined(rotation(POINT, AXIS, 1.0)),
    )
    for motion in motions:
        matrix = motion.pose(1.7)[0]
        assert matrix @ matrix.T == pytest.approx(np.eye(3), abs=ROUND_OFF)
        assert np.linalg.det(matrix) == pytest.approx(1.0, abs=ROUND_OFF)


def test_ramp_loses_half_of_its_time():
    """Nothing before the start, t^2 / (2 ramp) in the ramp, t - ramp / 2 after it."""
    course = Steady(start_s=2.0, ramp_s=0.5)
    times = [1.0, 2.0, 2.25, 2.5, 4.0]
    assert [course.gone(time) for time in times] == pytest.approx([0.0, 0.0, 0.0625, 0.25, 1.75], abs=ROUND_OFF)
    assert [course.pace(time) for time in times] == [None, None, None, 1.0, 1.0]


def test_stop_is_a_ramp_down():
    """From the stop on the pace falls as it grew: the whole course is as long as from start to stop at full pace."""
    course = Steady(start_s=2.0, ramp_s=0.5, stop_s=4.0)
    times = [4.0, 4.25, 4.5, 100.0]
    assert [course.gone(time) for time in times] == pytest.approx([1.75, 1.9375, 2.0, 2.0], abs=ROUND_OFF)
    assert [course.pace(time) for time in times] == [None, None, 0.0, 0.0]
    assert translation(AXIS, start_s=1.0, stop_s=2.0).deck_lines("slide", 2.0) == ()


def test_oscillation_swings_about_the_drawn_place():
    """A sin(2 pi t / T + phase), the same after any number of periods."""
    motion = oscillation((0.2, 0.0, -0.1), period_s=0.25, phase_rad=math.pi / 6)
    assert motion.pose(0.0)[1] == pytest.approx([0.1, 0.0, -0.05], abs=ROUND_OFF)
    assert motion.pose(0.0625)[1] == pytest.approx(np.array([0.2, 0.0, -0.1]) * math.cos(math.pi / 6), abs=ROUND_OFF)
    assert motion.pose(250_000.0625)[1] == pytest.approx(motion.pose(0.0625)[1], abs=ROUND_OFF)


def test_angular_oscillation_turns_to_and_fro():
    """The angle is amplitude sin(2 pi t / T + phase)."""
    motion = angular_oscillation(POINT, AXIS, 0.3, period_s=2.0, phase_rad=0.2)
    angle = 0.3 * math.sin(math.pi * 0.7 + 0.2)
    assert motion.placed(POINTS, 0.7) == pytest.approx(turned(POINTS, POINT, AXIS, angle), abs=10 * ROUND_OFF)


def test_combined_motions_carry_one_another():
    """The last motion moves the body, the one before it moves what came of that."""
    slide, shaft = translation((1.0, 0.0, 0.0)), rotation(POINT, AXIS, 2.0)
    both = combined(slide, shaft)
    assert both.placed(POINTS, 0.9) == pytest.approx(slide.placed(shaft.placed(POINTS, 0.9), 0.9), abs=10 * ROUND_OFF)


def test_carried_axis_stands_where_it_was_carried():
    """A shaft on a slide turns about a point that the slide has taken along by the time the lines are for."""
    lines = combined(translation((1.0, 0.0, 0.0)), rotation(POINT, AXIS, 2.0)).deck_lines("drum", 3.0)
    assert lines[0] == "fix move_drum_1 all move/mesh mesh drum linear 1 0 0"
    origin = [float(word) for word in lines[1].partition("origin ")[2].split()[:3]]
    assert origin == pytest.approx([3.1, -0.2, 0.3], abs=ROUND_OFF)


def test_motion_that_is_over_may_be_turned():
    """A bucket that was pushed and is then tipped: the push has come to its end before the turn begins."""
    push, tip = translation((1.0, 0.0, 0.0), stop_s=2.0), rotation((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.5, start_s=2.0)
    tipped = combined(tip, push).placed([[0.0, 1.0, 0.0]], 2.0 + math.pi)
    assert tipped == pytest.approx(np.array([[-1.0, 2.0, 0.0]]), abs=ROUND_OFF)
    assert len(combined(tip, push).deck_lines("bucket", 3.0)) == 1


def test_constant_motions_need_no_variables():
    """A constant velocity is the solver's `linear`, a constant angular velocity its `rotate`."""
    assert translation((1.0, -2.0, 0.5)).deck_lines("chute_3", 8.0) == (
        "fix move_chute_3 all move/mesh mesh chute_3 linear 1 -2 0.5",
    )
    (line,) = rotation((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), -math.pi).deck_lines("drum", 8.0)
    assert line == "fix move_drum all move/mesh mesh drum rotate origin 1 0 0 axis 0 0 1 period -2"


def solver_sum(course, begin, step, steps):
    """What the solver adds up in that many steps: its variables of the mean pace, evaluated at the end of each."""
    formulas = [line.split(maxsplit=3)[1::2] for line in course.pace_lines("part")]

    def mean_pace(end):
        names = {"sin": math.sin, "cos": math.cos, "abs": abs, "dt": step, "v_part_time": end}
        for name, formula in formulas:
            names[f"v_{name}"] = eval(formula, names)
        return names["v_part_pace"]

    return sum(step * mean_pace(begin + k * step) for k in range(1, steps + 1))


@pytest.mark.parametrize("step", [1e-5, 3.7e-3])
@pytest.mark.parametrize(
    "course",
    [
        Steady(start_s=10.001, ramp_s=0.004),
        Steady(start_s=10.0041),
        Steady(start_s=9.99, ramp_s=0.1),
        Steady(start_s=11.0),
        Steady(start_s=9.0, ramp_s=0.001, stop_s=10.0033),
        Steady(start_s=9.0, stop_s=10.00515),
        Swinging(0.0173, 0.4),
        Swinging(0.5, -2.0),
    ],
    ids=str,
)
def test_formula_adds_up_to_the_closed_form(course, step):
    """The solver's sum over its steps is what the course goes meanwhile, however the steps lie to start and period."""
    begin, steps = 10.0, 1000
    expected = course.gone(begin + steps * step) - course.gone(begin)
    assert solver_sum(course, begin, step, steps) == pytest.approx(expected, abs=SUMMED)


def test_lines_of_a_swing():
    """The time of a swing goes on from the step where its lines stand; the fix takes a variable per axis."""
    lines = oscillation((0.2, 0.0, -0.1), period_s=2.0 * math.pi).deck_lines("sieve", 12.5)
    assert lines == (
        "variable move_sieve_first equal $(step)",
        "variable move_sieve_time equal 12.5+(step-v_move_sieve_first)*dt",
        "variable move_sieve_pace equal 2.0*sin(0.5*1*dt)*cos(1*(v_move_sieve_time-0.5*dt)+0)/dt",
        "variable move_sieve_x equal 0.20000000000000001*v_move_sieve_pace",
        "variable move_sieve_y equal 0*v_move_sieve_pace",
        "variable move_sieve_z equal (-0.10000000000000001)*v_move_sieve_pace",
        "fix move_sieve all move/mesh mesh sieve linear/variable v_move_sieve_x v_move_sieve_y v_move_sieve_z",
    )


def test_belt_rests_and_tells_its_velocity():
    """A belt has the words of its mesh, no line that moves it, and the pose of a part at rest."""
    assert belt((0.0, -4.5, 0.0)).mesh_words() == "surface_vel 0 -4.5 0"
    words = turning_surface((0.0, 1.0, 0.0), (1.0, 0.0, 0.0), -2.0).mesh_words()
    assert words == "surface_ang_vel origin 0 1 0 axis 1 0 0 omega -2"
    assert belt((0.0, -4.5, 0.0)).deck_lines("belt", 1.0) == ()
    assert np.array_equal(belt((0.0, -4.5, 0.0)).placed(POINTS, 2.0), POINTS)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: translation((0.0, 0.0, 0.0)), "three finite numbers that are not all 0"),
        (lambda: translation((1.0, math.nan, 0.0)), "three finite numbers"),
        (lambda: translation((1.0, 0.0, 0.0), ramp_s=-1.0), "allowed are a ramp >= 0 s"),
        (lambda: translation((1.0, 0.0, 0.0), start_s=1.0, ramp_s=0.5, stop_s=1.4), "a stop after the ramp"),
        (lambda: rotation(POINT, (0.0, 0.0, 0.0), 1.0), "axis of a motion"),
        (lambda: rotation(POINT, AXIS, 0.0), "allowed are finite numbers, not 0"),
        (lambda: oscillation((1.0, 0.0, 0.0), 0.0), "period of 0.0 s"),
        (lambda: belt((0.0, 0.0, 0.0)), "velocity of a belt"),
        (lambda: combined(belt((1.0, 0.0, 0.0)), rotation(POINT, AXIS, 1.0)), "motion 0 of a combination is a Belt"),
        (lambda: combined(AT_REST), "motion 0 of a combination is a Motion"),
        (lambda: combined(rotation(POINT, AXIS, 1.0), translation((1.0, 0.0, 0.0))), "allowed are parallel ones"),
    ],
)
def test_refusals(make, said):
    """What is no motion, or one that the solver would make another of, is refused in one sentence."""
    with pytest.raises(ValueError, match=said):
        make()


def test_every_motion_is_one():
    """All that the module makes is a Motion, which can be compared and be a key."""
    made = (AT_REST, translation(AXIS), rotation(POINT, AXIS, 1.0), oscillation(AXIS, 1.0), belt(AXIS))
    assert all(isinstance(motion, Motion) for motion in made)
    assert len(set(made)) == len(made)
    assert translation(AXIS) == translation(AXIS)
