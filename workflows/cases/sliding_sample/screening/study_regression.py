"""A screening study's regression: from a design and the wear of its runs to models, effects and a best design.

The response is the logarithm of the normalised wear, the factors are in coded units (Yan 2022, section 3.5.4).
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.factors import Factor, half_normal_table
from bulkwear.postproc.statistics.model_terms import Heredity, Term, candidate_terms, parse_term, term_name, told_apart
from bulkwear.postproc.statistics.optimum import best_design
from bulkwear.postproc.statistics.regression import (
    CONSTANT,
    Fit,
    coefficient_table,
    fit,
    fit_measures,
    predict,
    residual_table,
)
from bulkwear.postproc.statistics.selection import (
    PERMUTATIONS,
    Choice,
    PermutationTest,
    Search,
    best_models,
    permutation_test,
)
from bulkwear.postproc.statistics.two_steps import TwoSteps, two_steps

HEREDITIES: tuple[Heredity, ...] = ("strong", "weak", "none")
FEWEST_RUNS = 4  # with four only the mean can be judged: the criterion needs four more than a model has terms


@dataclass(frozen=True, eq=False)
class Screening:
    """The regression of a screening study.

    factors: with short names
    design_rows, design_coded: (runs,) names and (runs, factors) coded levels of the whole design
    used: (runs,) True where there is a result
    response: (n,) of the used runs, ln of wear over the largest wear; largest_wear: in the unit that was given
    candidates: terms that the used runs tell apart; lost: others, each with the term it cannot be told from, or None
    choices: {heredity: models as good as the best of it, best first}
    model: fit of the best model of strong heredity
    by_aicc: best model of strong heredity by AICc; by_two_steps: what the two-step method finds, or why it cannot
    nuisances: {what: (n,) values of the used runs} that ought to be the same in all runs
    """

    factors: tuple[Factor, ...]
    design_rows: np.ndarray
    design_coded: np.ndarray
    used: np.ndarray
    response: np.ndarray
    largest_wear: float
    candidates: tuple[Term, ...]
    lost: tuple[tuple[Term, Term | None], ...]
    choices: dict[Heredity, list[Choice]]
    model: Fit
    by_aicc: Choice
    by_two_steps: TwoSteps | str
    nuisances: dict[str, np.ndarray] = field(default_factory=dict)

    @property
    def names(self) -> list[str]:
        """Return the short names of the factors."""
        return [factor.name for factor in self.factors]

    @property
    def coded(self) -> np.ndarray:
        """Return the coded levels of the used runs, (n, factors)."""
        return self.design_coded[self.used]

    def fit_of(self, terms: Sequence[Term | str]) -> Fit:
        """Return the fit of any model; terms as tuples or names such as b*d. Raises ValueError as `fit`."""
        parsed = [parse_term(term, self.names) if isinstance(term, str) else term for term in terms]
        return fit(parsed, self.coded, self.response)


def log_normalised(wear: np.ndarray) -> np.ndarray:
    """Return ln of wear over the largest wear, (n,); NaN where there is no result above zero."""
    values = np.asarray(wear, dtype=float)
    usable = np.where(np.isfinite(values) & (values > 0.0), values, np.nan)
    return np.log(usable / np.nanmax(usable)) if np.isfinite(usable).any() else usable


def screen(
    design: pd.DataFrame,
    factors: Mapping[str, Factor],
    wear: np.ndarray,
    nuisances: Mapping[str, np.ndarray] | None = None,
) -> Screening:
    """Return the regression of a screening study.

    design: a line per run, with `row` and a column per factor in real units
    factors: {column of the design: factor, whose name is the short one}
    wear: (runs,) in any one unit; runs where it is NaN or not above zero have no result and are left out
    nuisances: {what: (runs,) values} that ought to be the same in all runs, such as the particle scale

    Raises ValueError when fewer than four runs have a result.
    """
    coded = np.column_stack([factor.coded(design[column].to_numpy()) for column, factor in factors.items()])
    response = log_normalised(wear)
    used = np.isfinite(response) & np.isfinite(coded).all(axis=1)
    if used.sum() < FEWEST_RUNS:
        raise ValueError(f"found {used.sum()} runs with wear above zero, allowed are {FEWEST_RUNS} or more")
    candidates, lost = told_apart(candidate_terms(len(factors)), coded[used])
    searches = {each: Search(candidates, coded[used], response[used], heredity=each) for each in HEREDITIES}
    choices = {each: best_models(search) for each, search in searches.items()}
    return Screening(
        factors=tuple(factors.values()),
        design_rows=design["row"].astype(str).to_numpy(),
        design_coded=coded,
        used=used,
        response=response[used],
        largest_wear=float(np.asarray(wear, dtype=float)[used].max()),
        candidates=tuple(candidates),
        lost=tuple(lost),
        choices=choices,
        model=fit(choices["strong"][0].terms, coded[used], response[used]),
        by_aicc=best_models(Search(candidates, coded[used], response[used], criterion="aicc"), within=0.0)[0],
        by_two_steps=_two_steps(coded[used], response[used]),
        nuisances={what: np.asarray(values, dtype=float)[used] for what, values in (nuisances or {}).items()},
    )


def _two_steps(coded: np.ndarray, response: np.ndarray) -> TwoSteps | str:
    try:
        return two_steps(coded, response)
    except ValueError as error:
        return str(error)


def model_table(study: Screening) -> pd.DataFrame:
    """Return every model as good as the best of its heredity: heredity, model, above_best (criterion), measures."""
    rows = []
    for heredity, choices in study.choices.items():
        for choice in choices:
            terms = " + ".join(term_name(term, study.names) for term in choice.terms)
            head = {"heredity": heredity, "model": terms or CONSTANT, "above_best": choice.score - choices[0].score}
            rows.append({**head, **fit_measures(study.fit_of(choice.terms))})
    return pd.DataFrame(rows)


def method_table(study: Screening) -> pd.DataFrame:
    """Return which terms each method of selection finds, one line per term that one of them finds.

    Columns term, search, aicc and two_steps ("yes", "no"; "-" where the method cannot be used), found_by.
    """
    found = {"search": set(study.model.terms), "aicc": set(study.by_aicc.terms)}
    if isinstance(study.by_two_steps, TwoSteps):
        found["two_steps"] = set(study.by_two_steps.terms)
    lines = []
    for term in candidate_terms(len(study.factors)):
        methods = [name for name, terms in found.items() if term in terms]
        if not methods:
            continue
        told = {name: "yes" if name in methods else "no" for name in found}
        by = "all" if len(methods) == len(found) else ", ".join(methods)
        lines.append({"term": term_name(term, study.names), "two_steps": "-", **told, "found_by": by})
    return pd.DataFrame(lines, columns=["term", "search", "aicc", "two_steps", "found_by"])


def chance_test(study: Screening, permutations: int = PERMUTATIONS, seed: int = 0) -> PermutationTest:
    """Return how often the whole search finds in shuffled responses what it found here."""
    search = Search(study.candidates, study.coded, study.response)
    return permutation_test(search, permutations, seed)


def chosen_coefficients(study: Screening, chance: PermutationTest) -> pd.DataFrame:
    """Return the coefficients of the best model in coded units, with p values that were chosen with and ones that hold.

    Columns term, coefficient, standard_error, t_value, p_value_after_selection (as if the terms had been given: too
    small), p_value_permutation (with the whole search repeated; NaN for the constant).
    """
    table = coefficient_table(study.model, study.names).rename(columns={"p_value": "p_value_after_selection"})
    return table.assign(p_value_permutation=[np.nan, *(chance.term_p[term] for term in study.model.terms)])


def residuals(study: Screening) -> pd.DataFrame:
    """Return row and residuals (see `regression.residual_table`) of the used runs."""
    table = residual_table(study.model)
    table.insert(0, "row", study.design_rows[study.used])
    return table


def effects(study: Screening) -> pd.DataFrame:
    """Return the half-normal plot's data, see `factors.half_normal_table`."""
    return half_normal_table(study.candidates, study.coded, study.response, study.names)


