"""What the runs of a circular wear tester did, as findings need it, and how evidence on a claim is told.

Trends are those of increments and of means per revolution, never of what adds up. Two samples of one packing share
their bed: they are divided and subtracted before anything is averaged.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.increments import BLOCKS, rate_trend
from bulkwear.postproc.statistics.intervals import Estimate
from bulkwear.postproc.statistics.verdicts import Claim
from bulkwear.postproc.tables.summary import patterned_name
from bulkwear.workflows.cases.circular_tester.packings import PACKING, of_several
from bulkwear.workflows.cases.circular_tester.volume import SETTING

PERCENT = 100.0


@dataclass(frozen=True, eq=False)
class Observed:
    """What the runs of a study did, all packings.

    lost: as from `volume.volumes`; increments, ratios: as from `volume.element_increments` and
    `comparison.ratios_by_revolution`, at whole revolutions of series volume, size and ring
    columns: as from `distribution.wear_by_column`, with surface and packing, of series volume; bumps: as from
    `wear_by_bump`, with packing
    means, steady_means: as from `flow.revolution_means`, of revolutions of wear and of the bed
    hours_per_revolution: as from `hours.time_scale`
    shape, scale: of the machine and the particles of series volume
    meshes: as from `distribution.volumes_of_meshes`, None without a series of meshes
    worn_out: as from `comparison.worn_out_at`, None without a pattern that is worn right off
    foreign: {surface: why it is not the source's}, as from `source.unlike_source`
    times_source: wear coefficient over the source's, as from `volume.times_source`
    """

    lost: pd.DataFrame
    increments: pd.DataFrame
    ratios: pd.DataFrame
    columns: pd.DataFrame
    bumps: pd.DataFrame
    means: pd.DataFrame
    steady_means: pd.DataFrame
    hours_per_revolution: float
    shape: str
    scale: float
    meshes: pd.DataFrame | None = None
    worn_out: pd.DataFrame | None = None
    foreign: Mapping[str, str] = field(default_factory=dict)
    times_source: float = 1.0

    @property
    def patterned(self) -> str:
        """The surface that is set beside the plain one, for the source's convex one."""
        return patterned_name(self.columns["surface"])

    def of_main(self, table: pd.DataFrame) -> pd.DataFrame:
        """The rows of a table that belong to the machine and the particles of series volume."""
        return table[(table["shape"] == self.shape) & (table["particle_scale"] == self.scale)]

    def of_sizes(self, table: pd.DataFrame) -> pd.DataFrame:
        """The rows of a table that belong to that machine with particles of any size."""
        return table[table["shape"] == self.shape]


@dataclass(frozen=True)
class Evidence:
    """What was found on a claim.

    found: estimates by name, "" for the only one; covers: (low, high) of the range that the runs have
    further: words besides the estimates'; reason: why nothing can be said, whatever the estimates
    """

    found: Mapping[str, Estimate] = field(default_factory=dict)
    covers: tuple[float, float] | None = None
    further: str = ""
    reason: str = ""


Builder = Callable[[Observed, Claim], Evidence]  # the claim says the range, estimates are in its unit


def change(rows: pd.DataFrame, value: str, reach: tuple[float, float]) -> Estimate:
    """Return how a value per revolution changes (%) within a range of revolutions, by a straight line, over its mean.

    rows: of one setting: PACKING, revolution, end (of the revolution), value. Taken over the part of the range that all
    packings have, trend by trend.
    """
    rows = rows[(rows["revolution"] >= reach[0]) & (rows["end"] <= reach[1])].dropna(subset=value)
    if rows.empty:
        return Estimate(np.nan, np.nan, 0, 0)
    rows = rows[rows["end"] <= rows.groupby(PACKING)["end"].max().min()].sort_values([PACKING, "revolution"])
    blocks = rows.rename(columns={"revolution": "start"})
    blocks["increment"] = blocks[value] * (blocks["end"] - blocks["start"])
    blocks["cumulated"] = blocks.groupby(PACKING)["increment"].cumsum()
    return percent(of_several(rate_trend(blocks[BLOCKS]).change))


def percent(found: Estimate) -> Estimate:
    """Return an estimate of a share in percent."""
    return replace(found, value=PERCENT * found.value, error=PERCENT * found.error)


def reached(rows: pd.DataFrame) -> tuple[float, float]:
    """Return the first and the last revolution that all runs of a table have."""
    ends = rows.groupby([name for name in (*SETTING, PACKING) if name in rows])
    return float(ends["revolution"].min().max()), float(ends["end"].max().min())
