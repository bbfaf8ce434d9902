"""Where the feed of a machine falls first: on a part, before an outlet and while the run lasts."""

from __future__ import annotations

import math

import numpy as np
import pytest

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.workflows.cases.equipment.stream_checks import check_stream, first_met
from bulkwear.workflows.cases.equipment.surfaces import rectangle
from bulkwear.workflows.config.layers import ConfigError

G = 9.81  # m/s2
INLET = {"centre_m": [0.0, 0.0, 1.0], "normal": [0, 0, -1], "size_m": [0.1, 0.1], "velocity_m_per_s": [0.0, 0.0, -1.0]}
BELOW = {"centre_m": [0.0, 0.0, -1.0], "normal": [0, 0, -1], "size_m": [9.0, 9.0]}
DERIVED = {"run_in_steps": 1000, "travel_steps": 9000, "time_step_s": 1e-4}  # 1 s
PARTICLE = {"diameters_m": [0.004, 0.008]}
FLOOR = {"centre_m": [0.0, 0.0, 0.0], "normal": [0, 0, 1], "size_m": [0.4, 0.4]}
TURN = {"kind": "rotation", "point_m": [0.0, 0.0, 0.0], "axis": [0.0, 1.0, 0.0], "speed_rad_per_s": 6.0}


def checked(inlet=INLET, outlets=BELOW, floor=FLOOR, motion=None, **sections):
    run = {
        "inlet": inlet,
        "outlets": outlets and {"below": outlets},
        "periodic": None,
        "derived": DERIVED,
        "particle": PARTICLE,
    }
    return check_stream({**run, "parts": [{"name": "floor", "motion": motion}], **sections}, [rectangle(floor)])


def message_of(**given):
    with pytest.raises(ConfigError) as caught:
        checked(**given)
    return str(caught.value)


@pytest.mark.parametrize("upward", [-1.0, 0.0, 2.0])
def test_a_fall_takes_as_long_as_galileo_says(upward):
    """h = -v t + g t^2 / 2, down to a floor 1 m below."""
    (time,) = first_met(np.array([[0.03, 0.01, 1.0]]), np.array([0.0, 0.0, upward]), rectangle(FLOOR))
    assert time == pytest.approx((upward + math.sqrt(upward**2 + 2.0 * G)) / G)


def test_an_upright_wall_is_met_by_what_flies_level():
    """Distance over velocity: gravity has no part in it; what flies away from it, or above it, never meets it."""
    wall = rectangle({"centre_m": [1.0, 0.0, 0.0], "normal": [1, 0, 0], "size_m": [1.0, 1.0]})
    starts = np.array([[0.0, 0.0, 0.4], [2.0, 0.0, 0.4], [0.0, 0.0, 3.0]])
    assert first_met(starts, np.array([5.0, 0.0, 0.0]), wall).tolist() == pytest.approx([0.2, np.inf, np.inf])


def test_a_surface_in_any_order_is_met_first_where_it_is_nearest():
    """Of two floors the upper one."""
    upper = rectangle({**FLOOR, "centre_m": [0.0, 0.0, 0.5]})
    both = SurfaceMesh(
        np.concatenate([rectangle(FLOOR).points, upper.points]),
        np.concatenate([rectangle(FLOOR).triangles, upper.triangles + 4]),
    )
    start, still = np.array([[0.0, 0.0, 1.0]]), np.zeros(3)
    assert first_met(start, still, both) == first_met(start, still, upper) < first_met(start, still, rectangle(FLOOR))


def test_feed_that_falls_on_a_part_passes():
    """All of it, or its rim alone."""
    assert checked() is None
    assert checked(floor={**FLOOR, "centre_m": [0.24, 0.0, 0.0]}) is None


def test_feed_that_falls_past_all_parts():
    """Beside them, through an outlet before them, through one in the plane of the inlet, or into nothing."""
    allowed = "a place from which what comes in falls on a part: it falls past all of them"
    past = f"inlet.centre_mm is (0, 0, 1000) mm, allowed is {allowed}"
    assert message_of(floor={**FLOOR, "centre_m": [0.26, 0.0, 0.0]}) == f"{past}, through outlets.below."
    for height in (0.5, 1.0):
        assert message_of(outlets={**BELOW, "centre_m": [0.0, 0.0, height]}).startswith(past)
    nothing = message_of(floor={**FLOOR, "centre_m": [0.26, 0.0, 0.0]}, outlets=None)
    assert nothing.endswith("all of them, into nothing.")


