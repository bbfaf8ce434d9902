"""The rules of the house: who may import whom, how long things may get, what may be tracked."""

import ast
import itertools
import re
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path

import pytest

from tests import REPOSITORY

# Limits of the house style: what a reader can still take in at once.
LONGEST_SNAKEFILE = 60
LONGEST_SCRIPT = 30
LONGEST_MODULE = 399
LONGEST_FUNCTION = 60
LARGEST_FILE_BYTES = 1_000_000

# What a folder may import of this project's own packages; the longest one that a module lies in counts. Closed forms
# (reference) stand beside the chain. Cases are named by their folder: CASE stands for the case's own one.
CASE = "workflows.cases.<own>"
LAYERS = {
    "postproc.mesh": (),
    "postproc.triangle": (),
    "postproc.mesh_cuts": ("postproc.triangle",),
    "postproc.mesh_checks": ("postproc.mesh", "postproc.mesh_cuts"),
    "postproc.readers": ("postproc.mesh", "postproc.readers"),
    "postproc.wear": ("postproc.mesh", "postproc.mesh_checks", "postproc.triangle", "postproc.wear"),
    "postproc.reference": ("postproc.reference",),
    "postproc.statistics": ("postproc.statistics",),
    "postproc.inference": ("postproc.inference",),
    "postproc": ("postproc",),
    "meshes": ("postproc.mesh", "postproc.mesh_checks", "meshes"),
    "workflows.environment": ("workflows.environment",),
    "workflows.engine": ("postproc", "meshes", "workflows.engine"),
    "workflows.config": ("postproc", "meshes", "workflows.engine", "workflows.config"),
    "workflows.forecast": ("postproc", "meshes", "workflows.engine", "workflows.config", "workflows.forecast"),
    "workflows.report": ("postproc", "meshes", "workflows.engine", "workflows.config", "workflows.report"),
    "workflows.results": (
        *("postproc", "meshes", "workflows.engine", "workflows.config"),
        *("workflows.forecast", "workflows.report", "workflows.results"),
    ),
    "workflows.cases": (
        *("postproc", "meshes", "workflows.engine", "workflows.config"),
        *("workflows.forecast", "workflows.report", CASE),
    ),
}
PACKAGE = "bulkwear"  # that the library and the workflow are imported from
OURS = ("postproc", "meshes", "workflows", "benchmarks", "tests")
INSTALLED = ("postproc", "meshes", "workflows")
LIBRARY = ("postproc", "meshes")
WORKFLOW_MODULES = {"snakemake", "jinja2", "workflows"}
DRAWING_MODULES = {"matplotlib", "PIL", "pyvista", "vtk", "vtkmodules"}
WEAR_MAY_IMPORT = {"numpy", "scipy", "numba", "igl", "postproc"}
FILE_MODULES = {"pathlib", "os", "io", "csv", "json", "pandas", "polars", "pyarrow", "meshio"}
WORDS_OF_AN_INDEX = re.compile(r"https?://|--(extra-)?index|--find-links|--trusted-host|\.whl\b|@ *git")


def tracked(*patterns: str) -> list[Path]:
    """Files of the repository that match a git pattern: tracked ones and new ones that are not ignored."""
    command = ["git", "-c", f"safe.directory={REPOSITORY}", "ls-files", "--cached", "--others"]
    listing = subprocess.run(
        [*command, "--exclude-standard", "-z", "--", *patterns],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
        check=True,
    )
    paths = [REPOSITORY / name for name in listing.stdout.split("\0") if name]
    return sorted(path for path in paths if path.is_file())


def text_of(name: str) -> str:
    """Text of a file of the repository."""
    return (REPOSITORY / name).read_text(encoding="utf-8")


def name_of(path: Path) -> str:
    """Path in the repository, for messages."""
    return path.relative_to(REPOSITORY).as_posix()


def imported(source: str) -> set[str]:
    """Dotted names a module imports anywhere, without `bulkwear.`; `from a import b` counts as a and as a.b."""
    return {name.removeprefix(f"{PACKAGE}.") for name in spelled_imports(source)} - {PACKAGE}


@cache  # most of the rules ask for those of all modules
def spelled_imports(source: str) -> frozenset[str]:
    """Dotted names a module imports anywhere, as they are spelled."""
    names = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = "." * node.level + (node.module or "")
            names |= {base} | {f"{base}.{alias.name}" for alias in node.names}
    return frozenset(names)


