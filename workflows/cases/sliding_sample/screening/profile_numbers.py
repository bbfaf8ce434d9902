"""Single values of the source's profiles by layer beside ours, as values beside values (`report.published`)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.intervals import estimate
from bulkwear.postproc.tables.summary import read_summary
from bulkwear.workflows.cases.sliding_sample.screening.regime_groups import of_published_rows
from bulkwear.workflows.config.claims import ABOUT
from bulkwear.workflows.engine.project import PACKAGE
from bulkwear.workflows.report.published import COMPUTED
from bulkwear.workflows.report.sections import Block, Table

LAYER = 5.0  # mm, of the published profiles, whose particles have their real size
COLUMNS = {  # published quantity -> column of a profile
    "velocity": "velocity_m_per_s",
    "sideways_ratio": "sideways_ratio",
    "upward_ratio": "upward_ratio",
    "averaged_angular_velocity": "averaged_angular_velocity_deg_per_s",
}
ENDS = {"about": "published_value", "below": "published_high", "above": "published_low"}  # by relation
LEAST_MARGIN = {"-": 0.05}  # by unit: ratios are told to a tenth
PUBLISHED_PROFILES = PACKAGE / "config" / "published" / "screening_profiles.csv"
PROFILE_NOTE = (
    "Single values that the source's text tells of its profiles, in layers of 5 mm, beside ours in the layer at their "
    "height: means over the packings with 95 % intervals."
)
TOUCH = 1e-6  # -, of a layer's thickness, by which round-off may part a height from its layer


def profile_values(study: Mapping[str, Any], folder: Path) -> list[Block]:
    """Return single values of the source's profiles beside ours; nothing of a study without its rows."""
    rows, path = study["told"]["published_rows"], folder / "flow" / "profiles.csv"
    if not (rows and path.is_file()):
        return []
    settings = read_summary(folder / "summary.csv").drop_duplicates("row").set_index("row")["setting"]
    published = of_published_rows(pd.read_csv(PUBLISHED_PROFILES), rows)
    beside = profiles_beside_source(read_summary(path), settings, published[published["row"].isin(settings)])
    return [Table(beside, "profile_values", PROFILE_NOTE, beside_source=True)] if len(beside) else []


def profiles_beside_source(
    profiles: pd.DataFrame, settings: Mapping[str, str], published: pd.DataFrame
) -> pd.DataFrame:
    """Return published values of profiles beside the means over packings of ours, in the layer at their height; of
    settings that have profiles.

    profiles: run, row, surface, zone, layer, height_mm and COLUMNS, as from `flow_history.row_profiles`
    settings: {row: its setting}; published: config/published/screening_profiles.csv by names of our settings
    """
    setting = profiles["row"].map(settings)
    points = [point for point in published.to_dict("records") if (setting == point["row"]).any()]
    return pd.DataFrame([_point(point, profiles[setting == point["row"]]) for point in points])


def _point(point: Mapping[str, Any], profiles: pd.DataFrame) -> dict[str, Any]:
    """Return one published value beside ours, NaN where no layer of ours holds its height."""
    alike = profiles[(profiles["surface"] == point["surface"]) & (profiles["zone"] == point["zone"])]
    height = (point["layer"] - 0.5) * LAYER
    ours = [at_height(profile, COLUMNS[point["quantity"]], height) for _, profile in alike.groupby("run", sort=False)]
    mean = estimate(ours)
    low, high = mean.interval()
    return {
        "quantity": point["quantity"],
        "setting": f"{point['row']}, {point['surface']}, {point['zone']}, layer {point['layer']}",
        "unit": point["unit"],
        ENDS[point["relation"]]: point["value"],
        COMPUTED: mean.value,
        "computed_low": low,
        "computed_high": high,
        "packings": mean.packings,
        "margin": max(ABOUT * abs(point["value"]), LEAST_MARGIN.get(point["unit"], 0.0)),
        "source": point["source"],
    }


def at_height(profile: pd.DataFrame, column: str, height: float) -> float:
    """Return a profile's value in the layer that holds a height (mm), NaN where none does.

    Layers are equally thick and count from 0, those of the source from 1.
    """
    away = np.abs(profile["height_mm"] - height)
    half = 0.5 * profile["height_mm"] / (profile["layer"] + 0.5)
    holds = away[away <= half * (1.0 + TOUCH)]
    return float(profile.loc[holds.idxmin(), column]) if len(holds) else np.nan
