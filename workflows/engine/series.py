"""The surfaces of a run's cycles as one series in time, for ParaView."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from xml.sax.saxutils import quoteattr

SERIES = "cycles.pvd"


def write_series(folder: Path, surface: str, cycles: Sequence[int]) -> None:
    """Write SERIES of a run: what lies in the folder of each cycle, at the cycle's number as time.

    folder: of the run; surface: name of the surface's file in `cycle_<nnn>`. Cycles without one are left out.
    """
    names = {cycle: f"cycle_{cycle:03d}/{surface}" for cycle in cycles}
    lines = [
        f'    <DataSet timestep="{cycle}" part="0" file={quoteattr(name)}/>'
        for cycle, name in names.items()
        if (folder / name).is_file()
    ]
    head = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>'
    part = folder / f"{SERIES}.part"
    part.write_text("\n".join([head, *lines, "  </Collection>", "</VTKFile>", ""]), encoding="utf-8")
    os.replace(part, folder / SERIES)
