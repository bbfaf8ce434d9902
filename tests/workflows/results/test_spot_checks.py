"""What a spot check says of a page: the same numbers make it as new as the code that made them, others are told."""

from dataclasses import replace

import pytest

from bulkwear.workflows.report.provenance_of_pages import Change, Origin, older
from bulkwear.workflows.report.spot_checks import FILE, SpotCheck, SpotCheckError, keep_check, read_checks
from bulkwear.workflows.results.index import index_page

CODE = {"version": "1", "wear_version": 1, "commit": None, "changed": None}
FIRST, SECOND, NOW = ({**CODE, "parts": {"wear": wear}} for wear in "abc")
ORIGIN = Origin(
    "page.md",
    "pin_on_disc",
    study="pins",
    simulated=("2026-11-20 10:00", "2026-11-20 12:00"),
    versions=[{"runs": ["r"], "dates": ["2026-11-20", "2026-11-20"], "found": FIRST | {"commit": "first"}}],
)
TO_SECOND = SpotCheck("pins", "quick", "plain", "first", "second", SECOND | {"commit": "second"}, "2026-11-21", 3)
TO_NOW = replace(TO_SECOND, before="second", after="third", code=NOW | {"commit": "third"}, date="2026-11-22")


def test_checks_that_lead_to_todays_code_make_a_page_as_new():
    """One after the other; one that ends before leaves what is newer since then; of another study it says nothing."""
    assert older(ORIGIN, [], NOW, [TO_SECOND, TO_NOW]) == []
    (said,) = older(ORIGIN, [], NOW, [TO_SECOND])
    assert "with the same numbers as second in a spot check of plain at quick" in said and "Newer since then" in said
    assert older(ORIGIN, [], NOW, [replace(TO_SECOND, study="mills"), TO_NOW]) == older(ORIGIN, [], NOW)


def test_the_demo_speaks_for_pages_of_sliding_samples():
    """Of those named, also of a benchmark, which is of no study; not of clumps, and not of bulk tests, for which a
    shear box speaks.
    """
    sample = replace(ORIGIN, case="sliding_sample", study="screening")
    bench = replace(sample, study="", command="make it")
    checks = [replace(each, study="demo") for each in (TO_SECOND, TO_NOW)]
    assert older(sample, [], NOW, checks) == older(replace(bench, page="stiffness.md"), [], NOW, checks) == []
    assert older(replace(sample, study="grain_shape"), [], NOW, checks)
    box = replace(bench, page="tilted_bed_results.md")
    assert older(box, [], NOW, checks)
    assert older(box, [], NOW, [replace(each, study="calibration") for each in checks]) == []


def test_other_numbers_are_told_and_lead_nowhere():
    """A page whose check failed stays older than the code, and names the tables that differ."""
    differs = replace(TO_NOW, before="first", difference="pins/plain/wear.csv: volume differs by 0.01 of itself")
    warned, told = older(ORIGIN, [], NOW, [differs])
    assert "same numbers" not in warned
    assert "plain at quick by third differs from first in pins/plain/wear.csv" in told


def test_a_change_that_is_known_to_move_numbers_stays_known():
    """One row may not go through it."""
    change = Change("2026-11-21 00:00", "feedfacecafe", "edges", "pin_on_disc", "more contacts")
    (said,) = older(ORIGIN, [change], NOW, [TO_SECOND, TO_NOW])
    assert "feedfacecafe" in said


def test_checks_are_kept_and_listed(tmp_path):
    """A check done again replaces the earlier one; the list of pages names row, code and day; damage is told."""
    assert read_checks(tmp_path) == []
    for each in (TO_SECOND, TO_NOW, replace(TO_SECOND, tables=4)):
        keep_check(tmp_path, each)
    kept = read_checks(tmp_path)
    assert {each.after: each.tables for each in kept} == {"second": 4, "third": 3}
    (row,) = index_page([ORIGIN], lambda origin: older(origin, [], NOW, kept), [], kept).splitlines()[-1:]
    assert "| no | plain at quick by third, 2026-11-22 | none |" in row
    (tmp_path / FILE).write_text("[{}]")
    with pytest.raises(SpotCheckError, match="results_checks"):
        read_checks(tmp_path)
