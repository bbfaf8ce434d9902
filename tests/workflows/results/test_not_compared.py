"""Published numbers that are not compared: every number of the tables is told by a page, or is listed with a reason."""

import re

import pandas as pd
import pytest

from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.results.not_compared import (
    A_NUMBER,
    COLUMNS,
    LIST,
    NUMBERS,
    chapter_of,
    finding_of,
    is_found,
    lines_for,
    not_compared,
    published_cells,
    read_not_compared,
)
from bulkwear.workflows.results.published_numbers import read_published
from tests import REPOSITORY

TABLES = REPOSITORY / "config/published"
UNITS = {"deg": "°", "-": ""}  # of tables, as pages have them; mm³ and mm3 are one
OF_NAMES = {"deg": "deg", "mm3": "mm3", "s": "s"}  # of columns
CLAIMED = re.compile(r"\(published (?P<numbers>[^)]*)\)(?P<unit>[^,]*)")
PLACE = re.compile(r"\d\.\d+(?:\.\d+)*")  # section, table, figure or equation of the source
SAME = 1e-9  # -, of two readings of one printed number


def told_in_docs():
    """Return the published numbers of all pages."""
    tables = [read_published(path) for path in sorted((REPOSITORY / "docs/published").glob("*.csv"))]
    return pd.concat(tables, ignore_index=True).to_dict("records")


def claimed_numbers(published):
    """Return what is published without margins and without the range that it is claimed for, as text."""
    published = published.replace("mm³", "mm3")
    claimed = CLAIMED.search(published)
    return f"{claimed['numbers']}{claimed['unit']}" if claimed else re.split(r", for | at scale ", published)[0]


def unit_of(cell):
    """Return the unit of a number: of its row, else of its column's name."""
    if cell.column in ("value", "uncertainty", "low", "high") and "unit" in cell.row:
        return cell.row["unit"]
    response = cell.row.get("response", cell.column)
    return next((unit for name, unit in OF_NAMES.items() if re.search(rf"_{name}(_|$)", response)), "-")


def parsed(told):
    """Return (places and whole source, published text) of what pages tell."""
    return [({*PLACE.findall(row["source"]), row["source"]}, claimed_numbers(row["published"])) for row in told]


def is_told(cell, told):
    """Whether a page tells a number with its unit, from the same place of the source; told: as from `parsed`."""
    places, value = {*PLACE.findall(cell.row["source"]), cell.row["source"]}, float(cell.text)
    unit = UNITS.get(unit_of(cell), unit_of(cell))
    for theirs, text in told:
        if places & theirs and (text.endswith(unit) if unit else text[-1:] in "0123456789)"):
            numbers = A_NUMBER.findall(text.removesuffix(unit))
            if any(abs(float(each) - value) <= SAME * abs(value) for each in numbers):
                return True
    return False


def faults(listed, cells, told):
    """Return a sentence for each number that is told by no page and has no line, or more than it should have."""
    findings, by_values, found = [row["finding"] for row in told], parsed(told), []
    for cell in cells:
        lines, by_value = lines_for(cell, listed), is_told(cell, by_values)
        if len(lines) > 1 or not (lines or by_value):
            found.append(f"{cell.where}: {cell.text} has {len(lines)} lines in {LIST.name}")
        for line in lines:
            in_words = "as" in line
            if by_value and not in_words:
                found.append(f"{cell.where}: {cell.text} is compared and listed as not compared")
            if in_words and "reason" not in line and not is_found(finding_of(cell, line), findings):
                found.append(f"{cell.where}: no page has a finding '{finding_of(cell, line)}'")
    return found


def test_every_published_number_is_compared_or_listed():
    """All tables, against all pages in docs; no line is for nothing."""
    listed = read_not_compared()
    cells = published_cells(listed)
    assert faults(listed, cells, told_in_docs()) == []
    assert [line for line in listed.tables if not any(line in lines_for(cell, listed) for cell in cells)] == []
    assert {*listed.settings, *listed.not_of_a_source} <= {path.name for path in TABLES.glob("*.csv")}


