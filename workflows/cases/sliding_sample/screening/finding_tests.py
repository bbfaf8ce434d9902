"""What each claim on a finding of the source is judged by; keys are those of config/published/verdicts.yaml.

Each builder turns the evidence into estimates over the packings, in the unit of its claim, or says why it cannot. The
rules that judge them, and how often they err, are those of `postproc.statistics.verdicts`: with the margins of the
claims, at most 5 % false "agrees" and 5 % false "contradicts" each.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.intervals import CONFIDENCE, UNKNOWN, Estimate, estimate
from bulkwear.postproc.statistics.verdicts import AGREES, OTHER_SIZE, UNSAID, Claim, Verdict, judged, not_said
from bulkwear.workflows.cases.sliding_sample.evaluation import CONTINUOUS, DISCONTINUOUS
from bulkwear.workflows.cases.sliding_sample.screening.findings import CENTRAL, PERCENT, SIDE, SPIN, Evidence

EXCEPTION, BEST, BEST_DISCONTINUOUS = "R12", "R5", "R2"
THICKNESS, WITHOUT_EFFECT = "t", ("h", "b")
OF_TRAVEL = ("steady_flow",)  # claims on the travel itself, which no run covers by being steady
DIGITS = 3  # significant ones of numbers in words
MANY_ROWS = 4  # of which a reason names fewer


@dataclass(frozen=True)
class Found:
    """What a claim is judged by.

    estimates: by name, each of which is claimed; rows: those that it rests on; reason: why nothing can be said, if so
    of: rows of the source that it is claimed of, each of which could contradict it; lacking: those that were run and
        have no value
    """

    estimates: Mapping[str, Estimate] = field(default_factory=dict)
    rows: Sequence[str] = ()
    reason: str = ""
    of: Sequence[str] = ()
    lacking: Sequence[str] = ()


Builder = Callable[[Evidence], Found]


def findings_table(evidence: Evidence, claims: Mapping[str, Claim]) -> pd.DataFrame:
    """Return key, finding, source, claimed, found, verdict, factor and reason of every claim."""
    verdicts = {key: verdict_on(claim, evidence) for key, claim in claims.items()}
    return pd.DataFrame(
        {
            "key": key,
            "finding": claims[key].finding,
            "source": claims[key].source,
            "claimed": claims[key].words,
            "found": each.found,
            "verdict": each.verdict,
            "factor": each.factor,
            "reason": each.reason,
        }
        for key, each in verdicts.items()
    )


def verdict_on(claim: Claim, evidence: Evidence) -> Verdict:
    """Return the verdict on a claim. Rows that are shown to be steady cover the range that it is made for; what is
    claimed of many rows may be contradicted by one, and agrees only where all of them are there.
    """
    found = BUILDERS[claim.key](evidence)
    if found.reason:
        return not_said(found.reason, words(found.estimates))
    unsteady = evidence.unsteady(found.rows)
    covers = evidence.travel if unsteady or claim.key in OF_TRAVEL else claim.reach
    verdict = judged(claim, found.estimates, words(found.estimates), covers)
    if verdict.verdict == UNSAID and covers != claim.reach and unsteady and verdict.reason.startswith("claimed of"):
        return replace(verdict, reason=f"{verdict.reason}; {_some(unsteady)} not shown to be steady")
    missing = [row for row in found.of if row not in evidence.regimes or row in found.lacking]
    if missing and verdict.verdict in (AGREES, OTHER_SIZE):
        shown = f"{', '.join(found.rows)} {'do' if len(found.rows) > 1 else 'does'} as claimed"
        return not_said(f"{shown}; {_some(missing)} not there", verdict.found)
    return verdict


def words(found: Mapping[str, Estimate]) -> str:
    """Return estimates with their intervals in one line, such as `R5 0.34 (0.30 to 0.39)`, and how many packings."""
    told = [f"{name} {_short(each)}" for name, each in found.items()]
    if not told:
        return ""
    known = [each.packings for each in found.values() if each.known]
    if not known:
        return f"{', '.join(told)}; {UNKNOWN}"
    counts = f"{min(known)}" if min(known) == max(known) else f"{min(known)} to {max(known)}"
    return f"{', '.join(told)}; {PERCENT * CONFIDENCE:g} % intervals, {counts} packings"


def _short(found: Estimate) -> str:
    low, high = found.interval()
    return f"{found.value:.{DIGITS}g}" + (f" ({low:.{DIGITS}g} to {high:.{DIGITS}g})" if found.known else "")


def _some(rows: Sequence[str]) -> str:
    return f"{', '.join(rows)} {'are' if len(rows) > 1 else 'is'}" if len(rows) < MANY_ROWS else f"{len(rows)} rows are"


def _of_rows(
    evidence: Evidence, column: str, rows: Sequence[str], log: bool = True, none: str = "", of: Sequence[str] = ()
) -> Found:
    """Return a column of each of some rows; `none`: why there are no such rows."""
    if not rows:
        return Found(reason=none)
    found = evidence.by_row(column, rows, log)
    lacking = [row for row in rows if row not in found]
    return Found(found, list(found), "" if found else "none of the rows has a value", of, lacking)


def _all(evidence: Evidence, without: Sequence[str] = ()) -> list[str]:
    return [row for row in evidence.design if row not in without]


def _one(evidence: Evidence, row: str, column: str, log: bool = True, regime: str = "") -> Found:
    """Return a column of one row, which must flow in a regime, if given."""
    if row not in evidence.regimes:
        return Found(reason=f"{row} has no result")
    if regime and evidence.regimes[row] != regime:
        return Found(reason=f"{row} is not found to flow in the {regime} regime")
    return _of_rows(evidence, column, [row], log)


# ---------------------------------------------------------------- flow


def _told_regime(evidence: Evidence, regime: str) -> Found:
    here = [row for row in evidence.regimes if evidence.told.get(row) == regime]
    claimed = [row for row, told in evidence.told.items() if told == regime]
    return _of_rows(evidence, "relative_velocity", here, False, "none of these rows has a result", claimed)


def _in_regime(evidence: Evidence, column: str, regime: str, log: bool, without: Sequence[str] = ()) -> Found:
    rows = evidence.rows_in(regime, without)
    none = f"no run is found to flow in the {regime} regime"
    return _of_rows(evidence, column, rows, log, none, _all(evidence, without))


def _fluctuation(evidence: Evidence) -> Found:
    found = _of_rows(evidence, "fluctuation", list(evidence.regimes), of=_all(evidence))
    return Found(rows=list(evidence.regimes)) if found.reason else found


def _gradient(evidence: Evidence) -> Found:
    groups = [evidence.rows_in(regime) for regime in (CONTINUOUS, DISCONTINUOUS)]
    if not all(groups):
        return Found(reason="the runs are not of both regimes")
    wear = evidence.by_packing("wear_m3_per_m", [*groups[0], *groups[1]])
    ratio = wear[groups[0]].mean(axis=1) / wear[groups[1]].mean(axis=1)
    named = {"continuous over discontinuous": estimate(ratio, log=True)}
    return Found(named, [*groups[0], *groups[1]], of=_all(evidence))


# ---------------------------------------------------------------- wear and force


def _lowest(evidence: Evidence, best: str, regime: str) -> Found:
    """Return the wear rate of each other row of a regime over that of the one said to have the lowest."""
    rows = evidence.rows_in(regime, without=[best])
    if best not in evidence.regimes:
        return Found(reason=f"{best} has no result")
    if evidence.regimes[best] != regime:
        return Found(reason=f"{best} is not found to flow in the {regime} regime")
    if not rows:
        return Found(reason=f"no other row is found to flow in the {regime} regime")
    pairs = {row: evidence.by_packing("wear_rate", [row, best]) for row in rows}
    named = {row: estimate(both[row] / both[best], log=True) for row, both in pairs.items()}
    return Found(named, [best, *rows], of=_all(evidence))


def _force(evidence: Evidence) -> Found:
    rows = list(evidence.regimes)
    return _of_rows(evidence, "force_over_plain", rows, none="no row has a result", of=_all(evidence))


def _force_and_wear(evidence: Evidence) -> Found:
    rows = [row for row in evidence.regimes if row != EXCEPTION]
    force, wear = (evidence.by_row(name, rows) for name in ("force_over_plain", "wear_over_plain"))
    inverse = {
        row: replace(each, value=1.0 / each.value) for row, each in wear.items()
    }  # the logarithm changes its sign
    both = [row for row in rows if row in force and row in wear]
    if not both:
        return Found(reason="no row has a plain twin with a result")
    named = {f"{row} {what}": each[row] for row in both for what, each in (("force up", force), ("wear down", inverse))}
    return Found(named, both, of=_all(evidence, [EXCEPTION]), lacking=[row for row in rows if row not in both])


# ---------------------------------------------------------------- motion of the particles


def _rolling_falls(evidence: Evidence) -> Found:
    if BEST not in evidence.regimes:
        return Found(reason=f"{BEST} has no result")
    shown = evidence.profiles[(evidence.profiles["row"] == BEST) & (evidence.profiles["surface"] != PLAIN)]
    over, beside = (
        shown[shown["zone"] == zone].pivot(index="packing", columns="layer", values=SPIN).dropna(axis="columns")
        for zone in (CENTRAL, SIDE)
    )
    both = over.columns.intersection(beside.columns)
    if not {1, 2} <= set(over.columns) or both.empty:
        return Found(reason=f"{BEST} has too few layers to compare")
    top = max(over.columns)
    ratios = {"bottom over second layer": over[1] / over[2], "bottom over top layer": over[1] / over[top]}
    ratios["over the sample over beside it"] = over[both].mean(axis=1) / beside[both].mean(axis=1)
    return Found({name: estimate(values, log=True) for name, values in ratios.items()}, [BEST])


def _rolling_discontinuous(evidence: Evidence) -> Found:
    row = BEST_DISCONTINUOUS
    if row not in evidence.regimes:
        return Found(reason=f"{row} has no result")
    columns = {"over the sample": "spin_over_plain", "beside it": "spin_over_plain_beside"}
    found = {name: evidence.by_row(column, [row]).get(row) for name, column in columns.items()}
    if None in found.values():
        return Found(reason=f"too few particles next to {row} or its twin")
    other = "" if evidence.regimes[row] == DISCONTINUOUS else f"{row} is not found to flow discontinuously"
    return Found(found, [row], other)


# ---------------------------------------------------------------- effects of the factors


def _effects(evidence: Evidence) -> tuple[pd.DataFrame, str]:
    """Return ln(wear per metre) by packing and row of the source's whole design, or why that is not to be had."""
    if evidence.levels.empty:
        return pd.DataFrame(), "the study has not the source's factors"
    missing = [row for row in evidence.levels.index if row not in evidence.regimes]
    if missing:
        return pd.DataFrame(), f"effects are clear of each other in all thirteen rows alone; {_some(missing)} not there"
    scales = evidence.rows["particle_scale"]
    if scales.nunique() > 1:
        return pd.DataFrame(), "rows differ in their particle scale, which cannot be told from the thickness of the bed"
    return np.log(evidence.by_packing("wear_m3_per_m", list(evidence.levels.index))), ""


