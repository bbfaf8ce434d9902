"""Which measurement tells wear laws apart: volume against the angle of impact, in closed form, at one speed.

    python -m benchmarks.impact_angle --output docs        # in the root of the repository; a second

Writes impact_angle.csv, a row per law, and impact_angle.png.
"""

from __future__ import annotations

import argparse
from functools import partial

import numpy as np
import pandas as pd

from benchmarks.command_line import command, output_folder
from benchmarks.plots.impact_angle import angle_curves
from bulkwear.postproc.plots.style import save, save_small
from bulkwear.postproc.reference.impact_angle import angle_of_largest_wear, finnie, impact_energy, oka, sliding_work
from bulkwear.workflows.config.design import load_study

TESTED = (90, 60, 30, 15)  # degrees, of the study which_law
OVER = 30  # degrees, of the test that the others are set over
DIGITS = 3


def laws() -> dict[str, partial]:
    """Return {law: volume of an impact by angle (rad)} with friction, restitution and constants of that study."""
    study = load_study("which_law")
    contact = study.materials["walls"][study.settings["parts"]["plate"]["material"]]["contact"]
    names = ("angle_exponent", "hardness_exponent", "hardness_pa")
    constants = {name: study.settings["wear"]["parameters"][name] for name in names}
    sliding = partial(sliding_work, friction=contact["sliding_friction"], restitution=contact["restitution"])
    return {
        "Archard, shear work": sliding,
        "Finnie": finnie,
        "Oka": partial(oka, **constants),
        "impact energy": impact_energy,
    }


def table() -> pd.DataFrame:
    """Return law, angle of largest wear (degrees), and volumes at TESTED over that at OVER (-)."""
    rows = []
    for name, law in laws().items():
        volumes = {f"at_{angle}_over_{OVER}": float(law(np.radians(angle)) / law(np.radians(OVER))) for angle in TESTED}
        rows.append({"law": name, "largest_wear_deg": np.degrees(angle_of_largest_wear(law)), **volumes})
    return pd.DataFrame(rows)


def main() -> None:
    """Write table and figure."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--output", type=output_folder, default="benchmark")
    folder = parser.parse_args().output
    found, degrees = table(), np.arange(0.0, 90.5, 0.5)
    found.round(DIGITS).to_csv(folder / "impact_angle.csv", index=False)
    largest = dict(zip(found["law"], found["largest_wear_deg"], strict=True))
    values = {name: law(np.radians(degrees)) / law(np.radians(largest[name])) for name, law in laws().items()}
    picture = folder / "impact_angle.png"
    remarks = ["single spheres without spin at one speed, closed forms; in the legend the angle of the largest wear"]
    save(angle_curves(pd.DataFrame({"angle_deg": degrees, **values}), largest, remarks), picture)
    save_small(picture, picture)


if __name__ == "__main__":
    command(main)
