"""Which figures a study has, in the order of its page, and what its page is told about it.

A figure is a function in postproc/plots, a rule in report.smk, a caption in workflows/report, and its line
here."""

from __future__ import annotations

import csv
import re
from pathlib import Path
from typing import Any

from workflows.cases.sliding_sample.page import SIZE_TABLES
from workflows.config.design import PARTICLE_SCALE, REPOSITORY, Run, Study
from workflows.engine.derived import flow_measures
from workflows.report.pages import page_of
from workflows.report.remarks import figure_remarks
from workflows.report.text import name_and_unit

REPORT_FOLDER = Path(__file__).resolve().parent
PUBLISHED_DESIGN = REPOSITORY / "config" / "designs" / "screening.csv"  # Yan 2022, Table 3.8
CONDITIONS = ("velocity_m_per_s", "bed_thickness_mm")  # columns that are no property of the pattern
PATTERN = (  # columns that make two rows the same
    "major_radius_mm",
    "minor_radius_mm",
    "column_spacing_mm",
    "height_mm",
    "velocity_m_per_s",
    "bed_thickness_mm",
)
TEMPLATE, STYLE = "study.html.j2", "style.html.j2"
INTERACTIVE = ("worn_surface_3d",)  # pages, not pictures; their table is that of the picture
FILMS = ("worn_film",)  # animated pictures
OF_SAMPLES = (  # of every study of sliding samples
    "worn_surface",
    "worn_surface_3d",
    "wear_against_travel",
    "wear_split",
    "depth_distribution",
    "bed",
    "flow_views",
    "forces",
    "wear_law_comparison",
)
OF_PINS = (  # of every study of pins on discs: what answers its question first, then the source's figures
    "pin_comparison",
    "excess_volume",
    "wear_volume",
    "force_rise",
    "calibration",
    "disc_setup",
    "contour_extraction",
    "mesh_series",
    "mesh_contours",
    "normal_force",
    "contour_distribution",
    "run_in",
    "contour_examples",
    "worn_disc",
    "unrolled_track",
    "laboratory_contour",
    "size_invariance",
)
OF_SERIES = {"mesh": ("mesh_series", "mesh_contours"), "size": ("size_invariance",)}  # of them, where the design has it
TESTER_FIGURES = {  # of the circular wear tester: rule -> category, {figure: label}; see tester_figures.py
    "tester_volumes": (
        "Volume",
        {
            "tester_hours": "Volume against hours",
            "tester_volume": "Volume by revolution",
            "tester_increments": "Increments",
            "tester_benchmark": "Volume after 56 hours",
        },
    ),
    "tester_distribution": (
        "Distribution",
        {
            "tester_columns": "Wear by column",
            "tester_bumps": "Wear of every bump",
            "tester_contours": "Contours by revolution",
            "tester_force_columns": "Normal force by column",
        },
    ),
    "tester_worn_out_pattern": ("Volume", {"tester_worn_out": "Until the pattern is gone"}),
    "tester_flow": (
        "Flow",
        {
            "tester_steadiness": "Steadiness",
            "tester_spin": "Spin of the lowest layer",
            "tester_velocity": "Velocity of the lowest layer",
            "tester_force": "Normal force by revolution",
            "tester_spin_map": "Map of spin",
            "tester_velocity_map": "Map of velocity",
        },
    ),
    "tester_meshes": ("Elements", {"tester_mesh": "Volume by mesh size", "tester_mesh_contours": "Contours by mesh"}),
    "tester_machines": ("Machine", {"tester_ring": "Channel and ring"}),
}
TESTER_SERIES = {
    "tester_worn_out_pattern": "worn_out",
    "tester_meshes": "mesh",
    "tester_machines": "ring",
}  # that it needs
OF_TESTED_SAMPLES = ("worn_surface", "wear_updates")  # of every study of the tester besides
OF_WEAR_UPDATES = ("worn_film", "wear_updates")  # of studies whose samples deform
SECOND_ROW = "flow_views_second"
FLOW = (  # of studies that name factors or confirm one that does
    "relative_velocity",
    "wear_gradient",
    "wear_by_regime",
    "normal_force_by_regime",
    "velocity_profiles",
    "angular_velocity_profiles",
    "flow_views",
    SECOND_ROW,
)
PARTICLE_SIZE = (  # of studies whose rows differ in their particle scale
    "wear_against_scale",
    "wear_against_size_ratios",
    "wear_maps",
    "steady_by_scale",
    "velocity_by_layer",
    "upward_velocity_by_layer",
    "sideways_velocity_by_layer",
    "angular_velocity_along_sample",
    "collisions",
    "packing_profiles",
    "bed_packing",
)
CONFIRMING = ("confirmation",)  # of studies that simulate another one's best designs
PROFILES = ("velocity_profiles", "angular_velocity_profiles")  # of them, drawn by one job
REGRESSION = (  # of studies that name factors
    "regression_coefficients",
    "regression_residuals",
    "regression_half_normal",
    "regression_contours",
)
COMPARING_ROWS = ("relative_wear",)  # of studies with more than one design row and a plain twin

