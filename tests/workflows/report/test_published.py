"""Published numbers beside ours: tables of pages in one set of columns, and the page of all of them."""

import math

import pandas as pd
import pytest

from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.postproc.statistics.verdicts import AGREES, CONTRADICTS, OTHER_SIZE, UNSAID
from bulkwear.workflows.config.claims import ABOUT, about
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.report.provenance_of_pages import Origin
from bulkwear.workflows.report.published import (
    COLUMNS,
    GIVEN,
    NOT_COMPUTED,
    published_file,
    published_numbers,
    write_published_numbers,
)
from bulkwear.workflows.report.sections import Section, Table, Text
from bulkwear.workflows.report.text import number
from bulkwear.workflows.results.not_compared import CHAPTERS, not_compared, read_not_compared
from bulkwear.workflows.results.published_numbers import (
    PAGE,
    UNKNOWN_CAUSE,
    known_differences,
    published_page,
    with_causes,
)
from tests import REPOSITORY

SAID = {"found": "0.9 (0.8 to 1.0)", "verdict": AGREES, "reason": None, "factor": math.nan, "source": "Yan 2022"}
CLAIM = {"verdict": AGREES, "finding": "It is so", "claim": "above 1", **SAID}
NUMBER = {
    "quantity": "critical_scale",
    "surface": "convex",
    "scales": "4",
    "relation": "about",
    "value": 4.0,
    "unit": "-",
}
VALUE = {"quantity": "toe_pristine", "setting": "n77", "unit": "degrees", "published_value": 128.0, "source": "Kalala"}
DOCS = REPOSITORY / "docs"


def section(*tables, beside=True):
    return Section("Numbers", [Text("said"), *(Table(pd.DataFrame([row]), beside_source=beside) for row in tables)])


def test_tables_of_three_kinds_are_told_alike():
    """Claims, numbers with a relation, values beside values: one set of columns, in the order of the page."""
    table = published_numbers([section(CLAIM), section(NUMBER | SAID), section(VALUE | {"computed_value": 130.0})])
    assert list(table) == COLUMNS
    assert table["finding"].tolist() == ["It is so", "critical scale, convex", "toe pristine, n77"]
    assert table["published"].tolist() == ["above 1", "about 4 at scale 4", "128 degrees"]
    assert table["reason"].tolist()[:2] == ["", ""]


def test_a_claim_of_several_runs_tells_of_which():
    assert published_numbers([section(CLAIM | {"of": "conserving, removed"})])["finding"].tolist() == [
        "It is so, conserving, removed"
    ]


def test_a_table_may_have_its_numbers_beside_it():
    """One that shows them in columns of its own; without any it leaves no line."""
    shown, beside = pd.DataFrame({"hours": [56.0]}), pd.DataFrame([VALUE | {"computed_value": 130.0}])
    found = published_numbers([Section("Hours", [Table(shown, beside_source=beside)])])
    assert found["finding"].tolist() == ["toe pristine, n77"]
    assert published_numbers([Section("Hours", [Table(shown, beside_source=beside[:0])])]).empty


def test_tables_that_are_not_marked_are_left_out():
    """Not every table with a source is a comparison."""
    assert published_numbers([section(CLAIM, beside=False)]).empty


@pytest.mark.parametrize(
    ("computed", "low", "high", "verdict"),
    [
        (130.0, 126.0, 134.0, AGREES),
        (170.0, 165.0, 175.0, OTHER_SIZE),
        (146.0, 140.0, 152.0, UNSAID),  # past the end of the margin, 147.2
        (130.0, math.nan, math.nan, UNSAID),
    ],
)
def test_values_are_judged_by_the_margin_of_about(computed, low, high, verdict):
    """Inside 15 %, outside, across its end, and of one packing."""
    ours = {"computed_value": computed, "computed_low": low, "computed_high": high}
    row = published_numbers([section(VALUE | ours)]).iloc[0]
    assert row["verdict"] == verdict and row["factor"] == pytest.approx(computed / 128.0, rel=1e-12)


def test_a_margin_of_its_own_counts():
    """Narrower than 15 %: what agreed is of another size; the study's own reason stands behind."""
    ours = {"computed_value": 130.0, "computed_low": 129.5, "computed_high": 130.5, "margin": 1.0, "reason": "balls"}
    row = published_numbers([section(VALUE | ours)]).iloc[0]
    assert row["verdict"] == OTHER_SIZE and row["reason"] == "balls"
    assert about("x", 2.0, 2.0, "").margin == 2.0 * ABOUT and about("x", -2.0, -2.0, "").direction == "below"


