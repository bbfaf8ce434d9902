"""Input functions of calibrations."""


def batch_of(wildcards):
    """How many simulations a calibration does at a time."""
    from bulkwear.workflows.cases.calibration.case import calibration_box  # slow to import

    return calibration_box(study_of(wildcards))["calibration"]["batch"]


def measured_of(wildcards):
    """The table of measured responses; see `again_if_unrecorded`."""
    from bulkwear.workflows.cases.calibration.case import calibration_box, measured_file
    from bulkwear.workflows.cases.calibration.kept import other_calibration  # slow to import

    study, made = study_of(wildcards), Path(f"results/{wildcards.study}/simulations.csv")
    measured = measured_file(study)
    again_if_unrecorded(made, lambda: other_calibration(calibration_box(study), Path(measured), made))
    return measured


def pairs_of_sizes(wildcards):
    """The table of pairs that others simulated; see `again_if_unrecorded`."""
    from bulkwear.workflows.cases.calibration.case import pairs_file
    from bulkwear.workflows.cases.calibration.kept import other_box_sizes  # slow to import

    study, made = study_of(wildcards), Path(f"results/{wildcards.study}/box_sizes.csv")
    runs, pairs = {run.name: run.parameters for run in study.runs}, pairs_file(study)
    again_if_unrecorded(made, lambda: other_box_sizes(runs, Path(pairs), made))
    return pairs
