"""Wear coefficients: by the hardness of what wears, and from worn volumes."""

from __future__ import annotations

import numpy as np

PER_PA, DIMENSIONLESS = "wear_coefficient_per_pa", "wear_coefficient_k"  # the same number, without and with hardness


def coefficient_per_pa(dimensionless: float, hardness: float) -> float:
    """Return alpha = k / H in 1/Pa from k (-), at least 0, and the Vickers hardness H (Pa), above 0.

    Source: J. F. Archard, J. Appl. Phys. 24 (1953) 981; Yan 2022, Eq 3.4-3.6. Raises ValueError beyond these ranges.
    """
    return _checked(dimensionless, hardness, PER_PA) / hardness


def dimensionless_coefficient(per_pa: float, hardness: float) -> float:
    """Return k = alpha H (-), the inverse of `coefficient_per_pa`. Raises ValueError as that does."""
    return _checked(per_pa, hardness, DIMENSIONLESS) * hardness


def _checked(coefficient: float, hardness: float, wanted: str) -> float:
    if not (np.isfinite([coefficient, hardness]).all() and coefficient >= 0.0 and hardness > 0.0):
        raise ValueError(
            f"{wanted} of the coefficient {coefficient} and the hardness {hardness} Pa, allowed are finite numbers, at"
            " least 0 and above 0"
        )
    return coefficient


def laboratory_coefficient(volume: float, volume_error: float, load: float, distance: float) -> tuple[float, float]:
    """Wear coefficient V / (F L) (1/Pa) and its error, all of which comes from the volume.

    volume, volume_error : m3; load : N; distance : m, both taken as exact: no errors of theirs are published.
    Source: J. F. Archard, J. Appl. Phys. 24 (1953) 981; Yan 2022, Eq 5.1.
    """
    return volume / (load * distance), volume_error / (load * distance)


def scaling_factor(test_revolutions: float, revolutions: np.ndarray) -> np.ndarray:
    """Revolutions of the test over simulated ones, - (Yan 2022, section 5.4.3): 162.8 for 8, 108.5 for 12."""
    return test_revolutions / np.asarray(revolutions, dtype=float)


def coefficient_of_volume(coefficients: np.ndarray, volumes: np.ndarray, target: float) -> tuple[float, bool]:
    """Wear coefficient (1/Pa) whose volume is `target` (m3), and whether it lies between simulated ones.

    coefficients (k,) 1/Pa and volumes (k,) m3 after the same number of revolutions, k >= 1. Between two the logarithm
    of the volume is linear in that of the coefficient; beyond the last one the volume goes on in proportion.
    Raises ValueError for volumes that do not grow with the coefficient: then there is no one coefficient.
    """
    order = np.argsort(coefficients)
    alpha, volume = np.asarray(coefficients, dtype=float)[order], np.asarray(volumes, dtype=float)[order]
    if not ((volume > 0.0).all() and (np.diff(volume) > 0.0).all()):
        raise ValueError(f"volumes {volume} m3 do not grow with the coefficient, allowed are increasing ones above 0")
    if volume[0] <= target <= volume[-1]:
        return float(np.exp(np.interp(np.log(target), np.log(volume), np.log(alpha)))), True
    end = 0 if target < volume[0] else -1
    return float(alpha[end] * target / volume[end]), False
