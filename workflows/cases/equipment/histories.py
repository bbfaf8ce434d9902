"""What figures show over time and over hours of operation: the flow through a machine, the depth of deciding places."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from scipy.ndimage import gaussian_filter1d

from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.workflows.cases.equipment.life import WHOLE_PART, Course, patch_courses
from bulkwear.workflows.cases.equipment.tables import KG_PER_TONNE, SECONDS_PER_HOUR, Runs

WINDOW = 20  # rows of the table of the flow, over which a bell evens out single particles and batches of the feed
DEVIATIONS = 3.0  # of the bell in half of the window
WATTS_PER_KW = 1e3
HORIZON = 3.0  # -, over the hours asked for or simulated: lives beyond are not drawn
LONGEST_ROWS = 2000  # of a run in the table of the flow


def flow_series(runs: Runs) -> pd.DataFrame:
    """Return the flow of every run over simulated time: run, setting, packing, time_s, in_t_per_h, out_t_per_h,
    held_kg, power_<part>_kW, NaN where it is not known. All are evened out over a few reports.
    """
    return pd.concat([_series_of(table) for _, table in runs.flow.groupby("run", sort=False)], ignore_index=True)


def _series_of(flow: pd.DataFrame) -> pd.DataFrame:
    flow = flow.drop_duplicates("time_s")
    half = max(min(WINDOW, len(flow) - 1) // 2, 1)
    inside = slice(half, len(flow) - half) if len(flow) > 2 * half else slice(None)
    time = flow["time_s"].to_numpy()

    def bell(values: np.ndarray) -> np.ndarray:
        return gaussian_filter1d(values, half / DEVIATIONS, mode="nearest", truncate=DEVIATIONS)

    def smooth(column: str, since_start: bool = False) -> np.ndarray:
        values = flow[column].to_numpy(float)
        known = np.isfinite(values)
        sums = bell(np.where(known, values - values[0] if since_start else values, 0.0))
        if known.all():
            return sums
        return np.divide(sums, bell(known.astype(float)), out=np.full(len(values), np.nan), where=known)

    def rate(column: str) -> np.ndarray:
        counted = smooth(column, since_start=True)  # exactly none in a machine that is filled once
        return np.gradient(counted, time)[inside] * SECONDS_PER_HOUR / KG_PER_TONNE

    powers = [name for name in flow if name.startswith("power_")]
    table = {
        **{name: flow[name].iloc[0] for name in ("run", "setting", "packing")},
        "time_s": time[inside],
        "in_t_per_h": rate("inserted_mass_kg"),
        "out_t_per_h": rate("out_mass_kg"),
        "held_kg": smooth("held_mass_kg")[inside],
        **{f"{name.removesuffix('_W')}_kW": smooth(name)[inside] / WATTS_PER_KW for name in powers},
    }
    found = pd.DataFrame(table)
    return found.iloc[:: max(len(found) // LONGEST_ROWS, 1)]


def phase_spans(runs: Runs) -> pd.DataFrame:
    """Return when the first packing of each setting was in which phase: setting, phase, start_s, end_s."""
    rows = []
    for setting in runs.settings:
        flow = runs.flow[runs.flow["run"] == runs.first(setting)["run"]]
        ends, start = flow.groupby("phase", sort=False)["time_s"].max(), 0.0
        for phase, end in ends.items():
            rows.append({"setting": setting, "phase": phase, "start_s": start, "end_s": end})
            start = end
    return pd.DataFrame(rows)


def deciding_depths(runs: Runs, lives: pd.DataFrame, worst: pd.DataFrame) -> pd.DataFrame:
    """Return the depth of the deciding patch of every part against hours: setting, part, patch, packing, operation_h,
    depth_mm, simulated.

    lives: as from `life_tables.life_table`; worst: as from `life_tables.worst_places`, whose first place stands in
    where no patch decides. Packing 0 is the mean over packings, with what follows at the last rate until the part is
    changed.
    """
    tables = []
    for life in lives.itertuples():
        patch = life.patch
        if patch == WHOLE_PART:
            own = worst[(worst["setting"] == life.setting) & (worst["part"] == life.part) & (worst["rank"] == 1)]
            patch = int(own["patch"].iloc[0])
        places, courses = patch_courses(runs, life.setting, life.part)
        at = int(np.flatnonzero(places.index == patch)[0])
        for course in courses:
            tables.append(_depths(course.packing, course.hours, course.lost[:, at], True))
        last = min(course.hours[-1] for course in courses)
        hours = np.unique(np.append(courses[0].hours[courses[0].hours < last], last))
        tables.append(_depths(0, hours, _mean_at(courses, hours, at), True))
        asked = runs.first(life.setting)["operation"].get("duration_s", 0.0) / SECONDS_PER_HOUR
        end = min(life.life_h if np.isfinite(life.life_h) else np.inf, HORIZON * max(asked, last))
        if end > last:
            beyond = np.array([last, _hour_of(courses, at, life.allowed_mm, last, end)])
            tables.append(_depths(0, beyond, _mean_at(courses, beyond, at), False))
        count = len(courses) + 1 + (end > last)
        tables[-count:] = [each.assign(setting=life.setting, part=life.part, patch=patch) for each in tables[-count:]]
    columns = ["setting", "part", "patch", "packing", "operation_h", "depth_mm", "simulated"]
    return pd.concat(tables, ignore_index=True)[columns]


def _hour_of(courses: Sequence[Course], at: int, allowed_mm: float, last: float, end: float) -> float:
    """Return when the mean of a place reaches what it may lose, `end` where that is later or not known."""
    lost, then = MILLIMETRES * _mean_at(courses, np.array([last, end]), at)
    if not then > allowed_mm > lost:
        return end
    return last + (end - last) * (allowed_mm - lost) / (then - lost)


def _mean_at(courses: Sequence[Course], hours: np.ndarray, at: int) -> np.ndarray:
    """Return the mean over packings of what a place has lost after hours (k,), (k,) m."""
    return np.array([np.mean([course.at(hour)[at] for course in courses]) for hour in hours])


def _depths(packing: int, hours: np.ndarray, lost: np.ndarray, simulated: bool) -> pd.DataFrame:
    return pd.DataFrame(
        {"packing": packing, "operation_h": hours, "depth_mm": MILLIMETRES * lost, "simulated": simulated}
    )
