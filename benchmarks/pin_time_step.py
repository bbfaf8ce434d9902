"""Up to which time step a pin in its groove is stable: noise of its force and its work, in grooves of three depths.

    python -m benchmarks.pin_time_step --output docs        # in the root of the repository
    python -m benchmarks.pin_time_step --output docs --redraw

Writes pin_time_step.csv and .png; `--redraw` makes the picture from the table. Takes some minutes of one core.
"""

from __future__ import annotations

import argparse
import itertools
import tempfile
from datetime import date
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks.command_line import command, output_folder, read_table
from benchmarks.plots.time_step import time_step_limit
from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.plots.style import save
from tests.verification.ledger_cases import LOAD, RADIUS
from tests.verification.pin_cases import TIME_STEP, disc, ride, round_groove, stable_step, worn_groove

ELEMENT, BAND = 1e-4, 1.2e-3  # m
RESTITUTIONS = (0.5, 0.9)
OVER_LIMIT = (0.5, 0.7, 0.85, 0.95, 1.05, 1.15, 1.3)  # -, time steps over the closed form's limit


def surfaces() -> dict[str, SurfaceMesh]:
    """Return the grooves by name."""
    flat = disc(ELEMENT, BAND)
    return {
        "worn, 2.2 µm deep": worn_groove(flat),
        "round, 0.1 mm deep": round_groove(flat, 1e-4),
        "round, 0.3 mm deep": round_groove(flat, 3e-4),
    }


def study(folder: Path) -> pd.DataFrame:
    """Return a row per groove, restitution and time step; NaN where the pin was thrown out."""
    rows = []
    for (name, mesh), restitution in itertools.product(surfaces().items(), RESTITUTIONS):
        contacts = ride(folder / "first", mesh, 0.25 * TIME_STEP, restitution).contacts
        for ratio in OVER_LIMIT:
            step = ratio * stable_step(contacts, restitution)
            try:
                found = ride(folder / "ride", mesh, step, restitution)
            except RuntimeError:
                measured = dict.fromkeys(("mean_force_over_load", "force_deviation_over_load", "work_over_FL"), np.nan)
            else:
                names = ("mean_force_over_load", "force_deviation_over_load", "work_over_FL")
                measured = dict(zip(names, (found.mean, found.deviation, found.work), strict=True))
            row = {"groove": name, "restitution": restitution, "contacts": contacts, "time_step_s": step}
            rows.append({**row, "time_step_over_limit": ratio, **measured})
            print(pd.DataFrame(rows[-1:]).to_string(index=False, header=False), flush=True)
    return pd.DataFrame(rows)


def remarks() -> list[str]:
    """Return what must be known about the figure."""
    return [
        f"LIGGGHTS: pin of radius {1e3 * RADIUS:g} mm, {LOAD:g} N, softened as in Yan 2022 (Table 5.2), over a degree "
        f"of a groove with elements of {1e3 * ELEMENT:g} mm; limit: postproc/reference/sphere_contact.py",
        "at the top: the pin was thrown out",
        f"made by benchmarks/pin_time_step.py, {date.today():%Y-%m-%d}",
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=output_folder, default="docs")
    parser.add_argument("--redraw", action="store_true", help="from the table of an earlier run")
    given = parser.parse_args()
    file = given.output / "pin_time_step.csv"
    if not given.redraw:
        with tempfile.TemporaryDirectory() as folder:
            study(Path(folder)).to_csv(file, index=False, float_format="%.5g")
    save(time_step_limit(read_table(file), remarks()), given.output / "pin_time_step.png")


if __name__ == "__main__":
    command(main)
