"""Side, direction, friction and drive in the solver's load ledger: spheres on plates that are turned, moved and driven.

The spheres are carried along a prescribed path, so overlap and force stay what they are: Hertz' force and, once the
contact slides, friction times it. Vectors are those of the mesh's own frame, wherever it has gone.
"""

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.mesh import SurfaceMesh, areas, stl_corners, unit_normals
from bulkwear.postproc.readers.load_ledger import read_load_ledger
from bulkwear.postproc.wear.ledger import pressed_sides, vector_columns
from bulkwear.postproc.wear.part_loads import part_loads
from tests.verification.ledger_cases import (
    DUMP_LINES,
    LOAD,
    MESH_LINE,
    PIN_MOTION,
    RADIUS,
    hertz_force,
    hertz_overlap,
    ledger_of_dumps,
    pin,
    ring,
    run,
    run_case,
    table_of_solver,
    write_case,
)

pytestmark = pytest.mark.solver

EXACT = 1e-6  # relative; what is asked. The nine digits of the STL move the overlap. Measured: 2e-8
ROUNDING = 1e-12  # of the largest; what sums of a few thousand terms leave of a component that is nothing
DUMPED = 2e-7  # of the largest; the STL's nine digits turn the frame of a facet of 0.5 mm by 1e-8. Measured: 6e-8
FRICTION, SPEED, TIME_STEP, STEPS = 0.4, 1.0, 2e-6, 2000  # -, m/s, s, -
SETTLING = 300  # steps until the contact slides: its spring is at the limit of friction after some 10
DURATION = STEPS * TIME_STEP  # s
FORCE = hertz_force(hertz_overlap())  # N
START = np.array([1.31234567e-4, -0.0020007123456, RADIUS - hertz_overlap()])  # m, no node and no edge below it
SLIDING = {"friction": FRICTION, "settling": SETTLING, "steps": STEPS, "time_step": TIME_STEP}
WIDE = "-0.03 0.03 -0.03 0.03 -0.03 0.03"  # m
ALONG, UP = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])


def turn(seed):
    """A rotation about no particular axis."""
    rotation, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return rotation * np.sign(np.linalg.det(rotation))


def words(vector):
    """A vector as a deck spells it."""
    return " ".join(f"{part:.17g}" for part in vector)


def sphere(place):
    """Deck lines of a sphere at a place (m)."""
    return [f"create_atoms 1 single {words(place)} units box", *pin(0.0, 0.0)[1:]]


def carried(velocity, group="all"):
    """Deck line that carries spheres at a velocity (m/s) whatever pushes them."""
    return f"fix carry_{group} {group} move linear {words(velocity)} units box"


def turned(mesh, rotation, flipped=False, shift=(0.0, 0.0, 0.0)):
    """A mesh, turned and shifted, its facets looking the other way if asked for."""
    triangles = mesh.triangles[:, ::-1] if flipped else mesh.triangles
    return SurfaceMesh(mesh.points @ rotation.T + np.asarray(shift), triangles)


def vector(table, name):
    """Sum of a vector over all triangles."""
    return np.array([table[field].sum() for field in vector_columns(name)])


def assert_vector(found, expected):
    """Two vectors agree, against the length of the expected one."""
    assert found == pytest.approx(expected, rel=0, abs=EXACT * np.linalg.norm(expected))


def assert_same_vectors(table, sampled, tolerance=DUMPED):
    """Friction, drive and all vectors agree triangle by triangle, against the largest of all vectors of the name."""
    for name in ("impulse", "back_impulse", "moment"):
        one, other = (np.column_stack([each[field] for field in vector_columns(name)]) for each in (table, sampled))
        np.testing.assert_allclose(one, other, rtol=0, atol=tolerance * np.abs(one).max(), err_msg=name)
    for name in ("tangential_work_J", "drive_work_J"):
        np.testing.assert_allclose(
            table[name], sampled[name], rtol=0, atol=tolerance * np.abs(table[name]).max(), err_msg=name
        )


