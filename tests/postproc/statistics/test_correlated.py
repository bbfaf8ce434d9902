"""Regression on correlated values: limits in closed form, and the t that stands for a mixture."""

import numpy as np
import pytest
from scipy import stats

from bulkwear.postproc.statistics.correlated import LARGEST_CORRELATION, MATCHED, correlated_fit, whitened

ROUNDING = 1e-9  # -, of least squares


def series(seed, count, correlation):
    """Values of mean 5 and deviation 1 at even distances."""
    fresh = np.random.default_rng(seed).standard_normal(count)
    for place in range(1, count):
        fresh[place] = correlation * fresh[place - 1] + np.sqrt(1.0 - correlation**2) * fresh[place]
    return 5.0 + fresh


def line(values):
    """The fit of a straight line."""
    places = np.arange(len(values), dtype=float)
    return correlated_fit(places, values, np.column_stack([np.ones(len(values)), places - places.mean()]))


def test_generalised_least_squares_by_the_matrix():
    """Each correlation's coefficients and covariance are those of the dense formula, at uneven places too."""
    places, values = np.array([0.0, 1.0, 2.5, 3.0, 5.0, 6.0]), series(1, 6, 0.3)
    columns = np.column_stack([np.ones(6), places])
    fit, distance = correlated_fit(places, values, columns), np.diff(places).mean()
    for index, correlation in enumerate(fit.correlations):
        matrix = correlation ** (np.abs(places[:, None] - places) / distance)
        inverse = np.linalg.inv(matrix)
        covariance = np.linalg.inv(columns.T @ inverse @ columns)
        np.testing.assert_allclose(fit.covariances[index], covariance, rtol=1e-6)
        np.testing.assert_allclose(fit.coefficients[index], covariance @ columns.T @ inverse @ values, rtol=1e-6)


def test_a_long_series_tells_its_correlation():
    """Of 400 values the weights lie about the true correlation, and the error of the mean is that of the theory."""
    for correlation in (0.0, 0.7):
        fit = correlated_fit(np.arange(400.0), series(2, 400, correlation), np.ones((400, 1)))
        assert fit.weights @ fit.correlations == pytest.approx(correlation, abs=0.12)  # three deviations at r = 0.7
        theory = np.sqrt((1.0 + correlation) / (1.0 - correlation) / 400.0)
        assert fit.of(np.ones(1)).error == pytest.approx(theory, rel=0.35)


def test_the_t_has_the_quantiles_of_the_mixture():
    """At both confidences the interval holds that share of the weighted t distributions."""
    fit = line(series(3, 9, 0.5))
    contrast = np.array([0.0, 1.0])
    found, errors = fit.of(contrast), np.sqrt(fit.variances * fit.covariances[:, 1, 1])
    for share in MATCHED:
        low, high = found.interval(share)
        outer, inner = (stats.t.cdf((end - fit.coefficients[:, 1]) / errors, fit.freedom) for end in (high, low))
        assert fit.weights @ (outer - inner) == pytest.approx(share, abs=0.002)  # of the table of freedoms


def test_values_on_the_line_have_no_error():
    """What the columns explain wholly has its coefficients without error, and no deviation."""
    fit = line(1.0 + 0.5 * np.arange(8.0))
    found = fit.of(np.array([0.0, 1.0]))
    assert (found.value, found.error) == (pytest.approx(0.5, rel=ROUNDING), 0.0)
    assert fit.deviation() == (0.0, 0.0)


def test_deviation_of_a_long_series():
    """The interval of the deviation holds it, and is about as wide as the theory of 400 independent values."""
    low, high = correlated_fit(np.arange(400.0), series(4, 400, 0.0), np.ones((400, 1))).deviation()
    assert low < 1.0 < high
    assert high - low == pytest.approx(2.0 * 1.96 / np.sqrt(800.0), rel=0.3)


def test_ratio_to_first_order():
    """The ratio of slope and level has the value of their ratio; its error grows with that of the level."""
    fit = line(series(5, 30, 0.0))
    slope, level = np.array([0.0, 1.0]), np.array([1.0, 0.0])
    found = fit.ratio(29.0 * slope, level)
    assert found.value == pytest.approx(29.0 * fit.mean(slope) / fit.mean(level), rel=ROUNDING)
    assert found.error == pytest.approx(29.0 * fit.of(slope).error / fit.mean(level), rel=0.2)
    assert not fit.ratio(slope, np.zeros(2)).known


def test_too_few_values_have_no_fit():
    """Two degrees of freedom must be left."""
    assert line(np.arange(3.0)) is None
    assert line(np.array([1.0, 2.0, 0.0, 1.0])) is not None


def test_correlations_reach_from_none_to_nearly_all():
    """They grow, and the prior is even in their angle."""
    correlations, _, _ = whitened(np.arange(3.0), np.ones((3, 1)))
    angles = np.arcsin(correlations)
    np.testing.assert_allclose(np.diff(angles), np.arcsin(LARGEST_CORRELATION) / len(angles), rtol=ROUNDING)
    assert correlations[0] < 0.05 and correlations[-1] < LARGEST_CORRELATION
