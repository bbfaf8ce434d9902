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

# -, of friction's work over Coulomb limit times sliding work: 0.92 to 1 in chutes, beds and a screw, 0.64 to 0.7 in a
# mill, where shorter time steps change nothing; 0.16 in the mill at a step that makes sliding work 3.6 times as large
LEAST_SHARE = 0.5
LEDGER, SURFACE = "ledger.parquet", "surface.vtu"
WORKS = ["tangential_work_J", "sliding_work_J"]
PERCENT = 100.0


def friction_share(run_folder: Path, frictions: Mapping[int, float] | float) -> float:
    """Return friction's work over Coulomb limit times sliding work (-), of all cycles of a run on the faces that wear.

    frictions: sliding friction (-), of all or by the label `part` of faces; NaN where no ledger is or nothing slid
    """
    total, surface = np.zeros(2), run_folder / SURFACE
    for folder in cycle_folders(run_folder):
        if (folder / LEDGER).is_file():
            total += _works(pd.read_parquet(folder / LEDGER, columns=["triangle", *WORKS]), surface, frictions)
        surface = folder / SURFACE if (folder / SURFACE).is_file() else surface
    return float(total[0] / total[1]) if total[1] > 0.0 else math.nan


def _works(ledger: pd.DataFrame, surface: Path, frictions: Mapping[int, float] | float) -> np.ndarray:
    """Return friction's work and the Coulomb limit times sliding work (J) of a cycle. surface: as it was in it"""
    triangle = ledger["triangle"].to_numpy()
    part = read_surface(surface).cell_data.get("part", np.zeros(int(triangle.max(initial=0)) + 1, dtype=int))[triangle]
    work, sliding = (ledger[name].to_numpy() for name in WORKS)
    worn = part > HOLDER_PART
    limit = pd.Series(part).map(frictions).to_numpy() if isinstance(frictions, Mapping) else frictions
    return np.array([work[worn].sum(), (limit * sliding)[worn].sum()])


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
        return Light(what, SOUND, f"Friction does {PERCENT * share:.0f} % or more of what sliding at its limit would.")
    return Light(
        what,
        WEAK,
        f"In {run} friction does {PERCENT * share:.0f} % of what sliding at its limit would: contacts flutter, or "
        "stick as in square impacts, and wear by sliding is too large. Try half of solver.rayleigh_fraction.",
    )
