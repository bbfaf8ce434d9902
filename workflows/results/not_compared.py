"""Published numbers that stand beside none of ours, and why, from config/published/not_compared.yaml.

A line there is for numbers of a table of published numbers, or for what is in no table. Every number of the tables is
compared in docs or has one line.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from bulkwear.workflows.config.layers import ConfigError, read_csv_rows, read_yaml
from bulkwear.workflows.config.published_tables import FOLDER
from bulkwear.workflows.engine.project import current_project

LIST = FOLDER / "not_compared.yaml"
PARTS = ("settings", "not_of_a_source", "tables", "elsewhere")
OF_TABLES = ({"table"}, {"rows", "columns", "as", "reason"})  # keys that a line must and may have
OF_OTHERS = ({"what", "value", "source", "reason"}, {"unit"})
NOT_NUMBERS = ("source", "unit", "relation", "note", "reason")  # columns beside those that say of what a number is
COLUMNS = ["what", "published", "reason", "source"]
NUMBERS = "numbers"  # column of how many a row has
CHAPTERS = {
    3: "Chapter 3: calibration and screening",
    4: "Chapter 4: particle size",
    5: "Chapter 5: pin on disc",
    6: "Chapter 6: circular wear tester",
    None: "Machines",
}
CHAPTER = re.compile(r"Yan 2022.*?(?:section|Eq|Table|Fig)s? (\d)\.")
A_NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


@dataclass(frozen=True)
class Cell:
    """A published number of a table: its line in the file, what its row is told by, and its own column and text."""

    table: str
    line: int
    row: Mapping[str, str]
    column: str
    text: str

    @property
    def where(self) -> str:
        """Return file, line and column."""
        return f"{self.table}, line {self.line}, {self.column}"


@dataclass(frozen=True)
class NotCompared:
    """The list: columns of tables that are no numbers, tables without a source, lines for tables and for the rest."""

    settings: Mapping[str, Sequence[str]]
    not_of_a_source: Sequence[str]
    tables: Sequence[Mapping[str, Any]]
    elsewhere: Sequence[Mapping[str, Any]]


def chapter_of(source: str) -> int | None:
    """Return the chapter that a source names first; None where it is none of CHAPTERS."""
    found = CHAPTER.search(source)
    return int(found[1]) if found and int(found[1]) in CHAPTERS else None


def read_not_compared(path: Path | None = None) -> NotCompared:
    """Return the list. Raises ConfigError for a line with keys that it does not have."""
    path = Path(path or current_project().path(str(LIST)))
    values = read_yaml(path, current_project().folder).values
    if values.keys() != {*PARTS}:
        raise ConfigError(f"{path.name}: found are {', '.join(values)}, allowed are {', '.join(PARTS)}.")
    for part, (needed, further) in (("tables", OF_TABLES), ("elsewhere", OF_OTHERS)):
        for number, line in enumerate(values[part], 1):
            told = part == "elsewhere" or {"as", "reason"} & line.keys()
            if not (needed <= line.keys() <= needed | further and told):
                also = f" and, if any, {', '.join(sorted(further))}" + (", of as and reason one at least" * (not told))
                found, allowed = ", ".join(line), ", ".join(sorted(needed))
                raise ConfigError(f"{path.name}: line {number} of {part} has {found}, allowed are {allowed}{also}.")
    return NotCompared(**values)


def published_cells(listed: NotCompared, folder: Path | None = None) -> list[Cell]:
    """Return the numbers of all tables of published numbers, in their order. Raises ConfigError."""
    folder = Path(folder or current_project().path(str(FOLDER)))
    paths = [path for path in sorted(folder.glob("*.csv")) if path.name not in listed.not_of_a_source]
    return [
        Cell(path.name, line, row, column, text)
        for path in paths
        for line, row in read_csv_rows(path, folder)[1]
        for column, text in row.items()
        if column not in (*NOT_NUMBERS, *listed.settings.get(path.name, ())) and A_NUMBER.fullmatch(text)
    ]


def lines_for(cell: Cell, listed: NotCompared) -> list[Mapping[str, Any]]:
    """Return the lines of the list that are for a number."""
    return [line for line in listed.tables if _is_for(cell, line)]


def _is_for(cell: Cell, line: Mapping[str, Any]) -> bool:
    rows = line.get("rows", {})
    return (
        line["table"] == cell.table
        and cell.column in line.get("columns", [cell.column])
        and all(cell.row.get(name) in map(str, texts) for name, texts in rows.items())
    )


def finding_of(cell: Cell, line: Mapping[str, Any]) -> str | None:
    """Return how the finding begins under which pages tell a number in other words; None where they do not."""
    words = {name: text.replace("_", " ") for name, text in cell.row.items()}
    return line["as"].format_map(words) if "as" in line else None


def is_found(finding: str | None, findings: Iterable[str]) -> bool:
    """Return whether pages have a finding that begins so."""
    return finding is not None and any(each.startswith(finding) for each in findings)


def not_compared(findings: Sequence[str], listed: NotCompared, folder: Path | None = None) -> pd.DataFrame:
    """Return what is not compared: COLUMNS, NUMBERS of a row, and its chapter.

    findings: of all pages of docs; folder: of the tables, the project's without one
    """
    rows: dict[tuple[int, str, int], list[Cell]] = {}
    for cell in published_cells(listed, folder):
        for line in lines_for(cell, listed):
            if "reason" in line and not is_found(finding_of(cell, line), findings):
                rows.setdefault((listed.tables.index(line), cell.table, cell.line), []).append(cell)
    of_tables = [_told(cells, listed, listed.tables[key[0]]["reason"]) for key, cells in sorted(rows.items())]
    others = [_told_elsewhere(line) for line in listed.elsewhere]
    table = pd.DataFrame([*of_tables, *others], columns=[*COLUMNS, NUMBERS])
    return table.assign(chapter=[chapter_of(source) for source in table["source"]])


def _told(cells: Sequence[Cell], listed: NotCompared, reason: str) -> dict[str, Any]:
    """Return the row for the numbers of one row of a table that one line is for."""
    row, settings = cells[0].row, listed.settings.get(cells[0].table, ())
    words = [
        f"{name.replace('_', ' ')} {text}" if name in settings else text.replace("_", " ")
        for name, text in row.items()
        if name in settings or not (name in NOT_NUMBERS or A_NUMBER.fullmatch(text))
    ]
    said = ", ".join(filter(None, words)), "; ".join(_number_words(cell) for cell in cells), reason, row["source"]
    return dict(zip([*COLUMNS, NUMBERS], (*said, len(cells)), strict=True))


def _number_words(cell: Cell) -> str:
    """Return a number in words, with its unit, and its column where that is not the value."""
    unit = "" if cell.row.get("unit", "-") == "-" else cell.row["unit"]
    if cell.column in ("value", "uncertainty"):
        first = cell.row.get("relation", "") if cell.column == "value" else "±"
        return " ".join(filter(None, (first, cell.text, unit)))
    return f"{cell.column.replace('_', ' ')} {cell.text}"


def _told_elsewhere(line: Mapping[str, Any]) -> dict[str, Any]:
    """Return the row for numbers that are in no table."""
    published = f"{line['value']} {line.get('unit', '')}".strip()
    numbers = len(A_NUMBER.findall(str(line["value"])))
    said = line["what"], published, line["reason"], line["source"]
    return dict(zip([*COLUMNS, NUMBERS], (*said, numbers), strict=True))
