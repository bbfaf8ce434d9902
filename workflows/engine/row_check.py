"""Whether the rows of a run's cycles agree with one another: what each adds, and the totals that all of them carry."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

from bulkwear.workflows.engine.records import read_record
from bulkwear.workflows.engine.state import STATE
from bulkwear.workflows.engine.wear_step import TOTALS

ROUND_OFF = 1e-12  # -, of a sum of two numbers that was read back


class RowCheck:
    """Looks at the cycles of a run one after another."""

    def __init__(self) -> None:
        self.before: Mapping[str, float] = {}

    def fault(self, folder: Path) -> str | None:
        """Return what is wrong with a cycle's record beside that of the cycle before, a sentence, or None."""
        path = folder / STATE
        record = read_record(path)
        row, span = record.get("wear"), record.get("span")
        if row is None:
            return None
        for total, part in TOTALS.items():
            if total not in row or part not in row:
                continue
            due = self.before.get(total, 0.0) + row[part]
            if not math.isclose(row[total], due, rel_tol=ROUND_OFF, abs_tol=ROUND_OFF * abs(row[part])):
                return f"{path}: {total} is {row[total]:.10g}, allowed is {due:.10g}, the sum of the rows."
        if span and row.get("cycle") != span["cycle"]:
            return f"{path}: the row is of cycle {row.get('cycle')}, allowed is {span['cycle']}, that of its span."
        self.before = row
        return None
