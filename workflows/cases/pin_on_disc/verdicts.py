"""What runs of pins on discs say of the source's findings, claim by claim (config/published/verdicts.yaml).

There is no bed and no packing: every run is made once. Intervals are of the run that was simulated, from what its
revolutions scatter by; they say how sure its own trend is, and nothing of discs that were not simulated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.change_point import ENDED, NOT_ENDED, run_in
from bulkwear.postproc.statistics.increments import RateTrend, blocks_of, rate_trend
from bulkwear.postproc.statistics.intervals import Ends, Estimate, difference
from bulkwear.postproc.statistics.steady import relative_drift
from bulkwear.postproc.statistics.verdicts import Claim, Verdict, judged, not_said
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES, MILLIMETRES
from bulkwear.workflows.cases.pin_on_disc.run_in import revolution_series
from bulkwear.workflows.cases.pin_on_disc.runs import same_coefficient
from bulkwear.workflows.cases.pin_on_disc.volume import law_volume, volume_trend

READINGS = (("per_triangle", "Eq 5.9, touched"), ("per_triangle", "removed"), ("conserving", "removed"))
CALIBRATED, REFERENCE = 1.7e-11, 5e-11  # 1/Pa, of the claims
PERCENT = 100.0
COLUMNS = ["key", "finding", "claim", "of", "found", "verdict", "reason", "factor", "source"]
Found = Estimate | Ends | None


@dataclass(frozen=True)
class Tables:
    """What a study has: volumes: of the coefficients' runs; statistics: of contours by revolution, of the reference
    runs, with scheme; meshes: as from `comparison.mesh_series`. Any may be empty.
    """

    volumes: pd.DataFrame
    statistics: pd.DataFrame
    meshes: pd.DataFrame


@dataclass(frozen=True)
class Seen:
    """What one run says of a claim: of: which; found: None where there is none; covers: revolutions; reason, words."""

    of: str
    found: Found
    covers: tuple[float, float] | None = None
    reason: str = ""
    words: str = ""


def verdict_table(tables: Tables, claims: Mapping[str, Claim]) -> pd.DataFrame:
    """Return COLUMNS, a row per claim and run or reading that it can be asked of; factor: found over published size."""
    rows = []
    for key, claim in claims.items():
        for seen in EVIDENCE[key](tables, claim):
            verdict = _verdict(claim, seen)
            said = (verdict.found, verdict.verdict, verdict.reason, verdict.factor)
            rows.append((key, claim.finding, claim.words, seen.of, *said, claim.source))
    return pd.DataFrame(rows, columns=COLUMNS)


def _verdict(claim: Claim, seen: Seen) -> Verdict:
    if seen.found is None:
        return not_said(seen.reason or "no such run", seen.words)
    words = seen.words or seen.found.text(unit="" if claim.unit == "-" else claim.unit)
    return judged(claim, seen.found, words, seen.covers)


# ---------------------------------------------------------------- volume


def _volumes(coefficient: float, quantity: Callable[[RateTrend, pd.DataFrame], Estimate]):
    """Return the evidence of each reading of the volume of a coefficient."""

    def evidence(tables: Tables, claim: Claim) -> Iterator[Seen]:
        for scheme, volume in READINGS:
            trend, rows = _trend(tables.volumes, scheme, volume, coefficient, claim)
            name = f"{scheme.replace('_', ' ')}, {volume}"
            yield Seen(name, None) if trend is None else Seen(name, quantity(trend, rows), _covered(rows))

    return evidence


def _trend(
    volumes: pd.DataFrame, scheme: str, volume: str, coefficient: float, claim: Claim
) -> tuple[RateTrend | None, pd.DataFrame]:
    """Return the trend of a volume over the claimed revolutions, and the rows that it is of."""
    rows = same_coefficient(volumes[volumes["scheme"] == scheme], coefficient)
    rows = rows[rows["run"].isin(rows["run"].head(1)) & (rows["revolution"] <= claim.reach[1])]
    return (None, rows) if rows.empty else (volume_trend(rows, volume), rows)


def _covered(rows: pd.DataFrame) -> tuple[float, float]:
    return 0.0, float(rows["revolution"].max())


def _change(trend: RateTrend, _: pd.DataFrame) -> Estimate:
    return scaled(trend.change, PERCENT)


def _excess(trend: RateTrend, rows: pd.DataFrame) -> Estimate:
    """Return what a revolution adds over alpha F L of a revolution."""
    fixed = (rows[name].iloc[0] for name in ("wear_coefficient_per_pa", "load_n", "track_radius_m"))
    return scaled(trend.rate, 1.0 / (CUBIC_MILLIMETRES * float(law_volume(*fixed, 1.0))))


def scaled(one: Estimate, factor: float) -> Estimate:
    """Return an estimate in another unit."""
    return Estimate(factor * one.value, abs(factor) * one.error, one.freedom, one.packings, one.log)


def _curved_more(tables: Tables, claim: Claim) -> Iterator[Seen]:
    """Yield by how much more the volume bends at the reference than at the calibrated coefficient."""
    for scheme, volume in READINGS:
        name = f"{scheme.replace('_', ' ')}, {volume}"
        (more, rows), (less, others) = (
            _trend(tables.volumes, scheme, volume, each, claim) for each in (REFERENCE, CALIBRATED)
        )
        if more is None or less is None:
            yield Seen(name, None)
            continue
        covers = min(_covered(rows), _covered(others))
        yield Seen(name, difference(_change(more, rows), _change(less, others)), covers)


# ---------------------------------------------------------------- contours


def _growth(size: str):
    """Return the evidence of how the mean of a size grows from revolution to revolution."""

    def evidence(tables: Tables, claim: Claim) -> Iterator[Seen]:
        of_size = tables.statistics[tables.statistics["size"] == size]
        for scheme, rows in of_size.groupby("scheme", sort=False):
            rows = rows[rows["revolution"] <= claim.reach[1]].sort_values("revolution")
            travel, mean = np.append(0.0, rows["revolution"]), np.append(0.0, MILLIMETRES * rows["mean_m"])
            found = scaled(rate_trend(blocks_of(travel, mean)).change, PERCENT)
            yield Seen(scheme.replace("_", " "), found, _covered(rows))

    return evidence


def _run_in(tables: Tables, claim: Claim) -> Iterator[Seen]:
    """Yield where what a run does becomes level."""
    for run, rows in tables.statistics.groupby("run", sort=False):
        scheme = rows["scheme"].iloc[0].replace("_", " ")
        for name, (revolution, values) in revolution_series(rows, tables.volumes[tables.volumes["run"] == run]).items():
            found, of = run_in(revolution, values), f"{scheme}, {name}"
            if found.answer in (ENDED, NOT_ENDED):
                ends = Ends(found.end, found.low, found.high, 1)
                yield Seen(of, ends, _covered(rows), words=found.text("revolution"))
            else:
                yield Seen(of, None, reason=found.answer, words=found.text("revolution"))


def _by_mesh(size: str):
    """Return the evidence of how the mean of a size changes from the finest mesh to the coarsest."""

    def evidence(tables: Tables, claim: Claim) -> Iterator[Seen]:
        of_size = tables.meshes[tables.meshes["size"] == size]
        for scheme, rows in of_size.groupby("scheme", sort=False):
            ordered = rows.drop_duplicates("element_size_mm").sort_values("element_size_mm")
            name = f"{scheme.replace('_', ' ')}, {len(ordered)} meshes"
            if len(ordered) < 2:
                yield Seen(name, None, reason="fewer than two meshes")
                continue
            drift = relative_drift(ordered["element_size_mm"].to_numpy(float), ordered["mean_mm"].to_numpy(float))
            sizes = float(ordered["element_size_mm"].min()), float(ordered["element_size_mm"].max())
            yield Seen(name, scaled(drift, PERCENT), sizes)

    return evidence


EVIDENCE: dict[str, Callable[[Tables, Claim], Iterator[Seen]]] = {
    "excess_calibrated": _volumes(CALIBRATED, _excess),
    "excess_reference": _volumes(REFERENCE, _excess),
    "curved_calibrated": _volumes(CALIBRATED, _change),
    "curved_reference": _volumes(REFERENCE, _change),
    "curved_more": _curved_more,
    "depth_linear": _growth("depth"),
    "width_slows": _growth("opening width"),
    "run_in": _run_in,
    "shallower_on_coarse_meshes": _by_mesh("depth"),
    "wider_on_coarse_meshes": _by_mesh("opening width"),
}
