"""The page of a study for the docs: its provenance and durations, in Markdown."""

import shlex

import pandas as pd
import pytest

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report.markdown import (
    config_words,
    durations,
    fidelity_that_was_run,
    pictures_of,
    provenance,
    setting_of,
    study_that_was_run,
    write_results,
)
from bulkwear.workflows.report.markdown_text import Caption, markdown, written
from bulkwear.workflows.report.page_parameters import page_parameters
from bulkwear.workflows.report.products import figures_of
from bulkwear.workflows.report.sections import Pictures, Section, Text
from tests.support.finished_runs import leave_runs


def test_durations_stand_beside_their_forecast(tmp_path):
    """Wall time is that of all starts, measured over forecast that of the processor."""
    study = load_study("screening", overrides={"rows": ["R5", "R9"], "packings": 1})
    leave_runs(study, tmp_path)
    said = "\n".join(written(block, "screening_quick") for block in durations(tmp_path, page_parameters(study)))
    assert "| worn run R5 convex | 1 000 | 6 000 | 2.5 | 1 | 0.833 | 1.2 |" in said.replace("\u202f", " ")
    assert "took 10 minutes of wall time, 20.0 % of it outside the solver" in said


def test_provenance_names_solver_rows_and_remarks(tmp_path):
    """The solver's version, how many of the design's rows were run, and what is reduced."""
    study = load_study("screening", overrides={"rows": ["R5", "R9"], "packings": 1})
    leave_runs(study, tmp_path)
    said = " ".join(provenance(tmp_path, study).split())
    assert "LIGGGHTS-PUBLIC 3.8.0" in said and "4 runs of 2 rows" in said
    assert "particles at scale 1.25" in said


def test_runs_of_another_fidelity_make_no_page(tmp_path):
    """A page of standard from runs of quick is refused before anything is written."""
    (tmp_path / "forecast.csv").write_text("job,solver_s,fidelity\nworn_run_R5_plain,60,quick\n")
    assert fidelity_that_was_run(tmp_path) == "quick"
    study = load_study("screening", overrides={"fidelity": "standard", "packings": 1})
    with pytest.raises(ValueError, match=r"the study was run at quick, found --fidelity standard, allowed is quick\."):
        write_results(tmp_path, tmp_path / "docs", study)
    assert fidelity_that_was_run(tmp_path / "none") is None


def test_a_page_tells_the_settings_that_it_is_made_with():
    """As the command line takes them again."""
    settings = {"sliding": {"revolutions": 17}, "particle_scale": 4}
    _, words = config_words(settings).split(" --config ")
    assert dict(map(setting_of, shlex.split(words))) == settings
    assert config_words({}) == ""


def test_a_page_is_of_the_settings_that_were_run(tmp_path):
    """Those of the command line of Snakemake too, with the rows and packings of the design table."""
    folder = tmp_path / "screening"
    folder.mkdir()
    (folder / "design.csv").write_text("row,packing\nR5,1\nR5-2,2\n")
    settings = dict(map(setting_of, ["sliding={run_in_mm: 1000, travel_mm: 700}"]))
    study = study_that_was_run(folder, "standard", settings)
    assert (
        study.settings["sliding"]["run_in_mm"] == 1000 and [run.row for run in study.runs] == ["R5"] * 2 + ["R5-2"] * 2
    )
    with pytest.raises(ValueError, match="found 'sliding', allowed is KEY=VALUE"):
        setting_of("sliding")


@pytest.mark.parametrize(("rows", "there"), [(["R5"], False), (["R5", "R9"], True)])
def test_packings_of_one_row_have_no_second_row_of_views(rows, there):
    """They are rows of the design, and one setting."""
    study = load_study("screening", overrides={"fidelity": "standard", "rows": rows, "packings": 3})
    assert ("flow_views_second" in {each.name for each in figures_of(study)}) == there


def test_numbers_of_a_table_have_few_digits():
    """Three significant digits, or as many as are asked of a column; heads are words."""
    table = pd.DataFrame({"wear_volume_mm3": [1.23456], "share": [0.98765]})
    assert markdown(table, {"share": 4}).splitlines() == [
        "| wear volume mm3 | share |",
        "| --- | --- |",
        "| 1.23 | 0.9877 |",
    ]


def test_a_missing_figure_is_named_with_what_draws_it(tmp_path):
    """Figures are found in the order of the page, before anything of it is written."""
    sections = [
        Section("Wear", [Text("Depth."), Pictures(["depth", "volume"])]),
        Section("Flow", [Pictures(["power"])]),
    ]
    files = [tmp_path / "figures" / f"{name}.png" for name in ("depth", "volume", "power")]
    files[0].parent.mkdir()
    files[0].touch()
    with pytest.raises(FileNotFoundError, match=rf"^{files[1]} is missing; `snakemake {files[1]} {files[2]}` draws"):
        pictures_of(sections, tmp_path)
    for path in files:
        path.touch()
    assert pictures_of(sections, tmp_path) == files


def test_a_caption_says_first_what_the_figure_shows():
    """Then title and what is drawn; the finding is the alternative text, whose brackets would end it."""
    captions = {"depth": Caption("Worn depth", "A wears [most].", "Dots: runs."), "bed": Caption("Bed", "", "Dots.")}
    said = written(Pictures(["depth", "bed"]), "demo_quick", captions).split("\n\n")
    assert said[0] == "![A wears (most).](demo_quick_depth.png)"
    assert said[1].strip() == "**A wears [most].** Worn depth. Dots: runs."
    assert [each.strip() for each in said[2:]] == ["![Bed.](demo_quick_bed.png)", "**Bed.** Dots."]


def test_a_design_whose_rows_have_packings_of_their_own_is_found_again(tmp_path):
    """Rows that were run are chosen, their packings stand in the design: a setting of them is refused."""
    folder = tmp_path / "mill"
    folder.mkdir()
    pd.DataFrame({"run": ["n65"], "row": ["n65"], "packing": [1]}).to_csv(folder / "design.csv", index=False)
    assert [run.name for run in study_that_was_run(folder, "standard").runs] == ["n65"]
