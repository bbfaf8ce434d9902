"""What a simulated cycle leaves: its loads become a ledger, the ledger wears the surface, forces go into a table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import SurfaceMesh, read_surface, worn_faces
from bulkwear.postproc.readers.mesh_loads import read_mesh_loads
from bulkwear.postproc.wear.thickness import through_phrase
from bulkwear.workflows.engine.case import CycleError, Piece
from bulkwear.workflows.engine.chain import SURFACE, WORN_THROUGH, Chain
from bulkwear.workflows.engine.ledgers import producer
from bulkwear.workflows.engine.schedule import Span
from bulkwear.workflows.engine.wear_step import load_sums, on_whole_surface, wear

LEDGER, HISTORY = "ledger.parquet", "wear_history.csv"


def account_and_wear(chain: Chain, span: Span, folder: Path, surface: SurfaceMesh) -> tuple[dict[str, Any], list[Path]]:
    """Turn what the solver wrote in a cycle into its ledger, tables and worn surface.

    Returns the cycle's record and the files that nobody needs once its state is written; until then all of them stay,
    and it can be done again. Raises CycleError for a cycle that the case does not accept.
    """
    source, case = producer(chain.parameters), chain.case
    ledger_bytes = source.written_bytes(folder)
    pieces = case.pieces(chain.parameters, span, surface)
    ledger = account(chain, span, folder, pieces)
    wear_history(chain, span, folder, surface, pieces, ledger).to_csv(folder / HISTORY, index=False)
    case.forces(chain.parameters, span, folder).to_csv(folder / case.forces_table, index=False)
    own = case.own_columns(chain.parameters, span, folder)
    if fault := case.cycle_fault(chain.parameters, own):
        raise CycleError(f"{chain.name}, cycle {span.cycle}: {fault}")
    row = wear(chain, span, folder, surface, ledger) | own
    spent = [*source.written(folder), *(folder / name for name in case.leftovers)]
    spent += case.reduce(chain.parameters, span, folder)
    record = {"wear": row, "cost": {"ledger_bytes": ledger_bytes}}
    if nodes := int(row["through_nodes"]):
        record[WORN_THROUGH] = worn_through_words(nodes, read_surface(folder / SURFACE))
    return record, spent


def worn_through_words(nodes: int, worn: SurfaceMesh) -> str:
    """Return where a surface is worn through.

    nodes: worn through by the update, one at least; worn: after it and remeshing, which may take the last one away
    """
    return through_phrase(worn) or f"worn through at {nodes} nodes, which remeshing has merged with their neighbours"


def account(chain: Chain, span: Span, folder: Path, pieces: Sequence[Piece]) -> pd.DataFrame:
    """Write a cycle's ledger, the solver's own measures beside it, and return it. Raises the producer's errors.

    It has a row per triangle that the solver got, under its number on the whole surface; pieces: the meshes of these,
    as from `Case.pieces`.
    """
    last = chain.case.piece_ends(chain.parameters, chain.bed, span)[-1]
    ledgers = []
    for piece in pieces:
        columns = producer(chain.parameters).columns(chain, span, folder, piece)
        own = read_mesh_loads(folder / f"{piece.loads}_{last}.vtk", len(piece.triangles))
        ledgers.append(pd.DataFrame({"triangle": piece.triangles[own.pop("triangle")], **columns, **own}))
    ledger = pd.concat(ledgers, ignore_index=True)
    if len(ledgers) > 1:
        ledger = ledger.sort_values("triangle", ignore_index=True)
    ledger = chain.case.on_surface(chain.parameters, ledger)
    ledger.to_parquet(folder / LEDGER, index=False)
    return ledger


def wear_history(
    chain: Chain, span: Span, folder: Path, surface: SurfaceMesh, pieces: Sequence[Piece], ledger: pd.DataFrame
) -> pd.DataFrame:
    """Return the wear of a cycle from look to look, without reading anything between two steps twice.

    A row per stretch: cycle, time_s and the case's travel at its end, and of the stretch sliding_work_J,
    worn_volume_m3, the case's columns by label and mean_normal_force_N, as in wear.csv, whose row they add up to.
    Raises the producer's errors.
    """
    parameters = chain.parameters
    steps, sums = [0], []
    looks = [producer(parameters).history(chain, span, folder, piece) for piece in pieces]
    for together in zip(*looks, strict=True):
        tables = [
            pd.DataFrame({"triangle": piece.triangles, **columns})
            for piece, (_, columns) in zip(pieces, together, strict=True)
        ]
        look = on_whole_surface(pd.concat(tables, ignore_index=True), len(surface.triangles))
        steps.append(together[0][0])
        sums.append(_sums_of_look(chain, span, surface, look))
    whole = on_whole_surface(ledger, len(surface.triangles))
    steps.append(span.solver_steps)
    sums.append(_sums_of_look(chain, span, surface, whole))
    duration = np.array(steps) * parameters["derived"]["time_step_s"] / span.substeps
    end = span.first_step * parameters["derived"]["time_step_s"] + duration[1:]
    table = pd.DataFrame(sums)
    table = table.diff().fillna(table)
    force = table.pop("normal_impulse_N_s") / np.diff(duration)
    place = {"cycle": span.cycle, "time_s": end, **chain.case.travel_columns(parameters, end)}
    return pd.DataFrame(place).join(table).assign(mean_normal_force_N=force)


def _sums_of_look(chain: Chain, span: Span, surface: SurfaceMesh, ledger: pd.DataFrame) -> dict[str, float]:
    """Loads and the wear law's volume summed over the faces that wear, of all and by the case's labels."""
    volume = chain.case.law_volume(chain.parameters, span, surface, ledger) * worn_faces(surface)
    return {
        **load_sums(surface, ledger),
        "worn_volume_m3": float(volume.sum()),
        **chain.case.label_columns(surface, volume),
    }
