"""Rolling models of our own on the real solver: torques by closed form, no energy made, and a sphere that stands."""

import sys

import numpy as np
import pytest

from bulkwear.postproc.mesh import write_stl
from bulkwear.workflows.engine.solver import (
    DECK,
    LEDGER_EXECUTABLE,
    OWN_ROLLING_MODELS,
    SolverError,
    executable_of,
    missing_rolling_model,
    run_deck,
)
from tests.support.shapes import plate, shifted

pytestmark = pytest.mark.solver

RADII, DENSITY, COEFFICIENT, OVERLAP = (0.005, 0.008), 2500.0, 0.3, 1e-4  # m, kg/m3, -, m
MOMENT_OF_INERTIA = 0.4 * 4.0 / 3.0 * np.pi * RADII[0] ** 5 * DENSITY  # kg m2, of the smaller spheres
PAIRS, APART = 20, 0.05  # -, m
SHORT, LONG = 1e-10, 5e-6  # s: within one short step nothing moves; a long one stops spins within hundreds
TORQUE = 1e-5  # relative: the solver's normal at a wall is not quite of length 1
STOPPED, GROWTH = 1e-9, 1e-12  # rad/s, and relative: rounding
FAST, STRETCHED = (
    1e6,
    10,
)  # rad/s, which hardly changes within as many steps, that stretch a rolling spring to its limit
AT_45_DEGREES = {  # torque over mu_r F_n and the radius, and whether that is full between particles
    "cdt": (np.sqrt(0.5), False),
    "epsd2": (1.0, False),
    "own_spin": (1.0, True),
    "rvd": (1.0, False),
}
MIXED, MIXED_STEPS = 1.0, 4  # rad/s in a block, so that within so many steps some contacts stop turning and others not
SWEPT = 0.01  # relative: sweeps end where torques change by 0.001; seen 0.006
CHAIN, SLIDING, BELT = 12, 0.9, 2.0  # spheres, - and m/s of the belt below the first
PRESSED = 5  # times deeper into one another than into the belt
BLOCK, MOST_CONTACTS = 3, 6  # -, spheres along each side of a cube, and contacts of the one in the middle
MANY_SWEEPS = 20_000  # until nothing changes
GRAVITY = 9.81  # m/s2
ACCELERATION = 0.01  # relative: the lever of the contact is shorter than the radius by half of the overlap
RESTARTED = 1e-9  # relative: rounding, which rolling does not amplify
# Relative to the largest spin, under rvd with many contacts: the half step after a restart shares friction out between
# contacts from spins that are half a step later. Seen 2e-5.
SHARED_ANEW = 1e-4
AT_REST = 1e-9  # rad/s in a bed at rest
MOST_ENERGY = 1e-3  # relative to that of the drop: what the solver's steps add to an elastic contact
STANDS = 1e-9  # m in 0.1 s, after the deflection of the tangential spring has come to rest
HEAD = """\
units si
atom_style sphere
atom_modify map array sort 0 0
boundary f f f
newton off
communicate single vel yes
processors 1 {ranks} 1
region room block -0.5 0.5 -0.5 1.1 -0.1 0.1 units box
create_box 2 room
fix youngs_modulus all property/global youngsModulus peratomtype 1e7 1e7
fix poissons_ratio all property/global poissonsRatio peratomtype 0.3 0.3
fix restitution all property/global coefficientRestitution peratomtypepair 2 0.5 0.5 0.5 0.5
fix friction all property/global coefficientFriction peratomtypepair 2 {friction} {friction} {friction} {friction}
fix rolling all property/global coefficientRollingFriction peratomtypepair 2 0.3 0.3 0.3 0.3
pair_style gran model hertz tangential history rolling_friction {model}
pair_coeff * *
neighbor 0.002 bin
neigh_modify delay 0
timestep {step}
"""
WALL = "fix wall all wall/gran model hertz tangential history rolling_friction {model} "
WALLS = {
    "mesh": "fix plate all mesh/surface file plate.stl type 2\n" + WALL + "mesh n_meshes 1 meshes plate\n",
    "plane": WALL + "primitive type 2 zplane 0.0\n",
}
DUMP = "dump spins all custom {every} spins_*.dump id x fx fy fz tqx tqy tqz omegax omegay omegaz\n" + (
    'dump_modify spins sort id format "%d' + 10 * " %.15g" + '"\n'
)


