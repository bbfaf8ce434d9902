"""The two folders that a workflow reads: the package, which is this repository, and the project that is worked in.

A project is any folder with `config/`; it may hold `templates/`, `cases/`, `laws/` and `meshes/` as well, and gets
`results/`. A file is looked up in the project first, then in the package. The repository is its own project.
"""

from __future__ import annotations

import difflib
import importlib
import os
import sys
import traceback
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import ModuleType

from bulkwear.postproc.wear.kernels import KERNELS as REGISTERED_KERNELS
from bulkwear.postproc.wear.kernels import register_kernel
from bulkwear.postproc.wear.laws import LAWS as REGISTERED_LAWS
from bulkwear.postproc.wear.laws import register_law

PACKAGE = Path(__file__).resolve().parents[2]
CONFIG, TEMPLATES, CASES, LAWS, MESHES = "config", "templates", "cases", "laws", "meshes"  # folders of a project
CASES_OF_PACKAGE = PACKAGE / "workflows" / CASES
LAWS_OF_PACKAGE, KERNELS_OF_PACKAGE = frozenset(REGISTERED_LAWS), frozenset(REGISTERED_KERNELS)
LAWS_PACKAGE = "bulkwear_laws"  # by which a project's laws and their helpers are imported
ALIKE = 0.85  # of names of files: so much of them is the same
LAW, KERNELS = "LAW", "KERNELS"  # what a module of laws/ has


class ProjectError(ValueError):
    """A project that cannot be worked in, in one sentence: file, what was found, what is allowed."""


@dataclass(frozen=True)
class Project:
    """A project and the package that it is worked in with.

    own_laws: (name, file) of the wear laws that are the project's; a file that begins with _ is a helper of theirs
    """

    folder: Path
    package: Path = PACKAGE
    own_laws: tuple[tuple[str, Path], ...] = ()

    @cached_property
    def is_package(self) -> bool:
        """Return whether the package is its own project."""
        return self.folder.resolve() == self.package.resolve()

    @property
    def folders(self) -> tuple[Path, ...]:
        """Return the folders in which a file is looked up, in this order."""
        return (self.folder,) if self.is_package else (self.folder, self.package)

    def every(self, name: str) -> list[Path]:
        """Return the files of that path below project and package, the one that counts first."""
        return [folder / name for folder in self.folders if os.path.isfile(folder / name)]  # of a name too long, too

    def file(self, name: str) -> Path:
        """Return the file of that path, the project's where it has one."""
        return next(iter(self.every(name)), self.folder / name)

    def path(self, name: str) -> str:
        """Return the path of that file as rules have it: relative, where it is in the project that is worked in."""
        found = self.file(name)
        return name if found == self.folder / name and self.folder.resolve() == Path.cwd() else str(found)

    def names(self, folder: str, suffix: str) -> list[str]:
        """Return the names of all files in a folder of project and package."""
        return sorted({path.name for root in self.folders for path in (root / folder).glob(f"*{suffix}")})

    def law_file(self, law: str) -> str:
        """Return the file of a wear law of the project's own, within its folder; nothing of one of the package."""
        found = dict(self.own_laws).get(law)
        return f"{LAWS}/{found.name}" if found else ""

    def substitutes(self) -> list[str]:
        """Return a sentence for each file of the project that stands before one of the package."""
        if self.is_package:
            return []
        theirs = template_files(self.package)
        cases = {path.parent.name for path in CASES_OF_PACKAGE.glob("*/case.py")}
        settings = (path for path in self._own(CONFIG, "**/*.*") if path.parent.name != "studies")
        found = [
            *(path for path in settings if (self.package / path).is_file() and path.name != "README.md"),
            *sorted(path for name, path in template_files(self.folder).items() if name in theirs),
            *(path.parent for path in self._own(CASES, "*/case.py") if path.parent.name in cases),
            *(path for path in self._own(LAWS, "*.py") if path.stem in LAWS_OF_PACKAGE),
        ]
        return [f"{path.as_posix()}: this project's, {_before(path)} the package's" for path in found]

    def astray(self) -> list[str]:
        """Return a sentence for each file of the project that nearly has the name of one of the package, or has it in
        another folder, and so does not stand before it: templates, and files right in `config/` and of its cases; and
        for each that is nearly a study.
        """
        if self.is_package:
            return []
        own, theirs = template_files(self.folder), template_files(self.package)
        before = {path for name, path in own.items() if name in theirs}
        known = {path.name: path for path in theirs.values()}
        settings = {path.name: path.relative_to(self.package) for path in (self.package / CONFIG).glob("*.yaml")}
        cases = {path.name: path.relative_to(self.package) for path in (self.package / CONFIG / CASES).glob("*.yaml")}
        found = [
            *((path, known) for path in self._own(TEMPLATES, "**/*.*") if path not in before),
            *((path, settings) for path in self._own(CONFIG, "*.y*ml") if path.name not in settings),
            *((path, cases) for path in self._own(CONFIG, f"{CASES}/*.yml")),  # .yaml of no case is refused
        ]
        near = [(path, difflib.get_close_matches(path.name, names, 1, ALIKE), names) for path, names in found]
        return [
            *(
                f"{path.as_posix()}: not in place of the package's {names[name].as_posix()}, whose name it nearly has"
                for path, (name, *_), names in ((path, close, names) for path, close, names in near if close)
            ),
            *(
                f"{path.as_posix()}: no study, whose file ends with .yaml"
                for path in self._own(f"{CONFIG}/studies", "*.yml")
            ),
        ]

    def _own(self, folder: str, pattern: str) -> list[Path]:
        """Return the project's files of a folder, from the project's folder."""
        return sorted(path.relative_to(self.folder) for path in (self.folder / folder).glob(pattern))


