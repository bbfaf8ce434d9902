"""Ratios of wear between the plates of the study which_law, by each law, for the table of docs/wear.md.

    python -m benchmarks.stream_laws                # in the root of the repository, after `snakemake which_law`

Reads results/which_law/figures/wear_by_law.csv and writes the table anew between its marks.
"""

from __future__ import annotations

import argparse
import re
from pathlib import Path

import pandas as pd

from benchmarks.impact_angle import OVER, TESTED

PAGE = Path("docs") / "wear.md"
RESULTS = Path("results") / "which_law" / "figures" / "wear_by_law.csv"
BEGIN, END = "<!-- by benchmarks.stream_laws -->", "<!-- end -->"
PART = "plate"
LAWS = {  # in the order of the page
    "tangential_work": "Shear work",
    "archard": "Archard",
    "finnie": "Finnie",
    "oka": "Oka, quartz on steel of 1.4 GPa",
}
RATIOS = tuple(angle for angle in TESTED if angle != OVER)


def ratios(laws: pd.DataFrame) -> pd.DataFrame:
    """Return wear of the plate at each of RATIOS over that at OVER degrees (-), a line per law of LAWS.

    laws: as from `law_volumes.laws_of_settings`; its settings are A90, A60, ..., the first one has no over_first
    Raises KeyError for a law or a setting that is not there.
    """
    plate = laws[laws["part"] == PART].pivot(index="law", columns="setting", values="over_first")
    plate[laws["setting"].iloc[0]] = 1.0
    return pd.DataFrame({angle: plate[f"A{angle}"] / plate[f"A{OVER}"] for angle in RATIOS}).loc[list(LAWS)]


def table(found: pd.DataFrame) -> str:
    """Return the table in Markdown; found: as from `ratios`."""
    heads = ["law", *(f"{angle} over {OVER}°" for angle in RATIOS)]
    lines = [
        [LAWS[law], *(f"{value:.2f}" for value in row)] for law, row in zip(found.index, found.to_numpy(), strict=True)
    ]
    head, *rest = (f"| {' | '.join(cells)} |\n" for cells in (heads, *lines))
    return "".join([head, "|---" * len(heads), "|\n", *rest])


def with_table(text: str, new: str) -> str:
    """Return the page with a table in the place of the one between the marks. Raises ValueError without these."""
    between = re.compile(f"(?<={re.escape(BEGIN)}\n\n)[^<]*(?=\n{re.escape(END)})")
    if not between.search(text):
        raise ValueError(f"found no table between {BEGIN} and {END}, allowed is a page with one")
    return between.sub(lambda _: new, text, count=1)


def main() -> None:
    """Write the table into the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--results", type=Path, default=RESULTS)
    parser.add_argument("--page", type=Path, default=PAGE)
    given = parser.parse_args()
    new = table(ratios(pd.read_csv(given.results)))
    given.page.write_text(with_table(given.page.read_text(encoding="utf-8"), new), encoding="utf-8")


if __name__ == "__main__":
    main()
