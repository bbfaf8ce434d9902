"""What the page of a study, and every figure, is told of its configuration, JSON-able."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any

from bulkwear.postproc.wear.laws import NEUTRAL_LAW
from bulkwear.workflows.config.design import Study
from bulkwear.workflows.engine.cases import case_module, find_case
from bulkwear.workflows.report.charts import tables_of_charts
from bulkwear.workflows.report.products import Product, figures_of, products_of_study
from bulkwear.workflows.report.text import number_and_unit

REPORT_FOLDER = Path(__file__).resolve().parent
TEMPLATES = ("study.html.j2", "style.html.j2", "sections.html.j2", "runs.html.j2", "script.html.j2", "charts.html.j2")


def page_templates(study: Study) -> list[str]:
    """Return the paths of the templates of a study's page."""
    return [str(REPORT_FOLDER / name) for name in TEMPLATES]


def is_deformed(study: Study) -> bool:
    """Return whether wear is applied to the surfaces of a study, which then lose thickness."""
    return bool(study.settings["wear"]["deform"])


def job_names(study: Study) -> list[str]:
    """Return the names of all jobs behind a study's page, as their benchmark files are named."""
    return [
        "design_table",
        *(["summary"] if study.case.wears else []),
        *(f"settled_bed_{bed}" for bed in study.beds),
        *(f"{rule}_{run.name}" for run in study.runs for rule in study.case.run_rules),
        *(product.rule for product in products_of_study(study).values()),
        *(job.name for job in study.case.further_work(study)),
    ]


def page_parameters(study: Study) -> dict[str, Any]:
    """Return everything that a study's page says about its configuration; `told`: what its case adds."""
    return {
        "name": study.name,
        "case": study.case.name,
        "wears": study.case.wears,
        "title": study.title,
        "question": study.question,
        "fidelity": study.fidelity,
        "settings": study.settings,
        "paper_settings": study.paper_settings,
        "design_rows": list(study.design_rows),
        "left_out": study.settings_left_out,
        "remarks": figure_remarks(study),
        "figures": {product.name: _figure_words(product, study) for product in figures_of(study)},
        "told": page_of(study.case.name).told(study),
        "jobs": job_names(study),
        "runs": {
            run.name: {"row": run.row, "surface": run.surface, "setting": study.setting_of[run.row]}
            for run in study.runs
        },
        "parameters": {run.name: run.parameters for run in study.runs},
        "frictions": _frictions(study),
        "beds": list(study.beds),
        "bed_of": {run.name: study.bed_of(run.name) for run in study.runs},
    }


def _frictions(study: Study) -> dict[str, Any]:
    """Return {run: sliding friction (-) of what wears}, by label of its faces where the case's page has `frictions`."""
    page = page_of(study.case.name)
    of_run = getattr(page, "frictions", lambda run: run["sample_material"]["contact"]["sliding_friction"])
    return {run.name: of_run(run.parameters) for run in study.runs} if study.case.wears else {}


def part_names(study: Study) -> dict[int, str]:
    """Return {label of faces that wear: what it is called}: by the case's page where it has `part_names`."""
    page = page_of(study.case.name)
    return page.part_names(study.runs[0].parameters) if hasattr(page, "part_names") else {0: "base"}


def _figure_words(product: Product, study: Study) -> dict[str, Any]:
    words = {"title": product.title, "caption": product.paragraphs, "file": product.file}
    return words | {"beside": tables_of_charts(product, study)}


def page_of(case: str) -> ModuleType:
    """Return the module of a case's page."""
    return case_module(find_case(case), "page")


def answers_of_study(case: str, folder: Path) -> list[str]:
    """Return in sentences what a study that is done answers; nothing of a case whose page has no function `answers`."""
    page = page_of(case)
    return page.answers(folder) if hasattr(page, "answers") else []


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
