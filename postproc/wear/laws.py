"""Wear laws: worn volume per triangle from the load ledger of one cycle.

A law is one function and one entry in `LAWS`: with its words, its source, the contact kernels (kernels.py) whose sums
it needs, and its parameters. Settings, their checks, decks, both ledgers, figures and pages follow from that entry. The
function takes the ledger columns (name -> (m,) array, SI units in the names) and a mapping of parameters (SI, units in
the names), and returns the worn volume of every triangle. That is never negative, proportional to the wear coefficient,
which a study accelerates, and additive in the columns, which are summed over any number of cycles: whatever is not
linear in a contact's force and speed belongs into a kernel.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from bulkwear.postproc.wear.kernels import kernel_column
from bulkwear.postproc.wear.law_declaration import Law, Parameter, check_declaration


def archard(columns: Mapping[str, np.ndarray], parameters: Mapping[str, float]) -> np.ndarray:
    """Worn volume of Archard's law, V_i = alpha_s * sliding_work_i.

    Parameters
    ----------
    columns : needs `sliding_work_J`, (m,) array of sum(F_n |v_t| dt) in J.
    parameters : needs `wear_coefficient_per_pa`, alpha_s in 1/Pa, at least 0.

    Returns
    -------
    (m,) float64 array, worn volume in m3.

    Raises
    ------
    KeyError : the column or the parameter is missing.
    ValueError : alpha_s is negative or not finite.

    Source: Y. Yan, TU Delft 2022, Eq 3.6 and 5.2; J. F. Archard, J. Appl. Phys. 24 (1953) 981.
    """
    return _proportional("sliding_work_J", columns, parameters)


def tangential_work(columns: Mapping[str, np.ndarray], parameters: Mapping[str, float]) -> np.ndarray:
    """Worn volume by the work of friction (shear work), V_i = k * max(tangential_work_i, 0).

    Parameters
    ----------
    columns : needs `tangential_work_J`, (m,) array of -sum(F_t . v_t dt) in J.
    parameters : needs `wear_coefficient_per_pa`, k in 1/Pa, at least 0: Archard's over the coefficient of friction,
        where all contacts slide.

    Returns
    -------
    (m,) float64 array, worn volume in m3; 0 where a triangle gave back more than it took, as one does on which a
    contact unloads that another triangle, or an earlier cycle, has loaded. Additive but for this elastic energy.

    Raises
    ------
    KeyError : the column or the parameter is missing.
    ValueError : k is negative or not finite.

    Source: S. Fouvry, P. Kapsa, L. Vincent, Wear 200 (1996) 186.
    """
    return np.maximum(_proportional("tangential_work_J", columns, parameters), 0.0)


def combined(columns: Mapping[str, np.ndarray], parameters: Mapping[str, float]) -> np.ndarray:
    """Worn volume by sliding, rolling and impact, V_i = k (sliding_work_i + r rolling_work_i + q impact_i).

    Parameters
    ----------
    columns : needs `sliding_work_J`, `rolling_work_J` and `impact_above_threshold_J`, (m,) arrays in J; the last one as
        of `impact_threshold`.
    parameters : needs `wear_coefficient_per_pa`, k in 1/Pa, at least 0, that of sliding, and `rolling_ratio` and
        `impact_ratio`, r and q (-), at least 0: coefficients of rolling and of impact over that of sliding.

    Returns
    -------
    (m,) float64 array, worn volume in m3; Archard's where both ratios are 0.

    Raises
    ------
    KeyError : a column or a parameter is missing.
    ValueError : k or a ratio is negative or not finite.

    Source: rolling, Y. Yan, TU Delft 2022, chapter 7; impact, J. G. A. Bitter, Wear 6 (1963) 5, whose energy per volume
    is 1 / (q k).
    """
    volume, impact = _proportional("sliding_work_J", columns, parameters), kernel_column("impact_above_threshold")
    for column, name in (("rolling_work_J", "rolling_ratio"), (impact, "impact_ratio")):
        volume = volume + _not_negative(parameters, name, "-") * _proportional(column, columns, parameters)
    return volume


def finnie(columns: Mapping[str, np.ndarray], parameters: Mapping[str, float]) -> np.ndarray:
    """Worn volume of Finnie's impact wear as LIGGGHTS counts it, V_i = k * finnie_work_i.

    Parameters
    ----------
    columns : needs `finnie_work_J`, (m,) array of sum(2 E(gamma) |v_rel| |F| dt) in J (kernels.py).
    parameters : needs `wear_coefficient_per_pa`, k in 1/Pa, at least 0.

    Returns
    -------
    (m,) float64 array, worn volume in m3; over the triangle's area it is the solver's own `wear finnie`.

    Raises
    ------
    KeyError : the column or the parameter is missing.
    ValueError : k is negative or not finite.

    Source: I. Finnie, Wear 3 (1960) 87.
    """
    return _proportional(kernel_column("finnie_work"), columns, parameters)


def impact_threshold(columns: Mapping[str, np.ndarray], parameters: Mapping[str, float]) -> np.ndarray:
    """Worn volume by impacts above a threshold, V_i = k * impact_above_threshold_i.

    Parameters
    ----------
    columns : needs `impact_above_threshold_J`, (m,) array of sum(m (v_n - K)^2 / 2) over impacts in J (kernels.py).
    parameters : needs `wear_coefficient_per_pa`, k in 1/Pa, at least 0: one over the energy per worn volume.

    Returns
    -------
    (m,) float64 array, worn volume in m3.

    Raises
    ------
    KeyError : the column or the parameter is missing.
    ValueError : k is negative or not finite.

    Source: J. G. A. Bitter, Wear 6 (1963) 5.
    """
    return _proportional(kernel_column("impact_above_threshold"), columns, parameters)


def oka(columns: Mapping[str, np.ndarray], parameters: Mapping[str, float]) -> np.ndarray:
    """Worn volume of Oka's impact-angle law, V_i = k * oka_energy_i.

    Parameters
    ----------
    columns : needs `oka_energy_J`, (m,) array of sum(m V^2 / 2 (v / V)^k2 g(a)) over impacts in J (kernels.py).
    parameters : needs `wear_coefficient_per_pa`, k in 1/Pa, at least 0: E90 / (V^2 / 2), E90 in m3 per kg of particles
        that hit the surface squarely with V, its dependence on their true size included.

    Returns
    -------
    (m,) float64 array, worn volume in m3.

    Raises
    ------
    KeyError : the column or the parameter is missing.
    ValueError : k is negative or not finite.

    Source: Y. I. Oka, K. Okamura, T. Yoshida, Wear 259 (2005) 95; Y. I. Oka, T. Yoshida, Wear 259 (2005) 102.
    """
    return _proportional(kernel_column("oka_energy"), columns, parameters)


THRESHOLD = ("threshold_velocity_m_per_s", "velocity of impact that wears nothing", 0.0, 100.0)  # of two laws

LAWS: dict[str, Law] = {
    "archard": Law(
        archard,
        "volume = coefficient times normal force times sliding path, coefficient {wear_coefficient_per_pa} 1/Pa, the "
        "same for all particles and places. Rolling and impact are recorded but take no volume.",
        "J. F. Archard, J. Appl. Phys. 24 (1953) 981",
        comparable=True,
    ),
    "tangential_work": Law(
        tangential_work,
        "volume = coefficient times the work of the contacts' tangential force, coefficient "
        "{wear_coefficient_per_pa} 1/Pa, the same for all particles and places. Contacts that stick take no volume.",
        "S. Fouvry, P. Kapsa, L. Vincent, Wear 200 (1996) 186",
        comparable=True,
    ),
    "combined": Law(
        combined,
        "volume = coefficient times (sliding work + {rolling_ratio} rolling work + {impact_ratio} m (v - "
        "{threshold_velocity_m_per_s} m/s)^2 / 2 of every impact that is faster, v the speed along the normal), "
        "coefficient {wear_coefficient_per_pa} 1/Pa, the same for all particles and places.",
        "sliding, J. F. Archard, J. Appl. Phys. 24 (1953) 981; rolling, Y. Yan, TU Delft 2022, chapter 7; impact, "
        "J. G. A. Bitter, Wear 6 (1963) 5",
        kernels=("impact_above_threshold",),
        parameters=(
            Parameter("rolling_ratio", "coefficient of rolling over that of sliding", 0.0, 1e6, 0.0, unit="-"),
            Parameter("impact_ratio", "coefficient of impact energy over that of sliding", 0.0, 1e6, 0.0, unit="-"),
            Parameter(*THRESHOLD, 0.0, unit="m/s"),
        ),
        comparable=True,
    ),
    "finnie": Law(
        finnie,
        "volume = coefficient times a function of the impact angle times force and velocity of the particle's centre, "
        "coefficient {wear_coefficient_per_pa} 1/Pa, the same for all particles and places.",
        "I. Finnie, Wear 3 (1960) 87",
        kernels=("finnie_work",),
        is_solver_measure=True,
    ),
    "impact_threshold": Law(
        impact_threshold,
        "volume = coefficient times m (v - {threshold_velocity_m_per_s} m/s)^2 / 2 of every impact that is faster, v "
        "the speed along the normal at a particle's first touch, coefficient {wear_coefficient_per_pa} 1/Pa, the same "
        "for all particles and places. Sliding and rolling take no volume.",
        "J. G. A. Bitter, Wear 6 (1963) 5",
        kernels=("impact_above_threshold",),
        parameters=(Parameter(*THRESHOLD, unit="m/s"),),
    ),
    "oka": Law(
        oka,
        "volume = coefficient times m V^2 / 2 (v / V)^k2 sin^n1 a (1 + H (1 - sin a))^n2 of every impact, v the speed "
        "and a the angle to the surface of a particle's centre at its first touch, V {reference_velocity_m_per_s} m/s, "
        "k2 {velocity_exponent}, n1 {angle_exponent}, n2 {hardness_exponent}, H the hardness in GPa ({hardness_pa} "
        "Pa), coefficient {wear_coefficient_per_pa} 1/Pa, the same for all particles and places. Sliding and rolling "
        "take no volume.",
        "Y. I. Oka, K. Okamura, T. Yoshida, Wear 259 (2005) 95",
        kernels=("oka_energy",),
        parameters=(
            Parameter("angle_exponent", "n1, by which grazing impacts wear less", 0.01, 10.0, unit="-"),
            Parameter("hardness_exponent", "n2, by which oblique impacts cut", 0.0, 50.0, unit="-"),
            Parameter("hardness_pa", "Vickers hardness of the wall", 1e6, 1e11, unit="Pa"),
            Parameter("velocity_exponent", "k2, power of the speed; 2 is that of the energy", 1.0, 5.0, unit="-"),
            Parameter("reference_velocity_m_per_s", "V, to which the coefficient belongs", 0.001, 1000.0, unit="m/s"),
        ),
    ),
}
NEUTRAL_LAW = "archard"  # whose volume figures and pages name where they say nothing else


def register_law(name: str, law: Law) -> None:
    """Make a law known under a name, in place of one of that name.

    Raises ValueError as `check_declaration`.
    """
    check_declaration(name, law)
    LAWS[name] = law


def worn_volume(law: str, columns: Mapping[str, np.ndarray], parameters: Mapping[str, float]) -> np.ndarray:
    """Worn volume per triangle (m,) in m3 by the law of that name.

    Raises
    ------
    ValueError : no law of that name; the message names the allowed ones.
    KeyError : a ledger column or parameter that the law needs is missing.
    """
    return law_of(law).volume(columns, parameters)


def law_of(name: str) -> Law:
    """Return the law of that name. Raises ValueError where there is none; the message names the allowed ones."""
    if name not in LAWS:
        raise ValueError(f"wear law '{name}' is unknown, allowed are: {', '.join(sorted(LAWS))}")
    return LAWS[name]


def _proportional(column: str, columns: Mapping[str, np.ndarray], parameters: Mapping[str, float]) -> np.ndarray:
    work = _required(columns, column, "ledger column")
    return _not_negative(parameters, "wear_coefficient_per_pa", "1/Pa") * np.asarray(work, dtype=np.float64)


def _not_negative(parameters: Mapping[str, float], name: str, unit: str) -> float:
    value = float(_required(parameters, name, "wear parameter"))
    if not (np.isfinite(value) and value >= 0.0):
        raise ValueError(f"{name} is {value}, allowed is a finite number >= 0 ({unit})")
    return value


def _required(mapping: Mapping, name: str, kind: str):
    if name not in mapping:
        raise KeyError(f"{kind} '{name}' is missing, found: {', '.join(map(str, mapping)) or 'nothing'}")
    return mapping[name]
