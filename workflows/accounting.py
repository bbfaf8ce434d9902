"""What a simulated cycle leaves: its loads become a ledger, the ledger wears the surface, forces go into a table."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from postproc.mesh import SurfaceMesh
from postproc.readers.mesh_loads import read_mesh_loads
from postproc.readers.solver_log import thermo_table
from workflows.chain import Chain
from workflows.derived import WALLS
from workflows.ledgers import producer
from workflows.schedule import Span
from workflows.solver import LOG
from workflows.wear_step import wear

LEDGER, FORCES = "ledger.parquet", "forces.csv"
SETUP_LOADS, SETUP_BED = "loads_0.vtk", "bed_0.dump"  # of the cycle's first instant: the last one of the cycle before


def account_and_wear(chain: Chain, span: Span, folder: Path, surface: SurfaceMesh) -> dict[str, Any]:
    """Turn what the solver wrote in a cycle into its ledger and worn surface; return its record.

    What only the ledger was made from is removed.
    """
    source = producer(chain.parameters)
    ledger_bytes = source.written_bytes(folder)
    ledger = account(chain, span, folder, surface)
    write_forces(chain, span, folder)
    row = wear(chain, span, folder, surface, ledger) | drive(chain, folder)
    for name in (*source.files, SETUP_LOADS, SETUP_BED):
        (folder / name).unlink()
    return {"wear": row, "cost": {"ledger_bytes": ledger_bytes}}


def account(chain: Chain, span: Span, folder: Path, surface: SurfaceMesh) -> pd.DataFrame:
    """Write a cycle's ledger, the solver's own measures beside it, and return it. Raises the producer's errors."""
    columns = producer(chain.parameters).columns(chain, span, folder, surface)
    own = read_mesh_loads(folder / f"loads_{span.steps}.vtk", len(surface.triangles))
    ledger = pd.DataFrame({"triangle": own.pop("triangle"), **columns, **own})
    ledger.to_parquet(folder / LEDGER, index=False)
    return ledger


def drive(chain: Chain, folder: Path) -> dict[str, float]:
    """Return the bed's mean velocity over a cycle, over its floor's (-), where friction alone takes the bed along."""
    if chain.parameters["bed"]["ends"] == WALLS:
        return {}
    pace = thermo_table(folder / LOG)["bed_pace"][1:].mean()
    return {"bed_over_floor_velocity": float(pace / chain.parameters["sliding"]["velocity_m_per_s"])}


def write_forces(chain: Chain, span: Span, folder: Path) -> None:
    """Write the bed's force on the sample over a cycle; the set-up row of a run holds no force and is left out."""
    thermo = thermo_table(folder / LOG)
    derived = chain.parameters["derived"]
    step = thermo["Step"][1:] + span.first_step
    time_s = step * derived["time_step_s"]
    table = {"time_s": time_s, "travel_m": time_s * chain.parameters["sliding"]["velocity_m_per_s"]}
    table |= {f"force_{axis}_N": thermo[f"force_{axis}"][1:] for axis in "xyz"}
    pd.DataFrame(table).to_csv(folder / FORCES, index=False)
