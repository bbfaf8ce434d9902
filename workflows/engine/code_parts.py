"""Hashes of the code that simulated numbers depend on, part by part, so that two versions can be compared without git.

Comments, docstrings and blank lines do not count, nor does what only draws, forecasts, checks or reports: of that,
tables and figures have a hash of their own.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path

from bulkwear.workflows.engine.project import PACKAGE
from bulkwear.workflows.engine.state import digest

LETTERS = 12  # of a part's hash
PARTS = {  # name: what it is of the package
    "wear": ("postproc/wear/*.py", "postproc/mesh.py", "postproc/mesh_checks.py", "postproc/readers/*.py"),
    "flow": ("postproc/flow/*.py",),
    "engine": ("workflows/engine/*.py",),
    "meshes": ("meshes/*.py",),
    "solver": ("solver/**/*.cpp", "solver/**/*.h"),
}
OF_CASE = {"case": "workflows/cases", "templates": "templates"}  # parts of which each run has its case's
SHARED_TEMPLATES = "_shared"
ASIDE = {  # files that change no number of a run
    *(f"workflows/engine/{name}.py" for name in ("code_parts", "inputs", "job", "own_code", "project", "ranks")),
    *(f"workflows/engine/{name}.py" for name in ("provenance", "state", "work")),
    *(f"workflows/engine/{name}.py" for name in ("disk", "patience", "records", "row_check")),
    *(f"workflows/engine/{name}.py" for name in ("own_machine", "series", "study_folder", "terminal")),
    *("postproc/readers/point_cloud.py", "postproc/readers/restart_file.py"),
    "meshes/estimate.py",
}
# of cases, what refuses, forecasts or evaluates
ASIDE_OF_CASES = {
    *("box_checks.py", "checks.py", "machine_checks.py", "range_checks.py"),
    *("evaluation.py", "study.py", "volume.py", "work.py"),
}
PLANS = ("workflows/config", "workflows/engine", "workflows/forecast")  # what plans and runs; others only ask it
ROOTS = ("case.py", "decks.py", "driver.py", "simulations.py")  # of a case's folder, whence its code is found
PACKAGE_NAME = "bulkwear"
STATEMENTS = ("body", "orelse", "finalbody")  # of a statement, where it holds others
BLOCKS = (*STATEMENTS, "handlers", "cases")
SIMPLE = (ast.Expr, ast.Assign, ast.AnnAssign, ast.AugAssign, ast.Return, ast.Import, ast.ImportFrom, ast.Raise)
# of Python: texts, within which a # begins no comment, and comments
TEXT_OR_COMMENT = re.compile(
    r"""("{3}|'{3})(?:\\.|(?!\1).)*\1|"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'|\#[^\n]*""", re.DOTALL
)


def part_hashes(cases: Iterable[str], root: Path = PACKAGE) -> dict[str, str]:
    """Return {part: hash} of a package's code for runs of cases, named as their folders in `workflows/cases`.

    root: folder of the package, or of another version of it
    """
    return hashes_of(part_files(tuple(cases), root), root)


def hashes_of(files: Mapping[str, Iterable[str]], root: Path = PACKAGE) -> dict[str, str]:
    """Return {part: hash} of parts whose files are known, as from `part_files`."""
    return {part: _hash_of(root, names) for part, names in files.items()}


def part_files(cases: Iterable[str], root: Path = PACKAGE) -> dict[str, list[str]]:
    """Return {part: the files that it consists of}, as paths from the package's folder, sorted."""
    found = {part: _matching(root, patterns) for part, patterns in PARTS.items()}
    folders = [SHARED_TEMPLATES, *cases]
    found["templates"] = _matching(root, [f"{OF_CASE['templates']}/{folder}/*.in.j2" for folder in folders])
    found["case"] = sorted({file for case in cases for file in case_files(case, root)})
    found["meshes"] += _matching(root, [f"{folder}/*.py" for folder in _mesh_folders(found["case"], root)])
    return found


def _mesh_folders(files: Iterable[str], root: Path) -> set[str]:
    """Return the folders within `meshes` that a case's files import from."""
    reached = {path.parent.relative_to(root).as_posix() for file in files for path in _imported(root / file, root)}
    return {folder for folder in reached if folder.startswith("meshes/")}


def _matching(root: Path, patterns: Iterable[str]) -> list[str]:
    files = (path.relative_to(root).as_posix() for pattern in patterns for path in root.glob(pattern))
    return sorted(file for file in files if file not in ASIDE)


