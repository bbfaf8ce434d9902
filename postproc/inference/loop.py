"""The calibration itself: simulate where the acquisition rule says, until the stopping rule holds.

`simulate` is any function that simulates: LIGGGHTS in the workflow, a formula in the tests. Asked the same questions in
the same order it must give the same answers; then a calibration is the same however often it was interrupted.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.inference.acquisition import next_points, spread_over, surrogate_share
from bulkwear.postproc.inference.posterior import FAMILY_SHARE, densest, posterior_weights, recommended
from bulkwear.postproc.inference.problem import Experiment, Problem
from bulkwear.postproc.inference.surrogate import Surrogate, fit_surrogates, predictions

CANDIDATES_POWER = 12  # 4096 points carry the posterior
SEED_SPACING = 1000  # the largest gap between primes below 4e8 is 282, and a simulation needs a handful of them


def packing_seed(first: int, number: int) -> int:
    """Return the seed of a simulation's packing, far enough from that of the one before.

    The solver's own seeds are the next few primes above it; between numbers that are closer there may be none.
    """
    return first + SEED_SPACING * number


@dataclass(frozen=True)
class Request:
    """A simulation asked for. values: {parameter: value}; seed: of its packing; why: initial, rule or repeat."""

    test: str
    values: Mapping[str, float]
    seed: int
    why: str


Simulate = Callable[[Sequence[Request]], Sequence[Mapping[str, float]]]  # {response: value, response_uncertainty: ...}


@dataclass(frozen=True, eq=False)
class Posterior:
    """Points of the unit cube (n, p), their weights (n,), and the predictions of every response there.

    chosen: the point that was recommended before more simulations came in, None: what this posterior recommends
    """

    points: np.ndarray
    weights: np.ndarray
    predicted: Mapping[str, tuple[np.ndarray, np.ndarray]]
    surrogates: Mapping[str, Surrogate]
    chosen: int | None = None

    @property
    def recommended(self) -> int:
        """Which of the points is recommended."""
        return recommended(self.points, self.weights) if self.chosen is None else self.chosen


@dataclass(frozen=True, eq=False)
class Result:
    """simulations: one row each, in order, with test, seed, why, parameters and responses; shares: one row per look at
    the surrogate with simulations, test and surrogate_share; posterior: of all tests together."""

    simulations: pd.DataFrame
    shares: pd.DataFrame
    posterior: Posterior


def calibrate(problem: Problem, simulate: Simulate, say: Callable[[str], None] = lambda text: None) -> Result:
    """Run a calibration: every test in its order, each from its initial points to the stopping rule."""
    rows: list[dict[str, Any]] = []
    looks: list[dict[str, Any]] = []
    for test in problem.tests:
        known = posterior(problem, pd.DataFrame(rows)) if rows else None
        _simulate(problem, test, initial_points(problem, test, known), "initial", simulate, rows)
        while True:
            state = posterior(problem, pd.DataFrame(rows))
            share = surrogate_share(state.weights, state.predicted, problem.measured, test.responses)
            done = sum(row["test"] == test.name for row in rows)
            looks.append({"test": test.name, "simulations": done, "surrogate_share": share})
            say(f"{test.name}: {done} simulations, the surrogate's share of the variance is {share:.2f}")
            if share <= problem.surrogate_share or done >= test.most:
                break
            count = min(problem.parallel, test.most - done)
            own = {name: state.surrogates[name] for name in test.responses}
            chosen = next_points(_worth_simulating(state), own, problem.measured, count)
            _simulate(problem, test, chosen, "rule", simulate, rows)
    simulations = pd.DataFrame(rows)
    return Result(simulations, pd.DataFrame(looks), posterior(problem, simulations))


def posterior(problem: Problem, simulations: pd.DataFrame, power: int = CANDIDATES_POWER) -> Posterior:
    """Return the posterior that a table of simulations leads to, on 2^power points."""
    points = problem.spread_points(power)
    surrogates = fit_surrogates(problem, simulations)
    predicted = predictions(surrogates, points)
    return Posterior(points, posterior_weights(predicted, problem.measured), predicted, surrogates)


def initial_points(problem: Problem, test: Experiment, known: Posterior | None) -> np.ndarray:
    """Return the points of a test's first simulations: over the whole range, or over the family that is left."""
    if known is None:
        return problem.spread_points(math.ceil(math.log2(test.initial)))[: test.initial]
    family = densest(known.weights, FAMILY_SHARE)
    return spread_over(known.points, known.recommended, family, test.initial)


def _worth_simulating(state: Posterior) -> np.ndarray:
    """Return the candidates: points that the posterior does not rule out beyond doubt."""
    return state.points[state.weights >= 1e-6 * state.weights.max()]


def _simulate(
    problem: Problem, test: Experiment, points: np.ndarray, why: str, simulate: Simulate, rows: list[dict[str, Any]]
) -> None:
    """Simulate points and append a row for each."""
    requests = []
    for number, values in enumerate(problem.from_unit(points), start=len(rows)):
        named = dict(zip(problem.names, map(float, values), strict=True))
        requests.append(Request(test.name, named, packing_seed(problem.seed, number), why))
    for request, answer in zip(requests, simulate(requests), strict=True):
        head = {"test": request.test, "seed": request.seed, "why": request.why}
        rows.append({**head, **request.values, **answer})
