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
    FOREIGN,
    OF_PAIRS,
    PAIRS,
    PUBLISHED,
    WEAR,
    read,
    runs_of,
)
from bulkwear.workflows.cases.circular_tester.runs import VARIED, TesterRun, has_series, pairs_of
from bulkwear.workflows.cases.circular_tester.sensitivity import changes_of, settings_of_pairs
from bulkwear.workflows.cases.circular_tester.source import unlike_source
from bulkwear.workflows.report.products import Job, figure, tables

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pandas as pd

    from bulkwear.workflows.config.design import Study

CLAIMS_PART = "tester_sensitivity"
SENSITIVITY, EFFECTS = "tester/sensitivity.csv", "tester/sensitivity_effects.csv"
SETTINGS_SAID = "tester/sensitivity.txt"  # sentences of the page
NUMBERS = "tester/published_numbers.csv"
TOLD_ELSEWHERE = (  # numbers that findings or the table of hours have already
    *("loss_ratio", "plain_columns", "first_column", "bump_share"),
    *("convex_volume_56_h", "convex_volume_184_h"),
)


def varies_source(study: Study) -> bool:
    """Return whether a study varies what the source does not tell of its samples."""
    return has_series(VARIED)(study) and not unlike_source(study)


def _numbers(job: Job, pairs: Sequence[tuple[TesterRun, TesterRun]]) -> list[dict[str, float]]:
    """Return the numbers of each packing of a setting, see `sensitivity.numbers_of_pair`."""
    from bulkwear.workflows.cases.circular_tester.sensitivity import numbers_of_pair

    (published,) = read(job, "published")
    return [numbers_of_pair(*pair, published) for pair in pairs]


@tables(inputs={**PUBLISHED, **CLAIMS, **WEAR}, told={**PAIRS, **FOREIGN}, tables={"numbers": NUMBERS}, **OF_PAIRS)
def tester_numbers(job: Job) -> dict[str, pd.DataFrame]:
    """Make the table of published forces, volumes, spins, velocities and losses beside those of the main pair; without
    rows where its pattern is not the source's.
    """
    from bulkwear.workflows.cases.circular_tester import sensitivity
    from bulkwear.workflows.config.claims import claims_of

    claims = claims_of(CLAIMS_PART, job.files.claims)
    claims = {key: claim for key, claim in claims.items() if key not in TOLD_ELSEWHERE}
    pairs = [pair for pair in pairs_of(runs_of(job)) if pair[0].surface not in job.told.foreign]
    numbers = _numbers(job, pairs)
    return {"numbers": sensitivity.numbers_table(numbers, claims)}


@figure(
    "Experiment and model",
    "What each setting reaches of the published numbers",
    finding=figure_findings.reached,
    inputs={**PUBLISHED, **CLAIMS, **WEAR},
    told={**ALL_RUNS, "settings": settings_of_pairs},
    tables={"sensitivity": SENSITIVITY, "effects": EFFECTS, "said": SETTINGS_SAID},
    when=varies_source,
    digits=DIGITS,
    caption="""
    A line per published number of chapter 6 (Yan 2022), with the values that agree with it, margins included; a column
    per setting. White and framed: the number agrees. Colour: how far ours is above (red) or below (blue) the nearest
    value that agrees; a dash: the run is too short for it. At the bottom: how many each setting reaches of those that
    it has, of how many packings, and what it is, with what differs from the first one, the reference, in bold. Of one
    packing what is said is of that packing.
    """,
)
def tester_sensitivity(job: Job) -> Any:
    """Draw which published numbers each setting reaches."""
    from bulkwear.workflows.cases.circular_tester import sensitivity
    from bulkwear.workflows.cases.circular_tester.plots.sensitivity import reached_by_setting
    from bulkwear.workflows.config.claims import claims_of

    numbers = {pair: _numbers(job, packings) for pair, packings in sensitivity.pairs_by_setting(runs_of(job)).items()}
    claims = claims_of(CLAIMS_PART, job.files.claims)
    table = sensitivity.sensitivity_table(numbers, claims)
    changes = changes_of(job.told.settings)
    effects = sensitivity.effects_table(table, changes)
    said = "\n".join(sensitivity.sentences(table, changes, claims)) + "\n"
    further = {"sensitivity": table, "effects": effects, "said": said}
    return reached_by_setting(table, job.told.settings, changes, job.remarks), table, further