def test_straight_drag_pulls_along_and_presses_down(tmp_path):
    """A pin under its load: impulse (0, mu F, -F) T, friction's work mu F L, no drive; all on the front."""
    mesh = flat_plate(0.006, 0.012, 0.5e-3)
    dragged = [*pin(START[0], START[1]), f"velocity all set 0.0 {SPEED} 0.0 units box"]
    table = table_of_solver(run_case(tmp_path, mesh, dragged, PIN_MOTION, **SLIDING), mesh)
    assert_vector(vector(table, "impulse"), LOAD * DURATION * np.array([0.0, FRICTION, -1.0]))
    assert table["tangential_work_J"].sum() == pytest.approx(FRICTION * LOAD * SPEED * DURATION, rel=EXACT)
    assert not table["drive_work_J"].any()
    assert not vector(table, "back_impulse").any()


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("flipped", [False, True])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_plate_turned_any_way_has_its_loads_turned(tmp_path, seed, flipped, side):
    """Impulse (mu F along the travel - F into the plate) T from either side; the back is where the normals are not.

    Contacts from dumps, the force of the step with them, give the same triangle by triangle.
    """
    rotation = turn(seed)
    mesh = turned(flat_plate(0.006, 0.012, 0.5e-3), rotation, flipped)
    place, velocity = START * [1.0, 1.0, side] @ rotation.T, SPEED * rotation @ ALONG
    case = {"domain": WIDE, "outputs": DUMP_LINES, **SLIDING}
    table = table_of_solver(run_case(tmp_path, mesh, sphere(place), [carried(velocity)], **case), mesh)
    expected = FORCE * DURATION * rotation @ (FRICTION * ALONG - side * UP)
    assert_vector(vector(table, "impulse"), expected)
    on_back = flipped == (side > 0.0)
    assert_vector(vector(table, "impulse") - vector(table, "back_impulse") * on_back, expected * (not on_back))
    pressed = np.array([each.sum() for each in pressed_sides(table, unit_normals(mesh.points, mesh.triangles))])
    assert pressed[int(on_back)] == pytest.approx(FORCE * DURATION, rel=EXACT)
    assert pressed[int(not on_back)] <= ROUNDING * FORCE * DURATION
    assert table["tangential_work_J"].sum() == pytest.approx(FRICTION * FORCE * SPEED * DURATION, rel=EXACT)
    assert_same_vectors(table, ledger_of_dumps(tmp_path, mesh, TIME_STEP, SETTLING))


def test_both_sides_of_one_facet_at_once(tmp_path):
    """A sphere above and one below the same facet, of different overlap, drawn different ways: two known halves."""
    mesh = flat_plate(0.024, 0.024, 0.024)
    deeper = 1.5 * hertz_overlap()
    above, below = np.array([0.004, -0.004, START[2]]), np.array([0.005, 0.005, deeper - RADIUS])
    ways = {1: SPEED * np.array([1.0, 0.0, 0.0]), 2: 0.5 * SPEED * np.array([0.0, -1.0, 0.0])}
    groups = [f"group sphere_{k} id {k}" for k in ways]
    motion = [*groups, *(carried(velocity, f"sphere_{k}") for k, velocity in ways.items())]
    case = {"domain": WIDE, "outputs": DUMP_LINES, **SLIDING}
    table = table_of_solver(run_case(tmp_path, mesh, [*sphere(above), *sphere(below)], motion, **case), mesh)
    assert np.count_nonzero(table["contact_time_s"]) == 1
    force = hertz_force(deeper)
    back = force * DURATION * np.array([0.0, -FRICTION, 1.0])
    assert_vector(vector(table, "back_impulse"), back)
    assert_vector(vector(table, "impulse"), back + FORCE * DURATION * np.array([FRICTION, 0.0, -1.0]))
    front, behind = pressed_sides(table, unit_normals(mesh.points, mesh.triangles))
    assert (front.sum(), behind.sum()) == pytest.approx((FORCE * DURATION, force * DURATION), rel=EXACT)
    work = FRICTION * (FORCE * SPEED + force * 0.5 * SPEED) * DURATION
    assert table["tangential_work_J"].sum() == pytest.approx(work, rel=EXACT)
    assert_same_vectors(table, ledger_of_dumps(tmp_path, mesh, TIME_STEP, SETTLING))


def test_a_spinning_sphere_rubs_with_its_surface(tmp_path):
    """Spin about x, the centre held: friction does mu F omega l T, the plate is pushed along -y."""
    spin, mesh = 300.0, flat_plate(0.006, 0.012, 0.5e-3)
    ledger = run_case(tmp_path, mesh, [*pin(START[0], START[1]), f"set group all omegax {spin}"], PIN_MOTION, **SLIDING)
    table, lever = table_of_solver(ledger, mesh), RADIUS - hertz_overlap() / 2
    assert table["tangential_work_J"].sum() == pytest.approx(FRICTION * LOAD * spin * lever * DURATION, rel=EXACT)
    assert_vector(vector(table, "impulse"), LOAD * DURATION * np.array([0.0, FRICTION, -1.0]))


