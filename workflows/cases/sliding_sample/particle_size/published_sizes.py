"""What the source tells of particle size in numbers (Yan 2022, chapter 4), beside what a study found."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.flow.packing import MEASURES, inner_means
from bulkwear.postproc.statistics.crossing import Crossing
from bulkwear.postproc.statistics.intervals import Ends, Estimate, estimates
from bulkwear.postproc.statistics.verdicts import AGREES, OTHER_SIZE, Claim, Verdict, judged
from bulkwear.workflows.cases.sliding_sample.particle_size.wear_by_scale import CONVEX, critical_scale_text
from bulkwear.workflows.config.claims import about

GRADIENT, VELOCITY = "relative_gradient", "relative_velocity_percent"
DIFFERENCE = "difference"  # dense minus loose
COLUMNS = [
    *("quantity", "surface", "scales", "relation", "value", "unit"),
    *("found", "verdict", "reason", "factor", "source"),
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
    published: pd.DataFrame, steady: pd.DataFrame, profiles: pd.DataFrame, critical: Crossing, ratio: float
) -> pd.DataFrame:
    """Return every published number with ours and a verdict: COLUMNS.

    published: as in config/published/particle_size_results.csv; steady: as from `steady_by_scale`
    profiles: of layers over the samples: run, surface, particle_scale, height_mm and velocity_m_per_s
    critical: our critical scale, of which the interval over forms counts
    ratio: -, alpha_ER of real particles; NaN of samples without bumps, whose critical scale is not that of the source

    A number is claimed of every scale from scale_from to scale_to: of each that was simulated there is an estimate over
    packings, see `claim_of`. One of them may contradict it; it agrees only where the scales simulated reach from end to
    end. Windows of travel are no measurement of ours and left out.
    """
    ours = _measures(steady, profiles)
    rows = []
    for each in published[published["quantity"] != "steady"].itertuples():
        if each.quantity in ("critical_scale", "critical_size_ratio"):
            factor = 1.0 if each.quantity == "critical_scale" else ratio
            found = {
                "": Ends(*(factor * end for end in (critical.value, critical.low, critical.high)), critical.packings)
            }
        else:
            table = ours[each.quantity]
            found = _by_scale(table[table["surface"] == each.surface], each, "value")
        rows.append(_row(each, each.surface, found))
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
        chosen = ours[(ours["case"] == each.case) & (ours["state"] == each.state)]
        rows.append(_row(each, f"{each.case}, {each.state}", _by_scale(chosen, each, each.quantity)))
    return pd.DataFrame(rows, columns=COLUMNS)


def _by_scale(table: pd.DataFrame, each: Any, column: str) -> dict[float, Estimate]:
    """Return the estimate over packings of every scale that a published number is of."""
    inside = table[table["particle_scale"].between(each.scale_from, each.scale_to)].dropna(subset=column)
    return dict(sorted(estimates(inside["particle_scale"], inside[column]).items()))


def _row(each: Any, surface: str, found: Mapping[Any, Estimate | Ends]) -> tuple:
    """Return a published number with what was found and the verdict, in the order of COLUMNS."""
    verdict = _judged(claim_of(each), found, (each.scale_from, each.scale_to))
    told = (each.quantity, surface, _scales(each), each.relation, each.value, each.unit)
    return (*told, verdict.found, verdict.verdict, verdict.reason, verdict.factor, each.source)


def _judged(claim: Claim, found: Mapping[Any, Estimate | Ends], scales: tuple[float, float]) -> Verdict:
    """Return the verdict on what is claimed of all scales between two; found: by scale, "" of what is of no scale."""
    verdict = judged(claim, found, _words(found))
    if verdict.verdict not in (AGREES, OTHER_SIZE) or "" in found:
        return verdict
    reach = replace(claim, reach=scales, reach_unit="times the particles")
    return judged(reach, found, _words(found), covers=(min(found), max(found)))


def claim_of(each: Any) -> Claim:
    """Return a published number as a claim: "about" with the margin ABOUT to both sides, "above" and "below" as sides.

    each: a row of a table of published numbers: quantity, relation, value, unit and source
    """
    if each.relation == "about":
        return about(each.quantity, each.value, each.value, each.unit, each.source)
    told = {"key": each.quantity, "finding": f"{each.relation} {each.value:g}", "source": each.source}
    return Claim(**told, quantity=each.quantity, unit=each.unit, direction=each.relation, reference=each.value)


def _words(found: Mapping[Any, Estimate | Ends]) -> str:
    """Return what was found: the estimate, or the range of the means over several scales."""
    if len(found) == 1:
        scale, one = next(iter(found.items()))
        said = f"no value{one.text().removeprefix('nan')}" if math.isnan(one.value) else one.text()
        return f"scale {scale:g}: {said}" if scale != "" else said
    values = [one.value for one in found.values()]
    scales = ", ".join(f"{scale:g}" for scale in found)
    return f"{min(values):.3g} to {max(values):.3g} at scales {scales}" if found else ""


def _scales(each: Any) -> str:
    """Return the scales that a published number is of."""
    return " to ".join(dict.fromkeys((f"{each.scale_from:g}", f"{each.scale_to:g}")))


def _measures(steady: pd.DataFrame, profiles: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Return surface, particle_scale and value of every published quantity."""
    found = {}
    for measure, one in steady.groupby("measure", sort=False):
        for column, ending in (("mean_percent", ""), ("deviation_percent", "_deviation")):
            found[f"{measure}{ending}"] = one[["surface", "particle_scale"]].assign(value=one[column])
    velocity = profiles.rename(columns={"velocity_m_per_s": "value"})
    fastest = velocity.groupby(["run", "surface", "particle_scale"], as_index=False)["value"].max()
    found["velocity_every_layer"] = fastest[["surface", "particle_scale", "value"]]
    lowest = velocity.loc[velocity.groupby("run")["height_mm"].idxmin()]
    found["velocity_lowest_layer"] = lowest[["surface", "particle_scale", "value"]]
    return found


