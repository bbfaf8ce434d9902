"""A small pin-on-disc study in files, with closed forms for everything that its figures show.

Every run's groove has the pin's shape and grows by the same depth each revolution; forces carry the load exactly.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.meshes.disc import track_disc
from bulkwear.postproc.mesh import SurfaceMesh, write_surface
from bulkwear.workflows.cases.pin_on_disc.volume import law_volume
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.report.products import Job, Product, job_of, outputs_of, paths_of, products_of_study
from tests import REPOSITORY

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
REMARKS = ["pin softened", "coarse mesh"]  # of all its figures
UPDATES = "wear updates of 30 degrees"  # what the figure of the excess is told of them
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
            "total_worn_volume_m3": law,
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
    from bulkwear.workflows.cases.pin_on_disc.run_in import contours_of_run
    from bulkwear.workflows.cases.pin_on_disc.runs import of_runs, pin_runs
    from bulkwear.workflows.cases.pin_on_disc.volume import volumes_of_run

    runs = pin_runs(folder / "design.csv")
    for run in runs["run"]:
        contours_of_run(folder / run, TRACK).to_csv(folder / run / "contours.csv", index=False)
        volumes_of_run(folder / run).to_csv(folder / run / "volumes.csv", index=False)
    files = ([folder / run / f"{name}.csv" for run in runs["run"]] for name in ("contours", "volumes"))
    return runs, *(of_runs(runs, each) for each in files)


def without(folder: Path, runs: Sequence[str], target: Path) -> Path:
    """Write a study of the runs of a written one but some into a folder; return it."""
    design = pd.read_csv(folder / "design.csv")
    kept = design[~design["run"].isin(runs)]
    target.mkdir(exist_ok=True)
    kept.to_csv(target / "design.csv", index=False)
    for run in kept["run"]:
        (target / run).symlink_to(folder / run)
    return target


def drawn(folder: Path) -> dict[str, Any]:
    """All figures of a written study by name; what its jobs write besides lies in its folder."""
    design = pd.read_csv(folder / "design.csv")
    study = SimpleNamespace(
        name=folder.name,
        case=find_case("pin_on_disc"),
        design_rows=design.to_dict("records"),
        runs=[SimpleNamespace(name=run) for run in design["run"]],
    )
    (folder / "figures").mkdir(exist_ok=True)
    shared, figures = study.case.shared_figures, {}  # they are made of ledgers, which these runs have none of
    waiting = [product for name, product in products_of_study(study).items() if name not in shared]
    while waiting:
        product = next(each for each in waiting if all(map(Path.exists, _inputs(each, study, folder))))
        waiting.remove(product)
        figures[product.name], table, *further = product.make(_job(product, study, folder))
        for key, found in ({"table": table} | (further[0] if further else {})).items():
            found.to_csv(_below(folder, outputs_of(product, study.name)[key]), index=False)
    return figures


def _job(product: Product, study: SimpleNamespace, folder: Path) -> Job:
    files = {}
    for name, source in product.inputs.items():
        paths = paths_of(source, study)
        files[name] = [_below(folder, path) for path in paths] if isinstance(paths, list) else _below(folder, paths)
    return job_of(files, dict.fromkeys(product.told, UPDATES), REMARKS)


def _inputs(product: Product, study: SimpleNamespace, folder: Path) -> list[Path]:
    found = vars(_job(product, study, folder).files).values()
    return [path for paths in found for path in (paths if isinstance(paths, list) else [paths])]


def _below(folder: Path, path: str) -> Path:
    """Where a file of a study lies that is written in a folder; others lie in the repository."""
    start = f"results/{folder.name}/"
    return folder / path.removeprefix(start) if path.startswith(start) else REPOSITORY / path
