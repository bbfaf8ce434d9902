"""Projects outside the package: by --directory and as a module, side by side, killed; what is wrong is a sentence."""

import json
import multiprocessing
import os
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pandas as pd
import pytest

from bulkwear.__main__ import main
from bulkwear.workflows.config.design import ConfigError, load_study
from bulkwear.workflows.config.targets import Naming, naming, nearly_studies, placed, requested_studies, unknown_run
from bulkwear.workflows.engine.project import PACKAGE, Project
from bulkwear.workflows.report.printed import PDF, browser
from tests.support.loaded_project import load_project, plan
from tests.support.own_project import SECOND, STUDY, TEMPLATE, WORD, own_project
from tests.workflows.test_snakemake import TIMEOUT, finish, planned_jobs, snakemake

# Each process is forked from one that has read modules and entered no project: starting Snakemake costs 1.5 seconds.
CLEAN = multiprocessing.get_context("forkserver")
CLEAN.set_forkserver_preload(
    [load_project.__module__, "snakemake.cli", "snakemake.report", "snakemake.script", "jsonschema"]
)
ROUNDING = 1e-12  # relative; of a sum over triangles
WITHOUT_LIBRARIES = 80.0  # MB, of a process that imports no library, 25 of them; with pandas and matplotlib 170
RUNS, SUMMARY = ["A_convex", "A_plain"], f"results/{SECOND}/summary.csv"
POLL = 0.01  # s, of a cycle that takes a quarter of a second
PROFILE = ("--workflow-profile", str(PACKAGE / "workflows/profiles/default"))


# Runs a command where the package, mounted on itself, cannot be written to, not even by root; but for what numba has
# compiled, or each of the three would compile it anew, a quarter of a minute.
READ_ONLY = """
mount --bind "$0" "$0" && mount -o remount,bind,ro "$0" || exit 77
find "$0" -name .venv -prune -o -name "*.nbi" -printf "%h\n" | sort -u | while read -r compiled; do
    mount --bind "$compiled" "$compiled" && mount -o remount,bind,rw "$compiled" || exit 77
done || exit 77
touch "$0/written" 2>/dev/null && exit 78
exec "$@"
"""
NOT_ROOT = 77  # exit code of a command that could not mount


def read_only() -> list[str]:
    """What goes before a command so that it finds the package read-only; nothing where this user may not mount."""
    before = ["unshare", "--mount", "sh", "-c", READ_ONLY, str(PACKAGE)]
    try:
        code = subprocess.run([*before, "true"], capture_output=True).returncode
    except FileNotFoundError:
        return []
    assert code in (0, 1, NOT_ROOT), code
    return before if code == 0 else []


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A project whose study ran by --directory; the package could not be written to meanwhile."""
    mine = own_project(tmp_path_factory.mktemp("with a space") / "my project")
    outside = (*outside_of(mine), "--cores", "1", STUDY)
    return {"mine": mine, "said": finish(snakemake(mine.parent, *outside, before=read_only()))}


@pytest.fixture(scope="module")
def at_the_same_time(tmp_path_factory):
    """Two projects on one package, all at the same time: one runs two studies at once by --directory, the other is a
    Snakefile of its own that takes the workflow as a module. The package cannot be written to meanwhile.
    """
    place = tmp_path_factory.mktemp("with a space")
    mine, other = own_project(place / "my project"), own_project(place / "the other one")
    before = read_only()
    outside = (*outside_of(mine), "--cores", "1")
    running = {
        "mine": snakemake(place, *outside, STUDY, before=before),
        "second": snakemake(place, *outside, SUMMARY, before=before),
        "module": snakemake(other, *PROFILE, "--cores", "1", before=before),
    }
    said = {name: finish(process) for name, process in running.items()}
    return {"mine": mine, "other": other, "said": said}


@pytest.mark.solver
def test_a_project_runs_to_its_page(finished):
    """Its study with its case, law, material and template; the wear is the law's."""
    folder = finished["mine"] / "results" / STUDY
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "A dimpled sample" in page and "over 3" in page
    deck = (folder / "A_plain/cycle_001/deck.in").read_text()
    assert deck.endswith(f'print "{WORD}"\n') and "3300" in (folder / "beds/bed_A/deck.in").read_text()
    wear = pd.read_csv(folder / "A_plain/wear.csv")
    archard = 6.3e-13 * wear["sliding_work_J"].sum()
    assert wear["worn_volume_m3"].sum() == pytest.approx(archard / 3.0, rel=ROUNDING)


