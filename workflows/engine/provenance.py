"""What simulated a cycle, a bed or a bulk test: the commit and hashes of our code, the solver, the machine, its speed.

It stands in the record that a simulation leaves and decides nothing: no digest holds it, so another commit simulates
nothing again. Where git is not there, as in an installed package, version and hashes tell which code it was.
"""

from __future__ import annotations

import importlib.metadata
import json
import subprocess
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

from bulkwear.postproc.wear import WEAR_VERSION
from bulkwear.workflows.engine.case import Case
from bulkwear.workflows.engine.cases import case_folders
from bulkwear.workflows.engine.code_parts import hashes_of, part_files
from bulkwear.workflows.engine.machine import interpreter, machine_facts, program_hashes
from bulkwear.workflows.engine.own_code import code_of_case
from bulkwear.workflows.engine.project import CASES_OF_PACKAGE, PACKAGE
from bulkwear.workflows.engine.state import DIGEST_LETTERS, digest

PROVENANCE = "provenance"  # key of a state, and name of the file where there is none
PROVENANCE_FILE = f"{PROVENANCE}.json"
OWN = "project"  # part of the code that a project's own case is
COMMIT_LETTERS = 12


def simulating_code(case: Case) -> dict[str, Any]:
    """Return which code simulates runs of a case in this process: as it was when the process asked first.

    version, wear_version; commit and whether files that matter differ from it (changed), both None without git; parts,
    the hashes of `part_hashes`, and of a project's own case that of its code
    """
    own = code_of_case(case)
    parts = {OWN: digest(own)[:DIGEST_LETTERS]} if own else {}
    found = code_of_cases(package_cases(case))
    return {**found, "parts": {**found["parts"], **parts}}


def package_cases(case: Case) -> tuple[str, ...]:
    """Return the names of the package's cases whose code a case's runs go through: its own, those it extends."""
    folders = [folder for folder in case_folders(case) if folder.parent == CASES_OF_PACKAGE]
    return tuple(folder.name for folder in folders)


@cache
def code_of_cases(cases: tuple[str, ...]) -> dict[str, Any]:
    """Return `simulating_code` of the package's own cases by their names."""
    parts = part_files(cases)
    files = [file for found in parts.values() for file in found]
    commit = package_commit()
    return {
        "version": package_version(),
        "wear_version": WEAR_VERSION,
        "commit": commit,
        "changed": bool(git(PACKAGE, "status", "--porcelain", "--", *files)) if commit else None,
        "parts": hashes_of(parts),
    }


def provenance(code: Mapping[str, Any], executable: str, cost: Mapping[str, float]) -> dict[str, Any]:
    """Return what the record of a simulation tells of what made it.

    code: as from `simulating_code`
    executable: the solver's program
    cost: of the simulation; `processor_s`, `particles` and `steps` give the solver's speed
    """
    amount = cost["particles"] * cost["steps"]
    spent = cost.get("processor_s")
    return {
        **code,
        "programs": program_hashes(executable),
        "machine": machine_facts() | interpreter(),
        "solver_s_per_particle_step": float(f"{spent / amount:.4g}") if spent and amount else None,
        "date": datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
    }


def write_provenance(folder: Path, found: Mapping[str, Any]) -> None:
    """Write the provenance of a simulation that has no state, as a bed's."""
    (folder / PROVENANCE_FILE).write_text(json.dumps(found, indent=1) + "\n")


def package_version() -> str | None:
    """Return the version of the package that is installed, None where it is not."""
    try:
        return importlib.metadata.version("bulkwear")
    except importlib.metadata.PackageNotFoundError:
        return None


def package_commit() -> str | None:
    """Return the commit of the package; None where it is installed, and then lies in a repository of something else."""
    return commit_of(PACKAGE) if (PACKAGE / ".git").exists() else None


def commit_of(folder: Path) -> str | None:
    """Return the commit of the git repository that a folder is in, None where there is none."""
    return git(folder, "rev-parse", f"--short={COMMIT_LETTERS}", "HEAD") or None


def git(repository: Path, *words: str | Iterable[str]) -> str | None:
    """Return what git says in a repository, None where it fails or is not there."""
    command = ["git", "-c", f"safe.directory={repository}", *words]
    try:
        return subprocess.run(command, cwd=repository, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return None
