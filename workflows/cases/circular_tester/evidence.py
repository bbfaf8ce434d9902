"""What the runs of a circular wear tester say on each claim of config/published/verdicts.yaml, estimated over packings.

A builder takes what was observed and the claim, for its range, and returns estimates in the claim's unit. Trends are
those of increments and of means per revolution, never of what adds up. Two samples of one packing share their bed:
they are divided and subtracted before anything is averaged.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.increments import BLOCKS, rate_trend
from bulkwear.postproc.statistics.intervals import Estimate, difference, estimate
from bulkwear.postproc.statistics.verdicts import Claim
from bulkwear.postproc.tables.summary import patterned_name
from bulkwear.workflows.cases.circular_tester.comparison import ratio_of_sums, shared_ratios
from bulkwear.workflows.cases.circular_tester.decks import CHANNEL, RING
from bulkwear.workflows.cases.circular_tester.distribution import on_finest_mesh, share_of_bumps
from bulkwear.workflows.cases.circular_tester.flow import FORCE, SPIN, STEADINESS, VELOCITY
from bulkwear.workflows.cases.circular_tester.packings import PACKING, estimates_by, of_several
from bulkwear.workflows.cases.circular_tester.runs import SIZE, VOLUME
from bulkwear.workflows.cases.circular_tester.volume import (
    PATTERNED,
    SETTING,
    chosen,
    of_surface,
    settings_of,
    shared_revolutions,
    volumes_at,
)

PERCENT = 100.0
NAMES = {"velocity_m_per_s": "velocity", "bed_height_m": "bed height", "wear_rate_m3_per_s": "wear rate"}
OVERTAKING_SCALE = 4.0  # particle scale of which the source says it
EXTRAPOLATED = "extrapolated"


@dataclass(frozen=True, eq=False)
class Observed:
    """What the runs of a study did, all packings.

    lost: as from `volume.volumes`; increments, ratios: as from `volume.element_increments` and
    `comparison.ratios_by_revolution`, at whole revolutions of series volume, size and ring
    columns: as from `distribution.wear_by_column`, with surface and packing, of series volume; bumps: as from
    `wear_by_bump`, with packing
    means, steady_means: as from `flow.revolution_means`, of revolutions of wear and of the bed
    hours_per_revolution: as from `hours.time_scale`; short, long: hours of the tests
    shape, scale: of the machine and the particles of series volume
    meshes: as from `distribution.volumes_of_meshes`, None without a series of meshes
    worn_out: as from `comparison.worn_out_at`, None without a pattern that is worn right off
    """

    lost: pd.DataFrame
    increments: pd.DataFrame
    ratios: pd.DataFrame
    columns: pd.DataFrame
    bumps: pd.DataFrame
    means: pd.DataFrame
    steady_means: pd.DataFrame
    hours_per_revolution: float
    short: float
    long: float
    shape: str
    scale: float
    meshes: pd.DataFrame | None = None
    worn_out: pd.DataFrame | None = None

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


Builder = Callable[[Observed, Claim], Evidence]


# ---------------------------------------------------------------- rates and their changes


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


def _reached(rows: pd.DataFrame) -> tuple[float, float]:
    """Return the first and the last revolution that all runs of a table have."""
    ends = rows.groupby([name for name in (*SETTING, PACKING) if name in rows])
    return float(ends["revolution"].min().max()), float(ends["end"].max().min())


def _plain_linear(seen: Observed, claim: Claim) -> Evidence:
    rows = of_surface(seen.of_main(seen.increments), PLAIN)
    return Evidence({"": change(rows, "increment_mm3", claim.reach)}, _reached(rows))


def _convex_quadratic(seen: Observed, claim: Claim) -> Evidence:
    rows = of_surface(seen.of_sizes(seen.increments), PATTERNED)
    found = {
        f"scale {scale:g}": change(each, "increment_mm3", claim.reach)
        for scale, each in rows.sort_values("particle_scale").groupby("particle_scale")
    }
    return Evidence(found, _reached(rows))


def _overtakes(seen: Observed, claim: Claim) -> Evidence:
    ratios = seen.of_sizes(seen.ratios)
    of_scales = ratios.sort_values("particle_scale").groupby("particle_scale")
    last = ", ".join(f"scale {scale:g}: {_last_ratio(each)}" for scale, each in of_scales)
    further = "; ".join(filter(None, (last, _worn_out_words(seen.worn_out))))
    rows = ratios[np.isclose(ratios["particle_scale"], OVERTAKING_SCALE)]
    if rows.empty:
        reason = f"claimed of particle scale {OVERTAKING_SCALE:g}, which no pair of runs has"
        return Evidence(further=further, reason=reason)
    inside = rows[(rows["revolution"] >= claim.reach[0]) & (rows["end"] <= claim.reach[1])]
    found = {"": ratio_of_sums(inside)} if len(inside) else {}
    return Evidence(found, _reached(rows), further)


def _last_ratio(ratios: pd.DataFrame) -> str:
    """Return patterned over plain in the last revolution of a machine in words."""
    shared = shared_ratios(ratios)
    last = shared[shared["revolution"] == shared["revolution"].max()]
    return f"{ratio_of_sums(last).text()} in revolution {last['end'].iloc[0]:g}"


def _worn_out_words(worn_out: pd.DataFrame | None) -> str:
    """Return when patterns that are worn right off come to lose more than plain."""
    if worn_out is None:
        return ""
    rows = worn_out.dropna(subset="faster_revolution")
    if rows.empty:
        return "worn right off, never faster"
    told = [
        f"{row.faster_revolution:.3g} ({PERCENT * row.faster_share:.2g} % of the pattern left)"
        for row in rows.itertuples()
    ]
    return f"worn right off, first faster at revolution {', '.join(told)}"


# ---------------------------------------------------------------- hours, sizes, machines


def _less(seen: Observed, claim: Claim) -> Evidence:
    """Return patterned over plain, lost between the hours of the claim's range."""
    rows = seen.of_main(chosen(seen.lost, VOLUME))
    ends = [hours / seen.hours_per_revolution for hours in claim.reach]
    first, last = ([volumes_at(of_surface(rows, each), end) for each in (PATTERNED, PLAIN)] for end in ends)
    ratio = ((last[0] - first[0]) / (last[1] - first[1])).dropna()
    found = {"": estimate(ratio, log=True)} if len(ratio) else {}
    reached = shared_revolutions(rows) * seen.hours_per_revolution
    return Evidence(found, (0.0, reached), f"{EXTRAPOLATED} beyond {reached:.3g} h" if reached < claim.reach[1] else "")


