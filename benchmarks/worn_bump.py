"""A small film and a table of the bump that the study worn_bump wears through, for docs/wear.md.

    snakemake worn_bump                              # in the root of the repository, first
    python -m benchmarks.worn_bump --output docs

Writes worn_bump.gif and worn_bump.csv, one row per wear cycle; takes a minute.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import pandas as pd

from benchmarks.command_line import command, output_folder
from bulkwear.postproc.plots.film import film_pictures, save_film
from bulkwear.postproc.tables.depths import depth_quantity
from bulkwear.postproc.tables.display import in_display_units
from bulkwear.postproc.tables.film import film_frames, film_surfaces, frame_table
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.state import read_state
from bulkwear.workflows.report.page_parameters import figure_remarks

STUDY, RUN = "worn_bump", "bump_convex"
FRAMES = 24  # of the small film
LARGEST_BYTES = 300_000  # of the film
EVERY = 10_000  # frames: the table has every cycle
KEPT = (
    *("worn_volume_m3", "base_worn_volume_m3", "pattern_worn_volume_m3", "carried_volume_m3", "step_demand"),
    *("smallest_angle_deg", "remeshed_faces", "largest_outward_edge_fraction", "balance_error"),
    "bed_over_floor_velocity",
)  # columns of wear.csv


def cycle_table(wear: pd.DataFrame, folder: Path) -> pd.DataFrame:
    """Return one row per cycle: the frames of a film of all of them, and what the updates did (display units)."""
    frames = film_frames(wear, EVERY)
    table = frame_table(frames, film_surfaces(folder, frames))
    return table.merge(in_display_units(wear[["cycle", *KEPT]]), on="cycle", how="left")


def remarks(fidelity: str, folder: Path) -> list[str]:
    """Return what must be known about the film: what is reduced, configuration and versions."""
    study = load_study(STUDY, overrides={"fidelity": fidelity})
    solver = read_state(folder, 1)["solver"].split(",")[0].removeprefix("Version ")
    return [*figure_remarks(study), f"config/studies/{STUDY}.yaml, fidelity {fidelity}, {solver}"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=Path, default=Path("results"))
    parser.add_argument("--fidelity", default="quick", help="at which the study was run")
    parser.add_argument("--output", type=output_folder, default="docs")
    given = parser.parse_args()
    folder = given.results / STUDY / RUN
    wear = pd.read_csv(folder / "wear.csv")
    cycle_table(wear, folder).to_csv(given.output / "worn_bump.csv", index=False, float_format="%.6g")
    frames = film_frames(wear, FRAMES)
    surfaces = film_surfaces(folder, frames)
    told = remarks(given.fidelity, folder)
    pictures = film_pictures(RUN, surfaces, frame_table(frames, surfaces), depth_quantity(True), told)
    save_film(pictures, given.output / "worn_bump.gif", LARGEST_BYTES)


if __name__ == "__main__":
    command(main)
