"""What pages of studies ran of what their designs ask, and what nobody has run, with its cost."""

from dataclasses import replace

import pytest

from bulkwear.workflows.config.design import list_studies, load_study
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.report.markdown import config_words
from bulkwear.workflows.report.provenance_of_pages import Origin, read_origins
from bulkwear.workflows.report.text import number
from bulkwear.workflows.results.index import INDEX, of_studies
from bulkwear.workflows.results.not_run import NOT_RUN, NotRun, not_run_section
from bulkwear.workflows.results.ran import ran_row, ran_section, without_page
from tests import REPOSITORY

DOCS = REPOSITORY / "docs"
TRAVEL = {"travel_mm": 30}
PAGE = Origin(
    "screening_results_quick.md",
    "sliding_sample",
    study="screening",
    fidelity="quick",
    settings={"rows": ["R5", "R5-2", "R2"], "sliding": TRAVEL},
    versions=[{"runs": ["R5_convex", "R5_plain", "bed_R5"]}, {"runs": ["R5-2_convex", "R2_plain", "R99_plain"]}],
)


@pytest.fixture(scope="module")
def screening():
    return load_study("screening", overrides=PAGE.overrides)


def test_rows_run_are_settings_that_any_version_has_simulated(screening):
    """Their packings are counted; beds and rows that the design has no more are none; settings but rows are told."""
    row = ran_row(PAGE, screening)
    assert (row["rows run"], row["packings"], row["fidelity"]) == ("2 of 13", "1 to 2", "quick")
    assert row["set besides"] == '`sliding={"travel_mm": 30}`'


def test_runs_that_did_not_record_themselves_are_told_so(screening):
    """An old page names no runs."""
    row = ran_row(replace(PAGE, versions=[]), screening)
    assert (row["rows run"], row["packings"]) == ("not recorded, of 13", number(float("nan")))


def test_bulk_tests_are_no_rows():
    """A calibration counts its simulations, whatever boxes of other sizes its design has."""
    origin = Origin("page.md", "calibration", study="calibration", fidelity="quick", versions=[{"runs": ["a", "b"]}])
    assert ran_row(origin, load_study("calibration", overrides=origin.overrides))["rows run"] == "2 simulations"


def test_studies_without_a_page_are_named_by_fidelity():
    """Every study at each fidelity but that of its page; a picture of a study, and a page of none, say nothing."""
    said = without_page([PAGE]).replace("\n", " ")
    quick, standard, paper = said.removesuffix(".").split("; ")
    assert "`screening`" not in quick and all(f"`{name}`" in paper for name in list_studies())
    assert standard.startswith("at standard `") and "`screening`" in standard
    assert ran_section([replace(PAGE, figure="bed"), Origin("page.md", "pin_on_disc", command="make it")]) == ""


def test_what_was_not_run_is_forecast_by_its_command():
    """Dearer than a part of it; settings that a study does not take are refused."""
    cheap = NotRun("one row", "demo", {"fidelity": "quick", "rows": ["R5"], "packings": 1})
    section = not_run_section([cheap, replace(cheap, what="two rows", settings={"fidelity": "quick", "packings": 2})])
    rows = [line.split(" | ") for line in section.splitlines() if line.startswith(("| one", "| two"))]
    assert float(rows[0][1].split(";")[0]) < float(rows[1][1].split(";")[0])
    assert f"`snakemake demo_forecast{config_words(cheap.settings)}`" in rows[0][2]
    with pytest.raises(ConfigError, match="opening_mm is 45"):
        not_run_section([NotRun("square", "calibration", {"fidelity": "standard", "draw_down": {"opening": "square"}})])


def test_the_list_in_docs_is_of_the_pages_that_are_there():
    """The sections of docs/results.md were written from docs/results.json and the studies as they are."""
    assert (DOCS / INDEX).read_text(encoding="utf-8").endswith(of_studies(read_origins(DOCS)))
    assert {each.study for each in NOT_RUN} <= {*list_studies()}