def placed(centres, radii, spins):
    """Lines of a deck that place spheres: centres (n, 3) m, radii (n,) m, spins (n, 3) rad/s."""
    lines = []
    for number, (at, radius, spin) in enumerate(zip(centres, radii, spins, strict=True), start=1):
        lines.append("create_atoms 1 single {:.15g} {:.15g} {:.15g} units box".format(*at))
        lines.append(f"set atom {number} diameter {2.0 * radius} density {DENSITY}")
        lines.append("set atom {} omegax {:.15g} omegay {:.15g} omegaz {:.15g}".format(number, *spin))
    return "\n".join(lines) + "\n"


FLOOR = shifted(plate(0.8, 0.8, 2), (-0.4, -0.4, 0.0))


def simulated(folder, text, ranks=1, square=FLOOR):
    """What was dumped: force, torque and spin, (times, n, 3) each, and x (times, n), of a deck that is run; square: its
    plate.
    """
    folder.mkdir(exist_ok=True)
    write_stl(folder / "plate.stl", square.points, square.triangles)
    (folder / DECK).write_text(text)
    run_deck(folder, ranks, executable=LEDGER_EXECUTABLE)
    dumps = sorted(folder.glob("spins_*.dump"), key=lambda path: int(path.stem.split("_")[1]))
    rows = np.array([np.loadtxt(path, skiprows=9, ndmin=2) for path in dumps])
    return {"x": rows[..., 1], "force": rows[..., 2:5], "torque": rows[..., 5:8], "spin": rows[..., 8:11]}


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def tangential(vectors, normal):
    return vectors - np.einsum("ij,ij->i", vectors, normal)[:, None] * normal


def pairs():
    """Centres, radii and spins of pairs that touch in any direction, and the normals (n, 3) from each first sphere."""
    random = np.random.default_rng(8)
    normal, spins = unit(random.normal(size=(PAIRS, 3))), random.normal(0.0, 20.0, (2 * PAIRS, 3))
    first = np.column_stack([np.zeros(PAIRS), APART * np.arange(PAIRS), np.zeros(PAIRS)])
    centres = np.stack([first, first + (sum(RADII) - OVERLAP) * normal], axis=1).reshape(-1, 3)
    return centres, np.tile(RADII, PAIRS), spins, normal


def pair_deck(model, step, every, steps, ranks=1, hold=""):
    centres, radii, spins, _ = pairs()
    head = HEAD.format(model=model, step=step, friction=0.0, ranks=ranks)
    motion = f"fix motion all nve/sphere\n{hold}{DUMP.format(every=every)}run {steps}\n"
    return head + placed(centres, radii, spins) + motion


def torques_meant(model, force, spin, normal):
    """Torques (n, 2, 3) of pairs by the models' definitions; force (n,) N, spin (n, 2, 3) rad/s."""
    if model == "own_spin":
        return -COEFFICIENT * force[:, None, None] * np.array(RADII)[:, None] * unit(spin)
    reduced = RADII[0] * RADII[1] / sum(RADII)
    if model == "cdt":
        against = tangential(unit(spin[:, 0] - spin[:, 1]), normal)
        return -COEFFICIENT * reduced * force[:, None, None] * np.stack([against, -against], axis=1)
    against = unit(tangential(spin.sum(axis=1), normal))
    return np.repeat(-COEFFICIENT * reduced * force[:, None, None] * against[:, None], 2, axis=1)


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("model", [*OWN_ROLLING_MODELS, "cdt"])
def test_torques_between_particles(model, ranks, tmp_path):
    """Unequal spheres with any spins at any angle to the normal, also where the two belong to two ranks; under the
    library's cdt what is resisted falls with the cosine of the spin's angle to the plane of contact.
    """
    found = simulated(tmp_path, pair_deck(model, SHORT, 1, 1, ranks), ranks)
    *_, spins, normal = pairs()
    force = np.linalg.norm(found["force"][1].reshape(PAIRS, 2, 3)[:, 0], axis=1)
    meant = torques_meant(model, force, spins.reshape(PAIRS, 2, 3), normal)
    np.testing.assert_allclose(found["torque"][1].reshape(PAIRS, 2, 3), meant, atol=TORQUE * np.abs(meant).max())