OF_CALIBRATIONS = (  # drawn by one job, calibration_tables.py
    "heaps",
    "response_maps",
    "family",
    "pairs_against_bands",
    "box_sizes",
    "calibration_progress",
)


def figures_of(study: Study) -> list[str]:
    """Return the names of a study's figures in the order of its page."""
    return FIGURES[study.case.name](study)


def _figures_of_samples(study: Study) -> list[str]:
    several = len(study.design_rows) > 1 and any(run.surface == "plain" for run in study.runs)
    several_shown = FLOW if len(study.design_rows) > 1 else [name for name in FLOW if name != SECOND_ROW]
    names = [
        *(CONFIRMING if study.confirms else ()),
        *(PARTICLE_SIZE if varies_scale(study) else ()),
        *(COMPARING_ROWS if several else ()),
        *(several_shown if study.finds_regimes else ()),
        *(REGRESSION if study.factors else ()),
        *OF_SAMPLES,
        *(OF_WEAR_UPDATES if is_deformed(study) else ()),
    ]
    return list(dict.fromkeys(names))


def _figures_of_pins(study: Study) -> list[str]:
    series = {row["series"] for row in study.design_rows}
    left_out = [name for wanted, names in OF_SERIES.items() if wanted not in series for name in names]
    return [name for name in OF_PINS if name not in left_out]


def _figures_of_testers(study: Study) -> list[str]:
    series = {row["series"] for row in study.design_rows}
    jobs = [name for name in TESTER_FIGURES if TESTER_SERIES.get(name, "volume") in series]
    return [*(figure for name in jobs for figure in TESTER_FIGURES[name][1]), *OF_TESTED_SAMPLES]


RUN_RULES = {  # case -> rules that make a job of every run
    "sliding_sample": ("surface_mesh", "worn_run"),
    "pin_on_disc": ("surface_mesh", "worn_run", "track_tables"),
    "circular_tester": ("surface_mesh", "worn_run"),
}
FIGURES = {  # case -> names of a study's figures
    "sliding_sample": _figures_of_samples,
    "pin_on_disc": _figures_of_pins,
    "circular_tester": _figures_of_testers,
    "calibration": lambda study: list(OF_CALIBRATIONS),
}


def figure_file(name: str) -> str:
    """Return the file name of a figure."""
    return f"{name}.{'html' if name in INTERACTIVE else 'gif' if name in FILMS else 'png'}"


def figure_files(study: Study) -> list[str]:
    """Return the paths of all figures of a study."""
    return [f"results/{study.name}/figures/{figure_file(name)}" for name in figures_of(study)]


def page_templates(study: Study) -> list[str]:
    """Return the paths of the templates of a study's page."""
    page = page_of(study.case.name)
    return [str(REPORT_FOLDER / name) for name in (TEMPLATE, STYLE, page.KEY_NUMBERS, *page.FURTHER_TEMPLATES)]


