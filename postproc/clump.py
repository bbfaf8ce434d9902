"""A clump: spheres fixed to each other, which may overlap, as one body. Volume and inertia of their union."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

SURFACE_POINTS = 6_250  # in each eighth of a sphere; volume and inertia of unions are then right to 1e-4
ROUNDING = 1e-4  # -, of diameter and trace: smaller coordinates and products of inertia are those of the points


@dataclass(frozen=True)
class Clump:
    """A clump as large as a sphere of diameter 1 and density 1, its centre of mass at the origin.

    centres: (n, 3) and radii: (n,) of its spheres, over its equivalent diameter
    inertia: (3, 3) tensor about the centre of mass, over mass times equivalent diameter squared
    """

    centres: np.ndarray
    radii: np.ndarray
    inertia: np.ndarray

    @property
    def reach(self) -> float:
        """Return how far it reaches from its centre of mass, over its equivalent diameter (-); 0.5 is a sphere."""
        return float((np.linalg.norm(self.centres, axis=1) + self.radii).max())


def union_moments(centres: np.ndarray, radii: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Return volume, first moments (3,) and second moments (3, 3) of a union of spheres, m3 to m5 where they are in m.

    Points on the spheres that lie in no other sphere are the union's surface. By Gauss' theorem the integral of a
    product of k coordinates over the volume is that of the product times x.n over the surface, divided by k + 3.

    centres: (n, 3); radii: (n,)
    """
    normal = sphere_points(SURFACE_POINTS)
    volume, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for number, (centre, radius) in enumerate(zip(centres, radii, strict=True)):
        point = centre + radius * normal
        others = [(other, size) for k, (other, size) in enumerate(zip(centres, radii, strict=True)) if k != number]
        free = np.all([((point - other) ** 2).sum(axis=1) > size**2 for other, size in others] or [True], axis=0)
        flux = np.where(free, (point * normal).sum(axis=1), 0.0) * 4.0 * np.pi * radius**2 / len(normal)
        volume += flux.sum() / 3.0
        first += flux @ point / 4.0
        second += (flux[:, None] * point).T @ point / 5.0
    return float(volume), first, second


def sphere_points(count: int) -> np.ndarray:
    """Return points (8 count, 3) spread evenly over the unit sphere, each for the same area.

    A Fibonacci lattice and its mirror images: bodies that are symmetric about an axis get moments that are.
    """
    number = np.arange(count) + 0.5
    height, angle = 1.0 - 2.0 * number / count, np.pi * (1.0 + 5.0**0.5) * number
    distance = np.sqrt(1.0 - height**2)
    points = np.column_stack([distance * np.cos(angle), distance * np.sin(angle), height])
    return np.concatenate([points * signs for signs in product((1.0, -1.0), repeat=3)])


def unit_clump(centres: np.ndarray, radii: np.ndarray) -> Clump:
    """Return the clump of spheres that are given in any unit of length.

    centres: (n, 3); radii: (n,)
    """
    centres, radii = np.asarray(centres, float), np.asarray(radii, float)
    volume, first, second = union_moments(centres, radii)
    diameter, middle = np.cbrt(6.0 * volume / np.pi), first / volume
    central = second / volume - np.outer(middle, middle)
    inertia = (np.trace(central) * np.eye(3) - central) / diameter**2
    inertia[np.abs(inertia) < ROUNDING * np.trace(inertia)] = 0.0
    centres = (centres - middle) / diameter
    centres[np.abs(centres) < ROUNDING] = 0.0
    return Clump(centres, radii / diameter, inertia)
