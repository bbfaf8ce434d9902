"""Containers of studies of particle size; their figures are declared in figures.py."""

from bulkwear.workflows.cases.sliding_sample.particle_size.study import packed_runs
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.engine.templates import templates_digest


include: "inputs.smk"


rule packing_profiles:
    input:
        nothing_before_packings,
    output:
        profiles="results/{study}/packings/profiles.csv",
        cost="results/{study}/packings/solver_cost.csv",
    log:
        "results/{study}/logs/packing_profiles.log",
    benchmark:
        "results/{study}/logs/packing_profiles.benchmark.tsv"
    priority: 1  # waits for nothing and takes long: first, beside the beds
    resources:
        runtime=asked("packing_profiles", 0),
        mem_mb=asked("packing_profiles", 1),
    params:
        runs=lambda wildcards: packed_runs(study_of(wildcards)),
        packing=lambda wildcards: to_si(study_of(wildcards).settings)["packing"],
        templates=templates_digest("packed_container"),
        code=code_of_pages("bulkwear.workflows.cases.sliding_sample.particle_size.packings"),
    message:
        "Packings at every particle scale of {wildcards.study}"
    script:
        "../../../scripts/packing_profiles.py"
