"""Rounds of a search: the patterns of the next one follow from the results of all before."""

from dataclasses import asdict  # Snakemake does not see that an object of a class of ours has changed


checkpoint proposed_rows:
    input:
        before=round_before,
        wear=of_round("results/{study}/{run}/wear.csv"),
        surface=of_round("results/{study}/{run}/surface.vtu"),
        costs=costs_of_round,
    output:
        decided="results/{study}/rounds/round_{round}.json",
        design="results/{study}/rounds/round_{round}_design.csv",
    log:
        "results/{study}/logs/proposed_rows_{round}.log",
    wildcard_constraints:
        round=r"\d+",
        study="|".join(name for name in STUDIES if STUDIES[name].optimise) or "no_study",
    localrule: True
    params:
        search=lambda wildcards: asdict(study_of(wildcards).optimise),
        digest=lambda wildcards: study_of(wildcards).search_digest,
        rows=lambda wildcards: study_of_round(wildcards).design_table(),
        settings=SETTINGS,
    message:
        "Which patterns of {wildcards.study} come next?"
    script:
        "../../../scripts/proposed_rows.py"
