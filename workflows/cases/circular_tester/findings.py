"""Verdicts on the findings of Yan 2022, chapter 6, with what the runs of a circular wear tester found.

Claims are those of config/published/verdicts.yaml, evidence that of `volume_evidence` and `flow_evidence`, rules
those of `postproc.statistics.verdicts`.
"""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.verdicts import Claim, Verdict, judged, not_said
from bulkwear.workflows.cases.circular_tester.flow_evidence import ON_FLOW
from bulkwear.workflows.cases.circular_tester.observed import Builder, Evidence, Observed
from bulkwear.workflows.cases.circular_tester.volume_evidence import ON_VOLUMES

BUILDERS: Mapping[str, Builder] = {**ON_VOLUMES, **ON_FLOW}
OURS = ("machines",)  # claims of no source: how it is simulated
OF_ANY_PATTERN = ("plain_linear", "plain_sizes", "plain_columns", "plain_even", "steady", "mesh_size", *OURS)


def findings_table(seen: Observed, claims: Mapping[str, Claim]) -> pd.DataFrame:
    """Return key, finding, claim, found, verdict, reason, factor (-, found over published size) and source."""
    rows = []
    for key, claim in claims.items():
        verdict = verdict_on(key, seen, claim)
        said = {"found": verdict.found, "verdict": verdict.verdict, "reason": verdict.reason, "factor": verdict.factor}
        rows.append({"key": key, "finding": claim.finding, "claim": claim.words, **said, "source": claim.source})
    return pd.DataFrame(rows)


def verdict_on(key: str, seen: Observed, claim: Claim) -> Verdict:
    """Return the verdict on a claim; of the source's samples nothing can be said by others."""
    evidence = BUILDERS[key](seen, claim)
    words = found_words(evidence, claim.unit)
    why = seen.foreign.get(PLAIN if key in OF_ANY_PATTERN else seen.patterned)
    if why and key not in OURS:
        return not_said(why, words)
    if evidence.reason:
        return not_said(evidence.reason, words)
    return judged(claim, evidence.found, words, evidence.covers)


def found_words(evidence: Evidence, unit: str) -> str:
    """Return estimates with their intervals, and what else is to be told."""
    shown = "" if unit == "-" else unit
    told = [f"{name}: {one.text(unit=shown)}" if name else one.text(unit=shown) for name, one in evidence.found.items()]
    return "; ".join([*told, *filter(None, [evidence.further])])
