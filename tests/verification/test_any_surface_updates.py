"""A pressed sphere over parts that move, through the whole loop: restart, pose, ledger, touched side, law, wear."""

from __future__ import annotations

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.motion import Motion, combined, oscillation, rotation, translation
from bulkwear.workflows.engine.own_machine import part_of, wear_machine
from tests.verification.ledger_cases import LOAD
from tests.verification.machines.four import DECKS
from tests.verification.surface_cases import Attitude, attitude, height, pressed_sphere

pytestmark = pytest.mark.solver

UPDATES, STEPS, TIME_STEP = 4, 1500, 2e-6  # -, -, s
DURATION = UPDATES * STEPS * TIME_STEP  # s
COEFFICIENT = 1e-12  # 1/Pa: a few nm, little beside an overlap of 41 um, so that the load stays near its equilibrium
WORK_TOLERANCE = 1e-6  # relative. Measured: 3e-7
# The speed of a point of a turning part is that of the end of a step. Where the axis swings by 1 mm at 120 rad/s it
# changes by up to 0.12 m/s, of which half a step counts: 1.2e-7 m of a way of 8 mm. Measured: 1.7e-5
SWINGING_AXIS_TOLERANCE = 3e-5  # relative
INSTANTS = 20_000  # for the way in closed form: chords and reversals cost less than 1e-7 of it


def swing(where: Attitude) -> Motion:
    """To and fro in the plate, its period no part of an update."""
    return oscillation(tuple(where.direction([0.0007, 0.002, 0.0])), 0.0071, 0.4)


def turn(where: Attitude) -> Motion:
    """Round an axis along the plate's normal."""
    return rotation(axis_point(where), tuple(where.direction([0.0, 0.0, 1.0])), 120.0, start_s=0.001, ramp_s=0.004)


def rocking_turn(where: Attitude) -> Motion:
    """A table that swings and turns on itself."""
    return combined(oscillation(tuple(where.direction([0.001, 0.0, 0.0])), 0.0083), turn(where))


def push_and_turn(where: Attitude) -> Motion:
    """A push that ends within an update, and a turn that begins within another one."""
    push = translation(tuple(where.direction([0.3, 0.4, 0.0])), ramp_s=0.001, stop_s=0.0052)
    return combined(rotation(axis_point(where), tuple(where.direction([0.0, 0.0, 1.0])), 120.0, start_s=0.0071), push)


def axis_point(where: Attitude) -> tuple[float, ...]:
    """A point (m) on the axis, off the sphere."""
    return tuple(where.points([[0.003, -0.004, 0.0]])[0])


def way(motion: Motion, point: np.ndarray) -> float:
    """Length (m) that a point fixed in space travels over the part until the end, all to and fro counted."""
    track = []
    for time in np.linspace(0.0, DURATION, INSTANTS + 1):
        turned, shift = motion.pose(time)
        track.append(turned.T @ (point - shift))
    return float(np.linalg.norm(np.diff(track, axis=0), axis=1).sum())


@pytest.mark.parametrize(
    ("make", "tolerance"),
    [
        (swing, WORK_TOLERANCE),
        (turn, WORK_TOLERANCE),
        (rocking_turn, SWINGING_AXIS_TOLERANCE),
        pytest.param(push_and_turn, WORK_TOLERANCE, marks=pytest.mark.verify),
    ],
)
def test_worn_volume_is_load_times_way(tmp_path, make, tolerance):
    """Four updates on a part along no axis, drawn with its facets away: k F times the way, to and fro, in the loop."""
    where = attitude(12)
    motion, outward = make(where), where.direction([0.0, 0.0, 1.0])
    plate = flat_plate(0.016, 0.016, 1e-3)
    surface = SurfaceMesh(where.points(plate.points), plate.triangles[:, ::-1])
    centre = where.points([[0.000131234567, 0.0001007123456, height()]])[0]
    particles, load = pressed_sphere(centre, np.zeros(3), outward)
    for name, lines in (("sphere.in", particles), ("nothing.in", ["# the restart file has it"]), ("load.in", load)):
        (tmp_path / name).write_text("\n".join(lines) + "\n")
    deck, parts = DECKS / "pressed_sphere.in", [part_of("plate", surface, motion)]
    *_, (part,) = wear_machine(tmp_path, deck, parts, STEPS, TIME_STEP, COEFFICIENT, UPDATES)
    expected = COEFFICIENT * LOAD * way(motion, centre - height() * outward)
    assert part.law_volume_m3 / expected == pytest.approx(1.0, abs=tolerance)
    recession = -(part.surface.points - surface.points) @ outward
    assert recession.min() > -1e-15
    assert recession.max() > 0.0
