"""The two steps of definitive screening designs: odd part, even part, and the error that tells them apart."""

import numpy as np
import pytest

from bulkwear.postproc.statistics.model_terms import term_columns
from bulkwear.postproc.statistics.regression import fit
from bulkwear.postproc.statistics.screening_design import coded_design
from bulkwear.postproc.statistics.two_steps import MAIN_LEVELS, SECOND_LEVEL, two_steps

ROUNDING = 1e-9
QUIET = 0.05  # error at which effects of 1 cannot be missed
TRIALS = 150
SURE = 4.0  # standard deviations of a count of trials
TRUTH = ((0,), (1,), (3,), (0, 3), (1, 1))


def design(factors, fake=2, centres=1):
    return coded_design(factors, fake, centres).astype(float)


def noisy(coded, seed, error=QUIET, truth=TRUTH):
    """Effects of size one in turn up and down, with an error."""
    effects = np.resize([1.0, -1.0], len(truth))
    return term_columns(truth, coded) @ effects + np.random.default_rng(seed).normal(0.0, error, len(coded))


@pytest.mark.parametrize("factors", range(4, 13))
def test_clear_effects_are_found(factors):
    """In designs of 4 to 12 factors the first step finds clear main effects, the second all clear terms in them."""
    coded = design(factors)
    found = two_steps(coded, noisy(coded, factors))
    assert set(found.mains) >= set(TRUTH[:3])
    assert set(found.seconds) >= set(TRUTH[3:])
    assert {k for term in found.seconds for k in term} <= {k for (k,) in found.mains}


def test_the_error_is_what_fake_and_inactive_factors_leave():
    """It is that of a regression of the odd part on the active main effects, per degree of freedom of the odd part."""
    coded = design(6)
    response = noisy(coded, 1)
    found = two_steps(coded, response)
    odd = 0.5 * (response[0:-1:2] - response[1:-1:2])
    model = fit(found.mains, coded, np.append(np.repeat(odd, 2) * np.resize([1.0, -1.0], 16), 0.0))
    assert (found.own_freedom, found.error_freedom) == (2, 8 - len(found.mains))
    assert found.error == pytest.approx(np.sqrt(model.residual_sum / found.error_freedom), rel=ROUNDING)


def test_repeated_runs_tell_the_error_too():
    """Three runs at the centre give two degrees of freedom more, a whole design run twice one for every setting."""
    coded = design(6, centres=3)
    assert two_steps(coded, noisy(coded, 2)).own_freedom == 2 + 2
    twice = np.tile(design(6, fake=0), (2, 1))
    assert two_steps(twice, noisy(twice, 3)).own_freedom == 13


def test_the_order_of_runs_does_not_matter():
    """Runs in any order give the same terms and the same error."""
    coded = design(7)
    response, order = noisy(coded, 4), np.random.default_rng(4).permutation(len(coded))
    first, second = two_steps(coded, response), two_steps(coded[order], response[order])
    assert first.terms == second.terms
    assert first.error == pytest.approx(second.error, rel=ROUNDING)


def test_without_fake_factors_inactive_ones_tell_the_error():
    """Where main effects alone are there, the largest are set against the rest; three clear ones of six stand out."""
    coded = design(6, fake=0)
    found = two_steps(coded, noisy(coded, 5))
    assert found.own_freedom == 0
    assert found.mains == TRUTH[:3]
    assert set(found.seconds) >= set(TRUTH[3:])


def test_levels_hold_in_noise():
    """Of noise alone, a main effect passes the first step as often as its level says. So do terms of second order the
    second one after a known main effect, where fake factors are many: with few, inactive main effects make up most of
    the error, and those that are large by chance are missing in it.
    """
    coded = design(6)
    rng, level = np.random.default_rng(6), MAIN_LEVELS[2]
    count = sum(len(two_steps(coded, rng.normal(size=17)).mains) for _ in range(TRIALS))
    # one error for all six: their tests go together, the count scatters up to six times as much
    assert abs(count / (6 * TRIALS) - level) < SURE * np.sqrt(level * (1.0 - level) / TRIALS)
    coded = design(4, fake=16)
    known = 100.0 * coded[:, 0]
    found = [two_steps(coded, known + rng.normal(size=len(coded))) for _ in range(TRIALS)]
    share = np.mean([bool(each.seconds) or not each.complete for each in found])
    assert abs(share - SECOND_LEVEL) < SURE * np.sqrt(SECOND_LEVEL * (1.0 - SECOND_LEVEL) / TRIALS)


@pytest.mark.parametrize(
    ("kept", "sentence"),
    [
        (np.arange(17) != 3, "run 3 has no mirror image as often as itself"),
        (np.arange(17) > 9, "7 runs cannot tell the main effects of 6 factors apart"),
    ],
)
def test_other_designs_are_refused(kept, sentence):
    """A run without its mirror image has no odd part; fewer pairs than factors tell no main effects."""
    coded = design(6)
    with pytest.raises(ValueError, match=sentence):
        two_steps(coded[kept], noisy(coded, 7)[kept])
