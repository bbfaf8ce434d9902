"""The flow through a machine in a block: what the solver printed, the balance of particles, and where some got lost."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.flow.bed import read_snapshot
from bulkwear.postproc.readers.cycle_folders import step_files
from bulkwear.postproc.readers.dump_text import read_frames
from bulkwear.workflows.cases.equipment.parameters import drawn_mass_scatter, filled_mass
from bulkwear.workflows.engine.beds import MASS_TOLERANCE, BedMeasure

Parameters = Mapping[str, Any]

PRINTED, FLOW, STRAYS = "flow.txt", "flow.csv", "strays.dump"
FIRST = "cycle_000"  # folder of the first block, in which a machine is filled
SCATTER = 4.0  # -, standard deviations of a mass whose particles are drawn
AXES = ("x", "y", "z")
SHOWN = 3  # places of lost particles in a sentence


def printed_flow(folder: Path) -> pd.DataFrame:
    """Return what the solver printed in a block's folder: a row each report."""
    with (folder / PRINTED).open() as lines:
        header = next(lines).split()
    rows = np.loadtxt(folder / PRINTED, skiprows=1, ndmin=2)
    return pd.DataFrame(rows, columns=header)


def flow_table(run: Parameters, folder: Path) -> pd.DataFrame:
    """Return the table of the flow in a block: time_s, particles, held_mass_kg, inserted_particles, inserted_mass_kg,
    out_particles, out_mass_kg and out_<outlet>_mass_kg since the run began, kinetic_energy_J, power_<part>_W.

    It takes the first block's own table for what the machine was filled with, and that of the block before.
    """
    found = printed_flow(folder)
    first, before = folder.parent / FIRST, _block_before(folder)
    filled = (found if before is None else printed_flow(first)).iloc[0]
    outlets = list(run["outlets"] or {})
    out_before = 0.0 if before is None else read_flow(run, before)["out_particles"].iloc[-1]
    moved = [part["name"] for part in run["parts"] if part["motion"] and f"{part['name']}_work_J" in found]
    interval = run["derived"]["report_steps"] * run["derived"]["time_step_s"]
    return pd.DataFrame(
        {
            "time_s": found["time_s"],
            "particles": found["particles"].astype(int),
            "held_mass_kg": found["held_mass_kg"],
            "inserted_particles": (filled["filled_particles"] + found["fed_particles"]).astype(int),
            "inserted_mass_kg": filled["filled_mass_kg"] + found["fed_mass_kg"],
            "out_particles": (out_before + _sum(found, [f"out_{name}_particles" for name in outlets])).astype(int),
            "out_mass_kg": _sum(found, [f"out_{name}_mass_kg" for name in outlets]),
            **{f"out_{name}_mass_kg": found[f"out_{name}_mass_kg"] for name in outlets},
            "kinetic_energy_J": found["kinetic_energy_J"],
            **{f"power_{name}_W": np.diff(found[f"{name}_work_J"], prepend=0.0) / interval for name in moved},
        }
    )


def read_flow(run: Parameters, folder: Path) -> pd.DataFrame:
    """Return the table of the flow of a block, made where it has none yet."""
    if not (folder / FLOW).exists():
        new = folder / f"{FLOW}.new"
        flow_table(run, folder).to_csv(new, index=False)
        new.replace(folder / FLOW)
    return pd.read_csv(folder / FLOW)


def whole_flow(run_folder: Path, run: Parameters, last: int, unfinished: pd.DataFrame | None = None) -> pd.DataFrame:
    """Return the table of the flow from the first block to that of the number `last`, block by block (`cycle`).

    unfinished: the table of the block after it
    """
    found = [read_flow(run, run_folder / f"cycle_{number:03d}") for number in range(last + 1)]
    found += [] if unfinished is None else [unfinished]
    return pd.concat([each.assign(cycle=k) for k, each in enumerate(found)], ignore_index=True)


def _block_before(folder: Path) -> Path | None:
    number = int(folder.name.split("_")[1].split(".")[0])
    return folder.with_name(f"cycle_{number - 1:03d}") if number else None


def _sum(table: pd.DataFrame, names: list[str]) -> pd.Series:
    return table[names].sum(axis=1) if names else pd.Series(0.0, index=table.index)


def lost_particles(flow: pd.DataFrame) -> int:
    """Return how many particles are neither in the machine nor left through an outlet, at the end of a block."""
    last = flow.iloc[-1]
    return int(last["inserted_particles"] - last["out_particles"] - last["particles"])


def lost_phrase(run: Parameters, folder: Path, flow: pd.DataFrame) -> str | None:
    """Return a phrase with the places where particles were lost in a block, None where all are accounted for."""
    lost = lost_particles(flow)
    if not lost:
        return None
    places = stray_places(folder)
    seen = "; ".join(places[:SHOWN]) or "none of them was seen near the domain's faces"
    count = f"{abs(lost)} particle{'s are' if abs(lost) > 1 else ' is'}"
    return (
        f"{count} {'missing' if lost > 0 else 'too many'} in the balance of what came in, is there and left through"
        f" outlets, allowed is none: {seen}; close the gap there, or put an outlet there"
    )


def filling_phrase(run: Parameters, run_folder: Path) -> str | None:
    """Return a phrase where a machine was not filled with the mass that was asked for, else None.

    The solver draws sizes by number, and places what it has drawn as long as there is room.
    """
    asked = filled_mass(run)
    if not asked:
        return None
    found = printed_flow(run_folder / FIRST)["filled_mass_kg"].iloc[0]
    tolerance = max(MASS_TOLERANCE * asked, SCATTER * drawn_mass_scatter(run["particle"], asked))
    filled = BedMeasure("mass", "kg", asked, found, tolerance)
    if not filled.missed:
        return None
    return f"the machine is not filled as asked: {filled.said()}; its room needs a smaller filling.fraction"


def stray_places(folder: Path) -> list[str]:
    """Return where particles were last seen near the domain's faces that are gone at the end of a block, and which way
    they went. The first balance is that of the second block: it looks into the first one too.
    """
    pictures, before = pictures_of(folder), _block_before(folder)
    if not pictures:
        return []
    left = set(read_snapshot(pictures[-1])["id"].astype(int))
    first = [before] if before is not None and _block_before(before) is None else []
    last: dict[int, np.ndarray] = {}
    looks = [block / STRAYS for block in (*first, folder)]
    for path in (path for path in looks if path.exists() and path.stat().st_size):
        for batch in read_frames(path, "ATOMS", whole_columns=("id",)):
            place = [batch.columns.index(name) for name in (*AXES, "vx", "vy", "vz")]
            ids = batch.table[:, batch.columns.index("id")].astype(int)
            last |= dict(zip(ids.tolist(), batch.table[:, place], strict=True))
    return [_place(row) for number, row in last.items() if number not in left]


def pictures_of(folder: Path) -> list[Path]:
    """Return the snapshots of the particles in a block, in the order of their steps."""
    return step_files(folder, "picture_", ".dump")


def _place(row: np.ndarray) -> str:
    """Return a phrase for a particle's place (m) and velocity (m/s)."""
    axis = int(np.argmax(np.abs(row[3:])))
    way = f"{'-' if row[3 + axis] < 0 else '+'}{AXES[axis]}"
    return f"last seen at ({', '.join(f'{1e3 * value:.4g}' for value in row[:3])}) mm, going {way}"
