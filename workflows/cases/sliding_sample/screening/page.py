"""Sections of the page of a study whose flow regimes are found: patterned beside plain, the source's findings, the
flow, and, where the study has a regression, its models and best designs.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.tables.display import in_display_units
from bulkwear.postproc.tables.packings import BY, over_packings
from bulkwear.postproc.tables.summary import patterned_name, read_summary
from bulkwear.workflows.cases.sliding_sample.screening.profile_numbers import profile_values
from bulkwear.workflows.cases.sliding_sample.study import compares_surfaces, has_findings, published_rows
from bulkwear.workflows.config.claims import date_of_rules
from bulkwear.workflows.report.sections import Block, Pictures, Points, Section, Table, Text
from bulkwear.workflows.report.sensitivity import read_indices, sensitivity_blocks

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Study

TEXTS = (  # columns of words, which may be empty
    *("model", "given", "not_in_model", "warning"),
    *("claimed", "found", "reason", "published_regime", "published_wear_over_plain"),
)
HEADS = {"row": ("regime", "")}  # of tables whose rows are the best designs of the regimes
OF_RUNS = {"setting": ("regime", "")}  # of tables whose rows are runs of these
SENSITIVITY = "figures/regression_sensitivity.csv"
SIMULATED = "figures/confirmation.csv"


def told(study: Study) -> dict[str, Any]:
    """Return what the sections are told of a study."""
    return {
        "factors": study.factors,
        "findings": has_findings(study),
        "confirms": study.confirms,
        "compares_surfaces": compares_surfaces(study),
        "published_rows": published_rows(study),
    }


def sections(study: Mapping[str, Any], folder: Path) -> list[Section]:
    """Return the sections of a study; one of particle size has tables of its own of wear and steady flow, by scale."""
    of_study, by_scale = study["told"], study["told"]["varies_scale"]
    wear = [] if by_scale else [Table(wear_by_row(study, folder), "wear_by_row")]
    steady = [] if by_scale else steady_windows(folder)
    profiles = ("velocity_profiles", "angular_velocity_profiles")
    of_wear = "Wear over the plain twin" if of_study["compares_surfaces"] else "Wear by flow regime"
    return [
        *([confirmed(folder)] if of_study["confirms"] else []),
        Section(of_wear, [*wear, Pictures(["wear_by_regime", "normal_force_by_regime"])]),
        *(findings(study, folder) if of_study["findings"] else []),
        Section("Steady or not", [*steady, Pictures(["relative_velocity", "wear_gradient"])]),
        Section("The flow", [Pictures(["flow_views", "flow_views_second", *profiles]), *profile_values(study, folder)]),
        *([regression(folder), best_designs(study["name"], folder)] if of_study["factors"] else []),
    ]


def read_with_texts(path: Path) -> pd.DataFrame:
    """Return a table in which empty cells of the columns TEXTS are empty words, not missing numbers."""
    table = pd.read_csv(path, dtype=dict.fromkeys((*TEXTS, "row"), object))
    return table.assign(**{name: table[name].fillna("") for name in TEXTS if name in table})


def wear_by_row(study: Mapping[str, Any], folder: Path) -> pd.DataFrame:
    """Return wear, forces and regime of every setting, patterned beside plain, with the interval of wear over plain."""
    summary = read_summary(folder / "summary.csv")
    regimes = read_summary(folder / "flow" / "regimes.csv")
    patterned, plain = (
        summary[(summary["surface"] == PLAIN) == which].set_index("row", drop=False) for which in (False, True)
    )
    flow = regimes.set_index("run").reindex(patterned["run"]).set_index(patterned.index)
    volume, rate = patterned["worn_volume_m3"], "worn_volume_per_metre_m3_per_m"
    runs = patterned[list(BY)].assign(
        particle_scale=[study["parameters"][run]["particle"]["scale"] for run in patterned["run"]],
        regime=flow["regime"],
        flow_steady=flow["steady"].map({True: "yes", False: "not shown"}),
        relative_velocity_percent=100.0 * flow["relative_velocity"],
        wear_over_plain=patterned["wear_over_plain"],
        patterned_wear_m3_per_m=patterned[rate],
        plain_wear_m3_per_m=plain[rate].reindex(patterned.index),
        pattern_share_percent=100.0 * patterned["pattern_worn_volume_m3"] / volume,
        normal_force_over_plain=patterned["mean_normal_force_N"]
        / plain["mean_normal_force_N"].reindex(patterned.index),
    )
    table = over_packings(runs, "wear_over_plain").drop(columns="surface")
    if plain.empty:
        table["packings"] = np.nan  # those that wear over plain has, which is not told
    named = {"setting": "row", "patterned_wear_m3_per_m": f"{patterned_name(summary['surface'])}_wear_m3_per_m"}
    first = ["setting", "particle_scale", "regime", "flow_steady", "packings", "wear_over_plain"]
    first += ["interval_low", "interval_high"]
    ordered = table[[*first, *table.columns.drop(first)]].dropna(axis="columns", how="all")
    return in_display_units(ordered.rename(columns=named))


def steady_windows(folder: Path) -> list[Block]:
    """Return the steady window of the flow and the wear of every run."""
    table = read_summary(folder / "flow" / "steady.csv")
    return [
        Text(f"{int(table['steady'].sum())} of {len(table)} windows are steady. Travel counts from where wear does."),
        Table(table.drop(columns=["row", "surface", "published_mean", "published_deviation"]), "steady"),
    ]


def findings(study: Mapping[str, Any], folder: Path) -> list[Section]:
    """Return the verdicts on the source's findings, and its rows beside ours."""
    verdicts = read_with_texts(folder / "findings" / "findings.csv").drop(columns="key").dropna(axis=1, how="all")
    runs = read_with_texts(folder / "findings" / "runs.csv")
    counts = ", ".join(f"{count} {verdict}" for verdict, count in verdicts["verdict"].value_counts().items())
    asked = (
        "Each finding of Yan 2022, chapter 3, as a claim with its margin (config/published/verdicts.yaml, of "
        f"{date_of_rules('screening')}, which tells what came after runs), against the runs of this page"
        f"{', at the sizes told at its top' if study['remarks'] else ''}. Of {len(verdicts)} claims: {counts}."
    )
    note = (
        "Agrees: inside the margin, or on the claimed side, at an error rate of 5 %; contradicts: on the other side, "
        "or outside of a margin without a side, likewise; factor: what was found over the published size. The source "
        "analyses 1000 to 1700 mm of travel: runs that end before it say nothing unless their flow and wear are shown "
        "to be steady."
    )
    beside = (
        "The source's text tells single runs only; an empty cell is not told. Published model: exp of the regression "
        "of its Table 3.10 at the factors of the row, which is wear over the largest of the source, as normalised wear "
        "is over the largest here; the wear of its single runs is not in its text. Means over the packings; low and "
        "high: 95 % interval of wear over plain."
    )
    return [
        Section("Findings of the source", [Text(asked), Table(verdicts, "findings", note, beside_source=True)]),
        Section("Run by run beside the source", [Table(runs, "findings_runs", beside)]),
    ]


