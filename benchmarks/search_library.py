"""The search for the best pattern beside a library: how near to the least, at as many simulations, in closed forms.

    python -m benchmarks.search_library --output docs --library PYTHON   # in the root of the repository
    python -m benchmarks.search_library --output docs --redraw           # the page from its table, nothing computed

PYTHON: an interpreter that has BoTorch (pip install botorch; some 5 GB), none of the project's; without it ours is
compared with designs spread evenly. Writes search_library.csv, a line per search, and search_library.md.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.command_line import command, output_folder, read_table
from benchmarks.search_page import LIBRARY, OURS, SPREAD, page
from benchmarks.search_truths import HALF, TRUTHS, Truth
from bulkwear.postproc.inference.improvement import INTERVAL, Tried, best_of
from bulkwear.postproc.inference.proposals import Search
from bulkwear.postproc.inference.ranges import first_values, points_of, spread_values
from bulkwear.workflows.cases.sliding_sample.search.rounds import CHANCE
from bulkwear.workflows.config.design import load_study

PROGRAM = Path(__file__).parent / "peer_programs" / "botorch_search.py"
SEARCHES = 16  # per response and method, each with errors and first designs of its own
NOISE = 0.1  # -, standard deviation of a simulation's error over that of the response
FILE, PAGE = "search_library.csv", "search_library.md"


def every_design(values: np.ndarray) -> np.ndarray:
    """Return that each design (n, p) can be simulated."""
    return np.ones(len(values), dtype=bool)


@dataclass
class State:
    """A search so far: its designs (n, p), their responses with errors (n, 2), and the processor time taken in s."""

    truth: Truth
    method: str
    seed: int
    values: np.ndarray
    simulated: np.ndarray = field(init=False)
    cpu_s: float = 0.0

    def __post_init__(self) -> None:
        self.values, start = self.values[:0], self.values
        self.simulated = np.empty((0, 2))
        self.add(start)

    def add(self, values: np.ndarray) -> None:
        """Simulate designs (m, p). The k-th simulation of a seed has the same errors by every method."""
        known, count = len(self.values), len(self.values) + len(values)
        errors = np.random.default_rng(self.seed).standard_normal((count, 2))[known:]
        found = np.column_stack(self.truth.true_values(values)) + errors * self.deviations
        self.values, self.simulated = np.vstack([self.values, values]), np.vstack([self.simulated, found])

    @property
    def deviations(self) -> np.ndarray:
        """Standard deviations (2,) of the errors of both responses."""
        return NOISE * np.array(self.truth.spread)

    @property
    def tried(self) -> Tried:
        """What our search knows."""
        noise = [np.eye(len(self.values)) * deviation**2 for deviation in self.deviations]
        points = points_of(self.truth.ranges, self.values)
        response, limited = self.simulated.T
        return Tried(points, response, noise[0], limited, noise[1], HALF, self.seed)

    @property
    def search(self) -> Search:
        """Our search."""
        return Search(self.truth.ranges, self.values, self.tried, every_design)

    def asked(self, candidates: np.ndarray, count: int) -> dict[str, Any]:
        """Return what a library is asked, JSON-able: the next `count` of the candidates (m, p)."""
        response, limited = self.simulated.T.tolist()
        variances = [[deviation**2] * len(self.values) for deviation in self.deviations]
        return {
            "points": points_of(self.truth.ranges, self.values).tolist(),
            **{"values": response, "variances": variances[0], "limited": limited, "limited_variances": variances[1]},
            "candidates": points_of(self.truth.ranges, candidates).tolist(),
            **{"limit": HALF, "count": count, "seed": self.seed},
        }


def ask_library(python: Path, states: Sequence[State], count: int) -> list[dict[str, Any]]:
    """Return the library's answer to each search, with the `values` (count, p) that come next, chosen from the
    candidates of ours. Raises RuntimeError with its last words.
    """
    candidates = [state.search.candidates() if count else state.values[:0] for state in states]
    asked = [state.asked(each, count) for state, each in zip(states, candidates, strict=True)]
    before = children_s()
    with TemporaryDirectory() as folder:
        question, told = Path(folder) / "asked.json", Path(folder) / "answers.json"
        question.write_text(json.dumps(asked))
        done = subprocess.run([python, PROGRAM, question, told], capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(f"{python} {PROGRAM}: {' '.join(done.stderr.strip().splitlines()[-1:])}")
        answers = json.loads(told.read_text())
    for state, each, answer in zip(states, candidates, answers, strict=True):
        state.cpu_s += (children_s() - before) / len(states)
        answer["values"] = each[answer["next"]]
    return answers


def children_s() -> float:
    """Return the processor time (s) of the processes that were started and have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def answer_of_ours(state: State) -> dict[str, float]:
    """Return which tried design our search holds for the best, with mean and deviation of its response."""
    tried = state.tried
    best = best_of(tried, tried.points, CHANCE)
    mean, low, high = tried.interval(tried.points[[best]])
    return {"best": best, "mean": float(mean[0]), "deviation": float((high - low)[0] / (2.0 * INTERVAL))}


