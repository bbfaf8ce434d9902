"""Least squares on a few terms of coded factors: coefficients, measures of fit, residuals, predictions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import stats

from bulkwear.postproc.statistics.model_terms import Term, term_columns, term_name

CONSTANT = "Constant"
LEAST_RESIDUAL = 1e-13  # -, of the total sum of squares: below it is rounding, and has no logarithm worth comparing
SINGULAR = 1e-9  # -, smallest ratio of singular values of the columns


@dataclass(frozen=True, eq=False)
class Fit:
    """A fitted model. p coefficients: the constant first, then one per term; n runs.

    coefficients, errors: (p,) in units of the response, and their standard errors
    fitted, residuals, leverage: (n,); the leverage is without unit
    covariance: (p, p) of the coefficients over the error variance
    response: (n,)
    """

    terms: tuple[Term, ...]
    coefficients: np.ndarray
    errors: np.ndarray
    covariance: np.ndarray
    response: np.ndarray
    fitted: np.ndarray
    leverage: np.ndarray

    @property
    def residuals(self) -> np.ndarray:
        """Return response minus fitted value, (n,)."""
        return self.response - self.fitted

    @property
    def freedom(self) -> int:
        """Return the degrees of freedom of the error, runs less coefficients."""
        return len(self.response) - len(self.coefficients)

    @property
    def residual_sum(self) -> float:
        """Return the sum of squares of the residuals."""
        return float(self.residuals @ self.residuals)

    @property
    def total_sum(self) -> float:
        """Return the sum of squares of the response about its mean."""
        return float(((self.response - self.response.mean()) ** 2).sum())

    @property
    def error(self) -> float:
        """Return the standard deviation of the error; NaN without degrees of freedom."""
        return float(np.sqrt(self.residual_sum / self.freedom)) if self.freedom else float("nan")

    @property
    def t_values(self) -> np.ndarray:
        """Return the coefficients over their standard errors, (p,)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.coefficients / self.errors

    @property
    def p_values(self) -> np.ndarray:
        """Return two-sided p values, (p,); too small when the terms were chosen with the same data."""
        return 2.0 * stats.t.sf(np.abs(self.t_values), self.freedom)


def fit(terms: Sequence[Term], coded: np.ndarray, response: np.ndarray) -> Fit:
    """Return the least-squares fit of a constant and some terms.

    coded: (n, factors) in coded units; response: (n,), without gaps.
    Raises ValueError when runs are fewer than coefficients or cannot tell the terms apart.
    """
    response = np.asarray(response, dtype=float)
    columns = np.column_stack([np.ones(len(response)), term_columns(terms, coded)])
    singular = np.linalg.svd(columns, compute_uv=False)
    if len(response) < columns.shape[1] or singular[-1] < SINGULAR * singular[0]:
        count = columns.shape[1]
        raise ValueError(f"{len(response)} runs cannot tell {count} coefficients apart, allowed are fewer terms")
    orthogonal, triangle = np.linalg.qr(columns)
    inverse = np.linalg.inv(triangle)
    covariance = inverse @ inverse.T
    coefficients = inverse @ (orthogonal.T @ response)
    fitted = columns @ coefficients
    freedom = len(response) - columns.shape[1]
    variance = ((response - fitted) ** 2).sum() / freedom if freedom else np.nan
    return Fit(
        terms=tuple(terms),
        coefficients=coefficients,
        errors=np.sqrt(variance * np.diag(covariance)),
        covariance=covariance,
        response=response,
        fitted=fitted,
        leverage=(orthogonal**2).sum(axis=1),
    )


def press(model: Fit) -> float:
    """Return the sum of squares of each run's deviation from the fit without it (D. M. Allen, 1974).

    Infinite when a run alone decides a coefficient (leverage 1).
    """
    left = 1.0 - model.leverage
    if (left < SINGULAR).any():
        return float("inf")
    return float(((model.residuals / left) ** 2).sum())


def aicc(
    residual_sum: np.ndarray | float, total_sum: np.ndarray | float, runs: int, terms: np.ndarray | int
) -> np.ndarray:
    """Return Akaike's criterion corrected for few runs (C. M. Hurvich and C.-L. Tsai, 1989), up to a constant.

    The parameters are the terms, the constant and the error's variance. Infinite when they are too many for the runs.
    """
    parameters = np.asarray(terms) + 2.0
    return _deviance(residual_sum, total_sum, runs) + _corrected(2.0 * parameters, runs, terms)