def case_files(case: str, root: Path = PACKAGE) -> list[str]:
    """Return the files of cases that a case's class, its decks and its jobs reach by imports.

    Figures, findings and pages are so not among them.
    """
    folder = root / OF_CASE["case"]
    starts = [path for name in ROOTS if (path := folder / case / name).is_file()]
    reached = _reached(starts, root, lambda file: folder in file.parents and file.name not in ASIDE_OF_CASES)
    return sorted(path.relative_to(root).as_posix() for path in reached)


def code_of_shown(modules: Iterable[Path], root: Path = PACKAGE) -> str:
    """Return the hash of modules that make tables, figures or pages, and of what of the package they reach by imports.

    Of what plans and runs they reach those modules alone that they, or others that show, import themselves.
    """
    plans = [root / folder for folder in PLANS]
    reached = _reached(modules, root, follows=lambda file: not any(folder in file.parents for folder in plans))
    beside = {page for folder in {path.parent for path in reached} for page in folder.glob("*.html")}
    return digest(*(_essence_of(path) for path in sorted(reached | beside)))[:LETTERS]


def _reached(
    starts: Iterable[Path],
    root: Path,
    counts: Callable[[Path], bool] = lambda file: True,
    follows: Callable[[Path], bool] = lambda file: True,
) -> set[Path]:
    """Return the files that count of those at the starts and what is imported from there; follows: what is read on."""
    waiting, found = list(starts), set()
    while waiting:
        path = waiting.pop()
        if path not in found and counts(path):
            found.add(path)
            waiting += _imported(path, root) if follows(path) else []
    return found


def _imported(path: Path, root: Path) -> Iterator[Path]:
    """Yield the files of the package that a module imports, at its top or within its functions, for types alone not."""
    for module, names in _imports_of(path):
        folder = root.joinpath(*module.split(".")[1:])
        files = [folder.with_suffix(".py"), *(folder / f"{name}.py" for name in names)]
        yield from (file for file in files if file.is_file())


def _imports(block: Iterable[ast.AST]) -> Iterator[ast.ImportFrom]:
    """Yield the imports from the package in a block of statements and in the blocks within it, for types alone not."""
    for each in block:
        if isinstance(each, ast.ImportFrom) and (each.module or "").startswith(PACKAGE_NAME):
            yield each
        elif not isinstance(each, SIMPLE) and not _is_for_types(each):
            for name in BLOCKS:
                yield from _imports(getattr(each, name, ()))


def _is_for_types(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"


def _hash_of(root: Path, files: Iterable[str]) -> str:
    parts = [text for file in files for text in (file, _essence_of(root / file))]
    return digest(*parts)[:LETTERS]


def _essence_of(path: Path) -> str:
    return _kept(path, path.stat().st_mtime_ns)[0]


def _imports_of(path: Path) -> tuple[tuple[str, tuple[str, ...]], ...]:
    return _kept(path, path.stat().st_mtime_ns)[1]


@cache  # a process that simulates several runs, or plans several figures, asks for each
def _kept(path: Path, changed_ns: int) -> tuple[str, tuple[tuple[str, tuple[str, ...]], ...]]:
    """Return what counts of a file, and of Python what it imports from the package: (module, names)."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        return {".cpp": essence_of_solver, ".h": essence_of_solver}.get(path.suffix, str)(text), ()
    tree = ast.parse(text)
    imports = tuple((node.module, tuple(name.name for name in node.names)) for node in _imports(tree.body))
    return essence(text, tree), imports


def essence_of_solver(text: str) -> str:
    """Return C++ without blank lines and lines that are comments alone."""
    return "\n".join(line.rstrip() for line in text.splitlines() if not line.lstrip().startswith("//") and line.strip())


def essence(text: str, tree: ast.Module | None = None) -> str:
    """Return Python without comments, docstrings, blank lines and spaces at line ends; tree: the text parsed."""
    lines = TEXT_OR_COMMENT.sub(lambda found: "" if found[0].startswith("#") else found[0], text).splitlines()
    for said in _docstrings(tree or ast.parse(text)):
        lines[said.lineno - 1 : said.end_lineno] = [""] * (said.end_lineno - said.lineno + 1)
    return "\n".join(line.rstrip() for line in lines if line.strip())


def _docstrings(node: ast.Module | ast.stmt) -> Iterator[ast.expr]:
    """Yield what documents a module, its classes and functions; a text below a constant counts as such."""
    for name in STATEMENTS:
        for each in getattr(node, name, ()):
            if (
                isinstance(each, ast.Expr)
                and isinstance(each.value, ast.Constant)
                and isinstance(each.value.value, str)
            ):
                yield each.value
            elif not isinstance(each, SIMPLE):
                yield from _docstrings(each)
