"""Runs of a study against each other: patterned over plain, base against pattern; what replicates tell of scatter.

Rows of a design that differ in nothing but their seed are replicates. The response of a screening is the logarithm of
wear, so scatter is told as a factor: means are geometric, intervals are those of the logarithm. One scatter is taken
for all settings, estimated from all that are repeated.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
from scipy import stats

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.tables.display import in_display_units
from bulkwear.workflows.cases.sliding_sample.evaluation import UNDECIDED

NO_REPLICATES = "each row is one packing: the scatter between packings is not known"


def plain_of_row(summary: pd.DataFrame, column: str) -> pd.Series:
    """Return, for each run, a column's value of the plain run of the same design row; NaN without one."""
    plain = summary[summary["surface"] == PLAIN].set_index("row")[column]
    return summary["row"].map(plain)


def wear_split(summary: pd.DataFrame) -> pd.DataFrame:
    """Return each run's wear on base and on pattern over the wear of the plain run of its row.

    Columns run, row, surface, base_volume_mm3, pattern_volume_mm3, base_over_plain, pattern_over_plain.
    """
    plain = plain_of_row(summary, "worn_volume_m3")
    table = summary[["run", "row", "surface"]].assign(
        base_volume_m3=summary["base_worn_volume_m3"],
        pattern_volume_m3=summary["pattern_worn_volume_m3"],
        base_over_plain=summary["base_worn_volume_m3"] / plain,
        pattern_over_plain=summary["pattern_worn_volume_m3"] / plain,
    )
    return in_display_units(table)


def law_comparison(summary: pd.DataFrame) -> pd.DataFrame:
    """Return each run's volume by Archard and by the solver's own Finnie, and their ratio."""
    table = summary[["run", "row", "surface", "worn_volume_m3", "finnie_volume_m3"]]
    ratio = summary["finnie_volume_m3"] / summary["worn_volume_m3"]
    return in_display_units(table.assign(finnie_over_archard=ratio))


def cycle_ratios(history: pd.DataFrame) -> pd.DataFrame:
    """Return row, surface, lowest and highest ratio to the plain run over the single cycles of each run.

    history: as from `wear_history`; where the plain run has cycles of other lengths, its volume is interpolated along
    the travel. The range shows the scatter along the travel, not an uncertainty of the mean.
    """
    plain = {row: table for row, table in history[history["surface"] == PLAIN].groupby("row", sort=False)}
    rows = []
    for (row, surface), run in history[history["surface"] != PLAIN].groupby(["row", "surface"], sort=False):
        if row not in plain:
            continue
        twin = np.interp(run["travel_mm"], plain[row]["travel_mm"], plain[row]["worn_volume_mm3"])
        ratio = np.diff(run["worn_volume_mm3"]) / np.diff(twin)
        rows.append(
            {"row": row, "surface": surface, "lowest_cycle_ratio": ratio.min(), "highest_cycle_ratio": ratio.max()}
        )
    return pd.DataFrame(rows, columns=["row", "surface", "lowest_cycle_ratio", "highest_cycle_ratio"])


def relative_wear_table(
    summary: pd.DataFrame, history: pd.DataFrame, size_ratios: Mapping[str, float | None]
) -> pd.DataFrame:
    """Return row, surface, wear_over_plain, range over cycles and alpha_ER of every run that is not plain.

    size_ratios: alpha_ER by run (Yan 2022, Eq 4.18). Rows in the order of the design.
    """
    table = summary[summary["surface"] != PLAIN][["run", "row", "surface", "wear_over_plain"]]
    ratios = [size_ratios.get(run) for run in table["run"]]
    table = table.assign(equivalent_size_ratio=np.array(ratios, dtype=float))
    return table.merge(cycle_ratios(history), on=["row", "surface"], how="left")


# ---------------------------------------------------------------- replicates


def replicate_intervals(settings: np.ndarray, values: np.ndarray, level: float = 0.95) -> pd.DataFrame:
    """Return setting, runs, mean, low, high and deviation of positive values of runs that share a setting.

    settings: (n,) labels; values: (n,), without a result where NaN or not above zero
    mean: geometric; low, high: the interval of it at that confidence, by Student's t on the degrees of freedom of all
    repeated settings together; deviation: standard deviation of ln(value) between replicates, the same in every line.
    NaN where no setting is repeated.
    """
    values = np.asarray(values, dtype=float)
    table = pd.DataFrame({"setting": settings, "log": np.log(np.where(values > 0.0, values, np.nan))}).dropna()
    groups = table.groupby("setting", sort=False)["log"]
    found = groups.agg(runs="count", log="mean").reset_index()
    freedom = len(table) - len(found)
    rest = table["log"] - groups.transform("mean")
    deviation = float(np.sqrt((rest**2).sum() / freedom)) if freedom else float("nan")
    reach = stats.t.ppf(0.5 + level / 2.0, max(freedom, 1)) * deviation / np.sqrt(found["runs"])
    middle = found.pop("log")
    return found.assign(
        mean=np.exp(middle), low=np.exp(middle - reach), high=np.exp(middle + reach), deviation=deviation
    )