@pytest.fixture
def made_up(tmp_path):
    """A table with one number that is compared, one that is told in other words, one that is listed, and one more."""
    (tmp_path / "made_up.csv").write_text(
        "quantity,layer,value,unit,uncertainty,source\n"
        'depth,1,1.5,mm,0.2,"Yan 2022, Table 5.4"\n'
        'width,2,3,mm,,"Yan 2022, Table 5.4"\n'
        'wear_rate,2,7,mm,,"Yan 2022, Table 5.4"\n'
    )
    (tmp_path / "list.yaml").write_text(
        "settings: {made_up.csv: [layer]}\nnot_of_a_source: []\ntables:\n"
        "  - {table: made_up.csv, columns: [uncertainty], reason: scatter}\n"
        "  - {table: made_up.csv, rows: {quantity: [width]}, as: 'wide, layer {layer}'}\n"
        "  - {table: made_up.csv, rows: {quantity: [wear_rate]}, as: 'mean {quantity}', reason: not yet}\n"
        "elsewhere:\n  - {what: load, value: 5 and 1e-3, unit: N, source: 'Yan 2022, section 3.1', reason: given}\n"
    )
    return tmp_path


TOLD = {"finding": "depth", "published": "1.5 mm", "source": "Yan 2022, section 5.5, Table 5.4"}
WIDE = {"finding": "wide, layer 2, mean", "published": "1 to 2 %", "source": "Yan 2022"}


def test_a_number_that_is_neither_compared_nor_listed_is_found(made_up):
    """Without its page, without its finding, with another unit or from another place of the source."""
    listed = read_not_compared(made_up / "list.yaml")
    cells = published_cells(listed, made_up)
    assert [cell.text for cell in cells] == ["1.5", "0.2", "3", "7"]
    assert faults(listed, cells, [TOLD, WIDE]) == []
    for told in ([WIDE], [TOLD | {"published": "1.5 m"}, WIDE], [TOLD | {"source": "Yan 2022, Table 6.1"}, WIDE]):
        assert faults(listed, cells, told) == ["made_up.csv, line 2, value: 1.5 has 0 lines in not_compared.yaml"]
    assert faults(listed, cells, [TOLD]) == ["made_up.csv, line 3, value: no page has a finding 'wide, layer 2'"]
    compared = TOLD | {"published": "0.2 mm"}
    assert "is compared and listed" in faults(listed, cells, [TOLD, WIDE, compared])[0]


def test_the_list_is_told_with_reasons_until_a_page_has_the_finding(made_up):
    """A row of a table counts its numbers; `as` beside a reason ends once there is such a finding."""
    listed = read_not_compared(made_up / "list.yaml")
    table = not_compared([WIDE["finding"]], listed, made_up)
    assert table[COLUMNS].to_numpy().tolist() == [
        ["depth, layer 1", "± 0.2 mm", "scatter", "Yan 2022, Table 5.4"],
        ["wear rate, layer 2", "7 mm", "not yet", "Yan 2022, Table 5.4"],
        ["load", "5 and 1e-3 N", "given", "Yan 2022, section 3.1"],
    ]
    assert (table[NUMBERS].tolist(), table["chapter"].tolist()) == ([1, 1, 2], [5, 5, 3])
    assert len(not_compared(["mean wear rate, convex"], listed, made_up)) == 2


def test_a_line_of_the_list_has_its_keys(tmp_path):
    """A line for a table says why or under which finding; what is in no table has value, source and reason."""
    head = "settings: {}\nnot_of_a_source: []\n"
    texts = {
        "tables: [{table: a.csv}]\nelsewhere: []\n": "line 1 of tables has table, .*of as and reason one at least",
        "tables: []\nelsewhere: [{what: a, value: 1}]\n": "line 1 of elsewhere has what, value, allowed are reason,",
        "tables: []\n": "found are settings, not_of_a_source, tables, allowed are",
    }
    for text, words in texts.items():
        (tmp_path / "list.yaml").write_text(head + text)
        with pytest.raises(ConfigError, match=words):
            read_not_compared(tmp_path / "list.yaml")


@pytest.mark.parametrize(
    ("source", "chapter"),
    [
        ("Yan 2022, sections 4.5.2, 4.6 and Fig 4.14", 4),
        ("Yan 2022, Eq 6.3 to 6.6", 6),
        ("follows from Yan 2022, Eq 6.2 and Fig 6.21: 1.034 m", 6),
        ("Chen 2017, as quoted in Yan 2022, chapter 1", None),
        ("Roberts 2003, as quoted in Yan 2022, section 1.1", None),
        ("powderprocess.net", None),
    ],
)
def test_chapters_are_those_that_sources_name_first(source, chapter):
    """Machines have sources of their own, or quotations of the introduction."""
    assert chapter_of(source) == chapter
