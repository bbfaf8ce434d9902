"""What the source tells of particle size in numbers (Yan 2022, chapter 4), beside what a study found."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.flow.packing import MEASURES, inner_means
from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.lines import Crossing
from bulkwear.workflows.cases.sliding_sample.particle_size.wear_by_scale import CONVEX, patterned_curve

AGREES, DIFFERS, UNSAID = "agrees", "differs", "cannot be said"
# -, of a value told as "about": what is read off a figure's axis and told in whole tens of per cent
ABOUT = 0.15
GRADIENT, VELOCITY = "relative_gradient", "relative_velocity_percent"
DIFFERENCE = "difference"  # dense minus loose
COLUMNS = [
    *("quantity", "surface", "scales", "relation", "value", "unit"),
    *("low", "high", "of_scales", "verdict", "source"),
]


def steady_by_scale(steady: pd.DataFrame, scales: Mapping[str, float]) -> pd.DataFrame:
    """Return mean and deviation in the steady window of every run and measure (Yan 2022, Fig 4.13), in %.

    steady: as from `steady_table.steady_table`; scales: particle scale by run. Columns run, row, surface,
    particle_scale, measure (relative_velocity, relative_wear_rate), mean_percent, deviation_percent, start_mm, end_mm,
    drift_percent, steady; relative_wear_rate is over the largest of all runs (Yan 2022, Eq 4.12).
    """
    names = {VELOCITY: ("relative_velocity", 1.0), GRADIENT: ("relative_wear_rate", 100.0)}
    percent = steady["measure"].map({name: factor for name, (_, factor) in names.items()})
    return pd.DataFrame(
        {
            **{name: steady[name] for name in ("run", "row", "surface")},
            "particle_scale": steady["run"].map(scales),
            "measure": steady["measure"].map({name: shown for name, (shown, _) in names.items()}),
            "mean_percent": steady["mean"] * percent,
            "deviation_percent": steady["deviation"] * percent,
            **{name: steady[name] for name in ("start_mm", "end_mm")},
            "drift_percent": 100.0 * steady["drift"],
            "steady": steady["steady"],
        }
    )


def beside_the_source(
    published: pd.DataFrame, steady: pd.DataFrame, profiles: pd.DataFrame, critical: Crossing | None, ratio: float
) -> pd.DataFrame:
    """Return every published number with ours: COLUMNS; low to high is the range of ours over the scales in question.

    published: as in config/published/particle_size_results.csv; steady: as from `steady_by_scale`
    profiles: of layers over the samples: surface, particle_scale, height_mm and velocity_m_per_s
    critical: our critical scale, with its interval as low and high, or None
    ratio: -, alpha_ER of real particles; NaN of samples without bumps, whose critical scale is not that of the source

    A number "about" agrees if our range reaches to within ABOUT of it; a bound if our whole range keeps it. Where no
    scale in question was simulated, nothing can be said. Windows of travel are no measurement of ours and left out.
    """
    ours = _measures(steady, profiles)
    rows = []
    for each in published[published["quantity"] != "steady"].itertuples():
        if each.quantity in ("critical_scale", "critical_size_ratio"):
            factor = 1.0 if each.quantity == "critical_scale" else ratio
            bounded = critical is not None and critical.bounded and np.isfinite(ratio)
            low, high = (factor * critical.low, factor * critical.high) if bounded else (np.nan, np.nan)
            of = ""
        else:
            table = ours[each.quantity]
            inside = table["particle_scale"].between(each.scale_from, each.scale_to)
            found = table[inside & (table["surface"] == each.surface)].dropna(subset="value")
            low, high = (found["value"].min(), found["value"].max()) if len(found) else (np.nan, np.nan)
            of = ", ".join(f"{scale:g}" for scale in sorted(set(found["particle_scale"])))
        told = (each.quantity, each.surface, _scales(each), each.relation, each.value, each.unit)
        rows.append((*told, low, high, of, verdict(each.relation, each.value, low, high), each.source))
    return pd.DataFrame(rows, columns=COLUMNS)


def packing_beside_the_source(published: pd.DataFrame, container: pd.DataFrame, bed: pd.DataFrame) -> pd.DataFrame:
    """Return every published number of packings with ours, columns as of `beside_the_source`; surface is the packing.

    published: as in config/published/packing.csv; container: profiles of all scales, state, particle_scale and those of
    `packing.packing_profile`, of which the means without the lowest and the highest slab count (Yan 2022, section
    4.3.1); bed: as from `bed_packing_table` of a study
    """
    means = [
        {"case": "container", "state": state, "particle_scale": scale, **inner_means(one.sort_values("layer"))}
        for (state, scale), one in container.groupby(["state", "particle_scale"])
        if state != DIFFERENCE
    ]
    table = pd.DataFrame(means).set_index(["state", "particle_scale"])
    change = (table.loc["dense", list(MEASURES)] - table.loc["loose", list(MEASURES)]).reset_index()
    parts = [table.reset_index(), change.assign(case="container", state=DIFFERENCE), bed.assign(case="bed")]
    ours = pd.concat(parts, ignore_index=True)
    rows = []
    for each in published.itertuples():
        chosen = (ours["case"] == each.case) & (ours["state"] == each.state)
        found = ours[chosen & ours["particle_scale"].between(each.scale_from, each.scale_to)]
        low, high = (found[each.quantity].min(), found[each.quantity].max()) if len(found) else (np.nan, np.nan)
        of = ", ".join(f"{scale:g}" for scale in sorted(set(found["particle_scale"])))
        told = (each.quantity, f"{each.case}, {each.state}", _scales(each), each.relation, each.value, each.unit)
        rows.append((*told, low, high, of, verdict(each.relation, each.value, low, high), each.source))
    return pd.DataFrame(rows, columns=COLUMNS)


def _scales(each: Any) -> str:
    """Return the scales that a published number is of."""
    return " to ".join(dict.fromkeys((f"{each.scale_from:g}", f"{each.scale_to:g}")))


def verdict(relation: str, value: float, low: float, high: float) -> str:
    """Return whether a range from low to high agrees with a published value; UNSAID where there is none (NaN)."""
    if not (np.isfinite(low) or np.isfinite(high)):
        return UNSAID
    agrees: dict[str, Callable[[], bool]] = {
        "about": lambda: low <= value * (1.0 + ABOUT) and high >= value * (1.0 - ABOUT),
        "above": lambda: low >= value,
        "below": lambda: high <= value,
    }
    return AGREES if agrees[relation]() else DIFFERS


def _measures(steady: pd.DataFrame, profiles: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Return surface, particle_scale and value of every published quantity."""
    found = {}
    for measure, one in steady.groupby("measure", sort=False):
        for column, ending in (("mean_percent", ""), ("deviation_percent", "_deviation")):
            found[f"{measure}{ending}"] = one[["surface", "particle_scale"]].assign(value=one[column])
    velocity = profiles.rename(columns={"velocity_m_per_s": "value"})
    found["velocity_every_layer"] = velocity[["surface", "particle_scale", "value"]]
    lowest = velocity.loc[velocity.groupby(["surface", "particle_scale"])["height_mm"].idxmin()]
    found["velocity_lowest_layer"] = lowest[["surface", "particle_scale", "value"]]
    return found