def wear_at(study: Screening, coded: np.ndarray, level: float = 0.95) -> pd.DataFrame:
    """Return the wear that the model predicts at places (k, factors), with its intervals, in the unit of the wear.

    Columns predicted, mean_low, mean_high, run_low, run_high; see `regression.predict`. The predicted value is the
    median: the error is that of the logarithm.
    """
    return study.largest_wear * np.exp(predict(study.model, np.atleast_2d(coded), level))


def best_design_table(
    study: Screening, given: Sequence[Mapping[str, float]] = ({},), level: float = 0.95
) -> pd.DataFrame:
    """Return the design of least predicted wear inside the ranges, one line per case of given factors.

    given: {short name: real value} per case, such as the velocity and thickness of a regime
    Columns: the factors in real units, predicted wear with the interval of one further run, and `not_in_model`: the
    factors that the model says nothing about, which stand at their middle. Raises ValueError for an unknown factor.
    """
    lines = []
    in_model = {k for term in study.model.terms for k in term}
    positions = {name: k for k, name in enumerate(study.names)}
    for case in given:
        if unknown := sorted(set(case) - set(positions)):
            raise ValueError(f"factor {unknown[0]} is not known, allowed are {', '.join(positions)}")
        fixed = {positions[name]: float(study.factors[positions[name]].coded(value)) for name, value in case.items()}
        coded = best_design(study.model, len(study.factors), fixed)
        real = {name: float(study.factors[k].real(coded[k])) for name, k in positions.items()}
        silent = [name for name, k in positions.items() if k not in in_model and name not in case]
        wear = wear_at(study, coded, level).iloc[0][["predicted", "run_low", "run_high"]]
        lines.append({**real, **wear, "not_in_model": " ".join(silent)})
    return pd.DataFrame(lines)