@pytest.mark.solver
def test_figures_are_made_by_one_process(finished):
    """Their own processes import nothing of what draws."""
    logs = finished["mine"] / "results" / STUDY / "logs"
    memory = pd.concat(pd.read_csv(path, sep="\t", na_values="-") for path in logs.glob("figure_*.benchmark.tsv"))
    assert len(memory) > 1 and memory["max_rss"].max() < WITHOUT_LIBRARIES


@pytest.mark.verify
@pytest.mark.solver
def test_a_finished_study_has_further_reports(finished):
    """Its page as PDF, where there is a browser; and Snakemake's own report with a description, its tables by name and
    each figure by its title."""
    outside = (*outside_of(finished["mine"]), "--cores", "1")
    folder = finished["mine"] / "results" / STUDY
    if browser():
        finish(snakemake(finished["mine"], *outside, f"results/{STUDY}/report.pdf"))
        assert (folder / "report.pdf").read_bytes().startswith(PDF)
    finish(snakemake(finished["mine"], *outside, STUDY, "--report", str(folder / "snakemake_report.html")))
    text = (folder / "snakemake_report.html").read_text(encoding="utf-8")
    assert "Wear of surfaces by bulk solids" in text
    shown = json.loads(re.search(r"var categories = (.*);", text)[1])
    tables = {Path(path).name for path in shown.pop("Tables")["Other"]}
    assert {"design.csv", "summary.csv", "forecast.csv"} <= tables
    figures = {path for category in shown.values() for paths in category.values() for path in paths}
    assert {Path(path).stem for path in figures} == {path.stem for path in (folder / "figures").glob("*.*")}
    assert '"labels": {"figure": "Wear against travel"}' in text


@pytest.mark.verify
@pytest.mark.solver
def test_two_studies_at_once_from_one_folder(at_the_same_time):
    """Each ends in its summary."""
    for name, runs in ((STUDY, ["A_plain"]), (SECOND, RUNS)):
        assert list(pd.read_csv(at_the_same_time["mine"] / f"results/{name}/summary.csv")["run"]) == runs


@pytest.mark.verify
@pytest.mark.solver
def test_a_design_row_becomes_a_summary(at_the_same_time):
    """One row and two surfaces give two runs, each with its wear; the plain run is its own reference."""
    table = pd.read_csv(at_the_same_time["mine"] / SUMMARY).set_index("run")
    assert (table["worn_volume_m3"] > 0).all()
    assert table.loc["A_plain", "wear_over_plain"] == 1.0
    assert table.loc["A_plain", "pattern_worn_volume_m3"] == 0.0 < table.loc["A_convex", "pattern_worn_volume_m3"]


@pytest.mark.solver
def test_nothing_is_left_to_do_after_a_study(finished):
    """Started again, Snakemake finds everything up to date; the settled bed was filled once for its run."""
    outside = (*PROFILE, "--snakefile", str(PACKAGE / "Snakefile"))
    assert "Nothing to be done" in said_of(finished["mine"], *outside, f"results/{STUDY}/summary.csv")
    assert len(list((finished["mine"] / f"results/{STUDY}/beds").iterdir())) == 1


