"""What runs reach of the published numbers of the tester: a table of every study, and the figure and tables of one that
varies what the source does not tell.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.circular_tester import figure_findings
from bulkwear.workflows.cases.circular_tester.figures import (
    ALL_RUNS,
    CLAIMS,
    DIGITS,
    OF_PAIRS,
    PAIRS,
    PUBLISHED,
    WEAR,
    read,
    runs_of,
)
from bulkwear.workflows.cases.circular_tester.runs import VARIED, has_series, pairs_of
from bulkwear.workflows.cases.circular_tester.sensitivity import changes_of, settings_of_pairs
from bulkwear.workflows.report.products import Job, figure, tables

if TYPE_CHECKING:
    import pandas as pd

CLAIMS_PART = "tester_sensitivity"
SENSITIVITY, EFFECTS = "tester/sensitivity.csv", "tester/sensitivity_effects.csv"
SETTINGS_SAID = "tester/sensitivity.txt"  # sentences of the page
NUMBERS = "tester/published_numbers.csv"
TOLD_AS_FINDINGS = ("loss_ratio", "plain_columns", "first_column", "bump_share")  # numbers that findings judge already


@tables(inputs={**PUBLISHED, **CLAIMS, **WEAR}, told=PAIRS, tables={"numbers": NUMBERS}, **OF_PAIRS)
def tester_numbers(job: Job) -> dict[str, pd.DataFrame]:
    """Make the table of published forces, volumes, spins, velocities and losses beside those of the main pair; without
    rows where its pattern is not the source's.
    """
    from bulkwear.postproc.tables.summary import published_value
    from bulkwear.workflows.cases.circular_tester import sensitivity
    from bulkwear.workflows.cases.circular_tester.volume import CONVEX
    from bulkwear.workflows.config.claims import claims_of

    lost = published_value(*read(job, "published"), "convex_volume_184_h", "laboratory")
    claims = claims_of(CLAIMS_PART, job.files.claims)
    claims = {key: claim for key, claim in claims.items() if key not in TOLD_AS_FINDINGS}
    pairs = [pair for pair in pairs_of(runs_of(job)) if pair[0].surface == CONVEX]
    numbers = [sensitivity.numbers_of_pair(patterned, plain, lost) for patterned, plain in pairs]
    return {"numbers": sensitivity.numbers_table(numbers, claims)}


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
