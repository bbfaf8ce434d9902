"""What a study of pins on discs answers, in sentences, of the tables that it has. No run is repeated: numbers have no
interval but that of the run that was simulated.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from pathlib import Path

import pandas as pd

from bulkwear.workflows.cases.pin_on_disc import figure_findings
from bulkwear.workflows.cases.pin_on_disc.coefficient import PUBLISHED_FITS
from bulkwear.workflows.cases.pin_on_disc.comparison import EDGES_PER_WIDTH, STABLE_PERCENT
from bulkwear.workflows.cases.pin_on_disc.figure_findings import at_coefficient, by_scheme
from bulkwear.workflows.report.sentences import capital, measured, spoken


def all_answers(folder: Path, figures: Collection[str]) -> list[str]:
    """Return the answers of a study; folder: results/<study>; figures: that it has. What its rows do not tell is left
    out.
    """

    def read(name: str) -> pd.DataFrame:
        return pd.read_csv(folder / "figures" / f"{name}.csv")

    parts = {
        "pin_comparison": lambda: figure_findings.beside_laboratory(read("pin_comparison")),
        "calibration": lambda: coefficients(read("calibration")),
        "mesh_series": lambda: fine_meshes(read("mesh_stability"), read("mesh_series")),
        "run_in": lambda: run_ins(read("run_in_change_points")),
    }
    said = [answer for figure, tell in parts.items() if figure in figures for answer in tell()]
    return [*over_law(pd.read_csv(folder / "summary.csv")), *said]


def over_law(summary: pd.DataFrame) -> list[str]:
    """Return what discs lose over the law's volume, by scheme; of discs that keep their shape nothing."""
    worn = summary[summary["removed_volume_m3"] > 0.0]
    if worn.empty:
        return []
    times = by_scheme(worn, worn["removed_volume_m3"] / worn["alpha_F_L_volume_m3"])
    return [f"Discs lose {times} times what Archard's law asks for, alpha F L."]


def coefficients(table: pd.DataFrame) -> list[str]:
    """Return by scheme the coefficient with which the most revolutions stand for the laboratory's test.

    table: as from `coefficient.calibration_table`; the interval is that of the laboratory's volume alone
    """
    last = table[(table["revolutions"] == table["revolutions"].max()) & (table["scheme"] != PUBLISHED_FITS)]
    said = []
    for row in last.itertuples():
        ends = (f"{end:.3g}" for end in (row.least_wear_coefficient_per_pa, row.largest_wear_coefficient_per_pa))
        how = "" if row.interpolated else "; beyond the coefficients that were simulated"
        said.append(
            f"{capital(spoken(row.scheme))}: {row.revolutions:g} revolutions stand for the laboratory's test, each for"
            f" {row.scaling_factor:.3g} of it, with {at_coefficient(row.wear_coefficient_per_pa)} ({' to '.join(ends)}"
            f" by the laboratory's error{how})."
        )
    return said


def fine_meshes(stability: pd.DataFrame, series: pd.DataFrame) -> list[str]:
    """Return by scheme which meshes are fine enough, where two or more can be compared.

    stability, series: as from `comparison.mesh_stability` and `mesh_series`
    """
    said = []
    for scheme, rows in stability.groupby("scheme", sort=False):
        most, least = rows["largest_element_mm"].iloc[0], rows["meshes"].min()
        of_scheme = series.loc[series["scheme"] == scheme, "element_size_mm"]
        fine, off = sorted(of_scheme[of_scheme <= most].unique()), rows["difference_percent"].max()
        start = f"{capital(spoken(str(scheme)))}: "
        if least < 2 or math.isnan(off):
            limit = f"a {EDGES_PER_WIDTH:g}th of the groove's width ({measured(most, 'mm')})"
            count = f"{least} mesh has" if least == 1 else "no mesh has"
            said.append(f"{start}which mesh is fine enough cannot be said, as {count} elements of up to {limit}.")
        elif rows["stable"].all():
            said.append(
                f"{start}elements of {fine[-1]:g} mm are fine enough, sizes of the groove differ by up to"
                f" {off:.2g} % among the {least} meshes up to them."
            )
        else:
            said.append(
                f"{start}no mesh is shown to be fine enough, with elements of {fine[0]:g} to {fine[-1]:g} mm sizes"
                f" of the groove differ by {off:.2g} %, more than {STABLE_PERCENT:g} %."
            )
    return said


def run_ins(points: pd.DataFrame) -> list[str]:
    """Return when the volume of a revolution becomes level; points: as from `run_in.change_points`."""
    from bulkwear.postproc.statistics.change_point import ENDED  # slow to import, and every job reads the page
    from bulkwear.workflows.cases.pin_on_disc.run_in import VOLUME_SERIES

    said = []
    for row in points[points["series"] == VOLUME_SERIES].itertuples():
        if row.answer == ENDED:
            ends = f"{row.least_end_revolution:.3g} to {row.last_end_revolution:.3g}"
            said.append(
                f"The volume that a revolution removes is level from revolution {row.end_revolution:.3g} on in"
                f" {row.run} (95 % interval {ends}, of this run)."
            )
        else:
            said.append(f"The run-in of the volume that a revolution removes, {row.run}: {row.answer}.")
    return said
