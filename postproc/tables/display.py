"""Units that people read in figures and their tables: the one place where results leave SI.

The unit is the suffix of a column: `_m3` becomes `_mm3`, `_m` becomes `_mm`, depths `_depth_m` become
`_depth_um`, rates `_m3_per_m` become `_mm3_per_m`, angular speeds `_rad_per_s` become `_deg_per_s`. Other columns
stay as they are.
"""

from __future__ import annotations

import math

import pandas as pd

MILLIMETRES = 1e3  # mm per m
MICROMETRES = 1e6  # um per m
SQUARE_MILLIMETRES = 1e6  # mm2 per m2
CUBIC_MILLIMETRES = 1e9  # mm3 per m3
DEGREES = 180.0 / math.pi  # degrees per radian

# the longest suffix that fits counts, so they stand in that order
CONVERSIONS = (
    ("_m3_per_m", "_mm3_per_m", CUBIC_MILLIMETRES),
    ("_rad_per_s", "_deg_per_s", DEGREES),
    ("_depth_m", "_depth_um", MICROMETRES),
    ("_m3", "_mm3", CUBIC_MILLIMETRES),
    ("_m2", "_mm2", SQUARE_MILLIMETRES),
    ("_m", "_mm", MILLIMETRES),
)
RATES = ("_per_m",)  # per metre stays per metre unless it is listed above


def few_digits(value: float, digits: int = 3) -> str:
    """Return a number of so many significant digits, thousands apart by commas, without an exponent: 5,230."""
    return f"{float(f'{value:.{digits}g}'):,.12g}"


def display_unit(column: str) -> tuple[str, float]:
    """Return (name, factor): how a column of SI values is called and scaled for people."""
    for suffix, shown, factor in CONVERSIONS:
        if column.endswith(suffix):
            return f"{column.removesuffix(suffix)}{shown}", factor
        if suffix == "_m3_per_m" and column.endswith(RATES):
            return column, 1.0
    return column, 1.0


def in_display_units(table: pd.DataFrame) -> pd.DataFrame:
    """Return a table with lengths in mm, depths in um, areas in mm2, volumes in mm3 and angles in degrees."""
    shown = {}
    for column in table:
        name, factor = display_unit(str(column))
        shown[name] = table[column] if factor == 1.0 else table[column] * factor
    return pd.DataFrame(shown)
