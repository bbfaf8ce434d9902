"""What the figures and the page of a study of sliding samples are told of its configuration."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from typing import Any

from bulkwear.postproc.mesh import PLAIN
from bulkwear.workflows.cases.sliding_sample.parameters import flow_measures
from bulkwear.workflows.config.design import Study
from bulkwear.workflows.config.factors import FACTORS
from bulkwear.workflows.config.layers import read_yaml
from bulkwear.workflows.engine.case import Run
from bulkwear.workflows.engine.pouring import bulk_density
from bulkwear.workflows.engine.project import PACKAGE
from bulkwear.workflows.report.text import name_and_unit

PUBLISHED_DESIGN = PACKAGE / "config" / "designs" / "screening.csv"  # Yan 2022, Table 3.8
PUBLISHED_LAYOUT = (
    PACKAGE / "config" / "cases" / "sliding_sample.yaml"
)  # its block `pattern`: of all rows of that table
LAYOUT = (
    "major_axis",
    "row_spacing_mm",
    "row_offset_fraction",
)  # keys of it; what a spacing is between is left open there
PARTICLE_SCALE = "particle_scale"  # column of a design whose study is one of particle size
CONDITIONS = ("velocity_m_per_s", "bed_thickness_mm")  # columns that are no property of the pattern
BUMPS = ("major_radius_mm", "minor_radius_mm", "column_spacing_mm", "height_mm")  # columns of its bumps
PATTERN = (*BUMPS, *CONDITIONS)  # columns that make two rows the same


def compares_rows(study: Study) -> bool:
    """Return whether a study sets patterned over plain wear of several settings side by side."""
    return len(study.chosen_settings) > 1 and compares_surfaces(study)


def compares_surfaces(study: Study) -> bool:
    """Return whether a study has patterned samples and plain ones, which wear is told over."""
    return {run.surface == PLAIN for run in study.runs} == {True, False}


def varies_scale(study: Study) -> bool:
    """Return whether a study is one of particle size: the rows of its sliding samples give their particle scale."""
    return any(PARTICLE_SCALE in row for row in study.design_rows)


def compares_sizes(study: Study) -> bool:
    """Return whether a study of particle size tells wear over that of plain samples."""
    return varies_scale(study) and compares_surfaces(study)


def finds_regimes(study: Study) -> bool:
    """Return whether the flow regimes of a study's runs are found: it names factors, whether or not its rows can tell
    of them, confirms a study that does, or is one of particle size.
    """
    return bool(study.head.get(FACTORS)) or varies_scale(study)


def has_findings(study: Study) -> bool:
    """Return whether a study can be held against the source's findings: it has some of its rows, and their regimes."""
    return finds_regimes(study) and bool(published_rows(study))


def named_factors(study: Study) -> dict[str, str]:
    """Return {short name: column of the design} of the factors that a study names, also where its rows are too few for
    a regression; empty without any.
    """
    return dict(study.head.get(FACTORS) or {})


def published_flow(study: Study) -> str:
    """Return the table of what the source tells of the flow: of its chapter 4 for particle size, else of chapter 3."""
    return f"config/published/{'particle_size' if varies_scale(study) else 'screening'}_results.csv"


def run_in(study: Study) -> float:
    """Return the travel (mm) before wear counts."""
    return study.settings["sliding"]["run_in_mm"]


def plain_runs(study: Study) -> dict[str, Run]:
    """Return the plain runs of a study, by name."""
    return {run.name: run for run in study.runs if run.surface == PLAIN}


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
        "bulk_density": bulk_density(particle),
    }


def published_rows(study: Study) -> dict[str, str]:
    """Return {row: row of Yan 2022, Table 3.8} of the rows, and settings of replicates, that have its bumps, as far
    apart and shifted as there.
    """
    if all(ratio is None for ratio in equivalent_size_ratios(study).values()):
        return {}
    levels = {str(row["row"]): row_levels(study, row) for row in study.design_rows}
    published = published_levels()
    same = {row: name for row, found in levels.items() for name, theirs in published.items() if found == theirs}
    settings = replicate_settings(study)
    return same | {settings[row]: theirs for row, theirs in same.items()}


def row_levels(study: Study, row: Mapping[str, Any], columns: Sequence[str] = PATTERN) -> dict[str, Any]:
    """Return what of a row is compared with those of the source: columns, and LAYOUT."""
    laid_out = study.settings["pattern"] | row
    return {name: row.get(name) for name in columns} | {key: laid_out.get(key) for key in LAYOUT}


def published_levels(columns: Sequence[str] = PATTERN) -> dict[str, dict[str, Any]]:
    """Return the same of every row of Yan 2022, Table 3.8, by its name."""
    layout = read_yaml(PUBLISHED_LAYOUT, PACKAGE).values["pattern"]
    with open(PUBLISHED_DESIGN, encoding="utf-8", newline="") as stream:
        rows = {row["row"]: {name: float(row[name]) for name in columns} for row in csv.DictReader(stream)}
    return {name: row | {key: layout[key] for key in LAYOUT} for name, row in rows.items()}


def replicate_settings(study: Study) -> dict[str, str]:
    """Return {row: name of its setting}; rows that differ in nothing but their seed have the same."""
    return {str(row["row"]): study.setting_of[str(row["row"])] for row in study.design_rows}


def equivalent_size_ratios(study: Study) -> dict[str, float | None]:
    """Return alpha_ER by run; None for one without bumps."""
    return {run.name: run.parameters["derived"]["equivalent_size_ratio"] for run in study.runs}