@pytest.mark.verify
@pytest.mark.solver
def test_killed_snakemake_started_again_gives_the_same_summary(at_the_same_time, tmp_path):
    """kill -9 of everything during a wear cycle; a plain second call ends in the same summary.csv. Surfaces and bed are
    there already.
    """
    folder = shutil.copytree(at_the_same_time["mine"], tmp_path / "killed", symlinks=True)
    (folder / SUMMARY).unlink()
    for run in RUNS:
        shutil.rmtree(folder / f"results/{SECOND}" / run)
    outside = (*PROFILE, "--snakefile", str(PACKAGE / "Snakefile"), SUMMARY)
    process = snakemake(folder, *outside)
    deadline = time.monotonic() + TIMEOUT
    while not list(folder.glob(f"results/{SECOND}/*/cycle_00[12].part/bed_*.dump")):
        assert process.poll() is None and time.monotonic() < deadline
        time.sleep(POLL)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    assert not (folder / SUMMARY).exists()
    finish(snakemake(folder, *outside))
    for name in ("summary.csv", *(f"{run}/wear.csv" for run in RUNS)):
        path = Path(f"results/{SECOND}") / name
        assert (folder / path).read_bytes() == (at_the_same_time["mine"] / path).read_bytes()


@pytest.mark.verify
@pytest.mark.solver
def test_rules_on_top_take_results_on(at_the_same_time):
    """With a prefix on our rules: its own rule is made by default, from tables and a figure of ours; the results are
    those of the other project. Only the other figures and the page are left to make.
    """
    results = at_the_same_time["other"] / "results"
    assert (results / "ranking.txt").read_text() == "A_plain\n"
    path = f"results/{STUDY}/summary.csv"
    assert (at_the_same_time["other"] / path).read_bytes() == (at_the_same_time["mine"] / path).read_bytes()
    assert "Wear cycles of A_plain" in at_the_same_time["said"]["module"]
    assert "Forecast of mine" in at_the_same_time["said"]["module"]
    left = planned_jobs(said_of(at_the_same_time["other"], *PROFILE, f"bw_{STUDY}", "--dry-run"))
    assert left.pop(f"bw_{STUDY}") == left.pop("bw_report") == 1 and left, left
    assert (
        all(rule.startswith(("bw_figure_", "bw_tables_")) for rule in left)
        and "bw_figure_wear_against_travel" not in left
    ), left


@pytest.mark.solver
def test_the_log_says_which_file_won(finished):
    """Once, and of those only that the package has as well."""
    said = finished["said"]
    assert said.count("config/materials.yaml: this project's, over the package's") == 1
    assert said.count("templates/sliding_sample/sliding_sample.in.j2: this project's, not the package's") == 1
    assert said.count(": this project's") == 2


@pytest.mark.solver
def test_a_changed_line_is_told_before_a_run_is_done_again(finished, tmp_path):
    """What differs in a deck and a law stands in a sentence; Snakemake's own reason is a line."""
    mine = shutil.copytree(finished["mine"], tmp_path / "mine", symlinks=True)
    arguments = (*PROFILE, "--snakefile", str(PACKAGE / "Snakefile"), "--dry-run", f"results/{STUDY}/summary.csv")
    assert "differs" not in said_of(mine, *arguments)
    study = mine / "config/studies/mine.yaml"
    study.write_text(study.read_text().replace(WORD, "something else"))
    said = said_of(mine, *arguments)
    assert f"its deck of a wear cycle changed, line 119: 'print \"something else\"', it was 'print \"{WORD}\"'" in said
    assert max(len(line) for line in said.splitlines() if line.startswith("Reason:")) < 400
    study.write_text(study.read_text().replace("something else", WORD))
    law = mine / "laws/hardened.py"
    law.write_text(law.read_text().replace("/ parameters", "/ 2.0 / parameters"))
    assert "A_plain of mine differs from what was simulated: law.hardened.py is " in said_of(mine, *arguments)


@pytest.mark.solver
def test_a_page_of_other_code_is_made_again_and_nothing_else(finished, tmp_path):
    """A project's own page in the place of its case's: no run, no table, no figure."""
    mine = shutil.copytree(finished["mine"], tmp_path / "mine", symlinks=True)
    arguments = (*PROFILE, "--snakefile", str(PACKAGE / "Snakefile"), f"results/{STUDY}/report.html", "--dry-run")
    assert not planned_jobs(said_of(mine, *arguments))
    page = mine / "cases/dimpled/page.py"
    page.write_text("from bulkwear.workflows.cases.sliding_sample.page import *  # noqa: F403\n")
    assert planned_jobs(said_of(mine, *arguments)) == {"report": 1}


