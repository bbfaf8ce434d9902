"""Lifters of the drums of a study against hours of operation: heights and face angles, as built and after updates."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.intervals import estimate
from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.postproc.wear.lifter_profile import Lifters, lifter_profile
from bulkwear.workflows.cases.equipment.flow_views import LEVEL
from bulkwear.workflows.cases.equipment.pictures import labels_of, part_mesh, turns_about, wearing
from bulkwear.workflows.cases.equipment.sections import shown_shapes
from bulkwear.workflows.cases.equipment.tables import HOURS, with_ends

HEIGHT, LEADING, TRAILING = "height_mm", "leading_face_angle_deg", "trailing_face_angle_deg"
LOSS = "height_loss_mm_per_1000h"
MEANS = (HEIGHT, LEADING, TRAILING, LOSS)  # over packings, each with the ends of its interval
AT = ["setting", "part", "update"]


def lifters_table(runs: Sequence[Mapping[str, Any]], folder: Path) -> pd.DataFrame:
    """Return a row per setting, part that turns about a level axis, and update of its shape, the first one as built.

    operation_h, packings, lifters: as many as there are, the least of all packings; MEANS: over lifters, then over
    packings, with the ends _low and _high of their intervals; LOSS: since the shape as built, packing by packing.
    Packings are put together by the number of the update, as many as the first one has; their hours differ, operation_h
    is the mean. A part without lifters as built has no rows. runs: values of `tables.values_of_runs`; folder:
    results/<study>
    """
    columns = ["setting", "part", "operation_h", "packings", "lifters"]
    columns += [f"{name}{end}" for name in MEANS for end in ("", "_low", "_high")]
    rows = []
    for (setting, part, _), packings in _by_packing(runs, folder).groupby(AT, sort=False):
        if packings["packing"].iloc[0] == min(run["packing"] for run in runs if run["setting"] == setting):
            row = {"setting": setting, "part": part, "operation_h": packings["operation_h"].mean()}
            row |= {"packings": len(packings), "lifters": packings["lifters"].min()}
            for name in MEANS:
                row |= with_ends(name, estimate(packings[name].to_numpy(float)))
            rows.append(row)
    return pd.DataFrame(rows, columns=columns)


def _by_packing(runs: Sequence[Mapping[str, Any]], folder: Path) -> pd.DataFrame:
    """Return a row per run, part with lifters and update: AT, packing, operation_h, lifters, MEANS."""
    rows = []
    for run in runs:
        drums, labels = _drums(run), labels_of(run)
        shapes = shown_shapes(folder / run["run"], math.inf) if drums else []
        for name, axis in drums.items():
            meshes = [part_mesh(surface, labels[name])[0] for _, surface in shapes]
            found = [lifter_profile(mesh.points, mesh.triangles, *axis) for mesh in meshes]
            own = {"setting": run["setting"], "packing": run["packing"], "part": name}
            if len(found[0]):
                hours = [hour for hour, _ in shapes]
                rows += [own | row for row in _course(hours, found)]
    return pd.DataFrame(rows, columns=[*AT, "packing", "operation_h", "lifters", *MEANS])


def _drums(run: Mapping[str, Any]) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return {name: point (3,) m and axis (3,)} of the parts that wear and turn about a level axis."""
    found = {name: turns_about(run["parts"][name]["motion"]) for name in wearing(run)}
    return {name: turning for name, turning in found.items() if turning is not None and abs(turning[1][2]) < LEVEL}


def _course(hours: Sequence[float], found: Sequence[Lifters]) -> list[dict[str, Any]]:
    """Return a row per update of a run, with means over lifters, NaN where none are left."""
    rows, built = [], MILLIMETRES * float(found[0].height_m.mean())
    for update, (hour, lifters) in enumerate(zip(hours, found, strict=True)):
        row = {"update": update, "operation_h": hour, "lifters": len(lifters)}
        if len(lifters):
            row |= {HEIGHT: MILLIMETRES * float(lifters.height_m.mean())}
            row |= {LEADING: lifters.leading_face_deg.mean(), TRAILING: lifters.trailing_face_deg.mean()}
            row |= {LOSS: HOURS * (built - row[HEIGHT]) / hour} if update else {}
        rows.append(row)
    return rows
