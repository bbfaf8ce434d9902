"""What the figures of equipment show, in one sentence each, from the tables beside them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from bulkwear.workflows.cases.equipment.findings import answers_on_lifters
from bulkwear.workflows.cases.equipment.life_findings import interval_words, rounded
from bulkwear.workflows.cases.equipment.phases import PRISTINE
from bulkwear.workflows.report.sentences import PERCENT, capital, listed, spoken

PLACE_DIGITS = 1  # after the point, of a place in mm: beyond is rounding
RATE, AREA = "pristine_mm_per_1000h", "area_mm2"
MOST_SAID = 4  # designs and parts that a sentence enumerates
LEAST_LOST = 0.01  # -, of the thickness as built: a place that has lost less counts as not worn
SHARE_AT_END = 0.25  # -, of the time that the flow is shown for: means over it tell what it came to


def shortened(said: Sequence[str], sizes: Sequence[float]) -> str:
    """Return sayings as an enumeration; of more than MOST_SAID those with the largest size and the smallest alone."""
    if len(said) <= MOST_SAID:
        return listed(said)
    order = np.argsort(-np.asarray(sizes, dtype=float), kind="stable")
    return f"{said[order[0]]} (the most of {len(said)}) and {said[order[-1]]} (the least)"


def who(table: pd.DataFrame, row: pd.Series) -> str:
    """Return the part of a row, with its design where a table has several."""
    several = table["setting"].nunique() > 1
    return f"the {spoken(str(row['part']))}{f' of {row.setting}' if several else ''}"


def _after(hours: float) -> str:
    return f"after {rounded(hours)} h" if hours > 0.0 else "as built"


# ---------------------------------------------------------------- life and wear


def shortest_life(lives: pd.DataFrame) -> str:
    """Return which part is changed first and which last; lives: as from `life_tables.life_table`."""
    known = lives[np.isfinite(lives["life_h"])].sort_values("life_h", kind="stable")
    if known.empty:
        return ""
    first, last = known.iloc[0], known.iloc[-1]
    said = f"First {who(lives, first)} is changed, after {rounded(first['life_h'])} h ({interval_words(first)})"
    return f"{said}." if len(known) == 1 else f"{said}; last {who(lives, last)}, after {rounded(last['life_h'])} h."


def depth_reached(depths: pd.DataFrame) -> str:
    """Return how deep the deciding place of each part is worn in the end of what was simulated.

    depths: as from `histories.deciding_depths`, in which packing 0 is the mean
    """
    means = depths[(depths["packing"] == 0) & depths["simulated"].astype(bool)]
    last = means.loc[means.groupby(["setting", "part"], sort=False)["operation_h"].idxmax()]
    if last["operation_h"].eq(0.0).all() and len(last):
        return "The shape is kept as built: lines go on at its rate."
    said = [
        f"{who(depths, row)} has lost {rounded(row['depth_mm'])} mm {_after(row['operation_h'])}"
        for _, row in last.iterrows()
    ]
    return f"At the deciding place {shortened(said, last['depth_mm'].tolist())}." if said else ""


def fastest_place(rates: pd.DataFrame) -> str:
    """Return where the recession as built is fastest, and how much faster than the part's mean.

    rates: patches with their area, place and rate, as from `tables.rates_table`
    """
    known = rates[rates[RATE] > 0.0]
    if known.empty:
        return "Nothing wears as built."
    worst = known.loc[known[RATE].idxmax()]
    own = rates[(rates["setting"] == worst["setting"]) & (rates["part"] == worst["part"])].dropna(subset=RATE)
    mean = float(np.average(own[RATE], weights=own[AREA]))
    place = ", ".join(rounded(round(worst[f"{axis}_mm"], PLACE_DIGITS), 3) for axis in "xyz")
    return (
        f"{capital(who(rates, worst))} wears fastest as built, by {rounded(worst[RATE])} mm per 1,000 h at ({place}) mm"
        f" of its drawing, {rounded(worst[RATE] / mean)} times the mean over its area."
    )


def thinnest_place(rows: pd.DataFrame) -> str:
    """Return what is left at the thinnest place that has lost some, at the last hours of each design; of all where none
    has.

    rows: as from `remaining.remaining_rows`
    """
    hours = rows.groupby("setting")["operation_h"]
    last, built = (rows[rows["operation_h"] == hours.transform(end)] for end in ("max", "min"))
    names = ["setting", "part", "patch"]
    before = last[names].merge(built, on=names, how="left")["least_remaining_mm"].to_numpy()
    worn = last[last["least_remaining_mm"].to_numpy() < (1.0 - LEAST_LOST) * before]
    least = (worn if len(worn) else last).loc[lambda table: table["least_remaining_mm"].idxmin()]
    how = "" if least["how"] == "simulated" else f" ({least['how']})"
    left, when = rounded(least["least_remaining_mm"]), _after(least["operation_h"])
    which = "worn place" if len(worn) else "place"
    return f"The thinnest {which} has {left} mm left {when}{how}; it is on {who(rows, least)}."


def impact_share(rows: pd.DataFrame) -> str:
    """Return the share of impacts in the power on each part as built, and where the pressure is highest.

    rows: patches with their area and loads
    """
    said, shares = [], []
    for _, own in rows.groupby(["setting", "part"], sort=False):
        powers = [float((own[f"{name}_power_W_per_m2"] * own[AREA]).sum()) for name in ("impact", "sliding")]
        if sum(powers) > 0.0:
            shares.append(powers[0] / sum(powers))
            said.append(f"{PERCENT * shares[-1]:.0f} % on {who(rows, own.iloc[0])}")
    most = rows["pressure_Pa"].max()
    start = f"Of the power of impacts and sliding, impacts have {shortened(said, shares)}; t" if said else "T"
    return f"{start}he highest mean pressure on a patch is {rounded(most)} Pa."


def deepest_section(lines: pd.DataFrame) -> str:
    """Return how much is removed at most in the section of each part; lines: as from `sections.worst_sections`."""
    depth = lines[["depth_1_mm", "depth_2_mm"]].max(axis=1)
    last = lines.assign(depth=depth)[lines["operation_h"] == lines.groupby("section")["operation_h"].transform("max")]
    said = [
        f"up to {rounded(own['depth'].max())} mm from {who(lines, own.iloc[0])} {_after(own['operation_h'].iloc[0])}"
        for _, own in last.groupby("section", sort=False)
    ]
    most = last.groupby("section", sort=False)["depth"].max()
    return f"In the sections wear has removed {shortened(said, most.tolist())}."


def lifters(table: pd.DataFrame) -> str:
    """Return how far the lifters of the first mill lean and stand out, as built and in the end."""
    return next(iter(answers_on_lifters(table)), "")


# ---------------------------------------------------------------- flow


def held_and_power(series: pd.DataFrame) -> str:
    """Return mass held, what goes out and the power of moving parts in the end, mean over packings.

    series: as from `histories.flow_series`
    """
    ends = series.groupby("run")["time_s"].transform("max")
    last = series[series["time_s"] >= (1.0 - SHARE_AT_END) * ends]
    said, several = [], series["setting"].nunique() > 1
    for setting, own in last.groupby("setting", sort=False):
        means = own.groupby("run").mean(numeric_only=True).mean()
        parts = [f"{rounded(means['held_kg'], 3)} kg are held"]
        if means["out_t_per_h"] > 0.0:
            parts.append(f"{rounded(means['out_t_per_h'], 3)} t/h go out")
        parts += [
            f"the {spoken(name.removeprefix('power_').removesuffix('_kW'))} gives {rounded(means[name], 3)} kW"
            for name in means.index
            if name.startswith("power_") and abs(means[name]) > 0.0
        ]
        said.append(f"{f'of {setting} ' if several else ''}{listed(parts)}")
    return f"In the last quarter of the time {'; '.join(said)}."


def speeds(column: str, words: str):
    """Return the finding of panels of the flow: mean and largest of a speed (m/s) by phase."""

    def finding(panels: pd.DataFrame) -> str:
        said, means, several = [], [], panels["setting"].nunique() > 1
        for (setting, phase), own in panels.groupby(["setting", "phase"], sort=False):
            named = f"{setting}, {phase}" if several else str(phase)
            mean, most = (rounded(value) for value in (own[column].mean(), own[column].max()))
            said.append(f"{named} {mean} m/s, at most {most} m/s")
            means.append(own[column].mean())
        return f"{words}: {'; '.join(said) if len(said) <= MOST_SAID else shortened(said, means)}."

    return finding


def charge(rows: pd.DataFrame) -> str:
    """Return shoulder and toe by design and phase, mean over packings and range; rows: `flow_panels.charge_rows`."""
    said, several = [], rows["setting"].nunique() > 1
    for (setting, phase), own in rows.groupby(["setting", "phase"], sort=False):
        shape = "as built" if phase == PRISTINE else "as worn"
        named = f"{setting}, {shape}" if several else shape
        shoulder, toe = (_over_packings(own[f"{which}_deg"]) for which in ("shoulder", "toe"))
        said.append(f"{named} {shoulder} and {toe} degrees")
    return f"Shoulder and toe lie at: {'; '.join(said)}."


def _over_packings(angles: pd.Series) -> str:
    """Return the mean of an angle, with the range over packings where these differ."""
    mean, low, high = (rounded(value, 3) for value in (angles.mean(), angles.min(), angles.max()))
    return mean if low == high else f"{mean} ({low} to {high} in {len(angles)} packings)"
