"""Wear laws: worn volume per triangle from the load ledger of one cycle.

A law is one function and one line in `LAWS`, with the contact kernels (kernels.py) whose sums it needs. It takes the
ledger columns (name -> (m,) array, SI units in the names) and a mapping of parameters (units in the names), and
returns the worn volume of every triangle.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from postproc.wear.kernels import kernel_column


@dataclass(frozen=True)
class Law:
    """A wear law: its function, and the contact kernels whose sums the ledger must have for it."""

    volume: Callable[[Mapping[str, np.ndarray], Mapping[str, float]], np.ndarray]
    kernels: tuple[str, ...] = ()


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


LAWS: dict[str, Law] = {"archard": Law(archard), "finnie": Law(finnie, kernels=("finnie_work",))}


def law_kernels(law: str) -> tuple[str, ...]:
    """Contact kernels that the law of that name needs. Raises ValueError as `worn_volume`."""
    return _law(law).kernels


def worn_volume(law: str, columns: Mapping[str, np.ndarray], parameters: Mapping[str, float]) -> np.ndarray:
    """Worn volume per triangle (m,) in m3 by the law of that name.

    Raises
    ------
    ValueError : no law of that name; the message names the allowed ones.
    KeyError : a ledger column or parameter that the law needs is missing.
    """
    return _law(law).volume(columns, parameters)


def _law(name: str) -> Law:
    if name not in LAWS:
        raise ValueError(f"wear law '{name}' is unknown, allowed are: {', '.join(sorted(LAWS))}")
    return LAWS[name]


def _proportional(column: str, columns: Mapping[str, np.ndarray], parameters: Mapping[str, float]) -> np.ndarray:
    work = _required(columns, column, "ledger column")
    wear_coefficient = float(_required(parameters, "wear_coefficient_per_pa", "wear parameter"))
    if not (np.isfinite(wear_coefficient) and wear_coefficient >= 0.0):
        raise ValueError(f"wear_coefficient_per_pa is {wear_coefficient}, allowed is a finite number >= 0 (1/Pa)")
    return wear_coefficient * np.asarray(work, dtype=np.float64)


def _required(mapping: Mapping, name: str, kind: str):
    if name not in mapping:
        raise KeyError(f"{kind} '{name}' is missing, found: {', '.join(map(str, mapping)) or 'nothing'}")
    return mapping[name]