@pytest.mark.parametrize("wall", WALLS)
@pytest.mark.parametrize("model", OWN_ROLLING_MODELS)
def test_torques_at_walls(model, wall, tmp_path):
    """Against the whole spin, or the tangential part of it, with the radius."""
    random = np.random.default_rng(9)
    radii, spins = np.resize(RADII, 6), random.normal(0.0, 20.0, (6, 3))
    centres = np.column_stack([np.linspace(-0.3, 0.3, 6), np.full(6, 0.11), radii - OVERLAP])
    head = HEAD.format(model=model, step=SHORT, friction=0.0, ranks=1)
    motion = f"fix motion all nve/sphere\n{DUMP.format(every=1)}run 1\n"
    found = simulated(tmp_path, head + placed(centres, radii, spins) + WALLS[wall].format(model=model) + motion)
    against = spins if model == "own_spin" else spins * [1.0, 1.0, 0.0]
    force = np.linalg.norm(found["force"][1], axis=1)
    meant = -COEFFICIENT * (force * radii)[:, None] * unit(against)
    np.testing.assert_allclose(found["torque"][1], meant, atol=TORQUE * np.abs(meant).max())


@pytest.mark.parametrize("wall", [None, *WALLS])
@pytest.mark.parametrize("model", AT_45_DEGREES)
def test_a_spin_at_45_degrees_to_the_normal(model, wall, tmp_path):
    """The last column of the table in docs/rolling_friction.md, of a pair and at walls; the spring of epsd2 reaches its
    limit within a few steps.
    """
    share, is_full = AT_45_DEGREES[model]
    spins = FAST * np.sqrt(0.5) * np.array([[0.0, 1.0, 1.0], [0.0, 0.0, 0.0]])
    first = RADII[0] - OVERLAP
    centres, count = [[0.0, 0.1, first], [0.0, 0.1, first + sum(RADII) - OVERLAP]], 1 if wall else 2
    reduced = RADII[0] if wall else RADII[0] * RADII[1] / sum(RADII)
    force = 4.0 / 3.0 * 0.5 * 1e7 / (1.0 - 0.3**2) * np.sqrt(reduced) * OVERLAP**1.5  # N, Hertz
    head = HEAD.format(model=model, step=LONG, friction=0.0, ranks=1)
    head += placed(centres[:count], RADII[:count], spins[:count])
    held = "fix motion all nve/sphere\nfix hold all setforce 0.0 0.0 0.0\n"
    walls = WALLS[wall].format(model=model) if wall else ""
    found = simulated(tmp_path, head + walls + held + f"{DUMP.format(every=STRETCHED)}run {STRETCHED}\n")
    meant = share * COEFFICIENT * force * (RADII[0] if is_full else reduced)
    assert np.linalg.norm(found["torque"][-1, 0]) == pytest.approx(meant, rel=TORQUE)


@pytest.mark.parametrize("model", OWN_ROLLING_MODELS)
def test_no_energy_is_made(model, tmp_path):
    """Pairs that are held where they are: rotational energy falls from dump to dump, until nothing is resisted."""
    hold = "fix hold all setforce 0.0 0.0 0.0\n"
    spin = simulated(tmp_path, pair_deck(model, LONG, 20, 6000, hold=hold))["spin"]
    inertia = np.tile(np.array(RADII) ** 5, PAIRS)  # in proportion
    energy = (inertia * (spin**2).sum(axis=2)).reshape(len(spin), PAIRS, 2).sum(axis=2)
    assert (np.diff(energy, axis=0) <= GROWTH * energy[0]).all()
    last = spin[-1].reshape(PAIRS, 2, 3)
    resisted = last.reshape(-1, 3) if model == "own_spin" else tangential(last.sum(axis=1), pairs()[3])
    np.testing.assert_allclose(resisted, 0.0, atol=STOPPED)
    assert np.abs(spin[0]).max() > 1.0


