"""Means of settings that share packings: closed forms, and how far they lie apart beside how far they scatter."""

import itertools

import numpy as np
import pytest

from bulkwear.postproc.statistics.shared_scatter import means_and_covariance

SEED, DRAWS = 7, 400
OF_PACKING, REST = 0.2, 0.02  # standard deviations
FOUR_ERRORS = 4.0 / np.sqrt(2.0 * DRAWS)  # -, of a standard deviation over so many draws


def layout(settings, packings):
    """Labels of settings that all have the same packings, and which of them each is."""
    pairs = np.array(list(itertools.product(range(settings), range(packings))))
    return [f"O{k}" for k in pairs[:, 0]], pairs[:, 1], pairs


def test_what_a_packing_shifts_leaves_differences_alone():
    """Three settings in the same two packings: rests of +-r, a packing of +-p, to hand.

    The rest's mean square of 2 degrees of freedom is that of r; within settings it is that of both.
    """
    settings, packings, _ = layout(3, 2)
    rest, shift = np.array([0.01, -0.01, -0.02, 0.02, 0.01, -0.01]), np.tile([0.3, -0.3], 3)
    means, covariance = means_and_covariance(settings, packings, np.repeat([1.0, 2.0, 4.0], 2) + rest + shift)
    assert means == pytest.approx([1.0, 2.0, 4.0])
    own = (rest**2).sum() / 2.0
    both = ((rest + shift) ** 2).sum() / 3.0
    assert covariance.diagonal() == pytest.approx(np.full(3, both / 2.0))
    assert covariance[0, 1] == pytest.approx((both - own) / 2.0)
    apart = np.array([1.0, -1.0, 0.0])
    assert apart @ covariance @ apart == pytest.approx(own)
    assert own < both / 100.0  # that of both it would be, were they independent


def test_packings_of_some_settings_alone_do_not_shift_them_against_others():
    """O0 has a third packing, whose bed wears all patterns more: its mean stays beside that of O1, which has it not."""
    settings, packings = ["O0", "O0", "O0", "O1", "O1", "O2", "O2"], [0, 1, 2, 0, 1, 0, 1]
    shift, rest = np.array([0.1, -0.1, 0.9])[packings], np.array([1, -1, 0, -1, 1, 0, 0]) * 1e-3
    means, covariance = means_and_covariance(settings, packings, shift + rest)
    assert means - means[0] == pytest.approx(np.zeros(3), abs=2e-3)
    apart = np.array([1.0, -1.0, 0.0])
    assert np.sqrt(apart @ covariance @ apart) < 3e-3


def test_errors_are_those_of_draws():
    """Of differences and of means, in eight settings of five packings; the estimated ones are right in the mean."""
    settings, packings, pairs = layout(8, 5)
    chance = np.random.default_rng(SEED)
    apart = np.array([1.0, -1.0, *[0.0] * 6])
    found, told = [], []
    for _ in range(DRAWS):
        shared, own = OF_PACKING * chance.standard_normal(5), REST * chance.standard_normal(40)
        means, covariance = means_and_covariance(settings, packings, shared[pairs[:, 1]] + own)
        found.append([means[0], apart @ means])
        told.append([covariance[0, 0], apart @ covariance @ apart])
    ratio = np.std(found, axis=0) / np.sqrt(np.mean(told, axis=0))
    assert ratio == pytest.approx([1.0, 1.0], abs=2.0 * FOUR_ERRORS)


@pytest.mark.parametrize(
    ("settings", "packings", "values", "errors"),
    [
        (["A", "B"], [1, 1], [1.0, 2.0], np.zeros((2, 2))),
        (["A", "A", "B"], [1, 2, 1], [1.0, 1.0, 2.0], np.zeros((2, 2))),
        (["A", "A", "B"], [1, 2, 1], [1.1, 0.9, 2.0], np.diag([0.01, 0.02])),
    ],
)
def test_what_nobody_can_tell_is_taken_for_rest(settings, packings, values, errors):
    """Without a second packing, without any scatter, and where one setting alone has two packings."""
    means, covariance = means_and_covariance(settings, packings, np.array(values))
    assert means == pytest.approx([1.0, 2.0])
    assert covariance == pytest.approx(errors)
