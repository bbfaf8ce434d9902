"""Packings with LIGGGHTS: a container that is filled and shaken, and contacts counted in a bed's restart file."""

import math

import numpy as np
import pytest

from postproc.flow.bed import read_snapshot
from postproc.flow.bulk_test import HEAP
from postproc.flow.packing import contacts_of, inner_means, loose_and_dense, packing_profile
from tests.support.tiny import tiny_chain, tiny_study
from workflows.config.design import load_study
from workflows.engine import decks as deck
from workflows.engine.bulk_simulations import FILLED, simulated
from workflows.engine.bulk_tests import deck_text, packed_container, time_step
from workflows.engine.solver import DECK, run_deck
from workflows.engine.templates import render, used_sections

SCALE = 8.0
DIGITS = 0.02  # -, of the contacts: positions printed with six digits lose or invent a few. Measured: 2e-3
EXACT = 1e-12  # relative: the same formula


def container(axis="y", seconds=0.1):
    """A container of the study's gravel, 4 diameters wide and 13 high, shaken for a moment."""
    parameters = load_study("calibration", overrides={"fidelity": "paper"}).runs[0].parameters
    real = parameters["particle"]
    diameter = SCALE * real["median_diameter_m"]
    particle = {
        **real,
        "scale": SCALE,
        "median_diameter_m": diameter,
        "diameters_m": [SCALE * each for each in real["diameters_m"]],
    }
    walls = parameters["walls"]["perspex"]
    return {
        "kind": "packed_container",
        "wall_material": walls,
        "floor_material": walls,
        "box": {"length_m": 4.0 * diameter, "width_m": 4.0 * diameter, "fill_height_m": 13.5 * diameter},
        "rest": parameters["rest"],
        "shaking": {
            "amplitude_m": 0.1 * diameter,
            "frequency_rad_per_s": 200.0,
            "duration_s": seconds,
            "axis": axis,
        },
        "particle": particle,
        **used_sections("packed_container", parameters),
        "seed": 20220317,
    }


@pytest.mark.parametrize(("axis", "direction"), [("x", "1. 0. 0."), ("y", "0. 1. 0."), ("z", "0. 0. 1.")])
def test_the_deck_shakes_as_it_was_told(axis, direction):
    """Amplitude, frequency, steps and direction of A sin(w t) stand in the deck; both sides are periodic."""
    test = container(axis, 4.0)
    text = deck_text(test)
    assert f"gravity v_inertia vector {direction}" in text and "boundary        p p fm" in text
    filled = packed_container(test)
    assert filled["shaking_amplitude_m"] == pytest.approx(0.1 * SCALE * 2.65e-3, rel=EXACT)
    assert filled["shaking_steps"] == math.ceil(4.0 / time_step(test))
    assert "massflow" not in text and "lost error" in text


@pytest.fixture(scope="module")
def packed(tmp_path_factory):
    """Particles of a small container loose and shaken."""
    folder = simulated(container(), tmp_path_factory.mktemp("packings"))
    return [read_snapshot(folder / name) for name in (FILLED, HEAP)]


@pytest.mark.solver
def test_a_container_is_packed_as_gravel_is(packed):
    """Frictional spheres: 4 to 6 contacts, a third to a half of pores; shaking takes pores away, and no particle."""
    loose, dense = packed
    assert sorted(loose["id"]) == sorted(dense["id"])
    test = container()
    table = loose_and_dense(loose, dense, test["particle"]["median_diameter_m"], test["box"]["length_m"] ** 2)
    states = {state: inner_means(each) for state, each in table.groupby("state")}
    assert 4.0 < states["loose"]["coordination_number"] < 6.0
    assert 0.33 < states["loose"]["porosity"] < 0.5
    assert states["difference"]["porosity"] < 0.0


@pytest.mark.solver
def test_the_solver_counts_what_geometry_counts(packed):
    """Contacts from positions and radii, periodic across, are the solver's."""
    loose, side = packed[0], container()["box"]["length_m"]
    places, radius = loose[["x_m", "y_m", "z_m"]].to_numpy(), loose["radius_m"].to_numpy()
    ours = contacts_of(places, radius, (side, side, 0.0))
    assert ours.sum() == pytest.approx(loose["contacts"].sum(), rel=DIGITS)


@pytest.mark.solver
def test_contacts_of_a_bed_come_from_its_restart_file(tmp_path):
    """A settled bed has contacts: those of its positions; the tiny bed's layers have a porosity."""
    study = tiny_study()
    chain = tiny_chain(study, tmp_path)
    folder = tmp_path / "contacts"
    folder.mkdir()
    text = render("bed_contacts", deck.bed_contacts(chain.parameters, str(chain.bed_restart)))
    (folder / DECK).write_text(text)
    run_deck(folder)
    bed, width = read_snapshot(folder / "bed.dump"), chain.bed["width_m"]
    places, radius = bed[["x_m", "y_m", "z_m"]].to_numpy(), bed["radius_m"].to_numpy()
    assert bed["contacts"].sum() == pytest.approx(contacts_of(places, radius, (width, 0.0, 0.0)).sum(), rel=DIGITS)
    edges = chain.bed["temporary_floor_m"] + np.array([0.0, 0.5, 1.0]) * chain.bed["thickness_m"]
    profile = packing_profile(bed, edges, width * chain.bed["length_m"])
    assert profile["porosity"].between(0.3, 0.7).all() and (profile["coordination_number"] > 2.0).all()
