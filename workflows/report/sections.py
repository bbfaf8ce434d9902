"""Sections of a page of results: one source for the HTML page of a study and for its page in docs.

A case's module `page` makes them from the tables of a study that was run; `page.py` writes them as HTML, `markdown.py`
as Markdown.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import pandas as pd


@dataclass(frozen=True)
class Text:
    """A paragraph of plain words."""

    text: str


@dataclass(frozen=True)
class Points:
    """A list of sentences; folded: further ones, which a reader opens."""

    items: Sequence[str]
    folded: Sequence[str] = ()


@dataclass(frozen=True)
class Cards:
    """The few numbers that answer the question: (number as text, what it is)."""

    cards: Sequence[tuple[str, str]]


SOUND, CARE, WEAK = "sound", "with care", "weak"  # states of a light


@dataclass(frozen=True)
class Light:
    """How far a result can be trusted in one respect: what is looked at, SOUND, CARE or WEAK, and why."""

    what: str
    state: str
    said: str


@dataclass(frozen=True)
class Lights:
    """The lights of a verdict."""

    lights: Sequence[Light]


@dataclass(frozen=True, eq=False)
class Table:
    """A table; heads are the column names, their units those of the names' endings.

    file: name of its CSV for download, without ending; "" for none
    note: what must be said of its columns
    digits: significant ones, of single columns by name; else 3
    heads: names and units of columns, (name, unit), where the column's name does not say them
    beside_source: whether it holds published numbers beside ours, see `published`; or these numbers, where the table
    shows them in columns of its own
    """

    data: pd.DataFrame
    file: str = ""
    note: str = ""
    digits: Mapping[str, int] = field(default_factory=dict)
    heads: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    beside_source: bool | pd.DataFrame = False


@dataclass(frozen=True)
class Pictures:
    """Figures of the study by name; those that a study has not are left out."""

    names: Sequence[str]


@dataclass(frozen=True)
class Listing:
    """A file shown as it is, under its title."""

    title: str
    content: str


Block = Text | Points | Cards | Lights | Table | Pictures | Listing
DIGITS = 3  # significant ones of numbers in tables


@dataclass(frozen=True)
class Section:
    """A section of a page; anchor: its place in the HTML page."""

    title: str
    blocks: Sequence[Block]

    @property
    def anchor(self) -> str:
        """Return its title as one word."""
        return "".join(letter if letter.isalnum() else "-" for letter in self.title.lower()).strip("-")


def shown(section: Section, figures: Sequence[str]) -> Section | None:
    """Return a section with those of its figures that there are; None where nothing is left to show."""
    blocks = [
        Pictures([name for name in block.names if name in figures]) if isinstance(block, Pictures) else block
        for block in section.blocks
    ]
    kept = [block for block in blocks if not (isinstance(block, Pictures) and not block.names)]
    return Section(section.title, kept) if kept else None


def with_all_figures(sections: Sequence[Section], figures: Sequence[str]) -> list[Section]:
    """Return sections that show every figure of a study: those that none names come in one at the end."""
    kept = [each for section in sections if (each := shown(section, figures))]
    named = {name for each in kept for block in each.blocks if isinstance(block, Pictures) for name in block.names}
    rest = [name for name in figures if name not in named]
    return [*kept, *([Section("Further figures", [Pictures(rest)])] if rest else [])]
