"""What a block of simulated time does to the parts of a machine: tables by area patch and by part.

Rates are those of the true wear coefficient per hour of operation, whatever the wear of the block stands for.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy import optimize, sparse

from bulkwear.postproc.mesh import SurfaceMesh, areas, edge_lengths_per_triangle, read_surface, stl_corners
from bulkwear.postproc.statistics.intervals import error_of_mean, students_t
from bulkwear.postproc.wear.area_patches import area_patches, patch_means, patch_sums, patch_table, patches_of
from bulkwear.postproc.wear.caps import edge_limit
from bulkwear.postproc.wear.fields import REMOVED_THICKNESS
from bulkwear.postproc.wear.kernel_sums import columns_of_law
from bulkwear.postproc.wear.laws import worn_volume
from bulkwear.postproc.wear.part_loads import part_loads
from bulkwear.postproc.wear.thickness import LOCAL_THICKNESS, thickness_to_back, with_thickness
from bulkwear.workflows.cases.equipment.change_out import allowed_depths, rule_of
from bulkwear.workflows.cases.equipment.life import thinning
from bulkwear.workflows.cases.equipment.motions import axis_point
from bulkwear.workflows.cases.equipment.parameters import law_values, sums_of
from bulkwear.workflows.cases.equipment.phases import phase_of
from bulkwear.workflows.cases.equipment.surfaces import faces_of, label_of
from bulkwear.workflows.engine.schedule import Span

PATCHES, PARTS = "patches.csv", "parts.csv"
SECONDS_PER_HOUR = 3600.0
CONFIDENCE = 0.95
MOST_HELD_BACK = 0.1  # -, of the wear of an update, by caps on single nodes: the worn shape lags no further behind
LATEST = 4  # blocks whose mean recession says how far the next update may go

Parameters = Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class Geometry:
    """A run's pristine surface with its local thickness, the area patch of each face, the table of patches, and those
    behind each patch, see `patches_behind`.
    """

    surface: SurfaceMesh
    patch: np.ndarray
    table: pd.DataFrame
    behind: sparse.csr_array


@lru_cache(maxsize=4)
def _geometry(path: Path, stamp: int, length: float, given: tuple[tuple[int, float], ...]) -> Geometry:
    surface = with_thickness(read_surface(path), dict(given))
    patch = area_patches(surface, length)
    table = pd.DataFrame(patch_table(surface, patch))
    size = areas(surface.points, surface.triangles)
    thickness = surface.point_data[LOCAL_THICKNESS][surface.triangles].mean(axis=1)
    table = table.assign(thickness_m=patch_means(thickness, size, patch, len(table)))
    return Geometry(surface, patch, table, patches_behind(surface, patch, dict(given)))


def patches_behind(surface: SurfaceMesh, patch: np.ndarray, given: Collection[int]) -> sparse.csr_array:
    """Return by which shares (count, count) of its area each patch has which patches at its back, where the thickness
    of a part is measured and so is lost from both sides; none where it is given.

    surface: pristine; patch: (m,) of each face, as from `area_patches`; given: labels of the parts whose thickness is
    given. Faces without a back are left out.
    """
    part, size = surface.cell_data["part"], areas(surface.points, surface.triangles)
    count, found = int(patch.max()) + 1, []
    for label in sorted(set(part[patch >= 0].tolist()) - set(given)):
        faces = np.flatnonzero(part == label)
        back = thickness_to_back(surface.points, surface.triangles[faces])[1]
        front, back = np.repeat(faces, 3)[back.ravel() >= 0], faces[back[back >= 0]]
        found.append((size[front], patch[front], patch[back]))
    if not found:
        return sparse.csr_array((count, count))
    weight, front, back = (np.concatenate(each) for each in zip(*found, strict=True))
    shares = sparse.csr_array(sparse.coo_array((weight, (front, back)), shape=(count, count)))
    whole = shares.sum(axis=1)
    return sparse.diags_array(np.divide(1.0, whole, out=np.zeros(count), where=whole > 0.0)) @ shares


def geometry_of(run: Parameters, folder: Path) -> Geometry:
    """Return the geometry of a run's pristine surface; folder: of the run."""
    path = folder / "surface.vtu"
    return _geometry(path, path.stat().st_mtime_ns, run["sampling"]["patch_m"], tuple(given_thickness(run).items()))


