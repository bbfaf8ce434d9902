"""The screening study as tests of its analysis use it."""

from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]
FACTORS = yaml.safe_load((ROOT / "config/studies/screening.yaml").read_text(encoding="utf-8"))["factors"]
