"""Where the pages in docs come from, what of the code is newer, and what remaking them does and tells."""

import json
import os
import subprocess
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from bulkwear.workflows.config.design import list_studies, load_study
from bulkwear.workflows.engine.provenance import PROVENANCE, code_of_cases
from bulkwear.workflows.forecast.forecast import work_of
from bulkwear.workflows.report.provenance_of_pages import (
    Change,
    Origin,
    ResultsError,
    keep_origin,
    older,
    read_changes,
    read_origins,
    recorded,
    versions_in,
    with_banner,
    write_origins,
)
from bulkwear.workflows.report.simulated import Simulated, version_name
from bulkwear.workflows.results import commands, index
from bulkwear.workflows.results import remake as module
from bulkwear.workflows.results.index import index_page
from tests import REPOSITORY

DOCS = REPOSITORY / "docs"
NOW = {"version": "1", "wear_version": 1, "commit": None, "changed": None, "parts": {"wear": "a", "meshes": "b"}}
OLD = Origin("page.md", "pin_on_disc", simulated=("2026-11-20 10:00", "2026-11-20 12:00"), commits=["0123456789ab"])
NEW = replace(OLD, versions=[{"runs": ["r"], "dates": ["2026-11-20", "2026-11-20"], "found": NOW}], commits=[])
TEXT = "# Title\n\nGenerated.\n\n## Section\n\nWords.\n"


def test_every_page_of_results_is_listed_and_there():
    """Each page of results in docs has its origin; each origin has its file, and a known study or a command."""
    origins = read_origins(DOCS)
    assert {path.name for path in DOCS.glob("*_results*.md")} <= {each.page for each in origins}
    for each in origins:
        assert (DOCS / each.page).is_file() and (each.study in list_studies()) != bool(each.command)
        assert each.versions or each.commits
    cases = {each.case for each in origins}
    for change in read_changes(DOCS):
        assert {*change.concerns.split()} <= cases | {each.page for each in origins}


def test_known_changes_are_commits():
    """Each change that is told of a page is one of the repository's commits, made at the time that is told."""
    git = ("git", "-C", str(DOCS.parent))
    if (
        subprocess.run([*git, "rev-parse", "--is-shallow-repository"], capture_output=True, text=True).stdout
        != "false\n"
    ):
        pytest.skip("no whole history here")
    for change in read_changes(DOCS):
        shown = ("show", "--no-patch", "--format=%cd", "--date=format-local:%Y-%m-%d %H:%M", change.commit)
        utc = os.environ | {"TZ": "UTC"}
        found = subprocess.run([*git, *shown], capture_output=True, text=True, check=True, env=utc)
        assert found.stdout.strip() == change.date, change


@pytest.mark.parametrize(
    ("date", "concerns", "told"),
    [
        ("2026-11-20 09:59", "pin_on_disc", None),
        ("2026-11-20 11:00", "sliding_sample pin_on_disc", "While it was simulated"),
        ("2026-11-20 12:01", "page.md", "Since then"),
        ("2026-11-20 12:01", "sliding_sample other.md", None),
    ],
)
def test_a_known_change_is_told_where_it_came_later_and_concerns_the_page(date, concerns, told):
    """By case or page; before, while or after the page's simulations. The page that recorded nothing says so too."""
    change = Change(date, "feedfacecafe", "edges", concerns, "more contacts")
    first, *rest = older(OLD, [change], NOW)
    assert "did not record itself" in first and "0123456789ab" in first
    assert [sentence for sentence in rest if "feedfacecafe" in sentence][:1] == (
        [f"{told}, {date} UTC (feedfacecafe), edges: more contacts."] if told else []
    )


def test_a_page_of_the_present_code_has_no_warning_and_one_of_older_code_names_the_part():
    """Hashes decide, whatever the date; a known change is told beside a part that differs only."""
    change = Change("2026-11-21 00:00", "feedfacecafe", "edges", "pin_on_disc", "more contacts")
    assert older(NEW, [change], NOW) == []
    differs, known = older(NEW, [change], NOW | {"parts": {"wear": "a", "meshes": "c"}})
    assert "Newer since then: meshes" in differs and "feedfacecafe" in known


