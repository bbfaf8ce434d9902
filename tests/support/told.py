"""What pages of docs tell: their words, the tables on them and beside them."""

import pandas as pd

from tests import REPOSITORY
from tests.support.doc_pages import read

DOCS = REPOSITORY / "docs"


def told(page):
    """The words of a page with single spaces between them."""
    return " ".join(read(DOCS / page).split())


def table(name, **more):
    """A table of docs."""
    return pd.read_csv(DOCS / name, **more)


def rows(page, *first):
    """The table on a page whose first columns are these, cells as they stand there."""
    _, head, below = read(DOCS / page).partition(f"| {' | '.join(first)} |")
    lines = f"{head}{below}".partition("\n\n")[0].splitlines()
    cells = [[cell.strip() for cell in line.removeprefix("|").removesuffix("|").split("|")] for line in lines]
    return pd.DataFrame(cells[2:], columns=cells[0])
