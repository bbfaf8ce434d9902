"""The study `small` of a configuration that a test writes."""

from bulkwear.workflows.config.design import load_study


def parameters_of(config, run="R9_convex", overrides=None):
    """Return the parameters of one of its runs."""
    return load_study("small", config.project, overrides).run(run).parameters
