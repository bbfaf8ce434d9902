"""The flow over every run of a study along its travel: bins of each wear cycle, made of its snapshots when it ends."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.flow.bed import snapshots
from bulkwear.postproc.flow.moving_bins import (
    QUANTITIES,
    BinSums,
    MovingBins,
    add_dumps,
    joined,
    relative_velocity_history,
    surcharge_history,
    velocity_profile,
)
from bulkwear.postproc.flow.spin import MEANS, Segments, SpinSums, mean_spin
from bulkwear.postproc.readers.cycle_folders import FLOW_TABLE, PACKING, SPIN_TABLE, cycle_files
from bulkwear.postproc.statistics.steady import DRIFTING, FEWEST_VALUES, STEADY, UNSAID, steady_window
from bulkwear.postproc.tables.display import MILLIMETRES, in_display_units
from bulkwear.workflows.cases.sliding_sample.evaluation import regime_table

FIRST_SNAPSHOT = "bed_0.dump"  # of a cycle, at its step 0
COUNT_LINE = 4  # of a dump, with the number of its particles
INTERVAL = 0.01  # m of travel that is averaged (Yan 2022, section 3.4)
LAYER_HEIGHT = 0.005  # m, of layers of real particles; coarse-grained ones have layers as much higher
SIDE_SHARE = 0.25  # -, width of the side bins over the sample's: 50 mm beside 200 mm
LEAST_PARTICLES = 5.0  # in a bin, mean over frames: of fewer a profile tells single particles
HIGHEST = 3.0  # -, top of the layers over the thickness of the bed; room for what piles up


@dataclass(frozen=True)
class RunFlow:
    """What the bins of a run need to know of it, SI: sample, bed, motion, and the scale of its particles (-)."""

    width: float
    length: float
    bed_width: float
    bed_length: float
    bed_thickness: float
    velocity: float
    time_step: float
    particle_scale: float

    @property
    def bins(self) -> MovingBins:
        """Return the bins; side bins end where the bed does."""
        height = LAYER_HEIGHT * self.particle_scale
        side = min(SIDE_SHARE * self.width, 0.5 * (self.bed_width - self.width))
        return MovingBins(self.width, self.length, side, height, int(np.ceil(HIGHEST * self.bed_thickness / height)))

    @property
    def definition(self) -> dict[str, Any]:
        """Return what tells bins of this run from others; stored with them."""
        return {**asdict(self.bins), **self._intervals, "means": list(QUANTITIES)}

    @property
    def segments(self) -> Segments:
        """Return the pieces of the lowest layer along the sample."""
        return Segments(self.width, self.length, LAYER_HEIGHT * self.particle_scale)

    @property
    def spin_definition(self) -> dict[str, Any]:
        """Return what tells the pieces along the sample from others; stored with them."""
        return {**asdict(self.segments), **self._intervals, "means": MEANS}

    @property
    def _intervals(self) -> dict[str, float]:
        return {"interval": INTERVAL, "travel_per_step": self.velocity * self.time_step}


def reduce_snapshots(cycle_folder: str | Path, run: RunFlow, start: float) -> list[Path]:
    """Write the bins of a wear cycle from its snapshots and return those of no use from then on, all but the last.

    Beside the bins how particles turn along the sample (`spin.SpinSums`); both from one reading.
    start: m, travel at step 0 of the cycle; the snapshot of that step is the last one of the cycle before, and left
    out. Disk is then bounded by a snapshot and bins times intervals per cycle.
    Raises FileNotFoundError when there is no snapshot, and the errors of `moving_bins.bin_history`.
    """
    dumps = [path for path in snapshots(cycle_folder) if path.name != FIRST_SNAPSHOT]
    if not dumps:
        raise FileNotFoundError(f"{cycle_folder}: no bed_<step>.dump found, at least one is needed to know the flow.")
    travel_per_step = run.velocity * run.time_step
    bins, spins = BinSums(run.bins, travel_per_step, INTERVAL), SpinSums(run.segments, travel_per_step, INTERVAL)
    add_dumps(((path, start) for path in dumps), [bins, spins])
    for sums, name, definition in ((bins, FLOW_TABLE, run.definition), (spins, SPIN_TABLE, run.spin_definition)):
        table = sums.table()
        table.attrs = definition
        table.to_parquet(Path(cycle_folder) / name, index=False)
    return dumps[:-1]


def run_bins(folder: str | Path, run: RunFlow) -> pd.DataFrame:
    """Return the bin history of a run, see `moving_bins.bin_history`, from what its wear cycles were reduced to.

    Raises FileNotFoundError when no cycle was, ValueError for one whose bins are not those of `run`.
    """
    return joined(_cycle_tables(folder, FLOW_TABLE, run.definition))


def _cycle_tables(folder: str | Path, name: str, definition: Mapping[str, Any]) -> list[pd.DataFrame]:
    """Return the tables of that name of a run's wear cycles; errors as of `run_bins`."""
    tables = []
    for path in cycle_files(folder, name):
        table = pd.read_parquet(path)
        if table.attrs != definition:
            raise ValueError(
                f"{path}: its bins are not those asked for now, allowed are bins of {definition}; remove it"
                " and the run's wear.csv, and its cycles from this one on are simulated again."
            )
        tables.append(table)
    if not tables:
        raise FileNotFoundError(f"{folder}: no cycle_*/{name} found, at least one wear cycle must have been run.")
    return tables


def spin_profiles(
    folders: Mapping[str, Path], runs: Mapping[str, RunFlow], starts: Mapping[str, float]
) -> pd.DataFrame:
    """Return how particles turn along the sample of every run, as from `spin.mean_spin`, with a column run.

    starts: m, by run, travel from which on is averaged. Raises the errors of `run_bins`; cycles that were simulated
    before these tables were kept have none.
    """
    tables = []
    for run, folder in folders.items():
        history = pd.concat(_cycle_tables(folder, SPIN_TABLE, runs[run].spin_definition), ignore_index=True)
        tables.append(mean_spin(history, starts[run]).assign(run=run))
    return pd.concat(tables, ignore_index=True)


