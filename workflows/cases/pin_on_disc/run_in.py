"""Contours of a disc revolution by revolution: their statistics, whether they are normal, and the run-in.

The table of contours has one row per run, revolution and contour (`contours.contour_table`).
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import read_surface
from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.postproc.tables.summary import published_value
from bulkwear.workflows.cases.pin_on_disc.contours import contour_table
from bulkwear.workflows.cases.pin_on_disc.runs import whole_revolutions

SIGNIFICANCE = 0.05  # -, a p value above passes (Yan 2022, section 5.4.3)
FITTED_PARAMETERS = 2  # of the normal distribution: mean and standard deviation, each takes a degree of freedom
SIZES = {"depth": "depth_m", "opening width": "opening_width_m", "width of 95 % of the area": "area_width_m"}
TESTED = {"depth": "depth_p_value", "opening width": "width_p_value"}  # size -> column of Table 5.3
HISTOGRAM_CLASSES = 20


def contours_of_run(folder: str | Path, track_radius: float) -> pd.DataFrame:
    """Contours of a run's disc after each whole revolution: `revolution` and the columns of `contour_table`.

    folder : of the run, with wear.csv and cycle_<nnn>/surface.vtu; track_radius : m.
    Raises ValueError when no cycle ends with a whole revolution.
    """
    ends = whole_revolutions(pd.read_csv(Path(folder) / "wear.csv"))
    if ends.empty:
        raise ValueError(f"{folder}/wear.csv: no cycle ends with a whole revolution, allowed are runs of one and more")
    return pd.concat(
        [
            contour_table(read_surface(Path(folder) / f"cycle_{row.cycle:03d}" / "surface.vtu"), track_radius).assign(
                revolution=row.revolution
            )
            for row in ends.itertuples()
        ],
        ignore_index=True,
    )


def equiprobable_bins(count: int) -> int:
    """Number of classes of a chi-squared test of `count` values: 2 n^(2/5) (D. S. Moore, 1986, after Mann and Wald)."""
    return max(int(2.0 * count**0.4), FITTED_PARAMETERS + 2)


def chi_squared_normality(values: np.ndarray) -> float:
    """Probability (-) of a chi-squared as large as that of `values` (n,) if they are independent and normal.

    The classes are equally probable under the normal distribution of the same mean and standard deviation, as many as
    `equiprobable_bins` says; degrees of freedom: classes - 1 - 2. NaN for values that are all the same.
    Yan (2022) gives no classes.
    """
    from scipy import stats  # slow to import, and every job reads the page of its study's case

    spread = values.std(ddof=1) if len(values) > 1 else 0.0
    if not spread > 0.0:
        return float("nan")
    bins = equiprobable_bins(len(values))
    probability = stats.norm.cdf(values, values.mean(), spread)
    counts = np.bincount(np.minimum((bins * probability).astype(int), bins - 1), minlength=bins)
    return float(stats.chisquare(counts, ddof=FITTED_PARAMETERS).pvalue)


def neighbour_correlation(values: np.ndarray) -> float:
    """Correlation (-) of each contour (n,) with the next round the disc; the test wants 0. NaN without spread."""
    deviation = values - values.mean()
    square = float(deviation @ deviation)
    return float(deviation @ np.roll(deviation, -1)) / square if square > 0.0 else float("nan")


def revolution_statistics(contours: pd.DataFrame) -> pd.DataFrame:
    """Mean, standard deviation, extremes, p value and neighbour correlation of each size per run and revolution.

    contours : `run`, `revolution` and the sizes (m); columns: run, revolution, size, mean_m, deviation_m, least_m,
    largest_m, p_value, neighbour_correlation.
    """
    rows = [
        {
            "run": run,
            "revolution": revolution,
            "size": size,
            "mean_m": of_one[column].mean(),
            "deviation_m": of_one[column].std(ddof=1),
            "least_m": of_one[column].min(),
            "largest_m": of_one[column].max(),
            "p_value": chi_squared_normality(of_one[column].to_numpy()),
            "neighbour_correlation": neighbour_correlation(of_one[column].to_numpy()),
        }
        for (run, revolution), of_one in contours.groupby(["run", "revolution"], sort=False)
        for size, column in SIZES.items()
    ]
    return pd.DataFrame(rows)


def statistics_of(runs: pd.DataFrame, contours: pd.DataFrame) -> pd.DataFrame:
    """Statistics per run and revolution with the scheme of the run."""
    return revolution_statistics(contours).merge(runs[["run", "scheme"]], on="run")


def run_in_revolution(revolution: Sequence[int], *p_values: Sequence[float]) -> int | None:
    """First revolution from which on all p values stay above `SIGNIFICANCE`; None when the last one does not pass.

    revolution : increasing; p_values : one sequence per tested size. Table 5.3 of Yan (2022) gives 8.
    """
    passed = np.all(np.asarray(p_values, dtype=float) > SIGNIFICANCE, axis=0)
    failures = np.flatnonzero(~passed)
    first = failures[-1] + 1 if failures.size else 0
    return int(np.asarray(revolution)[first]) if first < len(passed) else None


def run_in_table(statistics: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Run-in by the same rule for every run and for the published p values: `run`, `run_in_revolution` (NaN: not yet),
    `revolutions`.

    statistics : as from `revolution_statistics`; published : `revolution`, `depth_p_value`, `width_p_value`.
    """
    rows = []
    for run, of_run in statistics.groupby("run", sort=False):
        p_values = of_run.pivot(index="revolution", columns="size", values="p_value")
        found = run_in_revolution(p_values.index, p_values["depth"], p_values["opening width"])
        rows.append({"run": run, "run_in_revolution": found, "revolutions": p_values.index.max()})
    found = run_in_revolution(published["revolution"], published["depth_p_value"], published["width_p_value"])
    rows.append(
        {"run": "Yan 2022, Table 5.3", "run_in_revolution": found, "revolutions": published["revolution"].max()}
    )
    return pd.DataFrame(rows)


