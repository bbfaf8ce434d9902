"""What a study of equipment computes, number by number, and published values beside it.

Names of numbers: <quantity>_<part>, of loads, rates and lifters <quantity>_<part>_<pristine or worn>, of the flow and
of a mill's charge <quantity>_<pristine or worn>. A row of config/published/equipment_anchors.csv stands beside the
number of its name and unit.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.intervals import estimate
from bulkwear.workflows.cases.equipment.comparison import FIRST
from bulkwear.workflows.cases.equipment.lifters import HEIGHT, LEADING, LOSS
from bulkwear.workflows.cases.equipment.machine_tables import RPM
from bulkwear.workflows.cases.equipment.tables import KEPT, PRISTINE

COLUMNS = ["quantity", "setting", "value", "low", "high", "unit", "packings", "given"]
GIVEN = "given"  # in the column of its name: put in by the study, as a coefficient or a size as drawn; else ""
LOAD_ANGLE = "load_angle_deg"
PER_PACKING = {  # table with a row per packing and phase: its columns and their units
    "flow": {"out_t_per_h": "t/h", "held_kg": "kg", "residence_s": "s", "power_W": "W"},
    "charge": {"toe_deg": "degrees", "shoulder_deg": "degrees", LOAD_ANGLE: "degrees"},
}
NAMES = {"out_t_per_h": "out", "held_kg": "held", "residence_s": "residence", "power_W": "power"}
WEEKS_PER_YEAR = 365.25 / 7.0
SETTINGS = "settings"  # column of published values: the settings of the design that they are beside
INSIDE, ABOVE, BELOW = "inside", "above", "below"

Rows = list[dict[str, Any]]


def key_numbers(found: Mapping[str, pd.DataFrame], runs: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return COLUMNS of all that a study computes, a row per number and setting.

    found: tables life, loads, steel, remaining, designs, flow, and of mills charge and lifters
    runs: values of `values_of_runs`
    """
    rows = [*_given(runs), *_lives(found["life"]), *_loads(found["loads"])]
    for row in found["steel"].itertuples():
        rows.append(_row(row, f"steel_lost_{row.part}", "kg per Mt", row.pristine_kg_per_Mt))
    for row in found["remaining"].itertuples():
        ends = row.remaining_mm, row.remaining_mm_low, row.remaining_mm_high
        rows.append(_row(row, f"remaining_{row.part}_after_{row.operation_h:.6g}_h", "mm", *ends))
    rows += _less_steel(found["designs"])
    if "lifters" in found:
        rows += _lifters(found["lifters"])
    if "charge" in found:
        found = {**found, "charge": _with_load_angle(found["charge"])}
    for name, columns in PER_PACKING.items():
        if name in found:
            rows += _over_packings(found[name], columns)
    return pd.DataFrame(rows, columns=COLUMNS).fillna({"given": ""})


def _given(runs: Sequence[Mapping[str, Any]]) -> Rows:
    """Return what a study gives that is published as well: coefficients (1/Pa) and speeds (rpm) of its parts."""
    rows = []
    for run in {run["setting"]: run for run in reversed(runs)}.values():
        for name, part in run["parts"].items():
            own = {"setting": run["setting"], "given": GIVEN}
            if part["wears"]:
                coefficient = {"value": part["wear_coefficient_per_pa"], "unit": "1/Pa"}
                rows.append({"quantity": f"wear_coefficient_{name}", **own, **coefficient})
            if speed := (part["motion"] or {}).get("speed_rad_per_s"):
                rows.append({"quantity": f"speed_{name}", **own, "value": abs(speed) * RPM, "unit": "rpm"})
    return rows


def _lives(life: pd.DataFrame) -> Rows:
    rows = []
    for row in life.itertuples():
        ends = row.life_h, row.life_low_h, row.life_high_h
        weeks = WEEKS_PER_YEAR * row.life_years / row.life_h  # of service, in an hour of operation
        rows.append(_row(row, f"life_{row.part}", "h", *ends))
        rows.append(_row(row, f"life_in_weeks_{row.part}", "weeks", *(weeks * end for end in ends)))
        for phase in KEPT:
            rate = getattr(row, f"{phase}_mm_per_1000h")
            rows.append(_row(row, f"worst_recession_{row.part}_{phase}", "mm per 1,000 h", rate))
    return rows


def _loads(loads: pd.DataFrame) -> Rows:
    rows = []
    for row in loads.itertuples():
        for phase in KEPT:
            values = (getattr(row, f"{phase}{end}") for end in ("", "_low", "_high"))
            rows.append(_row(row, f"{row.quantity}_{row.part}_{phase}", row.unit, *values))
    return rows


def _less_steel(designs: pd.DataFrame) -> Rows:
    """Return by how much less steel the parts of each design lose than those of the first one."""
    rows = []
    chosen = designs[(designs["quantity"] == "steel_lost") & (designs["verdict"] != FIRST)]
    for row in chosen[chosen["ratio"].notna()].itertuples():
        less = (100.0 * (1.0 - ratio) for ratio in (row.ratio, row.ratio_high, row.ratio_low))
        rows.append(_row(row, f"less_steel_lost_{row.part}", "%", *less))
    return rows