def along_travel(bins: pd.DataFrame, run: RunFlow, particles: int) -> pd.DataFrame:
    """Return travel_m, relative_velocity and surcharge (-) of a run; particles: of the whole bed."""
    undisturbed = particles * run.width * run.length / (run.bed_width * run.bed_length)
    velocity = relative_velocity_history(bins, run.velocity, run.bed_thickness)
    return velocity.merge(surcharge_history(bins, undisturbed), on="travel_m", how="left")


def settled_value(travel: np.ndarray, measure: np.ndarray) -> tuple[float, str]:
    """Return the mean of the window in which a measure is steadiest and what is said of it, see `steady.Window`.

    Of too few values it is their mean, and nothing can be said.
    """
    if np.isfinite(measure).sum() < FEWEST_VALUES:
        return (float(np.nanmean(measure)) if np.isfinite(measure).any() else float("nan")), UNSAID
    window = steady_window(travel, measure)
    return window.mean, window.answer


def steady_start(travel: np.ndarray, measure: np.ndarray) -> float:
    """Return where the window of a measure starts (its unit of travel), 0 where it drifts: then all of it is used."""
    if np.isfinite(measure).sum() < FEWEST_VALUES:
        return 0.0
    window = steady_window(travel, measure)
    return 0.0 if window.answer == DRIFTING else window.start


def row_profiles(
    bins: pd.DataFrame, along: pd.DataFrame, velocities: Mapping[str, float], rows: Sequence[str]
) -> pd.DataFrame:
    """Return the profiles by layer of all runs of some design rows, in display units.

    bins: of all runs, as from `flow_tables`; along: histories, likewise; velocities: of the beds (m/s) by run
    Columns run, row, surface, window_start_mm, window_end_mm, then those of `moving_bins.velocity_profile`. The window
    is that of the relative velocity, all where that drifts. Bins of fewer than LEAST_PARTICLES are left out.
    """
    tables = []
    for row in rows:
        for (run, surface), one in along[along["row"] == row].groupby(["run", "surface"], sort=False):
            history = bins[bins["run"] == run]
            first = steady_start(one["travel_mm"].to_numpy(), one["relative_velocity_percent"].to_numpy())
            start = float(np.floor(first / MILLIMETRES / INTERVAL) * INTERVAL)
            end = float(history["travel_end_m"].max())
            profile = velocity_profile(history, velocities[run], start, end)
            names = {"run": run, "row": row, "surface": surface, "window_start_m": start, "window_end_m": end}
            tables.append(profile[profile["particles"] >= LEAST_PARTICLES].assign(**names)[[*names, *profile]])
    return in_display_units(pd.concat(tables, ignore_index=True))


def study_regimes(histories: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Return run, relative_velocity, surcharge, regime and answer of every run; histories: as from `along_travel`.

    answer: what is said of the relative velocity, see `steady.Window`; steady: whether that is that it is.
    """
    found = {
        run: [settled_value(table["travel_m"], table[name]) for name in ("relative_velocity", "surcharge")]
        for run, table in histories.items()
    }
    velocity = {run: values[0][0] for run, values in found.items()}
    surcharge = {run: values[1][0] for run, values in found.items()}
    answers = [values[0][1] for values in found.values()]
    return regime_table(velocity, surcharge).assign(answer=answers, steady=[each == STEADY for each in answers])


def undisturbed_particles(folder: Path) -> int:
    """Return the number of particles of a run's whole bed at rest; in a travelling window that of its packing."""
    packing = next(iter(cycle_files(folder, PACKING)), None)
    if packing is None:
        return int(pd.read_csv(folder / "cost.csv")["particles"].max())
    with open(packing, encoding="utf-8") as stream:
        return int(next(islice(stream, COUNT_LINE - 1, None)))


def flow_tables(
    folders: Mapping[str, Path], runs: Mapping[str, RunFlow], names: pd.DataFrame
) -> tuple[pd.DataFrame, pd.DataFrame, pd.DataFrame]:
    """Return the bins, the histories along the travel with their regimes, and the regimes of all runs of a study.

    folders, runs: by run; names: run, row and surface of every run
    """
    bins = {run: run_bins(folder, runs[run]) for run, folder in folders.items()}
    histories = {}
    for run, folder in folders.items():
        histories[run] = along_travel(bins[run], runs[run], undisturbed_particles(folder))
    regimes = names.merge(study_regimes(histories), on="run")
    along = pd.concat([table.assign(run=run) for run, table in histories.items()], ignore_index=True)
    along = regimes[["run", "row", "surface", "regime"]].merge(along, on="run")
    percent = 100.0 * along.pop("relative_velocity")
    all_bins = pd.concat([table.assign(run=run) for run, table in bins.items()], ignore_index=True)
    return all_bins, in_display_units(along.assign(relative_velocity_percent=percent)), regimes


def published_window(published: pd.DataFrame, run_in: float) -> tuple[float, float]:
    """Return the source's steady window in a study's travel, which counts from the end of its run-in (all in mm).

    published: quantity, relation and value, as in config/published/screening_results.csv, where the wear settles later
    than the flow, or particle_size_results.csv, where one window is told
    """
    value = published.drop_duplicates(["quantity", "relation"]).set_index(["quantity", "relation"])["value"]
    first = next(name for name in ("wear_gradient_steady", "steady") if (name, "from") in value.index)
    return float(value[first, "from"]) - run_in, float(value["steady", "to"]) - run_in