@pytest.mark.parametrize("seed", [3, 4])
def test_a_plate_that_moves_under_a_held_sphere(tmp_path, seed):
    """As if the sphere were dragged the other way, but the drive pays for the friction; places are the file's."""
    rotation = turn(seed)
    mesh = turned(flat_plate(0.006, 0.012, 0.5e-3), rotation)
    velocity = -SPEED * rotation @ ALONG
    moving = f"fix fly all move/mesh mesh sample linear {words(velocity)}"
    case = {"domain": WIDE, "outputs": DUMP_LINES, "mesh_lines": [moving], **SLIDING}
    ledger = run_case(tmp_path, mesh, sphere(START @ rotation.T), [carried(np.zeros(3))], **case)
    table = table_of_solver(ledger, mesh)
    work = FRICTION * FORCE * SPEED * DURATION
    assert_vector(vector(table, "impulse"), FORCE * DURATION * rotation @ (FRICTION * ALONG - UP))
    assert table["tangential_work_J"].sum() == pytest.approx(work, rel=EXACT)
    assert table["drive_work_J"].sum() == pytest.approx(work, rel=EXACT)
    sampled = ledger_of_dumps(
        tmp_path, mesh, TIME_STEP, SETTLING, pose=lambda step: (np.eye(3), velocity * TIME_STEP * step)
    )
    assert_same_vectors(table, sampled)
    assert_same_places(table, sampled)


def assert_same_places(table, sampled):
    """Mean contact points agree in the mesh's own frame."""
    for axis in "xyz":
        name = f"contact_position_{axis}_m"
        assert table[name] == pytest.approx(sampled[name], rel=0, abs=1e-9, nan_ok=True)  # m; nine digits of the STL


def about(axis, angle):
    """Rotation about a unit axis by an angle (rad), after Rodrigues."""
    across = np.cross(np.eye(3), axis)
    return np.eye(3) + np.sin(angle) * across + (1.0 - np.cos(angle)) * across @ across


@pytest.mark.parametrize("seed", [5, 6])
def test_torque_of_a_turning_disc_is_its_power(tmp_path, seed):
    """A disc, leaning any way, turns under a held sphere: torque times angular velocity is the drive's power.

    In the disc's own frame friction turns against the disc: the impulse is the sum of the forces, each turned back.
    """
    rotation, shift, period = turn(seed), np.array([0.002, -0.003, 0.004]), 0.03
    mesh = turned(ring(0.0094, 0.0106, 0.5e-3), rotation, shift=shift)
    axis, place = rotation @ UP, np.array([0.01, 3.1234e-5, START[2]])
    omega, distance = 2 * np.pi / period, np.hypot(*place[:2])
    turning = f"fix turn all move/mesh mesh sample rotate origin {words(shift)} axis {words(axis)} period {period}"
    case = {"domain": WIDE, "outputs": DUMP_LINES, "mesh_lines": [turning], **SLIDING}
    ledger = run_case(tmp_path, mesh, sphere(place @ rotation.T + shift), [carried(np.zeros(3))], **case)
    table, corners = table_of_solver(ledger, mesh), stl_corners(mesh.points, mesh.triangles)
    power = FRICTION * FORCE * omega * distance

    loads = part_loads(table, corners, np.zeros(len(corners), int), DURATION, about=shift)
    torque = np.array([loads[f"torque_{k}_N_m"][0] for k in "xyz"])
    assert loads["power_W"][0] == pytest.approx(power, rel=EXACT)
    assert torque @ axis * omega == pytest.approx(-power, rel=EXACT)

    outward = np.array([place[0], place[1], 0.0]) / distance
    force = rotation @ (FORCE * (FRICTION * np.cross(outward, UP) - UP))  # against the disc's motion, in space
    angles = omega * TIME_STEP * np.arange(SETTLING + 1, SETTLING + STEPS + 1)
    assert_vector(vector(table, "impulse"), sum(about(axis, -angle) @ force for angle in angles) * TIME_STEP)

    def pose(step):
        present = about(axis, omega * TIME_STEP * step)
        return present, shift - present @ shift

    sampled = ledger_of_dumps(tmp_path, mesh, TIME_STEP, SETTLING, pose=pose, wall_angular_velocity=omega * axis)
    assert_same_vectors(table, sampled)
    assert_same_places(table, sampled)


