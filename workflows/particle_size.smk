"""Figures of studies of particle size: wear against scale, packings, and single contacts at every scale."""

from workflows.figures import bumps_and_particles, plain_runs
from workflows.units import to_si

PUBLISHED_LINES = f"{PUBLISHED_TABLES}/particle_size_lines.csv"


rule wear_against_scale:
    input:
        summary="results/{study}/summary.csv",
        published=PUBLISHED_LINES,
    output:
        figure=report(
            "results/{study}/figures/wear_against_scale.png",
            caption="report/wear_against_scale.rst",
            category="Particle size",
            labels={"figure": "Wear against particle scale"},
        ),
        table="results/{study}/figures/wear_against_scale.csv",
        lines="results/{study}/particle_size/lines.csv",
        critical="results/{study}/particle_size/critical_scale.csv",
    log:
        "results/{study}/logs/wear_against_scale.log",
    benchmark:
        "results/{study}/logs/wear_against_scale.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Wear against particle scale of {wildcards.study}"
    script:
        "scripts/wear_against_scale.py"


rule wear_against_size_ratios:
    input:
        wear="results/{study}/figures/wear_against_scale.csv",
        published=PUBLISHED_LINES,
    output:
        figure=report(
            "results/{study}/figures/wear_against_size_ratios.png",
            caption="report/wear_against_size_ratios.rst",
            category="Particle size",
            labels={"figure": "Wear against ratios of size"},
        ),
        table="results/{study}/figures/wear_against_size_ratios.csv",
        guidance="results/{study}/particle_size/guidance.csv",
    log:
        "results/{study}/logs/wear_against_size_ratios.log",
    benchmark:
        "results/{study}/logs/wear_against_size_ratios.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        rows=lambda wildcards: bumps_and_particles(study_of(wildcards)),
    message:
        "Wear against ratios of size of {wildcards.study}"
    script:
        "scripts/wear_against_size_ratios.py"


rule velocity_by_layer:
    input:
        summary="results/{study}/summary.csv",
        profiles="results/{study}/flow/profiles.csv",
    output:
        figure=report(
            "results/{study}/figures/velocity_by_layer.png",
            caption="report/velocity_by_layer.rst",
            category="Particle size",
            labels={"figure": "Velocity by layer and particle scale"},
        ),
        table="results/{study}/figures/velocity_by_layer.csv",
    log:
        "results/{study}/logs/velocity_by_layer.log",
    benchmark:
        "results/{study}/logs/velocity_by_layer.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Velocity by layer and particle scale of {wildcards.study}"
    script:
        "scripts/velocity_by_layer.py"


rule collisions:
    output:
        figure=report(
            "results/{study}/figures/collisions.png",
            caption="report/collisions.rst",
            category="Particle size",
            labels={"figure": "Single collisions"},
        ),
        table="results/{study}/figures/collisions.csv",
        measures="results/{study}/particle_size/collisions.csv",
    log:
        "results/{study}/logs/collisions.log",
    benchmark:
        "results/{study}/logs/collisions.benchmark.tsv"
    params:
        runs=lambda wildcards: {run.name: run.parameters for run in study_of(wildcards).runs},
        templates=template_sources("collision"),
    message:
        "Single collisions at every particle scale of {wildcards.study}"
    script:
        "scripts/collisions.py"


rule packing_profiles:
    input:
        published=f"{PUBLISHED_TABLES}/packing.csv",
    output:
        figure=report(
            "results/{study}/figures/packing_profiles.png",
            caption="report/packing_profiles.rst",
            category="Particle size",
            labels={"figure": "Packing of a container"},
        ),
        table="results/{study}/figures/packing_profiles.csv",
    log:
        "results/{study}/logs/packing_profiles.log",
    benchmark:
        "results/{study}/logs/packing_profiles.benchmark.tsv"
    params:
        runs=lambda wildcards: {run.name: run.parameters for run in study_of(wildcards).runs},
        packing=lambda wildcards: to_si(study_of(wildcards).settings)["packing"],
        templates=template_sources("packed_container"),
    message:
        "Packings at every particle scale of {wildcards.study}"
    script:
        "scripts/packing_profiles.py"


rule bed_packing:
    input:
        wear=lambda wildcards: [
            f"results/{wildcards.study}/{name}/wear.csv" for name in plain_runs(study_of(wildcards))
        ],
        beds=restarts_of_plain_beds,
        published=f"{PUBLISHED_TABLES}/packing.csv",
    output:
        figure=report(
            "results/{study}/figures/bed_packing.png",
            caption="report/bed_packing.rst",
            category="Particle size",
            labels={"figure": "Packing of the bed"},
        ),
        table="results/{study}/figures/bed_packing.csv",
    log:
        "results/{study}/logs/bed_packing.log",
    benchmark:
        "results/{study}/logs/bed_packing.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        runs=lambda wildcards: {name: run.parameters for name, run in plain_runs(study_of(wildcards)).items()},
        floors=lambda wildcards: [
            study_of(wildcards).beds[study_of(wildcards).bed_of(name)]["temporary_floor_m"]
            for name in plain_runs(study_of(wildcards))
        ],
        templates=template_sources("bed_contacts"),
    message:
        "Packing of the bed before and after the sample of {wildcards.study}"
    script:
        "scripts/bed_packing.py"
