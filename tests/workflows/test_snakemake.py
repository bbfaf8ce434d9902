"""Snakemake on a tiny study in a copy of the repository: planned, interrupted by Ctrl-C, started again, refused."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.job import STOPPED
from tests import REPOSITORY
from tests.support.compiled import share_compiled

PARTS = ("bulkwear", "workflows", "templates", "meshes", "postproc", "config", "profiles", "Snakefile")
TIMEOUT = 1800.0  # s, for a study that takes about 20 s on an idle machine
TINY = """\
title: A tiny study
question: Does the chain hold together?
design: demo.csv
rows: [R9]
surfaces: [convex, plain]
fidelities:
  quick:
    particle_scale: 4
    sample: {width_mm: 40, length_mm: 40, element_size_mm: 2}
    bed: {width_mm: 60, ahead_mm: 20, behind_mm: 20}
    sliding: {run_in_mm: 10, travel_mm: 20, cycles: 2}
packings: 1
"""
THREE_RUNS = """\
rule all:
    input:
        expand("{size}.run", size=[5000, 1000, 9000]),

rule run:
    input:
        "{size}.bed",
    output:
        "{size}.run",
    shell:
        "echo {wildcards.size} >> started; touch {output}"

rule bed:
    output:
        "{size}.bed",
    priority: 1
    shell:
        "echo bed >> started; head -c {wildcards.size} /dev/zero > {output}"