def driven_mesh(words_of_drive):
    """Deck line of the mesh with a surface that moves by itself."""
    return MESH_LINE.replace(" wear finnie", f" {words_of_drive}") + "\n"


def test_a_belt_drives_while_its_mesh_rests(tmp_path):
    """surface_vel: drive and friction are mu F v T each under a held sphere, the belt is pulled back."""
    mesh = flat_plate(0.006, 0.012, 0.5e-3)
    write_case(tmp_path, mesh, sphere(START), [carried(np.zeros(3))], outputs=DUMP_LINES, **SLIDING)
    (tmp_path / "mesh.in").write_text(driven_mesh(f"surface_vel 0.0 {SPEED} 0.0"))
    run(tmp_path)
    table = table_of_solver(read_load_ledger(tmp_path / "load_ledger.bin", "sample"), mesh)
    work = FRICTION * FORCE * SPEED * DURATION
    assert table["drive_work_J"].sum() == pytest.approx(work, rel=EXACT)
    assert table["tangential_work_J"].sum() == pytest.approx(work, rel=EXACT)
    assert_vector(vector(table, "impulse"), FORCE * DURATION * np.array([0.0, -FRICTION, -1.0]))
    assert_same_vectors(table, ledger_of_dumps(tmp_path, mesh, TIME_STEP, SETTLING))


def test_a_driven_drum_turns_without_moving(tmp_path):
    """surface_ang_vel about an axis beside the sphere: torque times angular velocity is the drive's power."""
    mesh, omega, origin = flat_plate(0.006, 0.012, 0.5e-3), 40.0, np.array([0.02, 0.001, 0.0])
    write_case(tmp_path, mesh, sphere(START), [carried(np.zeros(3))], **SLIDING)
    driven = f"surface_ang_vel origin {words(origin)} axis 0.0 0.0 1.0 omega {omega}"
    (tmp_path / "mesh.in").write_text(driven_mesh(driven))
    run(tmp_path)
    table = table_of_solver(read_load_ledger(tmp_path / "load_ledger.bin", "sample"), mesh)
    corners = stl_corners(mesh.points, mesh.triangles)
    loads = part_loads(table, corners, np.zeros(len(corners), int), DURATION, about=origin)
    power = FRICTION * FORCE * omega * np.hypot(*(START - origin)[:2])
    assert loads["power_W"][0] == pytest.approx(power, rel=EXACT)
    assert loads["torque_z_N_m"][0] * omega == pytest.approx(-power, rel=EXACT)


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.verify)])
def test_vectors_across_a_periodic_boundary(tmp_path, ranks):
    """Sphere and plate pass the boundary against each other: impulse as anywhere, moments no larger than a facet."""
    mesh = flat_plate(0.01, 0.012, 0.5e-3)
    box = {"boundary": "p p f", "domain": "-0.005 0.005 -0.006 0.006 -0.01 0.02", "processors": f"{ranks} 1 1"}
    velocity = np.array([0.5 * SPEED, 0.0, 0.0])
    moving = f"fix fly all move/mesh mesh sample linear {words(-velocity)}"
    place = np.array([0.004000712, 1.31234567e-4, START[2]])
    case = {"outputs": DUMP_LINES, "mesh_lines": [moving], **SLIDING, **box}
    table = table_of_solver(run_case(tmp_path, mesh, sphere(place), [carried(velocity)], ranks, **case), mesh)
    assert_vector(vector(table, "impulse"), FORCE * DURATION * np.array([FRICTION, 0.0, -1.0]))
    longest = np.sqrt(4.0 * areas(mesh.points, mesh.triangles).max())  # m, diagonal of a quad
    moment, impulse = (
        np.linalg.norm([table[field] for field in vector_columns(name)], axis=0) for name in ("moment", "impulse")
    )
    assert (moment <= longest * impulse).all()
    sampled = ledger_of_dumps(
        tmp_path, mesh, TIME_STEP, SETTLING,
        pose=lambda step: (np.eye(3), -velocity * TIME_STEP * step), periods=(0.01, 0.012, 0.0),
    )  # fmt: skip
    assert_same_vectors(table, sampled)
    assert_same_places(table, sampled)
