"""What code simulated: hashes that tell versions apart where numbers may differ, and nowhere else."""

import shutil
from pathlib import Path

import pytest

from bulkwear.workflows.engine import provenance
from bulkwear.workflows.engine.cases import case_names
from bulkwear.workflows.engine.code_parts import (
    PARTS,
    code_of_shown,
    essence,
    essence_of_solver,
    part_files,
    part_hashes,
)
from bulkwear.workflows.engine.project import PACKAGE
from tests import REPOSITORY

CASE = "sliding_sample"
OF_RUN = {*PARTS, "templates", "case"}


@pytest.fixture(scope="module")
def copied(tmp_path_factory) -> Path:
    """A copy of the package's code, which each test leaves as it found it."""
    folder = tmp_path_factory.mktemp("package")
    for name in ("postproc", "meshes", "solver", "templates", "workflows"):
        shutil.copytree(PACKAGE / name, folder / name, ignore=shutil.ignore_patterns("__pycache__", "build"))
    return folder


@pytest.mark.parametrize(
    ("file", "part"),
    [
        ("postproc/wear/laws.py", "wear"),
        ("postproc/mesh.py", "wear"),
        ("postproc/flow/bed.py", "flow"),
        ("workflows/engine/wear_step.py", "engine"),
        ("meshes/sample.py", "meshes"),
        ("meshes/own/solids.py", None),
        ("solver/fix_load_ledger.cpp", "solver"),
        ("solver/rolling/rolling_models.cpp", "solver"),
        ("solver/search/gap.h", "solver"),
        ("templates/_shared/particles.in.j2", "templates"),
        (f"templates/{CASE}/sliding_sample.in.j2", "templates"),
        (f"workflows/cases/{CASE}/decks.py", "case"),
        (f"workflows/cases/{CASE}/flow_history.py", "case"),
        (f"workflows/cases/{CASE}/page.py", None),
        (f"workflows/cases/{CASE}/figures.py", None),
        (f"workflows/cases/{CASE}/plots/bars.py", None),
        ("workflows/cases/circular_tester/decks.py", None),
        ("templates/circular_tester/circular_tester.in.j2", None),
        ("workflows/engine/provenance.py", None),
        ("workflows/report/page.py", None),
        ("workflows/forecast/forecast.py", None),
        ("postproc/plots/style.py", None),
        ("postproc/statistics/steady.py", None),
    ],
)
def test_a_change_of_code_is_one_of_its_part_alone(copied, file, part):
    """A line added changes the hash of the part that the file is of; of what no run goes through, none."""
    before, path = part_hashes([CASE], copied), copied / file
    text = path.read_text()
    path.write_text(f"{text}\nADDED = 1\n")
    after = part_hashes([CASE], copied)
    path.write_text(text)
    assert part_hashes([CASE], copied) == before
    assert {name for name in OF_RUN if before[name] != after[name]} == ({part} if part else set())


@pytest.mark.parametrize(
    ("file", "added", "counts"),
    [
        (f"workflows/cases/{CASE}/figures.py", "ADDED = 1", True),
        (f"workflows/cases/{CASE}/figures.py", "# said", False),
        ("postproc/plots/style.py", "ADDED = 1", True),  # imported within the functions
        ("postproc/plots/compare.html", "<p>", True),
        ("postproc/statistics/intervals.py", "ADDED = 1", True),
        ("workflows/report/products.py", "ADDED = 1", True),
        ("workflows/engine/project.py", "ADDED = 1", True),
        ("workflows/engine/wear_step.py", "ADDED = 1", False),  # what the engine imports, figures do not ask
        ("workflows/cases/calibration/figures.py", "ADDED = 1", False),
    ],
)
def test_a_change_of_code_that_figures_reach_changes_their_hash(copied, file, added, counts):
    """A line added to what they import, at any distance; a comment, another case and what plans and runs does not."""
    figures, path = copied / f"workflows/cases/{CASE}/figures.py", copied / file
    before, text = code_of_shown([figures], copied), path.read_text()
    path.write_text(f"{text}\n{added}\n")
    after = code_of_shown([figures], copied)
    path.write_text(text)
    assert code_of_shown([figures], copied) == before
    assert (after != before) == counts