def main_effects(response: pd.DataFrame, levels: pd.DataFrame) -> pd.DataFrame:
    """Return the main effects (packings, factors) per coded unit of a response (packings, rows) by a design whose main
    effects are orthogonal; levels: (rows, factors), coded.
    """
    return response @ levels / (levels**2).sum()


def _strongest(evidence: Evidence) -> Found:
    response, reason = _effects(evidence)
    if reason:
        return Found(reason=reason)
    effects = main_effects(response, evidence.levels)
    sizes = effects * np.sign(effects.mean())
    others = [name for name in sizes if name != THICKNESS]
    found = {f"{THICKNESS} - {name}": estimate(effects[THICKNESS] - sizes[name]) for name in others}
    return Found(found, list(evidence.levels.index))


def _same_terms(evidence: Evidence) -> Found:
    response, reason = _effects(evidence)
    if reason:
        return Found(reason=reason)
    terms = {term: evidence.levels[term.split("*")].prod(axis=1) for term in evidence.coefficients}
    columns = np.column_stack([np.ones(len(evidence.levels)), *terms.values()])
    fitted = np.linalg.lstsq(columns, response[evidence.levels.index].to_numpy().T, rcond=None)[0][1:]
    published = evidence.coefficients.items()
    found = {term: estimate(values / theirs) for values, (term, theirs) in zip(fitted, published, strict=True)}
    return Found(found, list(evidence.levels.index))


