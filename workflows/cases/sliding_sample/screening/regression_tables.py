"""Every table of a screening study's regression, from the study's summary, and the source's regression beside it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.factors import Factor, factor_of
from bulkwear.postproc.statistics.intervals import estimates
from bulkwear.postproc.statistics.model_terms import aliasing, candidate_terms, parse_term, term_columns
from bulkwear.postproc.statistics.regression import CONSTANT
from bulkwear.postproc.tables.packings import BY, SETTING
from bulkwear.workflows.cases.sliding_sample.screening.regression_warnings import confounded, screening_warnings
from bulkwear.workflows.cases.sliding_sample.screening.study_regression import (
    Screening,
    best_design_table,
    chance_test,
    chosen_coefficients,
    effects,
    method_table,
    model_table,
    pairs_to_show,
    residuals,
    response_surface,
    screen,
)

WEAR = "worn_volume_per_metre_m3_per_m"  # runs of different travel compare by it
MOST_PAIRS = 6  # of factors in the figure of contours
NUISANCES = {"particle_scale": "particle scale"}  # columns that should be the same in all runs


def screen_summary(summary: pd.DataFrame, factors: Mapping[str, str]) -> Screening:
    """Return the regression of the settings with a pattern; factors: {short name: column of the summary}.

    Their wear is that per metre of travel, mean over the packings. Raises ValueError as `screen`.
    """
    runs = settings_of(summary[summary["surface"] != PLAIN])
    coded = {}
    for name, column in factors.items():
        found = factor_of(name, runs[column].to_numpy())
        coded[column] = Factor(name, found.low, found.high, found.spacing)
    nuisances = {words: runs[column].to_numpy() for column, words in NUISANCES.items() if column in runs}
    return screen(runs, coded, runs[WEAR].to_numpy(), nuisances)


def settings_of(runs: pd.DataFrame) -> pd.DataFrame:
    """Return a line per setting and surface, its first run with the geometric mean of WEAR over its packings.

    What a model misses a setting by is the same in all its packings. As runs of their own they would take that for
    terms: with a misfit of twice their scatter four to five false terms are found of three packings, of means 0.3.
    Runs of a summary without settings are settings each.
    """
    if SETTING not in runs:
        return runs
    keys = pd.MultiIndex.from_frame(runs[list(BY)]).to_flat_index()
    means = [found.value for found in estimates(keys, runs[WEAR].to_numpy(float), log=True).values()]
    return runs[~keys.duplicated()].assign(row=lambda table: table[SETTING], **{WEAR: means})


def strongest_factor(study: Screening) -> Factor | None:
    """Return the factor with the largest main effect in the best model; None without a main effect."""
    mains = {
        term[0]: abs(value)
        for term, value in zip(study.model.terms, study.model.coefficients[1:], strict=True)
        if len(term) == 1
    }
    return study.factors[max(mains, key=mains.get)] if mains else None


def best_designs(study: Screening) -> pd.DataFrame:
    """Return the best design inside all ranges, and at each level of the strongest factor, which sets the regime.

    As `study_regression.best_design_table`, with the wear over the largest of the study, and `given` first: what was
    held. Factors that are aliased with a nuisance are held at their middle in all cases: nothing is claimed about them.
    """
    aliased = {name for factors in confounded(study).values() for name in factors}
    held = {factor.name: float(factor.real(0.0)) for factor in study.factors if factor.name in aliased}
    strongest = strongest_factor(study)
    cases = [held]
    if strongest is not None and strongest.name not in aliased:
        cases += [{**held, strongest.name: float(level)} for level in strongest.real([-1.0, 0.0, 1.0])]
    table = best_design_table(study, cases)
    for column in ("predicted", "run_low", "run_high"):
        table[column] = table[column] / study.largest_wear
    words = [", ".join(f"{name} = {value:g}" for name, value in case.items()) for case in cases]
    table.insert(0, "given", words)
    return table.rename(columns={name: f"{name}_over_largest" for name in ("predicted", "run_low", "run_high")})


def contour_table(study: Screening, coefficients: pd.DataFrame, pairs: pd.DataFrame) -> pd.DataFrame:
    """Return `study_regression.response_surface` over pairs of factors, with published_wear beside it.

    coefficients: of the published regression; pairs: x_factor and y_factor of its contours
    The study's own pairs follow the published ones, MOST_PAIRS in all. Of a study without the published factors there
    are its own pairs alone, and published_wear is NaN.
    """
    known = has_factors(coefficients, study.names)
    positions = {name: k for k, name in enumerate(study.names)}
    names = pairs[["x_factor", "y_factor"]].to_numpy() if known else ()
    theirs = [(positions[x], positions[y]) for x, y in names if {x, y} <= set(positions)]
    ours = [pair for pair in pairs_to_show(study) if set(pair) not in [set(one) for one in theirs]]
    table = response_surface(study, [*theirs, *ours][:MOST_PAIRS])
    if not known:
        return table.assign(published_wear=float("nan"))
    places = np.zeros((len(table), len(study.names)))
    for axis in ("x", "y"):
        for name, part in table.groupby(f"{axis}_factor"):
            places[part.index, positions[name]] = study.factors[positions[name]].coded(part[axis].to_numpy())
    return table.assign(published_wear=published_wear(coefficients, study.names, places))


def regression_tables(study: Screening, coefficients: pd.DataFrame, pairs: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Return all tables by name: coefficients, models (with the p value by permutation of the best), methods,
    residuals, effects, surface, aliasing, best_designs, warnings. coefficients, pairs: published, see `contour_table`.
    """
    chance = chance_test(study)
    models = model_table(study).assign(p_value_permutation=float("nan"))
    models.loc[0, "p_value_permutation"] = chance.model_p
    terms = candidate_terms(len(study.factors))
    return {
        "coefficients": chosen_coefficients(study, chance),
        "models": models,
        "methods": method_table(study),
        "residuals": residuals(study),
        "effects": effects(study),
        "surface": contour_table(study, coefficients, pairs),
        "aliasing": aliasing(terms, study.coded, study.names).rename_axis("term").reset_index(),
        "best_designs": best_designs(study),
        "warnings": pd.DataFrame({"warning": screening_warnings(study)}, dtype=str),
    }


