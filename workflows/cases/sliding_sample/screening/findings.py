"""What the simulations of the source's thirteen rows found, packing by packing, for the claims on its findings.

The rows of a study that have the factors of a row of the source stand for it under its name; where several settings do,
as particles of several sizes, those of the smallest particles.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.factors import factor_of
from bulkwear.postproc.statistics.intervals import Estimate, estimates
from bulkwear.postproc.statistics.regression import CONSTANT
from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.workflows.cases.sliding_sample.evaluation import MEASURES
from bulkwear.workflows.cases.sliding_sample.screening.regression_tables import has_factors

CENTRAL, SIDE = "central", "side"
PERCENT = 100.0
MIXED = "mixed"  # regime of a row whose packings flow in different ones
VELOCITY, SPIN = "velocity_m_per_s", "averaged_angular_velocity_deg_per_s"
ROW = ["row", "packing"]


@dataclass(frozen=True, eq=False)
class Evidence:
    """What the simulations found, by the source's names of the rows.

    rows: a line per row and packing, see `rows_of_study`
    profiles: row, packing, surface, zone, layer, VELOCITY and SPIN
    travel: (from, to) in mm, run-in included, over which wear counts
    levels: coded levels of the source's whole design, index row, columns the short names of the factors; empty where
        the study does not have these factors
    coefficients: {term: value} of the published regression, without its constant
    published: {(quantity, of, relation): value} as in config/published/screening_results.csv
    told: {row: regime} as the source tells them
    design: all rows of the source
    """

    rows: pd.DataFrame
    profiles: pd.DataFrame
    travel: tuple[float, float]
    levels: pd.DataFrame
    coefficients: Mapping[str, float]
    published: Mapping[tuple[str, str, str], float]
    told: Mapping[str, str]
    design: Sequence[str]

    @property
    def regimes(self) -> dict[str, str]:
        """Return {row: regime of all its packings, or MIXED}."""
        found = self.rows.groupby("row", sort=False)["regime"]
        return {str(row): each.iloc[0] if each.nunique() == 1 else MIXED for row, each in found}

    def rows_in(self, regime: str, without: Sequence[str] = ()) -> list[str]:
        """Return the rows that flow in a regime, in all their packings."""
        return [row for row, found in self.regimes.items() if found == regime and row not in without]

    def unsteady(self, rows: Sequence[str]) -> list[str]:
        """Return those of some rows whose flow and wear are not shown to be steady in all packings."""
        steady = self.rows.groupby("row")["steady"].all()
        return [row for row in rows if not steady[row]]

    def by_row(self, column: str, rows: Sequence[str], log: bool = True) -> dict[str, Estimate]:
        """Return the estimate of a column over the packings of each row; without those that have no value of it."""
        table = self.rows[self.rows["row"].isin(list(rows))].dropna(subset=[column])
        found = estimates(table["row"], table[column], table["packing"], log)
        return {row: found[row] for row in rows if row in found}

    def by_packing(self, column: str, rows: Sequence[str]) -> pd.DataFrame:
        """Return a column by packing (index) and row (columns), of the packings that have a value of every row."""
        return self.rows.pivot(index="packing", columns="row", values=column).reindex(columns=list(rows)).dropna()


def gather(
    tables: Mapping[str, pd.DataFrame], run_in: float, published_rows: Mapping[str, str], factors: Mapping[str, str]
) -> Evidence:
    """Return what a study found.

    tables: summary, regimes, profiles and steady of the study; published_results, published_regimes,
    published_coefficients and published_design; run_in: mm
    published_rows: {row: row of the source}; factors: {short name: column of the design}
    """
    summary, coefficients = tables["summary"], tables["published_coefficients"]
    names = _rows_of_source(summary, published_rows)
    profiles = tables["profiles"].rename(columns={"row": "own_row"}).merge(names, on="own_row")
    terms = coefficients[coefficients["term"] != CONSTANT]
    theirs = tables["published_results"].set_index(["quantity", "of", "relation"])
    first, last = run_in, run_in + MILLIMETRES * float(summary["travel_m"].min())
    return Evidence(
        rows=rows_of_study(summary, tables["regimes"], profiles, tables["steady"], names),
        profiles=profiles[[*ROW, "surface", "zone", "layer", VELOCITY, SPIN]],
        travel=(first, last),
        levels=_coded(tables["published_design"], factors)
        if has_factors(coefficients, list(factors))
        else pd.DataFrame(),
        coefficients=dict(zip(terms["term"], terms["coefficient"].astype(float), strict=True)),
        published=theirs["value"].astype(float).to_dict(),
        told=tables["published_regimes"].set_index("row")["regime"].to_dict(),
        design=tables["published_design"]["row"].astype(str).to_list(),
    )


def _rows_of_source(summary: pd.DataFrame, published_rows: Mapping[str, str]) -> pd.DataFrame:
    """Return own_row, row (of the source) and packing of the rows that stand for one of the source."""
    table = summary[summary["row"].isin(list(published_rows))].drop_duplicates("row")
    table = table.assign(own_row=table["row"], row=table["row"].map(published_rows))
    finest = table.sort_values("particle_scale", kind="stable").groupby("row")["setting"].transform("first")
    return table[table["setting"] == finest.reindex(table.index)][["own_row", *ROW]]


def _coded(design: pd.DataFrame, factors: Mapping[str, str]) -> pd.DataFrame:
    levels = {name: design[column].to_numpy(dtype=float) for name, column in factors.items()}
    coded = {name: factor_of(name, values).coded(values) for name, values in levels.items()}
    return pd.DataFrame(coded, index=design["row"].astype(str))


def rows_of_study(
    summary: pd.DataFrame, regimes: pd.DataFrame, profiles: pd.DataFrame, steady: pd.DataFrame, names: pd.DataFrame
) -> pd.DataFrame:
    """Return a line per row of the source and packing, of its patterned run, beside its plain twin in the same bed.

    profiles: with row and packing as in `names`; steady: a line per run and measure, with both of MEASURES

    Columns row, packing, regime, steady (flow and wear of both samples), particle_scale, wear_over_plain,
    wear_m3_per_m, wear_rate (over velocity and thickness of the bed, any unit), force_over_plain, base_percent,
    relative_velocity and its fluctuation in the source's window (%), spin_over_plain and spin_over_plain_beside,
    velocity_percent and
    plain_velocity_percent (of the bottom layer, over the sample's velocity).
    """
    table = summary.rename(columns={"row": "own_row"}).drop(columns="packing").merge(names, on="own_row")
    table = table.merge(regimes[["run", "relative_velocity", "regime"]], on="run", how="left")
    patterned, plain = (table[(table["surface"] == PLAIN) == which].set_index(ROW) for which in (False, True))
    flow = steady[steady["measure"] == MEASURES[0]].set_index("run")
    fluctuation = PERCENT * flow["published_deviation"] / flow["published_mean"]
    spins = {zone: _bottom(profiles, SPIN, zone, patterned.index) for zone in (CENTRAL, SIDE)}
    over, below = _bottom(profiles, VELOCITY, CENTRAL, patterned.index)
    wear, velocity = patterned["worn_volume_m3"] / patterned["travel_m"], patterned["velocity_m_per_s"]
    force = plain["mean_normal_force_N"].reindex(patterned.index)
    return pd.DataFrame(
        {
            "regime": patterned["regime"],
            "steady": patterned["own_row"].map(steady.groupby("row")["steady"].all()),
            "particle_scale": patterned["particle_scale"],
            "wear_over_plain": patterned["wear_over_plain"],
            "wear_m3_per_m": wear,
            "wear_rate": wear / (velocity * patterned["bed_thickness_mm"]),
            "force_over_plain": patterned["mean_normal_force_N"] / force,
            "base_percent": PERCENT * patterned["base_worn_volume_m3"] / patterned["worn_volume_m3"],
            "relative_velocity": PERCENT * patterned["relative_velocity"],
            "fluctuation": patterned["run"].map(fluctuation),
            "spin_over_plain": spins[CENTRAL][0] / spins[CENTRAL][1],
            "spin_over_plain_beside": spins[SIDE][0] / spins[SIDE][1],
            "velocity_percent": PERCENT * over / velocity,
            "plain_velocity_percent": PERCENT * below / velocity,
        }
    ).reset_index()


def _bottom(profiles: pd.DataFrame, column: str, zone: str, index: pd.MultiIndex) -> tuple[pd.Series, pd.Series]:
    """Return a column of the bottom layer of patterned and of plain samples, by row and packing."""
    layer = profiles[(profiles["zone"] == zone) & (profiles["layer"] == 1)]
    patterned, plain = (
        layer[(layer["surface"] == PLAIN) == which].set_index(ROW)[column].reindex(index) for which in (False, True)
    )
    return patterned, plain


def runs_beside_source(evidence: Evidence, published_model: Mapping[str, float]) -> pd.DataFrame:
    """Return a line per row of the source: our regime, wear and force beside what the source tells of the row.

    published_model: normalised wear by row, by the published regression
    """
    found = evidence.regimes
    names = list(found)
    ratios = evidence.by_row("wear_over_plain", names)
    wear = {row: each.value for row, each in evidence.by_row("wear_m3_per_m", names).items()}
    force, spin = (evidence.by_row(name, names) for name in ("force_over_plain", "spin_over_plain"))
    velocity, unknown = evidence.by_row("relative_velocity", names, log=False), Estimate(np.nan, np.nan, 0, 0)
    published = {
        row: f"{'' if relation == 'about' else relation + ' '}{value / PERCENT:g}"
        for (quantity, row, relation), value in evidence.published.items()
        if quantity == "wear_over_plain"
    }
    unsteady = evidence.unsteady(names)
    lines = [
        {
            "row": row,
            "regime": found[row],
            "published_regime": evidence.told.get(row, ""),
            "flow_and_wear_steady": "not shown" if row in unsteady else "yes",
            "relative_velocity_percent": velocity.get(row, unknown).value,
            "packings": ratios.get(row, unknown).packings,
            "wear_over_plain": ratios.get(row, unknown).value,
            "interval_low": ratios.get(row, unknown).interval()[0],
            "interval_high": ratios.get(row, unknown).interval()[1],
            "published_wear_over_plain": published.get(row, ""),
            "normalised_wear": wear.get(row, np.nan) / max(wear.values(), default=np.nan),
            "published_model": published_model.get(row, float("nan")),
            "force_over_plain": force.get(row, unknown).value,
            "bottom_spin_over_plain": spin.get(row, unknown).value,
        }
        for row in names
    ]
    return pd.DataFrame(lines)
