"""What a simulated cycle did to the surface: its loads become a ledger, the ledger wear, the wear a new surface."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from postproc.mesh import SurfaceMesh, areas, read_surface, write_surface
from postproc.readers.mesh_loads import read_mesh_loads
from postproc.readers.solver_log import thermo_table
from postproc.wear.caps import step_limit
from postproc.wear.laws import worn_volume
from postproc.wear.update import lost_volume, recession_fault, volume_balance, wear_update, worn_faces
from workflows import state
from workflows.chain import SURFACE, Chain
from workflows.ledgers import producer
from workflows.solver import LOG

LEDGER, FORCES = "ledger.parquet", "forces.csv"
SETUP_LOADS, SETUP_BED = "loads_0.vtk", "bed_0.dump"  # of the cycle's first instant: the last one of the cycle before
SUMMED = ("sliding_work_J", "normal_impulse_N_s", "rolling_work_J", "impact_energy_J", "finnie_wear")


class WearError(RuntimeError):
    """The worn surface cannot go back into the solver; the message names run and cycle."""


def account_and_wear(chain: Chain, cycle: int, folder: Path, surface: SurfaceMesh) -> dict[str, Any]:
    """Turn what the solver wrote in a cycle into its ledger and worn surface; return its record.

    What only the ledger was made from is removed.
    """
    source = producer(chain.parameters)
    ledger_bytes = source.written_bytes(folder)
    ledger = account(chain, cycle, folder, surface)
    write_forces(chain, cycle, folder)
    row = wear(chain, cycle, folder, surface, ledger)
    for name in (*source.files, SETUP_LOADS, SETUP_BED):
        (folder / name).unlink()
    return {"wear": row, "cost": {"ledger_bytes": ledger_bytes}}


def account(chain: Chain, cycle: int, folder: Path, surface: SurfaceMesh) -> pd.DataFrame:
    """Write a cycle's ledger, the solver's own measures beside it, and return it. Raises the producer's errors."""
    columns = producer(chain.parameters).columns(chain, cycle, folder, surface)
    steps = chain.parameters["derived"]["cycle_steps"]
    own = read_mesh_loads(folder / f"loads_{steps}.vtk", len(surface.triangles))
    ledger = pd.DataFrame({"triangle": own.pop("triangle"), **columns, **own})
    ledger.to_parquet(folder / LEDGER, index=False)
    return ledger


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
    """Wear the surface by a cycle's ledger, write it, and return the cycle's row of wear.csv.

    The balance closes on the geometry: pristine minus present volume, plus carried, is the law's volume of all cycles.
    Raises WearError, BalanceError.
    """
    parameters = chain.parameters
    volume = law_volume(parameters, ledger)
    limit = node_limits(parameters, surface)
    worn, update = wear_update(surface, read_surface(chain.surface), volume, limit)
    if fault := recession_fault(worn):
        raise WearError(f"{chain.name}, cycle {cycle}: {fault}; wear is accelerated too much, or the travel too long.")
    write_surface(folder / SURFACE, worn)
    row = wear_row(chain, cycle, surface, ledger, volume, update)
    lost, rounding = lost_volume(read_surface(chain.surface), worn)
    total, carried = row["total_archard_volume_m3"], row["carried_volume_m3"]
    return {
        **row,
        "step_limit_m": float(limit.max()),
        "remeshed": False,
        "balance_error": volume_balance(lost, carried, total, rounding),
    }


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
) -> dict[str, float | int]:
    """Return a cycle's row of wear.csv: loads, volumes of this cycle and of all so far, and the state of the mesh."""
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
        "finnie_volume_m3": float(
            (ledger["finnie_wear"].to_numpy() * areas(surface.points, surface.triangles))[worn].sum()
        ),
        "mean_normal_force_N": float(ledger["normal_impulse_N_s"].to_numpy()[worn].sum()) / derived["cycle_duration_s"],
        "largest_step_m": update["largest_step_m"],
        "largest_depth_m": update["largest_depth_m"],
        "smallest_angle_deg": update["smallest_angle_deg"],
    }


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