@pytest.mark.solver
def test_results_without_snakemakes_record_answer_no_other_question(finished, tmp_path):
    """Of results that were copied without .snakemake a run that was simulated from something else is made again, and
    its bed, which is told; what still holds is taken."""
    mine = shutil.copytree(finished["mine"], tmp_path / "mine", symlinks=True)
    shutil.rmtree(mine / ".snakemake")
    arguments = (*PROFILE, "--snakefile", str(PACKAGE / "Snakefile"), "--dry-run", f"results/{STUDY}/summary.csv")
    assert not {"worn_run", "settled_bed"} & set(planned_jobs(said_of(mine, *arguments)))
    study = mine / "config/studies/mine.yaml"
    study.write_text(study.read_text().replace(WORD, "something else"))
    said = said_of(mine, *arguments)
    assert f"results/{STUDY}/A_plain is made again: its deck of a wear cycle changed" in said
    assert planned_jobs(said)["worn_run"] == 1 and "settled_bed" not in planned_jobs(said)
    study.write_text(study.read_text().replace("something else", WORD))
    (mine / "results" / STUDY / "beds/bed_A/deck.in").write_text("another deck")
    said = said_of(mine, *arguments)
    assert f"results/{STUDY}/beds/bed_A is made again: its deck changed, line 1: '" in said
    assert planned_jobs(said)["settled_bed"] == 1


def test_a_project_is_planned_on_a_cluster(tmp_path):
    """The profile for Slurm of the package, on the project's study; the same jobs as on one machine."""
    mine = own_project(tmp_path / "my project")
    outside = (*outside_of(mine), "--dry-run", STUDY)
    profiles = (str(PACKAGE / "workflows/profiles" / name) for name in ("default", "slurm"))
    planned = [planned_jobs(said_of(tmp_path, *outside, "--workflow-profile", each)) for each in profiles]
    assert planned[0] == planned[1] and planned[0]["worn_run"] == 1


def test_one_command_makes_a_project(tmp_path, capsys):
    """Its Snakefile takes the package as a module; both ways in plan the same, and its study is made by default."""
    folder = tmp_path / "a new one"
    assert main(["project", str(folder)]) == 0
    assert f"cd '{folder}' && snakemake" in capsys.readouterr().out
    from_outside = said_of(tmp_path, *outside_of(folder), "--dry-run")
    planned = [planned_jobs(said) for said in (said_of(folder, "--dry-run"), from_outside)]
    assert planned[0] == planned[1] and planned[0]["worn_run"] == 2 * 3 and planned[0]["report"] == 1
    assert {"demo", "screening", "first"} <= set(said_of(folder, "--list-target-rules").split())
    assert main(["project", str(folder)]) == 1
    assert "there is something in it, allowed is a new or an empty folder" in capsys.readouterr().err
    assert main(["project", str(tmp_path / "q{8}")]) == 1
    assert "found a brace in the name of the folder" in capsys.readouterr().err
    assert main(["project", "~no_such_user/new"]) == 1
    assert "~no_such_user is the home of nobody, allowed is another folder" in capsys.readouterr().err


def test_names_with_words_round_them_are_ours():
    """A module's targets are recognised by what was put round them; what is not ours is the Snakefile's own."""
    project = Project(PACKAGE)
    named = naming(lambda name: f"bw_{name}_x", True)
    assert named == Naming("bw_", "_x", True)
    assert requested_studies(["bw_screening_x", "bw_calibration_decks_x"], project=project, names=named) == [
        *("screening", "calibration")
    ]
    jobs = [("bw_worn_run_x", {"study": "screening"}), ("own_rule", {"study": "no study"})]
    assert requested_studies([], jobs, project, named) == ["screening", "demo"]
    assert requested_studies(["all", "figures/a.png"], project=project, names=named) == ["demo"]
    assert requested_studies(["bw_cost_rates_x"], project=project, names=named) == []
    near = nearly_studies(["bw_screning_x", "bw_screening_x", "all", "screning", "results/screning/"], project, named)
    assert near == ["bw_screning_x is no study, the nearest is screening; it is taken for a rule of this Snakefile."]
    assert nearly_studies(["screning"], project) == []


