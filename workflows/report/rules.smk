"""Figures of a study, and its page."""

from workflows.report.remarks import figure_remarks
from workflows.report.figures import (
    equivalent_size_ratios,
    factor_labels,
    figure_files,
    finding_tables,
    flow_runs,
    is_deformed,
    page_parameters,
    page_templates,
    published_flow,
    published_rows,
    replicate_settings,
)

WORN_SURFACES = of_every_run("results/{study}/{run}/worn_surface.vtu")
WEAR_TABLES = of_every_run("results/{study}/{run}/wear.csv")


rule design_table:
    output:
        "results/{study}/design.csv",
    log:
        "results/{study}/logs/design_table.log",
    benchmark:
        "results/{study}/logs/design_table.benchmark.tsv"
    params:
        rows=lambda wildcards: study_of(wildcards).design_table(),
    message:
        "Design table of {wildcards.study}"
    script:
        "../scripts/design_table.py"


rule summary:
    input:
        design="results/{study}/design.csv",
        wear=of_every_run("results/{study}/{run}/wear.csv"),
        pristine=of_every_run("results/{study}/{run}/surface.vtu"),
        worn=of_every_run("results/{study}/{run}/worn_surface.vtu"),
    output:
        "results/{study}/summary.csv",
    log:
        "results/{study}/logs/summary.log",
    benchmark:
        "results/{study}/logs/summary.benchmark.tsv"
    params:
        case=case_of,
    message:
        "Summary of {wildcards.study}"
    script:
        "../scripts/summary.py"


rule worn_surface:
    input:
        design="results/{study}/design.csv",
        surfaces=WORN_SURFACES,
    output:
        figure=report(
            "results/{study}/figures/worn_surface.png",
            caption="worn_surface.rst",
            category="Wear",
            labels={"figure": "Worn surfaces"},
        ),
        table="results/{study}/figures/worn_surface.csv",
    log:
        "results/{study}/logs/worn_surface.log",
    benchmark:
        "results/{study}/logs/worn_surface.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        deformed=lambda wildcards: is_deformed(study_of(wildcards)),
    message:
        "Figure of the worn surfaces of {wildcards.study}"
    script:
        "../scripts/worn_surface.py"


rule worn_surface_3d:
    input:
        summary="results/{study}/summary.csv",
        surfaces=WORN_SURFACES,
    output:
        report(
            "results/{study}/figures/worn_surface_3d.html",
            caption="worn_surface_3d.rst",
            category="Wear",
            labels={"figure": "Worn surfaces, interactive"},
        ),
    log:
        "results/{study}/logs/worn_surface_3d.log",
    benchmark:
        "results/{study}/logs/worn_surface_3d.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        deformed=lambda wildcards: is_deformed(study_of(wildcards)),
    message:
        "Interactive worn surfaces of {wildcards.study}"
    script:
        "../scripts/worn_surface_3d.py"


rule wear_against_travel:
    input:
        design="results/{study}/design.csv",
        wear=WEAR_TABLES,
    output:
        figure=report(
            "results/{study}/figures/wear_against_travel.png",
            caption="wear_against_travel.rst",
            category="Wear",
            labels={"figure": "Wear against travel"},
        ),
        table="results/{study}/figures/wear_against_travel.csv",
    log:
        "results/{study}/logs/wear_against_travel.log",
    benchmark:
        "results/{study}/logs/wear_against_travel.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of wear against travel of {wildcards.study}"
    script:
        "../scripts/wear_against_travel.py"


rule wear_split:
    input:
        "results/{study}/summary.csv",
    output:
        figure=report(
            "results/{study}/figures/wear_split.png",
            caption="wear_split.rst",
            category="Wear",
            labels={"figure": "Wear of base and bumps"},
        ),
        table="results/{study}/figures/wear_split.csv",
    log:
        "results/{study}/logs/wear_split.log",
    benchmark:
        "results/{study}/logs/wear_split.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the wear of base and bumps of {wildcards.study}"
    script:
        "../scripts/wear_split.py"


rule depth_distribution:
    input:
        design="results/{study}/design.csv",
        depths="results/{study}/figures/worn_surface.csv",
    output:
        figure=report(
            "results/{study}/figures/depth_distribution.png",
            caption="depth_distribution.rst",
            category="Wear",
            labels={"figure": "Distribution of depth"},
        ),
        table="results/{study}/figures/depth_distribution.csv",
    log:
        "results/{study}/logs/depth_distribution.log",
    benchmark:
        "results/{study}/logs/depth_distribution.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        deformed=lambda wildcards: is_deformed(study_of(wildcards)),
    message:
        "Figure of the distribution of depth of {wildcards.study}"
    script:
        "../scripts/depth_distribution.py"


