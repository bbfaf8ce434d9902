"""Pristine surfaces."""


rule surface_mesh:
    output:
        "results/{study}/{run}/surface.vtu",
    params:
        sample=lambda wildcards: run_parameters(wildcards)["sample"],
        pattern=lambda wildcards: run_parameters(wildcards)["pattern"],
    log:
        "results/{study}/logs/surface_mesh_{run}.log",
    benchmark:
        "results/{study}/logs/surface_mesh_{run}.benchmark.tsv"
    message:
        "Surface mesh of {wildcards.run}"
    script:
        "scripts/surface_mesh.py"
