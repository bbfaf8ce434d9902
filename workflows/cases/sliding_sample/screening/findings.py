"""Which findings of the source the simulations of its thirteen rows confirm, and which not; with numbers.

A verdict is `confirmed`, `not confirmed`, or `cannot be said` with its reason: a row that was not run, a flow that is
not steady, a factor that cannot be told from the particle scale, a ratio too near to 1 without replicates.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.regression import CONSTANT
from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.workflows.cases.sliding_sample.comparison import relative_wear_intervals
from bulkwear.workflows.cases.sliding_sample.evaluation import CONTINUOUS
from bulkwear.workflows.cases.sliding_sample.screening.regression_tables import has_factors
from bulkwear.workflows.cases.sliding_sample.screening.regression_warnings import confounded
from bulkwear.workflows.cases.sliding_sample.screening.study_regression import Screening

UNSURE = 0.05  # -, from 1: between versions of the program the demo's relative wear has scattered by as much (README)
CENTRAL, SIDE = "central", "side"
PERCENT = 100.0


@dataclass(frozen=True, eq=False)
class Evidence:
    """What the simulations found, by the source's names of the rows.

    rows: index row; see `rows_of_study`. gradients: row, surface, regime and relative_gradient along the travel
    profiles: row, surface, zone, layer, velocity_m_per_s and averaged_angular_velocity_deg_per_s
    steady: run, row, surface, measure, mean, deviation and steady of every window, see `steady_table`
    terms: coefficients of the best model, columns term, coefficient, p_value_permutation; None without a regression
    models: models as good, each a set of terms; model_p: p value of the best by permutation
    aliased: {factor: what it cannot be told from}
    travel_end: mm, run-in included
    published: {(quantity, of, relation): value} as in config/published/screening_results.csv
    published_terms: of the source's model
    """

    rows: pd.DataFrame
    gradients: pd.DataFrame
    profiles: pd.DataFrame
    steady: pd.DataFrame
    terms: pd.DataFrame | None
    models: tuple[frozenset[str], ...]
    model_p: float
    aliased: Mapping[str, str]
    travel_end: float
    published: Mapping[tuple[str, str, str], float]
    published_terms: frozenset[str]

    @property
    def continuous(self) -> pd.DataFrame:
        """Return the rows whose flow over the patterned sample is continuous."""
        return self.rows[self.rows["regime"] == CONTINUOUS]


def gather(
    tables: Mapping[str, pd.DataFrame],
    study: Screening | None,
    run_in: float,
    settings: Mapping[str, str],
    published_rows: Mapping[str, str],
) -> Evidence:
    """Return what a study found.

    tables: summary, regimes, profiles, gradients, steady, coefficients and models of the study; published_results and
    published_coefficients. study: None without a regression, and then no coefficients and models
    run_in: mm; settings: {row: setting}; published_rows: {row: row of the source}
    """
    summary, theirs = tables["summary"], tables["published_results"]
    terms = frozenset(tables["published_coefficients"]["term"]) - {CONSTANT}
    of_runs = [tables[name] for name in ("gradients", "profiles", "steady")]
    named = [table.assign(row=table["row"].map(published_rows)).dropna(subset=["row"]) for table in of_runs]
    return Evidence(
        rows=rows_of_study(summary, tables["regimes"], tables["profiles"], settings, published_rows),
        gradients=named[0],
        profiles=named[1],
        steady=named[2],
        **_regression(tables, study),
        travel_end=run_in + MILLIMETRES * float(summary["travel_m"].max()),
        published=theirs.set_index(["quantity", "of", "relation"])["value"].astype(float).to_dict(),
        published_terms=terms,
    )


def _regression(tables: Mapping[str, pd.DataFrame], study: Screening | None) -> dict[str, Any]:
    """Return what the evidence has of the regression."""
    if study is None:
        return {"terms": None, "models": (), "model_p": np.nan, "aliased": {}}
    found = tables["models"][tables["models"]["heredity"] == "none"]
    return {
        "terms": tables["coefficients"] if has_factors(tables["published_coefficients"], study.names) else None,
        "models": tuple(frozenset(model.split(" + ")) - {CONSTANT} for model in found["model"]),
        "model_p": float(found["p_value_permutation"].iloc[0]),
        "aliased": {name: what for what, factors in confounded(study).items() for name in factors},
    }


def rows_of_study(
    summary: pd.DataFrame,
    regimes: pd.DataFrame,
    profiles: pd.DataFrame,
    settings: Mapping[str, str],
    published_rows: Mapping[str, str],
) -> pd.DataFrame:
    """Return a line per row of the source that the study has, index row (its name there); means over replicates.

    Columns: wear_over_plain, interval_low, interval_high, wear_m3_per_m (patterned), force_over_plain, base_share,
    bump_share, relative_velocity, regime and steady of the patterned sample, spin_over_plain (bottom layer over the
    sample), velocity_share and plain_velocity_share (of the bottom layer, in the sample's velocity).
    """
    table = summary.merge(regimes[["run", "relative_velocity", "regime", "steady"]], on="run", how="left")
    patterned, plain = (table[(table["surface"] == PLAIN) == which].set_index("row") for which in (False, True))
    wear = patterned["worn_volume_m3"]
    layer = profiles[(profiles["zone"] == CENTRAL) & (profiles["layer"] == 1)]
    over, beside = (
        layer[(layer["surface"] == PLAIN) == which].set_index("row").reindex(wear.index) for which in (False, True)
    )
    rows = pd.DataFrame(
        {
            "wear_over_plain": patterned["wear_over_plain"],
            "wear_m3_per_m": wear / patterned["travel_m"],
            "force_over_plain": patterned["mean_normal_force_N"] / plain["mean_normal_force_N"].reindex(wear.index),
            "base_share": patterned["base_worn_volume_m3"] / wear,
            "bump_share": patterned["pattern_worn_volume_m3"] / wear,
            "relative_velocity": patterned["relative_velocity"],
            "spin_over_plain": over["averaged_angular_velocity_deg_per_s"]
            / beside["averaged_angular_velocity_deg_per_s"],
            "velocity_share": over["velocity_m_per_s"] / patterned["velocity_m_per_s"],
            "plain_velocity_share": beside["velocity_m_per_s"] / patterned["velocity_m_per_s"],
            "regime": patterned["regime"],
            "steady": patterned["steady"],
        }
    )
    intervals = relative_wear_intervals(summary, settings).set_index("run")
    for name in ("interval_low", "interval_high"):
        rows[name] = patterned["run"].map(intervals[name])
    rows = rows[[row in published_rows for row in rows.index]]
    return _by_published_row(rows, published_rows)


def _by_published_row(rows: pd.DataFrame, published_rows: Mapping[str, str]) -> pd.DataFrame:
    """Return means of the numbers over replicates; the regime is the one they all have, or else mixed."""
    names = [published_rows[row] for row in rows.index]
    groups = rows.groupby(names, sort=False)
    found = groups.mean(numeric_only=True)
    found["wear_over_plain"] = np.exp(np.log(rows["wear_over_plain"]).groupby(names, sort=False).mean())
    found["regime"] = groups["regime"].agg(lambda names: names.iloc[0] if names.nunique() == 1 else "mixed")
    found["steady"] = groups["steady"].agg(lambda each: bool(each.all()))
    return found.rename_axis("row")


def percent(values: pd.Series) -> str:
    """Return shares by row in percent, such as `R1 8 %, R5 16 %`."""
    return ", ".join(f"{row} {PERCENT * value:.0f} %" for row, value in values.items())


def ratios(values: pd.Series) -> str:
    """Return ratios by row, such as `R3 1.12`."""
    return ", ".join(f"{row} {value:.2f}" for row, value in values.items())


def side_of_one(row: pd.Series) -> int:
    """Return 1 or -1 where a relative wear is above or below 1, 0 where that cannot be said.

    By the interval of replicates; without one it must be away from 1 by UNSURE.
    """
    low, high, value = row["interval_low"], row["interval_high"], row["wear_over_plain"]
    if not (np.isfinite(low) and np.isfinite(high)):
        low, high = value / (1.0 + UNSURE), value * (1.0 + UNSURE)
    return int(low > 1.0) - int(high < 1.0)


def coefficient(evidence: Evidence, term: str) -> pd.Series | None:
    """Return the line of a term of the best model, None without it."""
    table = evidence.terms
    found = table[table["term"] == term] if table is not None else pd.DataFrame()
    return found.iloc[0] if len(found) else None


def main_effects(evidence: Evidence) -> pd.DataFrame:
    """Return the main effects of the best model, largest first."""
    table = evidence.terms
    mains = table[~table["term"].str.contains(r"[*^]", regex=True) & (table["term"] != CONSTANT)]
    return mains.sort_values("coefficient", key=np.abs, ascending=False)


def unsteady(evidence: Evidence, rows: pd.DataFrame) -> str:
    """Return why nothing is said of the flow of some rows, empty where it is steady."""
    count = int((~rows["steady"].astype(bool)).sum())
    if not count:
        return ""
    start, end = evidence.published["relative_velocity_steady", "all", "from"], evidence.travel_end
    where = f"; the travel ends after {end:g} mm, the source's flow is steady from {start:g} mm on"
    return f"the flow over {count} of {len(rows)} is not shown to be steady{where if end < start else ''}"


def runs_beside_source(evidence: Evidence, regimes: pd.DataFrame, published_model: Mapping[str, float]) -> pd.DataFrame:
    """Return a line per row of the source: our regime, wear and force beside what the source tells of the row.

    regimes: row and regime as told; published_model: normalised wear by row, by the published regression
    """
    rows = evidence.rows
    told = {
        row: f"{'' if relation == 'about' else relation + ' '}{value / PERCENT:g}"
        for (quantity, row, relation), value in evidence.published.items()
        if quantity == "wear_over_plain"
    }
    return pd.DataFrame(
        {
            "row": rows.index,
            "regime": rows["regime"],
            "published_regime": [regimes.set_index("row")["regime"].get(row, "") for row in rows.index],
            "steady": rows["steady"],
            "relative_velocity_percent": PERCENT * rows["relative_velocity"],
            "wear_over_plain": rows["wear_over_plain"],
            "interval_low": rows["interval_low"],
            "interval_high": rows["interval_high"],
            "published_wear_over_plain": [told.get(row, "") for row in rows.index],
            "normalised_wear": rows["wear_m3_per_m"] / rows["wear_m3_per_m"].max(),
            "published_model": [published_model.get(row, float("nan")) for row in rows.index],
            "force_over_plain": rows["force_over_plain"],
            "bottom_spin_over_plain": rows["spin_over_plain"],
        }
    ).reset_index(drop=True)