def test_a_warning_stands_below_the_title_once_and_goes_again():
    """A second warning takes the place of the first, and no warning leaves the page as it was."""
    warned = with_banner(TEXT, ["One thing is newer."])
    assert warned.splitlines()[:4] == ["# Title", "", *warned.splitlines()[2:4]]
    assert "> **Older than the code.** One thing is newer." in warned and warned.endswith(
        "Generated.\n\n## Section\n\nWords.\n"
    )
    again = with_banner(warned, ["Another thing is newer."])
    assert "One thing" not in again and again.count("Older than the code.") == 1
    assert with_banner(again, []) == TEXT == with_banner(TEXT, [])


def test_what_is_known_of_a_page_is_renewed_but_its_settings_stay(tmp_path):
    """A page that is written again keeps how it is made; a page not known before is added."""
    made = replace(OLD, settings={"rows": ["R5"]}, command="make it", runs="results/x")
    write_origins(tmp_path, [made])
    keep_origin(tmp_path, NEW)
    keep_origin(tmp_path, replace(NEW, page="other.md"))
    renewed, added = read_origins(tmp_path)
    assert (renewed.settings, renewed.command, renewed.runs) == (made.settings, made.command, made.runs)
    assert renewed.versions and added.page == "other.md"
    (tmp_path / "results.json").write_text("[{}]")
    with pytest.raises(ResultsError, match=r"results\.json"):
        read_origins(tmp_path)


def test_a_study_is_known_by_the_settings_of_its_page(tmp_path):
    """Once whole it has no rows: it would be written of the first ones alone again. So it is with any setting."""
    few = replace(OLD, study="demo", settings={"rows": ["R5"], "packings": 1, "solver": {"search": "ours"}})
    write_origins(tmp_path, [few])
    keep_origin(tmp_path, replace(few, settings={"packings": 2}))
    assert read_origins(tmp_path)[0].settings == {"packings": 2}


def test_pending_files_are_those_of_the_summary_that_would_be_made():
    """Rule and file of each line with an update planned."""
    head = "output_file\tdate\trule\tlog-file(s)\tstatus\tplan"
    rows = ["results/s/a.csv\t-\tone\t-\tok\tno update", "results/s/b.csv\t-\ttwo\t-\tmissing\tupdate pending"]
    assert module.pending_files("\n".join([head, *rows])) == [("two", "results/s/b.csv")]


def test_jobs_are_known_by_the_files_they_make():
    """Of runs and beds by their folders, of other jobs by their rule; what is not pending costs nothing."""
    study = load_study("demo", overrides={"packings": 1})
    (bed,), (run, other) = study.beds, (each.name for each in study.runs)
    names = {job.name for job in work_of(study)}
    assert {job.name for job in module.missing_work(study, None)} == names
    pending = [("worn_run", f"results/demo/{run}/wear.csv"), ("figure_x", f"results/demo/figures/{other}.png")]
    assert [job.name for job in module.missing_work(study, pending)] == [f"worn_run_{run}"]
    bedded = [("settled_bed", f"results/demo/beds/{bed}/bed.restart")]
    assert [job.name for job in module.missing_work(study, bedded)] == [f"settled_bed_{bed}"]
    calibration = load_study("calibration")
    boxes = [("box_sizes", "results/calibration/box_sizes.csv")]
    assert [job.name for job in module.missing_work(calibration, boxes)] == ["box_sizes"]


@pytest.fixture
def done(monkeypatch, tmp_path):
    """What a remake of a study's page does instead of simulating and writing; the list of what it did."""
    found = []
    monkeypatch.setattr(module, "call", lambda command: found.append("made"))
    monkeypatch.setattr(
        module, "write_results", lambda folder, docs, study, settings: found.append(f"page of {folder}")
    )
    monkeypatch.chdir(tmp_path)
    return found


DEMO = Origin("demo_results_quick.md", "sliding_sample", "demo", settings={"packings": 1})
RUN = ("worn_run", "results/demo/R5_convex/wear.csv")
FIGURE = ("figure_forces", "results/demo/figures/forces.png")
PAGE = "page of results/demo"


