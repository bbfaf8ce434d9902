"""Poses of moving parts as the solver has them, in two chained runs with a restart, against the closed forms.

Three spheres rest where each dents one side of a box at its last pose. Their contact points lie on the sides, in all
digits of the dump; a box that is shifted or turned has them elsewhere.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from bulkwear.meshes.plate import closed_box
from bulkwear.postproc.mesh import write_stl
from bulkwear.postproc.motion import (
    Motion,
    angular_oscillation,
    belt,
    combined,
    oscillation,
    rotation,
    translation,
    turning_surface,
)
from tests.verification.ledger_cases import run

pytestmark = pytest.mark.solver

RADIUS, OVERLAP = 0.004, 4e-4  # m, of the spheres
TIME_STEP = 1e-5  # s
STEPS = (700, 1300)  # of the two runs
START = 12.3456  # s, of the first one: long after the part began to move
END = START + sum(STEPS) * TIME_STEP  # s
VELOCITY_TOLERANCE = 1e-3  # relative; the solver turns its speed by 50 rad/s within the step, 5e-4
PRINTED = 1e-12  # m/s; the dump prints all digits, what is left is rounding
STANDSTILL = 1e-10  # m/s; rounding of poses over a step
POSE_TOLERANCE = 1e-10  # m; the STL of 9 digits is good to 5e-11 for coordinates below 0.1 m, the sums to far less
AXIS, POINT = (0.3, -0.5, 0.8), (0.01, 0.02, -0.005)

MOTIONS = {
    "at rest": Motion(),
    "translation": translation((0.2, -0.1, 0.05), start_s=12.3),
    "translation that starts meanwhile": translation((2.0, -1.0, 0.5), start_s=12.35, ramp_s=0.004),
    "rotation": rotation(POINT, AXIS, -20.0),
    "rotation that starts meanwhile": rotation(POINT, AXIS, 50.0, start_s=12.3526, ramp_s=0.005),
    "translation that stops meanwhile": translation((2.0, -1.0, 0.5), start_s=12.345, ramp_s=0.001, stop_s=12.3546),
    "push that ends and a turn that begins": combined(
        rotation(POINT, AXIS, 40.0, start_s=12.3556, ramp_s=0.002),
        translation((2.0, -1.0, 0.5), start_s=12.345, ramp_s=0.001, stop_s=12.3546),
    ),
    "jerk": translation((2.0, -1.0, 0.5), start_s=12.350003),
    "oscillation": oscillation((0.003, 0.002, -0.001), 0.0173, 0.4),
    "angular oscillation": angular_oscillation(POINT, AXIS, 0.3, 0.0213, -1.0),
    "swinging slide with a turning shaft": combined(oscillation((0.004, 0.0, 0.0), 0.03), rotation(POINT, AXIS, 30.0)),
    "planet": combined(rotation((0.0, 0.0, 0.0), AXIS, 12.0), angular_oscillation(POINT, AXIS, 0.4, 0.017)),
    "screw": combined(rotation(POINT, AXIS, 12.0), oscillation(tuple(0.004 * np.array(AXIS)), 0.017)),
}

DECK = """
units si
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
{begin}
neighbor 0.002 bin
neigh_modify delay 0
fix youngs_modulus all property/global youngsModulus peratomtype 1e7
fix poissons_ratio all property/global poissonsRatio peratomtype 0.3
fix restitution all property/global coefficientRestitution peratomtypepair 1 0.5
fix friction all property/global coefficientFriction peratomtypepair 1 0.0
pair_style gran model hertz tangential history
pair_coeff * *
timestep {time_step}
{particles}
fix {mesh} all mesh/surface file {mesh}.stl type 1 {mesh_words}
fix wall all wall/gran model hertz tangential history mesh n_meshes 1 meshes {mesh}
compute contact all wall/gran/local pos vel id
{moving}
dump contacts all local 100 contacts_{mesh}.dump c_contact[1] c_contact[2] c_contact[3] &
    c_contact[7] c_contact[8] c_contact[9] c_contact[15]
