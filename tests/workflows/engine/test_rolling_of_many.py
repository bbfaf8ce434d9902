"""Rolling models of our own where particles have several contacts: the most energy is taken out, and none is made."""

import numpy as np
import pytest

from bulkwear.workflows.engine.solver import OWN_ROLLING_MODELS
from tests.support.rolling_spheres import (
    COEFFICIENT,
    DUMP,
    EFFECTIVE_MODULUS,
    GRAVITY,
    GROWTH,
    HEAD,
    HOLD,
    LONG,
    MOMENT_OF_INERTIA,
    OVERLAP,
    RADII,
    RESTARTED,
    STOPPED,
    WALL,
    WALLS,
    placed,
    simulated,
    slope_deck,
    unit,
)
from tests.support.shapes import plate, shifted

pytestmark = pytest.mark.solver

MIXED, MIXED_STEPS = 1.0, 4  # rad/s in a block, so that within so many steps some contacts stop turning and others not
SWEPT = 0.01  # relative: sweeps end where torques change by 0.001; seen 0.006
CHAIN, SLIDING, BELT = 12, 0.9, 2.0  # spheres, - and m/s of the belt below the first
PRESSED = 5  # times deeper into one another than into the belt
BLOCK, MOST_CONTACTS = 3, 6  # -, spheres along each side of a cube, and contacts of the one in the middle
MANY_SWEEPS = 20_000  # until nothing changes
# Relative to the largest spin, under rvd with many contacts: the half step after a restart shares friction out between
# contacts from spins that are half a step later. Seen 2e-5.
SHARED_ANEW = 1e-4
AT_REST = 1e-9  # rad/s in a bed at rest
RESTING = 1e-9  # of the largest kinetic energy of centres, which falls by a factor of sixty every 0.075 s; seen 2e-11
MOST_ENERGY = 1e-3  # relative to that of the drop: what the solver's steps add to an elastic contact


def block_deck(model, spins, ranks=1, steps=2000, every=1):
    """Spheres in a cube of three times three times three that touch and are held where they are, on a floor."""
    radius, apart = RADII[0], 2.0 * RADII[0] - OVERLAP
    cells = np.stack(np.meshgrid(*[apart * np.arange(BLOCK)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    centres = cells + np.array([-apart, 0.3 - apart, radius - OVERLAP])
    head = HEAD.format(model=model, step=LONG, friction=0.0, ranks=ranks)
    motion = f"fix motion all nve/sphere\n{HOLD}"
    dump = DUMP.format(every=every)
    return (
        head
        + placed(centres, np.full(len(centres), radius), spins)
        + WALLS["plane"].format(model=model)
        + motion
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
    modulus = 4.0 / 3.0 * EFFECTIVE_MODULUS
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
        + f"fix motion all nve/sphere\n{HOLD}"
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


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("model", OWN_ROLLING_MODELS)
def test_a_bed_falls_and_comes_to_rest(model, ranks, tmp_path):
    """Many contacts at once, on both sides of the border between ranks: kinetic and potential energy never exceed those
    of the drop and all centres come to rest. Under own_spin nothing turns in the end; rvd lets a particle spin on about
    the normal of its contacts.
    """
    random = np.random.default_rng(10)
    cells = np.stack(np.meshgrid(*[0.012 * np.arange(4)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    centres = cells + np.array([0.006, 0.281, 0.012]) + random.uniform(-3e-4, 3e-4, cells.shape)
    box = "".join(
        WALLS["plane"].replace("fix wall", f"fix {side}").replace("zplane 0.0", f"{axis}plane {at}")
        for side, axis, at in (("a", "x", 0.0), ("b", "x", 0.05), ("c", "y", 0.275), ("d", "y", 0.325), ("e", "z", 0.0))
    )
    energy = (
        "variable height equal xcm(all,z)\ncompute kinetic all ke\ncompute turning all erotate/sphere\n"
        f"variable moving equal c_kinetic\nvariable energy equal c_kinetic+c_turning+mass(all)*{GRAVITY}*v_height\n"
        "thermo_style custom step v_energy\nthermo 100\n"
        'fix energy all print 100 "${energy} ${moving}" file energy.txt screen no\n'
    )
    deck = HEAD.format(model=model, step=1e-5, friction=0.5, ranks=ranks) + placed(
        centres, np.full(len(centres), RADII[0]), random.normal(0.0, 20.0, centres.shape)
    )
    motion = f"fix weight all gravity {GRAVITY} vector 0 0 -1\nfix motion all nve/sphere\n"
    dump = DUMP.format(every=60000)
    found = simulated(tmp_path, deck + box.format(model=model) + motion + energy + f"{dump}run 60000\n", ranks)
    told, moving = np.loadtxt(tmp_path / "energy.txt").T
    assert told.max() <= told[0] * (1.0 + MOST_ENERGY) and told[-1] < 0.7 * told[0]
    assert moving[-1] < RESTING * moving.max()
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
    """What rvd keeps from step to step it finds again: spins after a restart are those of a run in one piece, though
    under it many contacts share friction out anew.
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
