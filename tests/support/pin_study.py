"""A small pin-on-disc study in files, with closed forms for everything that its figures show.

Every run's groove has the pin's shape and grows by the same depth each revolution; forces carry the load exactly.
"""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np
import pandas as pd

from meshes.disc import track_disc
from postproc.mesh import SurfaceMesh, write_surface
from workflows.cases.pin_on_disc.volume import law_volume

TRACK, PIN, LOAD = 22e-3, 3e-3, 5.0  # m, m, N
CYCLES_PER_REVOLUTION = 2
ROWS = (  # run, series, scheme, wear coefficient 1/Pa, element mm, revolutions, scale
    ("a", "coefficient", "conserving", 1.7e-11, 0.5, 3, 1.0),
    ("b", "coefficient", "per_triangle", 1.7e-11, 0.5, 3, 1.0),
    ("c", "coefficient", "conserving", 5e-11, 0.5, 3, 1.0),
    ("d", "coefficient", "per_triangle", 5e-11, 0.5, 3, 1.0),
    ("e", "mesh", "conserving", 5e-11, 0.7, 1, 1.0),
    ("f", "mesh", "per_triangle", 5e-11, 0.7, 1, 1.0),
    ("g", "size", "conserving", 1e-11, 0.7, 1, 8.0),
    ("h", "coefficient", "conserving", 27.2e-11, 0.5, 3, 1.0),
)
EXCESS = {"conserving": 1.0, "per_triangle": 6.0}  # -, volume removed over the law's
RISE = 1.02  # -, summed normal force over load
COLUMNS = ("run", "series", "scheme", "wear_coefficient_per_pa", "element_size_mm", "revolutions", "particle_scale")


@functools.cache
def ring(element_size: float) -> SurfaceMesh:
    """Flat ring; element_size in mm."""
    return track_disc(TRACK, 20e-3, 24e-3, 1e-3 * element_size, 0.8e-3)


def grooved(mesh: SurfaceMesh, depth: float) -> SurfaceMesh:
    """The ring with a groove of the pin's shape (m deep), a tenth deeper at +x than at -x."""
    x, y, _ = mesh.points.T
    deepest = depth * (1.0 + 0.05 * np.cos(np.arctan2(y, x)))
    bottom = deepest - PIN + np.sqrt(PIN**2 - (np.hypot(x, y) - TRACK) ** 2)
    return SurfaceMesh(np.column_stack([x, y, -np.maximum(bottom, 0.0)]), mesh.triangles)


def write_study(folder: Path) -> Path:
    """Write design.csv and the files of all runs into a folder; return it."""
    design = pd.DataFrame([dict(zip(COLUMNS, (*row[:6], row[6]), strict=True)) for row in ROWS])
    design.assign(load_n=LOAD, track_radius_mm=1e3 * TRACK, pin_radius_mm=1e3 * PIN).to_csv(
        folder / "design.csv", index=False
    )
    for run, _, scheme, coefficient, element, revolutions, _ in ROWS:
        _write_run(folder / run, scheme, coefficient, ring(element), revolutions)
    return folder


def _write_run(folder: Path, scheme: str, coefficient: float, flat: SurfaceMesh, revolutions: int) -> None:
    folder.mkdir()
    write_surface(folder / "surface.vtu", SurfaceMesh(flat.points, flat.triangles))
    cycle = np.arange(1, CYCLES_PER_REVOLUTION * revolutions + 1)
    number = cycle / CYCLES_PER_REVOLUTION
    law = RISE * law_volume(coefficient, LOAD, TRACK, number)
    for index, volume in zip(cycle, EXCESS[scheme] * law, strict=True):
        of_cycle = folder / f"cycle_{index:03d}"
        of_cycle.mkdir()
        area = volume / (2.0 * np.pi * TRACK)
        worn = grooved(flat, np.cbrt(12.0 * PIN * area) ** 2 / (8.0 * PIN))
        write_surface(of_cycle / "surface.vtu", worn)
        angle = 180.0 * (index - 1) + np.arange(1.0, 181.0)
        force = LOAD + np.where(np.arange(180) % 2, 0.5, -0.5)
        pd.DataFrame({"angle_deg": angle, "force_z_N": -force, "normal_force_N": RISE * force}).to_csv(
            of_cycle / "forces.csv", index=False
        )
    write_surface(folder / "worn_surface.vtu", worn)
    pd.DataFrame(
        {
            "cycle": cycle,
            "time_s": 2.0 * number,
            "revolution": number,
            "total_archard_volume_m3": law,
            "total_applied_volume_m3": EXCESS[scheme] * law,
            "carried_volume_m3": 0.0,
            "step_demand": 0.1,
            "centroid_path_volume_m3": EXCESS[scheme] * law / cycle,
            "touched_centroid_path_volume_m3": 0.5 * EXCESS[scheme] * law / cycle,
            "mean_normal_force_N": RISE * LOAD,
            "mean_vertical_force_N": LOAD,
            "contacts_per_step": 3.0,
        }
    ).to_csv(folder / "wear.csv", index=False)


def tables(folder: Path) -> tuple[pd.DataFrame, pd.DataFrame, pd.DataFrame]:
    """Runs, contours and volumes of a written study."""
    from workflows.cases.pin_on_disc.run_in import contours_of_run
    from workflows.cases.pin_on_disc.runs import of_runs, pin_runs
    from workflows.cases.pin_on_disc.volume import volumes_of_run

    runs = pin_runs(folder / "design.csv")
    for run in runs["run"]:
        contours_of_run(folder / run, TRACK).to_csv(folder / run / "contours.csv", index=False)
        volumes_of_run(folder / run).to_csv(folder / run / "volumes.csv", index=False)
    files = ([folder / run / f"{name}.csv" for run in runs["run"]] for name in ("contours", "volumes"))
    return runs, *(of_runs(runs, each) for each in files)
