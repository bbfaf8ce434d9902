"""The cases that there are: folders of the project and the package, each with a module that registers its case."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from types import ModuleType

from bulkwear.workflows.engine.case import CASES_PACKAGE, REGISTERED, Case
from bulkwear.workflows.engine.project import (
    CASES_OF_PACKAGE,
    ProjectError,
    cases_folders,
    current_project,
    import_fault,
    open_package,
)


def case_names() -> list[str]:
    """Return the names of all cases: the folders with a module `case`, of the project and of the package."""
    return sorted({path.parent.name for folder in cases_folders() for path in folder.glob("*/case.py")})


def find_case(name: str) -> Case:
    """Return the case of that name, imported when it is first asked for.

    Raises ValueError naming all cases, ProjectError for one that cannot be imported or registers no case of its name.
    """
    if name not in case_names():
        raise ValueError(f"case is '{name}', allowed is one of {', '.join(case_names())}.")
    package = importlib.import_module(CASES_PACKAGE)
    package.__path__[:] = map(str, cases_folders())
    path = next(file for folder in cases_folders() if (file := folder / name / "case.py").is_file())
    known = sys.modules.get(f"{CASES_PACKAGE}.{name}.case")
    if known is not None and Path(known.__file__) != path:
        raise ProjectError(f"{_shown(path)}: {known.__file__} is in use here, allowed is one case of a name.")
    if known is None and CASES_OF_PACKAGE not in path.parents and not path.with_name("__init__.py").exists():
        open_package(f"{CASES_PACKAGE}.{name}", path.parent)  # before the package's, which may have one of that name
    try:
        importlib.import_module(f"{CASES_PACKAGE}.{name}.case")
    except Exception as fault:
        raise ProjectError(import_fault(fault, path, current_project().folder)) from fault
    if name not in REGISTERED:
        raise ProjectError(
            f"{_shown(path)}: it registers no case {name}, allowed is register(...) of a Case of that name."
        )
    return REGISTERED[name]


def _shown(path: Path) -> str:
    folder = current_project().folder
    return path.relative_to(folder).as_posix() if path.is_relative_to(folder) else str(path)


def case_packages(case: Case) -> list[str]:
    """Return the packages of a case and of those that its class extends, its own first."""
    classes = [each for each in type(case).__mro__ if each.__module__.startswith(f"{CASES_PACKAGE}.")]
    return list(dict.fromkeys(each.__module__.rpartition(".")[0] for each in classes))


def case_folders(case: Case) -> list[Path]:
    """Return the folders of `case_packages`."""
    return [Path(sys.modules[f"{package}.case"].__file__).parent for package in case_packages(case)]


def case_module(case: Case, name: str) -> ModuleType:
    """Return a module of a case's folder, or the one of the case that it extends. Raises ModuleNotFoundError."""
    file = Path(*name.split(".")).with_suffix(".py")
    there = zip(case_packages(case), case_folders(case), strict=True)
    package = next((package for package, folder in there if (folder / file).is_file()), case_packages(case)[0])
    return importlib.import_module(f"{package}.{name}")
