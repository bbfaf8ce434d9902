"""Pristine surfaces."""


rule surface_mesh:
    output:
        "results/{study}/{run}/surface.vtu",
    log:
        "results/{study}/logs/surface_mesh_{run}.log",
    benchmark:
        "results/{study}/logs/surface_mesh_{run}.benchmark.tsv"
    priority: 1  # as beds: before the runs
    group:
        "meshes"
    params:
        case=case_of,
        geometry=run_geometry,
    message:
        "Surface mesh of {wildcards.run}"
    script:
        "scripts/surface_mesh.py"
