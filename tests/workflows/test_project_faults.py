"""What is wrong with a project is one sentence, and nothing is made."""

import re
import shutil

import pytest

from bulkwear.workflows.engine.project import PACKAGE
from tests.support.asked_project import outside_of, said_of, told_of
from tests.support.own_project import SECOND, STUDY, TEMPLATE, WORD, own_project

LAW, CASE, MINE = "laws/hardened.py", "cases/dimpled/case.py", "config/studies/mine.yaml"


@pytest.mark.parametrize(
    ("file", "old", "new", "sentence"),
    [
        (MINE, f"deck: {{remark: {WORD}}}\n", "", f"{TEMPLATE}: parameter remark is not given, allowed are its deck's"),
        (LAW, ', unit="-"', "", f"{LAW}: parameter hardening of the law hardened has no unit, allowed is the one that"),
        (LAW, '"-"', '"N"', f"{LAW}: law hardened: the unit of its parameter hardening is 'N', allowed is '-', by"),
        (LAW, "LAW = ", "RULE = ", f"{LAW}: there is no LAW in it, allowed is a module with LAW = Law(...)."),
        (
            LAW,
            "return archard",
            "return -archard",
            f"{LAW}: of two triangles, the first without load, the law",
        ),
        (LAW, "parameters) / ", "parameters) ** 2 / ", f"{LAW}: by twice the load the law hardened makes "),
        (LAW, "return archard(columns, parameters)", 'return columns["sliding_work_J"]', f"{LAW}: by twice the coeffi"),
        (
            LAW,
            '"measured by ourselves",',
            '"us", kernels=("oka_energy",),',
            f"{LAW}: a contact kernel of the law",
        ),
        (
            LAW,
            "{hardening}",
            "{hardness}",
            f"{LAW}: words of the law hardened have {{hardness}}, allowed",
        ),
        (
            CASE,
            "import numpy as np\n",
            "import numpie as np\n",
            f"{CASE}, line 5: ModuleNotFoundError: No module",
        ),
        (CASE, "class DimpledSample(", "class DimpledSample((", f"{CASE}, line 11: SyntaxError: "),
        (CASE, "register(DimpledSample())\n", "", f"{CASE}: it registers no case dimpled, allowed is register(...) of"),
    ],
)
def test_a_bad_project_is_one_sentence(tmp_path, file, old, new, sentence):
    """It names the file; nothing is made."""
    folder = own_project(tmp_path / "my project")
    text = (folder / file).read_text()
    assert text.count(old) == 1
    (folder / file).write_text(text.replace(old, new))
    assert sentence in told_of(folder)


@pytest.mark.parametrize(
    ("file", "text", "sentence"),
    [
        (TEMPLATE, "{% if %}\n", f"{TEMPLATE}, line 1: "),
        (TEMPLATE, "\n{{ remark | uper }}\n", f"{TEMPLATE}, line 2: No filter named 'uper'."),
        (TEMPLATE, "{{ remark / 3 }}\n", f"{TEMPLATE}, line 1: TypeError: "),
        (TEMPLATE, "\ufeffunits si\n", f"{TEMPLATE}: found a byte order mark, which the solver takes for a word"),
        ("templates/_shared/walls.in.j2", "\n", "templates/_shared/walls.in.j2: the file is empty, allowed is a"),
        ("templates/_shared/domain.in.j2", "{{ colour }}\n", "templates/_shared/domain.in.j2: parameter colour is not"),
        (
            LAW,
            "from bulkwear.postproc.wear.laws import Law\n\nLAW = Law(len, 'so.', 'nobody', parameters=3)\n",
            f"{LAW}: ",
        ),
        (
            LAW,
            "from bulkwear.postproc.wear.laws import Law\n\n"
            "LAW = Law(lambda columns, given: columns['work'], 'so.', 'nobody')\n",
            f"{LAW}: the law hardened ends in KeyError: 'work'; allowed are columns of the ledger and the law's",
        ),
        (LAW, "import sys\n\nsys.exit(0)\n", "laws/hardened.py, line 3: SystemExit: 0; allowed is Python"),
        ("laws/_part.py", "1 / 0\n", "laws/_part.py, line 1: ZeroDivisionError: division by zero; allowed is Python"),
        (
            "cases/dimpled/settings.schema.yaml",
            "type: object\n",
            "cases/dimpled/settings.schema.yaml: there are no prop",
        ),
        (
            "cases/dimpled/settings.schema.yaml",
            "properties: {dimples: {type: numbr}}\n",
            "cases/dimpled/settings.schema.yaml: properties.dimples.type is 'numbr', allowed is a JSON schema.",
        ),
        (
            "config/cases/dimpled.yaml",
            "{}\n",
            "config/cases/dimpled.yaml: dimples is missing, allowed is a block of keys.",
        ),
        ("config/cases/dimpeld.yaml", "{}\n", "config/cases/dimpeld.yaml: case is 'dimpeld', allowed is one of"),
    ],
)
def test_a_bad_file_of_a_project_is_one_sentence(tmp_path, file, text, sentence):
    """Whatever stands in it."""
    folder = own_project(tmp_path / "my project")
    (folder / file).parent.mkdir(exist_ok=True)
    (folder / file).write_text(text)
    if file == "laws/_part.py":
        law = folder / LAW
        law.write_text(law.read_text() + "from ._part import nothing\n")
    if file == LAW:
        study = folder / MINE
        study.write_text(study.read_text().replace(", parameters: {hardening: 3}", ""))
    assert sentence in told_of(folder)


