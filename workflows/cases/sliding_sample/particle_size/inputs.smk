"""Input function of the containers of studies of particle size."""


def nothing_before_packings(wildcards):
    """No input; see `again_if_unrecorded`."""
    from bulkwear.workflows.cases.sliding_sample.particle_size.kept import other_containers  # slow to import
    from bulkwear.workflows.cases.sliding_sample.particle_size.study import packed_runs
    from bulkwear.workflows.config.units import to_si

    study, made = study_of(wildcards), Path(f"results/{wildcards.study}/packings/profiles.csv")
    packing = to_si(study.settings)["packing"]
    again_if_unrecorded(made, lambda: other_containers(packed_runs(study), packing, made))
    return []