def has_findings(study: Study) -> bool:
    """Return whether a study can be held against the source's findings: it has some of its rows, and their regimes."""
    return study.case.name == "sliding_sample" and study.finds_regimes and bool(published_rows(study))


def regression_table(study: Study, name: str) -> str | list[str]:
    """Return the path of a table of the study's regression, an empty list without one."""
    return f"results/{study.name}/regression/{name}.csv" if study.factors else []


def finding_tables(study: Study) -> list[str]:
    """Return the paths of the tables of findings, best designs and particle size that the page of a study shows."""
    names = ["findings/findings", "findings/runs"] if has_findings(study) else []
    names += ["confirmation/prediction", "confirmation/design"] if study.factors else []
    names += [f"particle_size/{name}" for name in SIZE_TABLES] if varies_scale(study) else []
    return [f"results/{study.name}/{name}.csv" for name in names]


def varies_scale(study: Study) -> bool:
    """Return whether a study is one of particle size: the rows of its sliding samples give their particle scale."""
    return study.case.name == "sliding_sample" and any(PARTICLE_SCALE in row for row in study.design_rows)


def published_flow(study: Study) -> str:
    """Return the table of what the source tells of the flow: of its chapter 4 for particle size, else of chapter 3."""
    return f"config/published/{'particle_size' if varies_scale(study) else 'screening'}_results.csv"


def plain_runs(study: Study) -> dict[str, Run]:
    """Return the plain runs of a study, by name."""
    return {run.name: run for run in study.runs if run.surface == "plain"}


def is_deformed(study: Study) -> bool:
    """Return whether wear is applied to the samples of a study, which then lose thickness."""
    return bool(study.settings["wear"]["deform"])


def job_names(study: Study) -> list[str]:
    """Return the names of all jobs behind a study's page, as their benchmark files are named."""
    return [
        "design_table",
        "summary",
        *(f"settled_bed_{bed}" for bed in study.beds),
        *(f"{rule}_{run.name}" for run in study.runs for rule in RUN_RULES[study.case.name]),
        *dict.fromkeys(job_of_figure(name) for name in figures_of(study)),
        *(("tester_tables",) if study.case.name == "circular_tester" else ()),
        *(("findings",) if has_findings(study) else ()),
        *(("best_designs",) if study.factors else ()),
        *(("size_findings",) if varies_scale(study) else ()),
    ]


def job_of_figure(name: str) -> str:
    """Return the name of the job that draws a figure."""
    tester_job = next((job for job, (_, figures) in TESTER_FIGURES.items() if name in figures), None)
    return tester_job or ("regression" if name in REGRESSION else "profiles" if name in PROFILES else name)


def page_parameters(study: Study) -> dict[str, Any]:
    """Return everything that a study's page says about its configuration, JSON-able."""
    return {
        "name": study.name,
        "case": study.case.name,
        "title": study.title,
        "question": study.question,
        "fidelity": study.fidelity,
        "settings": study.settings,
        "paper_settings": study.paper_settings,
        "design_rows": list(study.design_rows),
        "remarks": figure_remarks(study),
        "figures": figures_of(study),
        "factors": study.factors,
        "findings": has_findings(study),
        "varies_scale": varies_scale(study),
        "replicates": replicate_settings(study) if study.case.name == "sliding_sample" else {},
        "jobs": job_names(study),
        "runs": {run.name: {"row": run.row, "surface": run.surface} for run in study.runs},
        "parameters": {run.name: run.parameters for run in study.runs},
        "beds": list(study.beds),
        "bed_of": {run.name: study.bed_of(run.name) for run in study.runs},
    }


def factor_labels(study: Study) -> dict[str, str]:
    """Return {short name: name and unit for an axis} of the factors of a study's regression."""
    named = {short: name_and_unit(column) for short, column in study.factors.items()}
    return {short: f"{name.capitalize()} {short} ({unit})" for short, (name, unit) in named.items()}


