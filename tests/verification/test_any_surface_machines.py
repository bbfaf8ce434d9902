"""Four machines worn over ten updates on the solver: chute, case with shelves, moving bucket, conveyor.

Balance of volumes, side and direction of the wear, and every triangle kept, after every update.
"""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path

import igl
import numpy as np
import pytest

from bulkwear.postproc.mesh import SurfaceMesh, unit_normals
from bulkwear.postproc.motion import oscillation
from bulkwear.postproc.wear.displacement import swept_volume
from bulkwear.postproc.wear.ledger import pressed_sides
from bulkwear.postproc.wear.side import SIDE, TURNED, turned_as
from bulkwear.workflows.engine.own_machine import Part, part_of, wear_machine
from tests.verification.machines.four import MACHINES, chute

pytestmark = pytest.mark.solver

UPDATES = 10
BALANCE = 1e-9  # relative, of geometry against coefficient times work
# Coordinates of half a metre are good to 1e-16 m; the distance to a surface is made of their products. Measured: 4e-18.
OUTSIDE = 1e-13  # m
SWEPT_ROUNDING = 1e-9  # relative to the largest volume that a face has lost. Measured: 1e-17
SAME_WORK = 1e-9  # relative, before collisions make rounding grow. Measured: 1e-12
SAME_PLACE = 1e-12  # m; steps of micrometres. Measured: 2e-16
FIRST_WEAR = {"chute": 2, "cascade": 2, "bucket": 3, "conveyor": 2}  # updates until each machine has been touched
IMPORTED = re.compile(r"Import and parallelization of mesh (\S+) containing (\d+) triangle")


def updates_of(folder: Path, name: str, updates: int, ranks: int = 1, parts: tuple[Part, ...] | None = None):
    """The parts after each update of a machine, those of the machine if none are given."""
    machine = MACHINES[name]()
    given = machine.parts if parts is None else parts
    settings = (machine.cycle_steps, machine.time_step_s, machine.coefficient_per_pa, updates, ranks)
    return wear_machine(folder, machine.deck, given, *settings)


def assert_worn_into_the_body(part: Part) -> None:
    """No node of the worn surface stands out of the pristine one, and no face has swept volume out of the body."""
    pristine, present = turned_as(part.pristine, part.surface), part.surface
    kind = igl.SIGNED_DISTANCE_TYPE_PSEUDONORMAL
    outside = igl.signed_distance(present.points, pristine.points, pristine.triangles, sign_type=kind)[0]
    assert outside.max() <= OUTSIDE
    swept = swept_volume(pristine.points, present.points - pristine.points, pristine.triangles)
    assert swept.min() >= -SWEPT_ROUNDING * swept.max()


def assert_kept(screen: str, parts: list[Part], update: int) -> None:
    """The solver has every triangle of every part that wears."""
    found = {mesh: int(count) for mesh, count in IMPORTED.findall(screen)}
    assert {f"{part.name}_{update}": len(part.surface.triangles) for part in parts} == found


def assert_sound(folder: Path, name: str, updates: int, ranks: int = 1, given=None) -> None:
    """Wear a machine, or these parts of it, and check every update."""
    history = []
    for update, parts in enumerate(updates_of(folder, name, updates, ranks, given)):
        assert_kept((folder / f"update_{update:03d}" / "screen.txt").read_text(), parts, update)
        for part in parts:
            assert part.balance_error <= BALANCE
            assert_worn_into_the_body(part)
        history.append(parts)
    for part in history[-1]:
        assert part.law_volume_m3 > 0.0
    coefficient = MACHINES[name]().coefficient_per_pa
    for earlier, later in pairwise(history):
        for before, after in zip(earlier, later, strict=True):
            work = after.columns["sliding_work_J"].sum()
            added = after.law_volume_m3 - before.law_volume_m3
            assert added == pytest.approx(coefficient * work, rel=BALANCE, abs=BALANCE * after.law_volume_m3)


def flipped(part: Part) -> Part:
    """The part as a file would have it whose facets look the other way, its side not known."""
    mesh = part.surface
    return part_of(part.name, SurfaceMesh(mesh.points, mesh.triangles[:, ::-1]), part.motion)


def assert_same_when_flipped(folder: Path, name: str) -> None:
    """Wear a machine from files with either winding: the same work on each facet, the same worn surface."""
    upside = [flipped(part) for part in MACHINES[name]().parts]
    runs = [
        list(updates_of(folder / "as_drawn", name, FIRST_WEAR[name])),
        list(updates_of(folder / "flipped", name, FIRST_WEAR[name], parts=upside)),
    ]
    for part, other in zip(runs[0][-1], runs[1][-1], strict=True):
        work = part.columns["sliding_work_J"]
        assert work.sum() > 0.0
        assert other.columns["sliding_work_J"] == pytest.approx(work, abs=SAME_WORK * work.sum())
        assert other.surface.points == pytest.approx(part.surface.points, abs=SAME_PLACE)
        moved = (part.surface.points != part.pristine.points).any(axis=1)
        assert moved.any()


def test_two_updates_of_the_conveyor(tmp_path):
    """Belt and box wear into their bodies, volumes in balance; files with either winding give the same."""
    assert_sound(tmp_path / "sound", "conveyor", 2)
    assert_same_when_flipped(tmp_path, "conveyor")


@pytest.mark.verify
@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("name", MACHINES)
def test_ten_updates(tmp_path, name, ranks):
    """Ten updates: volumes in balance, nothing grows, the solver takes every worn surface whole."""
    assert_sound(tmp_path, name, UPDATES, ranks)


@pytest.mark.verify
def test_shaken_chute(tmp_path):
    """A chute that swings, its period no part of a cycle: what holds at rest holds for it."""
    swing = oscillation((0.0, 0.001, 0.002), 0.0371, 0.3)
    assert_sound(tmp_path, "chute", 5, given=tuple(part_of(p.name, p.surface, swing) for p in chute().parts))


@pytest.mark.verify
@pytest.mark.parametrize("name", ["chute", "cascade", "bucket"])
def test_winding_of_the_file_does_not_matter(tmp_path, name):
    """Files with either winding give the same work on each facet and the same worn surface."""
    assert_same_when_flipped(tmp_path, name)


@pytest.mark.verify
def test_facets_of_the_chute_look_away_from_the_flow(tmp_path):
    """The first contacts are all on the back of the facets; the chute is turned once, and from then on they are not."""
    history = list(updates_of(tmp_path, "chute", 4))
    drawn = history[0][0].surface
    assert np.array_equal(drawn.triangles, chute().parts[0].surface.triangles)
    front, back = pressed_sides(history[1][0].columns, unit_normals(drawn.points, drawn.triangles))
    assert back.sum() > 0.0
    assert not front.any()
    assert (history[1][0].surface.cell_data[SIDE] == TURNED).all()
    for before, after in pairwise(history[1:]):
        surface = before[0].surface
        front, back = pressed_sides(after[0].columns, unit_normals(surface.points, surface.triangles))
        assert front.sum() > 0.0
        assert not back.any()