def given_thickness(run: Parameters) -> dict[int, float]:
    """Return {label of a part: thickness (m)} of the liners whose thickness is given."""
    parts = enumerate(run["parts"])
    return {label_of(k, part): part["thickness_m"] for k, part in parts if part["wears"] and "thickness_m" in part}


def rate_volume(run: Parameters, surface: SurfaceMesh, ledger: pd.DataFrame) -> np.ndarray:
    """Return the volume (m,) m3 that each part's law makes of a block's ledger, with the true coefficients."""
    volume, sums = np.zeros(len(surface.triangles)), sums_of(run)
    for number, part in enumerate(run["parts"]):
        if part["wears"]:
            faces, law, given = faces_of(surface, number, part), part["law"], law_values(part)
            columns = {name: ledger[name].to_numpy()[faces] for name in ledger}
            volume[faces] = worn_volume(law, columns_of_law(columns, sums, law, given), given)
    return volume


def patch_rows(run: Parameters, span: Span, folder: Path, surface: SurfaceMesh, ledger: pd.DataFrame) -> pd.DataFrame:
    """Return the table of a block by area patches; folder: of its run; surface: as it was in the block.

    back_recession_m_per_h: of what lies behind a patch, where its thickness is measured
    """
    geometry, duration = geometry_of(run, folder), duration_s(run, span)
    patch, count = patches_of(surface, geometry.surface, geometry.patch), len(geometry.table)
    size = areas(surface.points, surface.triangles)
    area = patch_sums(size, patch, count)
    names = {label_of(k, part): part["name"] for k, part in enumerate(run["parts"])}
    table = geometry.table.assign(part=geometry.table["part"].map(names))

    def per_area(values: np.ndarray) -> np.ndarray:
        return np.divide(patch_sums(values, patch, count), area * duration, out=np.zeros(count), where=area > 0.0)

    impulse, work = (
        patch_sums(ledger[name].to_numpy(), patch, count) for name in ("normal_impulse_N_s", "sliding_work_J")
    )
    removed = surface.point_data.get(REMOVED_THICKNESS, np.zeros(len(surface.points)))[surface.triangles].mean(axis=1)
    edge = edge_lengths_per_triangle(surface.points, surface.triangles).mean(axis=1)
    recession = SECONDS_PER_HOUR * per_area(rate_volume(run, surface, ledger))
    return table.assign(
        **_block(span, duration),
        area_m2=area,
        edge_m=patch_means(edge, size, patch, count),
        depth_m=patch_means(removed, size, patch, count),
        recession_m_per_h=recession,
        back_recession_m_per_h=geometry.behind @ recession,
        pressure_Pa=per_area(ledger["normal_impulse_N_s"].to_numpy()),
        sliding_velocity_m_per_s=np.divide(work, impulse, out=np.zeros(count), where=impulse > 0.0),
        sliding_power_W_per_m2=per_area(ledger["sliding_work_J"].to_numpy()),
        impact_power_W_per_m2=per_area(ledger["impact_energy_J"].to_numpy()),
    )


def _block(span: Span, duration: float) -> dict[str, Any]:
    return {
        "cycle": span.cycle,
        "phase": phase_of(span),
        "operation_h": span.operation_s / SECONDS_PER_HOUR,
        "stands_for_h": span.stands_for_s / SECONDS_PER_HOUR,
        "duration_s": duration,
    }


def duration_s(run: Parameters, span: Span) -> float:
    """Return the simulated time of a block (s)."""
    return span.steps * run["derived"]["time_step_s"]


def part_rows(run: Parameters, span: Span, surface: SurfaceMesh, ledger: pd.DataFrame) -> pd.DataFrame:
    """Return the table of a block by parts: mean force and torque, power, worn volume and mass, sliding and impacts."""
    duration, volume = duration_s(run, span), rate_volume(run, surface, ledger)
    corners, rows = stl_corners(surface.points, surface.triangles), []
    for number, part in enumerate(run["parts"]):
        faces = faces_of(surface, number, part)
        columns = {name: ledger[name].to_numpy()[faces] for name in ledger}
        point = axis_point(part["motion"])
        loads = part_loads(columns, corners[faces], np.zeros(faces.sum(), dtype=int), duration, point)
        worn = float(volume[faces].sum()) / duration * SECONDS_PER_HOUR
        rows.append(
            {
                **_block(span, duration),
                "part": part["name"],
                "role": "wears" if part["wears"] else "rigid",
                **{name: float(value[0]) for name, value in loads.items() if name != "part"},
                "worn_volume_m3_per_h": worn,
                "worn_mass_kg_per_h": worn * run["walls"][part["type"] - 2]["density_kg_per_m3"],
                "sliding_power_W": float(columns["sliding_work_J"].sum()) / duration,
                "impact_power_W": float(columns["impact_energy_J"].sum()) / duration,
            }
        )
    return pd.DataFrame(rows)


