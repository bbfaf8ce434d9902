"""Worn volume by several wear laws from the ledgers of the same cycles: the laws side by side, nothing simulated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import read_surface, worn_faces
from bulkwear.postproc.readers.cycle_folders import cycle_folders
from bulkwear.postproc.tables.history import runs_of
from bulkwear.postproc.wear.laws import LAWS, worn_volume

SURFACE, LEDGER = "surface.vtu", "ledger.parquet"


def laws_beside(law: str) -> list[str]:
    """Return the laws that the ledgers of a run worn by `law` serve: that one first, and all that take no parameters
    and no contact kernels but its own.
    """
    summed = set(LAWS[law].kernels)
    served = (name for name, each in LAWS.items() if not each.parameters and summed.issuperset(each.kernels))
    return [law, *(name for name in served if name != law)]


def volumes_by_law(folder: Path, laws: Sequence[str], parameters: Mapping[str, float]) -> dict[str, float]:
    """Return {law: worn volume (m3)} of all wear cycles of a run, by laws that the columns of all its ledgers suffice
    for.

    folder: of the run, with a surface after every cycle
    parameters: of the laws, SI, the coefficient included: the same for all
    """
    before, cycles = folder / SURFACE, []
    for cycle in (each for each in cycle_folders(folder) if (each / LEDGER).is_file()):
        ledger, worn = pd.read_parquet(cycle / LEDGER), worn_faces(read_surface(before))
        columns = {name: ledger[name].to_numpy()[worn] for name in ledger}
        cycles.append({law: volume for law in laws if (volume := _volume(law, columns, parameters)) is not None})
        before = cycle / SURFACE
    return {law: sum(each[law] for each in cycles) for law in laws if all(law in each for each in cycles)}


def _volume(law: str, columns: Mapping[str, np.ndarray], parameters: Mapping[str, float]) -> float | None:
    """Return the volume of a cycle; None where its ledger, of an older program, lacks a column."""
    try:
        return float(worn_volume(law, columns, parameters).sum())
    except KeyError:
        return None


def law_volumes(
    design: str | Path, folders: Sequence[Path], laws: Mapping[str, tuple[str, Mapping[str, float]]]
) -> pd.DataFrame:
    """Return RUN, law, worn_volume_m3 and over_study_law (-), a line per run and law, the study's own law first.

    folders: of the runs, in the order of the design
    laws: {run: (its wear law, parameters of that, SI)}; the coefficient is that of all laws
    """
    rows = []
    for run, folder in zip(runs_of(design).to_dict("records"), folders, strict=True):
        own, parameters = laws[run["run"]]
        volumes = volumes_by_law(folder, laws_beside(own), parameters)
        for law, volume in volumes.items():
            ratio = volume / volumes[own] if volumes[own] > 0.0 else np.nan
            rows.append({**run, "law": law, "worn_volume_m3": volume, "over_study_law": ratio})
    return pd.DataFrame(rows)
