"""Key numbers of a study of the circular wear tester, from its tables."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from postproc.tables.display import CUBIC_MILLIMETRES
from workflows.cases.circular_tester.volume import LABORATORY, OURS, THESIS, THESIS_ALIKE
from workflows.report.text import UNDEFINED

TABLES = ("comparison", "time_scale", "crossings", "fits", "mean_ratios")


def key_numbers(study: Mapping[str, Any], folder: Path, summary: pd.DataFrame) -> dict[str, Any]:
    """Return what the template shows: `results` (a table for download), cards, the comparison with the source."""
    tables = {name: pd.read_csv(folder / "tester" / f"{name}.csv", keep_default_na=True) for name in TABLES}
    tables["comparison"]["note"] = tables["comparison"]["note"].fillna("")
    return {
        "results": result_table(summary, tables["fits"]),
        "cards": cards(tables),
        "comparison": tables["comparison"].to_dict("records"),
        "sources": [LABORATORY, THESIS, THESIS_ALIKE, OURS],
        "scale": tables["time_scale"].iloc[0].to_dict(),
        "machines": tables["mean_ratios"].to_dict("records"),
        "verdicts": findings_table(folder).to_dict("records"),
    }


def findings_table(folder: Path) -> pd.DataFrame:
    """Return finding, source, found, verdict and reason of the source's findings, words all of them."""
    return pd.read_csv(folder / "tester" / "findings.csv", keep_default_na=False).drop(columns="key")


def result_table(summary: pd.DataFrame, fits: pd.DataFrame) -> pd.DataFrame:
    """Return the key numbers of each run in display units.

    sliding_over_travel (-): how far contacts slide over how far the trough goes, from sliding work and normal force
    """
    names = ["run", "series", "surface", "shape", "particle_scale", "element_size_mm", "wear_coefficient_per_pa"]
    volume = summary["archard_volume_m3"]
    linear = fits[fits["fit"] == "linear"].set_index("run")["r_squared"]
    return summary[[*names, "revolutions"]].assign(
        lost_volume_mm3=summary["applied_volume_m3"] * CUBIC_MILLIMETRES,
        lost_per_revolution_mm3=volume * CUBIC_MILLIMETRES / summary["revolutions"],
        bump_share_percent=100.0 * summary["bump_archard_volume_m3"] / volume,
        mean_normal_force_N=summary["mean_normal_force_N"],
        sliding_over_travel=summary["sliding_work_J"] / (summary["mean_normal_force_N"] * summary["travel_m"]),
        bed_over_floor_velocity=summary["bed_over_floor_velocity"],
        linear_r_squared=summary["run"].map(linear),
        carried_share_percent=100.0 * (summary["carried_volume_m3"] / volume).abs(),
    )


def cards(tables: Mapping[str, pd.DataFrame]) -> list[dict[str, str]]:
    """Return the few numbers that answer the question: the reductions beside the measured ones, and their future."""
    reductions = tables["comparison"][tables["comparison"]["quantity"] == "reduction"]
    found = [
        {
            "value": f"{row[OURS]:.3g} %",
            "label": f"less wear of the convex sample after {row['hours']:g} h; measured {row[LABORATORY]:.3g} %, "
            f"thesis' model {row[THESIS]:.3g} %",
        }
        for _, row in reductions.iterrows()
    ]
    for row in tables["crossings"].itertuples():
        never = not np.isfinite(row.crossing)
        words = "convex never loses more" if never else "revolutions until the convex sample has lost more"
        found.append(
            {"value": UNDEFINED if never else f"{row.crossing:.3g}", "label": f"{words}, scale {row.particle_scale:g}"}
        )
    return found
