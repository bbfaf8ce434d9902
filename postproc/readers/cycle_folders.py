"""The folders `cycle_<nnn>` of a run: those of finished cycles, in their order, and files in them by time step."""

from __future__ import annotations

import re
from pathlib import Path

FINISHED = re.compile(r"cycle_(\d+)")  # one that is worked on, or was left by a killed run, ends in .part
PACKING = "packing.dump"  # of cycle 0 in a travelling window: the settled bed, out of which it takes fresh bed
FLOW_TABLE = "flow.parquet"  # of a wear cycle: the bins that its snapshots were reduced to
SPIN_TABLE = "spin.parquet"  # likewise, of the lowest layer along the sample
LAYER_TABLE = "lowest_layer.csv"  # of a wear cycle of the circular tester: what its snapshots were reduced to


def cycle_folders(run_folder: str | Path) -> list[Path]:
    """Return the folders of a run's finished cycles, by number."""
    found = ((FINISHED.fullmatch(path.name), path) for path in Path(run_folder).glob("cycle_*"))
    return [path for _, path in sorted((int(match[1]), path) for match, path in found if match)]


def step_files(folder: str | Path, before: str, after: str) -> list[Path]:
    """Return the files of a folder that the solver named by time steps, in their order, as `bed_` 100 `.dump`.

    Files of a user's own deck with other words in the place of the step, as `bed_mine_100.dump`, are none of them.
    """
    name = re.compile(rf"{re.escape(before)}(\d+){re.escape(after)}")
    found = ((name.fullmatch(path.name), path) for path in Path(folder).glob(f"{before}*{after}"))
    return [path for _, path in sorted((int(match[1]), path) for match, path in found if match)]


def cycle_files(run_folder: str | Path, name: str) -> list[Path]:
    """Return the files of that name that finished cycles have, by number of the cycle."""
    return [folder / name for folder in cycle_folders(run_folder) if (folder / name).is_file()]
