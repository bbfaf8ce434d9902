"""Tables of a study."""


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
        "scripts/design_table.py"


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
        "scripts/summary.py"
