"""Rolling models of our own on the real solver: torques by closed form, no energy made, and a sphere that stands."""

import sys

import numpy as np
import pytest

from bulkwear.workflows.engine.solver import (
    LEDGER_EXECUTABLE,
    OWN_ROLLING_MODELS,
    SolverError,
    executable_of,
    missing_rolling_model,
)
from tests.support.rolling_spheres import (
    COEFFICIENT,
    DUMP,
    EFFECTIVE_MODULUS,
    GRAVITY,
    GROWTH,
    HEAD,
    HOLD,
    LONG,
    OVERLAP,
    RADII,
    STOPPED,
    WALLS,
    placed,
    simulated,
    slope_deck,
    tangential,
    unit,
)

pytestmark = pytest.mark.solver

PAIRS, APART, SHORT = 20, 0.05, 1e-10  # -, m, and s: within such a step nothing moves
TORQUE = 1e-5  # relative: the solver's normal at a wall is not quite of length 1
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
ACCELERATION = 0.01  # relative: the lever of the contact is shorter than the radius by half of the overlap
STANDS = 1e-9  # m in 0.1 s, after the deflection of the tangential spring has come to rest


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
    force = 4.0 / 3.0 * EFFECTIVE_MODULUS * np.sqrt(reduced) * OVERLAP**1.5  # N, Hertz
    head = HEAD.format(model=model, step=LONG, friction=0.0, ranks=1)
    head += placed(centres[:count], RADII[:count], spins[:count])
    held = f"fix motion all nve/sphere\n{HOLD}"
    walls = WALLS[wall].format(model=model) if wall else ""
    found = simulated(tmp_path, head + walls + held + f"{DUMP.format(every=STRETCHED)}run {STRETCHED}\n")
    meant = share * COEFFICIENT * force * (RADII[0] if is_full else reduced)
    assert np.linalg.norm(found["torque"][-1, 0]) == pytest.approx(meant, rel=TORQUE)


@pytest.mark.parametrize("model", OWN_ROLLING_MODELS)
def test_no_energy_is_made(model, tmp_path):
    """Pairs that are held where they are: rotational energy falls from dump to dump, until nothing is resisted."""
    spin = simulated(tmp_path, pair_deck(model, LONG, 20, 6000, hold=HOLD))["spin"]
    inertia = np.tile(np.array(RADII) ** 5, PAIRS)  # in proportion
    energy = (inertia * (spin**2).sum(axis=2)).reshape(len(spin), PAIRS, 2).sum(axis=2)
    assert (np.diff(energy, axis=0) <= GROWTH * energy[0]).all()
    last = spin[-1].reshape(PAIRS, 2, 3)
    resisted = last.reshape(-1, 3) if model == "own_spin" else tangential(last.sum(axis=1), pairs()[3])
    np.testing.assert_allclose(resisted, 0.0, atol=STOPPED)
    assert np.abs(spin[0]).max() > 1.0


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