# ---------------------------------------------------------------- what decides the next block


def patch_tables(folder: Path, last: int, phases: tuple[str, ...] = ()) -> list[pd.DataFrame]:
    """Return the tables of patches of a run's blocks up to the number `last`, of some phases or of all."""
    found = [pd.read_csv(folder / f"cycle_{number:03d}" / PATCHES) for number in range(1, last + 1)]
    return [table for table in found if not phases or table["phase"].iloc[0] in phases]


def urgency(run: Parameters, table: pd.DataFrame) -> np.ndarray:
    """Return by how much each patch gets thinner over the depth that it may lose (1/h), by which places are ordered;
    over 1 m where that is not known, or nothing.
    """
    allowed, of_part = np.full(len(table), np.nan), table.groupby("part").indices
    for part in run["parts"]:
        rows = of_part.get(part["name"], [])
        allowed[rows] = allowed_depths(table["thickness_m"].to_numpy()[rows], rule_of(run["operation"], part))
    return thinning(table).to_numpy() / np.where(np.isfinite(allowed), allowed, 1.0)


def deciding_width(run: Parameters, tables: list[pd.DataFrame]) -> float:
    """Return the whole width, over the mean, of the interval of the deciding patch's recession; infinite where unknown.

    tables: of the blocks on the shape as built, in their order
    """
    if len(tables) < 3:
        return np.inf
    rates = np.array([urgency(run, table) for table in tables])
    series = rates[:, int(np.argmax(rates.mean(axis=0)))]
    mean, error = float(series.mean()), error_of_mean(series)
    if not (mean > 0.0 and np.isfinite(error)):
        return np.inf
    return 2.0 * students_t(0.5 + 0.5 * CONFIDENCE, len(series) - 1) * error / mean


def fastest_step_per_s(run: Parameters, tables: list[pd.DataFrame]) -> float:
    """Return the recession of the fastest patch over the step that an update may take there (1/s), of the latest
    blocks; 0 where nothing wears.
    """
    latest = tables[-LATEST:]
    if not latest:
        return 0.0
    mean = np.mean([table["recession_m_per_h"].to_numpy() for table in latest], axis=0) / SECONDS_PER_HOUR
    allowed = run["wear"]["largest_step_edge_fraction"] * latest[-1]["edge_m"].to_numpy()
    return float(np.nanmax(mean / allowed, initial=0.0))


def held_back_per_s(run: Parameters, span: Span, surface: SurfaceMesh, ledger: pd.DataFrame) -> float:
    """Return one over the longest operation (1/s) for which the wear of a block may stand: caps on the step of each
    node then hold back no more than MOST_HELD_BACK of it. 0 where nothing wears.

    surface: as it was in the block
    """
    faces, size = surface.triangles, areas(surface.points, surface.triangles)
    rate = rate_volume(run, surface, ledger) / duration_s(run, span)
    count = len(surface.points)
    volume, area = (np.bincount(faces.ravel(), np.repeat(each / 3.0, 3), count) for each in (rate, size))
    room = area * edge_limit(surface.points, faces, run["wear"]["largest_step_edge_fraction"])
    loaded = volume > 0.0
    if not loaded.any():
        return 0.0
    volume, room = volume[loaded], room[loaded]

    def held_back(hours_log: float) -> float:
        wanted = math.exp(hours_log) * volume
        return float(np.maximum(wanted - room, 0.0).sum() / wanted.sum()) - MOST_HELD_BACK

    first, last = np.log((room / volume).min()), np.log((room / volume).max()) - math.log1p(-MOST_HELD_BACK)
    return math.exp(-optimize.brentq(held_back, first, last + 1.0))
