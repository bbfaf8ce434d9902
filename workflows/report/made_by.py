"""What made a study's results: versions of the code, of programs and packages, and what the solver warned of."""

from __future__ import annotations

import importlib.metadata
import os
import platform
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from bulkwear.postproc.readers.cycle_folders import cycle_files
from bulkwear.postproc.readers.solver_log import solver_version
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.project import PACKAGE, current_project
from bulkwear.workflows.engine.provenance import commit_of, git, package_cases, package_commit, simulating_code
from bulkwear.workflows.engine.provenance import package_version as installed_version
from bulkwear.workflows.engine.records import read_record
from bulkwear.workflows.engine.solver import LOG
from bulkwear.workflows.report.simulated import said_of, versions_of, warnings_of

PACKAGES = (
    "numpy",
    "scipy",
    "pandas",
    "numba",
    "meshio",
    "gmsh",
    "pyvista",
    "vtk",
    "matplotlib",
    "snakemake",
)


def simulation_folders(study: Mapping[str, Any], folder: Path) -> list[Path]:
    """Return the folders of a study's simulations."""
    return find_case(study["case"]).simulation_folders(folder, list(study["runs"]))


def simulated(study: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return what the template says of the versions that simulated a study, and what of the code is newer."""
    case = find_case(study["case"])
    found = versions_of(simulation_folders(study, folder), [folder / "beds" / bed for bed in study["beds"]])
    days = sorted(day for version in found for day in version.dates if day)
    return {
        "simulated": said_of(found),
        "simulated_on": " to ".join(dict.fromkeys([days[0], days[-1]])) if days else "",
        "page_by": package_version(),
        "older": warnings_of(found, simulating_code(case), package_cases(case)),
    }


def versions(study: Mapping[str, Any], folder: Path) -> dict[str, str]:
    """Return the versions of everything that made the results."""
    log = next((log for run in simulation_folders(study, folder) for log in cycle_files(run, LOG)), None)
    said = solver_version(log) if log else None
    found = {"LIGGGHTS": said.removeprefix("Version ") if said else "not reported"}
    project = current_project()
    found["bulkwear, which wrote this page"] = package_version()
    if not project.is_package:
        found["this project"] = commit(project.folder)
    found["Python"] = f"{platform.python_version()} on {platform.system()} {platform.machine()}, {os.cpu_count()} cores"
    for name in PACKAGES:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return found


def package_version() -> str:
    """Return the commit of the package, or the version that was installed."""
    if package_commit():
        return commit(PACKAGE)
    version = installed_version()
    return f"version {version}" if version else "version not known"


def commit(repository: Path) -> str:
    """Return the commit of a repository, and whether files differ from it; what is known where git is not there."""
    found = commit_of(repository)
    if not found:
        return "commit not known"
    return f"commit {found}{' with changes' if git(repository, 'status', '--porcelain') else ''}"


def solver_warnings(study: Mapping[str, Any], folder: Path) -> list[dict[str, Any]]:
    """Return the solver's warnings over all cycles of all simulations: what was said, how often."""
    counts: dict[str, int] = {}
    for said, count in _warnings_of(simulation_folders(study, folder)):
        counts[said] = counts.get(said, 0) + count
    return [{"said": said, "count": count} for said, count in sorted(counts.items(), key=lambda item: -item[1])]


def _warnings_of(folders: Iterable[Path]) -> Iterable[tuple[str, int]]:
    for folder in folders:
        for path in cycle_files(folder, "state.json"):
            yield from read_record(path).get("solver_warnings", {}).items()
