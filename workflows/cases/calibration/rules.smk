"""Calibrations: bulk tests simulated where a rule says, and their decks."""

from bulkwear.workflows.cases.calibration.case import calibration_box, pairs_file
from bulkwear.workflows.engine.inputs import SimulatedFrom
from bulkwear.workflows.engine.templates import templates_digest


include: "inputs.smk"


rule calibrated_parameters:
    input:
        measured=measured_of,
        pairs=lambda wildcards: pairs_file(study_of(wildcards)),
    output:
        simulations="results/{study}/simulations.csv",
        looks="results/{study}/looks.csv",
        repeats="results/{study}/repeats.csv",
    log:
        "results/{study}/logs/calibrated_parameters.log",
    benchmark:
        "results/{study}/logs/calibrated_parameters.benchmark.tsv"
    threads: batch_of
    resources:
        runtime=asked("calibrated_parameters", 0),
        mem_mb=asked("calibrated_parameters", 1),
        cpus_per_task=batch_of,  # of a submission, whose threads are no more than the profile's cores
        submitted=submitted,
    params:
        run=lambda wildcards: SimulatedFrom.all_of(calibration_box(study_of(wildcards))),
        templates=templates_digest("shear_box", "draw_down", "wall_shear"),
    message:
        "Calibration of {wildcards.study}"
    script:
        "../../scripts/calibrated_parameters.py"


rule box_sizes:
    input:
        pairs=pairs_of_sizes,
    output:
        "results/{study}/box_sizes.csv",
    log:
        "results/{study}/logs/box_sizes.log",
    benchmark:
        "results/{study}/logs/box_sizes.benchmark.tsv"
    threads: batch_of
    resources:
        runtime=asked("box_sizes", 0),
        mem_mb=asked("box_sizes", 1),
        cpus_per_task=batch_of,  # of a submission, whose threads are no more than the profile's cores
        submitted=submitted,
    params:
        runs=lambda wildcards: SimulatedFrom.all_of({run.name: run.parameters for run in study_of(wildcards).runs}),
        templates=templates_digest("shear_box"),
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
        test="shear_box|draw_down|wall_shear",
    localrule: True
    params:
        run=lambda wildcards: SimulatedFrom.all_of(calibration_box(study_of(wildcards))),
        templates=templates_digest("shear_box", "draw_down", "wall_shear"),
    message:
        "Deck of the {wildcards.test}"
    script:
        "../../scripts/bulk_test_deck.py"
