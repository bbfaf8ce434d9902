"""Hashes of what results depend on in a project beside its configuration: Python of its cases and laws, and its meshes.

For runs the package's own code has a version instead (`postproc.wear.WEAR_VERSION`): raised where a change gives other
numbers. Tables and figures, which cost no solver time, are made again where their code is another.
"""

from __future__ import annotations

import importlib.util
from functools import cache
from pathlib import Path

from bulkwear.postproc.wear.laws import law_of
from bulkwear.workflows.engine.case import Case
from bulkwear.workflows.engine.cases import case_folders
from bulkwear.workflows.engine.code_parts import code_of_shown
from bulkwear.workflows.engine.own_kernels import own_sources
from bulkwear.workflows.engine.project import CASES_OF_PACKAGE, MESHES, PACKAGE, current_project
from bulkwear.workflows.engine.state import file_digest

PLOTS = "plots"  # folder of what draws


def code_of_case(case: Case) -> dict[str, str]:
    """Return {file: its hash} of what runs of a project's own case depend on; empty for the package's cases.

    That is all Python of the project's cases, figures and pages aside, and its meshes.
    """
    own = [folder for folder in case_folders(case) if CASES_OF_PACKAGE not in folder.parents]
    if not own:
        return {}
    cases, shown = own[0].parent, {"page.py", *(f"{name.replace('.', '/')}.py" for name in case.figure_modules)}
    files = [path for path in cases.rglob("*.py") if PLOTS not in path.parts and _within_case(path, cases) not in shown]
    files += [path for path in (cases.parent / MESHES).rglob("*") if path.is_file()]
    return {path.relative_to(cases.parent).as_posix(): _hash(path) for path in sorted(files)}


def _within_case(path: Path, cases: Path) -> str:
    return "/".join(path.relative_to(cases).parts[1:])


def code_of_law(name: str) -> dict[str, str]:
    """Return {file: its hash} of a project's own law, the helpers beside it, and its contact kernels in C++.

    Empty for the package's laws with the package's kernels.
    """
    law = dict(current_project().own_laws).get(name)
    files = [law, *sorted(law.parent.glob("_*.py"))] if law else []
    return {path.name: _hash(path) for path in (*files, *own_sources(law_of(name).kernels).values())}


def code_that_shows(*modules: str) -> str:
    """Return the hash of modules of tables, figures or a page, by their names, and of what of the package they import.

    Of a project's own modules it holds what draws in plots/ beside them as well.
    """
    paths = [Path(importlib.util.find_spec(name).origin) for name in modules]
    own = [path for path in paths if PACKAGE not in path.parents]
    return code_of_shown([*paths, *(file for path in own for file in (path.parent / PLOTS).rglob("*.py"))])


def _hash(path: Path) -> str:
    found = path.stat()
    return _kept_hash(path, found.st_mtime_ns, found.st_size)


@cache  # a study asks once per run, and meshes may be large
def _kept_hash(path: Path, changed_ns: int, size: int) -> str:
    return file_digest(path)
