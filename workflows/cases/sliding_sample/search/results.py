"""What simulated patterns tell a search: wear over plain, and how fast the pattern itself goes, by setting."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from bulkwear.postproc.inference.ranges import points_of
from bulkwear.postproc.mesh import PLAIN, read_surface
from bulkwear.postproc.statistics.shared_scatter import means_and_covariance
from bulkwear.postproc.tables.packings import PACKING, SETTING
from bulkwear.postproc.wear.pattern_left import pattern_volume
from bulkwear.workflows.config.optimise import Optimise

if TYPE_CHECKING:
    from bulkwear.postproc.inference.improvement import Tried

SECONDS_PER_HOUR = 3600.0
LEAST_LOSS = 1e-3  # -, of the loss per hour that just leaves enough: a pattern that hardly wears has no logarithm else
OF_RUNS = ("ln_wear_over_plain", "ln_loss_per_h")  # of each packing; lower is better, the second one has a limit


def volumes_of(runs: Sequence[str], surfaces: Sequence[str | Path]) -> dict[str, float]:
    """Return {run: volume (m3) of its pristine pattern}; surfaces: files in the order of the runs."""
    return {run: pattern_volume(read_surface(path)) for run, path in zip(runs, surfaces, strict=True)}


def loss_limit(search: Optimise) -> float:
    """Return ln of the part (1/h) of a pattern's volume that it may lose per hour at most."""
    return float(np.log((1.0 - search.least_left) / search.after_h))


def left_after(ln_loss: np.ndarray | float, search: Optimise) -> np.ndarray | float:
    """Return which part (-) of a pattern is left after the hours of a search, at a steady loss of exp(ln_loss) per
    hour; 0 where that is more than there is.
    """
    return np.maximum(1.0 - np.exp(ln_loss) * search.after_h, 0.0)


def run_results(
    summary: pd.DataFrame, volumes: Mapping[str, float], search: Optimise, acceleration: float
) -> pd.DataFrame:
    """Return a line per patterned run with a plain twin: setting, packing, the factors, OF_RUNS.

    summary: as from `summary.summary_table`; volumes: as from `volumes_of`; acceleration: -, of the wear
    """
    runs = summary[(summary["surface"] != PLAIN) & (summary["wear_over_plain"] > 0.0)]
    hours = runs["time_s"] * acceleration / SECONDS_PER_HOUR
    loss = runs["pattern_worn_volume_m3"] / hours / runs["run"].map(volumes)
    least = LEAST_LOSS * np.exp(loss_limit(search))
    return runs[[SETTING, PACKING, *search.names]].assign(
        ln_wear_over_plain=np.log(runs["wear_over_plain"]), ln_loss_per_h=np.log(np.maximum(loss, least))
    )


def tried_patterns(runs: pd.DataFrame, search: Optimise) -> pd.DataFrame:
    """Return the setting and the factors of each pattern, in the order of the runs; runs: as from `run_results`."""
    return runs[[SETTING, *search.names]].drop_duplicates(SETTING, ignore_index=True)


def tried_of(runs: pd.DataFrame, search: Optimise) -> Tried:
    """Return what a search knows of its patterns, in the order of `tried_patterns`; runs: as from `run_results`.

    What a packing shifts, its bed and its plain twin, is an error that all its patterns share. Scatter is taken to be
    that of all settings together; without a setting of two packings it is 0, and the surrogate finds it.
    """
    from bulkwear.postproc.inference.improvement import Tried  # slow to import, and every start of Snakemake reads this

    wear, loss = (means_and_covariance(runs[SETTING], runs[PACKING], runs[name].to_numpy(float)) for name in OF_RUNS)
    points = points_of(search.factors, tried_patterns(runs, search)[search.names].to_numpy(float))
    return Tried(points, *wear, *loss, loss_limit(search), search.seed)


def predictions(tried: Tried, values: np.ndarray, search: Optimise) -> pd.DataFrame:
    """Return what the surrogates say of patterns, a line each of values (m, p): predicted wear over plain, its 95 %
    interval, scatter of packings left out, the part of the pattern that is left, and the chance that it is enough.
    """
    points = points_of(search.factors, values)
    mean, low, high = (np.exp(each) for each in tried.interval(points))
    left = left_after(tried.limited_response.predict(points)[0], search)
    return pd.DataFrame(
        {
            "predicted": mean,
            "predicted_low": low,
            "predicted_high": high,
            "predicted_left": left,
            "chance_enough_left": tried.chance_within(points),
        }
    )


def slices(tried: Tried, best: Mapping[str, float], search: Optimise) -> pd.DataFrame:
    """Return the `predictions` along each factor, others held at a pattern: factor, value and best, that of the
    pattern, in the factor's unit.
    """
    tables = []
    for column, each in enumerate(search.factors):
        along = each.low + each.step * np.arange(each.steps + 1)
        values = np.tile([float(best[name]) for name in search.names], (len(along), 1))
        values[:, column] = along
        head = pd.DataFrame({"factor": each.name, "value": along, "best": float(best[each.name])})
        tables.append(pd.concat([head, predictions(tried, values, search)], axis=1))
    return pd.concat(tables, ignore_index=True)
