"""Tables of the life of parts: when they are changed, their worst places, what is left, and the steel that is lost."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import area_vectors, boundary_edges, read_surface
from bulkwear.postproc.statistics.intervals import Estimate, estimate
from bulkwear.postproc.statistics.worst_place import geometric_mean
from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.postproc.wear.directions import ON_END
from bulkwear.workflows.cases.equipment.change_out import BY_MASS, allowed_depths, rule_of, rule_words
from bulkwear.workflows.cases.equipment.life import (
    AS_BUILT,
    WHOLE_PART,
    WORST,
    PartLife,
    mass_courses,
    patch_courses,
)
from bulkwear.workflows.cases.equipment.motions import surface_runs
from bulkwear.workflows.cases.equipment.tables import (
    AT_A_PATCH,
    HOURS,
    KEPT,
    PLACE,
    SECONDS_PER_HOUR,
    Runs,
    mt_per_hour,
    over_packings,
    with_ends,
)

HOURS_OF_REMAINING = 1e-6  # -, of the hours that are asked for: nearer ones are the same
SIMULATED, BEYOND = "simulated", "last rate goes on"
Lives = Mapping[tuple[str, str], PartLife]


def part_volumes(surface: str, run: Mapping[str, Any]) -> dict[str, float]:
    """Return the volume (m3) of each part that wears and is closed, and whose mass decides.

    surface: of the run as built, whose labels are the numbers of the parts. A part may be open at the ends of a slice,
    where it goes on in its image; its volume is then that within the slice.
    """
    by_mass = [name for name, part in run["parts"].items() if BY_MASS in rule_of(run["operation"], part)]
    if not by_mass:
        return {}
    mesh, found = read_surface(surface), {}
    for number, (name, part) in enumerate(run["parts"].items()):
        triangles = mesh.triangles[mesh.cell_data["part"] == number]
        if part["wears"] and name in by_mass and _closed(mesh.points, triangles, run["periodic"]):
            found[name] = _volume(mesh.points, triangles, run["periodic"])
    return found


def _closed(points: np.ndarray, triangles: np.ndarray, periodic: Mapping[str, Any] | None) -> bool:
    """Return whether a surface has no rim, but for those in the ends of a slice."""
    rim = boundary_edges(triangles)
    if not periodic or not len(rim):
        return not len(rim)
    along = points[rim][:, :, "xyz".index(periodic["axis"])]
    return all(any(np.abs(edge - periodic[end]).max() < ON_END for end in ("low_m", "high_m")) for edge in along)


def _volume(points: np.ndarray, triangles: np.ndarray, periodic: Mapping[str, Any] | None) -> float:
    """Return the volume (m3) within a surface, by the flux of a field across the slice, of which its ends have none."""
    across = next(k for k, axis in enumerate("xyz") if not periodic or axis != periodic["axis"])
    heights = points[triangles][:, :, across].mean(axis=1) - points[:, across].mean()
    return abs(float(heights @ area_vectors(points, triangles)[:, across]))


# ---------------------------------------------------------------- life


def life_table(runs: Runs, lives: Lives) -> pd.DataFrame:
    """Return a row per setting and part that wears: the place that decides and its life in h, Mt and years.

    worn_mm_per_1000h, worn_over_built: NaN where no shape was worn; of a rule by mass only the second is known
    life_low_h, life_high_h: with scatter and coefficient; scatter_..., coefficient_...: with one of them alone; of one
    packing the scatter is that of its blocks, which tells nothing of another packing; surface_runs: whether the part
    stays where it is and its surface runs
    """
    rows = []
    for (setting, part), life in lives.items():
        run = runs.first(setting)
        row = {"setting": setting, "part": part, "patch": life.patch, **_place(runs, setting, part, life.patch)}
        row["surface_runs"] = surface_runs(run["parts"][part]["motion"])
        row["rule"] = rule_words(rule_of(run["operation"], run["parts"][part]))
        row["asked_h"] = run["operation"].get("duration_s", 0.0) / SECONDS_PER_HOUR
        row["allowed_mm"] = life.allowed * MILLIMETRES if life.patch != WHOLE_PART else math.nan
        row |= _lives_in_hours(life) | _in_other_units(life, run)
        row |= {"how": life.how, "simulated_h": life.simulated_h, "packings": runs_of(runs, setting)}
        row |= {"blocks": life.blocks, "agreement": life.agreement, "reason": life.reason}
        row |= _earlier(runs, setting, part, life) | _faster(runs, setting, part, life)
        rows.append(row)
    return pd.DataFrame(rows)


def runs_of(runs: Runs, setting: str) -> int:
    """Return how many packings a setting has."""
    return sum(run["setting"] == setting for run in runs.values)


def _place(runs: Runs, setting: str, part: str, patch: int) -> dict[str, float]:
    if patch == WHOLE_PART:
        return {f"{axis}_mm": math.nan for axis in PLACE} | {"thickness_mm": math.nan}
    places, _ = patch_courses(runs, setting, part)
    found = places.loc[patch]
    place = {f"{axis}_mm": found[f"{axis}_m"] * MILLIMETRES for axis in PLACE}
    return place | {"thickness_mm": found["thickness_m"] * MILLIMETRES}


def _faster(runs: Runs, setting: str, part: str, life: PartLife) -> dict[str, Any]:
    """Return the place without a life that wears faster than the deciding one, NaN where there is none."""
    found = life.faster
    where = _place(runs, setting, part, found.patch if found else WHOLE_PART)
    rate = found.rate * MILLIMETRES * HOURS if found else math.nan
    return {"faster_mm_per_1000h": rate} | {f"faster_{name}_mm": where[f"{name}_mm"] for name in (*PLACE, "thickness")}


def _earlier(runs: Runs, setting: str, part: str, life: PartLife) -> dict[str, Any]:
    """Return the place that one packing alone would have changed much earlier, NaN where there is none."""
    found = life.earlier
    where = _place(runs, setting, part, found.patch if found else WHOLE_PART)
    place = {f"earlier_{axis}_mm": where[f"{axis}_mm"] for axis in PLACE}
    packing, hours = (found.packing, found.hours) if found else (math.nan, math.nan)
    return {"earlier_h": hours, "earlier_packing": packing, **place}


def _lives_in_hours(life: PartLife) -> dict[str, float]:
    low, high = life.ends()
    scatter, coefficient = life.ends(coefficient=False), life.ends(scatter=False)
    pristine = life.pristine_life
    rate = MILLIMETRES * HOURS if life.patch != WHOLE_PART else math.nan
    worn = life.worn if life.how != AS_BUILT else math.nan
    return {
        "life_h": life.life.value,
        **{"life_low_h": low, "life_high_h": high},
        **{"scatter_low_h": scatter[0], "scatter_high_h": scatter[1]},
        **{"coefficient_low_h": coefficient[0], "coefficient_high_h": coefficient[1]},
        "coefficient_error": life.error,
        **with_ends("pristine_life_h", pristine),
        "pristine_mm_per_1000h": life.pristine * rate,
        "worn_mm_per_1000h": worn * rate,
        "worn_over_built": worn / life.pristine if life.pristine > 0.0 else math.nan,
    }


def _in_other_units(life: PartLife, run: Mapping[str, Any]) -> dict[str, float]:
    """Return the life and its interval in Mt, NaN without an inlet, and in years."""
    per_year = run["operation"].get("hours_per_year_s", math.nan) / SECONDS_PER_HOUR
    ends = dict(zip(("life", "life_low", "life_high"), (life.life.value, *life.ends()), strict=True))
    units = {"Mt": mt_per_hour(run), "years": 1.0 / per_year}
    return {f"{name}_{unit}": value * factor for unit, factor in units.items() for name, value in ends.items()}


# ---------------------------------------------------------------- worst places


def worst_places(runs: Runs, rates: pd.DataFrame, lives: Lives) -> pd.DataFrame:
    """Return the WORST patches of each part that wears, those of the shortest life first, of all packings and blocks.

    rates: as from `tables.rates_table`. Where the thickness is not known the fastest come first, without a life.
    Patches that nothing wears are left out, but for one of a part that nothing wears at all.
    """
    rows = []
    for setting, part in lives:
        places, courses = patch_courses(runs, setting, part)
        run = runs.first(setting)
        rule = rule_of(run["operation"], run["parts"][part])
        allowed = allowed_depths(places["thickness_m"].to_numpy(), rule)
        last = np.array([course.last.mean(axis=0) for course in courses])
        hours = np.array([course.until(allowed, rate) for course, rate in zip(courses, last, strict=True)])
        load = geometric_mean(1.0 / hours)
        order = np.argsort(-np.where(np.isnan(load), 0.0, load), kind="stable")
        if np.isnan(load).all():
            order = np.argsort(-last.mean(axis=0), kind="stable")
        worn = [k for k in order[:WORST] if last[:, k].any()]
        for rank, k in enumerate(worn or order[:1], start=1):
            life = 1.0 / load[k] if load[k] > 0.0 else math.nan
            rows.append({"setting": setting, "part": part, "rank": rank, "patch": places.index[k], "life_h": life})
    table = pd.DataFrame(rows).merge(rates, on=["setting", "part", "patch"], how="left", sort=False)
    shown = [f"{axis}_mm" for axis in PLACE]
    phases = [f"{phase}_{name}mm_per_1000h" for phase in KEPT for name in ("", "low_", "high_")]
    return table[["setting", "part", "rank", "patch", *shown, "thickness_mm", *phases, "life_h", *AT_A_PATCH]]


# ---------------------------------------------------------------- what is left


def remaining_table(runs: Runs, lives: Lives) -> pd.DataFrame:
    """Return a row per setting, part and hours: the thickness left at the place that decides, and the least of all.

    hours: those of the updates of the first packing, the longest that all packings were worn for, the operation that
    is asked for, those of operation.told_at_h; of what is worn through 0 is left. Intervals are over packings,
    without the coefficient's.
    how: SIMULATED, or BEYOND what was worn.
    """
    rows = []
    for (setting, part), life in lives.items():
        places, courses = patch_courses(runs, setting, part)
        thickness = places["thickness_m"].to_numpy()
        if np.isnan(thickness).all():
            continue
        worn_for = min(course.hours[-1] for course in courses)
        at = int(np.flatnonzero(places.index == life.patch)[0]) if life.patch in places.index else None
        run = runs.first(setting)
        for hours in _hours_told(courses[0].hours, worn_for, run["operation"]):
            left = MILLIMETRES * np.maximum([thickness - course.at(hours) for course in courses], 0.0)
            deciding = estimate(left[:, at]) if at is not None else Estimate(math.nan, math.nan, 0, 0)
            row = {"setting": setting, "part": part, "operation_h": hours, "operation_Mt": hours * mt_per_hour(run)}
            row |= {name: np.maximum(end, 0.0) for name, end in with_ends("remaining_mm", deciding).items()}
            least = np.nanmean(np.nanmin(left, axis=1))
            rows.append(row | {"least_remaining_mm": least, "packings": len(courses), "how": how_told(hours, worn_for)})
    return pd.DataFrame(rows, columns=REMAINING)


REMAINING = [
    *("setting", "part", "operation_h", "operation_Mt"),
    *("remaining_mm", "remaining_mm_low", "remaining_mm_high", "least_remaining_mm", "packings", "how"),
]


def _hours_told(updates: np.ndarray, worn_for: float, operation: Mapping[str, Any]) -> list[float]:
    asked = operation.get("duration_s", 0.0) / SECONDS_PER_HOUR
    return hours_apart([*updates[updates <= worn_for], worn_for, asked, *wanted_hours(operation)])


def wanted_hours(operation: Mapping[str, Any]) -> list[float]:
    """Return the hours of operation.told_at_h."""
    return [seconds / SECONDS_PER_HOUR for seconds in operation.get("told_at_s", ())]


def hours_apart(hours: Iterable[float]) -> list[float]:
    """Return hours in order, each once: sums of updates and what is asked for differ by rounding."""
    told = sorted({float(each) for each in hours})
    same = [after - each <= HOURS_OF_REMAINING * after for each, after in pairwise(told)]
    return [each for each, again in zip(told, [*same, False], strict=True) if not again]


def how_told(hours: float, worn_for: float) -> str:
    """Return how what is left after hours is known of a shape that was worn for others: SIMULATED or BEYOND."""
    return SIMULATED if hours <= worn_for * (1.0 + HOURS_OF_REMAINING) else BEYOND


# ---------------------------------------------------------------- steel


def law_words(part: Mapping[str, Any]) -> str:
    """Return the wear law of a part with its parameters (SI), alike for parts that wear by the same one."""
    given = sorted((part.get("law_parameters") or {}).items())
    return ", ".join([part["law"], *(f"{name} {value!r}" for name, value in given)])


def steel_table(runs: Runs, lives: Lives) -> pd.DataFrame:
    """Return a row per setting and part: its material, wear coefficient and law, mass lost per hour as built and worn,
    per Mt, and until it is changed.
    """
    rows = []
    for (setting, part), life in lives.items():
        run, table = runs.first(setting), runs.parts
        blocks = table[(table["setting"] == setting) & (table["part"] == part)]
        density, row = run["parts"][part]["density_kg_per_m3"], {"setting": setting, "part": part}
        row |= {name: run["parts"][part][name] for name in ("material", "wear_coefficient_per_pa")}
        row["law"] = law_words(run["parts"][part])
        for phase in KEPT:
            found = over_packings(blocks[blocks["phase"] == phase], "worn_mass_kg_per_h")
            low, high = found.interval()
            row |= {f"{phase}_kg_per_h": found.value, f"{phase}_low_kg_per_h": low, f"{phase}_high_kg_per_h": high}
            row[f"{phase}_kg_per_Mt"] = found.value / mt_per_hour(run)
        lost = [float(course.at(life.life.value)[0]) for course in mass_courses(runs, setting, part)]
        row["until_change_kg"] = density * float(np.mean(lost)) if math.isfinite(life.life.value) else math.nan
        rows.append(row)
    return pd.DataFrame(rows)
