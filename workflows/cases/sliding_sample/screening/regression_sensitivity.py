"""Which factor decides: Sobol indices of a screening's regression over the ranges of its design.

The regression of ln wear per metre is that of the page; of ln wear over plain the same search is done. Where a search
finds as good a model in results that are dealt to the runs at random, no index is told.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.model_terms import term_columns
from bulkwear.postproc.statistics.regression import Fit, fit_measures
from bulkwear.postproc.statistics.sensitivity import RESAMPLES, sobol_indices
from bulkwear.workflows.cases.sliding_sample.screening.regression_tables import WEAR, screen_summary
from bulkwear.workflows.cases.sliding_sample.screening.study_regression import Screening, chance_test
from bulkwear.workflows.report.sensitivity import REASON, RESPONSE, refused

RESPONSES = {"ln wear per metre": WEAR, "ln wear over plain": "wear_over_plain"}  # and their columns of the summary
CHANCE = 0.05  # -, share of random results up to which a model is told apart from chance
FEWEST_FREEDOM = 2  # degrees of freedom from which on coefficients have an interval that says something


def sensitivity_table(summary: pd.DataFrame, factors: Mapping[str, str]) -> pd.DataFrame:
    """Return the Sobol indices of each of RESPONSES: response, `sensitivity.COLUMNS` and why there are none.

    summary: as of the study; factors: {short name: column of it}
    """
    tables = []
    for response, column in RESPONSES.items():
        if column not in summary or summary.loc[summary["surface"] != PLAIN, column].isna().all():
            tables.append(refused(response, "no run has a plain twin"))
            continue
        try:
            study = screen_summary(summary.assign(**{WEAR: summary[column]}), factors)
        except ValueError as fault:
            tables.append(refused(response, str(fault)))
            continue
        reason = why_not(study)
        tables.append(refused(response, reason) if reason else indices_of(study).assign(**{RESPONSE: response}))
    return pd.concat([table.assign(**{REASON: table.get(REASON, "")}) for table in tables], ignore_index=True)


def why_not(study: Screening) -> str:
    """Return why a regression does not hold, "" where it does."""
    model = study.model
    if not model.terms:
        return "the best model has no term: no factor is told apart from chance"
    if model.freedom < FEWEST_FREEDOM:
        runs = f"{len(model.response)} runs for {len(model.coefficients)} coefficients"
        return f"{runs} leave {model.freedom} degrees of freedom, allowed are {FEWEST_FREEDOM} or more"
    chance = chance_test(study).model_p
    if chance > CHANCE:
        return f"as good a model is found in {chance:.2g} of random results, allowed is up to {CHANCE:g}"
    left_out = fit_measures(model)["r_squared_predicted"]
    if not left_out > 0.0:
        return f"runs that are left out are predicted no better than by their mean (R² {left_out:.2g})"
    return ""


def indices_of(study: Screening) -> pd.DataFrame:
    """Return the indices of a regression over -1 to 1 in coded units; intervals hold the error of its coefficients."""
    draws = coefficient_draws(study.model, RESAMPLES)
    return sobol_indices(partial(_responses, study.model, draws), study.names)


def coefficient_draws(model: Fit, count: int, seed: int = 0) -> np.ndarray:
    """Return draws (p, count) of the coefficients: Student's t about the estimates, with their covariance; seeded.

    That is their posterior without prior knowledge (A. Gelman et al., Bayesian Data Analysis, 2013, section 14.2). The
    terms are taken as given, not as chosen with the data.
    """
    chance = np.random.default_rng(seed)
    normal = np.linalg.cholesky(model.covariance) @ chance.standard_normal((len(model.coefficients), count))
    scale = model.error / np.sqrt(chance.chisquare(model.freedom, count) / model.freedom)
    return model.coefficients[:, None] + scale * normal


def _responses(model: Fit, draws: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return the response (m, count) at points (m, factors) of the unit cube by draws of the coefficients."""
    return draws[0] + term_columns(model.terms, 2.0 * points - 1.0) @ draws[1:]
