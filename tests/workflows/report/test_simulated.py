"""What pages and figures say of the versions that simulated, and where the code is newer."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.provenance import PROVENANCE, PROVENANCE_FILE, simulating_code
from bulkwear.workflows.report import products
from bulkwear.workflows.report.markdown import provenance
from bulkwear.workflows.report.products import job_of, simulated_remark
from bulkwear.workflows.report.simulated import (
    UNRECORDED,
    figure_remark,
    newer_parts,
    said_of,
    versions_of,
    warnings_of,
)
from bulkwear.workflows.report.spot_checks import SpotCheck, keep_check
from tests.support.finished_runs import leave_runs
from tests.support.finished_samples import page_of_results, write_results

CASE = "sliding_sample"
NOW = {"version": "1.0", "wear_version": 3, "commit": "feedfacecafe", "changed": False}
NOW |= {"parts": {"wear": "a", "engine": "b", "solver": "c"}}


def record(date: str = "2026-11-22T10:00:00Z", **changes) -> dict:
    """What a simulation by the present code records, with changes; those of parts are merged."""
    parts = NOW["parts"] | changes.pop("parts", {})
    return NOW | {"date": date, **changes, "parts": parts}


def leave(folder: Path, *cycles: dict | None) -> Path:
    """Write the states of the cycles of a run with what they record, and return its folder."""
    for number, found in enumerate(cycles):
        cycle = folder / f"cycle_{number:03d}"
        cycle.mkdir(parents=True)
        (cycle / "state.json").write_text(json.dumps({"inputs": "x", **({PROVENANCE: found} if found else {})}))
    return folder


def told(folders: list[Path], beds: tuple[Path, ...] = ()) -> tuple[str, str, list[str]]:
    """Phrase of a page, remark of a figure, warnings."""
    versions = versions_of(folders, beds)
    return said_of(versions), figure_remark(versions, NOW), warnings_of(versions, NOW, [CASE])


def test_one_present_version_is_named_and_nothing_is_warned_of(tmp_path):
    """All cycles of all runs by the same code, on two days."""
    runs = [leave(tmp_path / "R1", record(), record("2026-11-23T01:00:00Z")), leave(tmp_path / "R2", record())]
    assert told(runs) == ("by commit feedfacecafe", "simulated by feedface, 2026-11-22 to 2026-11-23", [])


def test_another_commit_of_the_same_code_is_named_and_not_warned_of(tmp_path):
    """A commit that changed docs alone leaves the hashes as they are."""
    runs = [leave(tmp_path / f"R{k}", record()) for k in (1, 2)] + [
        leave(tmp_path / "R3", record(commit="0123456789ab"))
    ]
    said, remark, warned = told(runs)
    assert said == "by commit feedfacecafe (2 of the simulations); by commit 0123456789ab (1 of the simulations)"
    assert remark == "simulated by feedface, 01234567, 2026-11-22"
    assert warned == []


def test_older_code_is_warned_of_with_its_runs_and_parts(tmp_path):
    """The runs whose code differs, the parts that do, and that volumes change where the wear code's version does."""
    old = record(commit="0123456789ab", changed=True, parts={"solver": "z"}, wear_version=2)
    runs = [leave(tmp_path / "R1", record()), leave(tmp_path / "R2", old)]
    _, remark, warned = told(runs)
    assert remark == "simulated by feedface, 01234567+, 2026-11-22 (code newer since: solver)"
    (sentence,) = warned
    assert sentence.startswith("R2: simulated by commit 0123456789ab with changes. Newer since then: the solver's load")
    assert "postproc/wear" not in sentence and sentence.endswith("the same loads wear other volumes now.")


def test_a_run_that_two_versions_worked_on_counts_for_both(tmp_path):
    """A killed run that another version ended is named with the older one's parts."""
    old = record(commit="0123456789ab", parts={"wear": "z"})
    versions = versions_of([leave(tmp_path / "R1", old, record())])
    assert {(version.name[7:11], version.runs) for version in versions} == {("0123", ("R1",)), ("feed", ("R1",))}
    assert {tuple(newer_parts(version, NOW)) for version in versions} == {("wear",), ()}


