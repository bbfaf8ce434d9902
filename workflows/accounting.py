"""What a simulated cycle leaves: its loads become a ledger, the ledger wears the surface, forces go into a table."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from postproc.mesh import SurfaceMesh
from postproc.readers.mesh_loads import read_mesh_loads
from workflows.cases import CASES
from workflows.cases.base import CycleError
from workflows.chain import Chain
from workflows.ledgers import producer
from workflows.schedule import Span
from workflows.wear_step import wear

LEDGER, FORCES = "ledger.parquet", "forces.csv"


def account_and_wear(chain: Chain, span: Span, folder: Path, surface: SurfaceMesh) -> dict[str, Any]:
    """Turn what the solver wrote in a cycle into its ledger and worn surface; return its record.

    What only the ledger was made from is removed. Raises CycleError for a cycle that the case does not accept.
    """
    source, case = producer(chain.parameters), CASES[chain.case]
    ledger_bytes = source.written_bytes(folder)
    ledger = account(chain, span, folder, surface)
    case.forces(chain.parameters, span, folder).to_csv(folder / FORCES, index=False)
    own = case.own_columns(chain.parameters, span, folder)
    if fault := case.cycle_fault(chain.parameters, own):
        raise CycleError(f"{chain.name}, cycle {span.cycle}: {fault}")
    row = wear(chain, span, folder, surface, ledger) | own
    for name in (*source.files, *case.leftovers):
        (folder / name).unlink()
    return {"wear": row, "cost": {"ledger_bytes": ledger_bytes}}


def account(chain: Chain, span: Span, folder: Path, surface: SurfaceMesh) -> pd.DataFrame:
    """Write a cycle's ledger, the solver's own measures beside it, and return it. Raises the producer's errors.

    It has a row per triangle that the solver got, under its number on the whole surface.
    """
    piece = CASES[chain.case].piece(chain.parameters, span, surface)
    columns = producer(chain.parameters).columns(chain, span, folder, piece.mesh)
    own = read_mesh_loads(folder / f"loads_{span.solver_steps}.vtk", len(piece.triangles))
    ledger = pd.DataFrame({"triangle": piece.triangles[own.pop("triangle")], **columns, **own})
    ledger.to_parquet(folder / LEDGER, index=False)
    return ledger
