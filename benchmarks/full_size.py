"""Ten million particles and a million triangles: time, memory and disk of the solver and of each step of Python.

The solver's bed is a cubic lattice of spheres that touch, on a floor of triangles with a load ledger; it makes few time
steps and writes what a wear cycle writes: snapshot, restart file, ledger. Python's steps read those, or a wavy sheet
of as many triangles. Every step is a process of its own on one core, loops compiled before; its memory is the most that
the process held, with its inputs. Of the solver, time is that of a time step without output, memory of the program.
"""

from __future__ import annotations

import re
import resource
import time
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks.displacement import DOWN, bumpy_sheet
from benchmarks.measure import Measure, measured
from benchmarks.remesh import JITTER, SPACING, distorted_sheet
from bulkwear.postproc.flow.bed import read_snapshot
from bulkwear.postproc.flow.moving_bins import BinSums, MovingBins, add_dumps
from bulkwear.postproc.mesh import SurfaceMesh, read_surface, write_stl, write_surface
from bulkwear.postproc.readers.load_ledger import read_load_ledger
from bulkwear.postproc.readers.restart_file import read_restart
from bulkwear.postproc.wear.balance import lost_volume
from bulkwear.postproc.wear.caps import step_limit
from bulkwear.postproc.wear.mesh_faults import mesh_faults, with_target_edges
from bulkwear.postproc.wear.remesh import remesh
from bulkwear.postproc.wear.update import wear_update, with_depths
from bulkwear.workflows.engine.derived import rayleigh_time, youngs_modulus
from bulkwear.workflows.engine.solver import LEDGER_EXECUTABLE, run_deck

SIDE, QUICK_SIDE = 216, 12  # particles along an edge of the lattice
CELLS, QUICK_CELLS = 708, 24  # per side of the sheet, two triangles each
DIAMETER, SQUEEZED = 2.65e-3, 1e-4  # m; -, share of it by which neighbours overlap
DENSITY, SHEAR_MODULUS, POISSONS_RATIO = 2460.0, 7.0e7, 0.24  # kg/m3, Pa, -
STEPS = 10
WORN = 3e-4  # -, of the spacing cubed: volume that a triangle loses at most
LIMITS = 0.1, 0.01, 1.0  # of a step, see `postproc.wear.caps.step_limit`
SNAPSHOT, RESTART, LEDGER, STL = f"bed_{STEPS}.dump", "end.restart", "load_ledger.bin", "surface.stl"
SURFACE, WORN_SURFACE = "surface.vtu", "worn.vtu"
LOG_TIMES = r"Loop time of (\S+)", r"Outpt time \(%\) = (\S+)"
GIGABYTE, KIBIBYTE = 1e9, 1024.0
BINS = MovingBins(width=0.2, length=0.1, side_width=0.05, layer_height=0.01, layers=30)


@dataclass(frozen=True)
class Size:
    """Particles along an edge of the lattice, cells along an edge of the sheet."""

    side: int
    cells: int

    @property
    def spacing(self) -> float:
        """Between the lattice's particles, m."""
        return DIAMETER * (1.0 - SQUEEZED)


def deck(size: Size) -> str:
    """Return the deck of the lattice on the floor `STL`."""
    edge, gap = size.side * size.spacing, DIAMETER
    within = edge - 0.5 * size.spacing  # the next particle would be one too many
    model, pair = "hertz tangential history", "peratomtypepair 1"
    step = 0.2 * rayleigh_time(DIAMETER / 2.0, DENSITY, SHEAR_MODULUS, POISSONS_RATIO)
    lines = [
        "units si",
        "atom_style granular",
        "boundary f f f",
        "newton off",
        "communicate single vel yes",
        f"region box block {-gap} {edge + gap} {-gap} {edge + gap} {-gap} {edge + gap} units box",
        "create_box 1 box",
        f"neighbor {0.1 * DIAMETER} bin",
        "neigh_modify delay 0",
        f"fix modulus all property/global youngsModulus peratomtype {youngs_modulus(SHEAR_MODULUS, POISSONS_RATIO)}",
        f"fix ratio all property/global poissonsRatio peratomtype {POISSONS_RATIO}",
        f"fix restitution all property/global coefficientRestitution {pair} 0.45",
        f"fix friction all property/global coefficientFriction {pair} 0.21",
        f"fix wear all property/global k_finnie {pair} 1e-12",
        f"pair_style gran model {model}",
        "pair_coeff * *",
        f"timestep {step:.9g}",
        f"lattice sc {size.spacing}",
        f"region bed block 0 {within} 0 {within} 0 {within} units box",
        "create_atoms 1 region bed",
        f"set group all diameter {DIAMETER} density {DENSITY}",
        f"fix floor all mesh/surface/stress file {STL} type 1 wear finnie",
        f"fix floor_wall all wall/gran model {model} mesh n_meshes 1 meshes floor",
        "fix gravity all gravity 9.81 vector 0. 0. -1.",
        "fix motion all nve/sphere",
        f"fix load_ledger all load/ledger mesh floor file {LEDGER}",
        f"dump bed all custom {STEPS} bed_*.dump id x y z vx vy vz omegax omegay omegaz radius",
        f"thermo {STEPS}",
        f"run {STEPS}",
        f"write_restart {RESTART}",
    ]
    return "\n".join(lines) + "\n"


def floor(size: Size) -> SurfaceMesh:
    """Return a flat sheet under the lattice, whose lowest particles overlap with it as with one another."""
    edge = size.side * size.spacing
    mesh = distorted_sheet(size.cells, 0.0, 0.0)
    points = mesh.points * [*(edge / np.ptp(mesh.points, axis=0)[:2]), 0.0]
    return SurfaceMesh(points - [0.5 * DIAMETER, 0.5 * DIAMETER, 0.5 * size.spacing], mesh.triangles)


