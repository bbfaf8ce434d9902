"""Write docs/verification.md, what is checked, in the tests' own words: python -m tests.support.verification_page

Each test module says in its first line what it holds to what; of physics on the real solver each test does.
"""

import ast
import textwrap
from pathlib import Path

from tests import REPOSITORY

FILE = REPOSITORY / "docs" / "verification.md"
LINE = 118  # characters of the page
SECTIONS = (  # title, folders and files below tests; a file belongs to the first that holds it
    ("Physics on the real solver", ("verification",)),
    ("Wear: ledger, laws, displacement, remeshing, life", ("postproc/wear",)),
    ("Surfaces and their meshes", ("meshes", "postproc/test_mesh.py", "postproc/test_mesh_checks.py")),
    ("Motions", ("postproc/test_motion.py",)),
    ("Statistics and calibration", ("postproc/statistics", "postproc/inference")),
    ("Closed forms", ("postproc/reference",)),
    ("Flow of the bulk", ("postproc/flow",)),
    ("Scans", ("postproc/scans",)),
    ("Files, tables, figures", ("postproc",)),
    ("Case: sliding samples", ("workflows/cases/sliding_sample",)),
    ("Case: circular wear tester", ("workflows/cases/circular_tester",)),
    ("Case: pin on disc", ("workflows/cases/pin_on_disc",)),
    ("Case: equipment", ("workflows/cases/equipment",)),
    ("Case: calibration", ("workflows/cases/calibration",)),
    ("Engine: cycles, decks, states, ledgers", ("workflows/engine", "workflows/cases")),
    ("Configuration", ("workflows/config",)),
    ("Forecasts", ("workflows/forecast",)),
    ("Reports and results", ("workflows/report", "workflows/results")),
    ("Set-up, projects, clusters, Snakemake", ("workflows",)),
    ("Benchmarks", ("benchmarks",)),
    ("Repository, package, documentation", (".",)),
)
IN_WORDS = "verification"  # the folder whose tests are told one by one
HEAD = """# What is checked

Generated from the docstrings of the tests by `python -m tests.support.verification_page`; not to be edited. `make test`
runs all but those marked *long*, which `make verify` runs.

Every run checks itself, too: removed plus carried volume is coefficient times work in each cycle (`balance_error` in
`wear.csv`), no particle is missing, the solver has every triangle. A run that fails one stops there.
"""


def page() -> str:
    """Return the page: a section for each field, a line for each test module."""
    left = sorted(REPOSITORY.glob("tests/**/test_*.py"))
    parts = [HEAD]
    for title, places in SECTIONS:
        inside = [path for path in left if any(path.is_relative_to(REPOSITORY / "tests" / place) for place in places)]
        left = [path for path in left if path not in inside]
        parts.append(f"## {title}\n\n" + "".join(map(lines_of, inside)))
    return "\n".join(parts)


def lines_of(path: Path) -> str:
    """Return what the page says of a test module."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    name = path.relative_to(REPOSITORY).as_posix()
    link = f"([{path.stem.removeprefix('test_')}](../{name}))"
    said = [point(f"{first_line(tree)}{mark(is_long(tree))} {link}", 0)]
    if Path(name).parts[1] == IN_WORDS:
        tests = [node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")]
        said += [point(first_line(test) + mark(is_long(test)), 2) for test in tests]
    return "".join(said)


def point(text: str, indent: int) -> str:
    """Return a point of a list, in lines of the page's length."""
    begin = " " * indent
    kept = {"break_long_words": False, "break_on_hyphens": False}
    return textwrap.fill(text, LINE, initial_indent=f"{begin}* ", subsequent_indent=f"{begin}  ", **kept) + "\n"


def first_line(node: ast.Module | ast.FunctionDef) -> str:
    """Return the first paragraph of a docstring, in one line."""
    return " ".join((ast.get_docstring(node) or node.name.replace("_", " ")).partition("\n\n")[0].split())


def mark(is_marked: bool) -> str:
    """Return how a long test is marked."""
    return " *(long)*" if is_marked else ""


def is_long(node: ast.Module | ast.FunctionDef) -> bool:
    """Return whether all of a module or test is run by `make verify` only."""
    marks = [node.value for node in node.body if isinstance(node, ast.Assign) and names_marks(node)]
    return any("mark.verify" in ast.unparse(each) for each in (*marks, *simple_decorators(node)))


def names_marks(node: ast.Assign) -> bool:
    """Return whether an assignment is that of a module's marks."""
    return any(isinstance(target, ast.Name) and target.id == "pytestmark" for target in node.targets)


def simple_decorators(node: ast.Module | ast.FunctionDef) -> list[ast.expr]:
    """Return the decorators of a test without those that mark some of its parameters."""
    return [each for each in getattr(node, "decorator_list", []) if not isinstance(each, ast.Call)]


if __name__ == "__main__":
    FILE.write_text(page(), encoding="utf-8")
