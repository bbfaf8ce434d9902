"""A surrogate of simulations whose errors are partly the same: it knows differences better than the level."""

import numpy as np
import pytest

from bulkwear.postproc.inference.surrogate import fit_surrogate

COUNT, SEED = 12, 1
OWN, SHARED = 0.01, 0.2  # standard deviations of the errors of simulations that differ by up to 1
POINTS = (np.arange(COUNT)[:, None] + 0.5) / COUNT
VALUES = POINTS[:, 0]
INDEPENDENT = OWN**2 * np.eye(COUNT)
ENDS = POINTS[[0, -1]]
FOUR_ERRORS = 0.3  # -, of a standard deviation over 256 draws, and of a few kernels


def fitted(shared):
    """The surrogate of a line whose simulations share an error."""
    return fit_surrogate(POINTS, VALUES, INDEPENDENT + shared**2, SEED)


def test_a_shared_error_makes_the_level_uncertain():
    """It adds to the variance of every prediction; the line stays."""
    alone, shared = fitted(0.0).predict(ENDS), fitted(SHARED).predict(ENDS)
    assert shared[0] == pytest.approx(alone[0], abs=2.0 * OWN)
    assert shared[1] - alone[1] == pytest.approx(np.full(2, SHARED**2), rel=0.1)


def test_a_shared_error_leaves_differences_as_they_are():
    """In draws, by which designs are compared; an error of each simulation's own as large would hide them."""
    of_each = 16
    deviation = {}
    for shared in (0.0, SHARED):
        draws = fitted(shared).draws(ENDS, of_each, SEED)
        deviation[shared] = np.std(draws[1] - draws[0])
        assert np.mean(draws[1] - draws[0]) == pytest.approx(VALUES[-1] - VALUES[0], abs=3.0 * OWN)
    assert deviation[SHARED] == pytest.approx(deviation[0.0], rel=FOUR_ERRORS)
    own = fit_surrogate(POINTS, VALUES, (OWN**2 + SHARED**2) * np.eye(COUNT), SEED).draws(ENDS, of_each, SEED)
    assert np.std(own[1] - own[0]) > 5.0 * deviation[SHARED]