dump_modify contacts format "%.17g %.17g %.17g %.17g %.17g %.17g %.17g"
run {steps}
write_restart {mesh}.restart
"""
NEW_BOX = "region domain block -0.1 0.1 -0.1 0.1 -0.1 0.1 units box\ncreate_box 1 domain"


def box():
    """A box, 30 x 40 x 20 mm, drawn off the origin."""
    mesh = closed_box(0.03, 0.04, 0.02, 0.02)
    return mesh.points + np.array([0.004, -0.006, 0.002]), mesh.triangles


def dented() -> tuple[np.ndarray, np.ndarray]:
    """Points (3, 3) m on three sides of the box, within triangles, in its own frame, and the outward normals there."""
    points, _ = box()
    middle, reach = 0.5 * (points.min(axis=0) + points.max(axis=0)), 0.5 * np.ptp(points, axis=0)
    normals = np.diag([1.0, -1.0, 1.0])
    return middle + normals * reach + 0.3 * reach * (1.0 - np.abs(normals)) * [0.5, 0.9, 0.7], normals


def chained_runs(folder: Path, motion: Motion, steps=STEPS, ranks: int = 1) -> np.ndarray:
    """Contacts (k, 7) at the end of the last run: point, velocity of the wall there, sphere; sorted by sphere."""
    (points, triangles), time, begin = box(), START, NEW_BOX
    rotation_at_end, shift = motion.pose(START + sum(steps) * TIME_STEP)
    contact, normal = dented()
    centres = (contact + (RADIUS - OVERLAP) * normal) @ rotation_at_end.T + shift
    spheres = [f"create_atoms 1 single {x:.17g} {y:.17g} {z:.17g} units box" for x, y, z in centres]
    particles = [*spheres, f"set group all density 2500.0 diameter {2 * RADIUS}"]
    for k, number in enumerate(steps):
        write_stl(folder / f"box_{k}.stl", motion.placed(points, time), triangles)
        words = {"begin": begin, "particles": "\n".join(particles), "steps": number, "time_step": TIME_STEP}
        moving = "\n".join(motion.deck_lines(f"box_{k}", time))
        deck = DECK.format(mesh=f"box_{k}", mesh_words=motion.mesh_words(), moving=moving, **words)
        (folder / "deck.in").write_text(deck)
        run(folder, ranks)
        time, begin, particles = time + number * TIME_STEP, f"read_restart box_{k}.restart", []
    rows = (folder / f"contacts_box_{k}.dump").read_text().rpartition("ITEM: ENTRIES")[2].split("\n")[1:]
    found = np.array([row.split() for row in rows if row.strip()], dtype=float)
    return found[np.argsort(found[:, 6])]


@pytest.mark.parametrize(
    ("name", "ranks"), [*((name, 1) for name in MOTIONS), pytest.param("planet", 2, marks=pytest.mark.verify)]
)
def test_pose_after_a_restart_is_the_closed_form(tmp_path, name, ranks):
    """After two chained runs, each with a mesh id of its own, the part stands and moves as its closed form says."""
    motion = MOTIONS[name]
    found = chained_runs(tmp_path, motion, ranks=ranks)
    assert found[:, 6].tolist() == [1, 2, 3]
    expected = motion.placed(dented()[0], END)
    assert found[:, :3] == pytest.approx(expected, abs=POSE_TOLERANCE)
    speed = (expected - motion.placed(dented()[0], END - TIME_STEP)) / TIME_STEP
    assert found[:, 3:6] == pytest.approx(speed, abs=VELOCITY_TOLERANCE * np.abs(speed).max() + STANDSTILL)


@pytest.mark.verify
@pytest.mark.parametrize("name", ["rotation", "oscillation", "angular oscillation", "planet"])
def test_nothing_adds_up_in_a_long_run(tmp_path, name):
    """A million steps, 32 turns or 580 swings, leave a part where its closed form says."""
    motion, steps = MOTIONS[name], 1_000_000
    found = chained_runs(tmp_path, motion, steps=(steps,))
    expected = motion.placed(dented()[0], START + steps * TIME_STEP)
    assert found[:, :3] == pytest.approx(expected, abs=POSE_TOLERANCE)


def test_belt_keeps_its_speed_in_every_facet(tmp_path):
    """A belt stays where it was drawn. The solver turns its velocity into the facet and keeps the magnitude.

    So a belt has one speed on the flat and round its drums.
    """
    velocity = np.array([0.3, -0.2, 0.1])
    found = chained_runs(tmp_path, belt(tuple(velocity)))
    points, normals = dented()
    assert found[:, :3] == pytest.approx(points, abs=POSE_TOLERANCE)
    within = velocity - (normals @ velocity)[:, None] * normals
    expected = within * (np.linalg.norm(velocity) / np.linalg.norm(within, axis=1))[:, None]
    assert found[:, 3:6] == pytest.approx(expected, abs=PRINTED)


def test_end_of_a_turning_roll(tmp_path):
    """A surface that turns within itself about the normal of a side stays; each point there has the speed omega x r."""
    found = chained_runs(tmp_path, turning_surface(POINT, (0.0, 0.0, 2.0), -7.0))
    points, _ = dented()
    assert found[:, :3] == pytest.approx(points, abs=POSE_TOLERANCE)
    expected = np.cross([0.0, 0.0, -7.0], points[2] - POINT)
    assert found[2, 3:6] == pytest.approx(expected, abs=PRINTED)
