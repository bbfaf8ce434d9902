"""Bulk tests of any kind: what rest is, and that they are kept by what they were made from."""

import math

import numpy as np
import pytest

from bulkwear.postproc.flow.bed import NEEDED
from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.cases.calibration.boxes import with_values
from bulkwear.workflows.engine import bulk_simulations, state
from bulkwear.workflows.engine.bulk_simulations import FILLED, check_filling, simulated, simulation_folder
from bulkwear.workflows.engine.bulk_tests import filled_mass, rest_energy
from bulkwear.workflows.engine.solver import SolverCrashedError, SolverError, SolverStoppedError
from tests.support.bulk_boxes import ROLLING, SEED, asked, small

EXACT = 1e-12  # relative: the same formula


def test_rest_is_a_fraction_of_a_fall_by_a_diameter():
    """The energy of rest is the stated fraction of m g d, so it grows with the fourth power of the particle scale."""
    one, two = asked(particle_scale=1.0), asked(particle_scale=2.0)
    diameter = one["particle"]["median_diameter_m"]
    mass = one["particle"]["density_kg_per_m3"] * math.pi / 6.0 * diameter**3
    assert rest_energy(one) == pytest.approx(one["rest"]["energy_fraction"] * mass * GRAVITY * diameter, rel=EXACT)
    assert rest_energy(two) == pytest.approx(16.0 * rest_energy(one), rel=EXACT)


def test_the_question_decides_where_a_simulation_is_kept(tmp_path):
    """Another value, another seed or another box is another folder; asking again is the same one."""
    test = asked()
    others = [with_values(test, {ROLLING: 0.31}), {**test, "seed": SEED + 1}, small()]
    folders = {simulation_folder(each, tmp_path) for each in (test, *others)}
    assert len(folders) == 4
    assert simulation_folder(asked(), tmp_path) == simulation_folder(test, tmp_path)


@pytest.mark.solver
def test_a_box_without_rest_is_refused(tmp_path):
    """A box that does not come to rest in the time allowed gives no angle but a sentence, and nothing is kept."""
    test = small()
    test = {**test, "rest": {**test["rest"], "longest_s": 0.1}}
    with pytest.raises(SolverError, match=r"the filled box did not come to rest in 0.1 s \(rest.longest_s\)"):
        simulated(test, tmp_path)
    assert not state.cycle_folder(simulation_folder(test, tmp_path), 0).exists()


@pytest.mark.parametrize(
    ("signal", "words", "error"),
    [
        ("KILL", "memory was exhausted", SolverStoppedError),
        ("TERM", r"ended by SIGTERM \(signal 15\)", SolverStoppedError),
        ("SEGV", r"crashed \(SIGSEGV, signal 11\)", SolverCrashedError),
    ],
)
def test_a_killed_solver_is_not_called_restless(tmp_path, monkeypatch, signal, words, error):
    """Who runs out of memory, or crashes, is not sent to look for rest."""
    program = tmp_path / "killed"
    program.write_text(f"#!/bin/sh\nkill -{signal} $$\n")
    program.chmod(0o755)
    monkeypatch.setattr(bulk_simulations, "executable_of", lambda test: str(program))
    with pytest.raises(error, match=words):
        simulated(small(), tmp_path)


def write_filling(test, folder, share, level):
    """Write the dump of a box that holds a share of the mass asked for, in equal spheres, at a level (m)."""
    radius = 0.5 * test["particle"]["median_diameter_m"]
    each = test["particle"]["density_kg_per_m3"] * 4.0 / 3.0 * math.pi * radius**3
    count = round(share * filled_mass(test) / each)
    rows = np.zeros((count, len(NEEDED)))
    for name, values in {"id": np.arange(count), "z": np.linspace(0.0, level, count), "radius": radius}.items():
        rows[:, NEEDED.index(name)] = values
    head = f"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{count}\nITEM: BOX BOUNDS pp ff ff\n" + "0 1\n" * 3
    lines = [" ".join(f"{value:.9g}" for value in row) for row in rows]
    (folder / FILLED).write_text(f"{head}ITEM: ATOMS {' '.join(NEEDED)}\n" + "\n".join(lines) + "\n")


@pytest.mark.parametrize("kind", ["shear_box", "draw_down", "wall_shear"])
def test_a_box_without_its_mass_is_refused_and_a_loose_one_is_not(kind, tmp_path):
    """With mass and level in the sentence; a level that is too high is what friction makes of the filling."""
    test = asked(kind)
    height = test["box"]["fill_height_m"]
    write_filling(test, tmp_path, share=1.0, level=1.5 * height)
    check_filling(tmp_path, test)
    write_filling(test, tmp_path, share=0.9, level=0.9 * height)
    with pytest.raises(SolverError, match=r"not as asked: mass \S+ kg \(asked .*\), level \S+ m \(asked .*\)\.$"):
        check_filling(tmp_path, test)
