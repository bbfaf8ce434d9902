"""What each block of a run is for, from rows of wear.csv as blocks would leave them."""

from dataclasses import asdict

import pytest

from bulkwear.workflows.cases.equipment.phases import PHASES, hours_of_update, next_block, phase_of
from bulkwear.workflows.engine.schedule import Span

HOUR = 3600.0
ROUND_OFF = 1e-12  # relative; a few sums of hours
STEADY, UNSTEADY = {"steady": 1}, {"steady": 0}
WIDE, NARROW = {"deciding_width": 0.9}, {"deciding_width": 0.3}
SLOW, IDLE = {"fastest_step_per_s": 1e-12}, {"fastest_step_per_s": 0.0}
MOST = 100  # blocks, none of the runs here is longer


def run_of(start_up=1.0, fewest=3, most=6, updates=4, worn=2, hours=1000.0, motion=None):
    """Parameters of a run with blocks of 0.2 s, which are 1000 steps."""
    return {
        "parts": [{"motion": motion}, {"motion": None}],
        "start_up": {"most_s": start_up},
        "sampling": {"block_s": 0.2, "fewest_blocks": fewest, "most_blocks": most, "width_fraction": 0.4},
        "updates": {"most": updates, "worn_blocks": worn},
        "derived": {"operation_s": hours * HOUR, "time_step_s": 2e-4, "first_cycle_steps": 1000},
    }


def spans_of(run, row_of):
    """All blocks of a run after the first one; row_of: span -> what its block leaves."""
    states, span = [], Span(1, 0, 1000)
    while span:
        row = {**STEADY, **NARROW, **SLOW, **row_of(span)}
        states.append({"span": asdict(span), "wear": row})
        assert len(states) < MOST
        span = next_block(run, states)
    return [Span(**state["span"]) for state in states]


def phases(run, row_of=lambda span: {}):
    return [phase_of(span) for span in spans_of(run, row_of)]


def count(found, phase):
    return found.count(phase)


def test_start_up_ends_when_the_flow_is_steady():
    """It goes on until a block says so."""
    for steady_from in (1, 2, 3):
        found = phases(run_of(start_up=10.0), lambda span, k=steady_from: STEADY if span.cycle >= k else UNSTEADY)
        assert count(found, "start_up") == steady_from


def test_start_up_does_not_end_before_parts_have_their_speed():
    """A machine that rests is steady, but not yet at work: behind the first block, which leaves no row, the fourth one
    begins at 0.8 s.
    """
    for motion, blocks in (({"start_s": 0.5, "ramp_s": 0.2}, 4), ({"ramp_s": 0.1}, 1), ({"kind": "belt"}, 1)):
        found = phases(run_of(start_up=10.0, motion=motion))
        assert count(found, "start_up") == blocks


@pytest.mark.parametrize(
    ("motion", "blocks"),
    [
        ({"stop_s": 0.7}, 4),
        ({"stop_s": 0.5, "ramp_s": 0.2}, 4),
        ({"start_s": 0.1, "stop_s": 0.1}, 1),
        ({"stop_s": 2.0}, 9),
        ({"ramp_s": 0.5, "stop_s": 1.7}, 3),
    ],
)
def test_start_up_does_not_end_before_parts_stand(motion, blocks):
    """A part that stops within the longest start-up of 2 s stands when wear is counted, its ramp down included. One
    that stops later, as the last one does with its ramp, goes on for all of the run.
    """
    assert count(phases(run_of(start_up=2.0, motion=motion)), "start_up") == blocks


def test_start_up_ends_with_its_longest_time():
    """One second is five blocks of 0.2 s: the first one, and four that leave a row."""
    assert count(phases(run_of(start_up=1.0), lambda span: UNSTEADY), "start_up") == 4
    assert count(phases(run_of(start_up=0.1), lambda span: UNSTEADY), "start_up") == 1


def test_later_unsteady_blocks_change_nothing():
    """Whether the flow is steady is asked for during the start-up alone."""
    assert phases(run_of(), lambda span: UNSTEADY if span.cycle > 1 else STEADY) == phases(run_of())


@pytest.mark.parametrize(("narrow_from", "blocks"), [(1, 3), (2, 3), (5, 5), (6, 6), (50, 6)])
def test_sampling_ends_when_the_deciding_rate_is_known(narrow_from, blocks):
    """Not before the fewest blocks, not after the most, between as soon as the interval is narrow enough."""
    found = phases(run_of(), lambda span: NARROW if span.cycle - 1 >= narrow_from else WIDE)
    assert count(found, "pristine") == blocks