def pairs_to_show(study: Screening, most: int = 4) -> list[tuple[int, int]]:
    """Return up to `most` pairs of factors, by position, whose contours tell most about the best model.

    Interactions come first, then pairs of the factors with main effects or squares, the largest coefficients first.
    A model of fewer than two factors gives one pair, with a factor that has no effect in it.
    """
    size = dict(zip(study.model.terms, np.abs(study.model.coefficients[1:]), strict=True))
    pairs = sorted((term for term in size if len(set(term)) == 2), key=lambda term: -size[term])
    strength: dict[int, float] = {}
    for term, value in size.items():
        if len(set(term)) == 1:
            strength[term[0]] = max(strength.get(term[0], 0.0), value)
    ranked = sorted(strength, key=lambda k: -strength[k])
    if not pairs and len(ranked) < 2:
        ranked = list(dict.fromkeys([*ranked, *range(len(study.factors))]))[:2]
    others = [tuple(sorted(pair)) for pair in itertools.combinations(ranked, 2)]
    return list(dict.fromkeys([*pairs, *others]))[:most]


def response_surface(study: Screening, pairs: Sequence[tuple[int, int]], points: int = 41) -> pd.DataFrame:
    """Return the normalised wear (-) that the model predicts over grids of pairs of factors, others at their middle.

    Columns x_factor, y_factor (short names), x, y (real units), normalised_wear; points x points lines per pair.
    """
    levels = np.linspace(-1.0, 1.0, points)
    along, up = (grid.ravel() for grid in np.meshgrid(levels, levels))
    tables = []
    for first, second in pairs:
        places = np.zeros((len(along), len(study.factors)))
        places[:, first], places[:, second] = along, up
        one, other = study.factors[first], study.factors[second]
        columns = {"x": one.real(along), "y": other.real(up)}
        columns["normalised_wear"] = np.exp(predict(study.model, places)["predicted"].to_numpy())
        tables.append(pd.DataFrame({"x_factor": one.name, "y_factor": other.name, **columns}))
    return pd.concat(tables, ignore_index=True)
