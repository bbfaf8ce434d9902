"""Surfaces, beds and runs: everything up to what calls the solver, and the same decks without calling it."""

from dataclasses import asdict  # Snakemake does not see that an object of a class of ours has changed


rule surface_mesh:
    output:
        "results/{study}/{run}/surface.vtu",
    log:
        "results/{study}/logs/surface_mesh_{run}.log",
    benchmark:
        "results/{study}/logs/surface_mesh_{run}.benchmark.tsv"
    priority: 1  # as beds: before the runs
    group:
        "meshes"
    params:
        case=case_of,
        geometry=run_geometry,
    message:
        "Surface mesh of {wildcards.run}"
    script:
        "../scripts/surface_mesh.py"


rule settled_bed:
    output:
        restart="results/{study}/beds/{bed}/bed.restart",
        cost="results/{study}/beds/{bed}/cost.csv",
    log:
        "results/{study}/logs/settled_bed_{bed}.log",
    benchmark:
        "results/{study}/logs/settled_bed_{bed}.benchmark.tsv"
    priority: 1  # all of them first: of the runs that can then start, the one with the largest bed does
    threads: ranks_of
    resources:
        runtime=asked("settled_bed", 0),
        mem_mb=asked("settled_bed", 1),
        step_core_min=asked("settled_bed", 2),
        tasks=ranks_of,
        cpus_per_task=1,
        submitted=submitted,
        mpi=launcher_of,
    params:
        case=case_of,
        bed=lambda wildcards: simulated_bed(wildcards.study, wildcards.bed),
    message:
        "Filling and settling {wildcards.bed}"
    script:
        "../scripts/settled_bed.py"


rule worn_run:
    input:
        surface=surface_of_run,
        bed=bed_restart_of_run("beds"),
        same=same_run,
    output:
        wear="results/{study}/{run}/wear.csv",
        cost="results/{study}/{run}/cost.csv",
        surface="results/{study}/{run}/worn_surface.vtu",
    log:
        "results/{study}/logs/worn_run_{run}.log",
    benchmark:
        "results/{study}/logs/worn_run_{run}.benchmark.tsv"
    threads: ranks_of
    resources:
        runtime=asked("worn_run", 0),
        mem_mb=asked("worn_run", 1),
        step_core_min=asked("worn_run", 2),
        tasks=ranks_of,
        cpus_per_task=1,
        submitted=submitted,
        mpi=launcher_of,
    params:
        case=case_of,
        run=lambda wildcards: simulated_run(wildcards.study, wildcards.run)[0],
        bed=lambda wildcards: simulated_run(wildcards.study, wildcards.run)[1],
    message:
        "Wear cycles of {wildcards.run}"
    script:
        "../scripts/worn_run.py"


rule bed_deck:
    output:
        "results/{study}/decks/beds/{bed}/deck.in",
    log:
        "results/{study}/logs/bed_deck_{bed}.log",
    localrule: True  # a deck is rendered in a second: on a cluster, where snakemake was called
    params:
        case=case_of,
        bed=lambda wildcards: simulated_bed(wildcards.study, wildcards.bed),
    message:
        "Deck of {wildcards.bed}"
    script:
        "../scripts/bed_deck.py"


rule run_decks:
    input:
        "results/{study}/{run}/surface.vtu",
    output:
        "results/{study}/decks/{run}/cycle_000/deck.in",
    log:
        "results/{study}/logs/run_decks_{run}.log",
    localrule: True
    params:
        case=case_of,
        run=lambda wildcards: simulated_run(wildcards.study, wildcards.run)[0],
        bed=lambda wildcards: simulated_run(wildcards.study, wildcards.run)[1],
        bed_restart=lambda wildcards: next(iter(bed_restart_of_run("decks/beds")(wildcards)), None),
    message:
        "Decks of {wildcards.run}"
    script:
        "../scripts/run_decks.py"


checkpoint further_packings:
    input:
        before=round_before,
        wear=of_round("results/{study}/{run}/wear.csv"),
        costs=costs_of_round,
    output:
        decided="results/{study}/rounds/round_{round}.json",
        design="results/{study}/rounds/round_{round}_design.csv",
    log:
        "results/{study}/logs/further_packings_{round}.log",
    wildcard_constraints:
        round=r"\d+",
        study="|".join(name for name in STUDIES if STUDIES[name].optimise is None) or "no_study",
    localrule: True
    params:
        until=lambda wildcards: asdict(study_of(wildcards).until),
        rows=lambda wildcards: study_of_round(wildcards).design_table(),
        possible=lambda wildcards: rows_by_setting(study_of(wildcards)),
    message:
        "Are the intervals of {wildcards.study} narrow enough?"
    script:
        "../scripts/further_packings.py"
