"""The screening study as tests of its analysis use it."""

import yaml

from tests import REPOSITORY

FACTORS = yaml.safe_load((REPOSITORY / "config/studies/screening.yaml").read_text(encoding="utf-8"))["factors"]