"""


def workspace(folder: Path) -> Path:
    """Copy what a study needs into a folder, with the tiny study as its only one."""
    for name in PARTS:
        source = REPOSITORY / name
        if source.is_dir():
            shutil.copytree(source, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
            share_compiled(folder / name, source)
        else:
            shutil.copy(source, folder / name)
    (folder / "solver").symlink_to(REPOSITORY / "solver")
    for study in (folder / "config" / "studies").iterdir():
        study.unlink()
    (folder / "config" / "studies" / "tiny.yaml").write_text(TINY)
    return folder


def snakemake(folder: Path, *arguments: str, before: Sequence[str] = ()) -> subprocess.Popen:
    return subprocess.Popen(
        [*before, sys.executable, "-m", "snakemake", *arguments],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        process_group=0,
    )


def finish(process: subprocess.Popen) -> str:
    output, _ = process.communicate(timeout=TIMEOUT)
    assert process.returncode == 0, output
    return output


@pytest.mark.verify
@pytest.mark.solver
def test_ctrl_c_says_how_to_go_on(tmp_path):
    """What a terminal sends with Ctrl-C, while the solver works: the job says in a line how to go on, without a
    traceback, and no solver is left."""
    folder = workspace(tmp_path)
    process = snakemake(folder, "results/tiny/beds/bed_R5/bed.restart")
    deadline = time.monotonic() + TIMEOUT
    while not list(folder.glob("results/tiny/beds/bed_R5/log.liggghts")):
        assert process.poll() is None and time.monotonic() < deadline
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGINT)
    output, _ = process.communicate(timeout=TIMEOUT)
    assert process.returncode != 0
    assert STOPPED in output
    assert "Traceback" not in output


@pytest.mark.verify
def test_only_cases_of_the_studies_asked_for_are_imported(tmp_path):
    """A case that cannot be imported keeps no study of another case from being planned, and no job of one."""
    folder = workspace(tmp_path)
    shutil.copy(REPOSITORY / "config/studies/calibration.yaml", folder / "config/studies")
    for case in ("pin_on_disc", "circular_tester", "sliding_sample"):
        (folder / "workflows/cases" / case / "case.py").write_text("raise RuntimeError('not to be imported')\n")
    assert "Calibration of calibration" in finish(snakemake(folder, "calibration", "--dry-run"))
    job = ("--target-jobs", "box_sizes:study=calibration")
    assert planned_jobs(finish(snakemake(folder, *job, "--dry-run"))) == {"box_sizes": 1}
    output, _ = (process := snakemake(folder, "tiny", "--dry-run")).communicate(timeout=TIMEOUT)
    assert process.returncode != 0 and "not to be imported" in output


@pytest.mark.solver
@pytest.mark.verify
def test_an_edited_template_renders_again(tmp_path):
    """Decks are up to date until a template changes; then they are rendered again."""
    folder = workspace(tmp_path)
    decks = "results/tiny/decks/R9_plain/cycle_000/deck.in"  # and those of the cycles beside it
    finish(snakemake(folder, decks))
    assert "Nothing to be done" in finish(snakemake(folder, decks))
    template = folder / "templates/sliding_sample/sliding_sample.in.j2"
    template.write_text(template.read_text() + "# the end\n")
    finish(snakemake(folder, decks))
    deck = folder / "results/tiny/decks/R9_plain/cycle_001/deck.in"
    assert deck.read_text().endswith("# the end\n")


def test_a_fault_of_an_edited_template_is_one_sentence(tmp_path):
    """It names the file; no rule of Snakemake and no line of our code."""
    folder = workspace(tmp_path)
    template = folder / "templates/sliding_sample/sliding_sample.in.j2"
    whole = template.read_text()
    for filtered, sentence in (("skinm", ": parameter skinm is not given"), ("skin_m | tabel", ", line 29: No filter")):
        template.write_text(whole.replace("{{ skin_m }}", f"{{{{ {filtered} }}}}"))
        process = snakemake(folder, "tiny_decks", "--dry-run")
        output, _ = process.communicate(timeout=TIMEOUT)
        assert process.returncode != 0
        assert f"templates/sliding_sample/sliding_sample.in.j2{sentence}" in output
        assert "Traceback" not in output and "InputFunctionException" not in output


@pytest.mark.verify
def test_a_study_is_planned_without_a_solver(tmp_path):
    """Without the program that its wear cycles need a study is planned all the same."""
    folder = workspace(tmp_path)
    (folder / "solver").unlink()
    assert planned_jobs(finish(snakemake(folder, "tiny", "--dry-run")))["worn_run"] > 0


def test_a_missing_solver_is_one_sentence_before_any_job(tmp_path):
    """Without the program that its wear cycles need no bed is filled for a study."""
    folder = workspace(tmp_path)
    (folder / "solver").unlink()
    process = snakemake(folder, "tiny")
    output, _ = process.communicate(timeout=TIMEOUT)
    assert process.returncode != 0
    assert "liggghts-ledger: there is no such program, nor one of its name on the PATH" in output
    assert "Traceback" not in output
    assert not (folder / "results").exists()


@pytest.mark.verify
def test_damaged_rates_are_one_sentence_before_any_job(tmp_path):
    """By them jobs ask for time and memory, and the wait for a silent solver is found."""
    folder = workspace(tmp_path)
    (folder / "results").mkdir()
    (folder / "results" / "cost_rates.json").write_text("{")
    process = snakemake(folder, "tiny")
    output, _ = process.communicate(timeout=TIMEOUT)
    assert process.returncode != 0
    assert "results/cost_rates.json: no file of rates (" in output and "Traceback" not in output
    assert [path.name for path in (folder / "results").iterdir()] == ["cost_rates.json"]


def test_the_run_with_the_largest_bed_starts_first(tmp_path):
    """On one core the profile's scheduler takes all jobs of higher priority, then the others by size of their input;
    so beds and meshes have that priority, and runs do not.
    """
    (tmp_path / "Snakefile").write_text(THREE_RUNS)
    profile = str(REPOSITORY / "profiles" / "default")
    finish(snakemake(tmp_path, "--workflow-profile", profile, "--cores", "1"))
    started = (tmp_path / "started").read_text().split()
    assert started[:3] == ["bed"] * 3 and started[3:] == ["9000", "5000", "1000"]
    rules = (REPOSITORY / "workflows" / "engine" / "rules.smk").read_text()
    with_priority = re.findall(r"^rule (\w+):(?:\n(?!rule ).*)*?\n    priority: 1\b", rules, flags=re.MULTILINE)
    assert with_priority == ["surface_mesh", "settled_bed"]


def planned_jobs(output: str) -> dict[str, int]:
    """Jobs by rule from the table that a dry run prints."""
    table = output.partition("Job stats:")[2].partition("total")[0]
    return {rule: int(count) for rule, count in re.findall(r"^(\w+) +(\d+)$", table, flags=re.MULTILINE)}


@pytest.mark.verify
def test_paper_fidelity_of_every_study_is_planned_alike_under_both_profiles(tmp_path):
    """Sizes for a cluster are planned without a solver: the same jobs on one machine and on a cluster, and of a search
    those of its first rows."""
    folder = workspace(tmp_path)
    for study in (REPOSITORY / "config/studies").iterdir():
        shutil.copy(study, folder / "config/studies")
    studies = [path.stem for path in (REPOSITORY / "config/studies").iterdir()]
    planned = {}
    for profile in ("default", "slurm"):
        arguments = ("--dry-run", "--workflow-profile", f"profiles/{profile}", "--config", "fidelity=paper")
        planned[profile] = planned_jobs(finish(snakemake(folder, *studies, *arguments)))
    assert planned["default"] == planned["slurm"]
    loaded = [load_study(name, overrides={"fidelity": "paper"}) for name in studies]
    first = [study.with_packings(study.first_packings) for study in loaded if study.case.wears]
    assert planned["slurm"]["worn_run"] == sum(len(study.runs) for study in first)
    assert planned["slurm"]["report"] == len(studies)


@pytest.mark.verify
def test_best_designs_are_planned_once_they_are_found(tmp_path):
    """Before the regression has written them the target is a sentence; then both runs and their figure are planned."""
    folder = workspace(tmp_path)
    shutil.copy(REPOSITORY / "config/studies/screening.yaml", folder / "config/studies")
    output, _ = (process := snakemake(folder, "screening_confirmation", "--dry-run")).communicate(timeout=TIMEOUT)
    assert process.returncode != 0
    assert "results/screening/confirmation/design.csv: there is no such file yet, `snakemake screening`" in output
    design = (folder / "config/designs/screening.csv").read_text().splitlines()
    found = folder / "results/screening/confirmation"
    found.mkdir(parents=True)
    (found / "design.csv").write_text(f"{design[0]}\n{design[9].replace('R9', 'continuous')}\n")
    (found / "prediction.csv").write_text("row,fidelity\ncontinuous,quick\n")
    output = finish(snakemake(folder, "screening_confirmation", "--dry-run"))
    assert output.count("Wear cycles of continuous_") == 2
    assert planned_jobs(output)["figure_confirmation"] == 1