def simulated(folder: Path, size: Size) -> float:
    """Simulate the lattice; return how long (s) a time step takes by the program's own clock, output left out."""
    mesh = floor(size)
    write_stl(folder / STL, mesh.points, mesh.triangles)
    (folder / "deck.in").write_text(deck(size))
    run_deck(folder, executable=LEDGER_EXECUTABLE)
    log = (folder / "log.liggghts").read_text()
    loop, output = (float(re.search(label, log)[1]) for label in LOG_TIMES)
    return (loop - output) / STEPS


def binned(folder: Path) -> None:
    """Reduce the snapshot to bins, as a wear cycle does when it ends."""
    sums = BinSums(BINS, 1e-6, 0.01)
    add_dumps([(folder / SNAPSHOT, 0.0)], [sums])
    sums.table()


def ledger_kept(folder: Path) -> None:
    """Read the solver's ledger and write it as the table of a cycle."""
    pd.DataFrame(read_load_ledger(folder / LEDGER).columns).to_parquet(folder / "ledger.parquet", index=False)


def worn(mesh: SurfaceMesh) -> SurfaceMesh:
    """Return a sheet after one wear update."""
    volume = np.random.default_rng(1).random(len(mesh.triangles)) * WORN * SPACING**3
    return wear_update(mesh, volume, step_limit(mesh.points, mesh.triangles, *LIMITS), DOWN)[0]


PARTICLE_STEPS: dict[str, Callable[[Path], object]] = {
    "snapshot to bins": binned,
    "snapshot to a table, for figures": lambda folder: read_snapshot(folder / SNAPSHOT),
    "restart file proved whole": lambda folder: read_restart(folder / RESTART),
    "ledger read and kept": ledger_kept,
}
SHEET_STEPS: dict[str, Callable[[Path], object]] = {
    "surface read and written": lambda folder: write_surface(folder / "again.vtu", read_surface(folder / SURFACE)),
    "surface as ASCII STL": lambda folder: write_stl(
        folder / "again.stl", *(lambda mesh: (mesh.points, mesh.triangles))(read_surface(folder / SURFACE))
    ),
    "wear update": lambda folder: worn(read_surface(folder / SURFACE)),
    "depths": lambda folder: with_depths(read_surface(folder / WORN_SURFACE), read_surface(folder / SURFACE)),
    "lost volume": lambda folder: lost_volume(read_surface(folder / SURFACE), read_surface(folder / WORN_SURFACE)),
    "faults found": lambda folder: mesh_faults(read_surface(folder / WORN_SURFACE)),
    "a tenth remeshed": lambda folder: remesh(read_surface(folder / "distorted.vtu")),
}
STEPS_OF_PYTHON = PARTICLE_STEPS | SHEET_STEPS


def with_sheets(folder: Path, cells: int) -> None:
    """Write a bumpy sheet, the same worn, and a sheet whose tenth is distorted."""
    points, triangles = bumpy_sheet(cells, SPACING)
    parts = {"part": np.zeros(len(triangles), dtype=np.int64)}
    mesh = with_target_edges(SurfaceMesh(points, triangles, parts), SPACING)
    write_surface(folder / SURFACE, mesh)
    write_surface(folder / WORN_SURFACE, worn(mesh))
    write_surface(folder / "distorted.vtu", distorted_sheet(cells, JITTER, 0.1))


def in_a_process(task: Callable[..., object], *given: object) -> object:
    """Return what a task gives in a process of its own, which ends with it."""
    with get_context("spawn").Pool(1) as pool:
        return pool.apply(task, given)


def solver_cost(folder: Path, size: Size) -> tuple[float, float]:
    """Return the time of a time step (s) and the most memory of the solver (GB); of a process of its own."""
    step = simulated(folder, size)
    return step, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * KIBIBYTE / GIGABYTE


def step_cost(name: str, folder: Path, compiled_with: Path) -> tuple[float, float]:
    """Return processor time (s) and most memory (GB) of a step of Python; of a process of its own."""
    STEPS_OF_PYTHON[name](compiled_with)
    before = time.process_time()
    STEPS_OF_PYTHON[name](folder)
    spent = time.process_time() - before
    return spent, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * KIBIBYTE / GIGABYTE


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return time and memory of each step, and what files take on the disk."""
    small, size = Size(QUICK_SIDE, QUICK_CELLS), Size(SIDE, CELLS)
    small_folder, whole = folder / "full_size" / "small", folder / "full_size" / "whole"
    for place, of in [(small_folder, small)] + ([] if quick else [(whole, size)]):
        place.mkdir(parents=True, exist_ok=True)
        cost = in_a_process(solver_cost, place, of)
        in_a_process(with_sheets, place, of.cells)
    place, of = (small_folder, small) if quick else (whole, size)
    told = lines_of(f"solver, {of.side**3:,} particles on {2 * of.cells**2:,} triangles", cost)
    for name in STEPS_OF_PYTHON:
        told += lines_of(name, in_a_process(step_cost, name, place, small_folder))
    files = {"snapshot": SNAPSHOT, "restart file": RESTART, "ledger": LEDGER, "floor, ASCII STL": STL}
    return told + [
        measured(f"{name}, on the disk", "GB", [(place / f).stat().st_size / GIGABYTE]) for name, f in files.items()
    ]


def lines_of(name: str, cost: tuple[float, float]) -> list[Measure]:
    """Return the measures of a step: processor time (s) and memory (GB)."""
    return [measured(name, "s", [cost[0]]), measured(f"{name}, most memory", "GB", [cost[1]])]