def critical_sentences(critical: Crossing | None, published: float, wear: pd.DataFrame, unsteady: int) -> list[str]:
    """Return what a study tells of the critical scale beside the published one, with the reasons for a difference.

    published: scale; wear: as from `wear_by_scale.wear_by_scale`; unsteady: runs whose flow or wear is not steady
    """
    scales = sorted(set(wear["particle_scale"]))
    table = wear.pivot(index="row", columns="curve", values="relative_wear")
    name = patterned_curve(wear)
    theirs = "" if name == CONVEX else f", for a {CONVEX} sample,"
    over = table[name] / table[PLAIN]
    less, more = (list(over.index[chosen]) for chosen in (over < 1.0, over >= 1.0))
    said = [f"The {name} sample wears less than the plain one in {_listed(less)}, and not less in {_listed(more)}."]
    if critical is None or not critical.bounded:
        crossing = "" if critical is None else f", whose straight lines cross at {critical.value:.2g},"
        few = f"{len(table)} rows{crossing} do not bound a critical scale; the source's{theirs} is about {published:g}."
        return [*said, few]
    interval = f"{critical.value:.2g} (95 % interval {critical.low:.2g} to {critical.high:.2g})"
    inside = critical.low <= published <= critical.high
    word = "holds" if inside else "does not hold"
    said.append(f"Critical scale: {interval}, which {word} the source's{theirs} of about {published:g}.")
    if scales[0] > critical.value or scales[-1] < critical.value:
        said.append(
            f"It lies outside the scales simulated ({scales[0]:g} to {scales[-1]:g}): the line is extended to it."
        )
    if not inside and name == CONVEX:
        said.append(
            "What differs from the source, and a difference may come from: the size distribution, of which the source"
            " gives the median only; how bumps are turned and rows staggered, which its text leaves open; the ramp"
            " round the sample; and one packing per scale, so that the interval knows the scatter about the line only."
        )
    if unsteady:
        said.append(f"In {unsteady} of the windows behind it flow or wear is not steady by the study's own criterion.")
    return said


def _listed(rows: list[str]) -> str:
    return ", ".join(rows) if rows else "none of the rows"
