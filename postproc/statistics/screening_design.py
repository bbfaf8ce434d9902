"""Write a definitive screening design as a table for config/designs: every factor at three levels, few runs.

python -m bulkwear.postproc.statistics.screening_design --factor height_mm=1.5:6:log \\
    --factor velocity_m_per_s=0.5:2:log ... --constant bed_thickness_mm=40 --output config/designs/mine.csv

B. Jones and C. J. Nachtsheim, J. Qual. Technol. 43 (2011) 1-15; from conference matrices: L. Xiao, D. K. J. Lin and
F. Bai, J. Qual. Technol. 44 (2012) 2-8; fake factors: B. Jones and C. J. Nachtsheim, Technometrics 59 (2017) 319-329.
"""

from __future__ import annotations

import argparse
import csv
import io
import math
import re
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bulkwear.postproc.statistics.conference_matrix import conference_matrix, next_order
from bulkwear.postproc.statistics.factors import Factor

FEWEST_FACTORS = 3
FAKE = 2  # fake factors of a new design: four runs more, and an error that no factor has a part in
DIGITS = 10  # significant, of a level in a table
FACTOR = re.compile(r"(?P<name>\w+)=(?P<low>[^:]+):(?P<high>[^:]+?)(?P<log>:log)?")
CONSTANT = re.compile(r"(?P<name>\w+)=(?P<value>[^:]+)")


def coded_design(factors: int, fake: int = 0, centres: int = 1) -> np.ndarray:
    """Return a definitive screening design in coded units, (runs, factors) of -1, 0 and 1.

    fake: columns more that the conference matrix has and the design leaves out; they leave runs for the error
    centres: runs with every factor at its middle level, at the end

    Row 2 k + 1 mirrors row 2 k. Main effects are orthogonal to each other, to squares and to two-factor interactions.
    Raises ValueError for too few factors, negative counts, and no centre run.
    """
    if factors < FEWEST_FACTORS:
        raise ValueError(f"found {factors} factors, allowed are {FEWEST_FACTORS} or more")
    if fake < 0:
        raise ValueError(f"found {fake} fake factors, allowed are none or more")
    if centres < 1:
        raise ValueError(f"found {centres} centre runs, allowed is one or more: without one, squares are aliased")
    order = next_order(factors + fake)
    columns = conference_matrix(order)[:, :factors]
    pairs = np.stack([columns, -columns], axis=1).reshape(2 * order, factors)
    return np.vstack([pairs, np.zeros((centres, factors), dtype=int)])


def design_rows(
    factors: Sequence[Factor],
    constants: Sequence[tuple[str, float]] = (),
    fake: int = FAKE,
    centres: int = 1,
    coded: bool = False,
) -> list[dict[str, str]]:
    """Return the rows of a design table as text: row, one column per factor, then the constants.

    constants: names and values of columns that do not change
    fake: see `coded_design`; 0 for the fewest runs
    coded: levels -1, 0, 1 instead of real ones. Raises ValueError as `coded_design`, and for a name that comes twice.
    """
    names = [factor.name for factor in factors] + [name for name, _ in constants]
    twice = [name for index, name in enumerate(names) if name in ("row", *names[:index])]
    if twice:
        raise ValueError(f"column {twice[0]} comes twice, allowed is each column once")
    levels = coded_design(len(factors), fake, centres)
    columns = {f.name: levels[:, k] if coded else f.real(levels[:, k]) for k, f in enumerate(factors)}
    columns |= {name: np.full(len(levels), value) for name, value in constants}
    texts = {name: [f"{value:.{DIGITS}g}" for value in values] for name, values in columns.items()}
    return [{"row": f"R{run + 1}", **{name: texts[name][run] for name in names}} for run in range(len(levels))]


def design_text(rows: Sequence[dict[str, str]]) -> str:
    """Return rows as the text of a CSV file."""
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def parse_factor(text: str) -> Factor:
    """Return a factor from NAME=LOW:HIGH or NAME=LOW:HIGH:log. Raises ValueError with one sentence."""
    found = FACTOR.fullmatch(text)
    if not found:
        raise ValueError(f"--factor: found '{text}', allowed is NAME=LOW:HIGH or NAME=LOW:HIGH:log")
    low, high = (_number("--factor", text, found[key]) for key in ("low", "high"))
    return Factor(found["name"], low, high, "log" if found["log"] else "linear")


def parse_constant(text: str) -> tuple[str, float]:
    """Return name and value from NAME=VALUE. Raises ValueError with one sentence."""
    found = CONSTANT.fullmatch(text)
    if not found:
        raise ValueError(f"--constant: found '{text}', allowed is NAME=VALUE")
    return found["name"], _number("--constant", text, found["value"])


def _number(option: str, text: str, number: str) -> float:
    try:
        value = float(number)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{option}: found '{number}' in '{text}', allowed are numbers")
    return value


def _arguments(words: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m bulkwear.postproc.statistics.screening_design",
        description="Write a definitive screening design as a design table of a study.",
        epilog="Columns and their units: config/README.md, Design table. A study checks the table before it runs.",
    )
    add = parser.add_argument
    add("--factor", action="append", required=True, metavar="NAME=LOW:HIGH[:log]", help="a factor; give several")
    add("--constant", action="append", default=[], metavar="NAME=VALUE", help="a column that does not change")
    told = f"fake factors, two runs each, which estimate the error (default {FAKE}; 0: fewest runs)"
    add("--fake", type=int, default=FAKE, help=told)
    add("--centres", type=int, default=1, help="centre runs (default 1)")
    add("--coded", action="store_true", help="write levels -1, 0, 1 instead of real ones")
    add("--output", type=Path, help="file to write, one that does not exist yet (default: print the table)")
    return parser.parse_args(words)


def main(words: Sequence[str] | None = None) -> int:
    """Write or print a design; returns the exit status. Faults are one sentence on stderr."""
    given = _arguments(words)
    try:
        factors = [parse_factor(text) for text in given.factor]
        constants = [parse_constant(text) for text in given.constant]
        rows = design_rows(factors, constants, given.fake, given.centres, given.coded)
        if given.output is None:
            sys.stdout.write(design_text(rows))
            return 0
        with open(given.output, "x", encoding="utf-8") as stream:
            stream.write(design_text(rows))
    except ValueError as error:
        print(f"{error}.", file=sys.stderr)
        return 1
    except OSError as error:
        print(f"--output: {given.output} cannot be written ({error.strerror}).", file=sys.stderr)
        return 1
    print(f"{given.output}: {len(rows)} rows, {len(factors)} factors.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
