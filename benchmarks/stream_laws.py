"""Ratios of wear between the plates of the study which_law, by each law, and what reaches them, for docs/wear.md.

    python -m benchmarks.stream_laws                # in the root of the repository, after the study and its page

Reads figures/wear_by_law.csv and volume_by_law.csv of results/which_law and the page's table of loads, writes anew what
is between the marks.
"""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.command_line import command
from benchmarks.impact_angle import OVER, TESTED
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report.markdown_text import prose

PAGE = Path("docs") / "wear.md"
RESULTS = Path("results") / "which_law"
LOADS = Path("docs") / "tables" / "which_law_quick_loads.csv"
KG_PER_S = 1.0 / 3.6  # of a t/h
BEGIN, END = "<!-- by benchmarks.stream_laws -->", "<!-- end -->"
PART, SLOPE = "plate", "slide"
LAWS = {  # in the order of the page
    "tangential_work": "Shear work",
    "archard": "Archard",
    "finnie": "Finnie",
    "oka": "Oka, quartz on steel of 1.4 GPa",
    "combined": "Combined: Archard, a twentieth of rolling, impacts alike",
    "impact_threshold": "Impact energy above 0.5 m/s",
}
SLOPES = "slope over plate at {}°"
RATIOS = tuple(angle for angle in TESTED if angle != OVER)


def ratios(laws: pd.DataFrame) -> pd.DataFrame:
    """Return wear of the plate at each of RATIOS over that at OVER degrees (-), a line per law of LAWS.

    laws: as from `law_volumes.laws_of_settings`; its settings are A90, A60, ..., the first one has no over_first
    Raises KeyError for a law or a setting that is not there.
    """
    plate = laws[laws["part"] == PART].pivot(index="law", columns="setting", values="over_first")
    plate[laws["setting"].iloc[0]] = 1.0
    return pd.DataFrame({angle: plate[f"A{angle}"] / plate[f"A{OVER}"] for angle in RATIOS}).loc[list(LAWS)]


def slope_over_plate(volumes: pd.DataFrame) -> pd.DataFrame:
    """Return volume of the slope over that of the plate above it (-), geometric mean over packings, a line per law of
    LAWS and a column per angle of TESTED.

    volumes: as from `law_volumes.law_volumes`; both parts have one coefficient. Raises KeyError as `ratios`.
    """
    logs = np.log(volumes.set_index(["part", "law", "setting", "packing"])["worn_volume_m3"])
    found = np.exp((logs[SLOPE] - logs[PART]).groupby(["law", "setting"]).mean()).unstack()
    return found.loc[list(LAWS), [f"A{angle}" for angle in TESTED]].set_axis(list(TESTED), axis=1)


def table(found: pd.DataFrame, what: str = f"{{}} over {OVER}°") -> str:
    """Return a table in Markdown; found: as from `ratios` or `slope_over_plate`; what: of its columns, by angle."""
    heads = ["law", *(what.format(angle) for angle in found)]
    lines = [
        [LAWS[law], *(f"{value:.2f}" for value in row)] for law, row in zip(found.index, found.to_numpy(), strict=True)
    ]
    head, *rest = (f"| {' | '.join(cells)} |\n" for cells in (heads, *lines))
    return "".join([head, "|---" * len(heads), "|\n", *rest])


def arriving(loads: pd.DataFrame, inlet: Mapping[str, Any]) -> dict[int, float]:
    """Return by angle (degrees) which share (-) of the stream's kinetic energy along its normal a plate is hit with.

    loads: columns setting, part, quantity and pristine (W), of the page of the study; inlet: of the study's settings
    """
    speed = math.hypot(*inlet["velocity_m_per_s"])
    power = loads[(loads["part"] == PART) & (loads["quantity"] == "impact power")].set_index("setting")["pristine"]
    stream = 0.5 * inlet["rate_t_per_h"] * KG_PER_S * speed**2
    return {angle: power[f"A{angle}"] / (stream * math.sin(math.radians(angle)) ** 2) for angle in TESTED}


def sentence(shares: Mapping[int, float]) -> str:
    """Return what is said of them; shares: as from `arriving`."""
    each = ", ".join(f"{100.0 * share:.0f} % at {angle}°" for angle, share in shares.items())
    return prose(f"Of the stream's energy along the plate's normal impacts bring {each}.") + "\n"


def with_table(text: str, new: str, begin: str = BEGIN) -> str:
    """Return the page with what is new in the place of what is between the marks. Raises ValueError without these."""
    between = re.compile(f"(?<={re.escape(begin)}\n\n)[^<]*(?=\n{re.escape(END)})")
    if not between.search(text):
        raise ValueError(f"found no table between {begin} and {END}, allowed is a page with one")
    return between.sub(lambda _: new, text, count=1)


def main() -> None:
    """Write table and sentence into the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--results", type=Path, default=RESULTS)
    parser.add_argument("--loads", type=Path, default=LOADS)
    parser.add_argument("--page", type=Path, default=PAGE)
    given = parser.parse_args()
    shares = arriving(pd.read_csv(given.loads), load_study("which_law").settings["inlet"])
    by_law = pd.read_csv(given.results / "figures" / "wear_by_law.csv")
    slopes = slope_over_plate(pd.read_csv(given.results / "volume_by_law.csv"))
    new = f"{table(ratios(by_law))}\n{table(slopes, SLOPES)}\n{sentence(shares)}"
    given.page.write_text(with_table(given.page.read_text(encoding="utf-8"), new), encoding="utf-8")


if __name__ == "__main__":
    command(main)