def roots(names: set[str]) -> set[str]:
    """Top-level packages of dotted names."""
    return {name.partition(".")[0] for name in names}


def bare_imports(source: str) -> list[str]:
    """Lines of Python or of a workflow that import a package of ours without the package that holds it."""
    return re.findall(rf"^\s*(?:from|import) (?:{'|'.join(INSTALLED)})\b.*", source, re.MULTILINE)


def inside(name: str, packages) -> bool:
    """True if a dotted name is one of the packages or lies below one."""
    return any(name == package or name.startswith(package + ".") for package in packages)


def layer_breaches(module: str, source: str) -> list[str]:
    """Imports of this project that the layer of `module` must not have."""
    layer = max((name for name in LAYERS if inside(module, (name,))), key=len, default=None)
    if layer is None:
        return []
    own = ".".join(module.split(".")[:3])
    allowed = tuple(own if name == CASE else name for name in LAYERS[layer])
    # `from postproc import wear` names the bare package too, which says nothing by itself
    names = {name for name in imported(source) if inside(name, OURS) and name not in (*OURS, "workflows.cases")}
    return sorted(name for name in names if not inside(name, allowed))


def circles(graph: dict[str, set[str]]) -> list[str]:
    """Modules that reach themselves over the imports of others."""

    def reached(start: str) -> set[str]:
        found: set[str] = set()
        waiting = list(graph[start])
        while waiting:
            name = waiting.pop()
            if name not in found:
                found.add(name)
                waiting.extend(graph.get(name, ()))
        return found

    return sorted(name for name in graph if name in reached(name))


def import_graph(sources: dict[str, str]) -> dict[str, set[str]]:
    """For each module of {module: source} those of the others that it imports."""
    return {
        module: {name for name in imported(source) if name in sources and name != module}
        for module, source in sources.items()
    }


def function_lengths(source: str) -> dict[str, int]:
    """Lines of every function, from `def` to its end."""
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef)
    found = [node for node in ast.walk(ast.parse(source)) if isinstance(node, kinds)]
    return {f"{node.name} (line {node.lineno})": node.end_lineno - node.lineno + 1 for node in found}


def uses_name(source: str, name: str) -> bool:
    """True if the source imports a module or uses a variable of that name."""
    if name not in source:
        return False
    used = {node.id for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Name)}
    return name in used | roots(imported(source))


def has_run_block(text: str) -> bool:
    """True if a Snakemake file has a `run:` block."""
    return re.search(r"^\s*run:\s*(#.*)?$", text, flags=re.MULTILINE) is not None


def python_files() -> list[Path]:
    """Python sources outside the tests."""
    return [path for path in tracked("*.py") if not name_of(path).startswith("tests/")]


def library_files(*packages: str) -> list[Path]:
    """Python sources of postproc and meshes, or of one package below them."""
    found = [path for path in python_files() if inside(module_of(path), packages or LIBRARY)]
    assert found, f"no Python source in {packages or LIBRARY}: this test checks nothing"
    return found


def module_of(path: Path) -> str:
    """Dotted module name of a Python source."""
    return name_of(path).removesuffix(".py").removesuffix("/__init__").replace("/", ".")


def workflow_files() -> list[Path]:
    """The Snakefile and what it includes."""
    found = tracked("Snakefile", "*.smk")
    assert found, "no Snakefile: this test checks nothing"
    return found


# --- (a) import directions


def test_library_knows_nothing_of_the_workflow():
    """postproc and meshes never import snakemake, jinja2 or workflows."""
    guilty = {name_of(path): roots(imported(path.read_text())) & WORKFLOW_MODULES for path in library_files()}
    assert {name: found for name, found in guilty.items() if found} == {}


def test_imports_go_one_way():
    """postproc <- meshes <- engine <- config <- forecast, report <- cases and results; no case imports another one."""
    files = {name_of(path): path for path in python_files()}
    guilty = {name: layer_breaches(module_of(path), path.read_text()) for name, path in files.items()}
    assert {name: found for name, found in guilty.items() if found} == {}
    relative = [name for name, path in files.items() if "" in roots(imported(path.read_text()))]
    assert relative == []


def test_no_circle():
    """No module reaches itself over its imports, those inside functions included."""
    assert circles(import_graph({module_of(path): path.read_text() for path in python_files()})) == []


def test_drawing_stays_in_plots():
    """matplotlib, Pillow, pyvista and vtk are imported in folders called plots only."""
    outside = [path for path in python_files() if "plots" not in path.parent.parts]
    guilty = {name_of(path): roots(imported(path.read_text())) & DRAWING_MODULES for path in outside}
    assert {name: found for name, found in guilty.items() if found} == {}