# ---------------------------------------------------------------- the source's regression


def has_factors(coefficients: pd.DataFrame, names: Sequence[str]) -> bool:
    """Return whether a study has all factors of a published regression; coefficients: with term."""
    terms = coefficients.loc[coefficients["term"] != CONSTANT, "term"]
    return {name for term in terms for name in term.removesuffix("^2").split("*")} <= set(names)


def published_wear(coefficients: pd.DataFrame, names: Sequence[str], coded: np.ndarray) -> np.ndarray:
    """Return the normalised wear (k,) that a published regression predicts at places (k, factors) in coded units.

    coefficients: term and coefficient of ln(normalised wear); names: short names of the factors, which it has all
    """
    terms = coefficients[coefficients["term"] != CONSTANT]
    constant = float(coefficients.loc[coefficients["term"] == CONSTANT, "coefficient"].iloc[0])
    parsed = [parse_term(term, names) for term in terms["term"]]
    return np.exp(constant + term_columns(parsed, coded) @ terms["coefficient"].to_numpy(dtype=float))


def published_wear_by_row(
    design: pd.DataFrame, coefficients: pd.DataFrame, columns: Mapping[str, str]
) -> dict[str, float]:
    """Return the normalised wear (-) by row of a design by the published regression; {} without its factors.

    columns: {short name: column of the design}
    """
    if not has_factors(coefficients, list(columns)):
        return {}
    levels = {name: design[column].to_numpy(dtype=float) for name, column in columns.items()}
    coded = np.column_stack([factor_of(name, values).coded(values) for name, values in levels.items()])
    return dict(zip(design["row"].astype(str), published_wear(coefficients, list(columns), coded), strict=True))
