"""How often the terms of a screening are found, by method: definitive screening designs with known effects and noise.

    python -m benchmarks.selection_error_rates --output docs        # in the root of the repository, some ten minutes
    python -m benchmarks.selection_error_rates --output docs --redraw    # the page from its table, nothing computed

Writes selection_error_rates.csv and selection_error_rates.md.
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import pandas as pd

from benchmarks.command_line import at_least_one, command, output_folder, read_table
from benchmarks.page import markdown
from bulkwear.postproc.statistics.model_terms import Term, candidate_terms, term_columns
from bulkwear.postproc.statistics.screening_design import coded_design
from bulkwear.postproc.statistics.selection import Search, best_of_each
from bulkwear.postproc.statistics.two_steps import two_steps

FACTORS, FAKE = range(4, 13), (0, 2)
EFFECTS = (1.0, 2.0, 3.0)  # coefficients in coded units over the error's standard deviation
TRUTHS = ((0, 0), (2, 0), (3, 1), (3, 2))  # numbers of main effects and of second-order terms in them
TRIALS = 60
SEED = 20170319
NOTHING = 0.0  # effect where nothing acts
METHODS_SAID = """\
* search: the default, strong heredity, as many terms as the runs allow, by the corrected Bayesian criterion that counts
  the models
* strong heredity by AICc: the same models by AICc
* four terms by AICc: no heredity, at most four terms; right most often where just four act, never where more do
* two steps: the method of Jones and Nachtsheim"""

Find = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Of coded levels (n, factors) and responses (trials, n): which candidate terms are found, (trials, terms)."""


@dataclass(frozen=True)
class Case:
    """A design and what acts in it; effect: coefficients over the error's standard deviation (-)."""

    factors: int
    fake: int
    mains: int
    seconds: int
    effect: float


def by_search(coded: np.ndarray, responses: np.ndarray, **settings) -> np.ndarray:
    """Return what a search finds; settings: of `selection.Search`."""
    search = Search(candidate_terms(coded.shape[1]), coded, responses[0], **settings)
    return best_of_each(search, responses)[1]


def by_two_steps(coded: np.ndarray, responses: np.ndarray) -> np.ndarray:
    """Return what the two-step method finds."""
    terms = candidate_terms(coded.shape[1])
    found = [set(two_steps(coded, response).terms) for response in responses]
    return np.array([[term in each for term in terms] for each in found])


METHODS: dict[str, Find] = {
    "search": by_search,
    "strong heredity by AICc": partial(by_search, criterion="aicc"),
    "four terms by AICc": partial(by_search, criterion="aicc", heredity="none", most=4),
    "two steps": by_two_steps,
}


def cases(factors: Sequence[int], fake: Sequence[int], effects: Sequence[float]) -> list[Case]:
    """Return every design with every truth at every effect; where nothing acts, once."""
    return [
        Case(count, more, *truth, effect)
        for count, more, truth in itertools.product(factors, fake, TRUTHS)
        for effect in (effects if truth[0] else (NOTHING,))
    ]


def truth_of(case: Case, rng: np.random.Generator) -> list[Term]:
    """Return terms drawn at random: main effects, then squares and interactions of their factors."""
    active = sorted(int(k) for k in rng.choice(case.factors, case.mains, replace=False))
    pairs = list(itertools.combinations_with_replacement(active, 2))
    chosen = rng.choice(len(pairs), case.seconds, replace=False) if case.seconds else ()
    return [*((k,) for k in active), *(pairs[k] for k in chosen)]


