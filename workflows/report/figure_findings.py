"""What figures show, in one sentence each, from the tables beside them: alternative texts, first lines of captions."""

from __future__ import annotations

import pandas as pd

from bulkwear.postproc.tables.depths import area_quantile, depth_summary
from bulkwear.postproc.tables.packings import PACKING, SETTING, first_packings
from bulkwear.postproc.wear.laws import NEUTRAL_LAW
from bulkwear.workflows.report.sentences import PERCENT, capital, listed, measured, spoken
from bulkwear.workflows.report.text import range_text

HALF, MOST_WORN = 0.5, 0.99  # -, of an area
MOST_NAMED = 4  # samples of which a sentence tells
LAWS_AGREE = 1.5  # -, largest over smallest ratio of two settings by laws that are said to agree
UNIT = "µm"


def deepest_run(depths: pd.DataFrame) -> str:
    """Return which run that is drawn wears deepest, and how deep the most worn hundredth of each run's area is.

    depths: as from `tables.depths.depth_table`; with the packing of each run the first ones alone are drawn
    """
    found = depth_summary(_first(depths)).sort_values("depth_of_99_percent_um", ascending=False, kind="stable")
    first, last = found.iloc[0], found.iloc[-1]
    if not first["depth_of_99_percent_um"] > 0.0:
        return "No wear is on these surfaces: less than a hundredth of the area of each is worn."
    said = f"{first['run']} wears deepest: a hundredth of its area by {measured(first['depth_of_99_percent_um'], 'µm')}"
    if len(found) == 1:
        return f"{said} or more."
    return f"{said} or more, of {last['run']} by {measured(last['depth_of_99_percent_um'], 'µm')}."