def regression(folder: Path) -> Section:
    """Return the models within reach of the best, its coefficients, and what a reader must know."""
    models, methods, coefficients, warnings = (
        read_with_texts(folder / "regression" / f"{name}.csv")
        for name in ("models", "methods", "coefficients", "warnings")
    )
    said = (
        "Models of ln(wear / largest wear) of the patterned samples, all within 2 of the best of their heredity by the "
        "criterion; the data do not tell them apart. Then the terms of the first beside those of AICc and of the "
        "two-step method for definitive screening designs, and the coefficients of the first, in coded units."
    )
    figures = [f"regression_{name}" for name in ("coefficients", "residuals", "half_normal", "contours")]
    blocks = [
        Text(said),
        Points([f"Mind: {warning}." for warning in warnings["warning"]]),
        Table(models, "regression_models"),
        Table(methods, "regression_methods"),
        Table(coefficients),
        Pictures(figures),
        *sensitivity_blocks(read_indices(folder / SENSITIVITY)),
        Pictures(["regression_sensitivity"]),
    ]
    return Section("Regression of the wear", blocks)


def best_designs(name: str, folder: Path) -> Section:
    """Return the designs of least wear as predicted, and what runs of each wore where there are any."""
    inside = read_with_texts(folder / "regression" / "best_designs.csv")
    predicted = in_display_units(read_with_texts(folder / "confirmation" / "prediction.csv"))
    run = folder.with_name(f"{folder.name}_confirmation") / SIMULATED
    of_ranges = (
        "Least wear inside the ranges by the first of these models, over the largest wear of the study, with the "
        "interval in which one further run falls at 95 %. Factors have the units of the design table; those that the "
        "model does not have stand at their middle."
    )
    of_regimes = (
        "Least wear in each flow regime, at the velocity and thickness, of those at which a run had it, where the "
        "least is predicted; per metre of travel, with the interval of one further run. The target "
        f"{name}_confirmation simulates these designs and sets the result against the prediction."
    )
    simulated = [Text("Simulated:"), Table(read_with_texts(run), heads=OF_RUNS)] if run.is_file() else []
    blocks = [
        Text(of_ranges),
        Table(inside.assign(given=inside["given"].replace("", "nothing")), "best_designs"),
        Text(of_regimes),
        Table(predicted, "best_designs_by_regime", heads=HEADS),
        *(simulated or [Text("Not simulated.")]),
    ]
    return Section("Best designs", blocks)


def confirmed(folder: Path) -> Section:
    """Return what runs of each best design wear beside what was predicted of it."""
    table = Table(read_with_texts(folder / SIMULATED), heads=OF_RUNS)
    return Section("Best designs, predicted and simulated", [table, Pictures(["confirmation"])])
