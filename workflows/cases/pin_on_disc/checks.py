"""Checks of the rows of a design of pins on discs, before any solver starts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

COMPARED = "coefficient"  # series of the design that figures of groove and volume are made of
MESHES = "mesh"  # series of the design that differs in its elements only
SHARED = ("load_n", "track_radius_mm", "particle_scale")  # columns; a figure has rows of both series and tells them not


def design_fault(rows: Sequence[Mapping[str, Any]]) -> str | None:
    """Return a phrase if no row is of the series of coefficients, of which most figures and the page are made, if its
    rows or those of the series of meshes differ in load, track or size of the pin, or if meshes have several
    coefficients.
    """
    together = [row for row in rows if row["series"] in (COMPARED, MESHES)]
    if not any(row["series"] == COMPARED for row in together):
        found = _listed(row["series"] for row in rows) or "no row"
        return f"column series holds {found}, allowed is a design with at least one row of series {COMPARED}"
    meshes = [row for row in together if row["series"] == MESHES]
    if found := _several(meshes, "wear_coefficient_per_pa"):
        return f"column wear_coefficient_per_pa holds {found} in series {MESHES}, allowed is one for all its rows"
    for column in SHARED:
        if found := _several(together, column):
            series = " and ".join(name for name in (COMPARED, MESHES) if any(row["series"] == name for row in together))
            return f"column {column} holds {found} in series {series}, allowed is one for these rows"
    return None


def _several(rows: Sequence[Mapping[str, Any]], column: str) -> str:
    """Return the values of a column, "" where rows have one."""
    values = [str(row.get(column, "nothing")) for row in rows]
    return _listed(values) if len(set(values)) > 1 else ""


def _listed(values: Iterable[str]) -> str:
    """Each value once, with commas."""
    return ", ".join(dict.fromkeys(values))
