"""How long studies of paper fidelity take to plan, on one machine and for a cluster: dry runs as processes."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from benchmarks.measure import Measure, in_turn, measured
from bulkwear.workflows.config.design import list_studies

ROOT = Path(__file__).resolve().parents[1]
PROFILES = ("default", "slurm")
ROUNDS, QUICK_ROUNDS = 3, 1
QUICK_STUDIES = ("demo",)


def planned(study: str, profile: str) -> tuple[float, float]:
    """Plan a study; return wall and processor time of the process, in s. Compiled modules are kept, as by `make`."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    words = [sys.executable, "-m", "snakemake", study, "--dry-run", "--config", "fidelity=paper"]
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run(
        [*words, "--workflow-profile", f"profiles/{profile}"], cwd=ROOT, env=kept, check=True, capture_output=True
    )
    wall, after = time.monotonic() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return the wall time of each study and profile, and the processor time of both profiles against each other."""
    studies = QUICK_STUDIES if quick else list_studies()

    def way(study: str, profile: str) -> Callable[[], tuple[float, float]]:
        return lambda: planned(study, profile)

    ways = {(study, profile): way(study, profile) for study in studies for profile in PROFILES}
    next(iter(ways.values()))()  # compiles what is not
    found = in_turn(ways, QUICK_ROUNDS if quick else ROUNDS)
    told = []
    for study in studies:
        walls = {profile: [wall for wall, _ in found[study, profile]] for profile in PROFILES}
        told += [measured(f"{study}, {profile} profile", "s", walls[profile]) for profile in PROFILES]
        spent = [[processor for _, processor in found[study, profile]] for profile in PROFILES]
        told.append(measured(f"{study}, processor time, slurm", "s", spent[1], "default", spent[0]))
    return told