def test_a_study_of_the_package_s_name_is_refused(tmp_path):
    """It would be unclear whose it is."""
    folder = own_project(tmp_path / "my project")
    shutil.copy(folder / MINE, folder / "config/studies/demo.yaml")
    assert "config/studies/demo.yaml: a study demo is in the package too" in told_of(folder, "demo")


def test_a_wrong_key_is_one_sentence_before_any_job(tmp_path):
    """The message names file, line and key; no job starts and the exit code is not zero."""
    folder = own_project(tmp_path / "my project")
    study = folder / MINE
    study.write_text(study.read_text().replace("width_mm: 40", "width_cm: 4"))
    output = said_of(tmp_path, *outside_of(folder), STUDY, code=1)
    assert f"{MINE}, line 12, fidelity quick: unit cm is not allowed for sample.width" in output
    assert "Traceback" not in output and not (folder / "results").exists()


@pytest.mark.verify
def test_a_fault_in_one_study_leaves_the_others_running(tmp_path):
    """A study that is not asked for is not read; where all are listed one with a fault is left out with its words."""
    folder = own_project(tmp_path / "my project")
    broken = (folder / MINE).read_text().replace("width_mm: 40", "width_cm: 4")
    (folder / "config/studies/broken.yaml").write_text(broken)
    assert "broken" not in said_of(tmp_path, *outside_of(folder), STUDY, "--dry-run")
    output = said_of(tmp_path, *outside_of(folder), "--list-target-rules")
    assert "Study broken is left out: config/studies/broken.yaml, line 12" in output
    assert {STUDY, f"{STUDY}_decks", f"{STUDY}_forecast"} <= set(output.split()) and "broken_decks" not in output


def test_an_unknown_target_is_one_sentence(tmp_path):
    """The message lists the studies and the endings of their targets."""
    folder = own_project(tmp_path / "my project")
    output = said_of(tmp_path, *outside_of(folder), "mien_decks", "--dry-run", code=1)
    assert "Traceback" not in output
    found = re.search(r"target is 'mien_decks', allowed is one of (.*), alone or with the ending (.*)\.", output)
    assert {STUDY, SECOND} <= set(found[1].split(", "))
    assert found[2] == "_decks, _forecast or _confirmation"


def test_a_bad_project_ends_snakemake(tmp_path):
    """With that sentence, before any job."""
    output = said_of(tmp_path, "--snakefile", str(PACKAGE / "Snakefile"), "--dry-run", STUDY, code=1)
    assert f"{tmp_path}: there is no folder config in it" in output and "Traceback" not in output


def test_a_file_in_the_place_of_results_ends_snakemake(tmp_path):
    """Before any job, in one sentence; the file stays."""
    folder = own_project(tmp_path / "my project")
    (folder / "results").write_text("mine\n")
    output = said_of(tmp_path, *outside_of(folder), STUDY, "--dry-run", code=1)
    assert "results: found a file, allowed is a folder, or none" in output and "Traceback" not in output
    assert (folder / "results").read_text() == "mine\n"
