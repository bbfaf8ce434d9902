"""Pristine surfaces."""


rule surface_mesh:
    output:
        "results/{study}/{run}/surface.vtu",
    log:
        "results/{study}/logs/surface_mesh_{run}.log",
    benchmark:
        "results/{study}/logs/surface_mesh_{run}.benchmark.tsv"
    params:
        sample=lambda wildcards: run_parameters(wildcards)["sample"],
        pattern=lambda wildcards: run_parameters(wildcards)["pattern"],
    message:
        "Surface mesh of {wildcards.run}"
    script:
        "scripts/surface_mesh.py"
