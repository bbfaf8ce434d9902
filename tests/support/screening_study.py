"""The screening study as tests of its analysis use it."""

import yaml

from bulkwear.postproc.statistics.factors import factor_of
from tests import REPOSITORY

FACTORS = yaml.safe_load((REPOSITORY / "config/studies/screening.yaml").read_text(encoding="utf-8"))["factors"]


def factors_of(design, columns):
    """Factors that columns of a design table span."""
    return [factor_of(column, design[column].to_numpy()) for column in columns]
