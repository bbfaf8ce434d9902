"""The cost model is linear in every term, and the calibration finds the rates that times were made with."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.forecast.rates import OUTSIDE_TERMS, SOLVER_TERMS, TERMS, fitted_rates, seconds

EXACT = 1e-12  # relative; rounding of a dozen products and sums
FIT = 1e-6  # relative; of a least-squares solution whose columns differ by many orders of magnitude
NOISE, NOISY_FIT = 0.05, 0.1  # relative; of the times, and of rates from three times as many of them as rates


def amounts(rows, terms=TERMS, seed=20220317):
    """Amounts of work as different as those of decks and particle steps are."""
    random = np.random.default_rng(seed)
    sizes = 10.0 ** np.linspace(0, 9, len(terms))
    return pd.DataFrame(random.uniform(0.1, 1.0, (rows, len(terms))) * sizes, columns=list(terms))


def known_rates(terms=TERMS):
    """Rates with which every term costs seconds."""
    return dict(zip(terms, 10.0 ** -np.linspace(0, 9, len(terms)) * np.arange(1, len(terms) + 1), strict=True))


@pytest.mark.parametrize("term", TERMS)
def test_linear_in_every_term(term):
    """Twice as much of one term adds its rate times its amount, whatever else there is."""
    work, rates = amounts(4), known_rates()
    more = work.assign(**{term: 2.0 * work[term]})
    np.testing.assert_allclose(seconds(more, rates) - seconds(work, rates), rates[term] * work[term], rtol=1e-9)


def test_solver_and_outside_add_up():
    """Every term belongs to the solver or is spent outside it."""
    work, rates = amounts(3), known_rates()
    parts = seconds(work, rates, SOLVER_TERMS) + seconds(work, rates, OUTSIDE_TERMS)
    np.testing.assert_allclose(parts, seconds(work, rates), rtol=EXACT)


def test_rates_are_found_again():
    """Times made with known rates give these rates back, those that are known beforehand unchanged."""
    work, rates = amounts(2 * len(TERMS)), known_rates()
    found = fitted_rates(work, seconds(work, rates), {"particle_builds": rates["particle_builds"]})
    assert found == pytest.approx(rates, rel=FIT)


def test_rates_from_noisy_times():
    """Times that are off by five per cent give rates within ten, and none is negative."""
    terms = SOLVER_TERMS[3:6]
    work, rates = amounts(9 * len(terms), terms), known_rates(terms)
    noise = 1.0 + NOISE * np.random.default_rng(1).standard_normal(len(work))
    assert fitted_rates(work, noise * seconds(work, rates, terms)) == pytest.approx(rates, rel=NOISY_FIT)


def test_what_costs_nothing_is_not_negative():
    """A term that times fall with gets rate 0, not a negative one."""
    work = pd.DataFrame({"steps": [1.0, 1.0, 1.0], "decks": [1.0, 2.0, 3.0]})
    assert fitted_rates(work, [3.0, 2.9, 2.8])["decks"] == 0.0


@pytest.mark.parametrize("rows", [1, 3])
def test_too_few_or_alike_measurements_are_refused(rows):
    """Two rates cannot be told from one measurement, nor from three of the same work."""
    work = pd.DataFrame({"steps": [1.0] * rows, "decks": [2.0] * rows})
    with pytest.raises(ValueError, match=f"{rows} measurements cannot tell the rates of steps, decks apart"):
        fitted_rates(work, [1.0] * rows)


def test_a_time_of_nothing_is_refused():
    """Relative errors need times above 0."""
    with pytest.raises(ValueError, match="above 0 s, found 0"):
        fitted_rates(pd.DataFrame({"steps": [1.0, 2.0]}), [1.0, 0.0])
