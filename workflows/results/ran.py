"""What each page of a study ran: how many rows of its design as it is now, in how many packings, at which fidelity."""

from __future__ import annotations

import json
import math
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from bulkwear.workflows.config.chosen import ROWS
from bulkwear.workflows.config.design import Study, list_studies, load_study
from bulkwear.workflows.config.packings import PACKINGS
from bulkwear.workflows.forecast.shipped import FIDELITIES
from bulkwear.workflows.report.markdown_text import markdown
from bulkwear.workflows.report.provenance_of_pages import LINE, Origin
from bulkwear.workflows.report.text import number, range_text

HEAD = """
## What each page ran

Rows: of the study's design as it is now; packings: of each row that was run; set besides: settings that are not the
study's own at that fidelity. Calibrations simulate no rows but bulk tests. What searches for a pattern runs as many
rows as it may.

"""
UNRECORDED, NO_ROWS = "not recorded", number(math.nan)


def ran_section(origins: Sequence[Origin]) -> str:
    """Return the section of what the pages of studies ran, and at which fidelities no study has a page."""
    of_studies = [each for each in origins if each.study in list_studies() and not each.figure]
    if not of_studies:
        return ""
    table = pd.DataFrame([ran_row(each, load_study(each.study, overrides=each.overrides)) for each in of_studies])
    return f"{HEAD}{markdown(table)}\n{without_page(of_studies)}\n"


def ran_row(origin: Origin, study: Study) -> dict[str, Any]:
    """Return what a page ran; study: as it was loaded for it."""
    names = {name for version in origin.versions for name in version["runs"]}
    packings: dict[str, set[str]] = {}
    for run in study.all_runs:
        if run.name in names:
            packings.setdefault(study.setting_of[run.row], set()).add(run.row)
    asked = len({*study.setting_of.values()})
    rows = f"{len(packings)} of {asked}" if names else f"{UNRECORDED}, of {asked}"
    if names and not study.case.wears:
        rows = f"{len(names)} simulations"
    return {
        "page": f"[{origin.page}]({origin.page})",
        "fidelity": study.fidelity,
        "rows run": rows,
        "packings": range_text(sorted({len(each) for each in packings.values()})) if packings else NO_ROWS,
        "set besides": _set_besides(origin.settings),
    }


def _set_besides(settings: Mapping[str, Any]) -> str:
    """Return settings but for rows and packings, which the other columns tell."""
    others = {name: value for name, value in settings.items() if name not in (ROWS, PACKINGS)}
    return ", ".join(f"`{name}={json.dumps(value)}`" for name, value in others.items())


def without_page(origins: Sequence[Origin]) -> str:
    """Return the sentence about fidelities at which studies have no page."""
    there = {(each.study, each.fidelity) for each in origins}
    lacking = {
        fidelity: [f"`{study}`" for study in list_studies() if (study, fidelity) not in there]
        for fidelity in FIDELITIES
    }
    said = "; ".join(f"at {fidelity} {', '.join(studies)}" for fidelity, studies in lacking.items() if studies)
    return textwrap.fill(f"Studies without a page: {said}.", LINE, break_on_hyphens=False)
