"""What a simulation ran on: processor, memory, system, and the solver's programs as they are installed."""

from __future__ import annotations

import os
import platform
import re
import shutil
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from bulkwear.workflows.engine.state import file_digest

LETTERS = 12  # of a program's hash
SOLVER_LIBRARY = "liggghts"  # in the name of the library that the programs share


def machine_facts() -> dict[str, Any]:
    """Return processor, cores, memory (GB) and system of this machine."""
    pages = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "memory_gb": round(pages / 1e9, 1),
        "system": f"{platform.system()} {platform.machine()}",
    }


def _processor() -> str:
    try:
        found = re.search(r"^model name\s*:\s*(.+)$", Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    except OSError:
        found = None
    return found[1].strip() if found else platform.processor() or platform.machine()


def interpreter() -> dict[str, str]:
    """Return the versions of Python and NumPy that this process runs with."""
    return {"python": platform.python_version(), "numpy": np.__version__}


@cache  # a driver simulates many cycles with the same program
def program_hashes(executable: str) -> dict[str, str]:
    """Return {file name: hash} of a solver's program and of the solver's library that it loads; empty without it."""
    found = shutil.which(executable)
    files = [Path(found), *_solver_libraries(found)] if found else []
    return {path.name: file_digest(path)[:LETTERS] for path in files}


def _solver_libraries(program: str) -> list[Path]:
    try:
        said = subprocess.run(["ldd", program], capture_output=True, text=True).stdout
    except OSError:
        return []
    paths = re.findall(r"=> (/\S+)", said)
    return [path for path in map(Path, paths) if SOLVER_LIBRARY in path.name]
