"""Which findings of Yan 2022, chapter 6, the runs of a circular wear tester confirm, with the numbers that decide.

Verdicts are those of `postproc.statistics.verdicts`, keys those of config/published/circular_tester_findings.csv.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.stats import linregress

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.verdicts import CONFIRMED, REFUTED, UNSAID, Verdict
from bulkwear.postproc.tables.summary import patterned_name
from bulkwear.workflows.cases.circular_tester.comparison import mean_ratios
from bulkwear.workflows.cases.circular_tester.distribution import share_of_bumps
from bulkwear.workflows.cases.circular_tester.flow import FORCE, SPIN, VELOCITY
from bulkwear.workflows.cases.circular_tester.volume import CONVEX, PATTERNED, SURE, TERMS, of_surface, volume_at

LEAST_R_SQUARED = 0.99
SIZE_SPREAD = 0.14  # -, largest from smallest of the plain sample's volumes over particle scales, Fig 6.10
MESH_SPREAD = 3.0  # %, deviation over meshes, Fig 6.8: 1.8 and 2.8
STEADY_FROM = 6.0  # revolutions, Fig 6.7
OF_ANY_PATTERN = ("plain_linear", "plain_sizes", "plain_columns", "steady", "mesh_size", "machines")  # findings
FEW_REVOLUTIONS = 3  # with fewer a trend or R2 says nothing


@dataclass(frozen=True, eq=False)
class Evidence:
    """What the runs found.

    fits: one plain run and one with a pattern per particle scale, as from `volume.volume_fits`
    predictions, crossings, ratios: as from `volume.predictions`, `tables.crossings`, `comparison.ratios_by_revolution`
    columns, bumps: wear by column of the pair of runs with `surface`, and by bump of the one with a pattern
    means: of spin, velocity and force per revolution of wear of the pair, as from `flow.flow_means`
    steady: of them, as from `flow.steady_revolutions`
    meshes: as from `distribution.mesh_size_effect`, None without a series of meshes
    worn_out: as from `comparison.worn_out_at`, None without a pattern that is worn right off
    main: particle scale of the pair; short, long: hours of the tests
    """

    fits: pd.DataFrame
    predictions: pd.DataFrame
    crossings: pd.DataFrame
    ratios: pd.DataFrame
    columns: pd.DataFrame
    bumps: pd.DataFrame
    means: pd.DataFrame
    steady: pd.DataFrame
    meshes: pd.DataFrame | None
    worn_out: pd.DataFrame | None
    main: float
    short: float
    long: float

    @property
    def patterned(self) -> str:
        """The surface that is set beside the plain one, for the source's convex one."""
        return patterned_name(self.columns["surface"])


def findings_table(evidence: Evidence, published: pd.DataFrame) -> pd.DataFrame:
    """Return key, finding, source, found, verdict and reason (or reserve) of every published finding."""
    verdicts = [_judged(key, evidence) for key in published["key"]]
    return published.assign(
        found=[each.found for each in verdicts],
        verdict=[each.verdict for each in verdicts],
        reason=[each.reason for each in verdicts],
    )


def _judged(key: str, evidence: Evidence) -> Verdict:
    """Return the verdict on a finding; of the source's convex sample nothing can be said by another pattern."""
    verdict = TESTS[key](evidence)
    if evidence.patterned == CONVEX or key in OF_ANY_PATTERN:
        return verdict
    return Verdict(verdict.found, UNSAID, f"found of a {evidence.patterned} sample, the source's is {CONVEX}")


def _verdict(found: str, holds: object, reason: str = "") -> Verdict:
    """Return whether a finding holds; with a reason it cannot be said."""
    return Verdict(found, UNSAID, reason) if reason else Verdict(found, CONFIRMED if holds else REFUTED)


def _fit(evidence: Evidence, surface: str, order: str) -> pd.Series:
    fits = of_surface(evidence.fits, surface)
    return fits[(fits["fit"] == order) & np.isclose(fits["particle_scale"], evidence.main)].iloc[0]


def _too_few(row: pd.Series) -> str:
    few = row["revolutions"] < FEW_REVOLUTIONS
    return f"{row['revolutions']:.3g} revolutions, at least {FEW_REVOLUTIONS} are needed" if few else ""


def _plain_linear(evidence: Evidence) -> Verdict:
    line, curve = _fit(evidence, PLAIN, "linear"), _fit(evidence, PLAIN, "quadratic")
    found = f"R² {line['r_squared']:.5f} over {line['revolutions']:.3g} revolutions; {_curvature(curve)}"
    return _verdict(found, line["r_squared"] > LEAST_R_SQUARED, _too_few(line))


