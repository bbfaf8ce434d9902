"""Solids of STEP, IGES and BREP files, meshed on their true surfaces.

OpenCASCADE crashes on some damaged files, reads others without an end, and says of others on the terminal alone that it
skipped a line. So it reads in a process of its own (`cad_shapes`), with a limit on its processor time.
"""

from __future__ import annotations

import pickle
import re
import signal
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bulkwear.meshes.own.cad_units import UNIT_READERS, said_unit
from bulkwear.meshes.own.solids import Solids, metres_per

CAD_FORMATS = (".step", ".stp", ".iges", ".igs", ".brep")
MM = 1e-3  # m; OpenCASCADE hands over mm of formats that tell their unit, whatever it is
PROGRAM = "bulkwear.meshes.own.cad_shapes"
LONGEST_REASON = 200  # letters of what a process said last
# how OpenCASCADE tells of lines that it could not read
SKIPPED = re.compile(r"ERR StepFile\s*:\s*(?:Undefined Parsing:\s*)?([^*\x1b]+)")


def read_cad_solids(
    path: Path, unit: str, edges: Mapping[str, float] | float | None, solid: str | None = None
) -> tuple[Solids, float]:
    """Solids of a CAD file, meshed, and the m of its numbers; bodies are parts, and so are connected free faces.

    edges: m, target edge of all parts or by name of a part; solid: the only part that is meshed, None: all. Raises
    ValueError where no edge is given, where the file says another unit, or where it cannot be read or meshed.
    """
    if edges is None:
        raise ValueError(f"{path}: a CAD file has no triangles, allowed is a target edge that they are made with")
    scale = _metres_of_file(path, unit)
    return _apart(path, "solids", scale, edges, solid), scale


def cad_areas(path: Path, unit: str) -> dict[str, float]:
    """Area (m2) of the true surface of each part of a CAD file; nothing is meshed. Raises as `read_cad_solids`."""
    return _apart(path, "areas", _metres_of_file(path, unit))


def _apart(path: Path, what: str, scale: float, *choices: Any) -> Any:
    """Return the solids or the areas of a file, read in a process of its own. Raises ValueError with its reason."""
    asked = pickle.dumps((path, what, scale, *choices))
    ended = subprocess.run([sys.executable, "-m", PROGRAM], input=asked, capture_output=True)
    said = ended.stderr.decode("utf-8", "replace")
    if ended.returncode:
        raise ValueError(f"{path}: not a readable {path.suffix} file (OpenCASCADE {_end_of(ended.returncode, said)})")
    if skipped := SKIPPED.search(said):
        raise ValueError(f"{path}: not a whole {path.suffix} file ({' '.join(skipped[1].split())})")
    found = pickle.loads(ended.stdout)
    if isinstance(found, ValueError):
        raise found
    return found


def _end_of(code: int, said: str) -> str:
    """Return how a process ended that gave no answer, from its exit code and what it said."""
    if code == -signal.SIGXCPU:
        return "came to no end within its processor time"
    return f"ended with signal {-code}" if code < 0 else f"ended with {' '.join(said.split())[-LONGEST_REASON:]}"


def _metres_of_file(path: Path, unit: str) -> float:
    """Metres of the numbers that OpenCASCADE hands over. Raises ValueError where the file says another unit."""
    _check_unit(path, unit)
    return MM if path.suffix.lower() in UNIT_READERS else metres_per(unit)


def _check_unit(path: Path, unit: str) -> None:
    """Raise ValueError where the file says a unit and it is not this one."""
    metres_per(unit)
    said = said_unit(path)
    if said is not None and said != unit:
        raise ValueError(f"{path}: the file says that its lengths are in {said}, found unit {unit}; allowed is {said}")
