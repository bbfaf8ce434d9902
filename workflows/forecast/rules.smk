"""What studies will cost: the rates of this machine, and a forecast per study."""


rule cost_rates:
    output:
        "results/cost_rates.json",
    log:
        "results/cost_rates.log",
    threads: CORES
    message:
        "What the solver's work costs on this machine"
    script:
        "../scripts/cost_rates.py"


rule forecast_table:
    input:
        rates=used_rates,
    output:
        table_in_report("results/{study}/forecast.csv", captions="../report/"),
    log:
        "results/{study}/logs/forecast_table.log",
    priority: 2
    localrule: True  # at once, not with the tables: `status` tells the time left by it
    params:
        work=lambda wildcards: solver_work(wildcards.study)(wildcards),
        fidelity=lambda wildcards: study_of(wildcards).fidelity,
    message:
        "Forecast of {wildcards.study}, to compare with what it takes"
    script:
        "../scripts/forecast_table.py"


for STUDY in STUDIES:

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
            "../scripts/forecast.py"