def _no_effect(evidence: Evidence) -> Found:
    response, reason = _effects(evidence)
    if reason:
        return Found(reason=reason)
    effects = main_effects(response, evidence.levels)
    return Found({name: estimate(effects[name]) for name in WITHOUT_EFFECT}, list(evidence.levels.index))


BUILDERS: Mapping[str, Builder] = {
    "steady_flow": _fluctuation,
    "continuous_runs": partial(_told_regime, regime=CONTINUOUS),
    "discontinuous_runs": partial(_told_regime, regime=DISCONTINUOUS),
    "continuous_range": partial(_in_regime, column="relative_velocity", regime=CONTINUOUS, log=False),
    "discontinuous_range": partial(_in_regime, column="relative_velocity", regime=DISCONTINUOUS, log=False),
    "gradient_by_regime": _gradient,
    "convex_wears_less": partial(
        _in_regime, column="wear_over_plain", regime=CONTINUOUS, log=True, without=(EXCEPTION,)
    ),
    "r12_wears_more": partial(_one, row=EXCEPTION, column="wear_over_plain", regime=CONTINUOUS),
    "r5_reduction": partial(_one, row=BEST, column="wear_over_plain", regime=CONTINUOUS),
    "r5_lowest": partial(_lowest, best=BEST, regime=CONTINUOUS),
    "r2_lowest": partial(_lowest, best=BEST_DISCONTINUOUS, regime=DISCONTINUOUS),
    "base_wears_most": partial(_in_regime, column="base_percent", regime=CONTINUOUS, log=False, without=(EXCEPTION,)),
    "normal_force_up": _force,
    "force_up_wear_down": _force_and_wear,
    "rolling_at_surface": partial(_one, row=BEST, column="spin_over_plain"),
    "rolling_falls": _rolling_falls,
    "rolling_discontinuous": _rolling_discontinuous,
    "bottom_layer_taken_along": partial(_one, row=BEST, column="velocity_percent", log=False),
    "bottom_layer_left_behind": partial(_one, row=BEST, column="plain_velocity_percent", log=False),
    "thickness_strongest": _strongest,
    "same_terms": _same_terms,
    "no_effect_of_height": _no_effect,
}
