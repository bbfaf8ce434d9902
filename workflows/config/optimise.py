"""A search for the pattern of least wear: what a study asks of it, and the rows of its design that rounds have found.

    optimise: {factors: [{name: height_mm, low: 1, high: 6, step: 0.5}, ...], first_rows: 8, rows_of_round: 2, ...}

The first row of the design table is the reference. Rows O1, O2, ... follow it, `most_rows` of them. The first ones fill
the ranges evenly; each round of the study looks at what was simulated and says which values the next ones have. Until
then a row has a value of the even filling, by which its cost is forecast, and no packing.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from bulkwear.postproc.inference.ranges import Range, first_values
from bulkwear.postproc.mesh import PLAIN
from bulkwear.workflows.config.layers import ConfigError, Layer
from bulkwear.workflows.config.rounds import digest_of_text, rounds_of
from bulkwear.workflows.config.until import UNTIL

OPTIMISE = "optimise"  # key of the settings
ROWS, SURFACES, FACTORS = "rows", "surfaces", "factors"  # other keys of a study
ROW = "O"  # begins the names of rows that a search adds
CONFIRMED = 3  # settings that get more packings at the end: best predicted, best simulated, reference
NO_PROPOSAL_CHANGES = (  # with these settings: goals of the search, and what nothing is simulated again for
    *(f"{OPTIMISE}.{goal}" for goal in ("most_core_h", "most_rows", "confirming_packings")),
    *("solver.ranks", "solver.search", "solver.kept_restarts"),
    *("wear.wear_coefficient_error", "beyond_machine"),
)

Runs = Callable[[Layer], Sequence[Any]]  # the checked runs of a row; raises ConfigError

OF_SEARCH = ("first_rows", "rows_of_round", "most_rows", "confirming_packings", "most_core_h", "after_h", "seed")
FURTHER_OF_SEARCH = ("factors", "least_left_fraction", "largest_height_over_radius")
OF_FACTOR = ("name", "low", "high", "step")


@dataclass(frozen=True)
class Optimise:
    """What a study asks of a search.

    first_rows: before the first round; rows_of_round: that a round proposes; most_rows: in all
    packings: of every row; confirming_packings: of the best ones and the reference at the end
    most_core_h: of the solver, all runs and beds together
    after_h, least_left: hours (h) after which that share (-) of the pattern's volume or more must be left
    seed: of all that is drawn
    """

    factors: tuple[Range, ...]
    first_rows: int
    rows_of_round: int
    most_rows: int
    packings: int
    confirming_packings: int
    most_core_h: float
    after_h: float
    least_left: float
    seed: int

    @property
    def names(self) -> list[str]:
        """Return the columns of the factors."""
        return [each.name for each in self.factors]

    @property
    def rows(self) -> list[str]:
        """Return the names of the rows that the search may add."""
        return [f"{ROW}{number + 1}" for number in range(self.most_rows)]

    def first_packings(self, written: Sequence[str]) -> dict[str, int]:
        """Return how many packings settings have before the first round; written: those of the design table."""
        first = dict.fromkeys([*written, *self.rows[: self.first_rows]], self.packings)
        return first | dict.fromkeys(self.rows[self.first_rows :], 0)

    def foreseen(self, written: Sequence[str], rows: int | None = None) -> dict[str, int]:
        """Return how many packings settings have when a search of so many rows, or of all, has been confirmed."""
        added = self.rows[: self.most_rows if rows is None else min(rows, self.most_rows)]
        last = [written[0], *added[1 - CONFIRMED :]]
        more = dict.fromkeys(last, self.confirming_packings)
        return dict.fromkeys(self.rows, 0) | dict.fromkeys([*written, *added], self.packings) | more

    def said(self, study: str) -> str:
        """Return in a sentence what will be done."""
        return (
            f"{study}: after {self.first_rows} patterns that fill the ranges, {self.rows_of_round} are proposed in each"
            f" round, {self.most_rows} patterns and {self.most_core_h:g} core hours at most; the best is simulated in"
            f" {self.confirming_packings} packings."
        )


def optimise_of(settings: Mapping[str, Any]) -> Optimise | None:
    """Return what the settings ask of a search, None where nothing is looked for. Raises ConfigError for one of which
    something is missing: there are no defaults.
    """
    told = settings.get(OPTIMISE)
    if told is None:
        return None
    if missing := next((key for key in (*OF_SEARCH, *FURTHER_OF_SEARCH) if key not in told), None):
        raise ConfigError(f"{OPTIMISE}.{missing} is missing, allowed is {OPTIMISE} with all of its keys.")
    if part := next((each for each in told["factors"] if len(each) < len(OF_FACTOR)), None):
        raise ConfigError(f"{OPTIMISE}.factors has {part}, allowed are factors with {', '.join(OF_FACTOR)}.")
    return Optimise(
        factors=tuple(Range(**each) for each in told["factors"]),
        packings=settings["packings"],
        least_left=told["least_left_fraction"],
        **{key: told[key] for key in OF_SEARCH},
    )


def fault_of_search(asked: Optimise, settings: Mapping[str, Any], head: Mapping[str, Any]) -> str | None:
    """Return what of a study does not go together with its search, a phrase; None where all does."""
    surfaces = head.get(SURFACES, ())
    if other := next((key for key in (UNTIL, ROWS) if key in settings), None):
        return f"{other} stands beside {OPTIMISE}, allowed is one of them"
    if FACTORS in head:
        return f"{FACTORS} of a regression stand beside {OPTIMISE}, allowed is one of them"
    if PLAIN not in surfaces or len(surfaces) < 2:
        return f"{OPTIMISE} looks for least wear over plain, allowed is a study with surfaces of a pattern and {PLAIN}"
    if twice := next((name for name in asked.names if asked.names.count(name) > 1), None):
        return f"{OPTIMISE}.factors has {twice} twice, allowed is each factor once"
    if wrong := next((each for each in asked.factors if each.steps < 1), None):
        return f"{OPTIMISE}.factors has {wrong.name} from {wrong.low:g} to {wrong.high:g}, allowed is a step or more"
    if asked.most_rows < (least := asked.first_rows + asked.rows_of_round + 1):
        return f"{OPTIMISE}.most_rows is {asked.most_rows}, allowed are {least} or more: first rows, a round, the best"
    if asked.confirming_packings < asked.packings:
        return f"{OPTIMISE}.confirming_packings is {asked.confirming_packings}, allowed are {asked.packings} or more"
    return None


# ---------------------------------------------------------------- rows


def with_search(
    written: Sequence[Layer], settings: Mapping[str, Any], head: Mapping[str, Any], runs: Runs, folder: Path
) -> list[Layer]:
    """Return the rows of a design with those that its search adds; the design's alone where nothing is looked for.

    runs: of a row, checked; folder: results/<study>, whose rounds say what has been found
    Raises ConfigError where study and search do not go together, or the ranges hold too few patterns.
    """
    asked = optimise_of(settings)
    if asked is None:
        return list(written)
    where = f"{written[0].source}: " if written[0].source else ""
    if fault := fault_of_search(asked, settings, head):
        raise ConfigError(f"{fault}.")
    if taken := next((row for row in written if row.values["row"] in asked.rows), None):
        raise ConfigError(f"{taken.where()}: rows {ROW}1, {ROW}2, ... are the search's, allowed is another name.")
    if missing := next((name for name in asked.names if any(name not in row.values for row in written)), None):
        raise ConfigError(f"{where}column {missing} is a factor of the search, allowed is a design that gives it.")
    found = found_rows(folder, search_digest(settings, written))
    rows = _rows(asked, written, runs, found)
    return [*written, *(_row(written[0], name, values) for name, values in rows.items())]


def _row(reference: Layer, name: str, values: Mapping[str, float]) -> Layer:
    return replace(reference, values={**reference.values, **values, "row": name}, lines={}, block=f"row {name}")


def _rows(
    asked: Optimise, written: Sequence[Layer], runs: Runs, found: Mapping[str, Mapping[str, float]]
) -> dict[str, Mapping[str, float]]:
    """Return {row: {column: value}} of all rows of a search: the first ones, those that rounds found, and for others
    values by which their cost is forecast; each pattern once. Raises ConfigError.
    """

    def allowed(values: np.ndarray) -> np.ndarray:
        return np.array([fault_of(asked, written[0], runs, row) is None for row in values], dtype=bool)

    known = [[row.values[name] for name in asked.names] for row in written]
    if asked.most_rows < asked.first_rows + len(found):
        raise ConfigError(
            f"{OPTIMISE}.most_rows is {asked.most_rows}, allowed are {asked.first_rows + len(found)} or more, the rows"
            " that rounds have found"
        )
    try:
        first = first_values(asked.factors, allowed, asked.first_rows, asked.seed, known)
        known += [*first.tolist(), *([values[name] for name in asked.names] for values in found.values())]
        missing = asked.most_rows - asked.first_rows - len(found)
        rest = first_values(asked.factors, allowed, missing, asked.seed, known)
    except ValueError as fault:
        raise ConfigError(f"{OPTIMISE}: {fault}.") from None
    values = [*(named(asked, row) for row in first), *found.values(), *(named(asked, row) for row in rest)]
    return dict(zip(asked.rows, values, strict=True))


def named(asked: Optimise, values: Sequence[float]) -> dict[str, float]:
    """Return values in the order of the factors by their columns."""
    return {name: float(value) for name, value in zip(asked.names, values, strict=True)}


def fault_of(asked: Optimise, reference: Layer, runs: Runs, values: Sequence[float]) -> str | None:
    """Return why a pattern of these values cannot be simulated, a phrase without its place; None where it can."""
    row = _row(reference, f"{ROW}0", named(asked, values))
    try:
        runs(row)
    except ConfigError as fault:
        return str(fault).partition(": ")[2].rstrip(".")
    return None


# ---------------------------------------------------------------- rounds


def search_digest(settings: Mapping[str, Any], written: Sequence[Layer]) -> str:
    """Return the hash of what proposals depend on besides results, "" without a search: a round of another hash counts
    for nothing.
    """
    if OPTIMISE not in settings:
        return ""
    told = {**_that_count(settings), "rows": [row.values for row in written]}
    return digest_of_text(json.dumps(told, sort_keys=True, default=str))


def _that_count(settings: Mapping[str, Any], before: str = "") -> dict[str, Any]:
    """Return settings without those of NO_PROPOSAL_CHANGES; before: the section they stand in, with a point."""
    found = {key: value for key, value in settings.items() if f"{before}{key}" not in NO_PROPOSAL_CHANGES}
    return {k: _that_count(v, f"{before}{k}.") if isinstance(v, Mapping) else v for k, v in found.items()}


def found_rows(folder: Path, digest: str, before: int | None = None) -> dict[str, dict[str, float]]:
    """Return {row: {column: value}} of the rows that rounds have found so far, or before a round of that number."""
    rounds = itertools.islice(rounds_of(folder, digest), None if before is None else before - 1)
    return {name: values for found in rounds for name, values in found["rows"].items()}
