"""Friction of dumped contacts: put right by the force of the step, and by nothing else."""

import numpy as np
import pytest

from bulkwear.postproc.wear.dumped_forces import step_forces
from tests.postproc.wear.test_ledger import ledger, sample

ROUND_OFF = 1e-12  # sums of a few float64 terms
DUMPED, STEP = [5.0, 0.0, 2.0], [0.8, 0.1, 2.1]  # N; the dump has taken viscous damping for friction


def forces(contacts):
    return step_forces(contacts, np.zeros(len(contacts.triangle), np.int64))


def test_a_single_contact_has_the_friction_of_the_step():
    """The tangential part is that of the step, the normal part stays that of the dump."""
    np.testing.assert_allclose(forces(sample(force=[DUMPED], wall_force=[STEP])), [[0.8, 0.1, 2.0]], rtol=ROUND_OFF)


def test_several_contacts_of_a_particle_share_what_is_missing():
    """On one plane: by the share of their tangential forces, and together they have the friction of the step."""
    three = sample(
        3, particle=[4, 4, 9], force=[[3.0, 0.0, 1.0], [1.0, 0.0, 1.0], DUMPED],
        wall_force=[[1.0, 0.0, 2.0], [1.0, 0.0, 2.0], STEP],
    )  # fmt: skip
    np.testing.assert_allclose(forces(three), [[0.75, 0.0, 1.0], [0.25, 0.0, 1.0], [0.8, 0.1, 2.0]], rtol=ROUND_OFF)


def test_samples_are_apart():
    """The same particle in two samples is two touches."""
    two = sample(2, particle=[4, 4], force=[DUMPED] * 2, wall_force=[STEP, [0.5, 0.0, 2.0]])
    expected = [[0.8, 0.1, 2.0], [0.5, 0.0, 2.0]]
    np.testing.assert_allclose(step_forces(two, np.array([0, 1])), expected, rtol=ROUND_OFF)


def test_forces_on_other_meshes_of_the_wall_are_counted():
    """The force of the step is that of all meshes: what the other one did is not put on this one."""
    both = sample(2, mesh=[0, 1], particle=[4, 4], force=[[3.0, 0.0, 1.0]] * 2, wall_force=[[1.0, 0.0, 2.0]] * 2)
    assert ledger([both])["impulse_x_N_s"][0] == -0.5e-3


def test_without_the_force_of_the_step_the_dump_is_believed():
    """Dumps of older decks, and samples without contacts."""
    contacts = sample(force=[DUMPED])
    assert forces(contacts) is contacts.force
    assert forces(sample(0)).shape == (0, 3)


def test_pressing_and_sliding_work_do_not_depend_on_friction():
    """Columns that need no tangential force are the same with and without it; the contact lies in its facet's plane."""
    moving = {"force": [DUMPED], "particle_velocity": [[-0.3, 0.0, 0.0]]}
    plain, mended = (ledger([sample(**moving, **more)]) for more in ({}, {"wall_force": [STEP]}))
    changed = {name for name in plain if not np.array_equal(plain[name], mended[name], equal_nan=True)}
    assert changed == {"tangential_work_J", "impulse_x_N_s", "impulse_y_N_s", "moment_z_N_m_s"}
    assert mended["tangential_work_J"][0] == pytest.approx(0.8 * 0.3e-3, rel=ROUND_OFF)
