"""Conference matrices: square, zeros on the diagonal, else 1 and -1, every two columns orthogonal.

Order n = q + 1 from the squares of the finite field of q elements (Paley, J. Math. Phys. 12, 1933), order 2 n from a
skew one of order n. A matrix of order 22 or 34 does not exist; others are not known to these two constructions.
"""

from __future__ import annotations

import itertools

import numpy as np

SMALLEST_ORDER = 4
LARGEST_DEGREE = 3  # of the polynomials behind a field: up to here one without roots is irreducible


def conference_matrix(order: int) -> np.ndarray:
    """Return a conference matrix C of that order, (order, order) of 0, 1 and -1: C'C = (order - 1) I.

    Raises ValueError when neither construction gives that order.
    """
    found = _made(order)
    if found is None:
        raise ValueError(f"no conference matrix of order {order} can be constructed, the next is {next_order(order)}")
    return found


def next_order(least: int) -> int:
    """Return the smallest order, `least` or larger, of which `conference_matrix` makes one."""
    return next(order for order in itertools.count(least) if _made(order) is not None)


def _made(order: int) -> np.ndarray | None:
    """Return a conference matrix, skew (C' = -C) where the order is a multiple of 4, or None."""
    if order < SMALLEST_ORDER or order % 2:
        return None
    found = _paley(order)
    if found is None and order % 8 == 0:
        half = _made(order // 2)
        found = None if half is None else _doubled(half)
    return found


def _doubled(skew: np.ndarray) -> np.ndarray:
    """Return the skew conference matrix of twice the order."""
    unit = np.eye(len(skew), dtype=int)
    return np.block([[skew, skew + unit], [skew - unit, -skew]])


def _paley(order: int) -> np.ndarray | None:
    """Return the bordered matrix of chi(a - b) over the elements a, b of a field; None when there is no such field."""
    field = _prime_power(order - 1)
    if field is None:
        return None
    elements, squares = _field(*field)
    differences = (elements[:, None] - elements[None]) % field[0]
    digits = field[0] ** np.arange(field[1])
    character = np.where(np.isin(differences @ digits, squares @ digits), 1, -1)
    np.fill_diagonal(character, 0)
    sign = -1 if order % 4 == 0 else 1
    one = np.ones((1, order - 1), dtype=int)
    return np.block([[np.zeros((1, 1), dtype=int), one], [sign * one.T, character]])


def _prime_power(number: int) -> tuple[int, int] | None:
    """Return (prime, degree) of an odd number that is a power of a prime up to the largest degree; None otherwise."""
    for degree in range(1, LARGEST_DEGREE + 1):
        prime = round(number ** (1.0 / degree))
        if prime > 2 and prime**degree == number and all(prime % d for d in range(2, int(prime**0.5) + 1)):
            return prime, degree
    return None


def _field(prime: int, degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the elements of a field as digits (q, degree), and its squares other than zero (q - 1, degree)."""
    elements = np.array(list(itertools.product(range(prime), repeat=degree)))[:, ::-1]
    product = np.zeros((len(elements), 2 * degree - 1), dtype=int)
    for i, j in itertools.product(range(degree), repeat=2):
        product[:, i + j] += elements[:, i] * elements[:, j]
    modulus = _irreducible(prime, degree)
    for power in range(2 * degree - 2, degree - 1, -1):
        product[:, power - degree : power] -= product[:, power : power + 1] * modulus
    return elements, product[elements.any(axis=1), :degree] % prime


def _irreducible(prime: int, degree: int) -> np.ndarray:
    """Return the lower coefficients (degree,) of a monic polynomial without roots, hence irreducible."""
    places = np.arange(prime)[:, None] ** np.arange(degree)
    for lower in itertools.product(range(prime), repeat=degree):
        values = (places @ np.array(lower) + np.arange(prime) ** degree) % prime
        if degree == 1 or values.all():
            return np.array(lower)
    raise AssertionError(f"a field of {prime}^{degree} elements has such a polynomial")
