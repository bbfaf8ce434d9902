"""Calibrations: bulk tests simulated where a rule says, and their decks."""


localrules:
    bulk_test_deck,


def first_box(wildcards):
    """The parameters of the first run, whose box is that of the calibration."""
    return study_of(wildcards).all_runs[0].parameters


def published_file(key):
    """An input function: the published table that a setting of the calibration names."""
    return lambda wildcards: f"config/published/{first_box(wildcards)['calibration'][key]}"


def simulations_at_once(wildcards):
    """How many simulations a calibration has at the same time."""
    return first_box(wildcards)["calibration"]["batch"]


rule calibrated_parameters:
    input:
        measured=published_file("measured"),
        pairs=published_file("simulated_before"),
    output:
        simulations="results/{study}/simulations.csv",
        looks="results/{study}/looks.csv",
        repeats="results/{study}/repeats.csv",
    log:
        "results/{study}/logs/calibrated_parameters.log",
    benchmark:
        "results/{study}/logs/calibrated_parameters.benchmark.tsv"
    threads: simulations_at_once
    resources:
        runtime=asked("calibrated_parameters", 0),
        mem_mb=asked("calibrated_parameters", 1),
    params:
        run=first_box,
        templates=[template_sources("shear_box"), template_sources("draw_down")],
    message:
        "Calibration of {wildcards.study}"
    script:
        "../../scripts/calibrated_parameters.py"


rule box_sizes:
    input:
        pairs=published_file("simulated_before"),
    output:
        "results/{study}/box_sizes.csv",
    log:
        "results/{study}/logs/box_sizes.log",
    benchmark:
        "results/{study}/logs/box_sizes.benchmark.tsv"
    threads: simulations_at_once
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


rule bulk_test_deck:
    output:
        "results/{study}/decks/{test}/deck.in",
    log:
        "results/{study}/logs/bulk_test_deck_{test}.log",
    wildcard_constraints:
        test="shear_box|draw_down",
    params:
        run=first_box,
        templates=[template_sources("shear_box"), template_sources("draw_down")],
    message:
        "Deck of the {wildcards.test}"
    script:
        "../../scripts/bulk_test_deck.py"
