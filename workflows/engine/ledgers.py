"""The two producers of a wear cycle's load ledger, behind one interface: what the study's key `ledger` chooses from.

Both turn what the solver left in a cycle's folder into the same columns. `solver`: the solver has summed every contact
of every step. `dumps`: the contacts of some steps, written by any LIGGGHTS, are summed here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bulkwear.postproc.mesh import stl_corners
from bulkwear.postproc.readers.contacts import read_contact_batches
from bulkwear.postproc.readers.cycle_folders import step_files
from bulkwear.postproc.readers.load_ledger import read_load_ledger
from bulkwear.postproc.wear.ledger import LedgerBuilder, columns_of_solver
from bulkwear.postproc.wear.mesh_frame import facet_frames
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.case import Piece as Mesh
from bulkwear.workflows.engine.chain import Chain
from bulkwear.workflows.engine.derived import run_kernels
from bulkwear.workflows.engine.schedule import Span

CONTACTS, SPINS, TOUCHING = "contacts.dump", "spins.dump", "touching.npy"
SAMPLE_MESH = 0  # index of the sample among the meshes of the wall fix

Columns = dict[str, np.ndarray]


class SamplesError(RuntimeError):
    """A cycle's dumps lack samples of the contacts; the message names the file."""


@dataclass(frozen=True)
class Producer:
    """A producer of load ledgers.

    columns: (chain, span of the cycle, its folder, one of its meshes) -> {column: (m,) array}, units in the names
    patterns: names of what the solver writes for it; of no use once the ledger is written
    history: the same arguments -> (steps of the cycle, columns until then) of looks inside it, in order
    kept: what it leaves for the next cycle
    """

    columns: Callable[[Chain, Span, Path, Mesh], Columns]
    patterns: tuple[str, ...]
    history: Callable[[Chain, Span, Path, Mesh], Iterator[tuple[int, Columns]]]
    kept: tuple[str, ...] = ()

    def written(self, folder: Path) -> list[Path]:
        """Return the files that the solver wrote into a cycle's folder for the ledger."""
        return [path for pattern in self.patterns for path in folder.glob(pattern)]

    def written_bytes(self, folder: Path) -> int:
        """Return how much that is."""
        return sum(path.stat().st_size for path in self.written(folder))


def producer(parameters: Mapping[str, Any]) -> Producer:
    """Return the producer that a run's parameters choose."""
    return PRODUCERS[parameters["ledger"]]


def summed_by_solver(chain: Chain, span: Span, folder: Path, mesh: Mesh) -> Columns:
    """Return the ledger that the solver has summed. Raises LoadLedgerError where it is not that of this cycle."""
    return _columns_of_file(folder / mesh.ledger, chain, span, mesh, span.solver_steps, *_facets(mesh))


def history_of_solver(chain: Chain, span: Span, folder: Path, mesh: Mesh) -> Iterator[tuple[int, Columns]]:
    """Yield steps of a cycle and what the solver had summed until then. Raises LoadLedgerError."""
    facets = _facets(mesh)
    for path in step_files(folder, f"{mesh.ledger}.", ""):
        steps = int(path.suffix[1:])
        yield steps, _columns_of_file(path, chain, span, mesh, steps, *facets)


def _columns_of_file(
    path: Path, chain: Chain, span: Span, mesh: Mesh, steps: int, corners: np.ndarray, frames: np.ndarray
) -> Columns:
    loads = read_load_ledger(path, mesh=f"{mesh.name}_{span.cycle}", n_triangles=len(mesh.triangles), steps=steps)
    return columns_of_solver(loads.columns, corners, chain.case.kernels(chain.parameters), frames)


def _facets(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners (m, 3, 3) m of a mesh's facets as the solver got them, in the frame of its ledger, and the
    frames (m, 3, 3) of these facets.
    """
    facets = mesh.frame or mesh.mesh
    corners = stl_corners(facets.points, facets.triangles)
    return corners, facet_frames(corners)


def summed_from_dumps(chain: Chain, span: Span, folder: Path, mesh: Mesh) -> Columns:
    """Return the ledger of the sampled contacts; leaves the ids of the particles that touch at the end.

    Raises ContactDumpError, SamplesError.
    """
    parameters, surface = chain.parameters, mesh.mesh
    every, derived = parameters["solver"]["sampling_interval_steps"], parameters["derived"]
    builder = LedgerBuilder(
        len(surface.triangles),
        SAMPLE_MESH,
        effective_modulus(parameters),
        parameters["particle"]["density_kg_per_m3"],
        touching=_touching_before(chain, span.cycle),
        kernels=run_kernels(parameters),
        corners=stl_corners(surface.points, surface.triangles),
    )
    for batch in read_contact_batches(folder / CONTACTS, folder / SPINS, after_step=0):
        builder.add_batch(batch, every * derived["time_step_s"])
    expected = span.steps // every
    if builder.samples != expected:
        raise SamplesError(
            f"{folder / CONTACTS}: found {builder.samples} samples of the contacts, allowed is {expected}."
        )
    touching = builder.touching
    np.save(folder / TOUCHING, np.zeros(0, np.int64) if touching is None else touching)
    return builder.table()


def no_history(chain: Chain, span: Span, folder: Path, mesh: Mesh) -> Iterator[tuple[int, Columns]]:
    """Yield nothing: sampled contacts are summed over whole cycles."""
    return iter(())


def _touching_before(chain: Chain, cycle: int) -> np.ndarray | None:
    path = state.cycle_folder(chain.folder, cycle - 1) / TOUCHING
    return np.load(path) if path.exists() else None


def effective_modulus(parameters: Mapping[str, Any]) -> float:
    """Return E* (Pa) of particle and sample as simulated: 1/E* = sum of (1 - nu^2)/E (Hertz 1882)."""
    moduli = parameters["derived"]["youngs_modulus_pa"]
    pairs = ((name, parameters[name]["poissons_ratio"]) for name in ("particle", "sample_material"))
    return 1.0 / sum((1.0 - ratio**2) / moduli[name] for name, ratio in pairs)


PRODUCERS = {
    "solver": Producer(summed_by_solver, ("load_ledger*.bin", "load_ledger*.bin.*"), history_of_solver),
    "dumps": Producer(summed_from_dumps, (CONTACTS, SPINS), no_history, kept=(TOUCHING,)),
}