def test_feed_of_which_some_falls_into_nothing():
    """Past a floor that is half below the inlet, and past an outlet as narrow: the first stray would stop the run.

    A wider outlet takes it; so does a floor whose edge the outermost particles touch.
    """
    narrow = {**BELOW, "size_m": [0.05, 9.0]}
    half = {**FLOOR, "centre_m": [0.21, 0.0, 0.0]}
    assert message_of(floor=half, outlets={**narrow, "centre_m": [0.1, 0.0, -1.0]}) == (
        "inlet.centre_mm is (0, 0, 1000) mm, allowed is a place from which what comes in all falls on a part or through"
        " an outlet: 45 of 81 flights, as from (-46, 46, 1000) mm, meet neither, and a particle that leaves elsewhere"
        " stops the run: move or narrow the inlet, or widen a part or an outlet."
    )
    assert checked(floor=half) is None
    assert checked(floor={**FLOOR, "size_m": [0.086, 0.4]}, outlets=narrow) is None


def test_feed_does_not_fall_through_a_gap_that_is_narrower_than_a_particle():
    """Between two halves of a floor, as through a joint; a gap as wide as two particles lets some through."""
    narrow = {**BELOW, "size_m": [0.05, 9.0], "centre_m": [1.0, 0.0, -1.0]}
    for gap, passes in ((0.006, True), (0.016, False)):
        halves = [rectangle({**FLOOR, "centre_m": [side * (0.2 + 0.5 * gap), 0.0, 0.0]}) for side in (-1.0, 1.0)]
        floor = SurfaceMesh(
            np.concatenate([half.points for half in halves]),
            np.concatenate([halves[0].triangles + 4 * k for k in (0, 1)]),
        )
        run = {"inlet": INLET, "outlets": {"below": narrow}, "periodic": None, "derived": DERIVED, "particle": PARTICLE}
        machine = {**run, "parts": [{"name": "floor", "motion": None}]}
        if passes:
            assert check_stream(machine, [floor]) is None
        else:
            with pytest.raises(ConfigError, match="9 of 81 flights, as from"):
                check_stream(machine, [floor])


def test_an_outlet_that_looks_up_from_below_a_machine_that_moves():
    """Nothing throws material up through it; through one beside a turning part it may; one may look down."""
    up = {**BELOW, "normal": [0, 0, 2]}
    assert message_of(outlets=up, motion=TURN) == (
        "outlets.below.normal is (0, 0, 2), allowed is whither material leaves: below all parts it falls, against the"
        " normal it would not be counted; turn it round."
    )
    filling = {"fraction": 0.2, "axis": "y", "centre_m": [0.1, 0.0, 0.05], "radius_m": 0.05, "length_m": 0.2}
    assert message_of(outlets=up, motion=TURN, inlet=None, filling=filling).startswith(
        "outlets.below.normal is (0, 0, 2)"
    )
    for given in (BELOW, {**up, "centre_m": [0.0, 0.0, -0.1]}, {**up, "normal": [2, 0, 1]}):
        assert checked(outlets=given, motion=TURN) is None


def test_a_filling_that_falls_past_all_parts():
    """Beside the floor; above it, or within a drum that turns round it, it falls on a part."""
    filling = {"fraction": 0.2, "axis": "y", "centre_m": [0.0, 0.0, 0.5], "radius_m": 0.1, "length_m": 0.2}
    assert checked(inlet=None, filling=filling) is None
    beside = {**filling, "centre_m": [0.4, 0.0, 0.5]}
    assert message_of(inlet=None, filling=beside) == (
        "filling.centre_mm is (400, 0, 500) mm, allowed is a place from which what is filled in falls on a part: it"
        " falls past all of them."
    )
    inside = {**filling, "centre_m": [0.1, 0.0, -0.05], "radius_m": 0.05}
    assert checked(inlet=None, filling=inside, motion=TURN) is None


def test_feed_that_comes_too_late():
    """A fall of 100 m takes longer than the longest run."""
    high = message_of(inlet={**INLET, "centre_m": [0.0, 0.0, 100.0]})
    assert high.endswith("gets to a part within the longest run, 1 s: it takes 4.41 s.")


def test_a_part_that_moves_may_meet_the_feed_wherever_it_gets_to():
    """A floor beside the feed that turns about its own far end sweeps below the inlet; about its middle it does not."""
    far = {**FLOOR, "centre_m": [0.4, 0.0, 0.0]}
    checked(floor=far, motion={**TURN, "point_m": [0.2, 0.0, 0.0]})
    assert "past all of them" in message_of(floor=far, motion={**TURN, "point_m": [0.4, 0.0, 0.0]})
    checked(motion=TURN, inlet={**INLET, "centre_m": [0.0, 0.0, 0.1]})  # within the box


def test_nothing_is_said_of_machines_that_meet_the_feed_later():
    """A feed that leaves a slice and comes in at its other end, a machine without a feed."""
    beside = {**FLOOR, "centre_m": [0.26, 0.0, 0.0]}
    assert checked(floor=beside, inlet=None) is None
    along = {**INLET, "velocity_m_per_s": [0.0, 1.0, -1.0]}
    assert checked(floor=beside, inlet=along, periodic={"axis": "y", "low_m": -0.1, "high_m": 0.1}) is None
