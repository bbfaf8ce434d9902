"""How long the wear cycles of a run are: equal parts of its travel, or each as long as the one before lets expect."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from bulkwear.workflows.engine.derived import ADAPTIVE

LEAST_CYCLE_STEPS = 100  # fewer time steps do not resolve a single contact, let alone a cycle


@dataclass(frozen=True)
class Span:
    """A wear cycle and where it lies in the travel over which wear is counted.

    cycle: its number, from 1; first_step: time steps of that travel before it; steps: of the cycle itself; substeps: in
    so many the solver takes each of its steps, where the run's time step would be too large for this cycle
    Where cycles stand for spans of operation that are found as the run goes on: phase: what the cycle is for;
    operation_s: operation before it; stands_for_s: operation that its wear stands for
    """

    cycle: int
    first_step: int
    steps: int
    substeps: int = 1
    phase: str = ""
    operation_s: float = 0.0
    stands_for_s: float = 0.0

    @property
    def solver_steps(self) -> int:
        """Time steps that the solver takes in the cycle."""
        return self.steps * self.substeps

    @property
    def end(self) -> int:
        """Time steps of the travel until the cycle ends."""
        return self.first_step + self.steps


def first_span(parameters: Mapping[str, Any]) -> Span:
    """Return the span of the first wear cycle of a run."""
    return Span(1, 0, parameters["derived"]["first_cycle_steps"])


def next_span(parameters: Mapping[str, Any], before: Span, wear: Mapping[str, float]) -> Span | None:
    """Return the span of the cycle after `before`, whose row of wear.csv is `wear`; None when the travel is done.

    An adaptive cycle is as long as the caps let expect at the rate at which the fastest node receded, in whole samples.
    A rest shorter than half a cycle is added to the last one.
    """
    rest = parameters["derived"]["travel_steps"] - before.end
    if rest <= 0:
        return None
    steps = before.steps
    if parameters["sliding"]["cycles"] == ADAPTIVE:
        sampled = parameters["solver"].get("sampling_interval_steps", 1)
        steps = max(steps * wear["next_cycle_factor"], LEAST_CYCLE_STEPS)
        steps = math.ceil(steps / sampled) * sampled
        if rest < 1.5 * steps:
            steps = rest
    return Span(before.cycle + 1, before.end, min(steps, rest))


def known_spans(parameters: Mapping[str, Any]) -> list[Span]:
    """Return the wear cycles that are known before any of them ran: all equal ones, of adaptive ones the first."""
    spans = [first_span(parameters)]
    if parameters["sliding"]["cycles"] != ADAPTIVE:
        while span := next_span(parameters, spans[-1], {}):
            spans.append(span)
    return spans


def cycle_title(parameters: Mapping[str, Any], cycle: int) -> str:
    """Return what people call a wear cycle."""
    cycles = parameters["sliding"]["cycles"]
    return f"cycle {cycle}" if cycles == ADAPTIVE else f"cycle {cycle} of {cycles}"
