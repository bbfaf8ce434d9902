"""Columns of the tables on a page of equipment, in their order: name and unit."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial

import pandas as pd

from bulkwear.workflows.report.sections import DIGITS, Table

SMALLEST_LENGTH = 1e-9  # mm: what is left of a 0 by rounding
Heads = Mapping[str, tuple[str, str]]

LIFE_COLUMNS = {
    "setting": ("design", ""),
    "part": ("part", ""),
    "rule": ("changed at", ""),
    "x_mm": ("x", "mm"),
    "y_mm": ("y", "mm"),
    "z_mm": ("z", "mm"),
    "allowed_mm": ("may lose", "mm"),
    "pristine_mm_per_1000h": ("as built", "mm per 1,000 h"),
    "worn_mm_per_1000h": ("as worn", "mm per 1,000 h"),
    "life_h": ("life", "h"),
    "life_low_h": ("from", "h"),
    "life_high_h": ("to", "h"),
    "life_Mt": ("life", "Mt"),
    "life_years": ("life", "years"),
    "pristine_life_h": ("by the rate as built", "h"),
    "scatter_low_h": ("scatter alone, from", "h"),
    "scatter_high_h": ("to", "h"),
    "coefficient_low_h": ("coefficient alone, from", "h"),
    "coefficient_high_h": ("to", "h"),
    "how": ("shape", ""),
    "simulated_h": ("worn for", "h"),
    "packings": ("packings", "-"),
    "blocks": ("blocks of the last rate", "-"),
    "agreement": ("agreement", "-"),
}
WORST_COLUMNS = {
    "setting": ("design", ""),
    "part": ("part", ""),
    "rank": ("rank", ""),
    "x_mm": ("x", "mm"),
    "y_mm": ("y", "mm"),
    "z_mm": ("z", "mm"),
    "thickness_mm": ("thickness", "mm"),
    "pristine_mm_per_1000h": ("as built", "mm per 1,000 h"),
    "pristine_low_mm_per_1000h": ("from", "mm"),
    "pristine_high_mm_per_1000h": ("to", "mm"),
    "worn_mm_per_1000h": ("as worn", "mm per 1,000 h"),
    "life_h": ("life", "h"),
    "pressure_Pa": ("pressure", "Pa"),
    "sliding_velocity_m_per_s": ("sliding velocity", "m/s"),
    "sliding_power_W_per_m2": ("sliding power", "W/m²"),
    "impact_power_W_per_m2": ("impact power", "W/m²"),
}
REMAINING_COLUMNS = {
    "setting": ("design", ""),
    "part": ("part", ""),
    "operation_h": ("operation", "h"),
    "operation_Mt": ("fed", "Mt"),
    "remaining_mm": ("left at the worst place", "mm"),
    "remaining_mm_low": ("from", "mm"),
    "remaining_mm_high": ("to", "mm"),
    "least_remaining_mm": ("least of all patches", "mm"),
    "how": ("shape", ""),
}
LOAD_COLUMNS = {
    "setting": ("design", ""),
    "part": ("part", ""),
    "quantity": ("mean load", ""),
    "unit": ("unit", ""),
    "pristine": ("as built", ""),
    "pristine_low": ("from", ""),
    "pristine_high": ("to", ""),
    "worn": ("as worn", ""),
    "worn_low": ("from", ""),
    "worn_high": ("to", ""),
    "change_percent": ("change", "%"),
    "change_percent_low": ("from", "%"),
    "change_percent_high": ("to", "%"),
}
LOAD_NAMES = {
    "force": "force",
    "torque": "torque",
    "sliding_power_W": "sliding power",
    "impact_power_W": "impact power",
    "worn_mass_kg_per_h": "steel lost",
    "power_W": "power of its motion",
}
LIFTER_COLUMNS = {
    "setting": ("design", ""),
    "part": ("part", ""),
    "operation_h": ("operation", "h"),
    "packings": ("packings", "-"),
    "lifters": ("lifters", "-"),
    "height_mm": ("height", "mm"),
    "height_mm_low": ("from", "mm"),
    "height_mm_high": ("to", "mm"),
    "leading_face_angle_deg": ("leading face", "degrees"),
    "leading_face_angle_deg_low": ("from", "degrees"),
    "leading_face_angle_deg_high": ("to", "degrees"),
    "trailing_face_angle_deg": ("trailing face", "degrees"),
    "trailing_face_angle_deg_low": ("from", "degrees"),
    "trailing_face_angle_deg_high": ("to", "degrees"),
    "height_loss_mm_per_1000h": ("height lost since as built", "mm per 1,000 h"),
    "height_loss_mm_per_1000h_low": ("from", "mm per 1,000 h"),
    "height_loss_mm_per_1000h_high": ("to", "mm per 1,000 h"),
}
FLOW_COLUMNS = {
    "setting": ("design", ""),
    "packing": ("packing", ""),
    "phase": ("shape", ""),
    "duration_s": ("simulated", "s"),
    "in_t_per_h": ("in", "t/h"),
    "out_t_per_h": ("out", "t/h"),
    "out_low_t_per_h": ("from", "t/h"),
    "out_high_t_per_h": ("to", "t/h"),
    "held_kg": ("held", "kg"),
    "residence_s": ("residence", "s"),
    "power_W": ("power of parts", "W"),
    "answer": ("steady", ""),
}
STEEL_COLUMNS = {
    "setting": ("design", ""),
    "part": ("part", ""),
    "material": ("material", ""),
    "pristine_kg_per_h": ("lost as built", "kg/h"),
    "pristine_low_kg_per_h": ("from", "kg/h"),
    "pristine_high_kg_per_h": ("to", "kg/h"),
    "pristine_kg_per_Mt": ("lost as built", "kg/Mt"),
    "worn_kg_per_h": ("as worn", "kg/h"),
    "worn_kg_per_Mt": ("as worn", "kg/Mt"),
    "until_change_kg": ("until it is changed", "kg"),
}
DESIGN_COLUMNS = {
    "quantity": ("quantity", ""),
    "part": ("part", ""),
    "setting": ("design", ""),
    "unit": ("unit", ""),
    "value": ("value", ""),
    "value_low": ("from", ""),
    "value_high": ("to", ""),
    "ratio": ("over the first design", "-"),
    "ratio_low": ("from", "-"),
    "ratio_high": ("to", "-"),
    "packings": ("packings", "-"),
    "verdict": ("verdict", ""),
}
IMPACT_COLUMNS = {
    "setting": ("design", ""),
    "part": ("part", ""),
    "sliding_power_W": ("sliding", "W"),
    "impact_power_W": ("impacts", "W"),
    "impact_percent": ("share of impacts", "%"),
}
BALANCE_COLUMNS = {
    "run": ("run", ""),
    "cycles": ("cycles", ""),
    "in": ("in", "particles"),
    "out": ("out", "particles"),
    "held": ("held at the end", "particles"),
    "missing": ("missing", "particles"),
}
ANCHOR_COLUMNS = {
    "quantity": ("quantity", ""),
    "setting": ("design", ""),
    "unit": ("unit", ""),
    "published_value": ("published", ""),
    "published_low": ("from", ""),
    "published_high": ("to", ""),
    "margin": ("margin", ""),
    "computed_value": ("computed", ""),
    "computed_low": ("from", ""),
    "computed_high": ("to", ""),
    "packings": ("packings", "-"),
    "given": ("put in", ""),
    "difference_percent": ("difference", "%"),
    "where": ("of the published range", ""),
    "source": ("source", ""),
    "note": ("note", ""),
    "reason": ("why ours may differ", ""),
}


def shown(data: pd.DataFrame, heads: Heads, file: str = "", note: str = "") -> Table:
    """Return a table of those of its columns that have heads and something to say, in their order."""
    if "setting" in data and data["setting"].nunique() < 2:
        data = data.drop(columns="setting")
    kept = [name for name in heads if name in data and data[name].notna().any() and not (data[name] == "").all()]
    return Table(readable(data[kept]), file, note, heads={name: heads[name] for name in kept})


def readable(data: pd.DataFrame) -> pd.DataFrame:
    """Return a table whose large numbers are whole ones of DIGITS significant digits, shown in full, and lengths 0 that
    are 0 but for rounding.
    """
    numeric = data.select_dtypes("float")
    return data.assign(**{name: numeric[name].map(partial(_shown, length=name.endswith("_mm"))) for name in numeric})


def _shown(value: float, length: bool) -> float:
    if length and abs(value) < SMALLEST_LENGTH:
        return 0.0
    return float(f"{value:.{DIGITS}g}") if math.isfinite(value) and abs(value) >= 10.0**DIGITS else value