def block_deck(model, spins, ranks=1, steps=2000, every=1):
    """Spheres in a cube of three times three times three that touch and are held where they are, on a floor."""
    radius, apart = RADII[0], 2.0 * RADII[0] - OVERLAP
    cells = np.stack(np.meshgrid(*[apart * np.arange(BLOCK)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    centres = cells + np.array([-apart, 0.3 - apart, radius - OVERLAP])
    head = HEAD.format(model=model, step=LONG, friction=0.0, ranks=ranks)
    hold = "fix motion all nve/sphere\nfix hold all setforce 0.0 0.0 0.0\n"
    dump = DUMP.format(every=every)
    return (
        head
        + placed(centres, np.full(len(centres), radius), spins)
        + WALLS["plane"].format(model=model)
        + hold
        + (f"{dump}run {steps}\n")
    )


def block_spins(size):
    """Random spins (27, 3) of the spheres of a cube; size: rad/s."""
    return np.random.default_rng(12).normal(0.0, size, (BLOCK**3, 3))


@pytest.mark.parametrize("spin", [1e-9, 20.0])
@pytest.mark.parametrize("model", OWN_ROLLING_MODELS)
def test_many_contacts_make_no_energy(model, spin, tmp_path):
    """Up to six contacts on a sphere stop it together: rotational energy falls from step to step, also where each of
    them alone could stop the spin within one.
    """
    found = simulated(tmp_path, block_deck(model, block_spins(spin)))["spin"]
    energy = (found**2).sum(axis=(1, 2))
    assert (np.diff(energy) <= GROWTH * energy[0]).all() and energy[-1] < energy[0]


def block_contacts():
    """Contacts of the spheres of `block_deck`: (first, second, axis of the normal), and largest torques (m,) N m.

    second: BLOCK cubed for the floor
    """
    cells = np.stack(np.meshgrid(*[np.arange(BLOCK)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    number = {tuple(cell): index for index, cell in enumerate(cells)}
    steps = np.eye(3, dtype=int)
    pairs = [
        (number[tuple(cell)], number[tuple(cell + step)], axis)
        for cell in cells
        for axis, step in enumerate(steps)
        if tuple(cell + step) in number
    ]
    floor = [(number[tuple(cell)], len(cells), 2) for cell in cells if cell[2] == 0]
    modulus = 4.0 / 3.0 * 0.5 * 1e7 / (1.0 - 0.3**2)
    radii = np.repeat([0.5 * RADII[0], RADII[0]], [len(pairs), len(floor)])
    return np.array([*pairs, *floor]), COEFFICIENT * modulus * np.sqrt(radii) * OVERLAP**1.5 * radii


def least_energy(spins, step):
    """Spins (27, 3) after a step in which dry friction on all contacts of the block took out the most energy it can.

    They are checked: each contact has stopped, or its torque is the largest and against its turning. spins: before
    """
    (first, second, axis), largest = block_contacts()[0].T, block_contacts()[1]
    per_torque = step / MOMENT_OF_INERTIA
    tangential_parts = 1.0 - np.eye(3)[axis]
    torques = np.zeros((len(first), 3))

    def after():
        sums = np.zeros((BLOCK**3 + 1, 3))
        np.add.at(sums, first, torques)
        np.add.at(sums, second, torques)
        sums[-1] = 0.0
        return np.vstack([spins, np.zeros(3)]) + per_torque * sums

    for _ in range(MANY_SWEEPS):
        found = after()
        turning = (found[first] + found[second]) * tangential_parts
        wanted = torques - turning / (2.0 * MOST_CONTACTS * per_torque)
        size = np.linalg.norm(wanted, axis=1)
        torques = wanted * np.minimum(1.0, largest / np.maximum(size, 1e-300))[:, None]
    found = after()
    turning = (found[first] + found[second]) * tangential_parts
    slips = np.linalg.norm(turning, axis=1) > 1e-9 * np.abs(spins).max()
    against = -largest[slips, None] * unit(turning[slips])
    np.testing.assert_allclose(torques[slips], against, atol=1e-6 * largest.max())
    assert slips.any() and not slips.all()
    return found[:-1]


def test_rvd_takes_out_the_most_energy(tmp_path):
    """What all contacts of a block do in a step is the one thing that makes the rotational energy after it least."""
    found = simulated(tmp_path, block_deck("rvd", block_spins(MIXED), steps=MIXED_STEPS))
    per_torque = LONG / MOMENT_OF_INERTIA
    for torque, spin in zip(found["torque"][1:], found["spin"][1:], strict=True):
        before = spin - 0.5 * per_torque * torque  # torques are those of the middle of a step
        meant = (least_energy(before, LONG) - before) / per_torque
        assert np.linalg.norm(torque - meant) < SWEPT * np.linalg.norm(meant)


def chain_deck(model, ranks, steps):
    """Spheres in a row along y that are held where they are; a belt below the first turns it about x, a wall ends them.

    Belt and spheres rub, spheres do not; only wall and spheres resist turning, each contact more than the belt turns.
    """
    radius, deep = RADII[0], PRESSED * OVERLAP
    y = 0.1 + (2.0 * radius - deep) * np.arange(CHAIN)
    centres = np.column_stack([np.zeros(CHAIN), y, np.full(CHAIN, radius - OVERLAP)])
    head = HEAD.format(model=model, step=LONG, friction=0.0, ranks=ranks)
    for name, of_spheres, of_belt in (("Friction", 0.0, SLIDING), ("RollingFriction", COEFFICIENT, 0.0)):
        start = head.index(f"coefficient{name} peratomtypepair")
        line = head[start : head.index("\n", start)]
        head = head.replace(line, f"coefficient{name} peratomtypepair 2 {of_spheres} {of_belt} {of_belt} 0.0")
    wall = WALL.format(model=model)
    return (
        head
        + placed(centres, np.full(CHAIN, radius), np.zeros((CHAIN, 3)))
        + f"fix belt all mesh/surface/stress file plate.stl type 2 surface_vel 0.0 {BELT} 0.0\n"
        + f"{wall}mesh n_meshes 1 meshes belt\n"
        + f"{wall.replace('fix wall', 'fix end')}primitive type 1 yplane {y[-1] + radius - deep}\n"
        + "fix motion all nve/sphere\nfix hold all setforce 0.0 0.0 0.0\n"
        + f"{DUMP.format(every=steps)}run {steps}\n"
    )


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_chain_hands_a_torque_on_under_rvd(ranks, tmp_path):
    """A belt that slips turns the first of spheres in a row, which spins without rolling friction. With it each hands
    the torque on, with the other sign, until the wall holds the last, and all stand.
    """
    side = 2.0 * RADII[0]
    square = shifted(plate(side, side, 1), (-0.5 * side, 0.1 - 0.5 * side, 0.0))
    held, free = (
        simulated(tmp_path / model, chain_deck(model, ranks, 4000), ranks, square)["spin"][-1]
        for model in ("rvd", "off")
    )
    np.testing.assert_allclose(held, 0.0, atol=STOPPED)
    assert abs(free[0, 0]) > 1.0


@pytest.mark.parametrize("model", OWN_ROLLING_MODELS)
def test_ranks_do_not_matter(model, tmp_path):
    """Spheres with contacts on both sides of the border between ranks turn as on a single one."""
    one, two = (
        simulated(tmp_path / str(ranks), block_deck(model, block_spins(20.0), ranks, 50, 50), ranks)["spin"][-1]
        for ranks in (1, 2)
    )
    np.testing.assert_allclose(two, one, rtol=0.0, atol=RESTARTED * np.abs(one).max())


def slope_deck(model, slope, step, seconds, wall="mesh"):
    """A sphere at rest on a wall, gravity turned by a slope (-) about y; it lies as deep as its weight presses it."""
    radius, mass = RADII[0], 4.0 / 3.0 * np.pi * RADII[0] ** 3 * DENSITY
    angle, modulus = np.arctan(slope), 0.5 * 1e7 / (1.0 - 0.3**2)
    deep = (0.75 * mass * GRAVITY * np.cos(angle) / (modulus * np.sqrt(radius))) ** (2.0 / 3.0)
    steps = round(seconds / step)
    return (
        HEAD.format(model=model, step=step, friction=0.9, ranks=1)
        + placed([[0.0, 0.11, radius - deep]], [radius], [[0.0, 0.0, 0.0]])
        + WALLS[wall].format(model=model)
        + f"fix weight all gravity {GRAVITY} vector {np.sin(angle)} 0.0 {-np.cos(angle)}\nfix motion all nve/sphere\n"
        + f"{DUMP.format(every=steps // 2)}run {steps}\n"
    )


@pytest.mark.parametrize("step", [2e-6, 1e-5])
def test_a_sphere_stands_on_a_slope(step, tmp_path):
    """Below the coefficient of rolling friction nothing creeps on own_spin, whatever the time step; cdt lets it go."""
    gone = {}
    for model in ("own_spin", "cdt"):
        x = simulated(tmp_path / model, slope_deck(model, 0.8 * COEFFICIENT, step, 0.2))["x"]
        gone[model] = abs(x[-1, 0] - x[1, 0])
    assert gone["own_spin"] < STANDS < gone["cdt"]


@pytest.mark.parametrize("model", OWN_ROLLING_MODELS)
def test_a_sphere_rolls_down_a_steeper_slope(model, tmp_path):
    """With (sin - mu_r cos) g / (1 + 2/5)."""
    slope, seconds = 2.0 * COEFFICIENT, 0.1
    x = simulated(tmp_path, slope_deck(model, slope, 2e-6, seconds))["x"]
    angle = np.arctan(slope)
    meant = (np.sin(angle) - COEFFICIENT * np.cos(angle)) * GRAVITY / 1.4
    assert 2.0 * (x[-1, 0] - x[0, 0]) / seconds**2 == pytest.approx(meant, rel=ACCELERATION)


@pytest.mark.parametrize("model", OWN_ROLLING_MODELS)
def test_torques_of_two_contacts(model, tmp_path):
    """Spheres in a groove of two walls: under own_spin the sum of both forces resists the spin, under rvd each force
    the spin's part in its own wall.
    """
    random = np.random.default_rng(11)
    radii, spins = np.resize(RADII, 6), random.normal(0.0, 20.0, (6, 3))
    centres = np.column_stack([np.linspace(-0.3, 0.3, 6), radii - 0.5 * OVERLAP, radii - OVERLAP])
    floor = WALLS["plane"].format(model=model)
    walls = floor + floor.replace("fix wall", "fix side").replace("zplane", "yplane")
    head = HEAD.format(model=model, step=SHORT, friction=0.0, ranks=1)
    motion = f"fix motion all nve/sphere\n{DUMP.format(every=1)}run 1\n"
    found = simulated(tmp_path, head + placed(centres, radii, spins) + walls + motion)
    lever = COEFFICIENT * np.abs(found["force"][1]) * radii[:, None]  # (n, 3): none along x, of the side, of the floor
    parts = [spins, spins] if model == "own_spin" else [spins * [1.0, 0.0, 1.0], spins * [1.0, 1.0, 0.0]]
    meant = -sum(lever[:, [axis]] * unit(part) for axis, part in zip((1, 2), parts, strict=True))
    np.testing.assert_allclose(found["torque"][1], meant, atol=TORQUE * np.abs(meant).max())
    assert (lever[:, 1:] > 0.0).all()


@pytest.mark.parametrize("model", OWN_ROLLING_MODELS)
def test_a_bed_falls_and_comes_to_rest(model, tmp_path):
    """Many contacts at once: kinetic and potential energy never exceed those of the drop, and under own_spin nothing
    turns in the end; rvd lets a particle spin on about the normal of its contacts.
    """
    random = np.random.default_rng(10)
    cells = np.stack(np.meshgrid(*[0.012 * np.arange(4)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    centres = cells + np.array([0.006, 0.106, 0.012]) + random.uniform(-3e-4, 3e-4, cells.shape)
    box = "".join(
        WALLS["plane"].replace("fix wall", f"fix {side}").replace("zplane 0.0", f"{axis}plane {at}")
        for side, axis, at in (("a", "x", 0.0), ("b", "x", 0.05), ("c", "y", 0.1), ("d", "y", 0.15), ("e", "z", 0.0))
    )
    energy = (
        "variable height equal xcm(all,z)\ncompute kinetic all ke\ncompute turning all erotate/sphere\n"
        f"variable energy equal c_kinetic+c_turning+mass(all)*{GRAVITY}*v_height\nthermo_style custom step v_energy\n"
        'thermo 100\nfix energy all print 100 "${energy}" file energy.txt screen no\n'
    )
    deck = HEAD.format(model=model, step=1e-5, friction=0.5, ranks=1) + placed(
        centres, np.full(len(centres), RADII[0]), random.normal(0.0, 20.0, centres.shape)
    )
    motion = f"fix weight all gravity {GRAVITY} vector 0 0 -1\nfix motion all nve/sphere\n"
    dump = DUMP.format(every=60000)
    found = simulated(tmp_path, deck + box.format(model=model) + motion + energy + f"{dump}run 60000\n")
    told = np.loadtxt(tmp_path / "energy.txt")
    assert told.max() <= told[0] * (1.0 + MOST_ENERGY) and told[-1] < 0.7 * told[0]
    if model == "own_spin":
        assert np.abs(found["spin"][-1]).max() < AT_REST < np.abs(found["spin"][0]).max()


@pytest.mark.parametrize(
    "deck",
    [
        lambda model: slope_deck(model, 2.0 * COEFFICIENT, 1e-5, 0.04),
        lambda model: block_deck(model, block_spins(20.0), steps=100, every=50),
    ],
    ids=["one contact", "many contacts"],
)
@pytest.mark.parametrize("model", OWN_ROLLING_MODELS)
def test_a_restart_goes_on_as_if_nothing_had_been(model, deck, tmp_path):
    """They keep nothing from step to step: spins after a restart are those of a run in one piece, though under rvd many
    contacts share friction out anew.
    """
    whole = deck(model)
    start, run = whole.rsplit("run ", 1)
    first = f"{start}run {int(run) // 2}\nwrite_restart half.restart\n"
    created = [
        line for line in start.splitlines() if line.split()[0] in ("region", "create_box", "create_atoms", "set")
    ]
    again = "\n".join(line for line in start.splitlines() if line not in created)
    again = again.replace("fix youngs", "read_restart half.restart\nfix youngs", 1)
    expected = simulated(tmp_path / "whole", whole)
    simulated(tmp_path / "pieces", first)
    found = simulated(tmp_path / "pieces", f"{again}\nrun {int(run) // 2}\n")
    spins, share = expected["spin"][-1], SHARED_ANEW if model == "rvd" and len(expected["spin"][-1]) > 1 else 0.0
    np.testing.assert_allclose(found["spin"][-1], spins, rtol=RESTARTED, atol=STOPPED + share * np.abs(spins).max())


@pytest.mark.parametrize("model", OWN_ROLLING_MODELS)
def test_multispheres_are_refused(model, tmp_path):
    """Their spin and inertia are those of the body."""
    text = slope_deck(model, 0.1, 1e-5, 1e-3).replace("fix motion all nve/sphere", "fix motion all multisphere")
    with pytest.raises(SolverError, match=f"rolling_friction {model}: found multispheres, allowed are spheres"):
        simulated(tmp_path, text)


def test_which_program_has_them(monkeypatch):
    """Decks with these models, and of runs whose ledger is summed, run on our program alone. So do others where it is
    there, but for those of sampled contacts."""
    assert executable_of({"solver": {"rolling_friction": "own_spin"}}) == LEDGER_EXECUTABLE
    assert executable_of({"solver": {"rolling_friction": "cdt"}}) == LEDGER_EXECUTABLE
    assert executable_of({"solver": {"rolling_friction": "cdt"}, "ledger": "solver"}, wears=True) == LEDGER_EXECUTABLE
    assert executable_of({"solver": {"rolling_friction": "cdt"}, "ledger": "dumps"}, wears=True) == "liggghts"
    assert all(missing_rolling_model(LEDGER_EXECUTABLE, model) is None for model in OWN_ROLLING_MODELS)
    assert missing_rolling_model("liggghts", "cdt") is None
    assert missing_rolling_model(sys.executable, "rvd").startswith(f"{sys.executable}: it has no rolling friction rvd,")
    monkeypatch.setattr("bulkwear.workflows.engine.solver.LEDGER_EXECUTABLE", "/nowhere/liggghts-ledger")
    assert executable_of({"solver": {"rolling_friction": "cdt"}}) == "liggghts"
    assert executable_of({"solver": {"rolling_friction": "own_spin"}}) == "/nowhere/liggghts-ledger"
