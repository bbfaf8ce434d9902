"""Wear coefficients from worn volumes."""

from __future__ import annotations

import numpy as np


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
