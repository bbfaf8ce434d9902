"""The study `small` of a configuration that a test writes."""

import pytest

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import ConfigError


def parameters_of(config, run="R9_convex", overrides=None):
    """Return the parameters of one of its runs."""
    return load_study("small", config.project, overrides).run(run).parameters


def message_of(config, overrides=None) -> str:
    """Return the sentence that refuses it."""
    with pytest.raises(ConfigError) as caught:
        load_study("small", config.project, overrides)
    return str(caught.value)
