"""Each finding of the source put to the test, see `findings`; the keys are those of config/published."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.verdicts import CONFIRMED, REFUTED, UNSAID, Verdict
from bulkwear.workflows.cases.sliding_sample.evaluation import CONTINUOUS, DISCONTINUOUS, MEASURES, RIDES_ALONG
from bulkwear.workflows.cases.sliding_sample.screening.findings import (
    CENTRAL,
    PERCENT,
    SIDE,
    Evidence,
    coefficient,
    main_effects,
    percent,
    ratios,
    side_of_one,
    unsteady,
)

NO_TWIN = "no row has a plain twin with a result"
EXCEPTION, BEST, BEST_DISCONTINUOUS = "R12", "R5", "R2"
NEAR = 10.0  # %, of the plain twin's wear, within which a relative wear counts as the published one
TWICE = 2.0
ALIKE = 1.25  # -, ratio up to which two angular speeds count as hardly different
TAKEN_ALONG, LEFT_BEHIND = 0.5, 0.1  # -, of the sample's velocity: half of it, and a tenth
SIGNIFICANT = 0.05  # p value (Yan 2022, section 3.5.4)

Test = Callable[[Evidence], Verdict]


def findings_table(evidence: Evidence, published: pd.DataFrame, regimes: pd.DataFrame) -> pd.DataFrame:
    """Return key, finding, source, found, verdict and reason (or reserve) of every published finding.

    published: key, finding and source; regimes: row and regime as the source tells them
    """
    tests: Mapping[str, Test] = {
        **TESTS,
        "continuous_runs": lambda each: _told_regime(each, regimes, CONTINUOUS),
        "discontinuous_runs": lambda each: _told_regime(each, regimes, DISCONTINUOUS),
    }
    verdicts = [_with_reserve(tests[key](evidence), evidence) for key in published["key"]]
    return published.assign(
        found=[each.found for each in verdicts],
        verdict=[each.verdict for each in verdicts],
        reason=[each.reason for each in verdicts],
    )


def _with_reserve(verdict: Verdict, evidence: Evidence) -> Verdict:
    """Return a verdict with the reserve that the flow is not steady, where it gives one nevertheless."""
    if verdict.verdict == UNSAID or not (reserve := unsteady(evidence, evidence.rows)):
        return verdict
    return replace(verdict, reason=reserve.partition(";")[0])


def _verdict(found: str, holds: bool, reason: str = "") -> Verdict:
    """Return whether a finding holds; with a reason it cannot be said."""
    return Verdict(found, UNSAID, reason) if reason else Verdict(found, CONFIRMED if holds else REFUTED)


def _missing(evidence: Evidence, row: str) -> str:
    return "" if row in evidence.rows.index else f"{row} has no result"


def _none_of(regime: str) -> Verdict:
    return Verdict("", UNSAID, f"no run is found to flow in the {regime} regime")


# ---------------------------------------------------------------- flow


def _told_regime(evidence: Evidence, told: pd.DataFrame, regime: str) -> Verdict:
    rows = evidence.rows[evidence.rows.index.isin(told.loc[told["regime"] == regime, "row"])]
    if rows.empty:
        return Verdict("", UNSAID, "none of these rows has a result")
    as_told = int((rows["regime"] == regime).sum())
    found = f"{as_told} of {len(rows)}; relative velocity {percent(rows['relative_velocity'])}"
    return _verdict(found, as_told == len(rows), unsteady(evidence, rows))


def _continuous_range(evidence: Evidence) -> Verdict:
    rows = evidence.continuous
    if rows.empty:
        return _none_of(CONTINUOUS)
    low, high = (evidence.published["relative_velocity", CONTINUOUS, end] for end in ("from", "to"))
    inside = (PERCENT * rows["relative_velocity"]).between(low, high)
    found = f"{inside.sum()} of {len(rows)} inside; outside {percent(rows['relative_velocity'][~inside]) or 'none'}"
    return _verdict(found, bool(inside.all()), unsteady(evidence, rows))


def _discontinuous_range(evidence: Evidence) -> Verdict:
    rows = evidence.rows[evidence.rows["regime"] == DISCONTINUOUS]
    if rows.empty:
        return _none_of(DISCONTINUOUS)
    share = rows["relative_velocity"]
    return _verdict(percent(share), bool((share >= RIDES_ALONG).all()), unsteady(evidence, rows))


def _steady(evidence: Evidence) -> Verdict:
    start, end = evidence.published["relative_velocity_steady", "all", "from"], evidence.travel_end
    both = evidence.steady.groupby("run")["steady"].all()
    flow = evidence.steady[evidence.steady["measure"] == MEASURES[0]]
    share = PERCENT * (flow["deviation"] / flow["mean"]).max()
    found = (
        f"flow and wear steady in {both.sum()} of {len(both)} runs; relative velocity scatters by up to {share:.0f} %"
    )
    short = f"the travel ends after {end:g} mm, the source tells from {start:g} mm on" if end <= start else ""
    within = share < evidence.published["relative_velocity_fluctuation", "all", "below"]
    return _verdict(found if np.isfinite(share) else "", bool(both.all() and within), short)


def _gradient(evidence: Evidence) -> Verdict:
    patterned = evidence.gradients[evidence.gradients["surface"] != PLAIN]
    means = patterned.groupby("regime")["relative_gradient"].mean()
    found = ", ".join(f"{regime} {value:.2f}" for regime, value in means.items())
    if not {CONTINUOUS, DISCONTINUOUS} <= set(means.index):
        return Verdict(f"mean {found}", UNSAID, "the runs are not of both regimes")
    holds = means[CONTINUOUS] > means[DISCONTINUOUS]
    return _verdict(f"mean {found}", bool(holds), unsteady(evidence, evidence.rows))


# ---------------------------------------------------------------- wear and force


def _convex_wears_less(evidence: Evidence) -> Verdict:
    flowing = evidence.continuous.drop(index=EXCEPTION, errors="ignore")
    if flowing.empty:
        return _none_of(CONTINUOUS)
    rows = flowing.dropna(subset=["wear_over_plain"])
    if rows.empty:
        return Verdict("", UNSAID, NO_TWIN)
    sides = rows.apply(side_of_one, axis=1)
    more, open_ = rows["wear_over_plain"][sides > 0], rows["wear_over_plain"][sides == 0]
    found = f"{(sides < 0).sum()} of {len(rows)} wear less; more: {ratios(more) or 'none'}"
    doubt = f"too near to 1 to say: {ratios(open_)}" if len(open_) and more.empty else ""
    return _verdict(found, more.empty, doubt)


def _exception(evidence: Evidence) -> Verdict:
    if reason := _missing(evidence, EXCEPTION):
        return Verdict("", UNSAID, reason)
    row = evidence.rows.loc[EXCEPTION]
    if np.isnan(row["wear_over_plain"]):
        return Verdict("", UNSAID, f"{EXCEPTION} has no plain twin with a result")
    side = side_of_one(row)
    near = "" if side else "too near to 1 to say with the replicates there are"
    return _verdict(f"wear over plain {row['wear_over_plain']:.2f}", side > 0, near)


def _best(evidence: Evidence) -> Verdict:
    if reason := _missing(evidence, BEST):
        return Verdict("", UNSAID, reason)
    wear = evidence.continuous["wear_over_plain"].dropna()
    if BEST not in wear.index:
        return Verdict("", UNSAID, "R5 is not found to flow continuously, or has no plain twin with a result")
    ours, lowest = wear[BEST], wear.idxmin()
    found = f"R5 {PERCENT * (ours - 1.0):+.0f} %; lowest {lowest} {PERCENT * (wear.min() - 1.0):+.0f} %"
    away = abs(PERCENT * ours - evidence.published["wear_over_plain", BEST, "about"])
    return _verdict(found, lowest == BEST and away <= NEAR)


def _best_discontinuous(evidence: Evidence) -> Verdict:
    wear = evidence.rows.loc[evidence.rows["regime"] == DISCONTINUOUS, "wear_over_plain"].dropna()
    if BEST_DISCONTINUOUS not in wear.index:
        return Verdict("", UNSAID, "R2 is not found to flow discontinuously, or has no result beside a plain twin")
    return _verdict(f"lowest {ratios(wear.nsmallest(1))}", wear.idxmin() == BEST_DISCONTINUOUS)


def _base(evidence: Evidence) -> Verdict:
    rows = evidence.continuous.dropna(subset=["base_share", "bump_share"])
    if EXCEPTION not in rows.index:
        return Verdict("", UNSAID, "R12 is not found to flow continuously, or has no result")
    more = rows["base_share"] > rows["bump_share"]
    others = more.drop(index=EXCEPTION)
    found = f"base above bumps in {others.sum()} of {len(others)}; share of the base on R12"
    found += f" {PERCENT * rows.loc[EXCEPTION, 'base_share']:.0f} %"
    return _verdict(found, bool(others.all() and not more[EXCEPTION]))


def _force(evidence: Evidence) -> Verdict:
    force = evidence.rows["force_over_plain"].dropna()
    if force.empty:
        return Verdict("", UNSAID, NO_TWIN)
    found = f"higher in {(force > 1.0).sum()} of {len(force)}; convex over plain {force.min():.2f} to {force.max():.2f}"
    return _verdict(found, bool((force > 1.0).all()))


def _force_and_wear(evidence: Evidence) -> Verdict:
    rows = evidence.rows.dropna(subset=["force_over_plain", "wear_over_plain"]).drop(index=EXCEPTION, errors="ignore")
    if rows.empty:
        return Verdict("", UNSAID, NO_TWIN)
    less = rows.apply(side_of_one, axis=1)
    both = (rows["force_over_plain"] > 1.0) & (less < 0)
    against = (rows["force_over_plain"] <= 1.0) | (less > 0)
    found = f"{both.sum()} of {len(rows)}; not {ratios(rows['wear_over_plain'][against]) or 'any'} (wear over plain)"
    open_ = rows["wear_over_plain"][~both & ~against]
    doubt = f"too near to 1 to say: {ratios(open_)}" if len(open_) and not against.any() else ""
    return _verdict(found, not against.any(), doubt)


# ---------------------------------------------------------------- motion of the particles


def _rolling(evidence: Evidence) -> Verdict:
    if reason := _missing(evidence, BEST):
        return Verdict("", UNSAID, reason)
    spin = evidence.rows["spin_over_plain"].dropna()
    if BEST not in spin.index:
        return Verdict("", UNSAID, "too few particles next to R5 or its twin")
    found = f"R5 {spin[BEST]:.1f} times; all rows {spin.min():.1f} to {spin.max():.1f}"
    return _verdict(found, spin[BEST] > TWICE)


def _rolling_falls(evidence: Evidence) -> Verdict:
    if reason := _missing(evidence, BEST):
        return Verdict("", UNSAID, reason)
    profile = evidence.profiles
    shown = profile[(profile["row"] == BEST) & (profile["surface"] != PLAIN)]
    mean = (
        shown.groupby(["zone", "layer"])["averaged_angular_velocity_deg_per_s"].mean().dropna()
    )  # replicates are one row
    if not {CENTRAL, SIDE} <= set(mean.index.get_level_values("zone")):
        return Verdict("", UNSAID, "R5 has no profile")
    over, beside = mean[CENTRAL], mean[SIDE]
    both = over.index.intersection(beside.index)
    if len(over) < 2 or both.empty:
        return Verdict("", UNSAID, "R5 has too few layers to compare")
    falls = bool((over.diff().dropna() < 0.0).all())
    found = f"layers from below, over {_numbers(over)}, beside {_numbers(beside)} °/s"
    return _verdict(found, falls and bool((over[both] > beside[both]).all()))


def _rolling_discontinuous(evidence: Evidence) -> Verdict:
    if reason := _missing(evidence, BEST_DISCONTINUOUS):
        return Verdict("", UNSAID, reason)
    row = evidence.rows.loc[BEST_DISCONTINUOUS]
    if np.isnan(row["spin_over_plain"]):
        return Verdict("", UNSAID, "too few particles next to R2 or its twin")
    found = f"bottom layer {row['spin_over_plain']:.1f} times the plain twin's"
    other = "" if row["regime"] == DISCONTINUOUS else "R2 is not found to flow discontinuously"
    return _verdict(found, 1.0 / ALIKE <= row["spin_over_plain"] <= ALIKE, other)


def _taken_along(evidence: Evidence) -> Verdict:
    if reason := _missing(evidence, BEST):
        return Verdict("", UNSAID, reason)
    patterned, plain = evidence.rows.loc[BEST, ["velocity_share", "plain_velocity_share"]].astype(float)
    if np.isnan(patterned) or np.isnan(plain):
        return Verdict("", UNSAID, "too few particles next to R5 or its twin")
    shares = f"{PERCENT * patterned:.0f} % of the sample's velocity, over the plain twin {PERCENT * plain:.0f} %"
    found = f"bottom layer at {shares}"
    return _verdict(found, patterned >= TAKEN_ALONG and plain <= LEFT_BEHIND)


def _numbers(values: pd.Series) -> str:
    return ", ".join(f"{value:.0f}" for value in values)


# ---------------------------------------------------------------- regression


def _no_regression(evidence: Evidence) -> str:
    return "" if evidence.terms is not None else "the study has no regression on the source's factors"


def _chance(evidence: Evidence) -> str:
    if evidence.model_p <= SIGNIFICANT:
        return ""
    return f"a model as good comes by chance in {PERCENT * evidence.model_p:.0f} % of permutations"


def _strongest(evidence: Evidence) -> Verdict:
    if reason := _no_regression(evidence):
        return Verdict("", UNSAID, reason)
    mains = main_effects(evidence)
    found = ", ".join(f"{term} {value:+.2f}" for term, value in mains[["term", "coefficient"]].to_numpy())
    alias = f"t cannot be told from the {evidence.aliased['t']}" if "t" in evidence.aliased else ""
    return _verdict(f"main effects {found or 'none'}", list(mains["term"][:1]) == ["t"], alias or _chance(evidence))


def _same_terms(evidence: Evidence) -> Verdict:
    if reason := _no_regression(evidence):
        return Verdict("", UNSAID, reason)
    best = evidence.models[0]
    words = " + ".join(sorted(best)) or "none"
    found = f"best model {words}; {len(evidence.models)} as good"
    alias = f"t cannot be told from the {evidence.aliased['t']}" if "t" in evidence.aliased else ""
    several = "models as good differ in their terms" if evidence.published_terms in evidence.models[1:] else ""
    return _verdict(found, best == evidence.published_terms, alias or several or _chance(evidence))


def _no_effect(evidence: Evidence) -> Verdict:
    if reason := _no_regression(evidence):
        return Verdict("", UNSAID, reason)
    lines = {name: coefficient(evidence, name) for name in ("h", "b")}
    words = [
        f"{name} not in the model"
        if line is None
        else f"{name} {line['coefficient']:+.2f}, p by permutation {line['p_value_permutation']:.2f}"
        for name, line in lines.items()
    ]
    strong = [line is not None and line["p_value_permutation"] <= SIGNIFICANT for line in lines.values()]
    others = [name for name, line in lines.items() if line is None and any(name in model for model in evidence.models)]
    several = f"models as good as the best have {' and '.join(others)}" if others else ""
    return _verdict("; ".join(words), not any(strong), several or _chance(evidence))


TESTS: Mapping[str, Test] = {
    "steady_flow": _steady,
    "continuous_range": _continuous_range,
    "discontinuous_range": _discontinuous_range,
    "gradient_by_regime": _gradient,
    "convex_wears_less": _convex_wears_less,
    "r12_wears_more": _exception,
    "r5_lowest": _best,
    "r2_lowest": _best_discontinuous,
    "base_wears_most": _base,
    "normal_force_up": _force,
    "force_up_wear_down": _force_and_wear,
    "rolling_at_surface": _rolling,
    "rolling_falls": _rolling_falls,
    "rolling_discontinuous": _rolling_discontinuous,
    "bottom_layer_taken_along": _taken_along,
    "thickness_strongest": _strongest,
    "same_terms": _same_terms,
    "no_effect_of_height": _no_effect,
}