def test_one_packing_decides_nothing_and_what_is_given_is_no_result():
    """An interval over the blocks of one packing is none; a value that was put in has no verdict."""
    ours = {"computed_value": 130.0, "computed_low": 126.0, "computed_high": 134.0}
    found = published_numbers([section(VALUE | ours | extra) for extra in ({"packings": 3.0}, {"packings": 1.0})])
    assert found["verdict"].tolist() == [AGREES, UNSAID] and found["reason"].iloc[1] == UNKNOWN
    row = published_numbers([section(VALUE | ours | {"given": "given"})]).iloc[0]
    assert (row["verdict"], row["found"], row["factor"]) == (GIVEN, "130 degrees", pytest.approx(130.0 / 128.0))


def test_what_the_study_does_not_compute_is_told():
    """It is no contradiction."""
    row = published_numbers([section(VALUE | {"computed_value": math.nan})]).iloc[0]
    assert (row["verdict"], row["reason"]) == (UNSAID, NOT_COMPUTED)


def test_a_published_range_is_a_magnitude():
    """Its margin is that of its middle; a table may have no column of single values at all."""
    ranged = {name: value for name, value in VALUE.items() if name != "published_value"}
    ranged |= {"published_low": 1.0, "published_high": 2.0, "computed_value": 2.1}
    sure = published_numbers([section(ranged | {"computed_low": 2.05, "computed_high": 2.2})]).iloc[0]
    assert (sure["published"], sure["verdict"]) == ("1 to 2 degrees", AGREES)  # up to 2.225
    assert published_numbers([section(ranged)])["verdict"].tolist() == [UNSAID]


RANGE = {**{name: value for name, value in VALUE.items() if name != "published_value"}, "unit": "weeks"}


def told_of(**row):
    """Return the line of one value whose interval is 2 % to both sides."""
    ours = row["computed_value"]
    ends = sorted((0.98 * ours, 1.02 * ours))
    return published_numbers([section(RANGE | row | {"computed_low": ends[0], "computed_high": ends[1]})]).iloc[0]


def test_what_is_beyond_a_published_range_has_a_factor():
    """Over the end that it is beyond; inside there is none."""
    ends = {"published_low": 4.0, "published_high": 8.0}
    for computed, end in ((12.6, 8.0), (2.0, 4.0)):
        row = told_of(**ends, computed_value=computed)
        assert row["verdict"] == OTHER_SIZE and row["factor"] == pytest.approx(computed / end, rel=1e-12)
    assert math.isnan(told_of(**ends, computed_value=6.0)["factor"])


def test_a_range_beside_a_published_value_is_what_is_claimed():
    """Ours at an end of it agrees, though it is more than 15 % off the value, over which the factor is told."""
    row = told_of(published_value=6.0, published_low=4.0, published_high=8.0, computed_value=7.9)
    assert (row["published"], row["verdict"]) == ("6 (4 to 8) weeks", AGREES)
    assert row["factor"] == pytest.approx(7.9 / 6.0, rel=1e-12)


@pytest.mark.parametrize(
    ("ends", "words", "inside", "outside", "verdict"),
    [
        ({"published_low": 4.0}, "4 or more weeks", 40.0, 3.0, OTHER_SIZE),
        ({"published_high": 8.0}, "up to 8 weeks", 1.0, 10.0, CONTRADICTS),
    ],
)
def test_a_range_with_one_end_is_open_at_the_other(ends, words, inside, outside, verdict):
    """What is told as up to something has no sign of its own."""
    row = told_of(**ends, computed_value=inside)
    assert (row["published"], row["verdict"]) == (words, AGREES)
    assert told_of(**ends, computed_value=outside)["verdict"] == verdict


@pytest.mark.parametrize(
    "told",
    [
        {"published_low": -5.0, "published_high": 5.0},
        {"published_value": 0.0, "margin": 5.0},
        {"published_value": 2.0, "margin": 7.0},
    ],
)
def test_what_agrees_on_both_sides_of_nothing_claims_no_sign(told):
    """A range or a margin of its own that holds 0: either sign inside agrees, outside contradicts."""
    verdicts = [told_of(**told, computed_value=value)["verdict"] for value in (1.0, -1.0, -20.0, 20.0)]
    assert verdicts == [AGREES, AGREES, CONTRADICTS, CONTRADICTS]


