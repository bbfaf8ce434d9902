"""Commands and settings that pages name are there: targets of make, modules, studies, keys of the configuration."""

import re
import shlex

import pytest
import yaml

from bulkwear.workflows.config.design import list_studies
from bulkwear.workflows.config.readme import readme
from tests import REPOSITORY
from tests.support.doc_pages import code_blocks, inline_code, own_pages, pages, read
from tests.test_house import name_of, text_of

TARGETS = set(re.findall(r"^([a-z]+):", text_of("Makefile"), re.MULTILINE))
KEYS = set(re.findall(r"^\| `([\w.<>]+)` \|", readme(), re.MULTILINE))
ENDS = ("", "_decks", "_forecast", "_confirmation")
OF_PROJECTS = {"first", "transfer", "bw_first"}  # studies that projects of the pages have
ROOTS = {"bulkwear": "", "benchmarks": "benchmarks/", "tests": "tests/"}
NO_KEYS = (".csv", ".vtu", ".py", ".md", ".json", ".yaml", ".parquet", ".html", ".stl", ".txt", ".dump", ".in")


def commands(path):
    """Lines of shell that a page shows, in blocks and within sentences."""
    lines = "\n".join(code_blocks(read(path), "sh", "")).replace("\\\n", " ").splitlines()
    return [line.partition(" #")[0].strip() for line in (*lines, *inline_code(read(path)))]


def module_file(name):
    """Whether a module that is run with -m is there, as a file or a package with a __main__."""
    root, _, rest = name.partition(".")
    place = ROOTS[root] + rest.replace(".", "/") if rest else root
    return (REPOSITORY / f"{place}.py").is_file() or (REPOSITORY / place / "__main__.py").is_file()


def fits(key, known):
    """Whether a path of keys is a known one or a block of known ones; <name> stands for any word."""
    parts, wanted = key.split("."), known.split(".")
    alike = (a == b or b.startswith("<") for a, b in zip(parts, wanted, strict=False))
    return len(parts) <= len(wanted) and all(alike)


def settings_of(line):
    """Paths of the keys that a command line sets by --config."""
    given = line.partition("--config ")[2].partition(" --")[0]
    for word in shlex.split(given) if line.startswith("snakemake") else ():
        key, _, value = word.partition("=")
        yield from paths({key: yaml.safe_load(value)})


def paths(block, before=""):
    """All paths of keys of a block of YAML."""
    for key, value in block.items():
        path = f"{before}{key}"
        yield path
        if isinstance(value, dict):
            yield from paths(value, f"{path}.")


@pytest.mark.parametrize("path", pages(), ids=name_of)
def test_targets_of_make_are_there(path):
    """`make x`, but for those of the solver's own Makefile."""
    named = [re.match(r"make ([a-z]+)\b", line) for line in commands(path)]
    assert {found[1] for found in named if found} - TARGETS == set()


@pytest.mark.parametrize("path", pages(), ids=name_of)
def test_modules_are_there(path):
    """`python -m a.b` of the package, of benchmarks and of tests."""
    named = {
        name for line in commands(path) for name in re.findall(r"python -m ((?:bulkwear|benchmarks|tests)[\w.]*)", line)
    }
    assert {name for name in named if not module_file(name)} == set()


@pytest.mark.parametrize("path", pages(), ids=name_of)
def test_studies_are_there(path):
    """`snakemake x`: a study, its decks, forecast or confirmation."""
    known = {f"{study}{end}" for study in {*list_studies(), *OF_PROJECTS} for end in ENDS}
    named = [re.match(r"snakemake ([a-z]\w*)\b(?![/.])", line) for line in commands(path)]
    assert {found[1] for found in named if found} - known == set()


@pytest.mark.parametrize("path", own_pages(), ids=name_of)
def test_keys_are_in_a_schema(path):
    """`a.b` whose first word is a section of the configuration; keys of blocks of YAML that begin with one."""
    sections = {key.partition(".")[0] for key in KEYS if "." in key}
    named = {found[0] for code in inline_code(read(path)) if (found := re.match(r"[a-z_]+(\.[a-z_<>]+)+(?=$|:)", code))}
    named = {key for key in named if key.partition(".")[0] in sections and not key.endswith(NO_KEYS)}
    for text in code_blocks(read(path), "yaml"):
        block = yaml.safe_load(text)
        named |= {key for key in paths(block) if key.partition(".")[0] in sections}
    free = re.compile(r"deck\.|wear\.beside\.|.*\.parameters\.")  # whose words are the user's own, or a law's
    unknown = {key for key in named if not free.match(key) and not any(fits(key, known) for known in KEYS)}
    assert unknown == set()


@pytest.mark.parametrize("path", own_pages(), ids=name_of)
def test_settings_of_command_lines_are_in_a_schema(path):
    """`snakemake x --config key=value`, blocks included."""
    given = [setting for line in commands(path) for setting in settings_of(line)]
    assert {key for key in given if not any(fits(key, known) for known in KEYS)} == set()


def test_settings_of_a_command_line_are_read():
    """Single ones, lists and blocks, quoted anyhow; what follows another option is none."""
    line = "snakemake a --config fidelity=paper 'rows=[R5,R9]' bed='{ends: window}' --dry-run b=c"
    assert list(settings_of(line)) == ["fidelity", "rows", "bed", "bed.ends"]


def test_what_is_not_there_is_found():
    """A module, a key and a block of keys."""
    assert module_file("bulkwear.workflows.config.readme") and not module_file("bulkwear.workflows.config.nothing")
    assert module_file("bulkwear") and module_file("benchmarks") and module_file("tests.support.verification_page")
    assert fits("solver.ranks", "solver.ranks") and fits("parts.shell.role", "parts.<name>.role")
    assert fits("until", "until.width_fraction") and not fits("solver.rank", "solver.ranks")