def test_packages_are_imported_by_their_full_name():
    """`postproc`, `meshes` and `workflows` are imported as parts of `bulkwear`: a module is there once in a process."""
    sources = {name_of(path): path.read_text() for path in (*tracked("*.py"), *workflow_files())}
    guilty = {name: bare_imports(source) for name, source in sources.items()}
    assert {name: found for name, found in guilty.items() if found} == {}


def test_wear_takes_arrays():
    """postproc.wear imports arithmetic only: numpy, scipy, meshes; no file is opened there."""
    for path in library_files("postproc.wear"):
        source = path.read_text()
        packages = roots(imported(source))
        assert packages - WEAR_MAY_IMPORT - set(sys.stdlib_module_names) == set(), name_of(path)
        assert packages & FILE_MODULES == set(), name_of(path)
        assert not uses_name(source, "open"), name_of(path)


def test_snakemake_object_stays_in_scripts():
    """The name `snakemake` appears in Python under workflows/scripts only."""
    others = [path for path in python_files() if not name_of(path).startswith("workflows/scripts/")]
    assert [name_of(path) for path in others if uses_name(path.read_text(), "snakemake")] == []


def test_third_party_imports_are_direct_requirements():
    """What is imported is named in pyproject.toml, not there by some other package's grace."""
    project = tomllib.loads(text_of("pyproject.toml"))["project"]
    lines = itertools.chain(project["dependencies"], *project["optional-dependencies"].values())
    required = {re.sub(r"\[.*", "", line).replace("-", "_") for line in lines} | {"yaml", "PIL", "igl", "xdist"}
    ours = {path.name for path in REPOSITORY.iterdir()}
    siblings = {path.stem for path in tracked("*.py")}
    sources = {
        name: path.read_text()
        for path in tracked("*.py")
        if not (name := name_of(path)).startswith("benchmarks/peer_programs/")  # that other codes' interpreters run
    }
    known = required | ours | siblings | set(sys.stdlib_module_names) | {""}
    guilty = {name: roots(imported(source)) - known for name, source in sources.items()}
    assert {name: found for name, found in guilty.items() if found} == {}


# --- (b) the workflow


def test_no_run_blocks():
    """A `run:` block costs seconds per job and cannot be tested; rules call scripts."""
    assert [name_of(path) for path in workflow_files() if has_run_block(path.read_text())] == []


def test_snakefile_is_a_contents_page():
    """The Snakefile fits on one page."""
    assert len(text_of("Snakefile").splitlines()) <= LONGEST_SNAKEFILE


def test_scripts_only_unpack_and_call():
    """Scripts stay too short to hold logic."""
    scripts = tracked("workflows/scripts/*.py")
    assert scripts, "no scripts: this test checks nothing"
    lengths = {name_of(path): len(path.read_text().splitlines()) for path in scripts}
    assert {name: lines for name, lines in lengths.items() if lines > LONGEST_SCRIPT} == {}


# --- (c) what is tracked


@pytest.mark.parametrize("name", ["pyproject.toml", "requirements.txt", "requirements-bootstrap.txt"])
def test_requirements_name_no_address(name):
    """Requirements work with any package index: they name none."""
    assert WORDS_OF_AN_INDEX.search(text_of(name)) is None


def test_every_requirement_is_pinned_and_hashed():
    """Each entry of the lock has one exact version and at least one hash."""
    for name in ("requirements.txt", "requirements-bootstrap.txt"):
        entries = re.split(r"\n(?=\S)", text_of(name).strip())
        loose = [entry.split("\n")[0] for entry in entries if "==" not in entry or "sha256:" not in entry]
        assert loose == [], name


def test_bootstrap_is_the_entry_of_the_lock():
    """uv is installed first from the very entry the lock has."""
    assert text_of("requirements-bootstrap.txt") in text_of("requirements.txt")


def test_no_large_file():
    """Results and meshes are made, not tracked."""
    sizes = {name_of(path): path.stat().st_size for path in tracked()}
    assert {name: size for name, size in sizes.items() if size > LARGEST_FILE_BYTES} == {}


# --- (d) size and documentation