def run_in_words(statistics: pd.DataFrame, normality: pd.DataFrame) -> dict[str, str]:
    """What the test says of each tested size: from which revolution on it is normal, by scheme and in the thesis.

    statistics : of one run per scheme; normality : Table 5.3.
    """
    words = {}
    for size, column in TESTED.items():
        of_size = statistics[statistics["size"] == size]
        found = {
            scheme.replace("_", " "): run_in_revolution(rows["revolution"], rows["p_value"])
            for scheme, rows in of_size.groupby("scheme", sort=False)
        }
        found["Yan"] = run_in_revolution(normality["revolution"], normality[column])
        words[size] = "normal from: " + ", ".join(f"{name} {number or 'never'}" for name, number in found.items())
    return words


def size_histogram(values: np.ndarray, classes: int) -> pd.DataFrame:
    """Counts of values (n,) in equal classes, beside those of the normal distribution of their mean and spread.

    Columns: from, to (unit of the values), count, normal_count, p_value (of `chi_squared_normality`).
    """
    from scipy import stats

    counts, edges = np.histogram(values, classes)
    expected = len(values) * np.diff(stats.norm.cdf(edges, values.mean(), values.std(ddof=1)))
    return pd.DataFrame({"from": edges[:-1], "to": edges[1:], "count": counts, "normal_count": expected}).assign(
        p_value=chi_squared_normality(values)
    )


def histograms(contours: pd.DataFrame) -> pd.DataFrame:
    """Histograms of depth and opening (m) of one revolution per scheme: `scheme`, `size` and as `size_histogram`."""
    return pd.concat(
        [
            size_histogram(rows[SIZES[size]].to_numpy(), HISTOGRAM_CLASSES).assign(scheme=scheme, size=size)
            for scheme, rows in contours.groupby("scheme", sort=False)
            for size in TESTED
        ],
        ignore_index=True,
    )


def published_ranges(published: pd.DataFrame) -> pd.DataFrame:
    """Published ranges of depth and opening after ten revolutions: `size`, `least_m`, `largest_m`, `source`."""
    rows = []
    for size, name in (("depth", "depth"), ("opening width", "width")):
        least, largest = (
            published_value(published, f"{part}_{name}_after_10", "simulation") / MILLIMETRES
            for part in ("least", "largest")
        )
        source = published.loc[published["quantity"] == f"least_{name}_after_10", "source"].iloc[0]
        rows.append({"size": size, "least_m": least, "largest_m": largest, "source": source})
    return pd.DataFrame(rows)
