"""What each block of a run is for, found as the run goes on: start-up, the shape as built, wear, the worn shape."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from bulkwear.workflows.cases.equipment.motions import last_change_s
from bulkwear.workflows.cases.equipment.parameters import start_up_blocks
from bulkwear.workflows.engine.schedule import Span

START_UP, PRISTINE, WEARING, WORN = "start_up", "pristine", "wearing", "worn"
PHASES = (START_UP, PRISTINE, WEARING, WORN)

Parameters = Mapping[str, Any]


def phase_of(span: Span) -> str:
    """Return the phase of a block; the first one is of the start-up."""
    return span.phase or START_UP


def next_block(run: Parameters, states: Sequence[Mapping[str, Any]]) -> Span | None:
    """Return the block after those that left these states, None after the last one.

    Of the rows of wear.csv in the states it takes `steady`, `deciding_width` and `fastest_step_per_s`.
    """
    spans = [Span(**state["span"]) for state in states]
    before, row = spans[-1], states[-1]["wear"]
    phase = _next_phase(run, spans, row)
    if phase is None:
        return None
    operation = before.operation_s + before.stands_for_s
    stands_for = 0.0
    if phase == WEARING:
        done = sum(span.phase == WEARING for span in spans)
        stands_for = hours_of_update(run, operation, done, row["fastest_step_per_s"])
    return Span(before.cycle + 1, before.end, before.steps, 1, phase, operation, stands_for)


def _next_phase(run: Parameters, spans: Sequence[Span], row: Mapping[str, float]) -> str | None:
    """Return the phase of the block after these, the last of which left that row; None after the last one."""
    phase, updates = phase_of(spans[-1]), run["updates"]
    count = sum(phase_of(span) == phase for span in spans)
    if phase == START_UP:
        steady = row["steady"] and _began_as_it_goes_on(run, spans[-1])
        return PRISTINE if steady or count + 1 >= start_up_blocks(run) else START_UP
    if phase == PRISTINE and not _sampled(run, count, row["deciding_width"]):
        return PRISTINE
    if phase in (PRISTINE, WEARING) and _wears_on(run, spans, row):
        return WEARING
    if phase == PRISTINE:
        return None
    worn = sum(span.phase == WORN for span in spans)
    return WORN if worn < updates["worn_blocks"] else None


def _began_as_it_goes_on(run: Parameters, span: Span) -> bool:
    """Return whether every part had its full speed when a block began, and stood if it stops in the start-up: before, a
    machine may rest steadily, or work as it does not while wear is counted.
    """
    motions = [part["motion"] for part in run["parts"] if part["motion"]]
    last = max((last_change_s(motion, run["start_up"]["most_s"]) for motion in motions), default=0.0)
    derived = run["derived"]
    return (derived["first_cycle_steps"] + span.first_step) * derived["time_step_s"] >= last


def _sampled(run: Parameters, blocks: int, width: float) -> bool:
    """Return whether so many blocks are enough; width: of the deciding patch's interval over its mean."""
    sampling = run["sampling"]
    known = blocks >= sampling["fewest_blocks"] and width <= sampling["width_fraction"]
    return known or blocks >= sampling["most_blocks"]


def _wears_on(run: Parameters, spans: Sequence[Span], row: Mapping[str, float]) -> bool:
    """Return whether another update follows: there are some left, operation is left, and something wears."""
    done = sum(span.phase == WEARING for span in spans)
    reached = spans[-1].operation_s + spans[-1].stands_for_s
    left = run["derived"]["operation_s"] - reached
    return done < run["updates"]["most"] and left > 0.0 and row["fastest_step_per_s"] > 0.0


def hours_of_update(run: Parameters, operation_s: float, done: int, fastest_step_per_s: float) -> float:
    """Return the operation (s) that the wear of the next block stands for.

    An even share of what is left, but no more than lets the fastest area patch recede by the step that
    `wear.largest_step_edge_fraction` allows.

    operation_s: so far; done: updates so far; fastest_step_per_s: recession of the fastest patch, in such
        steps, or what single nodes hold back (`blocks.held_back_per_s`)
    """
    share = (run["derived"]["operation_s"] - operation_s) / (run["updates"]["most"] - done)
    return min(share, 1.0 / fastest_step_per_s)