def test_every_template_has_a_row():
    """templates/README.md has a table row for each template, and names each shared partial."""
    page = text_of("templates/README.md")
    rows = [line for line in page.splitlines() if line.startswith("|")]
    templates = tracked(":(glob)templates/[!_]*/*.j2")
    partials = tracked("templates/_shared/*.j2")
    assert templates, "no templates: this test checks nothing"
    assert [path.name for path in templates if not any(path.name in row for row in rows)] == []
    assert [path.name for path in partials if f"`{path.name.partition('.')[0]}`" not in page] == []


def test_modules_stay_short():
    """No module outside the tests reaches 400 lines."""
    lengths = {name_of(path): len(path.read_text().splitlines()) for path in python_files()}
    assert {name: lines for name, lines in lengths.items() if lines > LONGEST_MODULE} == {}


def test_functions_stay_short():
    """No function outside the tests is longer than 60 lines."""
    lengths = {name_of(path): function_lengths(path.read_text()) for path in python_files()}
    named = [(name, *each) for name, found in lengths.items() for each in found.items()]
    assert [each for each in named if each[-1] > LONGEST_FUNCTION] == []


# --- the rules themselves: each finds what it is for


@pytest.mark.parametrize(
    ("module", "source"),
    [
        ("postproc.wear.laws", "from bulkwear.postproc.readers.contacts import Contacts"),
        ("postproc.wear.laws", "def f():\n    from bulkwear.postproc import plots"),
        ("postproc.mesh", "import bulkwear.postproc.wear.laws"),
        ("postproc.statistics.lines", "from bulkwear.postproc.plots import maps"),
        ("postproc.tables.history", "from bulkwear.meshes.plate import plate"),
        ("meshes.plate", "from bulkwear.postproc.wear import displacement"),
        ("workflows.engine.cycles", "from bulkwear.workflows.config.design import Study"),
        ("workflows.engine.chain", "def f():\n    from bulkwear.workflows.cases.pin_on_disc import case"),
        ("workflows.config.design", "from bulkwear.workflows.cases.pin_on_disc.case import PinOnDisc"),
        (
            "workflows.cases.pin_on_disc.case",
            "from bulkwear.workflows.cases.circular_tester.case import CircularTester",
        ),
    ],
)
def test_a_wrong_direction_is_found(module, source):
    """Imports up the chain are found, also inside functions and as `from package import module`."""
    assert layer_breaches(module, source) != []


@pytest.mark.parametrize(
    ("module", "source"),
    [
        ("postproc.wear.laws", "from bulkwear.postproc.mesh import areas\nimport numpy"),
        ("postproc.plots.maps", "from bulkwear.postproc.tables import history"),
        ("workflows.cases.pin_on_disc.case", "from bulkwear.workflows.cases.pin_on_disc.checks import PIN_CHECKS"),
        ("workflows.cases.pin_on_disc.figures", "from bulkwear.workflows.report.products import figure"),
        ("meshes.plate", "from bulkwear.postproc import mesh"),
    ],
)
def test_a_right_direction_is_allowed(module, source):
    """Imports down the chain are no breach."""
    assert layer_breaches(module, source) == []


def test_a_bare_import_is_found():
    """Inside functions too; another package of a like name and the full name are none."""
    assert bare_imports("def f():\n    from postproc.mesh import areas\nimport meshes") != []
    assert bare_imports("from bulkwear.postproc import mesh\nimport meshes_of_others") == []


def test_a_circle_is_found():
    """Modules that import each other over a third one are found, those that lead to them are not."""
    graph = import_graph({"a": "import b", "b": "def f():\n    from c import x", "c": "import a", "d": "import a"})
    assert circles(graph) == ["a", "b", "c"]


def test_snakemake_is_found_as_object_and_as_module():
    """Both the injected object and an import count; a word in a string does not."""
    assert uses_name("print(snakemake.input)", "snakemake")
    assert uses_name("from snakemake.utils import validate", "snakemake")
    assert not uses_name("command = 'snakemake demo'", "snakemake")


def test_lengths_and_blocks_are_found():
    """Functions are measured from def to end; run: is found at any depth and not inside a word."""
    assert function_lengths("def f():\n    a = 1\n    return a\n") == {"f (line 1)": 3}
    assert has_run_block("rule a:\n    output: 'b'\n    run:\n        pass\n")
    assert not has_run_block("rule dry_run:\n    output: 'b'\n")


@pytest.mark.parametrize("text", ["--index-url x", "--find-links /a", "a @ https://b/c", "--extra-index-url y"])
def test_an_address_is_found(text):
    """Every way to name a package source is found."""
    assert WORDS_OF_AN_INDEX.search(text)
