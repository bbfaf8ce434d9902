"""Figures of screening studies: their runs by flow regime, and the motion of the bed over them layer by layer."""

from workflows.report.figures import CONDITIONS, PATTERN, flow_velocities, passing_beds, published_flow, regression_table

REGIMES = "results/{study}/flow/regimes.csv"


rule wear_gradient:
    input:
        design="results/{study}/design.csv",
        # the stretches of travel within cycles lie beside these
        wear=WEAR_TABLES,
        regimes=REGIMES,
        along="results/{study}/figures/relative_velocity.csv",
        published=lambda wildcards: published_flow(study_of(wildcards)),
    output:
        figure=report(
            "results/{study}/figures/wear_gradient.png",
            caption="../../../report/wear_gradient.rst",
            category="Wear",
            labels={"figure": "Relative wear gradient"},
        ),
        table="results/{study}/figures/wear_gradient.csv",
        steady="results/{study}/flow/steady.csv",
    log:
        "results/{study}/logs/wear_gradient.log",
    benchmark:
        "results/{study}/logs/wear_gradient.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        run_in=lambda wildcards: study_of(wildcards).settings["sliding"]["run_in_mm"],
    message:
        "Figure of the relative wear gradient of {wildcards.study}"
    script:
        "../../../scripts/wear_gradient.py"


rule wear_by_regime:
    input:
        summary="results/{study}/summary.csv",
        regimes=REGIMES,
    output:
        figure=report(
            "results/{study}/figures/wear_by_regime.png",
            caption="../../../report/wear_by_regime.rst",
            category="Wear",
            labels={"figure": "Relative wear by flow regime"},
        ),
        table="results/{study}/figures/wear_by_regime.csv",
    log:
        "results/{study}/logs/wear_by_regime.log",
    benchmark:
        "results/{study}/logs/wear_by_regime.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        settings=lambda wildcards: replicate_settings(study_of(wildcards)),
        beds=lambda wildcards: passing_beds(study_of(wildcards)),
    message:
        "Figure of the relative wear by regime of {wildcards.study}"
    script:
        "../../../scripts/wear_by_regime.py"


rule normal_force_by_regime:
    input:
        summary="results/{study}/summary.csv",
        wear=WEAR_TABLES,
        regimes=REGIMES,
    output:
        figure=report(
            "results/{study}/figures/normal_force_by_regime.png",
            caption="../../../report/normal_force_by_regime.rst",
            category="Bed",
            labels={"figure": "Normal force by flow regime"},
        ),
        table="results/{study}/figures/normal_force_by_regime.csv",
    log:
        "results/{study}/logs/normal_force_by_regime.log",
    benchmark:
        "results/{study}/logs/normal_force_by_regime.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        settings=lambda wildcards: replicate_settings(study_of(wildcards)),
    message:
        "Figure of the normal force by regime of {wildcards.study}"
    script:
        "../../../scripts/normal_force_by_regime.py"


rule profiles:
    input:
        summary="results/{study}/summary.csv",
        regimes=REGIMES,
        along="results/{study}/figures/relative_velocity.csv",
        bins="results/{study}/flow/moving_bins.csv",
        published="config/published/screening_profiles.csv",
    output:
        velocity=report(
            "results/{study}/figures/velocity_profiles.png",
            caption="../../../report/velocity_profiles.rst",
            category="Bed",
            labels={"figure": "Velocity profiles"},
        ),
        velocity_table="results/{study}/figures/velocity_profiles.csv",
        angular=report(
            "results/{study}/figures/angular_velocity_profiles.png",
            caption="../../../report/angular_velocity_profiles.rst",
            category="Bed",
            labels={"figure": "Profiles of the angular speed"},
        ),
        angular_table="results/{study}/figures/angular_velocity_profiles.csv",
        every_row="results/{study}/flow/profiles.csv",
    log:
        "results/{study}/logs/profiles.log",
    benchmark:
        "results/{study}/logs/profiles.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        velocities=lambda wildcards: flow_velocities(study_of(wildcards)),
        published_rows=lambda wildcards: published_rows(study_of(wildcards)),
    message:
        "Profiles of the flow of {wildcards.study}"
    script:
        "../../../scripts/profiles.py"


