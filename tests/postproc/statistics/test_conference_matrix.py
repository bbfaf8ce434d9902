"""Conference matrices: what they are, and which orders there are."""

import numpy as np
import pytest

from bulkwear.postproc.statistics.conference_matrix import conference_matrix, next_order

MADE = (4, 6, 8, 10, 12, 14, 16, 18, 20, 24, 26, 28, 30, 32, 48, 50, 56)  # 10, 26, 28, 50: fields of prime powers
DOUBLED = (16, 56)  # 15 and 55 are no prime powers
NOT_THERE = (22, 34)  # order - 1 is no sum of two squares (V. Belevitch, 1950)


@pytest.mark.parametrize("order", MADE)
def test_columns_are_orthogonal(order):
    """C'C = (order - 1) I with zeros on the diagonal and 1 or -1 elsewhere; exact, in whole numbers."""
    matrix = conference_matrix(order)
    unit = np.eye(order, dtype=int)
    assert (matrix.T @ matrix == (order - 1) * unit).all()
    assert (np.abs(matrix) == 1 - unit).all()


@pytest.mark.parametrize("order", MADE)
def test_symmetry_follows_the_order(order):
    """Skew where the order is a multiple of 4, else symmetric up to signs of rows and columns (Paley: symmetric)."""
    matrix = conference_matrix(order)
    assert ((-matrix if order % 4 == 0 else matrix) == matrix.T).all()


@pytest.mark.parametrize("order", [*NOT_THERE, 2, 5, 0, -4])
def test_an_order_that_is_not_there_is_refused(order):
    """Odd, too small and impossible orders are named, with the next one that can be had."""
    with pytest.raises(ValueError, match=f"order {order} can be constructed, the next is {next_order(order)}"):
        conference_matrix(order)


def test_the_next_order_skips_what_is_not_there():
    """21 columns come from order 24; an order that is there is its own next."""
    assert [next_order(least) for least in (1, 4, 5, 21, 22, 33)] == [4, 4, 6, 24, 24, 38]
    assert set(DOUBLED) <= {next_order(order) for order in DOUBLED}