def _curvature(curve: pd.Series) -> str:
    """Say what the quadratic term adds at the run's end, and its standard errors from zero."""
    terms, last = curve[TERMS].to_numpy(float), curve["revolutions"]
    share = 100.0 * terms[1] * last**2 / float(volume_at(terms, last))
    sure = "" if curve["curved"] else f", within {SURE:g} standard errors of none"
    return f"curvature makes {share:+.2g} % of the last volume{sure}"


def _convex_quadratic(evidence: Evidence) -> Verdict:
    curve = _fit(evidence, PATTERNED, "quadratic")
    quadratic, error = curve[TERMS[1]], curve[f"{TERMS[1]}_error"]
    found = f"{quadratic:.2g} ± {error:.2g} mm³ per revolution²; {_curvature(curve)}"
    return _verdict(found, curve["curved"] and quadratic > 0.0, _too_few(curve))


def _less(evidence: Evidence, hours: float) -> Verdict:
    of = of_surface(evidence.predictions, PATTERNED)
    of = of[np.isclose(of["hours"], hours)]
    row = of[np.isclose(of["particle_scale"], evidence.main)].iloc[0]
    words = f"{row['reduction_percent']:.3g} % less after {row['revolution']:.3g} revolutions"
    holds = row["reduction_percent"] > 0.0
    reserve = "beyond the simulated revolutions" if row["extrapolated"] else ""
    return Verdict(words, CONFIRMED if holds else REFUTED, reserve)


def _volumes(evidence: Evidence, surface: str) -> pd.Series:
    """Volumes (mm3) after the short test by particle scale, in rising order."""
    of = of_surface(evidence.predictions, surface)
    return of[np.isclose(of["hours"], evidence.short)].groupby("particle_scale")["volume_mm3"].mean().sort_index()


def _by_size(evidence: Evidence, surface: str, holds: Callable[[pd.Series], object]) -> Verdict:
    volumes = _volumes(evidence, surface)
    found = ", ".join(f"scale {scale:g}: {volume:.4g} mm³" for scale, volume in volumes.items())
    return _verdict(found, holds(volumes), "one particle scale only" if len(volumes) < 2 else "")


def _overtakes(evidence: Evidence) -> Verdict:
    table = evidence.crossings
    found = ", ".join(
        f"scale {row.particle_scale:g}: "
        + (f"faster from revolution {row.rate_crossing:.3g}" if np.isfinite(row.rate_crossing) else "never by the fits")
        for row in table.itertuples()
    )
    first, last = table["rate_crossing"].min(), evidence.fits["revolutions"].max()
    reserve = "beyond the simulated revolutions" if last < first < np.inf else ""
    late = None if evidence.worn_out is None else evidence.worn_out.dropna(subset="faster_revolution")
    if late is not None and len(late) and not np.isfinite(first):
        row = late.loc[late["faster_revolution"].idxmin()]
        found += f"; worn right off, first faster at revolution {row['faster_revolution']:.3g}"
        return Verdict(found, CONFIRMED, f"only when {100.0 * row['faster_share']:.2g} % of the pattern are left")
    return Verdict(found, CONFIRMED if np.isfinite(first) else REFUTED, reserve)


def _bump_share(evidence: Evidence) -> Verdict:
    share = share_of_bumps(of_surface(evidence.columns, PATTERNED)).iloc[0]
    return _verdict(f"{100.0 * share:.3g} %", share > 0.5)


def _total_by_column(evidence: Evidence, surface: str) -> pd.Series:
    of = of_surface(evidence.columns, surface).set_index("column")
    return of["base_mm3"] + of["bumps_mm3"]


def _listed(values: pd.Series, unit: str) -> str:
    return ", ".join(f"{value:.3g}" for value in values) + f" {unit}"


def _first_column(evidence: Evidence) -> Verdict:
    total = _total_by_column(evidence, PATTERNED)
    return _verdict(_listed(total, "mm³"), total.idxmax() == 1)


def _plain_columns(evidence: Evidence) -> Verdict:
    total = _total_by_column(evidence, PLAIN)
    return _verdict(_listed(total, "mm³"), total.is_monotonic_increasing)


