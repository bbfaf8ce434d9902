"""Size classes of a bulk material from its percent passing, with a stated cut-off of the fines.

Particles of a simulation cannot be as small as the finest grains: a time step goes with the smallest particle, their
number with the cube of the size. So the finest part by mass is counted to the smallest class that is left. The rest is
divided into classes of equal mass, and a class has the diameter at its middle mass: half of its mass is of finer
particles. That keeps the mass, needs no choice of limits and gives each class a number of particles that matters.

Alternatives, not taken: the diameter that keeps a class's surface (mass over the integral of mass over diameter) is
nearer to the finer end and makes more particles, the mean diameter by mass is nearer to the coarser end; of classes
within a factor of 2 in size both differ from the middle by about 2 %. Classes of equal steps in the size's
logarithm show the ends of the distribution better, with coarse classes of few particles. To leave the fines out and
keep the classes equal would make the material coarser in all of its mass; here the coarser classes keep their share.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

ROUNDING = 1e-9  # -, of fractions as they are typed
METRES_TO_MM = 1e3


@dataclass(frozen=True, eq=False)
class SizeClasses:
    """Classes of a size distribution, the finest first.

    diameters_m: (classes,); mass_fractions: (classes,) that sum to 1; median_m: where half of all mass passes
    told: the rule and what it gave, in sentences
    """

    diameters_m: np.ndarray
    mass_fractions: np.ndarray
    median_m: float
    told: str


def size_classes(
    sieve_m: Sequence[float] | np.ndarray,
    passing: Sequence[float] | np.ndarray,
    finest_fraction: float,
    classes: int,
) -> SizeClasses:
    """Return the classes of a distribution by the rule of this module.

    sieve_m: (k,) openings, m, in any order; passing: (k,) what passes each, fractions by mass (-), 1 at the largest;
    between sieves it is linear in the logarithm of the size
    finest_fraction: -, by mass, what is counted to the smallest class besides its own share; classes: how many
    Raises ValueError for a curve that is none, and where it says nothing of a size that is asked for: below its
    smallest sieve.
    """
    sizes, shares = _checked(sieve_m, passing)
    if not 0.0 <= finest_fraction < 1.0:
        raise ValueError(f"the finest fraction is {finest_fraction:g}, allowed is 0 to less than 1")
    if classes != int(classes) or classes < 1:
        raise ValueError(f"found {classes:g} size classes, allowed are whole numbers from 1 on")
    each = (1.0 - finest_fraction) / classes
    middles = finest_fraction + each * (np.arange(classes) + 0.5)
    lowest = min(middles[0], 0.5)
    if lowest < shares[0]:
        raise ValueError(
            f"{shares[0]:g} passes the smallest sieve of {METRES_TO_MM * sizes[0]:g} mm, allowed is {lowest:g} or less,"
            " the middle of the smallest class and the median; give a finer sieve or count a larger fraction to it"
        )
    *diameters, median = np.exp(np.interp([*middles, 0.5], shares, np.log(sizes)))
    fractions = np.full(int(classes), each)
    fractions[0] += finest_fraction
    told = _told(np.array(diameters), fractions, finest_fraction, median)
    return SizeClasses(np.array(diameters), fractions, float(median), told)


def _checked(sieves: Sequence[float] | np.ndarray, passing: Sequence[float] | np.ndarray) -> tuple[np.ndarray, ...]:
    """Return sieves and shares in the order of the sizes, those at which nothing and all passes once."""
    sizes, shares = np.asarray(sieves, dtype=float), np.asarray(passing, dtype=float)
    if sizes.shape != shares.shape or sizes.ndim != 1:
        raise ValueError(f"found {sizes.size} sieves and {shares.size} values of passing, allowed is one per sieve")
    if len(sizes) < 2:
        raise ValueError(f"found {len(sizes)} sieves, allowed are 2 or more")
    if not (np.isfinite(sizes).all() and sizes.min() > 0.0):
        raise ValueError(f"found the sieve {METRES_TO_MM * sizes.min():g} mm, allowed are sizes above 0")
    order = np.argsort(sizes, kind="stable")
    sizes, shares = sizes[order], shares[order]
    if (np.diff(sizes) == 0.0).any():
        twice = sizes[1:][np.diff(sizes) == 0.0][0]
        raise ValueError(f"found the sieve {METRES_TO_MM * twice:g} mm twice, allowed is each sieve once")
    if not abs(shares[-1] - 1.0) <= ROUNDING:
        raise ValueError(f"{shares[-1]:g} passes the largest sieve, allowed is 1; passing is a fraction, not percent")
    falls = np.flatnonzero(~(np.diff(shares) >= 0.0))
    if len(falls) or not shares[0] >= 0.0:
        at = falls[0] + 1 if len(falls) else 0
        raise ValueError(
            f"{shares[at]:g} passes the sieve of {METRES_TO_MM * sizes[at]:g} mm, allowed is"
            f" {shares[at - 1] if at else 0.0:g} or more: as much as passes a finer one, and none is below 0"
        )
    first = int(np.searchsorted(shares, shares[0], side="right")) - 1  # the coarsest sieve that still stops as much
    last = int(np.searchsorted(shares, 1.0 - ROUNDING))
    first = min(first, last)  # where all passes them all
    return sizes[first : last + 1], shares[first : last + 1]


def _told(diameters: np.ndarray, fractions: np.ndarray, finest: float, median: float) -> str:
    """Return the rule and the classes in sentences."""
    cut = f"The finest {100.0 * finest:.3g} % by mass are counted to the smallest class; the rest is" if finest else ""
    rest = f"{cut or 'The material is'} divided into {len(diameters)} {'class' if len(diameters) == 1 else 'classes'}"
    classes = ", ".join(
        f"{METRES_TO_MM * size:.3g} mm ({100.0 * share:.3g} %)"
        for size, share in zip(diameters, fractions, strict=True)
    )
    return (
        f"{rest} of equal mass, each with the diameter at its middle mass: {classes}."
        f" Half of all mass is finer than {METRES_TO_MM * median:.3g} mm."
    )
