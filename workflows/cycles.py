"""The driver of a run: solver restart -> load ledger -> wear -> displaced mesh, cycle by cycle, resumable.

Every step is a plain function of the files of a cycle's folder; `run_chain` strings them together.
"""

from __future__ import annotations

import csv
import os
import shutil
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from postproc.mesh import SurfaceMesh, areas, read_surface, write_stl, write_surface
from postproc.readers.contacts import read_contact_batches
from postproc.readers.mesh_loads import read_mesh_loads
from postproc.readers.solver_log import thermo_table, warnings
from postproc.wear.caps import step_limit
from postproc.wear.laws import worn_volume
from postproc.wear.ledger import LedgerBuilder
from postproc.wear.update import recession_fault, volume_balance, wear_update, worn_faces
from workflows import deck, state
from workflows.progress import Progress
from workflows.solver import DECK, LOG, SCREEN, run_deck

SURFACE, SURFACE_STL, END_WALL = "surface.vtu", "surface.stl", "end_wall.stl"
RESTART, LEDGER, FORCES, TOUCHING = "run.restart", "ledger.parquet", "forces.csv", "touching.npy"
CONTACTS, SPINS = "contacts.dump", "spins.dump"
WORN_SURFACE = "worn_surface.vtu"
SUMMED = ("sliding_work_J", "normal_impulse_N_s", "rolling_work_J", "impact_energy_J", "finnie_wear")
SAMPLE_MESH = 0  # index of the sample among the meshes of the wall fix


class WearError(RuntimeError):
    """The worn surface cannot go back into the solver; the message names run and cycle."""


@dataclass(frozen=True)
class Chain:
    """A run as the driver sees it. `parameters` and `bed` as in design.py (SI); the rest are paths."""

    name: str
    folder: Path
    parameters: Mapping[str, Any]
    bed: Mapping[str, Any]
    surface: Path
    bed_restart: Path

    @property
    def cycles(self) -> int:
        """Number of wear cycles."""
        return self.parameters["sliding"]["cycles"]

    @property
    def worn_folder(self) -> Path:
        """Folder of the last wear cycle."""
        return state.cycle_folder(self.folder, self.cycles)


# ---------------------------------------------------------------- the chain


def run_chain(chain: Chain) -> None:
    """Run what is missing of a run, then write its wear.csv and cost.csv. Resumes after the last finished cycle.

    Raises SolverError, StateError, WearError or a reader's error; finished cycles stay and are not done again.
    """
    with state.only_driver(chain.folder):
        inputs = inputs_digest(chain)
        moved = state.set_aside_others(chain.folder, inputs)
        finished = state.finished_cycles(chain.folder, inputs)
        progress = Progress(chain.name, total_steps(chain), sum(cycle_steps(chain, k) for k in range(finished)))
        if moved:
            progress.say(moved)
        if 0 < finished <= chain.cycles:
            progress.say(f"resumes after {cycle_title(chain, finished - 1)}")
        for cycle in range(finished, chain.cycles + 1):
            run_cycle(chain, cycle, inputs, progress)
        write_products(chain)


def inputs_digest(chain: Chain) -> str:
    """Return the hash of all that a run's results depend on: parameters, bed, templates and surface."""
    templates = {**deck.template_sources("lowered_bed"), **deck.template_sources("sliding_sample")}
    return state.digest(
        chain.parameters, chain.bed, templates, state.file_digest(chain.surface), state.file_digest(chain.bed_restart)
    )


def run_cycle(chain: Chain, cycle: int, inputs: str, progress: Progress) -> None:
    """Simulate, account, wear and displace one cycle; cycle 0 lowers the bed on to the sample and runs it in."""
    started = time.monotonic()
    with state.working_folder(chain.folder, cycle) as folder:
        surface = read_surface(surface_before(chain, cycle))
        write_end_wall(chain)
        write_cycle(chain, cycle, folder, surface)
        solver_seconds = simulate(chain, cycle, folder, len(surface.triangles), progress)
        record = {"cost": {}} if cycle == 0 else account_and_wear(chain, cycle, folder, surface)
        record["cost"] = cost(chain, cycle, folder, solver_seconds, time.monotonic() - started) | record["cost"]
        record["solver_warnings"] = warnings(folder / SCREEN)
        if inputs_digest(chain) != inputs:
            raise state.StateError(f"{chain.name}: its inputs changed while {cycle_title(chain, cycle)} ran; start again.")
        files = (RESTART,) if cycle == 0 else (RESTART, SURFACE, LEDGER, TOUCHING)
        state.write_state(folder, inputs, files, record)


