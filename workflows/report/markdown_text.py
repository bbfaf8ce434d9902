"""Texts in Markdown: paragraphs, tables, pictures with captions, and the blocks of a section."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import pandas as pd

from bulkwear.workflows.report.provenance_of_pages import LINE
from bulkwear.workflows.report.sections import DIGITS, Block, Cards, Lights, Listing, Points, Table, Text
from bulkwear.workflows.report.text import number


def markdown(table: pd.DataFrame, digits: Mapping[str, int] = MappingProxyType({})) -> str:
    """Return a table in Markdown, numbers as people read them; digits: significant ones of single columns."""
    head = [str(name).replace("_", " ") for name in table]
    places = [digits.get(name, DIGITS) for name in table]
    rows = [list(map(number, row, places)) for row in table.itertuples(index=False)]
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def prose(text: str) -> str:
    """Return a paragraph in lines of the usual length."""
    return textwrap.fill(text, LINE)


def bullet(text: str) -> str:
    """Return a point of a list in lines of the usual length."""
    return f"* {textwrap.fill(text, LINE - 2, subsequent_indent='  ')}"


@dataclass(frozen=True)
class Caption:
    """What stands beside a picture: title of the figure, what it shows ("" where that is not told), what is drawn."""

    title: str
    finding: str
    drawn: str


def untold(figure: str) -> Caption:
    """Return the caption of a figure of which the name alone is known."""
    return Caption(figure.replace("_", " "), "", "")


def picture(file: str, caption: Caption) -> str:
    """Return a picture in Markdown with its caption, the finding first; it is the alternative text, too."""
    shown = caption.finding or f"{caption.title}."
    told = f"{caption.title}. " if caption.finding else ""
    alternative = shown.replace("[", "(").replace("]", ")")
    return f"![{alternative}]({file})\n\n{prose(f'**{shown}** {told}{caption.drawn}')}\n"


def written(block: Block, name: str, captions: Mapping[str, Caption] = MappingProxyType({})) -> str:
    """Return a block of a section in Markdown.

    name: of study and fidelity, with which its pictures' names begin; captions: of the figures by name
    """
    if isinstance(block, Text):
        return prose(block.text) + "\n"
    if isinstance(block, Points):
        return "\n".join(map(bullet, [*block.items, *block.folded])) + "\n"
    if isinstance(block, Cards):
        return "\n".join(bullet(f"**{value}** {label}") for value, label in block.cards) + "\n"
    if isinstance(block, Lights):
        return "\n".join(bullet(f"**{each.what}: {each.state}.** {each.said}") for each in block.lights) + "\n"
    if isinstance(block, Table):
        note = f"\n{prose(block.note)}\n" if block.note else ""
        return markdown(block.data, block.digits) + note
    if isinstance(block, Listing):
        return f"{block.title}:\n\n```\n{block.content.rstrip()}\n```\n"
    return "\n".join(picture(picture_file(name, each), captions.get(each) or untold(each)) for each in block.names)


def picture_file(name: str, figure: str) -> str:
    """Return the file name of a figure beside its page of results; name: of study and fidelity."""
    return f"{name}_{figure}.png"
