"""What was mended of a surface: one row per part and kind of repair, counted, with its size and its first place."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

MM = 1e3  # of a m


@dataclass(frozen=True)
class Repair:
    """A row of the table.

    part: its name; repair: what was done or found; count: how often; largest_mm: mm, what it changed or how large it
    is, nan where it has no size; place_m: (x, y, z) m of the first
    """

    part: str
    repair: str
    count: int
    largest_mm: float
    place_m: tuple[float, float, float]


@dataclass
class Repairs:
    """The table while it grows."""

    names: tuple[str, ...]
    rows: list[Repair] = field(default_factory=list)

    def add(self, repair: str, part: np.ndarray, places: np.ndarray, sizes: np.ndarray | float = np.nan) -> None:
        """Count a repair in each part that has it. part: (k,) of each; places: (k, 3) m; sizes: (k,) m, or one."""
        sizes = np.broadcast_to(sizes, len(part))
        for number in np.unique(part):
            mine = np.flatnonzero(part == number)
            place = tuple((np.asarray(places)[mine[0]] + 0.0).tolist())
            self.rows.append(Repair(self.names[number], repair, len(mine), float(MM * sizes[mine].max()), place))


def table(head: list[str], rows: list[list[str]]) -> str:
    """Rows as lines of text, columns aligned."""
    lines = [head, *rows]
    widths = [max(len(line[column]) for line in lines) for column in range(len(head))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in lines
    )


def repairs_text(rows: tuple[Repair, ...]) -> str:
    """The table of repairs as text."""
    if not rows:
        return "nothing had to be repaired"
    cells = []
    for row in rows:
        size = "" if np.isnan(row.largest_mm) else f"{row.largest_mm:.3g}"
        cells.append([row.part, row.repair, str(row.count), size, ", ".join(f"{value:.6g}" for value in row.place_m)])
    return table(["part", "repair", "how many", "largest (mm)", "place of the first (m)"], cells)