def surface_before(chain: Chain, cycle: int) -> Path:
    """Return the surface that a cycle starts from."""
    return chain.surface if cycle <= 1 else state.cycle_folder(chain.folder, cycle - 1) / SURFACE


def cycle_steps(chain: Chain, cycle: int) -> int:
    """Return the time steps of a cycle."""
    derived = chain.parameters["derived"]
    if cycle:
        return derived["cycle_steps"]
    lowering = deck.lowered_bed(chain.parameters, chain.bed, "")["lowering_steps"]
    return lowering + derived["run_in_steps"]


def total_steps(chain: Chain) -> int:
    """Return the time steps of a whole run."""
    return sum(cycle_steps(chain, cycle) for cycle in range(chain.cycles + 1))


def cycle_title(chain: Chain, cycle: int) -> str:
    """Return what people call a cycle."""
    return f"cycle {cycle} of {chain.cycles}" if cycle else "lowering and run-in"


# ---------------------------------------------------------------- decks and solver


def write_cycle(chain: Chain, cycle: int, folder: Path, surface: SurfaceMesh) -> None:
    """Write the deck and the surface of a cycle into its folder, where they run by hand."""
    if cycle:
        restart = f"../{state.cycle_folder(chain.folder, cycle - 1).name}/{RESTART}"
        text = deck.render("sliding_sample", deck.sliding_sample(chain.parameters, chain.bed, cycle, restart))
    else:
        restart = os.path.relpath(chain.bed_restart, folder)
        text = deck.render("lowered_bed", deck.lowered_bed(chain.parameters, chain.bed, restart))
    (folder / DECK).write_text(text)
    write_stl(folder / SURFACE_STL, surface.points, surface.triangles)


def write_end_wall(chain: Chain) -> None:
    """Write the wall that closes the bed at both ends, two triangles across the domain at y = 0."""
    half_width, bottom, top = deck.end_wall_corners(chain.bed)
    corners = [(-half_width, bottom), (half_width, bottom), (half_width, top), (-half_width, top)]
    points = np.array([(x, 0.0, z) for x, z in corners])
    write_stl(chain.folder / END_WALL, points, np.array([[0, 1, 2], [0, 2, 3]]))


def simulate(chain: Chain, cycle: int, folder: Path, triangles: int, progress: Progress) -> float:
    """Run the solver on a cycle's deck and return its wall time in s. Raises SolverError."""
    before = sum(cycle_steps(chain, earlier) for earlier in range(cycle))
    return run_deck(
        folder,
        chain.parameters["solver"]["ranks"],
        lambda step: progress.update(before + step, cycle_title(chain, cycle)),
        triangles={f"sample_{cycle}": triangles},
    )


# ---------------------------------------------------------------- ledger and wear


def account_and_wear(chain: Chain, cycle: int, folder: Path, surface: SurfaceMesh) -> dict[str, Any]:
    """Turn a cycle's dumps into its ledger and worn surface; return its record. The dumps are removed."""
    dump_bytes = sum((folder / name).stat().st_size for name in (CONTACTS, SPINS))
    ledger = account(chain, cycle, folder, len(surface.triangles))
    write_forces(chain, cycle, folder)
    row = wear(chain, cycle, folder, surface, ledger)
    for name in (CONTACTS, SPINS):
        (folder / name).unlink()
    return {"wear": row, "cost": {"dump_bytes": dump_bytes}}


def account(chain: Chain, cycle: int, folder: Path, triangles: int) -> pd.DataFrame:
    """Sum the sampled contacts of a cycle into its ledger, the solver's own measures beside it; written and returned."""
    parameters = chain.parameters
    interval = parameters["solver"]["sampling_interval_steps"] * parameters["derived"]["time_step_s"]
    builder = LedgerBuilder(
        triangles,
        SAMPLE_MESH,
        effective_modulus(parameters),
        parameters["particle"]["density_kg_per_m3"],
        touching=_touching_before(chain, cycle),
    )
    for batch in read_contact_batches(folder / CONTACTS, folder / SPINS, after_step=0):
        builder.add_batch(batch, interval)
    own = read_mesh_loads(folder / f"loads_{parameters['derived']['cycle_steps']}.vtk", triangles)
    ledger = pd.DataFrame({"triangle": own.pop("triangle"), **builder.table(), **own})
    ledger.to_parquet(folder / LEDGER, index=False)
    touching = builder.touching
    np.save(folder / TOUCHING, np.zeros(0, np.int64) if touching is None else touching)
    return ledger


def _touching_before(chain: Chain, cycle: int) -> np.ndarray | None:
    path = state.cycle_folder(chain.folder, cycle - 1) / TOUCHING
    return np.load(path) if path.exists() else None


