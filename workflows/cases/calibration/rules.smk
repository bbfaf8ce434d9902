"""Calibrations: bulk tests simulated where a rule says, and what they tell about contact parameters."""

from workflows.report.figures import OF_CALIBRATIONS
from workflows.cases.calibration.page import page_parameters as calibration_parameters

CALIBRATIONS = "|".join(name for name in STUDIES if STUDIES[name].case.name == "calibration") or "no_calibration"
SIZES_BEFORE = f"{PUBLISHED_TABLES}/shear_box_sizes.csv"


localrules:
    bulk_test_deck,


# summary.csv and report.html of a calibration are made of other files than those of a wear study
ruleorder: calibration_results > summary
ruleorder: calibration_page > report


rule calibrated_parameters:
    input:
        measured=published_table("measured"),
        pairs=published_table("simulated_before"),
    output:
        simulations="results/{study}/simulations.csv",
        looks="results/{study}/looks.csv",
        repeats="results/{study}/repeats.csv",
    log:
        "results/{study}/logs/calibrated_parameters.log",
    benchmark:
        "results/{study}/logs/calibrated_parameters.benchmark.tsv"
    threads: calibration_threads
    resources:
        runtime=asked("calibrated_parameters", 0),
        mem_mb=asked("calibrated_parameters", 1),
    params:
        run=first_run,
        templates=[template_sources("shear_box"), template_sources("draw_down")],
    message:
        "Calibration of {wildcards.study}"
    script:
        "../../scripts/calibrated_parameters.py"


rule box_sizes:
    input:
        pairs=published_table("simulated_before"),
    output:
        "results/{study}/box_sizes.csv",
    log:
        "results/{study}/logs/box_sizes.log",
    benchmark:
        "results/{study}/logs/box_sizes.benchmark.tsv"
    threads: calibration_threads
    resources:
        runtime=asked("box_sizes", 0),
        mem_mb=asked("box_sizes", 1),
    params:
        runs=lambda wildcards: {run.name: run.parameters for run in study_of(wildcards).runs},
        templates=template_sources("shear_box"),
    message:
        "Shear boxes of other sizes"
    script:
        "../../scripts/box_sizes.py"


rule calibration_results:
    input:
        measured=published_table("measured"),
        pairs=published_table("simulated_before"),
        simulations="results/{study}/simulations.csv",
        looks="results/{study}/looks.csv",
        repeats="results/{study}/repeats.csv",
        sizes="results/{study}/box_sizes.csv",
        sizes_before=SIZES_BEFORE,
        design="results/{study}/design.csv",
    output:
        [
            report(
                f"results/{{study}}/figures/{name}.png",
                caption=f"../../report/{name}.rst",
                category="Calibration",
                labels={"figure": name.replace("_", " ").capitalize()},
            )
            for name in OF_CALIBRATIONS
        ],
        [f"results/{{study}}/figures/{name}.csv" for name in OF_CALIBRATIONS],
        summary="results/{study}/summary.csv",
        materials="results/{study}/materials.yaml",
    log:
        "results/{study}/logs/calibration_results.log",
    benchmark:
        "results/{study}/logs/calibration_results.benchmark.tsv"
    wildcard_constraints:
        study=CALIBRATIONS,
    params:
        run=first_run,
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        materials=lambda wildcards: study_of(wildcards).materials,
        study="{study}",
    message:
        "Figures, statements and materials of {wildcards.study}"
    script:
        "../../scripts/calibration_results.py"


rule calibration_page:
    input:
        measured=published_table("measured"),
        pairs=published_table("simulated_before"),
        results="results/{study}/summary.csv",
        materials="results/{study}/materials.yaml",
        forecast="results/{study}/forecast.csv",
        templates=lambda wildcards: page_templates(study_of(wildcards)),
    output:
        "results/{study}/report.html",
    log:
        "results/{study}/logs/calibration_page.log",
    wildcard_constraints:
        study=CALIBRATIONS,
    params:
        study=lambda wildcards: calibration_parameters(study_of(wildcards), figure_remarks(study_of(wildcards))),
    message:
        "Page of {wildcards.study}"
    script:
        "../../scripts/calibration_page.py"


rule bulk_test_deck:
    output:
        "results/{study}/decks/{test}/deck.in",
    log:
        "results/{study}/logs/bulk_test_deck_{test}.log",
    wildcard_constraints:
        study=CALIBRATIONS,
        test="shear_box|draw_down",
    params:
        run=first_run,
        templates=[template_sources("shear_box"), template_sources("draw_down")],
    message:
        "Deck of the {wildcards.test}"
    script:
        "../../scripts/bulk_test_deck.py"
