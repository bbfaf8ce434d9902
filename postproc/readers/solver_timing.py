"""How long the runs of a LIGGGHTS log took, from the lines it prints after each."""

from __future__ import annotations

import re
from itertools import zip_longest
from pathlib import Path

import numpy as np

_LOOP = re.compile(r"^Loop time of (\S+) on \d+ procs for (\d+) steps with (\d+) atoms", re.MULTILINE)
_NEIGHBOURS = re.compile(r"^Neigh time \(%\) = (\S+)", re.MULTILINE)
_BUILDS = re.compile(r"^Neighbor list builds = (\d+)", re.MULTILINE)


def run_times(path: Path | str) -> dict[str, np.ndarray]:
    """Return the `run` commands of a log that printed their times, in order, one (runs,) array per column.

    loop_s, neighbour_s: wall time in the time steps and of it in neighbour lists; steps; particles: at the end; builds:
    of the neighbour list. A run with `post no` tells no neighbour times and is left out.
    """
    text = Path(path).read_text("utf-8", "replace")
    found = list(_LOOP.finditer(text))
    ends = [after.start() for after in found[1:]]
    rows = []
    for loop, end in zip_longest(found, ends, fillvalue=len(text)):
        neighbours, builds = (pattern.search(text, loop.end(), end) for pattern in (_NEIGHBOURS, _BUILDS))
        if neighbours and builds:
            rows.append((float(loop[1]), float(neighbours[1]), int(loop[2]), int(loop[3]), int(builds[1])))
    columns = ("loop_s", "neighbour_s", "steps", "particles", "builds")
    return dict(zip(columns, np.array(rows, float).reshape(-1, len(columns)).T, strict=True))
