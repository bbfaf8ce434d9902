"""Wears the parts of a machine with a deck of one's own, update by update.

The deck is plain LIGGGHTS input with two includes: `parts.in` where its meshes belong, which sets `number` and `meshes`
for the wall's line, and `running.in` as the last line, which moves, accounts, runs and writes the restart file. It gets
the variables `update` (0, 1, ...), `before` (restart file to go on from, but for update 0) and `time_step` (s).
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, stl_corners, unit_normals, write_stl, write_surface
from bulkwear.postproc.motion import AT_REST, Motion
from bulkwear.postproc.readers.load_ledger import read_load_ledger
from bulkwear.postproc.wear.balance import BalanceError, GrowthError, lost_volume, volume_balance
from bulkwear.postproc.wear.built_shape import with_built_shape
from bulkwear.postproc.wear.caps import Caps, edge_limit
from bulkwear.postproc.wear.displacement import StepTooLargeError
from bulkwear.postproc.wear.fields import CARRIED_VOLUME
from bulkwear.postproc.wear.laws import worn_volume
from bulkwear.postproc.wear.ledger import columns_of_solver, pressed_sides
from bulkwear.postproc.wear.mesh_faults import Bounds, with_target_edges
from bulkwear.postproc.wear.remesh import RemeshError, remesh
from bulkwear.postproc.wear.side import TouchedSideError
from bulkwear.postproc.wear.update import wear_update
from bulkwear.workflows.engine.solver import LEDGER_EXECUTABLE, run_deck
from bulkwear.workflows.engine.wear_step import WearError

CURED_BY_SMALLER_STEPS = (GrowthError, StepTooLargeError, RemeshError)
RESTART = "after.restart"
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")  # of a part, which is a word of the deck and a file
EDGE_SHARE = 0.05  # -, of the shortest edge at a node, that it may recede in one update; what is left is carried


@dataclass(frozen=True, eq=False)
class Part:
    """A part that wears: its surface in its own frame (m), present and pristine, and how it moves.

    law_volume_m3: of the wear law, over all updates; columns: of the last ledger; balance_error: relative, of volumes
    """

    name: str
    surface: SurfaceMesh
    pristine: SurfaceMesh
    motion: Motion = AT_REST
    law_volume_m3: float = 0.0
    columns: dict | None = None
    balance_error: float = 0.0


def part_of(name: str, surface: SurfaceMesh, motion: Motion = AT_REST) -> Part:
    """A part that nothing has worn, its sharp edges and hollows known as built."""
    pristine = with_target_edges(with_built_shape(surface))
    return Part(name, pristine, pristine, motion)


def wear_machine(
    folder: Path,
    deck: Path,
    parts: Sequence[Part],
    cycle_steps: int,
    time_step_s: float,
    coefficient_per_pa: float,
    updates: int,
    ranks: int = 1,
    bounds: Bounds | None = None,
) -> Iterator[list[Part]]:
    """Simulate and wear in turn; yields the parts after every update, which has a folder with all its files.

    deck: see above; cycle_steps: of one update, each time_step_s long; coefficient_per_pa: Archard's, volume over work;
    bounds: beyond which worn triangles are remeshed, None: never
    Raises ValueError for what cannot be simulated, FileExistsError where an update has its folder already, SolverError
    and WearError.
    """
    _check(folder, deck, parts, cycle_steps, time_step_s, coefficient_per_pa)
    cycle_s = cycle_steps * time_step_s
    for update in range(updates):
        here = folder / f"update_{update:03d}"
        write_update(here, deck, parts, update, update * cycle_s, cycle_steps)
        before = f"../update_{update - 1:03d}/{RESTART}"
        variables = {"update": str(update), "before": before, "time_step": str(time_step_s)}
        kept = {f"{part.name}_{update}": len(part.surface.triangles) for part in parts}
        run_deck(here, ranks, triangles=kept, executable=LEDGER_EXECUTABLE, variables=variables)
        parts = [worn(part, here, update, coefficient_per_pa, bounds) for part in parts]
        yield parts


def _check(
    folder: Path, deck: Path, parts: Sequence[Part], steps: int, time_step_s: float, coefficient_per_pa: float
) -> None:
    """Raise for arguments of `wear_machine` that the solver, or the wear after it, would stumble over."""
    if not deck.is_file():
        raise ValueError(f"{deck}: there is no such deck.")
    if not parts:
        raise ValueError("parts is empty, allowed is one part or more.")
    names = [part.name for part in parts]
    for name in names:
        if not NAME.fullmatch(name) or names.count(name) > 1:
            raise ValueError(f"a part is called {name!r}, allowed are letters, digits and _, each name once.")
    if not steps >= 1:
        raise ValueError(f"cycle_steps is {steps}, allowed are 1 or more.")
    for what, value in (("time_step_s", time_step_s), ("coefficient_per_pa", coefficient_per_pa)):
        if not 0.0 < value < float("inf"):
            raise ValueError(f"{what} is {value:g}, allowed are values above 0.")
    if (first := folder / "update_000").exists():
        raise FileExistsError(f"{first} is there already, allowed is a folder without updates.")


def write_update(here: Path, deck: Path, parts: Sequence[Part], update: int, begin_s: float, steps: int) -> None:
    """Write what the solver reads: the parts where they stand at that time (s), and the lines that go with them.

    Every update has mesh ids of its own: a known id would bring the old surface back out of the restart file.
    """
    here.mkdir(parents=True)
    shutil.copy(deck, here / "deck.in")
    meshes, running, ledgers = [], [], [f"ledger_{part.name}" for part in parts]
    for part in parts:
        mesh, surface = f"{part.name}_{update}", part.surface
        write_stl(here / f"{part.name}.stl", part.motion.placed(surface.points, begin_s), surface.triangles)
        meshes.append(f"fix {mesh} all mesh/surface/stress file {part.name}.stl type 2 {part.motion.mesh_words()}")
        running += part.motion.deck_lines(mesh, begin_s)
        running.append(f"fix ledger_{part.name} all load/ledger mesh {mesh} file {part.name}.bin")
    running += [f"run {steps}", *(f"unfix {name}" for name in ledgers), f"write_restart {RESTART}"]
    names = " ".join(f"{part.name}_{update}" for part in parts)
    variables = [f"variable number index {len(parts)}", f'variable meshes index "{names}"']
    (here / "parts.in").write_text("\n".join([*meshes, *variables]) + "\n")
    (here / "running.in").write_text("\n".join(running) + "\n")


def worn(part: Part, here: Path, update: int, coefficient_per_pa: float, bounds: Bounds | None) -> Part:
    """The part after the wear of an update: ledger, touched side, law, displacement, and the balance of volumes."""
    surface = part.surface
    ledger = read_load_ledger(here / f"{part.name}.bin", f"{part.name}_{update}", len(surface.triangles))
    columns = columns_of_solver(ledger.columns, stl_corners(surface.points, surface.triangles))
    pressed = pressed_sides(columns, unit_normals(surface.points, surface.triangles))
    volume = worn_volume("archard", columns, {"wear_coefficient_per_pa": coefficient_per_pa})
    try:
        surface = receded(surface, volume, pressed, bounds)
        lost, rounding = lost_volume(part.pristine, surface)
        law = part.law_volume_m3 + float(volume.sum())
        error = volume_balance(lost, float(surface.point_data[CARRIED_VOLUME].sum()), law, rounding)
    except (*CURED_BY_SMALLER_STEPS, TouchedSideError, BalanceError) as fault:
        raise WearError(f"part {part.name}, update {update}: {fault}") from fault
    write_surface(here / f"{part.name}.vtu", surface)
    return replace(part, surface=surface, law_volume_m3=law, columns=columns, balance_error=error)


def receded(
    surface: SurfaceMesh, volume: np.ndarray, pressed: tuple[np.ndarray, np.ndarray], bounds: Bounds | None
) -> SurfaceMesh:
    """The surface after a volume (m,) m3 is worn off, remeshed if bounds are given; smaller steps where it must be."""
    caps = Caps(edge_limit(surface.points, surface.triangles, EDGE_SHARE), surface)
    while True:
        try:
            worn, _ = wear_update(surface, volume, caps.cap, pressed=pressed)
            return worn if bounds is None else remesh(worn, bounds).mesh
        except CURED_BY_SMALLER_STEPS as fault:
            if not caps.shrunk(getattr(fault, "places", None)):
                raise
