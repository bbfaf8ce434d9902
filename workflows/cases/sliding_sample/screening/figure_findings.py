"""What the figures of studies by flow regime show, in one sentence each, from the tables beside them."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.workflows.report.sentences import listed, measured, side, with_interval
from bulkwear.workflows.report.text import number, range_text

LATE = 0.5  # -, of a run's travel, from which on its flow and wear are told: the first half holds most of the start
LEAST_CHANGE = 1e-6  # -, of the largest predicted wear: less along a factor is rounding, and it is not in the model
LEVEL = 0.05  # -, p value of a term that is told apart from chance
CENTRAL, LOWEST = "central", 1  # zone and layer of profiles over the sample
SPIN = "averaged_angular_velocity_deg_per_s"


def pattern_over_plain(table: pd.DataFrame) -> str:
    """Return how many patterns wear less and more than plain, of how many neither can be said, and the lowest of them
    with its interval.

    table: setting, surface, wear_over_plain with packings and interval; plain samples are 1 by definition
    """
    found = table[table["surface"] != PLAIN].dropna(subset="wear_over_plain")
    if found.empty:
        return ""
    best = found.loc[found["wear_over_plain"].idxmin()]
    ratio = with_interval(best["wear_over_plain"], best["interval_low"], best["interval_high"], best["packings"])
    sides = [side(low, high) for low, high in zip(found["interval_low"], found["interval_high"], strict=True)]
    counts = f"{sides.count(-1)} of {len(found)} patterns wear less than plain, {sides.count(1)} more"
    counts += f", of {sides.count(0)} it cannot be said" if 0 in sides else ""
    return f"{counts}; lowest is {best['setting']} with {ratio} of the plain sample's wear."


def late_means(along: pd.DataFrame, column: str) -> pd.DataFrame:
    """Return the mean of a column over the second half of each run's travel: run, regime, column."""
    last = along.groupby("run")["travel_mm"].transform("max")
    late = along[along["travel_mm"] >= LATE * last].dropna(subset=column)
    return late.groupby(["run", "regime"], sort=False)[column].mean().reset_index()


def by_regime(table: pd.DataFrame, column: str, unit: str = "") -> str:
    """Return the range of a column by regime: 20 to 40 % (continuous) and 90 % (discontinuous)."""
    ending = f" {unit}" if unit else ""
    return listed(
        [
            f"{range_text(rows[column].tolist())}{ending} ({regime})"
            for regime, rows in table.groupby("regime", sort=False)
        ]
    )


def relative_velocity(along: pd.DataFrame) -> str:
    """Return how fast particles ride along in each regime; along: a row per run and stretch of travel."""
    found = late_means(along, "relative_velocity_percent")
    if found.empty:
        return ""
    words = by_regime(found, "relative_velocity_percent", "%")
    return f"In the second half of the travel particles ride along with {words} of the sample's velocity."


def wear_gradient(table: pd.DataFrame) -> str:
    """Return the relative wear gradient in each regime; table: a row per run and stretch of travel."""
    found = late_means(table, "relative_gradient")
    if found.empty:
        return ""
    words = by_regime(found, "relative_gradient")
    return f"In the second half of the travel the wear gradient is {words} times the largest one."