def line_of(state: State, answer: dict[str, Any]) -> dict[str, Any]:
    """Return how a search ended. missed: how far its best design is from the least, over how far a design at random
    is (-); one beyond the limit by more than an error counts as one at random.
    """
    truth = state.truth
    true, limited = (float(each[0]) for each in truth.true_values(state.values[[answer["best"]]]))
    keeps = limited <= HALF + state.deviations[1]
    return {
        **{"response": truth.name, "method": state.method, "search": state.seed, "simulations": len(state.values)},
        "missed": round(max(true - truth.least, 0.0) / (truth.at_random - truth.least) if keeps else 1.0, 4),
        "keeps_limit": bool(keeps),
        "version": answer.get("version", ""),
        "in_interval": bool(abs(answer["mean"] - true) <= INTERVAL * answer["deviation"]),
        "cpu_s": round(state.cpu_s, 2),
    }


def start_states(truths: Sequence[Truth], methods: Sequence[str], first: int, most: int, count: int) -> list[State]:
    """Return the searches before their first round; designs spread evenly are all simulated at once."""
    begin = {
        (truth, seed): first_values(truth.ranges, every_design, first, seed)
        for truth in truths
        for seed in range(1, count + 1)
    }
    found = [State(truth, method, seed, values) for (truth, seed), values in begin.items() for method in methods]
    return found + [State(truth, SPREAD, seed, spread_values(truth.ranges, most, seed)) for truth, seed in begin]


def searches(
    python: Path | None, truths: Sequence[Truth], first: int, of_round: int, most: int, count: int
) -> pd.DataFrame:
    """Return a line per search; first, of_round, most: designs to begin with, of a round and in all."""
    states = start_states(truths, [OURS, *([LIBRARY] if python else [])], first, most, count)
    ours, library = ([state for state in states if state.method == method] for method in (OURS, LIBRARY))
    for known in range(first, most, of_round):
        new = min(of_round, most - known)
        for state in ours:
            started = time.process_time()
            chosen = state.search.proposed(new)
            state.cpu_s += time.process_time() - started
            state.add(chosen)
        for state, answer in zip(library, ask_library(python, library, new) if library else [], strict=True):
            state.add(answer["values"])
        print(f"{known + new} of {most} simulations", flush=True)
    answers = iter(ask_library(python, library, 0) if library else [])
    return pd.DataFrame(
        [line_of(state, next(answers) if state.method == LIBRARY else answer_of_ours(state)) for state in states]
    )


def main() -> None:
    """Search, and write table and page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--output", type=output_folder, default="benchmark")
    parser.add_argument("--library", type=Path)
    parser.add_argument("--redraw", action="store_true")
    given = parser.parse_args()
    if not given.redraw:
        asked = load_study("optimised_pattern").optimise
        found = searches(given.library, TRUTHS, asked.first_rows, asked.rows_of_round, asked.most_rows, SEARCHES)
        found.to_csv(given.output / FILE, index=False)
    (given.output / PAGE).write_text(
        page(read_table(given.output / FILE, keep_default_na=False), NOISE), encoding="utf-8"
    )


if __name__ == "__main__":
    command(main)
