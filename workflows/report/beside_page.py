"""What a page of results in docs leaves to files beside it: long tables, long listings, and what stands elsewhere too.

The HTML page of the study has all of it, with its tables to sort; a page in docs is read from top to bottom.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from bulkwear.workflows.report.published import published_file
from bulkwear.workflows.report.sections import Block, Cards, Listing, Points, Section, Table, Text

MOST_ROWS = 16  # of a table, lines of a listing: what is taken in at a glance
FOLDER = "tables"  # in docs
SIX_DIGITS = "%.6g"  # of numbers in tables: more than any interval needs
PUBLISHED_PAGE = "published_numbers.md"


def short_sections(sections: Sequence[Section], docs: Path, name: str, published: str = "") -> list[Section]:
    """Return the sections of a page of results as docs show them, and write the files that they link to.

    Cards go where the page begins with a verdict in words: tables below have their numbers too.

    name: of study and fidelity, with which the names of the files begin; published: file name of the page, if its
    published numbers stand beside ours on a page of their own
    """
    answered = any(isinstance(block, Points) for section in sections[:1] for block in section.blocks)
    shortened = []
    for section in sections:
        kept = [block for block in section.blocks if not (answered and isinstance(block, Cards))]
        blocks = list(_short(section, kept, docs, name, published))
        shortened += [Section(section.title, blocks)] if blocks else []
    return shortened


def remove_unlinked(docs: Path, name: str, text: str) -> None:
    """Remove the files of an earlier page that the page of today does not link; name: as for `short_sections`."""
    for file in (docs / FOLDER).glob(f"{name}_*"):
        if f"]({FOLDER}/{file.name})" not in text:
            file.unlink()


def _short(section: Section, blocks: Sequence[Block], docs: Path, name: str, published: str) -> Iterator[Block]:
    """Yield the blocks of a section, links in place of what is long, one in place of all published numbers."""
    elsewhere = [block for block in blocks if published and isinstance(block, Table) and block.beside_source is True]
    for index, block in enumerate(blocks):
        if elsewhere and block is elsewhere[0]:
            ours = f"[Published numbers beside ours]({PUBLISHED_PAGE}), with verdicts"
            yield Text(
                f"{ours}: {sum(len(each.data) for each in elsewhere)} ([all of the page]({published_file(published)}))."
            )
        elif any(block is each for each in elsewhere):
            continue
        elif isinstance(block, Table) and len(block.data) > MOST_ROWS:
            file = _path(docs, f"{name}_{block.file or _place(section, index)}.csv")
            block.data.to_csv(file, index=False, float_format=SIX_DIGITS)
            yield Text(f"[Table of {len(block.data)} rows]({FOLDER}/{file.name}). {block.note}".strip())
        elif isinstance(block, Listing) and len(block.content.splitlines()) > MOST_ROWS:
            file = _path(docs, f"{name}_{_place(section, index)}.txt")
            file.write_text(block.content.rstrip() + "\n", encoding="utf-8")
            yield Text(f"{block.title}: [{len(block.content.splitlines())} lines]({FOLDER}/{file.name}).")
        else:
            yield block


def _place(section: Section, index: int) -> str:
    """Return a name for a block that has none; without hyphens, at which lines break."""
    return f"{section.anchor}_{index}".replace("-", "_")


def _path(docs: Path, file: str) -> Path:
    """Return the path of a file in the folder of tables, which is made."""
    (docs / FOLDER).mkdir(exist_ok=True)
    return docs / FOLDER / file