rule bed:
    input:
        summary="results/{study}/summary.csv",
        surfaces=WORN_SURFACES,
    output:
        figure=report(
            "results/{study}/figures/bed.png",
            caption="bed.rst",
            category="Bed",
            labels={"figure": "Bed over the sample"},
        ),
        table="results/{study}/figures/bed.csv",
    log:
        "results/{study}/logs/bed.log",
    benchmark:
        "results/{study}/logs/bed.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the bed of {wildcards.study}"
    script:
        "../scripts/bed.py"


rule forces:
    input:
        design="results/{study}/design.csv",
        wear=WEAR_TABLES,
    output:
        figure=report(
            "results/{study}/figures/forces.png",
            caption="forces.rst",
            category="Bed",
            labels={"figure": "Forces on the sample"},
        ),
        table="results/{study}/figures/forces.csv",
    log:
        "results/{study}/logs/forces.log",
    benchmark:
        "results/{study}/logs/forces.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the forces on the samples of {wildcards.study}"
    script:
        "../scripts/forces.py"


rule wear_updates:
    input:
        design="results/{study}/design.csv",
        wear=WEAR_TABLES,
    output:
        figure=report(
            "results/{study}/figures/wear_updates.png",
            caption="wear_updates.rst",
            category="Wear",
            labels={"figure": "What each wear update did"},
        ),
        table="results/{study}/figures/wear_updates.csv",
    log:
        "results/{study}/logs/wear_updates.log",
    benchmark:
        "results/{study}/logs/wear_updates.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        angle_bound=lambda wildcards: study_of(wildcards).settings["remeshing"]["smallest_angle_deg"],
    message:
        "Figure of the wear updates of {wildcards.study}"
    script:
        "../scripts/wear_updates.py"


rule worn_film:
    input:
        summary="results/{study}/summary.csv",
        # the surfaces of the cycles, whose number may follow from the wear, lie beside these
        wear=WEAR_TABLES,
        surfaces=WORN_SURFACES,
        pristine=of_every_run("results/{study}/{run}/surface.vtu"),
    output:
        figure=report(
            "results/{study}/figures/worn_film.gif",
            caption="worn_film.rst",
            category="Wear",
            labels={"figure": "The sample wears, a film"},
        ),
        table="results/{study}/figures/worn_film.csv",
    log:
        "results/{study}/logs/worn_film.log",
    benchmark:
        "results/{study}/logs/worn_film.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Film of the wear of {wildcards.study}"
    script:
        "../scripts/worn_film.py"


rule wear_law_comparison:
    input:
        "results/{study}/summary.csv",
    output:
        figure=report(
            "results/{study}/figures/wear_law_comparison.png",
            caption="wear_law_comparison.rst",
            category="Wear laws",
            labels={"figure": "Archard and Finnie"},
        ),
        table="results/{study}/figures/wear_law_comparison.csv",
    log:
        "results/{study}/logs/wear_law_comparison.log",
    benchmark:
        "results/{study}/logs/wear_law_comparison.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the wear laws of {wildcards.study}"
    script:
        "../scripts/wear_law_comparison.py"


rule relative_wear:
    input:
        summary="results/{study}/summary.csv",
        history="results/{study}/figures/wear_against_travel.csv",
        published="config/published/screening_results.csv",
    output:
        figure=report(
            "results/{study}/figures/relative_wear.png",
            caption="relative_wear.rst",
            category="Wear",
            labels={"figure": "Convex over plain"},
        ),
        table="results/{study}/figures/relative_wear.csv",
    log:
        "results/{study}/logs/relative_wear.log",
    benchmark:
        "results/{study}/logs/relative_wear.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        size_ratios=lambda wildcards: equivalent_size_ratios(study_of(wildcards)),
        settings=lambda wildcards: replicate_settings(study_of(wildcards)),
        published_rows=lambda wildcards: published_rows(study_of(wildcards)),
    message:
        "Figure of the relative wear of {wildcards.study}"
    script:
        "../scripts/relative_wear.py"


