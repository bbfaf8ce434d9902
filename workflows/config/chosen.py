"""Which rows of a design are simulated: all of them, or those that the settings choose."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from bulkwear.workflows.config.layers import ConfigError, Layer
from bulkwear.workflows.config.packings import Packings
from bulkwear.workflows.config.validation import locate, unknown_name
from bulkwear.workflows.engine.case import Run

ROWS = "rows"  # key of the settings


def is_wanted(name: str, chosen: list[str]) -> bool:
    """Return whether one of the chosen rows is a row of that name, or a packing of it; all are where none is chosen."""
    return not chosen or any(each == name or each.startswith(f"{name}-") for each in chosen)


def chosen_rows(layers: tuple[Layer, ...], settings: dict[str, Any], designed: Packings) -> list[Layer]:
    """Return the rows that the settings choose by their names or by their setting's, all where they choose none.

    Raises ConfigError.
    """
    known = list(dict.fromkeys(name for pair in designed.setting_of.items() for name in reversed(pair)))
    chosen = settings.get(ROWS, known)
    for name in chosen:
        if name not in known:
            raise ConfigError(unknown_name(locate(layers, (ROWS,)), "row", name, known))
    return [row for row in designed.rows if not {designed.setting_of[n := row.values["row"]], n}.isdisjoint(chosen)]


def runs_of_rows(
    every: list[Layer], chosen: list[Layer], runs_of_row: Callable[[Layer], list[Run]]
) -> dict[str, list[Run]]:
    """Return {row: its runs}; a row that is not chosen, and has a fault, has none. Raises ConfigError."""
    found = {}
    for row in every:
        try:
            found[row.values["row"]] = runs_of_row(row)
        except ConfigError:
            if row in chosen:
                raise
    return found
