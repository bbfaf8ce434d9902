"""The beds of a study of the circular wear tester: what was asked of each, and what it has."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from bulkwear.workflows.cases.circular_tester import decks as tester_deck
from bulkwear.workflows.cases.circular_tester.runs import TesterRun
from bulkwear.workflows.engine.beds import MEASURES, BedMeasure
from bulkwear.workflows.report.sections import Block, Table

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

    import numpy as np
    import pandas as pd

BEDS = "tester/beds.csv"
MASS_TOLERANCE = 0.01  # -, of a level bed's mass: sizes are drawn at random until about the mass is there
LEVEL_TOLERANCE = 0.5  # -, in median diameters: no plate levels a bed finer than half a grain
MILLIMETRES = {"level": 1e3, "depth": 1e3}
NOTE = """
Asked: the mass of a level bed at the bulk density of the material, and a little more that the consolidator pushes; the
bed's height, and what of it covers the sample's middle. Found, over the last revolution before the sample comes in:
twice the height of the centre of mass of the quarter that has just left the consolidator. Over the sample the bed
heaps up above that. A bed outside a tolerance is refused.
"""


def bed_measures(bed: Mapping[str, Any], thermo: Mapping[str, np.ndarray]) -> list[BedMeasure]:
    """Return mass (kg), level past the consolidator (m) and the sample's depth under it (m), over the last revolution.

    thermo: columns of the log of the bed's deck
    """
    last = thermo["Step"] > thermo["Step"][-1] - bed["revolution_s"] / bed["time_step_s"]
    mass, level = float(thermo["bed_mass"][-1]), float(thermo["level_h"][last].mean())
    apart = MASS_TOLERANCE * tester_deck.level_mass(bed)
    near = LEVEL_TOLERANCE * bed["particle"]["median_diameter_m"]
    covering = bed["bed_height_m"] - bed["depth_m"]
    return [
        BedMeasure("mass", "kg", tester_deck.poured_mass(bed), mass, apart),
        BedMeasure("level", "m", bed["bed_height_m"], level, near),
        BedMeasure("depth", "m", bed["depth_m"], level - covering, near),
    ]


def beds_table(runs: Sequence[TesterRun]) -> pd.DataFrame:
    """Return a row per bed: shape, scale and packing of its runs, and asked, found and tolerance of each measure."""
    import pandas as pd

    rows = {}
    for run in runs:
        row = {"bed": run.bed_folder.name, "shape": run.shape, "particle_scale": run.particle_scale}
        row["packing"] = run.packing
        for each in pd.read_csv(run.bed_folder / MEASURES).itertuples():
            unit, factor = ("mm", MILLIMETRES[each.measure]) if each.measure in MILLIMETRES else (each.unit, 1.0)
            for what in ("asked", "found", "tolerance"):
                row[f"{each.measure}_{what}_{unit}"] = factor * getattr(each, what)
        rows[run.bed_folder] = row
    return pd.DataFrame(list(rows.values()))


def beds(folder: Path) -> list[Block]:
    """Return the table of a study's beds."""
    import pandas as pd

    return [Table(pd.read_csv(folder / BEDS), "beds", NOTE)]
