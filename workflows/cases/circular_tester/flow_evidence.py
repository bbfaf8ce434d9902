"""What the runs of a circular wear tester say on claims about places of wear, flow and force."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.intervals import estimate
from bulkwear.postproc.statistics.verdicts import Claim
from bulkwear.workflows.cases.circular_tester.distribution import share_of_bumps
from bulkwear.workflows.cases.circular_tester.flow import FORCE, SPIN, STEADINESS, VELOCITY
from bulkwear.workflows.cases.circular_tester.observed import Builder, Evidence, Observed, change, percent, reached
from bulkwear.workflows.cases.circular_tester.packings import PACKING
from bulkwear.workflows.cases.circular_tester.volume import PATTERNED, of_surface

SOURCE_COLUMNS = 5  # of its sample (Fig 6.1)
NAMES = {"velocity_m_per_s": "velocity", "bed_height_m": "bed height", "wear_rate_m3_per_s": "wear rate"}


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
    if reason := _other_columns(share):
        return Evidence(reason=reason, further=_listed(share))
    away = share.columns.to_numpy(float) - share.columns.to_numpy(float).mean()
    slopes = share.to_numpy() @ away / (away @ away)
    return Evidence({"": percent(estimate(slopes * np.ptp(away)))}, further=_listed(share))


def _plain_even(seen: Observed, claim: Claim) -> Evidence:
    share = _columns(seen, PLAIN)
    if reason := _other_columns(share):
        return Evidence(reason=reason, further=_listed(share))
    return Evidence({f"column {k}": estimate(share[k]) for k in share.columns})


def _other_columns(share: pd.DataFrame) -> str:
    """Return why columns are not those of the source, whose claims name five; nothing where they are."""
    count = share.shape[1]
    return "" if count == SOURCE_COLUMNS else f"claimed of {SOURCE_COLUMNS} columns, the sample is told by {count}"


def _listed(share: pd.DataFrame) -> str:
    return "columns over their mean " + ", ".join(f"{value:.2f}" for value in share.mean())


def _outer_bumps(seen: Observed, claim: Claim) -> Evidence:
    odd = seen.bumps[seen.bumps["row"] % 2 == 1].sort_values("part")  # numbered row by row from one side
    of_row = odd.groupby(["row", PACKING])
    at_side = (of_row.cumcount() == 0) | (of_row.cumcount(ascending=False) == 0)
    outer, inner = (each.groupby(["row", PACKING])["volume_mm3"].mean() for each in (odd[at_side], odd[~at_side]))
    ratio = (outer / inner).dropna()
    if ratio.empty:
        return Evidence(reason="no bump between those at the sides")
    return Evidence({f"column {row}": estimate(each, log=True) for row, each in ratio.groupby("row")})


def _bump_volumes(odd: bool) -> Builder:
    """Return what finds the least and the largest volume that a bump of the odd or of the even columns has lost, at the
    source's wear coefficient.
    """

    def found(seen: Observed, claim: Claim) -> Evidence:
        of_packing = seen.bumps[seen.bumps["row"] % 2 == int(odd)].groupby(PACKING)["volume_mm3"]
        ends = {"least": of_packing.min(), "largest": of_packing.max()}
        reach = reached(of_surface(seen.of_main(seen.increments), PATTERNED))
        estimates = {name: estimate(each / seen.times_source, log=True) for name, each in ends.items()}
        return Evidence(estimates, reach, "" if seen.times_source == 1.0 else "told at the source's wear coefficient")

    return found


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
    ends = [reached(rows) for _, rows in means[means["measure"].isin(STEADINESS)].groupby("measure")]
    found = found if any(np.isfinite(each.value) for each in found.values()) else {}
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
        return Evidence({"": change(rows, "mean", claim.reach)}, reached(rows))

    return found


ON_FLOW: Mapping[str, Builder] = {
    "bump_share": _bump_share,
    "first_column": _first_column,
    "plain_columns": _plain_columns,
    "plain_even": _plain_even,
    "outer_bumps": _outer_bumps,
    "odd_bumps": _bump_volumes(odd=True),
    "even_bumps": _bump_volumes(odd=False),
    "steady": _steady,
    "spin": _over_plain(SPIN),
    "spin_falls": _falls(SPIN),
    "velocity": _over_plain(VELOCITY),
    "force": _over_plain(FORCE),
    "force_falls": _falls(FORCE),
}
