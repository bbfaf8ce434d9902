"""Simulations of a calibration: until rest, measured, not done twice, done again where an arch blocks the opening."""

import json
import math

import numpy as np
import pytest

from bulkwear.postproc.flow.bulk_test import HEAP, Measurement
from bulkwear.postproc.flow.outflow import BlockedError
from bulkwear.postproc.inference.loop import packing_seed
from bulkwear.workflows.cases.calibration import simulations
from bulkwear.workflows.cases.calibration.boxes import test_of as bulk_test_of
from bulkwear.workflows.cases.calibration.simulations import (
    BLOCKED,
    NEXT_PACKING,
    PACKINGS,
    answer,
    flowing,
    is_answered,
    measured,
    packings_of,
    simulate_all,
)
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.bulk_simulations import (
    filling_measures,
    inputs_digest,
    kept_filling,
    simulated,
    simulation_folder,
)
from bulkwear.workflows.engine.bulk_tests import rest_energy
from bulkwear.workflows.engine.solver import SolverError
from bulkwear.workflows.report.fillings import filling_columns
from tests.support.bulk_boxes import asked, small
from tests.support.calibration_study import study

LOOSE = 0.2  # of the level of a box six to ten grains high: floor, end walls and friction hold grains apart; seen 0.15
EXACT = 1e-12  # relative: the same formula


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A small shear box that LIGGGHTS filled, opened and ran until rest."""
    root = tmp_path_factory.mktemp("simulations")
    simulated(small(), root)
    return root


@pytest.mark.solver
def test_a_shear_box_stands_at_rest_with_a_slope(done):
    """What is left in the box stands at an angle between 20 and 50 degrees, slower than rest allows."""
    test = small()
    folder = state.cycle_folder(simulation_folder(test, done), 0)
    angle = measured(test, folder).responses["shear_angle_deg"]
    assert 20.0 < angle < 50.0
    rows = np.loadtxt(folder / HEAP, skiprows=9)
    speed = np.sqrt((rows[:, 4:7] ** 2).sum(axis=1))
    heaviest = test["particle"]["density_kg_per_m3"] * math.pi / 6.0 * (2.0 * rows[:, -1].max()) ** 3
    assert 0.5 * heaviest * (speed**2).mean() < 2.0 * rest_energy(test)  # the heaviest stand for all


@pytest.mark.solver
def test_a_shear_box_is_filled_as_asked(done):
    """Its mass within the tolerance, its level as high as so few grains lie; the record has both."""
    test = small()
    kept = simulation_folder(test, done)
    mass, level = measures = filling_measures(state.cycle_folder(kept, 0), test)
    assert not mass.missed and 0.0 < level.found / level.asked - 1.0 < LOOSE
    told, recorded = kept_filling(kept)
    assert told["seed"] == test["seed"] and recorded == measures
    box, asked_density = test["box"], 0.59 * 2460.0
    density = mass.found / (box["length_m"] * box["width_m"] * level.found)
    columns = filling_columns(kept)
    assert columns["bulk_density_found_kg_per_m3"] == pytest.approx(density, rel=EXACT)
    assert columns["bulk_density_over_asked"] == pytest.approx(density / asked_density, rel=EXACT)


@pytest.mark.solver
def test_a_wall_shear_box_is_filled_as_asked(tmp_path):
    """The box at rest, before its plate is drawn."""
    test = asked("wall_shear", particle_scale=5.0)
    size = {"length_m": 0.08, "width_m": 0.054, "fill_height_m": 0.08, "drag_m": 0.002}
    test = {**test, "box": {**test["box"], **size}}
    mass, level = filling_measures(simulated(test, tmp_path), test)
    assert not mass.missed and 0.0 < level.found / level.asked - 1.0 < LOOSE


@pytest.mark.solver
def test_what_was_simulated_is_not_simulated_again(done):
    """Asked again, a simulation is read and not done."""
    test = small()
    folder = state.cycle_folder(simulation_folder(test, done), 0)
    written, said = (folder / HEAP).stat().st_mtime_ns, []
    simulate_all([test], done, 1, said.append)
    assert (folder / HEAP).stat().st_mtime_ns == written and said == []


@pytest.mark.solver
def test_the_state_tells_what_was_simulated(done):
    """Beside a simulation stand its inputs, their digest, the solver and what it cost."""
    test = small()
    told = json.loads((state.cycle_folder(simulation_folder(test, done), 0) / state.STATE).read_text())
    assert told["inputs"] == inputs_digest(test) and told["test"] == json.loads(json.dumps(test))
    assert told["cost"]["particles"] > 100 and told["solver"]


@pytest.fixture
def arches(monkeypatch, tmp_path):
    """A solver in whose first packings an arch blocks the opening: {seed: blocked}, filled by the test."""
    blocked = {}

    def measure(test, folder):
        if blocked.get(test["seed"], False):
            raise BlockedError(f"{folder}: an arch blocks the opening")
        return Measurement({"discharge_time_s": float(test["seed"])}, {}, {})

    monkeypatch.setattr(simulations, "simulated", lambda test, root: root / str(test["seed"]))
    monkeypatch.setattr(simulations, "measured", measure)
    return blocked


def test_a_blocked_packing_is_done_again_with_another(arches, tmp_path):
    """As in a laboratory: the answer is that of the next packing that flows, and how many were blocked is told."""
    test, said = asked("draw_down"), []
    arches[test["seed"]] = True
    found, folder = flowing(test, tmp_path, said.append)
    used = found.responses["discharge_time_s"]
    assert used != test["seed"] and folder.name == f"{used:.0f}"
    assert answer(found)[BLOCKED] == 1 and "an arch blocks the opening" in said[0]
    assert answer(simulate_all([test], tmp_path, 1, said.append)[0]) == answer(found)
    arches.clear()
    assert answer(flowing(test, tmp_path, said.append)[0]) == {"discharge_time_s": test["seed"], BLOCKED: 0}


def test_equal_tests_of_a_batch_are_one_simulation(arches, monkeypatch, tmp_path):
    """Boxes that are widened to the same slice are the same test: it is simulated once, and answers for all of them."""
    runs, asked_for, said = study(shear_box={"width_mm": 53}).runs, [], []
    sizes = [
        bulk_test_of(run.parameters, "shear_box", {}, 20_000) for run in runs if run.name in ("L200", "W53", "W80")
    ]

    def simulate(test, root):
        asked_for.append(test)
        return root

    monkeypatch.setattr(simulations, "simulated", simulate)
    found = simulate_all(sizes, tmp_path, 2, said.append)
    assert len(asked_for) == len(said) == 2 and len(found) == 3
    assert found[0] is found[1] and said[-1].startswith("shear_box 2 of 2 simulated")


def test_a_blocked_packing_alone_is_no_answer(arches, monkeypatch, tmp_path):
    """Nothing is left to simulate only where those that take its place are there, too."""
    test, there = asked("draw_down"), set()
    monkeypatch.setattr(simulations, "simulation_folder", lambda packing, root: root / str(packing["seed"]))
    monkeypatch.setattr(simulations, "inputs_digest", lambda packing: "")
    monkeypatch.setattr(simulations.state, "finished_cycles", lambda folder, inputs: int(folder.name) in there)
    seeds = [packing["seed"] for packing in packings_of(test)]
    assert not is_answered(test, tmp_path)
    there.add(seeds[0])
    assert is_answered(test, tmp_path)
    arches[seeds[0]] = True
    assert not is_answered(test, tmp_path)
    there.add(seeds[1])
    assert is_answered(test, tmp_path)


def test_a_test_whose_packings_are_all_blocked_is_refused(arches, tmp_path):
    """A slot that arches again and again is too narrow for these particles."""
    test = asked("draw_down")
    arches.update({packing_seed(test["seed"], number * NEXT_PACKING): True for number in range(PACKINGS)})
    with pytest.raises(SolverError, match=f"{PACKINGS} packings of one test are blocked"):
        flowing(test, tmp_path, print)
