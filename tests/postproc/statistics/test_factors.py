"""Factors between real and coded units."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.factors import Factor, factor_of
from tests.support.models import coded_table
from tests.support.screening_study import factors_of

ROUNDING = 1e-13  # of a logarithm and its power


@pytest.mark.parametrize(("factor", "middle"), [(Factor("d", 20.0, 60.0), 40.0), (Factor("a", 2.0, 8.0, "log"), 4.0)])
def test_levels(factor, middle):
    """-1, 0 and 1 are the low, the middle and the high level; with log the middle is the geometric mean."""
    np.testing.assert_allclose(factor.real([-1.0, 0.0, 1.0]), [factor.low, middle, factor.high], rtol=ROUNDING)
    np.testing.assert_allclose(factor.coded([factor.low, middle, factor.high]), [-1.0, 0.0, 1.0], atol=ROUNDING)


@pytest.mark.parametrize("spacing", ["linear", "log"])
def test_coding_and_back(spacing):
    """Real to coded and back is the same value, beyond the range too."""
    factor = Factor("x", 0.5, 2.0, spacing)
    values = np.random.default_rng(1).uniform(0.1, 5.0, 50)
    np.testing.assert_allclose(factor.real(factor.coded(values)), values, rtol=ROUNDING * 10)


def test_spacing_is_told_from_the_levels():
    """Levels that double make a log factor, levels at equal distances a linear one, two levels a linear one."""
    assert factor_of("a", np.array([2, 8, 4, 2])) == Factor("a", 2.0, 8.0, "log")
    assert factor_of("d", np.array([20, 60, 40])) == Factor("d", 20.0, 60.0)
    assert factor_of("s", np.array([-1.0, 0.0, 1.0])) == Factor("s", -1.0, 1.0)
    assert factor_of("w", np.array([1.0, 4.0])) == Factor("w", 1.0, 4.0)


def test_a_table_is_coded_column_by_column():
    """Columns come in the order of the factors."""
    table = pd.DataFrame({"row": ["R1", "R2", "R3"], "d": [20, 40, 60], "a": [8, 2, 4]})
    coded = coded_table(table, factors_of(table, ["a", "d"]))
    np.testing.assert_allclose(coded, [[1.0, -1.0], [-1.0, 0.0], [0.0, 1.0]], atol=ROUNDING)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: Factor("a", 2.0, 2.0), "factor a: found 2 to 2, allowed is a low below a high"),
        (lambda: Factor("a", float("nan"), 2.0), "factor a: found nan to 2"),
        (lambda: Factor("a", 0.0, 2.0, "log"), "factor a: found the low 0, allowed with log is above 0"),
        (lambda: factor_of("a", np.ones(5)), r"factor a: found 1 level\(s\), allowed are two or more"),
    ],
)
def test_what_is_no_factor_is_refused(make, sentence):
    """One sentence names the factor, what was found and what is allowed."""
    with pytest.raises(ValueError, match=sentence):
        make()


def test_no_logarithm_no_code():
    """A value without a logarithm has no code on a log factor."""
    assert np.isnan(Factor("a", 1.0, 4.0, "log").coded(0.0))