def bic_corrected(
    residual_sum: np.ndarray | float, total_sum: np.ndarray | float, runs: int, terms: np.ndarray | int
) -> np.ndarray:
    """Return the Bayesian criterion corrected for few runs (A. D. McQuarrie, Stat. Probab. Lett. 44, 1999, 79-86).

    Up to a constant; the parameters are the terms and the constant. Infinite when they are too many for the runs.
    """
    return _deviance(residual_sum, total_sum, runs) + _corrected(np.log(runs) * (np.asarray(terms) + 1.0), runs, terms)


def _deviance(residual_sum: np.ndarray | float, total_sum: np.ndarray | float, runs: int) -> np.ndarray:
    least = LEAST_RESIDUAL * np.asarray(total_sum, dtype=float) + np.finfo(float).tiny
    return runs * np.log(np.maximum(residual_sum, least) / runs)


def _corrected(penalty: np.ndarray, runs: int, terms: np.ndarray | int) -> np.ndarray:
    """Return the penalty of a criterion for large samples, corrected for few runs; infinite where they are too few."""
    left = runs - np.asarray(terms, dtype=float) - 3.0
    return np.where(left > 0.0, penalty * runs / np.where(left > 0.0, left, 1.0), np.inf)


def fit_measures(model: Fit) -> dict[str, float]:
    """Return runs, terms, error, r_squared, r_squared_adjusted, r_squared_predicted (by PRESS) and aicc.

    NaN where the response does not vary, or no degree of freedom is left.
    """
    runs, total = len(model.response), model.total_sum
    share = 1.0 - model.residual_sum / total if total else float("nan")
    adjusted = 1.0 - (1.0 - share) * (runs - 1) / model.freedom if model.freedom else float("nan")
    return {
        "runs": runs,
        "terms": len(model.terms),
        "error": model.error,
        "r_squared": share,
        "r_squared_adjusted": adjusted,
        "r_squared_predicted": 1.0 - press(model) / total if total else float("nan"),
        "aicc": float(aicc(model.residual_sum, total, runs, len(model.terms))),
    }


def coefficient_table(model: Fit, names: Sequence[str]) -> pd.DataFrame:
    """Return term, coefficient, standard_error, t_value and p_value, the constant first; coded units.

    After a selection with the same data, the p values are too small; see `selection.permutation_test`.
    """
    return pd.DataFrame(
        {
            "term": [CONSTANT, *(term_name(term, names) for term in model.terms)],
            "coefficient": model.coefficients,
            "standard_error": model.errors,
            "t_value": model.t_values,
            "p_value": model.p_values,
        }
    )


def residual_table(model: Fit) -> pd.DataFrame:
    """Return response, fitted, residual, leverage, standardised_residual and normal_score of each run.

    Scores: (rank - 3/8) / (n + 1/4) of the standard normal distribution (G. Blom, 1958).
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        standardised = model.residuals / (model.error * np.sqrt(np.maximum(1.0 - model.leverage, 0.0)))
    count = len(model.response)
    share = (stats.rankdata(model.residuals, method="ordinal") - 0.375) / (count + 0.25)
    return pd.DataFrame(
        {
            "response": model.response,
            "fitted": model.fitted,
            "residual": model.residuals,
            "leverage": model.leverage,
            "standardised_residual": standardised,
            "normal_score": stats.norm.ppf(share),
        }
    )


def predict(model: Fit, coded: np.ndarray, level: float = 0.95) -> pd.DataFrame:
    """Return predicted, mean_low, mean_high, run_low and run_high at some places (k, factors) in coded units.

    mean_*: interval of the mean response, run_*: interval in which one further run falls, at that confidence level.
    NaN limits without degrees of freedom. The intervals take the terms as given, not as chosen with the data.
    """
    columns = np.column_stack([np.ones(len(coded)), term_columns(model.terms, coded)])
    predicted = columns @ model.coefficients
    spread = np.einsum("ij,jk,ik->i", columns, model.covariance, columns)
    reach = stats.t.ppf(0.5 + level / 2.0, model.freedom) * model.error if model.freedom else np.nan
    mean, run = reach * np.sqrt(spread), reach * np.sqrt(1.0 + spread)
    return pd.DataFrame(
        {
            "predicted": predicted,
            "mean_low": predicted - mean,
            "mean_high": predicted + mean,
            "run_low": predicted - run,
            "run_high": predicted + run,
        }
    )
