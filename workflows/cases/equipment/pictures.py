"""What maps of a study of equipment show: the parts that wear with values on their faces, worst places, rigid parts.

A run is what a job is told of it, see `map_figures.runs_as_told`. Values of faces are those of their area patches,
means over blocks and packings, on the surface as built of the first packing of a setting; all packings are built alike.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import SurfaceMesh, read_surface
from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.postproc.wear.area_patches import area_patches
from bulkwear.workflows.cases.equipment.change_out import remaining_m, rule_of
from bulkwear.workflows.cases.equipment.tables import AT_A_PATCH, HOURS, KG_PER_MT, SECONDS_PER_HOUR

SURFACE = "surface.vtu"
MARKED = 3  # worst places of a part that are marked
RECESSION, REMAINING = "recession", "remaining"  # quantities of maps: mm per 1,000 h, mm
TURNING = ("rotation", "turning_surface")  # kinds of motion about an axis for good
Run = Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class PartMap:
    """A part of a setting as it was drawn or has worn, with values on its faces.

    mesh: of this part alone, m; values: {quantity: (m,)}, NaN where there is none
    wear: (m,), by which views are chosen; marks: {text: place (3,) m}
    turns_about: point (3,) m and axis (3,) of its right-handed rotation, None where it does not turn
    note: what stands below its name
    """

    setting: str
    part: str
    mesh: SurfaceMesh
    values: Mapping[str, np.ndarray]
    wear: np.ndarray
    marks: Mapping[str, np.ndarray] = field(default_factory=dict)
    turns_about: tuple[np.ndarray, np.ndarray] | None = None
    note: str = ""


# ---------------------------------------------------------------- runs and parts


def first_runs(runs: Sequence[Run]) -> list[Run]:
    """Return the first packing of each setting."""
    return list({run["setting"]: run for run in reversed(runs)}.values())[::-1]


def shown_runs(runs: Sequence[Run], most: int) -> list[Run]:
    """Return the runs of the first so many settings."""
    settings = list(dict.fromkeys(run["setting"] for run in runs))[:most]
    return [run for run in runs if run["setting"] in settings]


def designs_remark(runs: Sequence[Run], most: int) -> list[str]:
    """Return what a figure of the first so many settings must say where there are more."""
    count = len({run["setting"] for run in runs})
    return [f"{most} of {count} designs are shown"] if count > most else []


def packings_remark(runs: Sequence[Run]) -> list[str]:
    """Return what a figure of first packings must say where there are others."""
    most = max(run["packing"] for run in runs)
    return [f"the first of {most} packings is shown"] if most > 1 else []


def labels_of(run: Run) -> dict[str, int]:
    """Return the label of the faces of each part of a run."""
    return {name: number if part["wears"] else -1 - number for number, (name, part) in enumerate(run["parts"].items())}


def wearing(run: Run) -> list[str]:
    """Return the names of the parts of a run that wear."""
    return [name for name, part in run["parts"].items() if part["wears"]]


def turns_about(motion: Mapping[str, Any] | None) -> tuple[np.ndarray, np.ndarray] | None:
    """Return point (3,) m and unit axis (3,) of a motion that turns for good, right-handed; None of others."""
    if not motion or motion["kind"] not in TURNING or not motion["speed_rad_per_s"]:
        return None
    axis = np.asarray(motion["axis"], dtype=float)
    return np.asarray(motion["point_m"], dtype=float), axis / np.linalg.norm(axis) * np.sign(motion["speed_rad_per_s"])


def part_mesh(surface: SurfaceMesh, label: int) -> tuple[SurfaceMesh, np.ndarray]:
    """Return the part with a label of a surface of several, with its data, and which faces (m,) of all are its own."""
    faces = np.flatnonzero(surface.cell_data["part"] == label)
    nodes, triangles = np.unique(surface.triangles[faces], return_inverse=True)
    cells = {name: values[faces] for name, values in surface.cell_data.items()}
    points = {name: values[nodes] for name, values in surface.point_data.items()}
    return SurfaceMesh(surface.points[nodes], triangles.reshape(-1, 3), cells, points), faces


def rigid_parts(runs: Sequence[Run], folder: Path) -> dict[str, list[SurfaceMesh]]:
    """Return the surfaces of the parts that keep their shape by setting; folder: results/<study>."""
    found = {}
    for run in first_runs(runs):
        surface, labels = read_surface(folder / run["run"] / SURFACE), labels_of(run)
        found[run["setting"]] = [part_mesh(surface, label)[0] for label in labels.values() if label < 0]
    return found


def mm_per_mt(runs: Sequence[Run]) -> dict[str, float]:
    """Return how many mm per Mt 1 mm per 1,000 h is, by setting; NaN without an inlet."""
    found = {}
    for run in first_runs(runs):
        rate = run["rate_kg_per_s"]
        found[run["setting"]] = np.nan if rate is None else KG_PER_MT / (HOURS * SECONDS_PER_HOUR * rate)
    return found


def hours_per_mt(runs: Sequence[Run]) -> dict[str, float]:
    """Return how many hours of operation a Mt takes, by setting; NaN without an inlet."""
    return {setting: HOURS * factor for setting, factor in mm_per_mt(runs).items()}


# ---------------------------------------------------------------- maps


def patch_maps(
    runs: Sequence[Run],
    folder: Path,
    rates: pd.DataFrame,
    columns: Mapping[str, str],
    worst: pd.DataFrame | None = None,
) -> list[PartMap]:
    """Return maps of the parts that wear, of every setting.

    rates: as from `tables.rates_table`; columns: {quantity: column of it}; worst: as from `life_tables.worst_places`
    Faces of patches that wear nothing have no value.
    """
    found = []
    for run in first_runs(runs):
        surface, labels = read_surface(folder / run["run"] / SURFACE), labels_of(run)
        patches = area_patches(surface, run["patch_m"])
        for name in wearing(run):
            mesh, faces = part_mesh(surface, labels[name])
            rows = rates[(rates["setting"] == run["setting"]) & (rates["part"] == name)].set_index("patch")
            own = rows.reindex(patches[faces])
            wear = own["pristine_mm_per_1000h"].to_numpy(float)
            values = {
                quantity: np.where(wear > 0.0, own[column].to_numpy(float), np.nan)
                for quantity, column in columns.items()
            }
            marks = {} if worst is None else marks_of(worst, run["setting"], name)
            turning = turns_about(run["parts"][name]["motion"])
            found.append(PartMap(run["setting"], name, mesh, values, np.nan_to_num(wear), marks, turning))
    return found


def recession_maps(runs: Sequence[Run], folder: Path, rates: pd.DataFrame, worst: pd.DataFrame) -> list[PartMap]:
    """Return maps of the recession as built (mm per 1,000 h), worst places marked; see `patch_maps`."""
    return patch_maps(runs, folder, rates, {RECESSION: "pristine_mm_per_1000h"}, worst)


def load_maps(runs: Sequence[Run], folder: Path, rates: pd.DataFrame) -> list[PartMap]:
    """Return maps of pressure, sliding velocity, sliding power and impact power as built, SI; see `patch_maps`."""
    return patch_maps(runs, folder, rates, {name: name for name in AT_A_PATCH})


def marks_of(worst: pd.DataFrame, setting: str, part: str) -> dict[str, np.ndarray]:
    """Return the first of the worst places of a part, (3,) m, by their rank."""
    rows = worst[(worst["setting"] == setting) & (worst["part"] == part) & (worst["rank"] <= MARKED)]
    places = rows[["x_mm", "y_mm", "z_mm"]].to_numpy(float) / MILLIMETRES
    return {f"{rank:.0f}": place for rank, place in zip(rows["rank"], places, strict=True)}


def change_out_mm(runs: Sequence[Run]) -> dict[str, float]:
    """Return the remaining thickness (mm) at which each part is changed; NaN where that is not one thickness."""
    found: dict[str, set[float]] = {}
    for run in runs:
        for name in wearing(run):
            part = run["parts"][name]
            due = remaining_m(rule_of(run["operation"], part), part["thickness_m"])
            found.setdefault(name, set()).add(MILLIMETRES * due)
    return {name: values.pop() if len(values) == 1 else np.nan for name, values in found.items()}


def patch_rows(rates: pd.DataFrame, *columns: str) -> pd.DataFrame:
    """Return the patches of a table of rates with some of its columns."""
    return rates[["setting", "part", "patch", "x_mm", "y_mm", "z_mm", "area_mm2", *columns]]