def ratio_intervals(settings: np.ndarray, values: np.ndarray, reference: str, level: float = 0.95) -> pd.DataFrame:
    """Return `replicate_intervals` with each setting's ratio to a reference: columns ratio, ratio_low, ratio_high.

    Runs of a setting and of the reference are independent samples. The interval of the ratio is that of the difference
    of mean logarithms, by Student's t on `freedom` degrees of freedom, those of all settings together; of the reference
    itself it is NaN. Raises ValueError without a value of the reference.
    """
    found = replicate_intervals(settings, values, level)
    if reference not in found["setting"].to_numpy():
        raise ValueError(f"no run of {reference}, found are {', '.join(map(str, found['setting'])) or 'none'}")
    own = found["setting"] == reference
    freedom = int(found["runs"].sum()) - len(found)
    against = found[own].iloc[0]
    error = found["deviation"] * np.sqrt(1.0 / found["runs"] + 1.0 / against["runs"])
    reach = (stats.t.ppf(0.5 + level / 2.0, max(freedom, 1)) * error).mask(own)
    ratio = found["mean"] / against["mean"]
    ends = {"ratio_low": ratio * np.exp(-reach), "ratio_high": ratio * np.exp(reach)}
    return found.assign(ratio=ratio, **ends, freedom=freedom)


def by_setting(table: pd.DataFrame, settings: Mapping[str, str]) -> pd.DataFrame:
    """Return a table of relative wear with a line per setting instead of per row; `row` is then the setting's name.

    table: as from `comparison.relative_wear_table`; settings: {row: setting}
    Columns more: replicates, and interval_low and interval_high of wear_over_plain, NaN without replicates. Ranges over
    the cycles are those of all replicates.
    """
    setting = table["row"].map(settings)
    intervals = replicate_intervals(setting.to_numpy(), table["wear_over_plain"].to_numpy()).set_index("setting")
    groups = table.groupby(setting, sort=False)
    merged = groups.first().assign(
        row=list(groups.groups),
        lowest_cycle_ratio=groups["lowest_cycle_ratio"].min(),
        highest_cycle_ratio=groups["highest_cycle_ratio"].max(),
    )
    columns = {"mean": "wear_over_plain", "runs": "replicates", "low": "interval_low", "high": "interval_high"}
    return merged.assign(**{ours: intervals[name] for name, ours in columns.items()}).reset_index(drop=True)


def mean_of_replicates(table: pd.DataFrame, settings: Mapping[str, str]) -> pd.DataFrame:
    """Return a table of runs with the mean of every number over the replicates of each setting and surface.

    table: with run, row, surface and regime; `row` is then the setting's name, other words are those of the first.
    Replicates that flow in different regimes are UNDECIDED together.
    """
    named = table.assign(row=table["row"].map(settings))
    regimes = named.groupby(["row", "surface"])["regime"]
    named["regime"] = named["regime"].where(regimes.transform("nunique") < 2, UNDECIDED)
    means = dict.fromkeys(table.select_dtypes("number"), "mean")
    words = {name: "first" for name in table if name not in means and name not in ("row", "surface")}
    found = named.groupby(["row", "surface"], sort=False).agg(words | means).reset_index()
    return found[list(table)]


def with_intervals(table: pd.DataFrame, settings: Mapping[str, str], column: str = "relative_wear") -> pd.DataFrame:
    """Return `mean_of_replicates` with replicates, interval_low and interval_high of a column, surface by surface."""
    named = table["row"].map(settings)
    parts = [
        replicate_intervals(named[runs.index].to_numpy(), runs[column].to_numpy()).assign(surface=surface)
        for surface, runs in table.groupby("surface", sort=False)
    ]
    names = {"setting": "row", "runs": "replicates", "low": "interval_low", "high": "interval_high"}
    found = pd.concat(parts, ignore_index=True).rename(columns=names)[[*names.values(), "surface"]]
    return mean_of_replicates(table, settings).merge(found, on=["row", "surface"], how="left")


def relative_wear_intervals(summary: pd.DataFrame, settings: Mapping[str, str]) -> pd.DataFrame:
    """Return run, replicates, interval_low and interval_high of wear over plain of runs with a plain twin; settings: by
    row. The interval is that of the mean over the run's setting, see `replicate_intervals`.
    """
    runs = summary[(summary["surface"] != PLAIN) & summary["wear_over_plain"].notna()]
    setting = runs["row"].map(settings)
    found = replicate_intervals(setting.to_numpy(), runs["wear_over_plain"].to_numpy()).set_index("setting")
    columns = {"runs": "replicates", "low": "interval_low", "high": "interval_high"}
    return runs[["run"]].assign(**{ours: setting.map(found[name]) for name, ours in columns.items()})


def replicate_remark(intervals: pd.DataFrame, column: str = "replicates") -> str:
    """Return what figures must say of replicates: how many there are, or that there are none."""
    runs = intervals[column]
    repeated = int((runs > 1).sum())
    if not repeated:
        return NO_REPLICATES
    return f"{repeated} of {len(runs)} rows repeated with other packings; bars: 95 % interval of the mean"