def _lifters(lifters: pd.DataFrame) -> Rows:
    """Return height, angle of the leading face, and loss of height of lifters, as built and after the last update."""
    rows = []
    for (_, part), updates in lifters.groupby(["setting", "part"], sort=False):
        last = updates.iloc[-1]
        for phase, row in zip(KEPT, (updates.iloc[0], last) if len(updates) > 1 else (last,), strict=False):
            drawn = {"given": GIVEN if phase == PRISTINE else ""}
            rows.append(_row(row, f"lifter_height_{part}_{phase}", "mm", *_ends(row, HEIGHT)) | drawn)
            rows.append(_row(row, f"lifter_face_angle_{part}_{phase}", "degrees", *_ends(row, LEADING)) | drawn)
        rows.append(_row(last, f"lifter_height_loss_{part}", "mm per 1,000 h", *_ends(last, LOSS)))
    return [row for row in rows if np.isfinite(row["value"])]


def _ends(row: pd.Series, name: str) -> tuple[float, ...]:
    return tuple(float(row[f"{name}{end}"]) for end in ("", "_low", "_high"))


def _with_load_angle(charge: pd.DataFrame) -> pd.DataFrame:
    """Return toe and shoulder with LOAD_ANGLE, the slope of the chord between them, see `flow.charge_angles`."""
    middle = charge["toe_deg"] + 0.5 * ((charge["shoulder_deg"] - charge["toe_deg"]) % 360.0)  # of the charge's arc
    return charge.assign(**{LOAD_ANGLE: middle - 180.0})


def _over_packings(table: pd.DataFrame, columns: Mapping[str, str]) -> Rows:
    """Return the mean over packings of columns, a row per column, phase and setting."""
    rows = []
    for (setting, phase), packings in table.groupby(["setting", "phase"], sort=False):
        for column, unit in columns.items():
            mean = estimate(packings[column].to_numpy(float))
            if np.isfinite(mean.value):
                quantity = f"{NAMES.get(column, column.removesuffix('_deg'))}_{phase}"
                ends = dict(zip(("low", "high"), mean.interval(), strict=True))
                own = {"setting": setting, "packings": mean.packings, "value": mean.value, "unit": unit}
                rows.append({"quantity": quantity, **own, **ends})
    return rows


def _row(
    row: Any, quantity: str, unit: str, value: float, low: float = math.nan, high: float = math.nan
) -> dict[str, Any]:
    """Return a number of a setting; row: of a table, with `setting` and perhaps `packings`."""
    own = {"setting": row.setting, "packings": getattr(row, "packings", math.nan)}
    return {"quantity": quantity, **own, "unit": unit, "value": value, "low": low, "high": high}


def beside_anchors(anchors: pd.DataFrame, computed: pd.DataFrame) -> pd.DataFrame:
    """Return published values beside the computed ones of the same quantity and unit.

    difference_percent: computed over published, less 1; where: whether the computed one lies in the published range.
    anchors: rows of equipment_anchors.csv of a study, each beside its `settings` alone where it names some; computed:
    as from `key_numbers`. A value that the study does not compute stands there without one.
    """
    theirs = anchors.rename(columns={name: f"published_{name}" for name in ("value", "low", "high")})
    ours = computed.rename(columns={name: f"computed_{name}" for name in ("value", "low", "high")})
    table = theirs.assign(anchor=range(len(theirs))).merge(ours, on=["quantity", "unit"], how="left", sort=False)
    table["setting"] = table["setting"].fillna("")
    table = _of_its_settings(table, ours.columns) if SETTINGS in table else table.drop(columns="anchor")
    table["difference_percent"] = 100.0 * (table["computed_value"] / table["published_value"] - 1.0)
    value, low, high = (table[name] for name in ("computed_value", "published_low", "published_high"))
    where = np.select([value < low, value > high, (value >= low) & (value <= high)], [BELOW, ABOVE, INSIDE], "")
    return table.assign(where=where)


def _of_its_settings(table: pd.DataFrame, computed: Sequence[str]) -> pd.DataFrame:
    """Return published values without the computed ones of settings that they are not of; each stands at least once.

    table: with columns anchor, one number per published value, and SETTINGS; computed: columns of what is computed
    """
    named = [each.split() if isinstance(each, str) else [] for each in table[SETTINGS]]
    of_it = np.array([not names or own in names for names, own in zip(named, table["setting"], strict=True)], bool)
    found = pd.Series(of_it).groupby(table["anchor"]).transform("any").to_numpy(bool)
    alone = ~found & ~table.duplicated("anchor").to_numpy()
    for name in computed:
        if name not in ("quantity", "unit"):
            table[name] = table[name].where(~alone, "" if name == "setting" else np.nan)
    return table[of_it | alone].drop(columns=["anchor", SETTINGS]).reset_index(drop=True)