def test_a_fault_of_settings_is_of_the_place_that_gives_them():
    """The command line where it has that key, else the files of --configfile; without either the module's config."""
    said, mine = "command line: packings is 200, allowed is 1.", Naming(is_module=True)
    for given, files, place in (
        (["packings=200"], [Path("my.yaml")], "command line"),
        (["rows=[R5]"], [Path("my.yaml")], "my.yaml"),
        ([], [Path("my.yaml"), Path("ours.yaml")], "my.yaml, ours.yaml"),
        (["rows=[R5]"], [], "command line"),
        ([], [], "config of the module"),
    ):
        assert placed(said, mine, given, files) == f"{place}: packings is 200, allowed is 1."
    assert placed(said, Naming(), []) == said
    assert placed("default.yaml: packings is 200.", mine, [], [Path("my.yaml")]) == "default.yaml: packings is 200."


def test_a_file_of_a_run_that_a_study_does_not_have():
    """It is named, with those that there are; files of beds and studies, and studies that add runs, are let be."""
    runs = {"demo": ["R5_convex", "R5_plain"]}
    said = unknown_run(["demo", "results/demo/R9_convex/wear.csv"], runs)
    assert said.startswith("target results/demo/R9_convex/wear.csv: its run is 'R9_convex', allowed is one of R5_")
    fine = ["demo", "results/demo/R5_plain/wear.csv", "results/demo/beds/wear.csv/x", "results/screening/R0/wear.csv"]
    assert unknown_run(fine, runs) is None


def test_a_study_called_as_a_rule_is_refused_by_its_name(tmp_path):
    """Not taken for the rule, which needs wildcards."""
    (tmp_path / "config/studies").mkdir(parents=True)
    (tmp_path / "config/studies/report.yaml").write_text("title: x\n")
    assert requested_studies(["report"], project=Project(tmp_path)) == ["report"]
    with pytest.raises(ConfigError, match="a study cannot be called report"):
        load_study("report", Project(tmp_path))


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


def test_what_an_own_template_leaves_out_is_told(tmp_path):
    """It is no fault: the line stands beside that on which template won."""
    folder = own_project(tmp_path / "my project")
    partial = "templates/_shared/integration.in.j2"
    (folder / partial).parent.mkdir(exist_ok=True)
    (folder / partial).write_text("fix step_check all check/timestep/gran 1000 0.5 0.5\n")
    said = said_of(folder, *PROFILE, f"bw_{STUDY}_forecast", "--dry-run")
    assert said.count(f"{partial}: without fix gravity, fix motion of the package's deck") == 1


@pytest.mark.verify
def test_studies_of_the_package_are_planned_in_a_project(tmp_path):
    """With the published tables that they are compared with, and those of the project where it has some."""
    folder = own_project(tmp_path / "my project")
    shutil.rmtree(folder / "templates")
    outside = (*outside_of(folder), "--dry-run")
    planned = planned_jobs(said_of(tmp_path, *outside, "calibration", "particle_size"))
    assert planned["calibrated_parameters"] == 1 and planned["report"] == 2


def test_a_module_loads_the_studies_that_it_names(tmp_path):
    """Two modules side by side, each with its own; what is not a list of names is refused."""
    folder = own_project(tmp_path / "my project")
    module = """
module {name}:
    snakefile: "{package}/Snakefile"
    config: {{"studies": {studies}}}

use rule * from {name} as {name}_*
"""
    texts = [
        module.format(name=name, package=PACKAGE, studies=studies)
        for name, studies in (("a", ["mine"]), ("b", ["second"]))
    ]
    (folder / "Snakefile").write_text("".join(texts))
    planned = planned_jobs(said_of(folder, *PROFILE, "a_mine", "b_second_decks", "--dry-run"))
    assert planned["a_worn_run"] == 1 and planned["b_run_decks"] == 2
    (folder / "Snakefile").write_text(texts[0].replace("['mine']", "'mine'"))
    output = said_of(folder, *PROFILE, "--dry-run", code=1)
    assert "config of the module: studies is 'mine', allowed is a list of names of studies." in output


