"""A run as the driver sees it: where its cycles are, how long they are, and the decks that simulate them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from postproc.mesh import SurfaceMesh, read_surface, write_stl
from workflows import deck, state
from workflows.derived import WALLS
from workflows.schedule import Span, first_span, known_spans, next_span
from workflows.solver import DECK

SURFACE, SURFACE_STL, END_WALL, RESTART = "surface.vtu", "surface.stl", "end_wall.stl", "run.restart"


@dataclass(frozen=True)
class Chain:
    """A run as the driver sees it. `parameters` and `bed` as in design.py (SI); paths, and the MPI
    ranks that the solver gets, which change nothing but the time it takes."""

    name: str
    folder: Path
    parameters: Mapping[str, Any]
    bed: Mapping[str, Any]
    surface: Path
    bed_restart: Path
    ranks: int = 1


def surface_before(chain: Chain, cycle: int) -> Path:
    """Return the surface that a cycle starts from."""
    return chain.surface if cycle <= 1 else state.cycle_folder(chain.folder, cycle - 1) / SURFACE


def span_of(chain: Chain, cycle: int) -> Span | None:
    """Return the span of a wear cycle (1, 2, ...) whose predecessors are finished; None after the last one."""
    if cycle == 1:
        return first_span(chain.parameters)
    before = state.read_state(chain.folder, cycle - 1)
    return next_span(chain.parameters, Span(**before["span"]), before["wear"])


def run_in_steps(chain: Chain) -> int:
    """Return the time steps of cycle 0."""
    lowering = deck.lowered_bed(chain.parameters, chain.bed, "")["lowering_steps"]
    return lowering + chain.parameters["derived"]["run_in_steps"]


def steps_before(chain: Chain, span: Span | None) -> int:
    """Return the time steps of a run before a wear cycle; before cycle 0 (None) there are none."""
    return run_in_steps(chain) + span.first_step if span else 0


def total_steps(chain: Chain) -> int:
    """Return the time steps of a whole run."""
    return run_in_steps(chain) + chain.parameters["derived"]["travel_steps"]


def deck_text(chain: Chain, span: Span | None) -> str:
    """Return the deck of a wear cycle, or of cycle 0 (None); paths in it are relative to the cycle's folder."""
    if span:
        restart = f"../{state.cycle_folder(chain.folder, span.cycle - 1).name}/{RESTART}"
        return deck.render("sliding_sample", deck.sliding_sample(chain.parameters, chain.bed, span, restart))
    restart = os.path.relpath(chain.bed_restart, state.cycle_folder(chain.folder, 0))
    return deck.render("lowered_bed", deck.lowered_bed(chain.parameters, chain.bed, restart))


def write_cycle(chain: Chain, span: Span | None, folder: Path, surface: SurfaceMesh) -> None:
    """Write the deck and the surface of a wear cycle, or of cycle 0 (None), into its folder, where they run by hand."""
    (folder / DECK).write_text(deck_text(chain, span))
    write_stl(folder / SURFACE_STL, surface.points, surface.triangles)


def write_end_wall(chain: Chain) -> None:
    """Write the wall that closes the bed at both ends, two triangles across the domain at y = 0, where it has ends."""
    if chain.bed["ends"] != WALLS:
        return
    half_width, bottom, top = deck.end_wall_corners(chain.bed)
    corners = [(-half_width, bottom), (half_width, bottom), (half_width, top), (-half_width, top)]
    points = np.array([(x, 0.0, z) for x, z in corners])
    write_stl(chain.folder / END_WALL, points, np.array([[0, 1, 2], [0, 2, 3]]))


# ---------------------------------------------------------------- decks by hand


def write_bed(bed: Mapping[str, Any], folder: Path) -> None:
    """Write the deck of a bed into its folder, where it runs by hand."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / DECK).write_text(deck.render("settled_bed", deck.settled_bed(bed)))


def write_decks(chain: Chain) -> None:
    """Write the decks of a run with what they read, without running the solver; they run by hand in their order.

    Of adaptive cycles only the first is known beforehand.
    """
    surface = read_surface(chain.surface)
    chain.folder.mkdir(parents=True, exist_ok=True)
    write_end_wall(chain)
    for span in (None, *known_spans(chain.parameters)):
        folder = state.cycle_folder(chain.folder, span.cycle if span else 0)
        folder.mkdir(parents=True, exist_ok=True)
        write_cycle(chain, span, folder, surface)
