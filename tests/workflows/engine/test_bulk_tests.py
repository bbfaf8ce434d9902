"""Bulk tests are what they say: decks of the boxes asked for, run until rest, kept by what they were made from."""

import json
import math

import numpy as np
import pytest

from postproc.flow.bulk_test import HEAP, Measurement
from postproc.flow.outflow import BlockedError
from postproc.inference.loop import packing_seed
from postproc.wear.caps import GRAVITY
from workflows.cases.calibration.driver import test_of as bulk_test_of
from workflows.cases.calibration.driver import with_values
from workflows.config.design import load_study
from workflows.engine import bulk_simulations, state
from workflows.engine.bulk_simulations import (
    BLOCKED,
    NEXT_PACKING,
    PACKINGS,
    answer,
    flowing,
    inputs_digest,
    measured,
    simulate_all,
    simulated,
    simulation_folder,
)
from workflows.engine.bulk_tests import (
    deck_text,
    draw_down,
    rest_energy,
    shear_box,
    simulated_width,
    slot_length,
    surfaces,
)
from workflows.engine.solver import SolverError

EXACT = 1e-12  # relative: the same formula
SLIDING, ROLLING = "particle.contact.sliding_friction", "particle.contact.rolling_friction"
PAIR = {SLIDING: 0.3, ROLLING: 0.3}
SEED = 20_000


def asked(kind="shear_box", **settings):
    """A bulk test of the study as configured, at particle scale 5 or with other settings."""
    study = load_study("calibration", overrides={"fidelity": "quick", **settings})
    return bulk_test_of(study.runs[0].parameters, kind, PAIR, SEED)


def small():
    """A shear box of a few hundred particles that needs seconds: the particles fill a tenth of its length."""
    test = asked(particle_scale=5.0)
    box = {"length_m": 0.135, "width_m": 0.054, "fill_height_m": 0.135}
    return {**test, "box": {**test["box"], **box}}


@pytest.mark.parametrize("kind", ["shear_box", "draw_down"])
@pytest.mark.parametrize("front_and_back", ["periodic", "walls"])
def test_decks_render_with_what_they_say(kind, front_and_back):
    """The friction asked for stands in the deck, doubled for the solver's radius where it rolls; so do its walls."""
    text = deck_text(asked(kind, draw_down={"front_and_back": front_and_back}))
    table = text[text.index("coefficientRollingFriction") :].splitlines()[1]
    assert float(table.split()[0]) == pytest.approx(2.0 * PAIR[ROLLING], rel=EXACT)
    assert ("front_wall" in text) == (kind == "draw_down" and front_and_back == "walls")
    assert text.count("label ") == 4  # two loops until rest, each with a beginning and an end


def test_reduced_convention_is_not_converted():
    """A coefficient for the reduced radius is the solver's own."""
    text = deck_text(asked(solver={"rolling_radius": "reduced"}))
    table = text[text.index("coefficientRollingFriction") :].splitlines()[1]
    assert float(table.split()[0]) == pytest.approx(PAIR[ROLLING], rel=EXACT)


@pytest.mark.parametrize(("kind", "domain"), [("shear_box", shear_box), ("draw_down", draw_down)])
def test_meshes_lie_in_the_domain(kind, domain):
    """LIGGGHTS drops what lies outside the domain: every mesh lies inside, and floors end where the walls stand."""
    test = asked(kind)
    box = domain(test)
    for points, _ in surfaces(test).values():
        assert (points[:, 1] > box["domain_back_m"]).all() and (points[:, 1] < box["domain_front_m"]).all()
        assert (points[:, 2] > box["domain_bottom_m"]).all() and (points[:, 2] < box["domain_top_m"]).all()
    floors = [points for name, (points, _) in surfaces(test).items() if name != "outflow"]
    assert min(points[:, 1].min() for points in floors) == 0.0
    assert max(points[:, 1].max() for points in floors) == pytest.approx(test["box"]["length_m"], rel=EXACT)


def test_gate_fills_the_slot():
    """Floor, gate and floor close the upper box without gap or overlap."""
    found = surfaces(asked("draw_down"))
    ends = [found[name][0][:, 1] for name in ("back_floor", "gate", "front_floor")]
    assert ends[0].max() == ends[1].min() and ends[1].max() == ends[2].min()


def test_slot_keeps_what_particles_see_of_it():
    """Coarse graining widens the slot by 1.4 times what it adds to the diameter; at true size it is the real one."""
    real, scaled = asked("draw_down", particle_scale=1.0), asked("draw_down", particle_scale=4.0)
    assert slot_length(real) == pytest.approx(real["box"]["opening_m"], rel=EXACT)
    free = [slot_length(test) - 1.4 * test["particle"]["median_diameter_m"] for test in (real, scaled)]
    assert free[0] == pytest.approx(free[1], rel=EXACT)


