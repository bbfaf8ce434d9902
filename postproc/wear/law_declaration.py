"""What a wear law declares of itself, and what a declaration must hold."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from string import Formatter

import numpy as np

from bulkwear.postproc.wear.kernels import kernel_column


@dataclass(frozen=True)
class Parameter:
    """A number of a law, besides the wear coefficient, that the configuration gives: `wear.parameters.<name>`.

    name: ends in its unit as every key of the configuration does, without one for a pure number; the law's function and
        its kernels get it in SI (`length_mm` as `length_m`)
    meaning: one line
    lowest, highest: the allowed range, ends included
    default: None where the configuration must give it
    unit: the one that the name ends in, as people write it (N of `force_n`); "-" of a pure number
    """

    name: str
    meaning: str
    lowest: float
    highest: float
    default: float | None = None
    unit: str = ""


@dataclass(frozen=True)
class Law:
    """A wear law.

    volume: the function
    words: what a volume is by this law, with {wear_coefficient_per_pa} and the names of its parameters, in braces,
        where a page shows their values
    source: where it was published
    kernels: names of the contact kernels whose sums the ledger must have
    parameters: what it takes besides the wear coefficient; a kernel takes its own parameters from these
    is_solver_measure: whether LIGGGHTS' own `wear finnie` counts the same
    comparable: whether its coefficient is volume over work of sliding contacts, as Archard's, so that volumes by the
        same coefficient may be set side by side
    """

    volume: Callable[[Mapping[str, np.ndarray], Mapping[str, float]], np.ndarray]
    words: str
    source: str
    kernels: tuple[str, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    is_solver_measure: bool = False
    comparable: bool = False


def check_declaration(name: str, law: Law) -> None:
    """Raise ValueError, without the end of its sentence, for what is no law, a parameter without a unit, kernels that
    are not registered, and words that name other values than the law has.

    name: of the law
    """
    if not isinstance(law, Law):
        raise ValueError(f"law {name} is {type(law).__name__}, allowed is a Law(...)")
    if not callable(law.volume):
        raise ValueError(f"volume of the law {name} is {law.volume!r}, allowed is a function")
    if not (isinstance(law.parameters, tuple) and all(isinstance(each, Parameter) for each in law.parameters)):
        raise ValueError(f"parameters of the law {name} are {law.parameters!r}, allowed is a tuple of Parameter(...)")
    for parameter in law.parameters:
        _check_parameter(name, parameter)
    for kernel in law.kernels:
        kernel_column(kernel)
    given = {"wear_coefficient_per_pa", *(parameter.name for parameter in law.parameters)}
    try:
        asked = {field for _, field, _, _ in Formatter().parse(law.words) if field is not None}
    except ValueError as fault:
        raise ValueError(
            f"words of the law {name}: {fault}, allowed in braces are: {', '.join(sorted(given))}"
        ) from None
    if asked - given:
        names = ", ".join(f"{{{field}}}" for field in sorted(asked - given))
        raise ValueError(f"words of the law {name} have {names}, allowed in braces are: {', '.join(sorted(given))}")


def _check_parameter(law: str, parameter: Parameter) -> None:
    """Raise ValueError for a parameter without a unit, or whose range and default are no numbers that go together."""
    if not parameter.unit:
        raise ValueError(
            f"parameter {parameter.name} of the law {law} has no unit, allowed is the one that its name ends in "
            "(N of force_n), or - of a pure number"
        )
    limits = [parameter.lowest, parameter.default, parameter.highest]
    numbers = [limit for limit in limits if limit is not None]
    if not all(isinstance(limit, int | float) for limit in numbers) or numbers != sorted(numbers):
        raise ValueError(
            f"lowest, default and highest of the parameter {parameter.name} of the law {law} are "
            f"{', '.join(map(repr, limits))}, allowed are numbers in this order, the default or None"
        )
