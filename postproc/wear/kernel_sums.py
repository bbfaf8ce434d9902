"""Sums of contact kernels: which laws need them, one for each set of parameters, and which are those of a law."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from bulkwear.postproc.wear.kernels import kernel_column, kernel_of, kernel_parameters, sum_label
from bulkwear.postproc.wear.laws import law_of


def law_kernels(name: str, parameters: Mapping[str, float]) -> dict[str, dict[str, float]]:
    """Return {contact kernel: {parameter: value}} that the law of that name needs.

    parameters: of the law, SI

    Raises ValueError for a law that there is not, KeyError for a parameter that is missing.
    """
    return {kernel: {key: parameters[key] for key in kernel_parameters(kernel)} for kernel in law_of(name).kernels}


def kernel_sums(laws: Iterable[tuple[str, Mapping[str, float]]]) -> dict[str, dict[str, float]]:
    """Return {label as in kernels.py: {parameter: value}} of the sums that several laws need together, in their order.

    laws: name and parameters of each

    Raises as `law_kernels`.
    """
    found: dict[str, dict[str, float]] = {}
    for name, values in laws:
        for kernel, given in law_kernels(name, values).items():
            sets = [known for label, known in found.items() if kernel_of(label) == kernel]
            if given not in sets:
                found[sum_label(kernel, len(sets) + 1)] = given
    return found


def columns_of_law(
    columns: Mapping[str, np.ndarray],
    sums: Mapping[str, Mapping[str, float]],
    law: str,
    parameters: Mapping[str, float],
) -> dict[str, np.ndarray]:
    """Return the columns of a ledger as the function of a law takes them: of its kernels the sums with its parameters.

    columns: {name: (m,)}; sums: that the ledger holds, as from `kernel_sums`; law, parameters: as for `law_kernels`

    A sum that the ledger does not hold is not there. Raises as `law_kernels`.
    """
    found = dict(columns)
    for kernel, given in law_kernels(law, parameters).items():
        found.pop(kernel_column(kernel), None)
        for label, values in sums.items():
            if kernel_of(label) == kernel and values == given and kernel_column(label) in columns:
                found[kernel_column(kernel)] = columns[kernel_column(label)]
    return found
