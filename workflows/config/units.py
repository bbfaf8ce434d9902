"""Configuration in SI: the one place where the units that its keys spell are converted."""

from __future__ import annotations

import math
from typing import Any

SECONDS_PER_HOUR = 3600.0


def to_si(values: Any) -> Any:
    """Return values in SI, with keys that say so: width_mm -> width_m, skirt_slope_deg -> skirt_slope_rad.

    Every other unit of the schemas (N, Pa, 1/Pa, kg/m3, m/s, steps) is SI already. The user's own words for templates
    (`deck`) stay as they are written.
    """
    if not isinstance(values, dict):
        return values
    converted = {}
    for key, value in values.items():
        if key == "deck":
            converted[key] = value
        elif key.endswith("_mm"):
            converted[f"{key.removesuffix('_mm')}_m"] = value / 1000.0
        elif key.endswith("_deg"):
            converted[f"{key.removesuffix('_deg')}_rad"] = math.radians(value)
        elif key.endswith("_h"):
            converted[f"{key.removesuffix('_h')}_s"] = value * SECONDS_PER_HOUR
        elif key.endswith("_deg_per_s"):
            converted[f"{key.removesuffix('_deg_per_s')}_rad_per_s"] = math.radians(value)
        else:
            converted[key] = to_si(value)
    return converted