def test_words_about_code_are_no_code():
    """Comments, docstrings, blank lines and spaces at line ends change nothing; a number or a used text does."""
    bare = 'def f(x):\n    return {"#": x + 1}\n'
    told = '"""About."""\n\n\ndef f(x):  # says\n    """Return\n    one more."""\n    # why\n    return {"#": x + 1} \n'
    assert essence(told) == essence(bare)
    assert essence(bare.replace("1", "2")) != essence(bare) != essence(bare.replace("#", "%"))


def test_words_about_the_solver_are_no_code():
    """Lines of comments and blank ones change nothing; a number does."""
    bare = "double twice(double x) { return 2.0 * x; }"
    assert essence_of_solver(f"// says\n\n{bare} \n  // why\n") == essence_of_solver(bare)
    assert essence_of_solver(bare.replace("2.0", "3.0")) != essence_of_solver(bare)


def test_drawings_read_are_of_the_cases_that_read_them(copied):
    """A change of what reads CAD files is one of equipment, and of no sample."""
    path = copied / "meshes/own/stl.py"
    text, before = path.read_text(), {case: part_hashes([case], copied) for case in (CASE, "equipment")}
    path.write_text(f"{text}\nADDED = 1\n")
    after = {case: part_hashes([case], copied) for case in before}
    path.write_text(text)
    assert after[CASE] == before[CASE]
    assert {name for name in OF_RUN if after["equipment"][name] != before["equipment"][name]} == {"meshes"}


@pytest.mark.parametrize(
    "text",
    [
        '"""a\n# b\n"""',
        "'''a\n\"# b'''",
        "'\\'# b'",
        "'''a\\''' # b'''",
        "f'{1}# b'",
        "r'# b\\\\'",
    ],
)
def test_a_number_sign_within_a_text_begins_no_comment(text):
    """In texts of one line and of several, with either quote, and with escaped ones."""
    assert essence(f"x = {text}  # said") == essence(f"x = {text}")
    assert "# b" in essence(f"x = {text}")


def test_every_part_of_every_case_has_files():
    """No pattern has lost its files, and no file is in two parts."""
    for name in case_names():
        found = part_files([name])
        assert set(found) == OF_RUN and all(found.values())
        files = [file for part in found.values() for file in part]
        assert len(files) == len(set(files))


def test_the_engine_a_driver_imports_is_all_counted():
    """What a driver of runs has imported of the package is in a part, or stands aside by name."""
    import sys

    from bulkwear.workflows.engine import code_parts

    counted = {file for part in part_files(case_names()).values() for file in part} | code_parts.ASIDE
    drawn = [path.parent for path in (REPOSITORY / "meshes").glob("*/draw.py")]  # programs that draw what studies read
    folders = ("postproc/wear/", "postproc/readers/", "workflows/engine/", "meshes/")
    files = (getattr(module, "__file__", None) for name, module in sys.modules.items() if name.startswith("bulkwear."))
    loaded = {
        Path(file).relative_to(REPOSITORY).as_posix()
        for file in files
        if file and REPOSITORY in Path(file).parents and Path(file).parent not in drawn
    }
    assert "workflows/engine/case.py" in loaded
    assert {file for file in loaded if file.startswith(folders)} <= counted


def test_without_git_version_and_hashes_tell(monkeypatch):
    """An installed package has no commit; what a run says then still names its version and its code."""
    monkeypatch.setattr(provenance, "git", lambda *asked: None)
    found = provenance.code_of_cases.__wrapped__((CASE,))
    assert (found["commit"], found["changed"]) == (None, None)
    assert found["version"] and found["parts"] == part_hashes([CASE])


def test_a_speed_is_told_where_time_was_taken():
    """Processor seconds over particles times steps; none where the simulation shared its processor time."""
    cost = {"processor_s": 12.0, "particles": 1000, "steps": 2000}
    assert provenance.provenance({}, "no_such_program", cost)["solver_s_per_particle_step"] == 6e-6
    del cost["processor_s"]
    found = provenance.provenance({}, "no_such_program", cost)
    assert found["solver_s_per_particle_step"] is None and found["programs"] == {}