def test_runs_of_one_name_in_several_folders_are_several(tmp_path):
    """Packings that have folders of their own; named from the folder that all are in."""
    folders = [leave(tmp_path / f"seed_{k}" / "plain", record()) for k in (1, 2)]
    (version,) = versions_of(folders, within=tmp_path)
    assert version.runs == ("seed_1/plain", "seed_2/plain")


def test_runs_without_a_record_say_so(tmp_path):
    """States from before there were records, and a bed without its file."""
    bed = tmp_path / "beds" / "bed_1"
    bed.mkdir(parents=True)
    (bed / "bed.restart").write_bytes(b"")
    said, remark, warned = told([leave(tmp_path / "R1", None)], (bed,))
    assert said == f"by {UNRECORDED}" and remark == f"simulated by {UNRECORDED}"
    assert warned == [f"R1, bed_1: simulated by {UNRECORDED}. What of the code is newer is not known."]
    (bed / PROVENANCE_FILE).write_text(json.dumps(record()))
    assert told([], (bed,))[2] == []


def test_without_git_the_version_and_its_code_are_named(tmp_path):
    """An installed package has no commit."""
    said, _, _ = told([leave(tmp_path / "R1", record(commit=None, changed=None))])
    assert said == "by version 1.0 (wear code a)"


@pytest.fixture
def study(config):
    """A study of four runs, whose case tells which code counts."""
    return load_study("small", config.project)


def test_pages_and_figures_name_what_simulated(study, tmp_path):
    """Page, page in docs and the remark of each figure: the commit that simulated, and the part that is newer."""
    code = simulating_code(study.case)
    old = code | {
        "commit": "0123456789ab",
        "parts": code["parts"] | {"meshes": "older"},
        "date": "2026-11-20T10:00:00Z",
    }
    write_results(tmp_path, study)
    for run in study.runs:
        (tmp_path / run.name / "cycle_001" / "state.json").write_text(json.dumps({PROVENANCE: old}))
    page = page_of_results(tmp_path, study)
    assert "Simulated 2026-11-20 by commit 0123456789ab" in page
    assert page.count("<b>Older than the code:</b>") == 1 and "meshes (meshes)" in page
    remark = simulated_remark(study.case, tmp_path, [run.name for run in study.runs])
    assert remark.startswith("simulated by 01234567") and remark.endswith("(code newer since: meshes)")
    assert job_of({}, {}, ["reduced", remark]).remarks == ["reduced", remark]
    assert "by commit 0123456789ab" in " ".join(provenance(tmp_path, study).split())


def test_a_figure_takes_a_spot_check_into_account(study, tmp_path, monkeypatch):
    """Code that made the same numbers is not newer for it; the commit that simulated stays named."""
    code = simulating_code(study.case)
    old = code | {
        "commit": "0123456789ab",
        "parts": code["parts"] | {"meshes": "older"},
        "date": "2026-11-20T10:00:00Z",
    }
    leave(tmp_path / "small" / "R5_convex", old)
    monkeypatch.setattr(products, "DOCS", tmp_path)
    check = SpotCheck("small", "quick", "R5", "0123456789ab", "feedfacecafe", code, "2026-11-21", 3)
    for difference, newer in (("wear.csv", " (code newer since: meshes)"), ("", "")):
        keep_check(tmp_path, replace(check, difference=difference))
        remark = simulated_remark(study.case, tmp_path / "small", ["R5_convex"])
        assert remark == f"simulated by 01234567, 2026-11-20{newer}"


def test_a_study_not_yet_run_has_no_remark(study, tmp_path):
    """A figure that is made before any run has nothing to name."""
    assert simulated_remark(study.case, tmp_path, ["R5_convex"]) == ""
    assert job_of({}, {}, ["reduced", ""]).remarks == ["reduced"]


def test_page_in_docs_of_runs_without_records(study, tmp_path):
    """What was simulated before there were records says so."""
    leave_runs(study, tmp_path)
    assert UNRECORDED in " ".join(provenance(tmp_path, study).split())
