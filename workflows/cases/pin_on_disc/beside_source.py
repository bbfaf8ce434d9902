"""Numbers that the source prints of its pin on disc beside ours, as values beside values (`report.published`).

published: as config/published/pin_on_disc.csv. No run is repeated, so that none has an interval.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.tables.summary import published_value
from bulkwear.workflows.cases.pin_on_disc.coefficient import coefficient_of_laboratory
from bulkwear.workflows.cases.pin_on_disc.comparison import COMPARED, PERCENT, SAME_VOLUME
from bulkwear.workflows.report.published import COMPUTED, GIVEN

UNITS = {"depth": "mm", "width": "mm", "volume": "mm3"}
LABORATORY, THESIS = (
    {"laboratory": "conserving"},
    {"simulation": "per triangle"},
)  # what is published of: rule beside it
FITTED = "the run whose coefficient gives the laboratory's volume"
ARITHMETIC = "from the published volume, load and distance"


def sizes_beside_source(compared: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Return depth, width and volume: the laboratory's beside the conserving run whose volume is nearest to its own,
    the thesis' beside that by the source's own rule. A volume that the coefficient was chosen for is given.

    compared: as from `comparison.comparison`
    """
    runs = compared[compared["run"].fillna("") != ""]
    rows: list[dict[str, Any]] = []
    for of, rule in (LABORATORY | THESIS).items():
        near = runs[runs["case"].str.startswith(rule)].sort_values("volume_to_laboratory_percent", key=np.abs)
        for case in near.head(1).to_dict("records"):
            chosen = abs(case["volume_to_laboratory_percent"]) <= PERCENT * SAME_VOLUME
            rows += [_size(name, of, case, published, of in LABORATORY and chosen) for name in COMPARED]
    return pd.DataFrame(rows)


def _size(name: str, of: str, case: dict[str, Any], published: pd.DataFrame, chosen: bool) -> dict[str, Any]:
    setting = f"{'thesis' if of in THESIS else of}, {case['case']}"
    given = chosen and name == "volume"
    return _row(name, of, published) | {
        "setting": setting,
        "unit": UNITS[name].replace("mm3", "mm³"),
        COMPUTED: case[f"{name}_{UNITS[name]}"],
        GIVEN: "yes" if given else "",
        "reason": FITTED if given else "",
    }


def coefficients_beside_source(calibration: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Return wear coefficients: the laboratory's beside that of Archard's law, which is given, and the thesis' beside
    those of each of our rules that make its number of revolutions stand for the test.

    calibration: as from `coefficient.calibration_table`
    """
    revolutions = published_value(published, "revolutions", "simulation")
    ours = calibration[(calibration["revolutions"] == revolutions) & ~calibration["scheme"].str.startswith("Yan")]
    value, _ = coefficient_of_laboratory(published)
    laboratory = {"setting": "laboratory", COMPUTED: value, GIVEN: "yes", "reason": ARITHMETIC}
    rows = [_row("wear_coefficient", "laboratory", published) | laboratory]
    for row in ours.to_dict("records"):
        setting = f"thesis, {row['scheme'].replace('_', ' ')}, {revolutions:g} revolutions"
        own = {"setting": setting, COMPUTED: row["wear_coefficient_per_pa"], GIVEN: "", "reason": ""}
        rows.append(_row("wear_coefficient", "simulation", published) | own)
    return pd.DataFrame(rows).assign(unit="1/Pa")


def differences_beside_source(sizes: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Return the largest difference to Archard's law over all particle scales beside the published bound.

    sizes: with particle_scale and difference_percent
    """
    name, scales = "size_invariance_difference", sizes["particle_scale"]
    row = _row(name, "simulation", published)
    own = {
        "quantity": "difference to Archard",
        "setting": f"particle scales {scales.min():g} to {scales.max():g}",
        "unit": "%",
        "published_high": row.pop("published_value"),
        COMPUTED: float(sizes["difference_percent"].abs().max()),
    }
    return pd.DataFrame([row | own])


def _row(name: str, of: str, published: pd.DataFrame) -> dict[str, Any]:
    """Return quantity, published value and source of a number."""
    own = published[(published["quantity"] == name) & (published["of"] == of)]
    return {"quantity": name, "published_value": published_value(published, name, of), "source": own["source"].iloc[0]}