def test_the_page_has_the_numbers_of_every_page_that_left_some(tmp_path):
    """Counts of the verdicts first; a page without published numbers leaves no file and has no section."""
    origins = [Origin("a_results_quick.md", "equipment"), Origin("b_results_quick.md", "equipment")]
    write_published_numbers(tmp_path, origins[0].page, [section(CLAIM), section(NUMBER | SAID)])
    write_published_numbers(tmp_path, origins[1].page, [section(CLAIM, beside=False)])
    assert [path.name for path in (tmp_path / "published").iterdir()] == ["a_results_quick.csv"]
    page = published_page(tmp_path, origins)
    assert "| [a_results_quick.md](a_results_quick.md) | 2 | 2 | 0 | 0 | 0 | 0 |" in page
    none = number(math.nan)
    assert f"| critical scale, convex | about 4 at scale 4 | 0.9 (0.8 to 1.0) | {none} | agrees |  | Yan 2022 |" in page
    assert "b results" not in page


def test_pages_stand_by_chapter_and_what_is_not_compared_stands_behind(tmp_path):
    """Chapters in their order, machines last; numbers that are not compared are counted at the top."""
    origins = [Origin(f"{name}_results_quick.md", "equipment") for name in ("mill", "tester", "pin")]
    for origin, source in zip(origins, ("Kalala 2008", "Yan 2022, Eq 6.2", "Yan 2022, Table 5.4"), strict=True):
        write_published_numbers(tmp_path, origin.page, [section(CLAIM | {"source": source})])
    page = published_page(tmp_path, origins)
    heads = [line for line in page.splitlines() if line.startswith("#")]
    assert heads[1:7] == [
        "## Chapter 5: pin on disc",
        "### pin results quick",
        "## Chapter 6: circular wear tester",
        "### tester results quick",
        "## Machines",
        "### mill results quick",
    ]
    assert heads[7:] == ["## Published, not compared"] + [
        f"### {title}, not compared" for chapter, title in CHAPTERS.items() if chapter
    ]
    overview = page[: page.index("## ")]
    assert overview.index("(pin_results") < overview.index("(tester_results") < overview.index("(mill_results")
    left = not_compared(["It is so"] * 3, read_not_compared())
    assert f"Further {left['numbers'].sum()} published numbers are [not compared](#published-not-compared)" in overview
    assert f"{left.loc[left['chapter'] == 4, 'numbers'].sum()} of chapter 4" in overview


def test_a_page_without_published_numbers_leaves_none_of_an_earlier_one(tmp_path):
    """The table that it once left is removed; a page that never had one changes nothing."""
    for sections, there in (([section(CLAIM)], True), ([], False), ([], False)):
        write_published_numbers(tmp_path, "a_results_quick.md", sections)
        assert (tmp_path / published_file("a_results_quick.md")).is_file() == there


def test_the_page_in_docs_is_that_of_its_tables():
    """Tables, the list of pages and the page of all numbers were committed together."""
    from bulkwear.workflows.report.provenance_of_pages import read_origins

    origins = read_origins(DOCS)
    assert (DOCS / PAGE).read_text(encoding="utf-8") == published_page(DOCS, origins)
    known = {published_file(each.page) for each in origins}
    assert {str(path.relative_to(DOCS)) for path in (DOCS / "published").glob("*.csv")} <= known


def test_differences_have_a_reason_or_are_said_to_have_none():
    """The page's own first; then the first line that fits page and finding, a candidate where no page shows it."""
    own, shown, guessed, none = "the page's own", "critical scale", "coordination number", "velocity"
    table = pd.DataFrame(
        {
            "finding": [shown, shown, guessed, none, none],
            "verdict": [OTHER_SIZE, CONTRADICTS, CONTRADICTS, OTHER_SIZE, AGREES],
            "reason": [own, "", "", "", ""],
        }
    )
    known = [
        {"page": ("z", "a"), "finding": "critical", "cause": "sizes", "shown": "sizes.md"},
        {"page": "", "finding": "c", "cause": "beds"},
    ]
    found = with_causes("a_results_quick.md", table, known)["reason"]
    assert found.tolist() == [own, "sizes ([shown](sizes.md))", "candidate: beds", UNKNOWN_CAUSE, ""]
    assert with_causes("b.md", table, known)["reason"].iloc[1] == "candidate: beds"


def test_lines_of_differences_are_of_pages_that_there_are(tmp_path):
    """Those that measured a cause too; a line with another key is refused."""
    pages = [path.name for path in DOCS.glob("*.md")]
    for line in known_differences():
        for name in line["page"]:
            assert any(page.startswith(name) for page in pages)
        assert line.get("shown", PAGE) in pages
    (tmp_path / "differences.yaml").write_text("differences: [{page: a, finding: b, why: c}]\n")
    with pytest.raises(
        ConfigError, match=r"line 1 has page, finding, why, allowed are cause, finding, page and, if any,"
    ):
        known_differences(tmp_path / "differences.yaml")
