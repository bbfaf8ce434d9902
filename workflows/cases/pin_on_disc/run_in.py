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
from bulkwear.workflows.cases.pin_on_disc.contours import CONTOURS, contour_table
from bulkwear.workflows.cases.pin_on_disc.runs import whole_revolutions

SIGNIFICANCE = 0.05  # -, a p value above passes (Yan 2022, section 5.4.3)
FITTED_PARAMETERS = 2  # of the normal distribution: mean and standard deviation, each takes a degree of freedom
SIZES = {"depth": "depth_m", "opening width": "opening_width_m", "width of 95 % of the area": "area_width_m"}
TESTED = {"depth": "depth_p_value", "opening width": "width_p_value"}  # size -> column of Table 5.3
HISTOGRAM_CLASSES = 20
VOLUME_SERIES = "volume removed per revolution"


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
    spread = values.std(ddof=1) if len(values) > 1 else 0.0
    return float(normality_p_values(values[None])[0]) if spread > 0.0 else float("nan")


def normality_p_values(samples: np.ndarray) -> np.ndarray:
    """Return the p values (m,) of `chi_squared_normality` of samples (m, n) that all have a spread."""
    from scipy import special  # slow to import, and every job reads the page of its study's case

    count, size = samples.shape
    bins = equiprobable_bins(size)
    scores = (samples - samples.mean(axis=1, keepdims=True)) / samples.std(axis=1, ddof=1, keepdims=True)
    classes = np.minimum((bins * special.ndtr(scores)).astype(int), bins - 1)
    of_all = (classes + bins * np.arange(count)[:, None]).ravel()
    counts = np.bincount(of_all, minlength=bins * count).reshape(count, bins)
    expected = size / bins
    return special.chdtrc(bins - 1 - FITTED_PARAMETERS, ((counts - expected) ** 2).sum(axis=1) / expected)


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


def run_in_revolution(
    revolution: Sequence[int], *p_values: Sequence[float], significance: float = SIGNIFICANCE
) -> int | None:
    """First revolution from which on all p values stay above a significance; None when the last one does not pass.

    revolution : increasing; p_values : one sequence per tested size. Table 5.3 of Yan (2022) gives 8. With the source's
    significance for each single test, contours that are normal all along fail somewhere more often than not
    (`rate_of_no_run_in`): the more revolutions, the later the run-in ends by chance.
    """
    passed = np.all(np.asarray(p_values, dtype=float) > significance, axis=0)
    failures = np.flatnonzero(~passed)
    first = failures[-1] + 1 if failures.size else 0
    return int(np.asarray(revolution)[first]) if first < len(passed) else None


def corrected_significance(tests: int) -> float:
    """Significance (-) of each of some independent tests of which all are passed by chance as often as one at
    `SIGNIFICANCE` (Z. Sidak, J. Am. Stat. Assoc. 62, 1967).
    """
    return 1.0 - (1.0 - SIGNIFICANCE) ** (1.0 / tests)


def rate_of_no_run_in(
    revolutions: int, trials: int, rng: np.random.Generator, corrected: bool, contours: int = CONTOURS
) -> float:
    """Share (-) of discs, normal in both sizes from the start, whose run-in the rule ends with revolution 1.

    corrected : whether by `corrected_significance`, or with the source's for each test
    """
    sizes = len(TESTED)
    significance = corrected_significance(sizes * revolutions) if corrected else SIGNIFICANCE
    numbers, found = np.arange(1, revolutions + 1), 0
    for _ in range(trials):
        p_values = normality_p_values(rng.standard_normal((sizes * revolutions, contours))).reshape(sizes, -1)
        found += run_in_revolution(numbers, *p_values, significance=significance) == 1
    return found / trials


def run_in_table(statistics: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Run-in by the same rules for every run and for the published p values.

    statistics : as from `revolution_statistics`; published : `revolution`, `depth_p_value`, `width_p_value`. Columns:
    `run`, `run_in_revolution` by the source's rule, `corrected_run_in_revolution` with `corrected_significance` (NaN:
    not yet), `revolutions`.
    """
    cases = {
        run: of_run.pivot(index="revolution", columns="size", values="p_value")[list(TESTED)]
        for run, of_run in statistics.groupby("run", sort=False)
    }
    cases["Yan 2022, Table 5.3"] = published.set_index("revolution")[list(TESTED.values())]
    rows = []
    for run, p_values in cases.items():
        columns = p_values.to_numpy(float).T
        corrected = corrected_significance(columns.size)
        found = [run_in_revolution(p_values.index, *columns, significance=each) for each in (SIGNIFICANCE, corrected)]
        rows.append((run, *found, p_values.index.max()))
    return pd.DataFrame(rows, columns=["run", "run_in_revolution", "corrected_run_in_revolution", "revolutions"])


def revolution_series(of_run: pd.DataFrame, volume: pd.DataFrame) -> dict[str, tuple[pd.Series, np.ndarray]]:
    """What a run does from revolution to revolution, by name: revolutions, and volume removed in each (if the run has
    volumes) or the deviation of a size over its mean.

    of_run : of one run, as from `revolution_statistics`; volume : `revolution` and `removed_volume_m3` of the run
    """
    volume, found = volume.sort_values("revolution"), {}
    if len(volume):
        found[VOLUME_SERIES] = (volume["revolution"], np.diff(volume["removed_volume_m3"], prepend=0.0))
    for size, rows in of_run[of_run["size"].isin(TESTED)].groupby("size", sort=False):
        ratio = (rows["deviation_m"] / rows["mean_m"]).to_numpy(float)
        found[f"deviation of {size} over its mean"] = (rows["revolution"], ratio)
    return found


def change_points(statistics: pd.DataFrame, volumes: pd.DataFrame) -> pd.DataFrame:
    """Where what a run does from revolution to revolution becomes level, by `postproc.statistics.change_point`.

    statistics : as from `revolution_statistics`, which says the runs; volumes : `run`, `revolution`,
    `removed_volume_m3`. The volume removed in each revolution, and the deviation of the contours over their mean.
    Columns: run, series, answer, end_revolution, least_end_revolution, last_end_revolution (95 %), p_value (of a run-in
    as clear by chance).
    """
    from bulkwear.postproc.statistics.change_point import run_in

    rows = []
    for run, of_run in statistics.groupby("run", sort=False):
        for name, (revolution, values) in revolution_series(of_run, volumes[volumes["run"] == run]).items():
            found = run_in(revolution, values)
            rows.append((run, name, found.answer, found.end, found.low, found.high, found.p_value))
    ends = ["end_revolution", "least_end_revolution", "last_end_revolution"]
    return pd.DataFrame(rows, columns=["run", "series", "answer", *ends, "p_value"])


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
