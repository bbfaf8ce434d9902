"""Configuration in SI: the one place where the units that its keys spell are converted."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

SECONDS_PER_HOUR = 3600.0
KG_PER_TONNE = 1000.0
# End of a key -> end of its key in SI, and what makes SI of a value; of ends that end alike the longer one first.
TO_SI: dict[str, tuple[str, Callable[[float], float]]] = {
    "mm": ("m", lambda value: value / 1000.0),
    "deg": ("rad", math.radians),
    "deg_per_s": ("rad_per_s", math.radians),
    "rpm": ("rad_per_s", lambda value: value * 2.0 * math.pi / 60.0),
    "t_per_h": ("kg_per_s", lambda value: value * KG_PER_TONNE / SECONDS_PER_HOUR),
    "mt": ("kg", lambda value: value * 1e6 * KG_PER_TONNE),
    "h": ("s", lambda value: value * SECONDS_PER_HOUR),
}


def to_si(values: Any) -> Any:
    """Return values in SI, with keys that say so: width_mm -> width_m, skirt_slope_deg -> skirt_slope_rad.

    Every other unit of the schemas (N, Pa, 1/Pa, kg/m3, m/s, steps) is SI already. Names of blocks stay, whatever they
    end in, and so do the user's own words for templates (`deck`).
    """
    if not isinstance(values, dict):
        return values
    return {**_in_si(values), **({"deck": values["deck"]} if "deck" in values else {})}


@cache
def _end(key: str) -> str:
    """Return the unit that a key ends in, one of TO_SI; nothing where it ends in none."""
    return next((end for end in TO_SI if key.endswith(f"_{end}")), "")


def _in_si(values: dict[str, Any]) -> dict[str, Any]:
    converted = {}
    for key, value in values.items():
        end = _end(key)
        if isinstance(value, dict) or not end:
            converted[key] = _in_si(value) if isinstance(value, dict) else value
            continue
        unit, convert = TO_SI[end]
        several = isinstance(value, list)
        converted[f"{key.removesuffix(end)}{unit}"] = [convert(each) for each in value] if several else convert(value)
    return converted