rule regression:
    input:
        summary="results/{study}/summary.csv",
        published="config/published/screening_coefficients.csv",
        published_contours="config/published/screening_contours.csv",
    output:
        figure_coefficients=report(
            "results/{study}/figures/regression_coefficients.png",
            caption="regression_coefficients.rst",
            category="Regression",
            labels={"figure": "Coefficients of the regression"},
        ),
        table_coefficients="results/{study}/figures/regression_coefficients.csv",
        figure_residuals=report(
            "results/{study}/figures/regression_residuals.png",
            caption="regression_residuals.rst",
            category="Regression",
            labels={"figure": "Residuals of the regression"},
        ),
        table_residuals="results/{study}/figures/regression_residuals.csv",
        figure_half_normal=report(
            "results/{study}/figures/regression_half_normal.png",
            caption="regression_half_normal.rst",
            category="Regression",
            labels={"figure": "Half-normal plot of effects"},
        ),
        table_half_normal="results/{study}/figures/regression_half_normal.csv",
        figure_contours=report(
            "results/{study}/figures/regression_contours.png",
            caption="regression_contours.rst",
            category="Regression",
            labels={"figure": "Contours of the predicted wear"},
        ),
        table_contours="results/{study}/figures/regression_contours.csv",
        coefficients="results/{study}/regression/coefficients.csv",
        models="results/{study}/regression/models.csv",
        residuals="results/{study}/regression/residuals.csv",
        effects="results/{study}/regression/effects.csv",
        surface="results/{study}/regression/surface.csv",
        aliasing="results/{study}/regression/aliasing.csv",
        best_designs="results/{study}/regression/best_designs.csv",
        warnings="results/{study}/regression/warnings.csv",
    log:
        "results/{study}/logs/regression.log",
    benchmark:
        "results/{study}/logs/regression.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        factors=lambda wildcards: study_of(wildcards).factors,
        labels=lambda wildcards: factor_labels(study_of(wildcards)),
    message:
        "Regression of the wear of {wildcards.study}"
    script:
        "../scripts/regression.py"


rule flow_views:
    input:
        regimes=regimes_of_study,
        summary="results/{study}/summary.csv",
        surfaces=WORN_SURFACES,
    output:
        figure=report(
            "results/{study}/figures/flow_views.png",
            caption="flow_views.rst",
            category="Bed",
            labels={"figure": "Views of the flow"},
        ),
        table="results/{study}/figures/flow_views.csv",
    log:
        "results/{study}/logs/flow_views.log",
    benchmark:
        "results/{study}/logs/flow_views.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        published_rows=lambda wildcards: published_rows(study_of(wildcards)),
        place=0,
    message:
        "Figure of the flow of {wildcards.study}"
    script:
        "../scripts/flow_views.py"


rule relative_velocity:
    input:
        design="results/{study}/design.csv",
        # the snapshots of the bed lie beside these
        wear=WEAR_TABLES,
        costs=of_every_run("results/{study}/{run}/cost.csv"),
        published=lambda wildcards: published_flow(study_of(wildcards)),
    output:
        figure=report(
            "results/{study}/figures/relative_velocity.png",
            caption="relative_velocity.rst",
            category="Bed",
            labels={"figure": "Relative velocity of the particles"},
        ),
        table="results/{study}/figures/relative_velocity.csv",
        bins="results/{study}/flow/moving_bins.csv",
        regimes="results/{study}/flow/regimes.csv",
    log:
        "results/{study}/logs/relative_velocity.log",
    benchmark:
        "results/{study}/logs/relative_velocity.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        runs=lambda wildcards: flow_runs(study_of(wildcards)),
        run_in=lambda wildcards: study_of(wildcards).settings["sliding"]["run_in_mm"],
    message:
        "Relative velocity of the particles of {wildcards.study}"
    script:
        "../scripts/flow.py"


rule report:
    input:
        lambda wildcards: figure_files(study_of(wildcards)),
        summary="results/{study}/summary.csv",
        design="results/{study}/design.csv",
        costs=of_every_run("results/{study}/{run}/cost.csv"),
        findings=lambda wildcards: finding_tables(study_of(wildcards)),
        forecast="results/{study}/forecast.csv",
        templates=lambda wildcards: page_templates(study_of(wildcards)),
    output:
        "results/{study}/report.html",
    log:
        "results/{study}/logs/report.log",
    params:
        study=lambda wildcards: page_parameters(study_of(wildcards)),
    message:
        "Page of {wildcards.study}"
    script:
        "../scripts/report.py"