def test_rest_is_a_fraction_of_a_fall_by_a_diameter():
    """The energy of rest is the stated fraction of m g d, so it grows with the fourth power of the particle scale."""
    one, two = asked(particle_scale=1.0), asked(particle_scale=2.0)
    diameter = one["particle"]["median_diameter_m"]
    mass = one["particle"]["density_kg_per_m3"] * math.pi / 6.0 * diameter**3
    assert rest_energy(one) == pytest.approx(one["rest"]["energy_fraction"] * mass * GRAVITY * diameter, rel=EXACT)
    assert rest_energy(two) == pytest.approx(16.0 * rest_energy(one), rel=EXACT)


def test_periodic_slices_hold_four_particles():
    """A periodic slice is widened to four diameters, a wider one and one between walls stay."""
    particle = {"median_diameter_m": 0.01}
    assert simulated_width({"width_m": 0.02}, particle) == pytest.approx(0.04)
    assert simulated_width({"width_m": 0.05}, particle) == 0.05
    assert simulated_width({"width_m": 0.02, "front_and_back": "walls"}, particle) == 0.02


def test_values_replace_only_what_they_name():
    """A calibrated value reaches the place its dotted name says; the original stays as it was."""
    test = asked()
    changed = with_values(test, {SLIDING: 0.77})
    assert changed["particle"]["contact"]["sliding_friction"] == 0.77
    assert test["particle"]["contact"]["sliding_friction"] == PAIR[SLIDING]
    assert {**changed, "particle": 0} == {**test, "particle": 0}


def test_the_question_decides_where_a_simulation_is_kept(tmp_path):
    """Another value, another seed or another box is another folder; asking again is the same one."""
    test = asked()
    others = [with_values(test, {ROLLING: 0.31}), {**test, "seed": SEED + 1}, small()]
    folders = {simulation_folder(each, tmp_path) for each in (test, *others)}
    assert len(folders) == 4
    assert simulation_folder(asked(), tmp_path) == simulation_folder(test, tmp_path)


# ---------------------------------------------------------------- with LIGGGHTS


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


@pytest.mark.solver
def test_a_box_without_rest_is_refused(tmp_path):
    """A box that does not come to rest in the time allowed gives no angle but a sentence, and nothing is kept."""
    test = small()
    test = {**test, "rest": {**test["rest"], "longest_s": 0.1}}
    with pytest.raises(SolverError, match=r"the filled box did not come to rest in 0.1 s \(rest.longest_s\)"):
        simulated(test, tmp_path)
    assert not state.cycle_folder(simulation_folder(test, tmp_path), 0).exists()


@pytest.fixture
def arches(monkeypatch, tmp_path):
    """A solver in whose first packings an arch blocks the slot: {seed: blocked}, filled by the test."""
    blocked = {}

    def measure(test, folder):
        if blocked.get(test["seed"], False):
            raise BlockedError(f"{folder}: an arch blocks the slot")
        return Measurement({"discharge_time_s": float(test["seed"])}, {}, {})

    monkeypatch.setattr(bulk_simulations, "simulated", lambda test, root: root / str(test["seed"]))
    monkeypatch.setattr(bulk_simulations, "measured", measure)
    return blocked


def test_a_blocked_packing_is_done_again_with_another(arches, tmp_path):
    """As in a laboratory: the answer is that of the next packing that flows, and how many were blocked is told."""
    test, said = asked("draw_down"), []
    arches[test["seed"]] = True
    found, folder = flowing(test, tmp_path, said.append)
    used = found.responses["discharge_time_s"]
    assert used != test["seed"] and folder.name == f"{used:.0f}"
    assert answer(found)[BLOCKED] == 1 and "an arch blocks the slot" in said[0]
    assert answer(simulate_all([test], tmp_path, 1, said.append)[0]) == answer(found)
    arches.clear()
    assert answer(flowing(test, tmp_path, said.append)[0]) == {"discharge_time_s": test["seed"], BLOCKED: 0}


def test_a_test_whose_packings_are_all_blocked_is_refused(arches, tmp_path):
    """A slot that arches again and again is too narrow for these particles."""
    test = asked("draw_down")
    arches.update({packing_seed(test["seed"], number * NEXT_PACKING): True for number in range(PACKINGS)})
    with pytest.raises(SolverError, match=f"{PACKINGS} packings of one test are blocked"):
        flowing(test, tmp_path, print)
