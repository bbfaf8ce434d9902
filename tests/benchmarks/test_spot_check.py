"""Which versions a spot check holds against today's code, and what it makes of their tables; nothing simulates."""

from dataclasses import replace

import pandas as pd
import pytest

import benchmarks.spot_check as module
from benchmarks.rolling_models import parser_of
from bulkwear.workflows.cases.calibration.case import pairs_file
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.provenance import code_of_cases
from bulkwear.workflows.report.provenance_of_pages import Origin
from bulkwear.workflows.report.spot_checks import read_checks

CASE = "equipment"


@pytest.fixture
def now(monkeypatch):
    """Return today's code, as though it were committed."""
    code = code_of_cases((CASE,)) | {"commit": "today", "changed": False}
    monkeypatch.setattr(module, "code_of_cases", lambda cases: code)
    return code


@pytest.fixture
def page(now):
    """Return a page of two versions, one of today's code."""
    old = now | {"commit": "before", "parts": now["parts"] | {"wear": "other"}}
    versions = [{"runs": ["r"], "dates": ["2026-11-20"] * 2, "found": found} for found in (old, now)]
    return Origin("page.md", CASE, study="which_law", versions=versions)


def simulated(monkeypatch, folder, **volumes):
    """Let versions have simulated, each its volume."""
    runs = module.sample_of("which_law").runs
    for commit, volume in volumes.items():
        for run in runs:
            (folder / commit / run).mkdir(parents=True)
            pd.DataFrame({"volume_m3": [volume]}).to_csv(folder / commit / run / "wear.csv", index=False)
    monkeypatch.setattr(module, "solved", lambda commit, *given: folder / commit)


def test_the_version_that_is_older_is_checked_once(monkeypatch, now, page, tmp_path, capsys):
    """The same numbers are kept, and the version is then not asked for again."""
    simulated(monkeypatch, tmp_path, before=1.25, today=1.25)
    assert list(module.wanted(page, tmp_path)) == ["before"]
    assert module.check_pages([page], tmp_path, tmp_path)
    assert "before and today, 1 tables: the same numbers" in capsys.readouterr().out
    assert read_checks(tmp_path)[0].code["parts"] == now["parts"]
    assert not module.wanted(page, tmp_path)
    assert not module.wanted(replace(page, study=""), tmp_path)


def test_a_sum_in_another_order_is_no_difference(monkeypatch, page, tmp_path):
    """Numbers are the same but for round-off."""
    simulated(monkeypatch, tmp_path, before=1.25, today=1.25 * (1.0 + 0.5 * module.ROUND_OFF))
    assert module.check_pages([page], tmp_path, tmp_path)
    assert read_checks(tmp_path)[0].difference == ""


def test_commits_of_the_same_code_are_simulated_once(monkeypatch, page, tmp_path):
    """The other one's check names who simulated in its place, and both are as new as today's code."""
    (old, now_) = page.versions
    twin = old | {"found": old["found"] | {"commit": "twin"}}
    simulated(monkeypatch, tmp_path, before=1.25, today=1.25)
    assert module.check_pages([page, replace(page, versions=[twin, now_])], tmp_path, tmp_path)
    assert [(each.before, each.simulated_by) for each in read_checks(tmp_path)] == [("before", ""), ("twin", "before")]
    assert not module.wanted(replace(page, versions=[old, twin]), tmp_path)
    monkeypatch.setattr(module, "solved", None)  # what was checked before is not simulated again
    third = replace(page, versions=[old | {"found": old["found"] | {"commit": "third"}}])
    assert module.check_pages([third], tmp_path, tmp_path, [page])
    assert read_checks(tmp_path)[-1].before == "third"


def test_another_number_is_a_difference(monkeypatch, page, tmp_path):
    """It is kept with its table, and asked for again."""
    simulated(monkeypatch, tmp_path, before=1.25, today=1.25 * (1.0 + 2.0 * module.ROUND_OFF))
    assert not module.check_pages([page], tmp_path, tmp_path)
    assert "wear.csv: volume_m3 differs" in read_checks(tmp_path)[0].difference
    assert list(module.wanted(page, tmp_path)) == ["before"]


def test_code_that_is_not_committed_and_runs_without_tables_are_refused(monkeypatch, now, page, tmp_path):
    """A check of what nobody can look up says nothing, nor does one of beds alone."""
    simulated(monkeypatch, tmp_path, before=1.25)
    (run,) = module.sample_of("which_law").runs
    (tmp_path / "before" / run).rename(tmp_path / "before" / "bed_1")
    with pytest.raises(module.VersionError, match=f"found no wear.csv of {run}"):
        module.spot_check(page, "before", tmp_path)
    monkeypatch.setattr(module, "code_of_cases", lambda cases: now | {"changed": True})
    with pytest.raises(module.VersionError, match="not committed"):
        module.spot_check(page, "before", tmp_path)


def test_the_runs_of_one_packing_of_the_first_row_are_asked_for(monkeypatch, tmp_path):
    """By the files of its runs, in the clone of that commit."""
    called = []
    monkeypatch.setattr(module, "_call", lambda command, where: called.append((command, where)))
    sample = module.sample_of("demo")
    assert (sample.row, sample.runs) == ("R5", ("R5_convex", "R5_plain"))
    (tmp_path / "before").mkdir()
    assert module.solved("before", sample, tmp_path) == tmp_path / "before/results/demo"
    command, where = called[-1]
    assert where == tmp_path / "before"
    assert {"results/demo/R5_convex/wear.csv", "results/demo/R5_plain/wear.csv", "packings=1"} <= set(command)


def test_of_bulk_tests_a_shear_box_is_asked_for(monkeypatch, tmp_path):
    """By a command that the benchmark itself takes, into the folder whose tables are compared."""
    called = []
    monkeypatch.setattr(module, "_call", lambda command, where: called.append(command))
    sample = module.sample_of("calibration")
    (tmp_path / "before").mkdir()
    place = module.solved("before", sample, tmp_path)
    words = called[-1][list(called[-1]).index("benchmarks.rolling_models") + 1 :]
    published = pd.read_csv(pairs_file(load_study("calibration")))
    monkeypatch.chdir(tmp_path)  # where the parser makes the folder of the output
    given = parser_of(published).parse_args(words)
    assert (given.tests, given.pairs, given.packings) == (["shear_box"], ["calibrated"], 1)
    assert tmp_path / "before" / given.folder == tmp_path / "before" / given.output == place / sample.runs[0]
    assert (place / sample.runs[0]).is_dir()
