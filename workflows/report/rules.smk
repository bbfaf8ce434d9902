"""Tables and figures of a study, and its page."""

from bulkwear.workflows.report.page_parameters import figure_remarks, page_of, page_parameters, page_templates
from bulkwear.workflows.report.products import outputs_of, product_files, rules_of

PAGE = "bulkwear.workflows.report.page"  # makes it, and is slow to import


report: "description.rst"


for RULE_OF_PRODUCT, (NAMES, PRODUCT) in rules_of(STUDIES.values()).items():

    rule:
        name:
            RULE_OF_PRODUCT
        input:
            last_round,
            **{name: input_of(source) for name, source in PRODUCT.inputs.items()},
        output:
            **in_report(PRODUCT, outputs_of(PRODUCT)),
        log:
            f"results/{{study}}/logs/{RULE_OF_PRODUCT}.log",
        benchmark:
            f"results/{{study}}/logs/{RULE_OF_PRODUCT}.benchmark.tsv"
        wildcard_constraints:
            study="|".join(NAMES),
        params:
            case=case_of,
            product=PRODUCT.name,
            told=told_of(PRODUCT),
            code=code_of_pages(PRODUCT.make.__module__),
            remarks=lambda wildcards: figure_remarks(study_so_far(wildcards)),
            runs=lambda wildcards: [run.name for run in study_so_far(wildcards).runs],
            title=PRODUCT.title,
            caption=PRODUCT.caption,
        message:
            f"{PRODUCT.title or PRODUCT.name} of {{wildcards.study}}"
        script:
            "../scripts/product.py"


rule design_table:
    input:
        last_round,
    output:
        table_in_report("results/{study}/design.csv"),
    log:
        "results/{study}/logs/design_table.log",
    benchmark:
        "results/{study}/logs/design_table.benchmark.tsv"
    params:
        rows=lambda wildcards: study_so_far(wildcards).design_table(),
    message:
        "Design table of {wildcards.study}"
    script:
        "../scripts/design_table.py"


# a case without wear cycles declares its own
WITH_SUMMARY = "|".join(study.name for study in STUDIES.values() if study.case.wears)


rule summary:
    input:
        design="results/{study}/design.csv",
        wear=of_every_run("results/{study}/{run}/wear.csv"),
        pristine=of_every_run("results/{study}/{run}/surface.vtu"),
        worn=of_every_run("results/{study}/{run}/worn_surface.vtu"),
    output:
        table_in_report("results/{study}/summary.csv"),
    log:
        "results/{study}/logs/summary.log",
    benchmark:
        "results/{study}/logs/summary.benchmark.tsv"
    wildcard_constraints:
        study=WITH_SUMMARY or "no_study",
    params:
        case=case_of,
        code=code_of_pages(),
    message:
        "Summary of {wildcards.study}"
    script:
        "../scripts/summary.py"


rule report:
    input:
        last_round,
        lambda wildcards: product_files(study_so_far(wildcards)),
        summary="results/{study}/summary.csv",
        design="results/{study}/design.csv",
        costs=costs_of_runs,
        forecast="results/{study}/forecast.csv",
        templates=lambda wildcards: page_templates(study_of(wildcards)),
    output:
        "results/{study}/report.html",
    log:
        "results/{study}/logs/report.log",
    params:
        study=lambda wildcards: page_parameters(study_so_far(wildcards)),
        code=lambda wildcards: code_by_name(wildcards.study, (PAGE, page_of(case_of(wildcards)).__name__)),
    message:
        "Page of {wildcards.study}"
    script:
        "../scripts/report.py"


rule printed_page:
    input:
        "results/{study}/report.html",
    output:
        "results/{study}/report.pdf",
    log:
        "results/{study}/logs/printed_page.log",
    localrule: True  # a cluster's nodes need no browser
    message:
        "Page of {wildcards.study} as PDF"
    script:
        "../scripts/printed_page.py"