@pytest.mark.parametrize(
    ("pending", "run", "expected"),
    [
        (None, False, []),
        ([RUN, FIGURE], False, []),
        ([RUN, FIGURE], True, ["made", PAGE]),
        (None, True, ["made", PAGE]),
        ([FIGURE], False, ["made", PAGE]),
        ([], False, [PAGE]),
    ],
)
def test_nothing_is_simulated_unless_asked(monkeypatch, done, pending, run, expected, tmp_path):
    """Missing runs are forecast with the command that redoes them; figures alone are made, finished ones written."""
    monkeypatch.setattr(module, "pending_of", lambda origin, cores: pending)
    said = module.remake_study(DEMO, tmp_path, 2, run)
    assert done == expected
    assert ("make results RUN=1 PAGE=demo_results_quick" in said and "core hours" in said) == (expected == [])


def test_runs_of_another_fidelity_are_not_those_of_the_page(monkeypatch, done, tmp_path):
    """They are taken for none, however finished."""
    monkeypatch.setattr(module, "pending_of", lambda origin, cores: [])
    monkeypatch.setattr(module, "fidelity_that_was_run", lambda folder: "paper")
    said = module.remake_study(DEMO, tmp_path, 2, False)
    assert "jobs of the solver are not done in results/demo" in said and done == []


@pytest.mark.parametrize(("run", "older"), [(False, True), (True, True), (True, False)])
def test_runs_begun_by_older_code_are_told_before_they_go_on(monkeypatch, done, tmp_path, capsys, run, older):
    """With what to move for a page of one version; nothing is said of runs of the present code."""
    code = code_of_cases(("sliding_sample",)) | {"date": "2026-11-22T10:00:00Z"}
    code = code | {"parts": code["parts"] | ({"solver": "another"} if older else {})}
    state = Path("results/demo/R5_convex/cycle_001/state.json")
    state.parent.mkdir(parents=True)
    state.write_text(json.dumps({PROVENANCE: code}))
    monkeypatch.setattr(module, "pending_of", lambda origin, cores: [RUN])
    monkeypatch.setattr(module, "fidelity_that_was_run", lambda folder: "quick")
    said = module.remake_study(DEMO, tmp_path, 2, run) + capsys.readouterr().err
    told = "R5_convex: simulated by" in said and "the page is of both" in said and "move results/demo away" in said
    assert told == older


def test_a_page_of_a_command_is_renewed_from_its_simulations(done, tmp_path):
    """Written since its last run: their versions and cost are kept; with a newer run it is not its page."""
    code = code_of_cases(("pin_on_disc",)) | {"date": "2026-11-22T10:00:00Z"}
    origin = replace(OLD, command="make it", runs=str(tmp_path / "runs"))
    state = tmp_path / "runs" / "one" / "cycle_001" / "state.json"
    state.parent.mkdir(parents=True)
    state.write_text(json.dumps({PROVENANCE: code, "cost": {"processor_s": 3600.0}}))
    (tmp_path / origin.page).write_text(TEXT)
    write_origins(tmp_path, [origin])
    assert "written from" in commands.remake_by_command(origin, tmp_path, False)
    (kept,) = read_origins(tmp_path)
    assert (kept.core_hours, kept.versions[0]["runs"], kept.command) == (1.0, ["one"], "make it")
    assert older(kept, [], code_of_cases(("pin_on_disc",))) == []
    newer = (tmp_path / origin.page).stat().st_mtime + 1.0
    os.utime(state, (newer, newer))
    assert "its cost was not kept" in commands.remake_by_command(origin, tmp_path, False)
    index.mark(tmp_path, [])  # it writes into pages too
    table = commands.table_file(origin, tmp_path)
    table.write_text("a\n1\n")
    os.utime(table, (newer - 2.0, newer - 2.0))
    os.utime(tmp_path / origin.page, (newer + 2.0, newer + 2.0))
    assert "its cost was not kept" in commands.remake_by_command(origin, tmp_path, False)
    assert done == []


