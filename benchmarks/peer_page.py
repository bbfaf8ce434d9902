"""The page of `benchmarks.peers`: how fast each code is beside ours where the physics agree, and what it tells of
wear.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from benchmarks.measure import measured
from benchmarks.peer_codes import OURS, Code
from bulkwear.workflows.report.markdown_text import bullet, markdown, prose

QUANTITIES = ("kinetic_energy_J", "contacts", "force_x_N", "force_z_N")  # means over the samples of a run
# -, of any quantity, beyond which two codes do not simulate the same. The path of a bed is chaotic: no other code can
# be expected nearer than ours with one particle moved by 1 nm; this is several times that.
MOST_APART = 0.1
PERCENT = 100.0


def agreement(table: pd.DataFrame) -> pd.DataFrame:
    """Return a row per code: version, `QUANTITIES`, and `apart`, the largest relative difference (-) of them from ours.

    table: a row per code and round
    """
    means = table.groupby("code", sort=False)[list(QUANTITIES)].mean()
    means["apart"] = (means / means.loc[OURS] - 1.0).abs().max(axis=1)
    return means.reset_index()


def speeds(table: pd.DataFrame) -> pd.DataFrame:
    """Return a row per code: rate (particle-steps/s, median of the rounds), and its ratio to ours, median and range.

    The ratio is NaN where physics are apart by more than `MOST_APART`. table: a row per code and round
    """
    rates = table.pivot(index="round", columns="code", values="particle_steps_per_s")
    apart = agreement(table).set_index("code")["apart"]
    rows = []
    for code in dict.fromkeys(table["code"]):
        both = rates[[code, OURS]].dropna() if code != OURS else rates[[code]].dropna()
        found = measured(code, "1/s", both[code], OURS, both[OURS])
        told = {"ratio": found.ratio, "ratio_low": found.ratio_low, "ratio_high": found.ratio_high}
        agrees = apart[code] <= MOST_APART
        rows.append(
            {"code": code, "rate": found.value, "rounds": found.repeats}
            | {name: value if agrees else float("nan") for name, value in told.items()}
        )
    return pd.DataFrame(rows)


def wear_words(code: Code, ratio: float) -> str:
    """Return in a phrase what a code tells of wear; ratio: of its volume to the closed form, NaN where none."""
    if code.wear is None:
        return "none"
    return f"{ratio:.6f}" if abs(ratio - 1.0) < 0.5 else f"{ratio:.2g}"


def results_page(table: pd.DataFrame, known: Sequence[Code], machine: Mapping[str, Any]) -> str:
    """Return the page; table: a row per code and round; known: all codes, whether found or not."""
    first, found, dates = table.iloc[0], agreement(table), sorted(set(table["date"]))
    parts = [
        "# Beside other codes",
        prose(
            "Written by `python -m benchmarks.peers` from [peers.csv](peers.csv); not to be edited. Machine:"
            f" {machine['processor']}, {machine['system']}; one core each, programs as they are distributed; measured"
            f" {' to '.join(dict.fromkeys((dates[0], dates[-1])))}."
        ),
        prose(
            f"One bed of {first['particles']:.0f} spheres (diameters 3.6, 4.0 and 4.4 mm) at rest in a box, whose floor"
            f" is pulled away under it: {first['steps']:.0f} steps from the same places, Hertz-Mindlin, sliding"
            " friction 0.5, restitution 0.6, no rolling friction, the same time step. Rate: particle-steps in a second"
            " of processor time, of a whole run less one of a single step; codes take turns, round by round."
        ),
        "## Speed",
        markdown(speed_table(table)),
        "![Rates over ours](peers.png)",
        "## Is it the same simulation?",
        prose(
            f"Means over the samples of a run. No ratio is told where one of them is over {PERCENT * MOST_APART:g} %"
            " from ours. The path of a bed is chaotic: ours with one particle moved by 1 nm shows how far that alone"
            " goes, and its ratio above how well processor time repeats."
        ),
        markdown(found.assign(apart=(PERCENT * found["apart"]).round(1)).rename(columns={"apart": "apart_percent"})),
        "## Wear",
        prose(
            "A sphere dragged over the floor at constant overlap; Archard's volume is coefficient times force times"
            " distance. Volume told over that, with the same coefficient. LIGGGHTS' `wear finnie` is a law of impacts"
            " and sees none here."
        ),
        markdown(wear_table(table, known)),
        "## What differs",
        "\n".join(bullet(f"{code.name}: {code.law}.") for code in known if code.name in set(table["code"])),
    ]
    missing = [code for code in known if code.name not in set(table["code"])]
    if missing:
        parts += [
            "## Not found, or its run failed",
            "\n".join(bullet(f"{code.name}: {code.how_to_get}.") for code in missing),
        ]
    return "\n\n".join(part.rstrip("\n") for part in parts) + "\n"


def speed_table(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table of speeds as the page shows it."""
    found = speeds(table)
    versions = table.groupby("code")["version"].first()
    lines = [
        {
            "code": row.code,
            "version": versions[row.code],
            "particle_steps_per_s": f"{row.rate:,.0f}",
            f"over {OURS} (range)": (
                "physics apart"
                if pd.isna(row.ratio)
                else f"{row.ratio:.3g} ({row.ratio_low:.3g} to {row.ratio_high:.3g})"
            ),
            "rounds": row.rounds,
        }
        for row in found.itertuples()
    ]
    return pd.DataFrame(lines)


def wear_table(table: pd.DataFrame, known: Sequence[Code]) -> pd.DataFrame:
    """Return what each code that ran tells of wear, as the page shows it."""
    ratios = table.groupby("code")["wear_over_archard"].mean()
    ran = [code for code in known if code.name in ratios]
    return pd.DataFrame(
        {"code": code.name, "volume over closed form (-)": wear_words(code, ratios[code.name])} for code in ran
    )
