"""Tables on disk, written whole or not at all."""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any


def write_table(path: Path, rows: list[Mapping[str, Any]]) -> None:
    """Write rows with the same keys as CSV, whole or not at all."""
    part = path.with_suffix(".csv.part")
    with open(part, "w", newline="") as stream:
        table = csv.DictWriter(stream, fieldnames=list(rows[0]))
        table.writeheader()
        table.writerows(rows)
    os.replace(part, path)