def test_earlier_versions_stay_with_their_rows(tmp_path):
    """Of a table to which another clone's runs were added both versions stand; one whose rows are gone does not."""
    code = code_of_cases(("pin_on_disc",)) | {"date": "2026-11-22T10:00:00Z"}
    earlier, gone = (code | {"commit": commit, "changed": False} for commit in ("aaaaaaaaaaaa", "bbbbbbbbbbbb"))
    now = Simulated(version_name(code), ("new", "again"), code, ("2026-11-22", "2026-11-22"))
    before = [
        Simulated(version_name(each), runs, each, ("2026-11-20", "2026-11-21"))
        for each, runs in ((earlier, ("old", "again")), (gone, ("lost",)))
    ]
    page = replace(OLD, page="candidates_results.md", simulated=("2026-11-20 10:00", "2026-11-21 10:00"))
    rows = {commands.BY: [now.name, now.name, before[0].name], commands.COST: [1800.0, 1800.0, 3600.0]}
    pd.DataFrame(rows).to_csv(tmp_path / "candidates.csv", index=False)
    here = replace(page, versions=recorded([now]), simulated=("2026-11-22 10:00", "2026-11-22 11:00"), core_hours=1.0)
    found = commands.with_earlier(here, replace(page, versions=recorded(before)), tmp_path)
    assert [(each.name, each.runs) for each in versions_in(found)] == [
        (now.name, ("new", "again")),
        (before[0].name, ("old",)),
    ]
    assert found.simulated == ("2026-11-20 10:00", "2026-11-22 11:00") and found.core_hours == 2.0
    (tmp_path / "candidates.csv").unlink()
    assert commands.with_earlier(here, replace(page, versions=recorded(before)), tmp_path) == here


def test_faults_of_a_page_are_told_beside_the_others(monkeypatch, tmp_path, capsys):
    """One page that cannot be remade goes to standard error, the next one is done; the list of pages is written."""
    write_origins(tmp_path, [replace(DEMO, study="no_such_study"), replace(OLD, command="make it")])
    (tmp_path / "results_changes.csv").write_text("date,commit,part,concerns,change\n")
    (tmp_path / OLD.page).write_text(TEXT)
    module.remake(tmp_path, "", False, 2)
    told = capsys.readouterr()
    assert told.err.startswith(f"{DEMO.page}: ") and "no_such_study" in told.err
    assert f"{OLD.page}: older than the code; " in told.out
    assert "Older than the code" in (tmp_path / OLD.page).read_text()
    index = (tmp_path / "results.md").read_text()
    assert f"[{OLD.page}]" in index and f"[{DEMO.page}]" in index
    with pytest.raises(ResultsError, match=r"PAGE is none, allowed is one of demo_results_quick, page\."):
        module.remake(tmp_path, "none", False, 2)


def test_finished_runs_of_older_code_are_told_with_what_doing_them_again_costs(monkeypatch, tmp_path, capsys):
    """A page whose runs are there is written, and says how to simulate them anew where the code is newer."""
    write_origins(tmp_path, [DEMO])
    (tmp_path / "results_changes.csv").write_text("date,commit,part,concerns,change\n")
    monkeypatch.setattr(module, "remake_study", lambda *given: "written from results/demo")
    module.remake(tmp_path, "", False, 2)
    (told,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith(DEMO.page)]
    assert "older than the code; written from results/demo, whose runs no job does again" in told
    assert "core hours" in told and "move results/demo away: make results RUN=1 PAGE=demo_results_quick" in told


def test_the_list_of_pages_names_what_moved_their_numbers():
    """The part of each known change that a page's sentences name."""
    change = Change("2026-11-21 00:00", "feedfacecafe", "edges", "pin_on_disc", "more contacts")
    page = index_page([OLD, NEW], lambda origin: older(origin, [change], NOW), [change])
    old, new = page.splitlines()[-2:]
    assert "| yes |  | edges |" in old and "0123456789ab, by the time" in old
    assert "| no |  | none |" in new and Path(OLD.page).stem in new
    within = replace(OLD, commits=["feedfacecafe"], simulated=("2026-11-21 01:00", "2026-11-21 02:00"))
    (row,) = index_page([within], lambda origin: older(origin, [change], NOW), [change]).splitlines()[-1:]
    assert "feedfacecafe, by the time" in row and "| yes |  | none |" in row  # simulated by the change itself
