"""Contents page: <study> makes a study's report, <study>_decks its decks without the solver, <study>_forecast its cost.

    snakemake                       the demo
    snakemake screening --config fidelity=standard
    snakemake screening_forecast --config fidelity=paper

Snakemake finds profiles/default by itself, the choices for one machine; docs/cluster.md has those for a cluster."""


include: "workflows/common.smk"
include: "workflows/forecast/rules.smk"
include: "workflows/engine/rules.smk"
include: "workflows/report/rules.smk"


for RULES_OF_CASE in rules_of_cases():

    include: str(RULES_OF_CASE)


include: "workflows/submissions.smk"


for STUDY in STUDIES:

    rule:
        name:
            STUDY
        default_target: STUDY == "demo"
        input:
            f"results/{STUDY}/report.html",
            f"results/{STUDY}/summary.csv",
        message:
            "Report of the study"

    rule:
        name:
            f"{STUDY}_decks"
        input:
            study_decks(STUDY),
        message:
            "Decks of the study, rendered without running the solver"

    rule:
        name:
            f"{STUDY}_forecast"
        input:
            rates=used_rates,
        log:
            f"results/{STUDY}/logs/forecast.log",
        localrule: True
        params:
            work=solver_work(STUDY),
            study=STUDY,
            heading=f"{STUDY}, fidelity {STUDIES[STUDY].fidelity}: {STUDIES[STUDY].title}",
            cores=CORES,
        message:
            "What the study will cost"
        script:
            "workflows/scripts/forecast.py"
