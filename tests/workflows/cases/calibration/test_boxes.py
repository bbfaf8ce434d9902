"""Bulk tests are what they say: decks and meshes of the boxes asked for."""

import numpy as np
import pytest

from bulkwear.workflows.cases.calibration.boxes import (
    discharge_time,
    draw_down,
    draw_down_surfaces,
    opening_length,
    shear_box,
    shear_box_surfaces,
    simulated_width,
    wall_shear,
    wall_shear_surfaces,
    with_values,
)
from bulkwear.workflows.cases.calibration.boxes import (
    test_of as made_test,
)
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.bulk_tests import deck_text, time_step
from bulkwear.workflows.engine.grains import smallest_radius
from bulkwear.workflows.engine.project import enter_project, leave_project
from tests.support.bulk_boxes import NOT_ROLLING, PAIR, ROLLING, SLIDING, asked

EXACT = 1e-12  # relative: the same formula
NO_ROLLING = {
    "solver": {"rolling_friction": "none"},
    "calibration": {"parameters": NOT_ROLLING},
}


@pytest.mark.parametrize("kind", ["shear_box", "draw_down", "wall_shear"])
@pytest.mark.parametrize("front_and_back", ["periodic", "walls"])
def test_decks_render_with_what_they_say(kind, front_and_back):
    """The friction asked for stands in the deck, and so do its walls."""
    text = deck_text(asked(kind, draw_down={"front_and_back": front_and_back}))
    table = text[text.index("coefficientRollingFriction") :].splitlines()[1]
    assert float(table.split()[0]) == pytest.approx(PAIR[ROLLING], rel=EXACT)
    assert ("front_wall" in text) == (kind == "draw_down" and front_and_back == "walls")
    loops = 1 if kind == "wall_shear" else 2  # until rest, each with a beginning and an end; a drag needs none
    assert text.count("label ") == 2 * loops


def test_clumps_that_flow_out_lie_in_a_pit():
    """The solver takes no bodies out: walls hold them within the domain, all of them below the box's floor."""
    test = asked(bulk={"shape": "pair", "material": "river_gravel_published"}, **NO_ROLLING)
    text, given = deck_text(test), shear_box(test)
    assert "delete_atoms" not in text and "erotate/multisphere" in text and "2*ke/atoms" in text
    assert given["domain_bottom_m"] < given["pit_bottom_m"] < -test["box"]["fill_height_m"]
    assert given["domain_back_m"] < given["pit_back_m"] < 0.0
    assert test["box"]["length_m"] < given["pit_front_m"] < given["domain_front_m"]
    spheres = asked(bulk={"material": "river_gravel_published"}, **NO_ROLLING)
    assert "delete_atoms" in deck_text(spheres) and "pit" not in deck_text(spheres)
    assert time_step(test) == pytest.approx(
        2.0 * smallest_radius(test["particle"]) / (2.0 * smallest_radius(spheres["particle"])) * time_step(spheres),
        rel=EXACT,
    )


def test_a_plate_is_drawn_as_far_and_as_fast_as_asked():
    """Steps of the drag are its way over its speed, in whole means of the forces; its friction is the wall's."""
    test = with_values(asked("wall_shear"), {"wall_material.contact.sliding_friction": 0.77})
    given, box = wall_shear(test), test["box"]
    way = given["drag_steps"] * given["time_step_s"] * given["drag_speed_m_per_s"]
    assert way == pytest.approx(box["drag_m"], rel=1.0 / given["force_interval_steps"])  # a step of each mean
    assert given["drag_steps"] % given["force_interval_steps"] == 0
    text = deck_text(test)
    table = text[text.index("coefficientFriction") :].splitlines()[1:4]
    assert [float(line.split()[0]) for line in table] == pytest.approx([0.3, 0.77, 0.36], rel=EXACT)


@pytest.mark.parametrize(
    ("model", "convention", "factor"),
    [("own_spin", "full", 1.0), ("own_spin", "reduced", 0.5), ("cdt", "full", 2.0), ("cdt", "reduced", 1.0)],
)
def test_a_coefficient_is_converted_to_the_radius_of_its_model(model, convention, factor):
    """own_spin acts on the full radius, cdt on the reduced one, half of it between equal spheres."""
    text = deck_text(asked(solver={"rolling_friction": model, "rolling_radius": convention}))
    table = text[text.index("coefficientRollingFriction") :].splitlines()[1]
    assert float(table.split()[0]) == pytest.approx(factor * PAIR[ROLLING], rel=EXACT)


