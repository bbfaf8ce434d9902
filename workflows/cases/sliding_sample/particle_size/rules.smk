"""Figures of studies of particle size: wear against scale, packings, and single contacts at every scale."""

from workflows.report.figures import bumps_and_particles, flow_runs, plain_runs
from workflows.cases.sliding_sample.particle_size.packings import packed_runs
from workflows.config.units import to_si

PUBLISHED_LINES = f"{PUBLISHED_TABLES}/particle_size_lines.csv"
PUBLISHED_SIZES = f"{PUBLISHED_TABLES}/particle_size_results.csv"
PROFILES_BY_ROW = "results/{study}/flow/profiles.csv"


rule wear_against_scale:
    input:
        summary="results/{study}/summary.csv",
        published=PUBLISHED_LINES,
    output:
        figure=report(
            "results/{study}/figures/wear_against_scale.png",
            caption="../../../report/wear_against_scale.rst",
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
        "../../../scripts/wear_against_scale.py"


rule wear_against_size_ratios:
    input:
        wear="results/{study}/figures/wear_against_scale.csv",
        published=PUBLISHED_LINES,
    output:
        figure=report(
            "results/{study}/figures/wear_against_size_ratios.png",
            caption="../../../report/wear_against_size_ratios.rst",
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
        "../../../scripts/wear_against_size_ratios.py"


rule velocity_by_layer:
    input:
        summary="results/{study}/summary.csv",
        profiles=PROFILES_BY_ROW,
        published=PUBLISHED_SIZES,
    output:
        figure=report(
            "results/{study}/figures/velocity_by_layer.png",
            caption="../../../report/velocity_by_layer.rst",
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
        component="velocity_m_per_s",
    message:
        "Velocity by layer and particle scale of {wildcards.study}"
    script:
        "../../../scripts/velocity_by_layer.py"


use rule velocity_by_layer as upward_velocity_by_layer with:
    output:
        figure=report(
            "results/{study}/figures/upward_velocity_by_layer.png",
            caption="../../../report/upward_velocity_by_layer.rst",
            category="Particle size",
            labels={"figure": "Upward velocity by layer and particle scale"},
        ),
        table="results/{study}/figures/upward_velocity_by_layer.csv",
    log:
        "results/{study}/logs/upward_velocity_by_layer.log",
    benchmark:
        "results/{study}/logs/upward_velocity_by_layer.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        component="upward_m_per_s",
    message:
        "Upward velocity by layer and particle scale of {wildcards.study}"


use rule velocity_by_layer as sideways_velocity_by_layer with:
    output:
        figure=report(
            "results/{study}/figures/sideways_velocity_by_layer.png",
            caption="../../../report/sideways_velocity_by_layer.rst",
            category="Particle size",
            labels={"figure": "Sideways velocity by layer and particle scale"},
        ),
        table="results/{study}/figures/sideways_velocity_by_layer.csv",
    log:
        "results/{study}/logs/sideways_velocity_by_layer.log",
    benchmark:
        "results/{study}/logs/sideways_velocity_by_layer.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        component="sideways_m_per_s",
    message:
        "Sideways velocity by layer and particle scale of {wildcards.study}"


rule angular_velocity_along_sample:
    input:
        summary="results/{study}/summary.csv",
        profiles=PROFILES_BY_ROW,
        # what the snapshots of the bed were reduced to lies beside these
        wear=WEAR_TABLES,
    output:
        figure=report(
            "results/{study}/figures/angular_velocity_along_sample.png",
            caption="../../../report/angular_velocity_along_sample.rst",
            category="Particle size",
            labels={"figure": "Angular speed along the sample"},
        ),
        table="results/{study}/figures/angular_velocity_along_sample.csv",
    log:
        "results/{study}/logs/angular_velocity_along_sample.log",
    benchmark:
        "results/{study}/logs/angular_velocity_along_sample.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        runs=lambda wildcards: flow_runs(study_of(wildcards)),
    message:
        "Angular speed along the samples of {wildcards.study}"
    script:
        "../../../scripts/angular_velocity_along_sample.py"


rule steady_by_scale:
    input:
        summary="results/{study}/summary.csv",
        steady="results/{study}/flow/steady.csv",
        published=PUBLISHED_SIZES,
    output:
        figure=report(
            "results/{study}/figures/steady_by_scale.png",
            caption="../../../report/steady_by_scale.rst",
            category="Particle size",
            labels={"figure": "Relative velocity and wear rate by particle scale"},
        ),
        table="results/{study}/figures/steady_by_scale.csv",
    log:
        "results/{study}/logs/steady_by_scale.log",
    benchmark:
        "results/{study}/logs/steady_by_scale.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Relative velocity and wear rate by particle scale of {wildcards.study}"
    script:
        "../../../scripts/steady_by_scale.py"


rule wear_maps:
    input:
        summary="results/{study}/summary.csv",
        surfaces=WORN_SURFACES,
    output:
        figure=report(
            "results/{study}/figures/wear_maps.png",
            caption="../../../report/wear_maps.rst",
            category="Particle size",
            labels={"figure": "Wear of the smallest and the largest particles"},
        ),
        table="results/{study}/figures/wear_maps.csv",
    log:
        "results/{study}/logs/wear_maps.log",
    benchmark:
        "results/{study}/logs/wear_maps.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        deformed=lambda wildcards: is_deformed(study_of(wildcards)),
    message:
        "Maps of the wear by the smallest and the largest particles of {wildcards.study}"
    script:
        "../../../scripts/wear_maps.py"


rule size_findings:
    input:
        wear="results/{study}/figures/wear_against_scale.csv",
        critical="results/{study}/particle_size/critical_scale.csv",
        guidance="results/{study}/particle_size/guidance.csv",
        steady="results/{study}/figures/steady_by_scale.csv",
        profiles="results/{study}/figures/velocity_by_layer.csv",
        container="results/{study}/figures/packing_profiles.csv",
        bed="results/{study}/figures/bed_packing.csv",
        published=PUBLISHED_SIZES,
        published_packing=f"{PUBLISHED_TABLES}/packing.csv",
    output:
        published="results/{study}/particle_size/published.csv",
        sentences="results/{study}/particle_size/sentences.csv",
    log:
        "results/{study}/logs/size_findings.log",
    benchmark:
        "results/{study}/logs/size_findings.benchmark.tsv"
    message:
        "What the source tells of particle size beside {wildcards.study}"
    script:
        "../../../scripts/size_findings.py"


rule collisions:
    output:
        figure=report(
            "results/{study}/figures/collisions.png",
            caption="../../../report/collisions.rst",
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
        "../../../scripts/collisions.py"


rule packing_profiles:
    input:
        published=f"{PUBLISHED_TABLES}/packing.csv",
    output:
        figure=report(
            "results/{study}/figures/packing_profiles.png",
            caption="../../../report/packing_profiles.rst",
            category="Particle size",
            labels={"figure": "Packing of a container"},
        ),
        table="results/{study}/figures/packing_profiles.csv",
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
        templates=template_sources("packed_container"),
    message:
        "Packings at every particle scale of {wildcards.study}"
    script:
        "../../../scripts/packing_profiles.py"


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
            caption="../../../report/bed_packing.rst",
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
        "../../../scripts/bed_packing.py"