use rule flow_views as flow_views_second with:
    output:
        figure=report(
            "results/{study}/figures/flow_views_second.png",
            caption="../../../report/flow_views_second.rst",
            category="Bed",
            labels={"figure": "Views of the flow, second row"},
        ),
        table="results/{study}/figures/flow_views_second.csv",
    log:
        "results/{study}/logs/flow_views_second.log",
    benchmark:
        "results/{study}/logs/flow_views_second.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        published_rows=lambda wildcards: published_rows(study_of(wildcards)),
        place=1,
    message:
        "Figure of the flow of {wildcards.study} over a second row"


rule findings:
    input:
        summary="results/{study}/summary.csv",
        regimes=REGIMES,
        profiles="results/{study}/flow/profiles.csv",
        gradients="results/{study}/figures/wear_gradient.csv",
        steady="results/{study}/flow/steady.csv",
        # none of a study with too few rows for a regression
        coefficients=lambda wildcards: regression_table(study_of(wildcards), "coefficients"),
        models=lambda wildcards: regression_table(study_of(wildcards), "models"),
        published_findings="config/published/screening_findings.csv",
        published_regimes="config/published/screening_regimes.csv",
        published_results="config/published/screening_results.csv",
        published_coefficients="config/published/screening_coefficients.csv",
        published_design="config/designs/screening.csv",
    output:
        findings="results/{study}/findings/findings.csv",
        runs="results/{study}/findings/runs.csv",
    log:
        "results/{study}/logs/findings.log",
    benchmark:
        "results/{study}/logs/findings.benchmark.tsv"
    params:
        factors=lambda wildcards: study_of(wildcards).factors,
        run_in=lambda wildcards: study_of(wildcards).settings["sliding"]["run_in_mm"],
        settings=lambda wildcards: replicate_settings(study_of(wildcards)),
        published_rows=lambda wildcards: published_rows(study_of(wildcards)),
    message:
        "Findings of the source beside those of {wildcards.study}"
    script:
        "../../../scripts/findings.py"


rule best_designs:
    input:
        summary="results/{study}/summary.csv",
        regimes=REGIMES,
    output:
        design="results/{study}/confirmation/design.csv",
        prediction="results/{study}/confirmation/prediction.csv",
    log:
        "results/{study}/logs/best_designs.log",
    benchmark:
        "results/{study}/logs/best_designs.benchmark.tsv"
    params:
        factors=lambda wildcards: study_of(wildcards).factors,
        conditions=CONDITIONS,
        columns=PATTERN,
        fidelity=lambda wildcards: study_of(wildcards).fidelity,
    message:
        "Best designs of {wildcards.study}, to be simulated by {wildcards.study}_confirmation"
    script:
        "../../../scripts/best_designs.py"


rule confirmation:
    input:
        summary="results/{study}/summary.csv",
        regimes=REGIMES,
        prediction=lambda wildcards: f"results/{study_of(wildcards).confirms}/confirmation/prediction.csv",
    output:
        figure=report(
            "results/{study}/figures/confirmation.png",
            caption="../../../report/confirmation.rst",
            category="Regression",
            labels={"figure": "Best designs, predicted and simulated"},
        ),
        table="results/{study}/figures/confirmation.csv",
    log:
        "results/{study}/logs/confirmation.log",
    benchmark:
        "results/{study}/logs/confirmation.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        fidelity=lambda wildcards: study_of(wildcards).fidelity,
    message:
        "Predicted and simulated wear of {wildcards.study}"
    script:
        "../../../scripts/confirmation.py"
