"""Pin on disc: contours and volumes of every run, of which the figures are made."""


rule track_tables:
    input:
        design="results/{study}/design.csv",
        wear="results/{study}/{run}/wear.csv",
    output:
        contours="results/{study}/{run}/contours.csv",
        volumes="results/{study}/{run}/volumes.csv",
    log:
        "results/{study}/logs/track_tables_{run}.log",
    benchmark:
        "results/{study}/logs/track_tables_{run}.benchmark.tsv"
    params:
        code=code_of_pages(*(f"bulkwear.workflows.cases.pin_on_disc.{name}" for name in ("run_in", "runs", "volume"))),
    message:
        "Contours and volumes of {wildcards.study}, {wildcards.run}"
    script:
        "../../scripts/track_tables.py"