def critical_sentences(critical: Crossing, published: float, ratios: pd.DataFrame, curve: str) -> list[str]:
    """Return what a study tells of the critical scale beside the published one, with the reasons for a difference.

    published: scale; ratios: as from `wear_by_scale.ratio_by_scale`; curve: name of the patterned sample
    """
    theirs = "" if curve == CONVEX else f", for a {CONVEX} sample,"
    said = [_side_words(ratios, curve)]
    said.append(f"{critical_scale_text(critical).capitalize()}; the source's{theirs} is about {published:g}.")
    if np.isfinite(critical.below) and np.isfinite(critical.above):
        said.append(
            "Whatever the form, the side changes between the scales"
            f" {critical.below:g} and {critical.above:g}, each told by its own packings."
        )
    outside = not critical.reason and not critical.low <= published <= critical.high
    if outside and curve == CONVEX:
        said.append(
            "What differs from the source, and a difference may come from: the size distribution, of which the source"
            " tells the median and the share below 2 mm in numbers; friction between particles; the rolling model and"
            " the time step, of which it does not say which its sliding samples had; how bumps are turned, which its"
            " text leaves open; and the ramp round the sample."
        )
    return said


def _side_words(ratios: pd.DataFrame, curve: str) -> str:
    """Return at which scales the intervals tell which sample wears more."""
    if ratios["interval_low"].isna().all():
        return f"No scale has an interval: which of {curve} and plain sample wears more is told of none."
    less, more = (
        _listed(ratios.loc[chosen, "particle_scale"])
        for chosen in (ratios["interval_high"] < 1.0, ratios["interval_low"] > 1.0)
    )
    return (
        f"By the intervals of its packings the {curve} sample wears less than the plain one at {less}, more at {more}."
    )


def _listed(scales: pd.Series) -> str:
    return f"scale {', '.join(f'{scale:g}' for scale in scales)}" if len(scales) else "no scale"