def _outer_bumps(evidence: Evidence) -> Verdict:
    odd = evidence.bumps[evidence.bumps["row"] % 2 == 1].sort_values("bump")
    of_row = odd.groupby("row")
    at_side = (of_row.cumcount() == 0) | (of_row.cumcount(ascending=False) == 0)
    outer, inner = odd[at_side]["volume_mm3"], odd[~at_side]["volume_mm3"]
    found = f"mean {outer.mean():.3g} mm³ at the sides" + (f", {inner.mean():.3g} mm³ between" if len(inner) else "")
    return _verdict(found, outer.mean() > inner.mean(), "" if len(inner) else "no bump between those at the sides")


def _steady(evidence: Evidence) -> Verdict:
    table = evidence.steady[evidence.steady["measure"] == "all"]
    found = ", ".join(
        f"{row.surface}: " + (f"from {row.start:.2g}" if row.steady else "not steady") for row in table.itertuples()
    )
    return _verdict(found, (table["steady"] & (table["start"] <= STEADY_FROM)).all())


def _flow(evidence: Evidence, measure: str, above: bool, falls: bool) -> Verdict:
    """Whether patterned lies above (or below) plain in the mean, and falls, surely by a straight line."""
    table = evidence.means[evidence.means["measure"] == measure].sort_values("revolution")
    plain, own = (of_surface(table, surface) for surface in (PLAIN, PATTERNED))
    mean = own["mean"].to_numpy()
    ratio = mean.mean() / plain["mean"].to_numpy().mean()
    found = f"{evidence.patterned} over plain {ratio:.3g}"
    holds = (ratio > 1.0) == above
    if not falls:
        return _verdict(found, holds)
    if len(own) < FEW_REVOLUTIONS:
        return _verdict(found, holds, f"at least {FEW_REVOLUTIONS} revolutions are needed")
    revolution = own["revolution"].to_numpy()
    line = linregress(revolution, mean)
    change, error = (100.0 * each * np.ptp(revolution) / mean.mean() for each in (line.slope, line.stderr))
    found += f"; {evidence.patterned} over its revolutions {change:+.2g} ± {error:.2g} %"
    return _verdict(found, holds and change < -SURE * error)


def _mesh_size(evidence: Evidence) -> Verdict:
    if evidence.meshes is None:
        return Verdict("", UNSAID, "no series of meshes")
    spread = evidence.meshes.groupby("surface")["deviation_percent"].first()
    found = ", ".join(f"{surface}: {value:.2g} %" for surface, value in spread.items())
    return _verdict(found, (spread <= MESH_SPREAD).all())


def _machines(evidence: Evidence) -> Verdict:
    """Reductions of ring and channel with the same particles, over the revolutions that both have."""
    counts = evidence.ratios.groupby("particle_scale")["shape"].nunique()
    both = counts[counts > 1].index
    if both.empty:
        return Verdict("", UNSAID, "no ring beside a channel of the same particles")
    means = mean_ratios(evidence.ratios[evidence.ratios["particle_scale"] == both[0]], shared=True).set_index("shape")
    found = ", ".join(
        f"{shape}: {row['reduction_percent']:.3g} ± {100.0 * row['standard_error']:.2g} %"
        for shape, row in means.iterrows()
    )
    error = float(np.sqrt((means["standard_error"] ** 2).sum()))
    apart = float(np.ptp(means["ratio"]))
    few = "" if np.isfinite(means["standard_error"]).all() else "one revolution has no standard error"
    return _verdict(f"{found}; {100.0 * apart:.2g} ± {100.0 * error:.2g} points apart", apart <= SURE * error, few)


TESTS: Mapping[str, Callable[[Evidence], Verdict]] = {
    "plain_linear": _plain_linear,
    "convex_quadratic": _convex_quadratic,
    "less_short": lambda each: _less(each, each.short),
    "less_long": lambda each: _less(each, each.long),
    "plain_sizes": lambda each: _by_size(
        each, PLAIN, lambda volumes: volumes.max() - volumes.min() <= SIZE_SPREAD * volumes.max()
    ),
    "convex_sizes": lambda each: _by_size(each, PATTERNED, lambda volumes: volumes.is_monotonic_increasing),
    "overtakes": _overtakes,
    "bump_share": _bump_share,
    "first_column": _first_column,
    "plain_columns": _plain_columns,
    "outer_bumps": _outer_bumps,
    "steady": _steady,
    "spin": lambda each: _flow(each, SPIN, True, True),
    "velocity": lambda each: _flow(each, VELOCITY, False, False),
    "force": lambda each: _flow(each, FORCE, True, True),
    "mesh_size": _mesh_size,
    "machines": _machines,
}
