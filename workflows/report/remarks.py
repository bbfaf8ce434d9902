"""What every figure of a study must say about itself: what is smaller than at paper fidelity, and what is assumed."""

from __future__ import annotations

from postproc.wear.laws import NEUTRAL_LAW
from workflows.config.design import Study
from workflows.report.pages import page_of
from workflows.report.text import number_and_unit


def figure_remarks(study: Study) -> list[str]:
    """Return what every figure must say: what is smaller than at paper fidelity or else simpler, law, acceleration."""
    now = study.settings
    remarks = page_of(study.case.name).remarks(study)
    if not study.case.wears:
        return remarks
    if now["wear"]["law"] != NEUTRAL_LAW:
        given = [number_and_unit(key, value) for key, value in now["wear"].get("parameters", {}).items()]
        law = " ".join([now["wear"]["law"], *([f"({', '.join(given)})"] if given else [])])
        remarks.append(f"worn by the law {law}")
    if now["wear"]["scheme"] != "conserving":
        remarks.append("worn by the per-triangle rule, which removes more than the law's volume")
    if now["wear"]["acceleration"] != 1.0:
        remarks.append(f"wear accelerated {now['wear']['acceleration']:g} times")
    return remarks