def effective_modulus(parameters: Mapping[str, Any]) -> float:
    """Return E* (Pa) of particle and sample as simulated: 1/E* = sum of (1 - nu^2)/E (Hertz 1882)."""
    moduli = parameters["derived"]["youngs_modulus_pa"]
    pairs = ((name, parameters[name]["poissons_ratio"]) for name in ("particle", "sample_material"))
    return 1.0 / sum((1.0 - ratio**2) / moduli[name] for name, ratio in pairs)


def write_forces(chain: Chain, cycle: int, folder: Path) -> None:
    """Write the bed's force on the sample over a cycle; the set-up row of a run holds no force and is left out."""
    thermo = thermo_table(folder / LOG)
    derived = chain.parameters["derived"]
    step = thermo["Step"][1:] + (cycle - 1) * derived["cycle_steps"]
    time_s = step * derived["time_step_s"]
    table = {"time_s": time_s, "travel_m": time_s * chain.parameters["sliding"]["velocity_m_per_s"]}
    table |= {f"force_{axis}_N": thermo[f"force_{axis}"][1:] for axis in "xyz"}
    pd.DataFrame(table).to_csv(folder / FORCES, index=False)


def wear(
    chain: Chain, cycle: int, folder: Path, surface: SurfaceMesh, ledger: pd.DataFrame
) -> dict[str, float | int | bool]:
    """Wear the surface by a cycle's ledger, write it, and return the cycle's row of wear.csv. Raises WearError."""
    parameters = chain.parameters
    volume = law_volume(parameters, ledger)
    limit = node_limits(parameters, surface)
    worn, update = wear_update(surface, read_surface(chain.surface), volume, limit)
    if fault := recession_fault(worn):
        raise WearError(f"{chain.name}, cycle {cycle}: {fault}; wear is accelerated too much, or the travel too long.")
    write_surface(folder / SURFACE, worn)
    return wear_row(chain, cycle, surface, ledger, volume, update, float(limit.max()))


def law_volume(parameters: Mapping[str, Any], ledger: pd.DataFrame) -> np.ndarray:
    """Return the volume (m3) per triangle that the study's wear law makes of a ledger, acceleration included."""
    return worn_volume(
        parameters["wear"]["law"],
        {name: ledger[name].to_numpy() for name in ledger},
        {"wear_coefficient_per_pa": parameters["wear"]["accelerated_wear_coefficient_per_pa"]},
    )


def node_limits(parameters: Mapping[str, Any], surface: SurfaceMesh) -> np.ndarray:
    """Return how far (m) each node may move in one cycle; nowhere when the study keeps the sample rigid."""
    wear_parameters = parameters["wear"]
    if not wear_parameters["deform"]:
        return np.zeros(len(surface.points))
    return step_limit(
        surface.points,
        surface.triangles,
        wear_parameters["largest_step_edge_fraction"],
        wear_parameters["gap_closing_fraction"],
        parameters["derived"]["cycle_duration_s"],
    )


def wear_row(
    chain: Chain,
    cycle: int,
    surface: SurfaceMesh,
    ledger: pd.DataFrame,
    volume: np.ndarray,
    update: Mapping[str, float],
    largest_limit: float,
) -> dict[str, float | int | bool]:
    """Return a cycle's row of wear.csv; the balance of volumes over all cycles is checked here."""
    part = surface.cell_data["part"]
    worn = worn_faces(surface)
    before = state.read_state(chain.folder, cycle - 1)["wear"] if cycle > 1 else {}
    derived = chain.parameters["derived"]
    time_s = cycle * derived["cycle_duration_s"]
    total = before.get("total_archard_volume_m3", 0.0) + update["worn_volume_m3"]
    applied = before.get("total_applied_volume_m3", 0.0) + update["applied_volume_m3"]
    faces = volume * worn
    return {
        "cycle": cycle,
        "time_s": time_s,
        "travel_m": time_s * chain.parameters["sliding"]["velocity_m_per_s"],
        "sliding_work_J": float(ledger["sliding_work_J"].to_numpy()[worn].sum()),
        "archard_volume_m3": update["worn_volume_m3"],
        "applied_volume_m3": update["applied_volume_m3"],
        "carried_volume_m3": update["carried_volume_m3"],
        "total_archard_volume_m3": total,
        "total_applied_volume_m3": applied,
        "base_archard_volume_m3": float(faces[part == 0].sum()),
        "bump_archard_volume_m3": float(faces[part > 0].sum()),
        "finnie_volume_m3": float((ledger["finnie_wear"].to_numpy() * areas(surface.points, surface.triangles))[worn].sum()),
        "mean_normal_force_N": float(ledger["normal_impulse_N_s"].to_numpy()[worn].sum()) / derived["cycle_duration_s"],
        "largest_step_m": update["largest_step_m"],
        "step_limit_m": largest_limit,
        "largest_depth_m": update["largest_depth_m"],
        "smallest_angle_deg": update["smallest_angle_deg"],
        "remeshed": False,
        "balance_error": volume_balance(applied, update["carried_volume_m3"], total),
    }