def _before(path: Path) -> str:
    """Return how a file of the project stands to the package's; of YAML, what it does not name is the package's."""
    return "over" if path.parts[0] == CONFIG and path.suffix == ".yaml" else "not"


def template_files(root: Path) -> dict[str, Path]:
    """Return the templates of a project or the package by the names that they are found by, as paths from there.

    A folder in templates/ is looked through for any template, one that begins with _ is part of the name of partials.
    """
    folder = root / TEMPLATES
    files = [path.relative_to(folder) for pattern in ("*.in.j2", "*/*.in.j2") for path in sorted(folder.glob(pattern))]
    named = [(path.as_posix() if path.parts[0].startswith("_") else path.name, path) for path in files]
    return {name: Path(TEMPLATES) / path for name, path in reversed(named)}


ITS_OWN = Project(PACKAGE)
_entered: list[Project] = []


def current_project() -> Project:
    """Return the project that this process works in: the one it entered last, else the package itself."""
    return _entered[-1] if _entered else ITS_OWN


def enter_project(folder: Path) -> Project:
    """Work in a project from now on: its cases can be found, its wear laws are registered.

    Raises ProjectError for a folder without `config/`, and for a law that cannot be used.
    """
    if not (folder / CONFIG).is_dir():
        raise ProjectError(
            f"{folder}: there is no folder {CONFIG} in it, allowed is a project, with {CONFIG}/studies and "
            f"{CONFIG}/designs; `make project DIR=...` in the package makes one."
        )
    project = Project(folder)
    if project.is_package:
        _entered[:] = [project]
        return project
    laws = sorted((folder / LAWS).glob("[!_]*.py"))
    open_package(LAWS_PACKAGE, folder / LAWS)
    for path in laws:
        _register_law(path, folder)
    _entered[:] = [Project(folder, own_laws=tuple((path.stem, path) for path in laws))]
    return _entered[-1]


def work_here() -> None:
    """Enter the project of the working directory, where it is one: for commands."""
    if (Path.cwd() / CONFIG).is_dir():
        enter_project(Path.cwd())


def leave_project() -> None:
    """Work in the package itself again; laws that were registered stay so."""
    _entered.clear()


def cases_folders() -> list[Path]:
    """Return the folders that hold cases, a folder each: the project's, then the package's."""
    project = current_project()
    own = [] if project.is_package else [project.folder / CASES]
    return [folder for folder in (*own, CASES_OF_PACKAGE) if folder.is_dir()]


def _register_law(path: Path, folder: Path) -> None:
    """Register the law of a module of laws/ under the name of its file, and the contact kernels it brings."""
    name = path.relative_to(folder).as_posix()
    try:
        module = importlib.import_module(f"{LAWS_PACKAGE}.{path.stem}")
    except (Exception, SystemExit) as fault:
        raise ProjectError(import_fault(fault, path, folder)) from fault
    if not hasattr(module, LAW):
        raise ProjectError(f"{name}: there is no {LAW} in it, allowed is a module with {LAW} = Law(...).")
    kernels = getattr(module, KERNELS, {})
    if not isinstance(kernels, dict):
        raise ProjectError(f"{name}: {KERNELS} is {kernels!r}, allowed are names with a Kernel(...) each, in braces.")
    try:
        for kernel, declared in kernels.items():
            register_kernel(kernel, declared)
        register_law(path.stem, getattr(module, LAW))
    except ValueError as fault:
        raise ProjectError(f"{name}: {fault}.") from None


def open_package(name: str, folder: Path) -> None:
    """Let the modules of a folder be imported as those of a package of that name, as they are now."""
    for known in [module for module in sys.modules if module == name or module.startswith(f"{name}.")]:
        del sys.modules[known]
    package = sys.modules[name] = ModuleType(name)
    package.__path__ = [str(folder)]
    importlib.invalidate_caches()


def import_fault(fault: Exception, path: Path, folder: Path) -> str:
    """Return the sentence for a Python file of a project that cannot be imported, or that fails.

    path: of the file, where the fault tells of none in the project's folder
    """
    places = [(step.filename, step.lineno) for step in traceback.extract_tb(fault.__traceback__)]
    if isinstance(fault, SyntaxError) and fault.filename:
        places.append((fault.filename, fault.lineno))
    ours = [(Path(name), line) for name, line in places if Path(name).is_relative_to(folder)]
    file, line = ours[-1] if ours else (path, None)
    shown = file.relative_to(folder).as_posix() if file.is_relative_to(folder) else str(file)
    words = (fault.msg if isinstance(fault, SyntaxError) else str(fault)).removesuffix(".")
    where = f"{shown}, line {line}" if line else shown
    return f"{where}: {type(fault).__name__}: {words}; allowed is Python that runs."
