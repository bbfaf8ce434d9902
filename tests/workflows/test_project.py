"""Projects outside the package, run: by --directory and as a module, side by side, killed, started again."""

import json
import os
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pandas as pd
import pytest

from bulkwear.workflows.engine.project import PACKAGE
from bulkwear.workflows.report.printed import PDF, browser
from tests.support.asked_project import PROFILE, outside_of, said_of
from tests.support.own_project import SECOND, STUDY, WORD, own_project
from tests.workflows.test_snakemake import TIMEOUT, finish, planned_jobs, snakemake

ROUNDING = 1e-12  # relative; of a sum over triangles
WITHOUT_LIBRARIES = 80.0  # MB, of a process that imports no library, 25 of them; with pandas and matplotlib 170
RUNS, SUMMARY = ["A_convex", "A_plain"], f"results/{SECOND}/summary.csv"
POLL = 0.01  # s, of a cycle that takes a quarter of a second

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