def lowest_layer(profiles: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of the lowest layer over the sample."""
    return profiles[(profiles["zone"] == CENTRAL) & (profiles["layer"] == LOWEST)]


def bottom_velocities(profiles: pd.DataFrame) -> str:
    """Return the velocity of the lowest layer over the samples of the rows shown."""
    said = [
        f"{measured(row.velocity_m_per_s, 'm/s')} ({row.row}, {row.surface})"
        for row in lowest_layer(profiles).itertuples()
    ]
    return f"With the sample the lowest layer over it moves at {listed(said)}." if said else ""


def bottom_spins(profiles: pd.DataFrame) -> str:
    """Return how fast the lowest layer turns over patterned samples, over plain ones, by row."""
    said = []
    for row, own in lowest_layer(profiles).groupby("row", sort=False):
        plain, patterned = (own.loc[(own["surface"] == PLAIN) == which, SPIN].mean() for which in (True, False))
        if plain > 0.0 and patterned > 0.0:
            said.append(f"{number(patterned / plain, 2)} times as fast as over the plain one ({row})")
    return f"Over the patterned sample the lowest layer turns {listed(said)}." if said else ""


def least_by_regime(table: pd.DataFrame) -> str:
    """Return the patterned sample that wears least per length of travel in each regime, and its plain twin.

    table: as from `regime_groups.wear_by_group`
    """
    said = []
    for regime, rows in table[table["surface"] != PLAIN].groupby("regime", sort=False):
        best = rows.loc[rows["relative_wear"].idxmin()]
        twin = table[(table["setting"] == best["setting"]) & (table["surface"] == PLAIN)]["relative_wear"]
        beside = f", its plain twin {number(twin.iloc[0], 2)}" if len(twin) else ""
        said.append(f"{best['setting']} in {regime} flow ({number(best['relative_wear'], 2)}{beside})")
    return f"Least wear of a pattern over the largest of its regime: {'; '.join(said)}." if said else ""


def forces_by_regime(table: pd.DataFrame) -> str:
    """Return the normal force on patterned and on plain samples in each regime."""
    said = []
    for plain, word in ((False, "patterned"), (True, "plain")):
        rows = table[(table["surface"] == PLAIN) == plain]
        if len(rows):
            said.append(f"{word} samples with {by_regime(rows, 'mean_normal_force_N', 'N')}")
    return f"The bed presses on {'; on '.join(said)}."


# ---------------------------------------------------------------- regression


def confirmed(table: pd.DataFrame) -> str:
    """Return how many runs of best designs lie in their predicted interval; table: `confirmation_table`."""
    ratio = range_text(table["over_predicted"].tolist())
    inside = int(table["inside"].sum())
    return f"{inside} of {len(table)} runs wear within the predicted interval; they wear {ratio} times the prediction."


def strongest_terms(table: pd.DataFrame) -> str:
    """Return the strongest term, and how many are told apart from chance; table: `chosen_coefficients`."""
    terms = table.dropna(subset="p_value_permutation")
    if terms.empty:
        return "The best model has no term: no factor is told apart from chance."
    first = terms.loc[terms["coefficient"].abs().idxmax()]
    sure = int((terms["p_value_permutation"] <= LEVEL).sum())
    return (
        f"Strongest is {first['term']}, {first['coefficient']:+.2g} of ln wear (p {first['p_value_permutation']:.2g} by"
        f" permutation); {sure} of {len(terms)} terms have p up to {LEVEL:g}."
    )


def largest_residual(table: pd.DataFrame) -> str:
    """Return the run that the model misses most; table: `study_regression.residuals`."""
    row = table.loc[table["residual"].abs().idxmax()]
    return f"The model misses {row['row']} most, by {row['residual']:+.2g} of ln wear."


def largest_contrast(table: pd.DataFrame) -> str:
    """Return the largest contrast over the error that the smallest ones tell; table: `factors.half_normal_table`."""
    row = table.loc[table["contrast"].abs().idxmax()]
    if not row["pseudo_error"] > 0.0:
        return f"Largest is the contrast of {row['term']}."
    times = number(abs(row["contrast"]) / row["pseudo_error"], 2)
    return f"Largest is the contrast of {row['term']}, {times} times the pseudo standard error."


def least_predicted(table: pd.DataFrame) -> str:
    """Return where over pairs of factors the least wear is predicted, by those that the model knows.

    table: `regression_tables.contour_table`
    """
    low, high = table["normalised_wear"].min(), table["normalised_wear"].max()
    said = f"Predicted are {number(low, 2)} to {number(high, 2)} of the largest wear"
    best = table.loc[table["normalised_wear"].idxmin()]
    pair = table[(table["x_factor"] == best["x_factor"]) & (table["y_factor"] == best["y_factor"])]
    at = [
        f"{best[f'{axis}_factor']} {number(best[axis], 3)}"
        for axis, other in (("x", "y"), ("y", "x"))
        if _varies(pair, other)
    ]
    return f"{said}, least at {' and '.join(at)}." if at else f"{said}."


def _varies(pair: pd.DataFrame, kept: str) -> bool:
    """Return whether the prediction depends on a factor of a pair, the other of which is `kept`, "x" or "y"."""
    spans = pair.groupby(kept)["normalised_wear"].agg(np.ptp)
    return bool((spans > LEAST_CHANGE * pair["normalised_wear"].max()).any())
