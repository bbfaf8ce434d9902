"""Key numbers of a study of a pin on a disc, from its summary."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from postproc.tables.display import CUBIC_MILLIMETRES, MICROMETRES


def key_numbers(study: Mapping[str, Any], folder: Path, summary: pd.DataFrame) -> dict[str, Any]:
    """Return what the template shows: `results` (a table for download) and `cards`."""
    results = result_table(summary)
    return {"results": results, "cards": cards(results)}


def result_table(summary: pd.DataFrame) -> pd.DataFrame:
    """Return the key numbers of each run in display units: volumes, their ratios to alpha F L, forces, contacts."""
    due = summary["alpha_F_L_volume_m3"]
    names = ["run", "series", "wear_coefficient_per_pa", "element_size_mm", "scheme", "particle_scale", "revolutions"]
    return summary[names].assign(
        alpha_F_L_volume_mm3=due * CUBIC_MILLIMETRES,
        law_over_alpha_F_L=summary["archard_volume_m3"] / due,
        removed_over_alpha_F_L=summary["removed_volume_m3"] / due,
        centroid_path_over_alpha_F_L=summary["centroid_path_volume_m3"] / due,
        largest_depth_um=summary["largest_depth_m"] * MICROMETRES,
        mean_normal_force_N=summary["mean_normal_force_N"],
        mean_vertical_force_N=summary["mean_vertical_force_N"],
        most_contacts=summary["most_contacts_per_step"],
        carried_share_percent=100.0 * (summary["carried_volume_m3"] / summary["archard_volume_m3"]).abs(),
    )


def cards(results: pd.DataFrame) -> list[dict[str, str]]:
    """Return the few numbers that answer the question: the first row of the coefficients by each scheme."""
    found = []
    for scheme, words in (("conserving", "conserving"), ("per_triangle", "by the per-triangle rule")):
        rows = results[(results["series"] == "coefficient") & (results["scheme"] == scheme)]
        if rows.empty:
            continue
        row = rows.iloc[0]
        found += [
            {
                "value": f"{row['removed_over_alpha_F_L']:.4g}",
                "label": f"volume removed over coefficient x load x distance, {words}, {row['run']}",
            },
            {"value": f"{row['largest_depth_um']:.3g}", "label": f"µm, largest thickness removed, {words}"},
        ]
    return found