def simulated(case: Case, trials: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return coded levels (n, factors), responses (trials, n) with an error of 1, and what acts, (trials, terms).

    Signs are drawn as well. The same case gives the same trials.
    """
    rng = np.random.default_rng([SEED, case.factors, case.fake, case.mains, case.seconds, round(10.0 * case.effect)])
    coded, terms = coded_design(case.factors, case.fake).astype(float), candidate_terms(case.factors)
    responses, true = rng.normal(size=(trials, len(coded))), np.zeros((trials, len(terms)), dtype=bool)
    for trial in range(trials):
        acting = truth_of(case, rng)
        true[trial] = [term in acting for term in terms]
        responses[trial] += term_columns(acting, coded) @ (case.effect * rng.choice([-1.0, 1.0], len(acting)))
    return coded, responses, true


def rates(found: np.ndarray, true: np.ndarray) -> dict[str, float]:
    """Return exact_percent of trials, and false_terms and missed_terms per trial; found, true: (trials, terms)."""
    return {
        "exact_percent": 100.0 * float((found == true).all(axis=1).mean()),
        "false_terms": float((found & ~true).sum(axis=1).mean()),
        "missed_terms": float((~found & true).sum(axis=1).mean()),
    }


def rates_of(case: Case, trials: int) -> list[dict]:
    """Return a line per method: the case, its runs, and the method's rates."""
    coded, responses, true = simulated(case, trials)
    told = {
        "factors": case.factors,
        "fake_factors": case.fake,
        "runs": len(coded),
        "main_effects": case.mains,
        "second_order_terms": case.seconds,
        "effect_over_error": case.effect,
        "trials": trials,
    }
    return [told | {"method": name, **rates(find(coded, responses), true)} for name, find in METHODS.items()]


def page(table: pd.DataFrame) -> str:
    """Return docs/selection_error_rates.md of a table as from `rates_of`."""
    trials = int(table["trials"].iloc[0])
    designs = table.groupby(["factors", "fake_factors"]).ngroups
    parts = [
        "# Error rates of selection",
        "Written by `python -m benchmarks.selection_error_rates`, every case in"
        " [selection_error_rates.csv](selection_error_rates.csv).",
        f"Definitive screening designs of {table['factors'].min()} to {table['factors'].max()} factors, each without"
        f" and with two fake factors, {trials} responses per case with normal error. Terms that act are drawn at random"
        " (squares and interactions only of factors that act); all have one size. Found exactly is a model with all"
        " terms that act and no other. In one case the share of it has a standard error of up to"
        f" {50.0 / np.sqrt(trials):.0f} points.",
        *said_of(table),
        METHODS_SAID,
        "## All designs together",
        f"Means over {designs} designs.",
        markdown(*summary_of(table)),
    ]
    for mains, seconds in table[["main_effects", "second_order_terms"]].drop_duplicates().to_numpy():
        rows = table[(table["main_effects"] == mains) & (table["second_order_terms"] == seconds)]
        parts += [f"## {words(mains, seconds)}", *told_by_design(rows)]
    return "\n\n".join(parts) + "\n"


def said_of(table: pd.DataFrame) -> list[str]:
    """Return what the table says of the default against AICc, and of fake factors, in sentences."""
    rich = table[table["second_order_terms"] == table["second_order_terms"].max()]
    rich = rich[rich["effect_over_error"] == rich["effect_over_error"].max()]
    acting = words(int(rich["main_effects"].iloc[0]), int(rich["second_order_terms"].iloc[0]))

    def mean(rows: pd.DataFrame, method: str, column: str) -> float:
        return float(rows.loc[rows["method"] == method, column].mean())

    def by_fake(method: str) -> str:
        shares = [mean(rich[rich["fake_factors"] == fake], method, "exact_percent") for fake in FAKE]
        return f"{shares[0]:.0f} % without and {shares[1]:.0f} % with fake factors"

    false = {method: mean(rich[rich["factors"] == rich["factors"].max()], method, "false_terms") for method in METHODS}
    default, akaike, steps = "search", "strong heredity by AICc", "two steps"
    return [
        f"AICc takes in too much where candidates are many: with {rich['factors'].max()} factors and {acting}, at"
        f" {rich['effect_over_error'].max():g} times the error, {false[akaike]:.1f} false terms per analysis, the"
        f" default {false[default]:.1f}. Over all designs the default finds exactly that model in {by_fake(default)},"
        f" AICc in {by_fake(akaike)}, the two steps in {by_fake(steps)}."
    ]


def words(mains: int, seconds: int) -> str:
    """Return what acts, as a heading."""
    second = f", {seconds} of second order" if seconds else ""
    return f"{mains} main effects{second}" if mains else "Nothing acts"


def summary_of(table: pd.DataFrame) -> tuple[list[str], list[list[str]]]:
    """Return head and rows of the means over all designs, by truth, effect and method."""
    keys = ["main_effects", "second_order_terms", "effect_over_error", "method"]
    means = table.groupby(keys, sort=False)[["exact_percent", "false_terms", "missed_terms"]].mean().reset_index()
    head = ["what acts", "effect over error (-)", "method", "exactly found (%)", "false terms", "missed terms"]
    rows = [
        [
            words(row.main_effects, row.second_order_terms),
            f"{row.effect_over_error:g}" if row.main_effects else "",
            *(row.method, f"{row.exact_percent:.0f}", f"{row.false_terms:.2f}", f"{row.missed_terms:.2f}"),
        ]
        for row in means.itertuples()
    ]
    return head, rows


def told_by_design(table: pd.DataFrame) -> list[str]:
    """Return a sentence and a table by design of one truth: share found exactly, and false terms, by method."""
    effects = sorted(table["effect_over_error"].unique())
    at = ", ".join(f"{effect:g}" for effect in effects)
    said = "Exactly found (%) / false terms per analysis" + (f", at {at} times the error." if effects[-1] else ".")
    methods = list(dict.fromkeys(table["method"]))
    rows = []
    for (factors, fake, runs), lines in table.groupby(["factors", "fake_factors", "runs"]):
        cells = [lines[lines["method"] == method].sort_values("effect_over_error") for method in methods]
        told = [
            ", ".join(f"{row.exact_percent:.0f} / {row.false_terms:.1f}" for row in cell.itertuples()) for cell in cells
        ]
        rows.append([str(factors), str(fake), str(runs), *told])
    return [said, markdown(["factors", "fake", "runs", *methods], rows)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=output_folder, default="docs")
    parser.add_argument("--trials", type=at_least_one, default=TRIALS)
    parser.add_argument("--redraw", action="store_true", help="write the page from the table that is there")
    given = parser.parse_args()
    file = given.output / "selection_error_rates.csv"
    if not given.redraw:
        lines = []
        for case in cases(FACTORS, FAKE, EFFECTS):
            lines += rates_of(case, given.trials)
            print(case, flush=True)
        pd.DataFrame(lines).to_csv(file, index=False, float_format="%.4g")
    file.with_suffix(".md").write_text(page(read_table(file)), encoding="utf-8")


if __name__ == "__main__":
    command(main)
