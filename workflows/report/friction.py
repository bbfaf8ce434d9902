"""How much of the sliding that wear is counted by is friction's work: what tells contacts that flutter.

Where a contact slides, friction does the work of the Coulomb limit over the way that it slides. A contact that sticks
has a velocity too, that of its tangential spring, so that a little of the sliding work is not friction's. Contacts
that never come to rest, because the time step is too long for how hard particles are pressed, slide to and fro: the
sliding work grows, friction's does not (docs/equipment.md).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import HOLDER_PART, read_surface
from bulkwear.postproc.readers.cycle_folders import cycle_folders
from bulkwear.workflows.report.sections import CARE, SOUND, WEAK, Light

ALMOST_ALL = 0.995  # -, a share beyond which rounding would say all
# -, of friction's work over Coulomb limit times sliding work: 0.92 to 1 in chutes, beds and a screw, 0.64 to 0.7 in a
# mill, where shorter time steps change nothing; 0.16 in the mill at a step that makes sliding work 3.6 times as large
LEAST_SHARE = 0.5
LEAST_OF_PART = 0.01  # -, of what sliding at its limit would do in a run: a part with less tells nothing of it
LEDGER, SURFACE = "ledger.parquet", "surface.vtu"
WORKS = ["tangential_work_J", "sliding_work_J"]
PERCENT = 100.0


def friction_share(run_folder: Path, frictions: Mapping[int, float] | float) -> float:
    """Return friction's work over Coulomb limit times sliding work (-), of all cycles of a run on the faces that wear,
    of the part where it is smallest; parts with hardly any of the sliding do not count.

    frictions: sliding friction (-), of all or by the label `part` of faces; NaN where no ledger is or nothing slid
    """
    works, surface = [], run_folder / SURFACE
    for folder in cycle_folders(run_folder):
        if (folder / LEDGER).is_file():
            works.append(_works(pd.read_parquet(folder / LEDGER, columns=["triangle", *WORKS]), surface, frictions))
        surface = folder / SURFACE if (folder / SURFACE).is_file() else surface
    if not works:
        return math.nan
    of_parts = pd.concat(works).groupby(level=0).sum()
    counted = of_parts[of_parts["limit"] > LEAST_OF_PART * of_parts["limit"].sum()]
    return float((counted["work"] / counted["limit"]).min())


def _works(ledger: pd.DataFrame, surface: Path, frictions: Mapping[int, float] | float) -> pd.DataFrame:
    """Return friction's `work` and Coulomb's `limit` times sliding work (J) of a cycle by part, or of all parts in one
    where they have one friction. surface: as it was in it
    """
    triangle = ledger["triangle"].to_numpy()
    part = read_surface(surface).cell_data.get("part", np.zeros(int(triangle.max(initial=0)) + 1, dtype=int))[triangle]
    work, sliding = (ledger[name].to_numpy() for name in WORKS)
    worn = part > HOLDER_PART
    several = isinstance(frictions, Mapping)
    limit = pd.Series(part).map(frictions).to_numpy() if several else np.full(len(part), frictions)
    found = pd.DataFrame({"work": work, "limit": limit * sliding, "part": part if several else 0})
    return found[worn].groupby("part").sum()


def friction_light(study: Mapping[str, Any], folder: Path) -> Light:
    """Return whether contacts slide or flutter, by the run with the smallest share of friction's work.

    study: as from `page_parameters.page_parameters`, `frictions` {run: see `friction_share`} in it; folder:
    results/<study>
    """
    shares = {run: friction_share(folder / run, of) for run, of in study["frictions"].items()}
    known = {run: share for run, share in shares.items() if math.isfinite(share)}
    what = "Contacts slide"
    if not known:
        return Light(what, CARE, "Nothing slid, or no ledger is left.")
    run, share = min(known.items(), key=lambda pair: pair[1])
    if share >= LEAST_SHARE:
        least = f"{PERCENT * share:.0f} % or more" if share < ALMOST_ALL else f"more than {PERCENT * ALMOST_ALL:g} %"
        return Light(what, SOUND, f"Friction does {least} of what sliding at its limit would.")
    return Light(
        what,
        WEAK,
        f"In {run}, on the part where it is least, friction does {PERCENT * share:.0f} % of what sliding at its limit "
        "would: contacts flutter, or stick as in square impacts, and wear by sliding is too large. Try half of "
        "solver.rayleigh_fraction.",
    )
