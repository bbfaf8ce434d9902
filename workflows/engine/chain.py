"""A run as the driver sees it: where its cycles are, how long they are, and the decks that simulate them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from bulkwear.postproc.mesh import SurfaceMesh, read_surface, write_stl
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.case import Case
from bulkwear.workflows.engine.patience import PATIENCE, Patience
from bulkwear.workflows.engine.schedule import Span, cycle_title, first_span, known_spans
from bulkwear.workflows.engine.solver import DECK, LAUNCHER
from bulkwear.workflows.engine.templates import render

MOST_DECKS = 12  # wear cycles of a run whose decks are written to be run by hand
WORN_THROUGH = "worn_through"  # of a cycle's state: where, a phrase
SURFACE, RESTART = "surface.vtu", "run.restart"


@dataclass(frozen=True)
class Chain:
    """A run as the driver sees it.

    `parameters` and `bed` as the case makes them (SI), no bed where the case has none; paths,
    the MPI ranks that the solver gets and what starts them, which change nothing but the time it takes, the folder
    of a finished run with the same parameters, whose cycles this one shares, and how long a solver may make no step.
    """

    name: str
    folder: Path
    case: Case
    parameters: Mapping[str, Any]
    surface: Path
    bed: Mapping[str, Any] | None = None
    bed_restart: Path | None = None
    ranks: int = 1
    launcher: str = LAUNCHER
    same_as: Path | None = None
    patience: Patience = PATIENCE


def surface_before(chain: Chain, cycle: int) -> Path:
    """Return the surface that a cycle starts from."""
    return chain.surface if cycle <= 1 else state.cycle_folder(chain.folder, cycle - 1) / SURFACE


def span_of(chain: Chain, cycle: int) -> Span | None:
    """Return the span of a wear cycle (1, 2, ...) whose predecessors are finished; None after the last one, or where
    the surface is worn through and the run is to end then.
    """
    if cycle == 1:
        return first_span(chain.parameters)
    states = [state.read_state(chain.folder, number) for number in range(1, cycle)]
    if states[-1].get(WORN_THROUGH) and chain.parameters["wear"].get("worn_through", "stop") == "stop":
        return None
    span = chain.case.next_span(chain.parameters, states)
    return span and replace(span, substeps=chain.case.substeps(chain.parameters, states[-1]["wear"]))


def run_in_steps(chain: Chain) -> int:
    """Return the time steps of cycle 0."""
    return chain.case.run_in_steps(chain.parameters, chain.bed)


def steps_before(chain: Chain, span: Span | None) -> int:
    """Return the time steps of a run before a wear cycle; before cycle 0 (None) there are none."""
    return run_in_steps(chain) + span.first_step if span else 0


def total_steps(chain: Chain) -> int:
    """Return the time steps of a whole run."""
    return run_in_steps(chain) + chain.parameters["derived"]["travel_steps"]


def deck_text(chain: Chain, span: Span | None) -> str:
    """Return the deck of a wear cycle, or of cycle 0 (None); paths in it are relative to the cycle's folder."""
    restart = ""
    if span:
        restart = f"../{state.cycle_folder(chain.folder, span.cycle - 1).name}/{RESTART}"
    elif chain.bed_restart:
        restart = os.path.relpath(chain.bed_restart, state.cycle_folder(chain.folder, 0))
    return chain.case.deck(chain.parameters, chain.bed, span, restart)


def write_shared_files(chain: Chain) -> None:
    """Write what the decks of all cycles read besides surface and restart file."""
    chain.case.write_shared_files(chain.parameters, chain.bed, chain.surface, chain.folder)


def write_cycle(chain: Chain, span: Span | None, folder: Path, surface: SurfaceMesh) -> dict[str, int]:
    """Write the deck and the meshes of a wear cycle, or of cycle 0 (None), into its folder, where they run by hand.

    Returns {id of the mesh in the deck: number of its triangles}.
    """
    (folder / DECK).write_text(deck_text(chain, span))
    chain.case.write_cycle_files(chain.parameters, span, folder)
    pieces = chain.case.pieces(chain.parameters, span, surface)
    for piece in pieces:
        write_stl(folder / piece.stl, piece.mesh.points, piece.mesh.triangles)
    cycle = span.cycle if span else 0
    return {f"{piece.name}_{cycle}": len(piece.triangles) for piece in pieces}


def title(chain: Chain, cycle: int) -> str:
    """Return what people call a cycle."""
    return cycle_title(chain.parameters, cycle) if cycle else chain.case.first_title


# ---------------------------------------------------------------- decks by hand


def bed_deck_text(case: Case, bed: Mapping[str, Any]) -> str:
    """Return the deck of a bed. Raises DeckError."""
    return render(case.bed_template, case.bed_deck(bed))


def sample_decks(case: Case, parameters: Mapping[str, Any], bed: Mapping[str, Any] | None) -> list[str]:
    """Return a deck of each kind of a run, its bed's included if it has one. Raises DeckError."""
    return [*case.sample_decks(parameters, bed), *([bed_deck_text(case, bed)] if bed else [])]


def write_bed(case: Case, bed: Mapping[str, Any], folder: Path) -> None:
    """Write the deck of a bed, and what it reads, into its folder, where it runs by hand."""
    folder.mkdir(parents=True, exist_ok=True)
    case.write_bed_files(bed, folder)
    (folder / DECK).write_text(bed_deck_text(case, bed))


def write_decks(chain: Chain) -> None:
    """Write the decks of a run with what they read, without running the solver; they run by hand in their order.

    Of adaptive cycles only the first is known beforehand, of many the first `MOST_DECKS` are written: all have
    the pristine surface here, so later ones show nothing new.
    """
    surface = read_surface(chain.surface)
    chain.folder.mkdir(parents=True, exist_ok=True)
    write_shared_files(chain)
    for span in (None, *known_spans(chain.parameters)[:MOST_DECKS]):
        folder = state.cycle_folder(chain.folder, span.cycle if span else 0)
        folder.mkdir(parents=True, exist_ok=True)
        write_cycle(chain, span, folder, surface)
