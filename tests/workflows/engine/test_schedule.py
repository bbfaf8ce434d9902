"""How long wear cycles are: equal parts, or what the caps allow."""

import itertools

import pytest

from bulkwear.workflows.engine.schedule import LEAST_CYCLE_STEPS, Span, cycle_title, first_span, known_spans, next_span
from tests.support.tiny import tiny_study

RUN = "R9_convex"


def parameters_of(**changes):
    """Parameters of the tiny convex run."""
    return tiny_study(**changes).run(RUN).parameters


def adaptive(**changes):
    """The same with adaptive cycles."""
    return parameters_of(sliding={"cycles": "adaptive", "first_cycle_mm": 20, "travel_mm": 400}, **changes)


def test_equal_cycles_fill_the_travel():
    """Spans follow on one another, are equally long and end with the travel."""
    parameters = parameters_of(sliding={"cycles": 3})
    spans = known_spans(parameters)
    assert [span.cycle for span in spans] == [1, 2, 3]
    assert all(after.first_step == before.end for before, after in itertools.pairwise(spans))
    assert len({span.steps for span in spans}) == 1
    assert spans[-1].end == parameters["derived"]["travel_steps"]


@pytest.mark.parametrize("factor", [0.5, 1.0, 2.0])
def test_an_adaptive_cycle_is_as_long_as_planned(factor):
    """The length of the cycle before, times what its wear lets expect."""
    parameters = adaptive()
    before = first_span(parameters)
    after = next_span(parameters, before, {"next_cycle_factor": factor})
    assert after.first_step == before.end
    assert after.steps == pytest.approx(factor * before.steps, abs=1)


def test_the_last_adaptive_cycle_takes_the_rest():
    """A rest of less than one and a half cycles is one cycle; after it there is none."""
    parameters = adaptive()
    total = parameters["derived"]["travel_steps"]
    steady = {"next_cycle_factor": 1.0}
    assert next_span(parameters, Span(5, total - 550, 200), steady) == Span(6, total - 350, 200)
    last = next_span(parameters, Span(5, total - 490, 200), steady)
    assert last.end == total
    assert next_span(parameters, last, steady) is None


def test_sampled_cycles_are_whole_samples():
    """With dumps every cycle holds a whole number of samples."""
    parameters = adaptive(ledger="dumps", solver={"sampling_interval_steps": 20})
    span = first_span(parameters)
    while span:
        assert span.steps % 20 == 0
        span = next_span(parameters, span, {"next_cycle_factor": 1.1})


def test_an_adaptive_cycle_resolves_contacts():
    """However fast the surface wears, a cycle keeps its hundred time steps."""
    assert next_span(adaptive(), Span(1, 0, 120), {"next_cycle_factor": 0.2}).steps == LEAST_CYCLE_STEPS


def test_only_the_first_adaptive_cycle_is_known():
    """Decks written without running the solver stop where the next length depends on what happens."""
    assert known_spans(adaptive()) == [first_span(adaptive())]
    assert cycle_title(adaptive(), 3) == "cycle 3"
    assert cycle_title(parameters_of(), 2) == "cycle 2 of 2"
