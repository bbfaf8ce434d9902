"""Maps of what is left of the parts that wear: as built, after the last simulated hour, and at hours that are wanted.

An hour between updates, or after the last one, has the surface of the update before: from there on each face loses as
much as its area patch does, as in the table of what is left. What the caps of the updates held back, and is not on that
surface yet, is lost as well, evenly over each patch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import SurfaceMesh, areas, read_surface, worn_faces
from bulkwear.postproc.readers.cycle_folders import cycle_files
from bulkwear.postproc.tables.depths import face_depth
from bulkwear.postproc.tables.display import MILLIMETRES, few_digits
from bulkwear.postproc.wear.area_patches import area_patches, patch_means, patches_of
from bulkwear.postproc.wear.fields import REMOVED_THICKNESS
from bulkwear.postproc.wear.side import turned_as
from bulkwear.postproc.wear.thickness import (
    BACK_LOST_THICKNESS,
    LOCAL_THICKNESS,
    remaining_thickness,
    thickness_to_back,
)
from bulkwear.workflows.cases.equipment.blocks import patches_behind
from bulkwear.workflows.cases.equipment.life import patch_courses
from bulkwear.workflows.cases.equipment.life_tables import (
    BEYOND,
    HOURS_OF_REMAINING,
    hours_apart,
    how_told,
    wanted_hours,
)
from bulkwear.workflows.cases.equipment.pictures import (
    REMAINING,
    SURFACE,
    PartMap,
    Run,
    first_runs,
    labels_of,
    part_mesh,
    turns_about,
    wearing,
)
from bulkwear.workflows.cases.equipment.tables import read_runs

WORN_SURFACE = "worn_surface.vtu"
COLUMNS = ["setting", "part", "patch", "operation_h", "mean_remaining_mm", "least_remaining_mm", "how"]


@dataclass(frozen=True, eq=False)
class State:
    """What is left of a run after hours of operation.

    surface: of the last update before; how: SIMULATED or BEYOND; patch: (m,) area patch of each face, negative without
    left: (m,) m on each face, at least 0; NaN where no thickness is known
    """

    hours: float
    how: str
    surface: SurfaceMesh
    patch: np.ndarray
    left: np.ndarray


def states_of(run: Run, folder: Path) -> list[State]:
    """Return a run as built, after its last update, and at the hours that are wanted; folder: results/<study>."""
    place, states = folder / run["run"], []
    shapes, tables, pristine = _shapes(place), read_runs([run], folder), read_surface(place / SURFACE)
    patches, worn_for = area_patches(pristine, run["patch_m"]), shapes[-1][0]
    behind = patches_behind(pristine, patches, _given(run))
    of_parts = [patch_courses(tables, run["setting"], part) for part in wearing(run)]
    for hours in hours_apart([0.0, worn_for, *wanted_hours(run["operation"])]):
        since, file = next(shape for shape in reversed(shapes) if shape[0] <= hours * (1.0 + HOURS_OF_REMAINING))
        surface = read_surface(file)
        patch = patches_of(surface, pristine, patches)
        held = held_back(surface, patch, patches.max() + 1)
        lost = held + behind @ held
        for places, (course,) in of_parts:
            lost[places.index] += course.at(hours) - course.at(min(since, hours))
        left = left_of_faces(surface, pristine) - np.where(patch >= 0, lost[patch], 0.0)
        states.append(State(hours, how_told(hours, worn_for), surface, patch, np.maximum(left, 0.0)))
    return states


def _given(run: Run) -> list[int]:
    """Return the labels of the parts whose thickness is given."""
    labels = labels_of(run)
    return [labels[name] for name, part in run["parts"].items() if part["thickness_m"] is not None]


def held_back(surface: SurfaceMesh, patch: np.ndarray, count: int) -> np.ndarray:
    """Return the depth (count,) m that the law took of each patch and caps on the updates hold back, 0 of none.

    patch: (m,) of each face, negative without
    """
    removed = surface.point_data[REMOVED_THICKNESS][surface.triangles].mean(axis=1)
    held, size = face_depth(surface, deformed=True) - removed, areas(surface.points, surface.triangles)
    return np.nan_to_num(patch_means(held, size, patch, count))


def left_of_faces(surface: SurfaceMesh, pristine: SurfaceMesh) -> np.ndarray:
    """Return the thickness (m,) m left on each face: the mean of what its corners have left, less what they were
    thicker as built than the face itself. A ray from a corner at a rim may pass the back, and then the thickness of the
    corner is that from the rim's own face along the part.

    Where thickness is given, and where no ray from a face as built finds its back, the mean alone; NaN where a corner
    has no thickness.
    """
    left = remaining_thickness(surface)[surface.triangles].mean(axis=1)
    if not np.isfinite(surface.point_data.get(BACK_LOST_THICKNESS, np.nan)).any():
        return left
    faces, measured = worn_faces(pristine), np.isfinite(surface.point_data[BACK_LOST_THICKNESS])
    nearest = patches_of(surface, pristine, np.where(faces, np.arange(len(faces)), -1))
    own = np.where(nearest >= 0, _thickness_of_faces(turned_as(pristine, surface), faces)[nearest], np.nan)
    thicker = surface.point_data[LOCAL_THICKNESS][surface.triangles].mean(axis=1) - own
    known = np.isfinite(thicker) & measured[surface.triangles].all(axis=1)
    return np.maximum(left - np.where(known, thicker, 0.0), 0.0)


def _thickness_of_faces(built: SurfaceMesh, faces: np.ndarray) -> np.ndarray:
    """Return how far (m,) m it is through a part as built from each of some faces (m,) bool, as the mean over those of
    its corners that have the back behind them; NaN where none has.
    """
    label, thickness = np.asarray(built.cell_data.get("part", np.zeros(len(faces)))), np.full(len(faces), np.nan)
    for part in np.unique(label[faces]):
        own = np.flatnonzero(label == part)
        found = thickness_to_back(built.points, built.triangles[own])[0]
        some = np.isfinite(found).any(axis=1)
        thickness[own[some]] = np.nanmean(found[some], axis=1)
    return thickness


def _shapes(place: Path) -> list[tuple[float, Path]]:
    """Return (hours of operation, surface) of a run as built and after each update."""
    wear, files = pd.read_csv(place / "wear.csv"), cycle_files(place, SURFACE)
    hours = (wear["operation_h"] + wear["stands_for_h"]).tolist()
    updates = [
        shape for shape, stood in zip(zip(hours, files, strict=True), wear["stands_for_h"], strict=True) if stood
    ]
    shapes = [(0.0, files[0]), *updates]
    return shapes if not updates else [*shapes[:-1], (hours[-1], place / WORN_SURFACE)]


def remaining_maps(runs: Sequence[Run], folder: Path) -> list[PartMap]:
    """Return maps of the remaining thickness (mm) of the states of the first packing of each setting; the settings are
    called so.
    """
    found, several = [], len(first_runs(runs)) > 1
    for run in first_runs(runs):
        labels = labels_of(run)
        for state in states_of(run, folder):
            title = f"{run['setting']}, {words(state)}" if several else words(state)
            for name in wearing(run):
                mesh, faces = part_mesh(state.surface, labels[name])
                lost = mesh.point_data["removed_thickness_m"][mesh.triangles].mean(axis=1)
                values = {REMAINING: MILLIMETRES * state.left[faces]}
                turning = turns_about(run["parts"][name]["motion"])
                found.append(PartMap(title, name, mesh, values, lost, {}, turning))
    return found


def most_designs(runs: Sequence[Run], most: int) -> int:
    """Return how many designs a figure of so many maps of a part has room for, one or more."""
    states = 2 + max(len(wanted_hours(run["operation"])) for run in runs)
    return max(most // states, 1)


def words(state: State) -> str:
    """Return what a state is called."""
    if not state.hours:
        return "as built"
    return f"after {few_digits(state.hours, 4)} h" + (f", {BEYOND}" if state.how == BEYOND else "")


def remaining_rows(runs: Sequence[Run], folder: Path) -> pd.DataFrame:
    """Return COLUMNS of what `remaining_maps` shows by area patches. Patches of which no thickness is known are left
    out.
    """
    tables = []
    for run in first_runs(runs):
        names = {label: name for name, label in labels_of(run).items()}
        for state in states_of(run, folder):
            table = pd.DataFrame({"label": state.surface.cell_data["part"], "patch": state.patch})
            table["remaining_mm"] = MILLIMETRES * state.left
            table["weight"] = areas(state.surface.points, state.surface.triangles)
            table = table[(table["patch"] >= 0) & np.isfinite(table["remaining_mm"])]
            table["weighted"] = table["weight"] * table["remaining_mm"]
            by_patch = table.groupby(["label", "patch"])
            sums = by_patch[["weight", "weighted"]].sum()
            found = pd.DataFrame({"mean_remaining_mm": sums["weighted"] / sums["weight"]})
            found["least_remaining_mm"] = by_patch["remaining_mm"].min()
            found = found.reset_index().assign(setting=run["setting"], operation_h=state.hours, how=state.how)
            tables.append(found.assign(part=found["label"].map(names)))
    return pd.concat(tables, ignore_index=True)[COLUMNS]