@pytest.mark.parametrize(
    ("triggers", "said"),
    [
        ((), "are code, input, mtime, params, software-env: newer code fills beds and simulates runs again"),
        (("--rerun-triggers", "mtime"), "are mtime: without params and input results may stay"),
        (PROFILE, ""),
    ],
)
def test_a_pipeline_without_our_profile_is_told(tmp_path, triggers, said):
    """What Snakemake makes again there, and what it does not; nothing with the package's profile."""
    folder = own_project(tmp_path / "my project")
    output = said_of(folder, *triggers, "--cores", "1", "bw_mine_decks", "--dry-run")
    assert output.count("rerun-triggers of Snakemake") == bool(said) and said in output


def test_settings_of_a_pipeline_are_those_of_its_block(tmp_path):
    """What the command line sets beside the block does not reach the studies, which is said; a fault within the block
    names the module. What moves the results is refused.
    """
    folder = own_project(tmp_path / "my project")
    snakefile = folder / "Snakefile"
    own = snakefile.read_text()
    snakefile.write_text(own.replace("        config\n", '        config.get("bulkwear", {})\n'))
    lost = ("--config", "fidelity=paper", "sample={width_mm: 50}", "colour=red")
    output = said_of(folder, *PROFILE, "bw_mine", "--dry-run", *lost)
    assert "command line: fidelity, sample of --config does not reach the studies" in output
    given = said_of(folder, *PROFILE, "bw_mine", "--dry-run", "--config", "bulkwear={particle_scale: 5}")
    assert "does not reach" not in given
    snakefile.write_text('config["bulkwear"] = {"fidelity": "paper"}\n' + snakefile.read_text())
    output = said_of(folder, *PROFILE, "bw_mine", "--dry-run", code=1)
    assert "config of the module: fidelity is 'paper', allowed is one of quick" in output
    snakefile.write_text(own.replace("    config:\n", '    prefix:\n        "sub"\n    config:\n'))
    output = said_of(folder, *PROFILE, "bw_mine", "--dry-run", code=1)
    assert "module: its prefix makes sub/results/first/summary.csv of results/first/summary.csv, allowed is" in output


def test_a_study_of_the_package_s_name_is_refused(tmp_path):
    """It would be unclear whose it is."""
    folder = own_project(tmp_path / "my project")
    shutil.copy(folder / MINE, folder / "config/studies/demo.yaml")
    assert "config/studies/demo.yaml: a study demo is in the package too" in told_of(folder, "demo")


def said_of(folder: Path, *arguments: str, code: int = 0) -> str:
    """What Snakemake says in a folder where it makes nothing; code: with which it ends."""
    said = folder.parent / "plan.txt"
    process = CLEAN.Process(target=plan, args=(folder, arguments, said))
    process.start()
    process.join()
    output = said.read_text(encoding="utf-8")
    assert process.exitcode == code, output
    return output


def outside_of(folder: Path) -> tuple[str, ...]:
    """How a project is named from outside it, for the package's own Snakefile."""
    return "--snakefile", str(PACKAGE / "Snakefile"), "--directory", str(folder)


def told_of(folder: Path, study: str = STUDY) -> str:
    """What is said of a project that cannot be worked in, and nothing else: one line."""
    said = folder.parent / "said.txt"
    process = CLEAN.Process(target=load_project, args=(folder, study, said))
    process.start()
    process.join()
    told = said.read_text()
    assert process.exitcode == 1 and told.count("\n") == 1, told
    assert not (folder / "results").exists()
    return told


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
