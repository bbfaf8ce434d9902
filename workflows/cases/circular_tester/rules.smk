"""Circular wear tester: tables of all runs, and the figures of the study (Yan 2022, chapter 6)."""

from workflows.report.figures import TESTER_FIGURES
from workflows.cases.circular_tester.page import values_of_runs
from workflows.report.remarks import figure_remarks

TESTER_PUBLISHED = {
    "published": f"{PUBLISHED_TABLES}/circular_tester.csv",
    "published_fits": f"{PUBLISHED_TABLES}/circular_tester_volume.csv",
}
TESTER_FINDINGS = f"{PUBLISHED_TABLES}/circular_tester_findings.csv"
TESTER_RUNS = {
    "wear": of_every_run("results/{study}/{run}/wear.csv"),
    "worn": of_every_run("results/{study}/{run}/worn_surface.vtu"),
}


rule tester_tables:
    input:
        **TESTER_PUBLISHED,
        **TESTER_RUNS,
        published_findings=TESTER_FINDINGS,
    output:
        volumes="results/{study}/tester/lost_volumes.csv",
        others=[
            f"results/{{study}}/tester/{name}.csv"
            for name in (
                *("fits", "time_scale", "predictions", "comparison"),
                *("crossings", "ratios", "mean_ratios", "series", "findings"),
            )
        ],
    log:
        "results/{study}/logs/tester_tables.log",
    benchmark:
        "results/{study}/logs/tester_tables.benchmark.tsv"
    params:
        runs=lambda wildcards: values_of_runs(study_of(wildcards)),
    message:
        "Tables of the runs of {wildcards.study}"
    script:
        "../../scripts/tester_tables.py"


for JOB, (CATEGORY, FIGURES_OF_JOB) in TESTER_FIGURES.items():

    rule:
        name:
            JOB
        input:
            **TESTER_PUBLISHED,
            **TESTER_RUNS,
            tables="results/{study}/tester/lost_volumes.csv",
        output:
            figures=[
                report(
                    f"results/{{study}}/figures/{figure}.png",
                    caption=f"../../report/{figure}.rst",
                    category=CATEGORY,
                    labels={"figure": title},
                )
                for figure, title in FIGURES_OF_JOB.items()
            ],
            tables=[f"results/{{study}}/figures/{figure}.csv" for figure in FIGURES_OF_JOB],
        log:
            f"results/{{study}}/logs/{JOB}.log",
        benchmark:
            f"results/{{study}}/logs/{JOB}.benchmark.tsv"
        params:
            runs=lambda wildcards: values_of_runs(study_of(wildcards)),
            job=JOB,
            remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        message:
            f"{CATEGORY} of {{wildcards.study}}"
        script:
            "../../scripts/tester_figures.py"