@pytest.mark.parametrize(
    ("kind", "domain", "surfaces"),
    [
        ("shear_box", shear_box, shear_box_surfaces),
        ("draw_down", draw_down, draw_down_surfaces),
        ("wall_shear", wall_shear, wall_shear_surfaces),
    ],
)
def test_meshes_lie_in_the_domain(kind, domain, surfaces):
    """LIGGGHTS drops what lies outside the domain: every mesh lies inside, and floors end where the walls stand."""
    test = asked(kind)
    box = domain(test)
    for points, _ in surfaces(test).values():
        assert (points[:, 1] > box["domain_back_m"]).all() and (points[:, 1] < box["domain_front_m"]).all()
        assert (points[:, 2] > box["domain_bottom_m"]).all() and (points[:, 2] < box["domain_top_m"]).all()
    floors = [points for name, (points, _) in surfaces(test).items() if name != "outflow"]
    assert min(points[:, 1].min() for points in floors) == 0.0
    assert max(points[:, 1].max() for points in floors) == pytest.approx(test["box"]["length_m"], rel=EXACT)


@pytest.mark.parametrize("front_and_back", ["periodic", "walls"])
@pytest.mark.parametrize("opening", ["slot", "square"])
def test_gate_and_floor_close_the_upper_box(opening, front_and_back):
    """Without gap or overlap: areas add up to that of the domain, and no place of a raster lies under both or none."""
    wide = {"width_mm": 100, "opening": opening, "opening_mm": 62, "front_and_back": front_and_back}
    test = asked("draw_down", draw_down=wide)
    found, half = draw_down_surfaces(test), draw_down(test)["half_domain_m"]
    floor, gate = (found[name][0][found[name][1]] for name in ("upper_floor", "gate"))
    faces = np.concatenate([floor, gate])
    area = 0.5 * np.abs(np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])[:, 2]).sum()
    assert area == pytest.approx(2.0 * half * 0.5, rel=EXACT)
    low, high = gate.reshape(-1, 3).min(axis=0), gate.reshape(-1, 3).max(axis=0)
    side = opening_length(test)
    assert (high - low)[:2] == pytest.approx([side if opening == "square" else 2.0 * half, side], rel=EXACT)
    middles = floor.mean(axis=1)
    assert not ((middles > low) & (middles < high))[:, :2].all(axis=1).any()


def test_a_square_flows_as_beverloo_says():
    """0.58 of a circle by area: a square of 62 mm lets 3/4 of 14 litres of gravel of 2.65 mm out in some six s."""
    square = asked("draw_down", draw_down={"width_mm": 100, "opening": "square", "opening_mm": 62}, particle_scale=1)
    expected = 0.75 * 0.5 * 0.1 * 0.28 / (0.74 * 9.81**0.5 * (0.062 - 1.4 * 0.00265) ** 2.5)
    assert discharge_time(square) == pytest.approx(expected, rel=1e-3)


def test_the_mass_told_is_poured():
    """19.68 kg in 100 mm of width, whatever the slice; without it the bulk density's of the height."""
    told, left_out = asked("draw_down"), asked("draw_down")
    assert draw_down(told)["poured_mass_kg"] == pytest.approx(196.8 * told["box"]["width_m"], rel=EXACT)
    del left_out["box"]["fill_mass_kg_per_m"]
    expected = 0.59 * 2460.0 * 0.5 * 0.28 * told["box"]["width_m"]
    assert draw_down(left_out)["poured_mass_kg"] == pytest.approx(expected, rel=EXACT)


def test_a_box_of_ones_own_is_filled_to_its_height(tmp_path):
    """A study of one's own that tells no mass: the source's, 197 kg/m, would fill this box to 0.62 of its height."""
    (tmp_path / "config/studies").mkdir(parents=True)
    text = "title: own\nquestion: Which?\ncase: calibration\ndesign: shear_box_sizes.csv\nparticle_scale: 3\n"
    box = "draw_down: {length_mm: 400, fill_height_mm: 546, lower_height_mm: 700}\nshear_box: {width_mm: 43}\n"
    (tmp_path / "config/studies/own.yaml").write_text(text + box)
    enter_project(tmp_path)
    try:
        test = made_test(load_study("own").runs[0].parameters, "draw_down", {}, 20011)
    finally:
        leave_project()
    expected = 0.59 * 2460.0 * 0.4 * 0.546 * test["box"]["width_m"]
    assert draw_down(test)["poured_mass_kg"] == pytest.approx(expected, rel=EXACT)


def test_slot_keeps_what_particles_see_of_it():
    """Coarse graining widens the slot by 1.4 times what it adds to the diameter; at true size it is the real one."""
    real, scaled = asked("draw_down", particle_scale=1.0), asked("draw_down", particle_scale=4.0)
    assert opening_length(real) == pytest.approx(real["box"]["opening_m"], rel=EXACT)
    free = [opening_length(test) - 1.4 * test["particle"]["median_diameter_m"] for test in (real, scaled)]
    assert free[0] == pytest.approx(free[1], rel=EXACT)


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
