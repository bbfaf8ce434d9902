"""What nobody has run so far of the source's own conditions, with the command that forecasts it and what it costs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import pandas as pd

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.project import PACKAGE
from bulkwear.workflows.forecast.forecast import forecast_table, work_of
from bulkwear.workflows.forecast.rates import DEFAULT, read_rates
from bulkwear.workflows.forecast.shipped import CORES, cost
from bulkwear.workflows.report.markdown import config_words
from bulkwear.workflows.report.markdown_text import markdown


@dataclass(frozen=True)
class NotRun:
    """A study as it was not run: in words, and the settings besides those of the configuration."""

    what: str
    study: str
    settings: Mapping[str, Any]


WINDOW = {"ends": "window", "ahead_mm": 150, "behind_mm": 200}
NOT_RUN = (
    NotRun(
        "screening: all thirteen rows at standard, over the source's travel",
        "screening",
        {"fidelity": "standard", "sliding": {"run_in_mm": 1000, "travel_mm": 700}},
    ),
    NotRun(
        "screening: thirteen rows at quick with three packings; they have one",
        "screening",
        {"fidelity": "quick"},
    ),
    NotRun(
        "screening: two rows at the source's own particle size over its travel and by its time step, in a window"
        " instead of its bed of 2 m",
        "screening",
        {"fidelity": "paper", "packings": 1, "rows": ["R5", "R12"], "bed": WINDOW},
    ),
    NotRun(
        "calibration: the draw-down test with the source's square opening; all results are of a slot",
        "calibration",
        {
            "fidelity": "standard",
            "calibration": {"tests": ["draw_down"]},
            "draw_down": {"width_mm": 100, "opening": "square", "front_and_back": "walls"},
        },
    ),
    NotRun(
        "particle size: scale 2 at standard",
        "particle_size",
        {"fidelity": "standard", "rows": ["S2"]},
    ),
    NotRun(
        "circular tester: ring, and particle scale 4 over seventeen revolutions with three packings; it has five and"
        " one",
        "circular_tester",
        {"fidelity": "standard"},
    ),
)
HEAD = f"""
## What was not run

Wall time on {CORES} cores, by the default rates; the command prints them job by job, and without
`_forecast` runs the study. Whole studies at each fidelity: [forecasts](forecast_studies.md).

"""
BESIDE = """
Of the source's draw-down tests (Table 3.5) the calibrated pair alone was simulated under other [rolling
models](rolling_models_results.md) than the studies' own, in one packing, and under `cdt` none; their
[calibrations](calibration_models_results.md) have the shear box alone. Of the [tester's
sensitivity](tester_sensitivity_results_quick.md) every setting but the reference has one packing.

The pin has not been run with the source's 14 µs undivided where its displacement rule makes more than 22 contacts at
once: no setting leaves the step as it is, since from 40 contacts on the pin swings by itself ([why](pin_on_disc.md)).
Nor is there a row of that rule at 6.8e-11 1/Pa, with which the conserving rule gives the laboratory's volume; that rule
gives it with 1.06e-11.
"""


def not_run_section(asked: Iterable[NotRun] = NOT_RUN) -> str:
    """Return the section of what was not run. Raises ConfigError where a study does not take its settings."""
    rates = read_rates(PACKAGE / DEFAULT).rates
    rows = []
    for each in asked:
        study = load_study(each.study, overrides=dict(each.settings))
        command = f"`snakemake {each.study}_forecast{config_words(each.settings)}`"
        hours = cost(forecast_table(work_of(study.foreseen), rates))
        rows.append({"what": each.what, "core hours; wall time": hours, "forecast": command})
    return f"{HEAD}{markdown(pd.DataFrame(rows))}{BESIDE}"
