"""Numbers in sentences: readable units, means with their intervals, what is more and what is less."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from bulkwear.postproc.statistics.intervals import CONFIDENCE, UNKNOWN
from bulkwear.workflows.report.text import NO_UNIT, number, range_text

DIGITS = 2  # significant ones, as intervals are wide
PERCENT = 100.0
COARSER = {"µm": "mm", "mm": "m"}
COARSE_FROM = 1000.0  # of a unit, from which on the coarser one is read more easily; it is as many times as large
INTERVAL = f"{PERCENT * CONFIDENCE:g} % interval"


def measured(value: float, unit: str = "", digits: int = DIGITS) -> str:
    """Return a number and its unit; in the coarser unit where the number is large: 1.8 mm, not 1800 µm."""
    factor, shown = _readable(value, unit, digits)
    return f"{_rounded(factor * value, digits)}{_ending(shown)}"


def with_interval(
    value: float, low: float, high: float, packings: float, unit: str = "", digits: int = DIGITS, of: str = "packings"
) -> str:
    """Return a mean with its interval and what it is over, or that its scatter is unknown.

    low, high: ends of the interval, NaN where it is unknown; packings: how many there are of what `of` names
    """
    factor, shown = _readable(value, unit, digits)
    mean = f"{_rounded(factor * value, digits)}{_ending(shown)}"
    if not (math.isfinite(low) and math.isfinite(high)):
        return f"{mean} ({UNKNOWN if packings < 2 else 'scatter unknown'})"
    ends = " to ".join(_rounded(factor * end, digits) for end in (low, high))
    return f"{mean} ({INTERVAL} {ends}, {packings:.0f} {of})"


def _readable(value: float, unit: str, digits: int) -> tuple[float, str]:
    """Return the factor to the unit in which a number is told, and that unit."""
    factor, size = 1.0, abs(float(f"{value:.{digits}g}"))
    while unit in COARSER and size >= COARSE_FROM and math.isfinite(size):
        factor, size, unit = factor / COARSE_FROM, size / COARSE_FROM, COARSER[unit]
    return factor, unit


def _rounded(value: float, digits: int) -> str:
    return number(float(f"{value:.{digits}g}"), digits)


def _ending(unit: str) -> str:
    return f" {unit}" if unit and unit != NO_UNIT else ""


def side(low: float, high: float, reference: float = 1.0) -> int:
    """Return 1 or -1 where an interval lies above or below a reference, 0 where it does neither or is not known."""
    return int(low > reference) - int(high < reference)


def less_or_more(ratio: float, low: float, high: float) -> str:
    """Return what a ratio with its interval means in per cent, as what follows a clause.

    Neither is said where the interval holds 1, and nothing where it is not known.
    """
    if math.isnan(low) or math.isnan(high):
        return ""
    if not (where := side(low, high)):
        return ": neither less nor more can be said"
    ends = sorted(PERCENT * abs(end - 1.0) for end in (low, high))
    word = "less" if where < 0 else "more"
    return f": {PERCENT * abs(ratio - 1.0):.0f} % {word} ({ends[0]:.0f} to {ends[1]:.0f} %)"


def listed(items: Sequence[str]) -> str:
    """Return items as an enumeration: a, b and c."""
    return f"{', '.join(items[:-1])} and {items[-1]}" if len(items) > 1 else "".join(items)


def spoken(name: str) -> str:
    """Return a name as people say it."""
    return name.replace("_", " ")


def capital(text: str) -> str:
    """Return words with a capital first."""
    return f"{text[:1].upper()}{text[1:]}"


def sentence(text: str) -> str:
    """Return words as a sentence: a capital first, a full stop at the end."""
    return f"{capital(text)}." if text else ""


def friction_between(particles: Sequence[Mapping[str, Any]]) -> str:
    """Return which material the particles of some runs are of, and the friction between them; ranges where it differs.

    particles: sections of the runs' parameters
    """
    names = " and ".join(dict.fromkeys(particle["name"] for particle in particles))
    sliding, rolling = (
        range_text([particle["contact"][f"{kind}_friction"] for particle in particles])
        for kind in ("sliding", "rolling")
    )
    return f"Between particles ({names}) sliding friction is {sliding}, rolling friction {rolling}."