def test_width_is_allowed_to_be_as_wide_as_asked():
    """0.4 is not above 0.4."""
    assert count(phases(run_of(), lambda span: {"deciding_width": 0.4}), "pristine") == 3
    assert count(phases(run_of(), lambda span: {"deciding_width": 0.4 + 1e-9}), "pristine") == 6


def test_phases_follow_one_another():
    """Start-up, the shape as built, wear, the worn shape; blocks and their steps are counted through."""
    spans = spans_of(run_of(), lambda span: {})
    assert [phase_of(span) for span in spans] == ["start_up", *["pristine"] * 3, *["wearing"] * 4, *["worn"] * 2]
    assert [span.cycle for span in spans] == list(range(1, 11))
    assert [span.first_step for span in spans] == list(range(0, 10000, 1000))
    assert {span.steps for span in spans} == {1000} and {span.substeps for span in spans} == {1}
    order = [PHASES.index(phase_of(span)) for span in spans]
    assert order == sorted(order)


def test_updates_share_out_the_operation():
    """Where caps allow it, each update stands for the same hours, all of them for the whole operation."""
    spans = spans_of(run_of(updates=4, hours=1000.0), lambda span: {})
    stands_for = [span.stands_for_s / HOUR for span in spans if span.phase == "wearing"]
    assert stands_for == pytest.approx([250.0] * 4, rel=ROUND_OFF)
    begins = [span.operation_s / HOUR for span in spans]
    assert begins == pytest.approx([0.0] * 5 + [250.0, 500.0, 750.0] + [1000.0] * 2, rel=ROUND_OFF)
    assert not [span.stands_for_s for span in spans if span.phase != "wearing" and span.stands_for_s]


def test_an_update_goes_no_further_than_the_cap():
    """The fastest patch recedes by one allowed step: 100 h here. What is left of the operation is not reached."""
    fast = {"fastest_step_per_s": 1.0 / (100.0 * HOUR)}
    spans = spans_of(run_of(updates=4, hours=1000.0), lambda span: fast)
    wearing = [span for span in spans if span.phase == "wearing"]
    assert [span.stands_for_s / HOUR for span in wearing] == pytest.approx([100.0] * 4, rel=ROUND_OFF)
    assert spans[-1].operation_s == pytest.approx(400.0 * HOUR, rel=ROUND_OFF)


def test_later_updates_make_up_for_capped_ones():
    """Where wear slows down, what is left is shared out among the updates that are left, and none goes beyond it."""

    def row_of(span):
        return {"fastest_step_per_s": 1.0 / (100.0 * HOUR) if span.operation_s < 200.0 * HOUR else 1e-12}

    spans = spans_of(run_of(updates=5, hours=1000.0), row_of)
    stands_for = [span.stands_for_s / HOUR for span in spans if span.phase == "wearing"]
    assert stands_for == pytest.approx([100.0, 100.0, 100.0, 350.0, 350.0], rel=ROUND_OFF)


def test_hours_of_an_update_are_the_share_or_the_cap():
    """The smaller of the two, at any moment."""
    run = run_of(updates=4, hours=1000.0)
    assert hours_of_update(run, 400.0 * HOUR, 2, 1e-12) == pytest.approx(300.0 * HOUR, rel=ROUND_OFF)
    assert hours_of_update(run, 400.0 * HOUR, 3, 1e-12) == pytest.approx(600.0 * HOUR, rel=ROUND_OFF)
    assert hours_of_update(run, 400.0 * HOUR, 2, 1.0 / 7.0) == 7.0


def test_a_run_without_updates_ends_after_sampling():
    """There is no worn shape to look at."""
    assert phases(run_of(updates=0)) == ["start_up", *["pristine"] * 3]


def test_a_run_in_which_nothing_wears_ends_after_sampling():
    """No hours make a shape of it."""
    assert phases(run_of(), lambda span: IDLE | WIDE) == ["start_up", *["pristine"] * 6]


def test_a_run_without_operation_is_not_worn():
    """Nothing is to be predicted."""
    assert phases(run_of(hours=0.0)) == ["start_up", *["pristine"] * 3]


def test_updates_end_when_nothing_wears_any_more():
    """The worn shape is looked at all the same."""
    found = phases(run_of(), lambda span: IDLE if span.cycle >= 6 else SLOW)
    assert found == ["start_up", *["pristine"] * 3, *["wearing"] * 2, *["worn"] * 2]


def test_a_run_without_worn_blocks_ends_with_its_last_update():
    """None was asked for."""
    assert phases(run_of(worn=0))[-1] == "wearing"