def _scales(seen: Observed, surface: str) -> dict[float, Estimate]:
    """Return the volume that a surface loses over the revolutions which all particle scales have, by scale."""
    rows = of_surface(seen.of_sizes(chosen(seen.lost, VOLUME, SIZE)), surface)
    if rows.empty:
        return {}
    last = shared_revolutions(rows)
    found = {each["particle_scale"]: estimate(volumes_at(of, last), log=True) for each, of in settings_of(rows)}
    return dict(sorted(found.items()))


def _by_size(seen: Observed, surface: str, every: bool) -> Evidence:
    """Return the volume at each particle scale over that at every smaller one, or at the next smaller one."""
    volumes = _scales(seen, surface)
    if len(volumes) < 2:
        return Evidence(reason="one particle scale only")
    scales = list(volumes)
    pairs = [(low, high) for low in scales for high in scales if low < high] if every else list(pairwise(scales))
    found = {f"scale {high:g} over {low:g}": difference(volumes[high], volumes[low]) for low, high in pairs}
    return Evidence(found, (scales[0], scales[-1]))


def _machines(seen: Observed, claim: Claim) -> Evidence:
    """Return patterned over plain in the ring over the same in the channel, over the revolutions that both have."""
    counts = seen.ratios.groupby("particle_scale")["shape"].nunique()
    both = counts[counts > 1].index
    if both.empty:
        return Evidence(reason="no ring beside a channel of the same particles")
    rows = shared_ratios(seen.ratios[seen.ratios["particle_scale"] == both[0]])
    of = {shape: ratio_of_sums(each) for shape, each in rows.groupby("shape")}
    further = ", ".join(f"{shape} {found.text()}" for shape, found in of.items())
    return Evidence({"": difference(of[RING], of[CHANNEL])}, further=further)


def _mesh_size(seen: Observed, claim: Claim) -> Evidence:
    if seen.meshes is None:
        return Evidence(reason="no series of meshes")
    found = {
        f"{surface}, {size:g} mm": each
        for (surface, size), each in estimates_by(
            on_finest_mesh(seen.meshes), ["surface", "element_size_mm"], "ratio", log=True
        ).items()
    }
    sizes = seen.meshes["element_size_mm"]
    return Evidence(found, (float(sizes.min()), float(sizes.max())))


# ---------------------------------------------------------------- where it wears


def _columns(seen: Observed, surface: str) -> pd.DataFrame:
    """Return wear of each column (columns) in each packing (rows) over that packing's mean column."""
    rows = of_surface(seen.columns, surface)
    rows = rows.assign(total=rows["base_mm3"] + rows["bumps_mm3"])
    table = rows.pivot(index=PACKING, columns="column", values="total")
    return table.div(table.mean(axis=1), axis=0)


