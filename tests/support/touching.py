"""Contacts of spheres by their places, beside the solver's own count."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree


def contacts_of(places: np.ndarray, radius: np.ndarray, period: Sequence[float] = (0.0, 0.0, 0.0)) -> np.ndarray:
    """Return the number (k,) of others that each sphere (centres (k, 3) m) touches or overlaps.

    period: m, along each axis, 0 where it is not periodic. Contacts are overlaps of micrometres: places that were
    printed with six digits do not tell them, and the solver's own count is to be taken.
    """
    period = np.asarray(period)
    wrapped = np.where(period > 0.0, np.mod(places, np.where(period > 0.0, period, 1.0)), places)
    pairs = cKDTree(wrapped, boxsize=period).query_pairs(2.0 * radius.max(), output_type="ndarray")
    apart = wrapped[pairs[:, 0]] - wrapped[pairs[:, 1]]
    apart -= period * np.round(apart / np.where(period > 0.0, period, np.inf))
    touching = pairs[np.linalg.norm(apart, axis=1) <= radius[pairs].sum(axis=1)]
    return np.bincount(touching.ravel(), minlength=len(radius))