def flow_runs(study: Study) -> dict[str, dict[str, float]]:
    """Return by run what the bins of its flow need, see `workflows.cases.sliding_sample.flow_history.RunFlow`."""
    return {run.name: flow_measures(run.parameters) for run in study.runs}


def flow_velocities(study: Study) -> dict[str, float]:
    """Return the velocity of the bed (m/s) by run."""
    return {run.name: run.parameters["sliding"]["velocity_m_per_s"] for run in study.runs}


def passing_beds(study: Study) -> dict[str, dict[str, float]]:
    """Return by run what the mass that passes its sample depends on, see `evaluation.wear_rate`."""
    return {run.name: _passing_bed(run.parameters) for run in study.runs}


def _passing_bed(parameters: dict[str, Any]) -> dict[str, float]:
    particle, bed = parameters["particle"], parameters["bed"]
    return {
        "velocity": parameters["sliding"]["velocity_m_per_s"],
        "thickness": bed["thickness_m"],
        "width": bed["width_m"],
        "bulk_density": particle["density_kg_per_m3"] * particle["bulk_solid_fraction"],
    }


def published_rows(study: Study) -> dict[str, str]:
    """Return {row: row of Yan 2022, Table 3.8} of the rows, and settings of replicates, that have its factors."""
    with open(PUBLISHED_DESIGN, encoding="utf-8", newline="") as stream:
        published = {tuple(float(row[name]) for name in PATTERN): row["row"] for row in csv.DictReader(stream)}
    levels = {str(row["row"]): tuple(row.get(name) for name in PATTERN) for row in study.design_rows}
    same = {row: published[found] for row, found in levels.items() if found in published}
    settings = replicate_settings(study)
    return same | {settings[row]: theirs for row, theirs in same.items()}


def replicate_settings(study: Study) -> dict[str, str]:
    """Return {row: name of its setting}; rows that differ in nothing but their seed have the same.

    The name is R5 of R5-1 and R5-2, or that of the first of them where they are named otherwise.
    """
    groups: dict[tuple, list[str]] = {}
    for row in study.design_rows:
        key = tuple(sorted((name, value) for name, value in row.items() if name not in ("row", "seed")))
        groups.setdefault(key, []).append(str(row["row"]))
    stems = [{re.sub(r"-\d+$", "", row) for row in rows} for rows in groups.values()]
    names = [
        stem.copy().pop() if len(rows) > 1 and len(stem) == 1 and stems.count(stem) == 1 else rows[0]
        for stem, rows in zip(stems, groups.values(), strict=True)
    ]
    return {row: name for name, rows in zip(names, groups.values(), strict=True) for row in rows}


def bumps_and_particles(study: Study) -> dict[str, dict[str, Any]]:
    """Return by row pattern, real particles and scale of its convex run, see `guidance`."""
    return {run.row: _bumps_and_particles(run.parameters) for run in study.runs if run.parameters["pattern"]}


def _bumps_and_particles(parameters: dict[str, Any]) -> dict[str, Any]:
    pattern, particle = parameters["pattern"], parameters["particle"]
    lengths = ("major_radius", "minor_radius", "height", "column_spacing", "row_spacing")
    return {
        "pattern": {name: pattern[f"{name}_m"] for name in lengths}
        | {"across": pattern["major_axis"] == "across_travel"},
        "particles": {
            "median_diameter": particle["median_diameter_m"] / particle["scale"],
            "diameters": [diameter / particle["scale"] for diameter in particle["diameters_m"]],
            "mass_fractions": particle["mass_fractions"],
        },
        "scale": particle["scale"],
    }


def equivalent_size_ratios(study: Study) -> dict[str, float | None]:
    """Return alpha_ER by run; None for a plain one."""
    return {run.name: run.parameters["derived"]["equivalent_size_ratio"] for run in study.runs}