def _first(table: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of what figures draw of several packings: the first ones."""
    return first_packings(table) if {SETTING, PACKING} <= set(table) else table


def depth_of_half(shares: pd.DataFrame) -> str:
    """Return up to which depth half of the area of each sample that is drawn is worn, of many the least and the most.

    shares: run, depth_um, area_share_percent; with setting and packing of each run the first ones alone are drawn
    """
    deeper = _first(shares)
    runs = list(dict.fromkeys(deeper["run"]))
    deeper = deeper[deeper["area_share_percent"] >= PERCENT * HALF].groupby("run")["depth_um"].max()
    deeper = deeper.reindex(runs)
    if deeper.isna().all() and len(deeper) > 1:
        return "Half or more of the area of every sample is worn hardly or not at all."
    few = len(deeper) <= MOST_NAMED
    shown = deeper if few else deeper.sort_values(kind="stable", na_position="first").iloc[[0, -1]]
    said = [
        f"half of {run} is worn {'hardly or not at all' if pd.isna(depth) else f'deeper than {measured(depth, UNIT)}'}"
        for run, depth in shown.items()
    ]
    return f"{capital('; '.join(said))}." if few else f"Least deep, {'; most, '.join(said)}."


def total_wear(history: pd.DataFrame) -> str:
    """Return how much each surface has lost in the end, mean over all runs. history: one row per run and cycle."""
    last = history.groupby("run", sort=False).last()
    means = last.groupby("surface", sort=False)[["worn_volume_mm3", "travel_mm"]].mean()
    worn = ", ".join(
        f"{surface} samples {measured(row['worn_volume_mm3'], 'mm³')}" for surface, row in means.iterrows()
    )
    return f"After {measured(means['travel_mm'].max(), 'mm')} of travel {worn} are worn, on average."


def largest_step(updates: pd.DataFrame) -> str:
    """Return whether steps reached their caps, and how much wear waits at most. updates: of `tables.updates`."""
    capped = updates[updates["step_taken"] >= 1.0]
    if capped.empty:
        return "No update reaches a cap on its step: all wear is applied at once."
    share = _share_of(len(capped), len(updates))
    return f"In {share} of the updates a cap on a step is reached, and wear is carried on to the next."


def _share_of(count: int, whole: int) -> str:
    """Return a count over the whole in %; neither nothing nor all where it is not."""
    percent = PERCENT * count / whole
    if 0 < count < whole and not 1.0 <= percent <= PERCENT - 1.0:
        return "less than 1 %" if percent < 1.0 else f"more than {PERCENT - 1.0:.0f} %"
    return f"{percent:.0f} %"


def laws_apart(laws: pd.DataFrame) -> str:
    """Return where which law differs most from Archard's in place. laws: as from `laws_of_settings`."""
    others = laws[(laws["law"] != NEUTRAL_LAW) & laws["overlap"].notna()]
    if others.empty:
        return ""
    least = others.loc[others["overlap"].idxmin()]
    at = " ".join(str(least[name]) for name in ("setting", "surface", "part") if _is_word(least.get(name)))
    share = f"{PERCENT * least['overlap']:.0f} %"
    return f"By {spoken(least['law'])} {share} of the wear lies where Archard's does, at {at}, the least of all."


def _is_word(value: object) -> bool:
    return isinstance(value, str) and bool(value)


def laws_on_designs(laws: pd.DataFrame) -> str:
    """Return of which part and setting laws disagree most on how its wear compares with that of the first setting; ""
    of one setting, and where laws agree within LAWS_AGREE. laws: as from `laws_of_settings`, of machines
    """
    known = laws[laws["over_first"].notna()]
    if known.empty or "part" not in known:
        return ""
    ends = known.groupby(["part", "setting"], sort=False)["over_first"].agg(["min", "max"])
    apart = ends["max"] / ends["min"]
    if not apart.max() > LAWS_AGREE:
        return ""
    part, setting = apart.idxmax()
    rows = known[(known["part"] == part) & (known["setting"] == setting)].sort_values("over_first")
    said = [f"{_with_ends(row)} by {spoken(row['law'])}" for _, row in rows.iterrows()]
    first = laws["setting"].iloc[0]
    return f"Laws disagree most on the {spoken(part)} of {setting}: over that of {first} it wears {listed(said)}."


def _with_ends(row: pd.Series) -> str:
    if pd.isna(row["over_first_low"]):
        return f"{row['over_first']:.3g}"
    return f"{row['over_first']:.3g} ({row['over_first_low']:.3g} to {row['over_first_high']:.3g})"


def steepest_map(maps: pd.DataFrame) -> str:
    """Return by which law wear is most uneven. maps: law, relative_depth, area_mm2 of every face."""
    tops = {
        law: area_quantile(faces["relative_depth"].to_numpy(), faces["area_mm2"].to_numpy(), MOST_WORN)
        for law, faces in maps.groupby("law", sort=False)
    }
    if not any(tops.values()):
        return f"Less than {PERCENT * (1.0 - MOST_WORN):.0f} % of the area wears."
    said = listed([f"{top:.2g} by {spoken(law)}" for law, top in tops.items()])
    return f"The most worn hundredth of the area is worn by this many times the mean or more: {said}."


def pattern_in_film(frames: pd.DataFrame) -> str:
    """Return what is left of a filmed pattern in the end, or how deep a plain sample is worn."""
    last = frames.iloc[-1]
    if pd.isna(last["bumps_left_percent"]):
        return f"{last['run']} is worn by up to {measured(last['largest_depth_um'], 'µm')} in the end."
    return f"{last['run']} keeps {last['bumps_left_percent']:.4g} % of its pattern."


def share_of_pattern(split: pd.DataFrame) -> str:
    """Return how much of the wear of patterned samples is on their pattern, "" where none has a plain twin that it is
    told over. split: a row per setting and surface
    """
    known = split.dropna(subset="pattern_over_plain")
    if known.empty:
        return ""
    patterned = known[known["pattern_over_plain"] > 0.0]
    if patterned.empty:
        return "No sample has a pattern that wears."
    shares = PERCENT * patterned["pattern_over_plain"] / patterned["wear_over_plain"]
    low, high = shares.min(), shares.max()
    ends = f"{low:.0f} %" if f"{low:.0f}" == f"{high:.0f}" else f"{low:.0f} to {high:.0f} %"
    return f"Of the wear of patterned samples {ends} is on the pattern."


def mean_forces(table: pd.DataFrame) -> str:
    """Return the mean vertical and drag force on each surface. table: along the travel, or its means by direction."""
    if "direction" in table:
        means = table.pivot_table(index="surface", columns="direction", values="mean_force_N", sort=False)
    else:
        columns = {f"{name}_force_N": name for name in ("vertical", "drag")}
        means = table.groupby("surface", sort=False)[list(columns)].mean().rename(columns=columns)
    said = [
        f"{surface} samples with " + " and ".join(f"{measured(row[name], 'N')} ({name})" for name in means)
        for surface, row in means.iterrows()
    ]
    return f"On average the bed loads {', '.join(said)}."


def finnie_over_law(table: pd.DataFrame) -> str:
    """Return Finnie's volume over the study's law by surface. table: a row per setting and surface, with the ratio."""
    said = [
        f"{range_text([PERCENT * each for each in rows['finnie_over_archard']])} % on {surface} samples"
        for surface, rows in table.groupby("surface", sort=False)
    ]
    return f"The solver's Finnie volume is, of that by the study's law, {listed(said)}."


def particle_speeds(particles: pd.DataFrame) -> str:
    """Return the mean speed of the particles shown over each sample. particles: of a snapshot, with their run."""
    return f"The particles shown pass the sample at {_means(particles, 'speed_m_per_s', 'm/s')}, on average."


def particle_spins(particles: pd.DataFrame) -> str:
    """Return the mean angular speed of the particles shown over each sample, each once. particles: of all views."""
    shown = particles.drop_duplicates(["run", "id"])
    return f"The particles shown turn at {_means(shown, 'angular_speed_deg_per_s', '°/s')}, on average."


def _means(particles: pd.DataFrame, column: str, unit: str) -> str:
    means = particles.groupby("run", sort=False)[column].mean()
    return listed([f"{measured(value, unit)} over {run}" for run, value in means.items()])