def _bump_share(seen: Observed, claim: Claim) -> Evidence:
    return Evidence({"": percent(share_of_bumps(seen.columns))})


def _first_column(seen: Observed, claim: Claim) -> Evidence:
    share = _columns(seen, PATTERNED)
    found = {f"column {k}": percent(estimate(share[1] - share[k])) for k in share.columns[1:]}
    return Evidence(found, further=_listed(share))


def _plain_columns(seen: Observed, claim: Claim) -> Evidence:
    share = _columns(seen, PLAIN)
    away = share.columns.to_numpy(float) - share.columns.to_numpy(float).mean()
    slopes = share.to_numpy() @ away / (away @ away)
    return Evidence({"": percent(estimate(slopes * np.ptp(away)))}, further=_listed(share))


def _plain_even(seen: Observed, claim: Claim) -> Evidence:
    share = _columns(seen, PLAIN)
    return Evidence({f"column {k}": estimate(share[k]) for k in share.columns})


def _listed(share: pd.DataFrame) -> str:
    return "columns over their mean " + ", ".join(f"{value:.2f}" for value in share.mean())


def _outer_bumps(seen: Observed, claim: Claim) -> Evidence:
    odd = seen.bumps[seen.bumps["row"] % 2 == 1].sort_values("bump")
    of_row = odd.groupby(["row", PACKING])
    at_side = (of_row.cumcount() == 0) | (of_row.cumcount(ascending=False) == 0)
    outer, inner = (each.groupby(["row", PACKING])["volume_mm3"].mean() for each in (odd[at_side], odd[~at_side]))
    ratio = (outer / inner).dropna()
    if ratio.empty:
        return Evidence(reason="no bump between those at the sides")
    return Evidence({f"column {row}": estimate(each, log=True) for row, each in ratio.groupby("row")})


# ---------------------------------------------------------------- flow


def _by_number(means: pd.DataFrame) -> pd.DataFrame:
    """Return means per revolution with the revolution's start and end for its number."""
    return means.assign(end=means["revolution"].astype(float), revolution=means["revolution"] - 1.0)


def _steady(seen: Observed, claim: Claim) -> Evidence:
    """Return the change of every measure of every surface from the claimed revolution on."""
    means = _by_number(seen.steady_means)
    reach = (claim.reach[0], np.inf)
    found = {
        f"{surface}, {NAMES[measure]}": change(rows, "mean", reach)
        for measure in STEADINESS
        for surface, rows in means[means["measure"] == measure].groupby("surface")
    }
    ends = [_reached(rows) for _, rows in means[means["measure"].isin(STEADINESS)].groupby("measure")]
    return Evidence(found, (max(first for first, _ in ends), min(last for _, last in ends)))


def _over_plain(measure: str) -> Builder:
    """Return what finds a measure of the patterned sample over that of the plain one, mean of their revolutions."""

    def found(seen: Observed, claim: Claim) -> Evidence:
        rows = seen.means[seen.means["measure"] == measure]
        keys = [PACKING, "revolution"]
        both = of_surface(rows, PLAIN).merge(of_surface(rows, PATTERNED), on=keys, suffixes=("_plain", "_patterned"))
        sums = both.groupby(PACKING)[["mean_patterned", "mean_plain"]].mean()
        return Evidence({"": estimate(sums["mean_patterned"] / sums["mean_plain"], log=True)})

    return found


def _falls(measure: str) -> Builder:
    """Return what finds the change of a measure over the patterned sample."""

    def found(seen: Observed, claim: Claim) -> Evidence:
        rows = of_surface(_by_number(seen.means[seen.means["measure"] == measure]), PATTERNED)
        return Evidence({"": change(rows, "mean", claim.reach)}, _reached(rows))

    return found


BUILDERS: Mapping[str, Builder] = {
    "plain_linear": _plain_linear,
    "convex_quadratic": _convex_quadratic,
    "less_short": _less,
    "less_long": _less,
    "plain_sizes": lambda seen, claim: _by_size(seen, PLAIN, every=True),
    "convex_sizes": lambda seen, claim: _by_size(seen, PATTERNED, every=False),
    "overtakes": _overtakes,
    "bump_share": _bump_share,
    "first_column": _first_column,
    "plain_columns": _plain_columns,
    "plain_even": _plain_even,
    "outer_bumps": _outer_bumps,
    "steady": _steady,
    "spin": _over_plain(SPIN),
    "spin_falls": _falls(SPIN),
    "velocity": _over_plain(VELOCITY),
    "force": _over_plain(FORCE),
    "force_falls": _falls(FORCE),
    "mesh_size": _mesh_size,
    "machines": _machines,
}