# ---------------------------------------------------------------- tables


def cost(chain: Chain, cycle: int, folder: Path, solver_seconds: float, all_seconds: float) -> dict[str, float]:
    """Return what a cycle cost: wall times in s and the sizes that they depend on."""
    thermo = thermo_table(folder / LOG)
    return {
        "cycle": cycle,
        "solver_s": round(solver_seconds, 3),
        "other_s": round(all_seconds - solver_seconds, 3),
        "steps": cycle_steps(chain, cycle),
        "particles": int(thermo["Atoms"][-1]),
        "triangles": int(read_surface(chain.surface).triangles.shape[0]),
        "ranks": chain.parameters["solver"]["ranks"],
        "dump_bytes": 0,
    }


def write_products(chain: Chain) -> None:
    """Write wear.csv, cost.csv and worn_surface.vtu of a finished run from what its cycles left."""
    states = [state.read_state(chain.folder, cycle) for cycle in range(chain.cycles + 1)]
    write_table(chain.folder / "wear.csv", [found["wear"] for found in states[1:]])
    write_table(chain.folder / "cost.csv", [found["cost"] for found in states])
    write_surface(chain.folder / WORN_SURFACE, worn_surface(chain))


def worn_surface(chain: Chain) -> SurfaceMesh:
    """Return the surface after the last cycle, with sums over all cycles per triangle: the work done on it, the volume
    that the wear law takes for it, the solver's own Finnie wear; and its mean normal traction."""
    surface = read_surface(chain.worn_folder / SURFACE)
    ledgers = [
        pd.read_parquet(state.cycle_folder(chain.folder, cycle) / LEDGER) for cycle in range(1, chain.cycles + 1)
    ]
    sums = {name: sum(ledger[name].to_numpy() for ledger in ledgers) for name in SUMMED}
    sums["worn_volume_m3"] = sum(law_volume(chain.parameters, ledger) for ledger in ledgers)
    duration = chain.cycles * chain.parameters["derived"]["cycle_duration_s"]
    pristine = read_surface(chain.surface)
    sums["normal_traction_Pa"] = sums["normal_impulse_N_s"] / duration / areas(pristine.points, pristine.triangles)
    return replace(surface, cell_data={**surface.cell_data, **sums})


def write_table(path: Path, rows: list[Mapping[str, Any]]) -> None:
    """Write rows with the same keys as CSV, whole or not at all."""
    part = path.with_suffix(".csv.part")
    with open(part, "w", newline="") as stream:
        table = csv.DictWriter(stream, fieldnames=list(rows[0]))
        table.writeheader()
        table.writerows(rows)
    os.replace(part, path)


# ---------------------------------------------------------------- beds and decks by hand


def fill_bed(name: str, bed: Mapping[str, Any], folder: Path) -> None:
    """Fill and settle a bed; leaves bed.restart and cost.csv in the folder. Raises SolverError."""
    write_bed(bed, folder)
    parameters = deck.settled_bed(bed)
    total = parameters["settling_steps"] + parameters["relaxing_steps"]
    progress = Progress(name, total)
    seconds = run_deck(folder, bed["ranks"], lambda step: progress.update(step, "filling and settling"))
    particles = int(thermo_table(folder / LOG)["Atoms"][-1])
    write_table(folder / "cost.csv", [{"solver_s": round(seconds, 3), "steps": total, "particles": particles}])


def write_bed(bed: Mapping[str, Any], folder: Path) -> None:
    """Write the deck of a bed into its folder, where it runs by hand."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / DECK).write_text(deck.render("settled_bed", deck.settled_bed(bed)))


def write_decks(chain: Chain) -> None:
    """Write every deck of a run with what it reads, without running the solver; they run by hand in their order."""
    surface = read_surface(chain.surface)
    chain.folder.mkdir(parents=True, exist_ok=True)
    write_end_wall(chain)
    for cycle in range(chain.cycles + 1):
        folder = state.cycle_folder(chain.folder, cycle)
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        write_cycle(chain, cycle, folder, surface)
