"""The figure and tables of a study that varies what the source does not tell of its tester."""

from __future__ import annotations

from typing import Any

from bulkwear.workflows.cases.circular_tester import figure_findings
from bulkwear.workflows.cases.circular_tester.figures import ALL_RUNS, CLAIMS, DIGITS, PUBLISHED, WEAR, read, runs_of
from bulkwear.workflows.cases.circular_tester.runs import VARIED, has_series
from bulkwear.workflows.cases.circular_tester.sensitivity import changes_of, settings_of_pairs
from bulkwear.workflows.report.products import Job, figure

CLAIMS_PART = "tester_sensitivity"
SENSITIVITY, EFFECTS = "tester/sensitivity.csv", "tester/sensitivity_effects.csv"
SETTINGS_SAID = "tester/sensitivity.txt"  # sentences of the page


@figure(
    "Experiment and model",
    "What each setting reaches of the published numbers",
    finding=figure_findings.reached,
    inputs={**PUBLISHED, **CLAIMS, **WEAR},
    told={**ALL_RUNS, "settings": settings_of_pairs},
    tables={"sensitivity": SENSITIVITY, "effects": EFFECTS, "said": SETTINGS_SAID},
    when=has_series(VARIED),
    digits=DIGITS,
    caption="""
    A line per published number of chapter 6 (Yan 2022), with the values that agree with it, margins included; a column
    per setting. White and framed: the number agrees. Colour: how far ours is above (red) or below (blue) the nearest
    value that agrees. At the bottom: how many each setting reaches, and what it is, with what differs from the first
    one, the reference, in bold. Of one packing what is said is of that packing.
    """,
)
def tester_sensitivity(job: Job) -> Any:
    """Draw which published numbers each setting reaches."""
    from bulkwear.postproc.tables.summary import published_value
    from bulkwear.workflows.cases.circular_tester import sensitivity
    from bulkwear.workflows.cases.circular_tester.plots.sensitivity import reached_by_setting
    from bulkwear.workflows.config.claims import claims_of

    lost = published_value(*read(job, "published"), "convex_volume_184_h", "laboratory")
    numbers = {
        pair: [sensitivity.numbers_of_pair(patterned, plain, lost) for patterned, plain in packings]
        for pair, packings in sensitivity.pairs_by_setting(runs_of(job)).items()
    }
    table = sensitivity.sensitivity_table(numbers, claims_of(CLAIMS_PART, job.files.claims))
    changes = changes_of(job.told.settings)
    effects = sensitivity.effects_table(table, changes)
    said = "\n".join(sensitivity.sentences(table, changes)) + "\n"
    further = {"sensitivity": table, "effects": effects, "said": said}
    return reached_by_setting(table, job.told.settings, changes, job.remarks), table, further
