"""Contents page: <study> makes a study's report, <study>_decks its decks without the solver, <study>_forecast its cost.

    snakemake                       the demo; in a project of your own its study (docs/project.md)
    snakemake screening --config fidelity=standard
    snakemake screening_forecast --config fidelity=paper

Snakemake finds profiles/default by itself, the choices for one machine; docs/cluster.md has those for a cluster."""

from bulkwear.workflows.config.targets import default_studies


include: "workflows/common.smk"
include: "workflows/start_and_end.smk"
include: "workflows/inputs.smk"
include: "workflows/jobs.smk"
include: "workflows/forecast/rules.smk"
include: "workflows/engine/rules.smk"
include: "workflows/report/rules.smk"


for RULES_OF_CASE in rules_of_cases():

    include: str(RULES_OF_CASE)


include: "workflows/submissions.smk"


rule default_studies:
    default_target: MADE_BY_DEFAULT
    input:
        [f"results/{name}/report.html" for name in default_studies(PROJECT) if name in STUDIES],
    localrule: True
    message:
        "Reports of {input}"


for STUDY in STUDIES:

    rule:
        name:
            STUDY
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
