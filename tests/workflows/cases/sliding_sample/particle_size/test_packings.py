"""Packings: a container that is filled and shaken, pieces of a bed, and contacts counted in its restart file."""

import fcntl
import math

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.flow.bed import read_snapshot
from bulkwear.postproc.flow.bulk_test import HEAP
from bulkwear.postproc.flow.packing import inner_means, loose_and_dense, packing_profile
from bulkwear.workflows.cases.sliding_sample.decks import bed_contacts
from bulkwear.workflows.cases.sliding_sample.particle_size import packings
from bulkwear.workflows.cases.sliding_sample.particle_size.kept import other_containers
from bulkwear.workflows.cases.sliding_sample.particle_size.packings import (
    AT_REST_BEHIND,
    LEAVING_DIAMETERS,
    container,
    packed_container,
    packing_costs,
    packing_table,
    packing_work,
    pieces,
)
from bulkwear.workflows.cases.sliding_sample.particle_size.study import by_scale, packed_runs
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.engine.bulk_simulations import FILLED, simulated, simulation_folder
from bulkwear.workflows.engine.bulk_tests import deck_text, time_step
from bulkwear.workflows.engine.derived import PERIODIC
from bulkwear.workflows.engine.solver import DECK, LEDGER_EXECUTABLE, SolverError, run_deck
from bulkwear.workflows.engine.state import LOCK
from bulkwear.workflows.engine.templates import render, used_sections
from tests.support.tiny import tiny_chain, tiny_study
from tests.support.touching import contacts_of

SCALE = 8.0
DIGITS = 0.02  # -, of the contacts: positions printed with six digits lose or invent a few. Measured: 2e-3
EXACT = 1e-12  # relative: the same formula
ROUNDING = 1e-9  # relative
CONTAINER = 0.25  # relative, of the forecast of the narrowest container: fewer fit between its sides. Measured: 0.19
ROWS = {
    "quick": [4, 6, 8, 9, 10, 12],
    "standard": [2, 3, 4, 6, 8, 9, 10, 12],
    "paper": [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12],
}


def study(fidelity="quick", **overrides):
    """The study of particle size."""
    return load_study("particle_size", overrides={"fidelity": fidelity, "packings": 1, **overrides})


def gravel_container(axis="y", seconds=0.1):
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
        "box": {
            "length_m": 4.0 * diameter,
            "width_m": 4.0 * diameter,
            "fill_height_m": 13.5 * diameter,
            "ends": PERIODIC,
        },
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
    test = gravel_container(axis, 4.0)
    text = deck_text(test)
    assert f"gravity v_inertia vector {direction}" in text and "boundary        p p fm" in text
    filled = packed_container(test)
    assert filled["shaking_amplitude_m"] == pytest.approx(0.1 * SCALE * 2.65e-3, rel=EXACT)
    assert filled["shaking_steps"] == math.ceil(4.0 / time_step(test))
    assert "massflow" not in text and "lost error" in text


@pytest.fixture(scope="module")
def packed(tmp_path_factory):
    """Particles of a small container loose and shaken."""
    folder = simulated(gravel_container(), tmp_path_factory.mktemp("packings"))
    return [read_snapshot(folder / name) for name in (FILLED, HEAP)]


@pytest.mark.solver
def test_a_container_is_packed_as_gravel_is(packed):
    """Frictional spheres: 4 to 6 contacts, a third to a half of pores; shaking takes pores away, and no particle."""
    loose, dense = packed
    assert sorted(loose["id"]) == sorted(dense["id"])
    test = gravel_container()
    table = loose_and_dense(loose, dense, test["particle"]["median_diameter_m"], test["box"]["length_m"] ** 2)
    states = {state: inner_means(each) for state, each in table.groupby("state")}
    assert 4.0 < states["loose"]["coordination_number"] < 6.0
    assert 0.33 < states["loose"]["porosity"] < 0.5
    assert states["difference"]["porosity"] < 0.0


@pytest.mark.solver
def test_the_solver_counts_what_geometry_counts(packed):
    """Contacts from positions and radii, periodic across, are the solver's."""
    loose, side = packed[0], gravel_container()["box"]["length_m"]
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
    text = render("bed_contacts", bed_contacts(chain.parameters, str(chain.bed_restart)))
    (folder / DECK).write_text(text)
    run_deck(folder, executable=LEDGER_EXECUTABLE)
    bed, width = read_snapshot(folder / "bed.dump"), chain.bed["width_m"]
    places, radius = bed[["x_m", "y_m", "z_m"]].to_numpy(), bed["radius_m"].to_numpy()
    assert bed["contacts"].sum() == pytest.approx(contacts_of(places, radius, (width, 0.0, 0.0)).sum(), rel=DIGITS)
    edges = chain.bed["temporary_floor_m"] + np.array([0.0, 0.5, 1.0]) * chain.bed["thickness_m"]
    profile = packing_profile(bed, edges, width * chain.bed["length_m"])
    assert profile["porosity"].between(0.3, 0.7).all() and (profile["coordination_number"] > 2.0).all()


def test_containers_are_of_the_studys_particles():
    """Amplitude and width follow the scale."""
    found = study()
    packing = to_si(found.settings)["packing"]
    for scale, run in by_scale(packed_runs(found)).items():
        test = container(run, packing)
        assert test["shaking"]["amplitude_m"] == pytest.approx(0.1 * scale * 2.65e-3, rel=ROUNDING)
        assert "packed container" in deck_text(test).lower()


@pytest.mark.parametrize("fidelity", ROWS)
def test_containers_of_every_scale(fidelity):
    """Standard packs all scales of the design, no higher than thirty diameters; paper no higher than 120."""
    found = study(fidelity)
    packing, packed = to_si(found.settings)["packing"], by_scale(packed_runs(found))
    assert list(packed) == (ROWS["quick"] if fidelity == "quick" else ROWS["paper"])
    heights = {scale: container(run, packing)["box"]["fill_height_m"] for scale, run in packed.items()}
    most = {
        scale: packing["most_fill_diameters"] * run["particle"]["median_diameter_m"] for scale, run in packed.items()
    }
    assert heights == {
        scale: pytest.approx(min(packing["fill_height_m"], most[scale]), rel=ROUNDING) for scale in packed
    }
    assert (heights[min(packed)] < packing["fill_height_m"]) is (fidelity != "quick")


def test_pieces_of_bed_lie_where_they_are_said_to():
    """Before: the settled bed without its ends. After: at rest behind the sample, ahead of it when it started, and
    short of where a window lets it out."""
    run = study().run("S4_plain").parameters
    found = pieces(run)
    start, end, width = found["before"]
    assert start > run["derived"]["bed_start_m"] and width == run["bed"]["width_m"]
    assert end < run["derived"]["bed_start_m"] + run["derived"]["bed_length_m"]
    start, end, width = found["after"]
    assert start == pytest.approx(0.1 + AT_REST_BEHIND) and width == run["sample"]["width_m"]
    assert end == pytest.approx(0.1 + 0.4 - LEAVING_DIAMETERS * 4 * 2.65e-3)
    start, end, width = pieces(study("paper").run("S4_plain").parameters)["after"]
    assert end == pytest.approx(0.7 + 1.0 - 0.1)  # where the bed at the front has come to, less what was behind it


@pytest.mark.parametrize("fidelity", ROWS)
def test_a_piece_of_bed_at_rest_is_left_behind_every_sample(fidelity):
    """At every scale it is at least three median diameters long, so that a packing can be told from it."""
    for run in study(fidelity).runs:
        start, end, _ = pieces(run.parameters)["after"]
        assert end - start > 3.0 * run.parameters["particle"]["median_diameter_m"]


def test_one_job_at_a_time_simulates_containers(monkeypatch, tmp_path):
    """Their folder is locked as that of a run: another job waits, and does not write into the same containers."""

    def locked(test, folder, alone):
        with open(folder / LOCK) as lock, pytest.raises(BlockingIOError):
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        raise SolverError("it was locked")

    monkeypatch.setattr(packings, "simulated", locked)
    found = study()
    with pytest.raises(SolverError, match="it was locked"):
        packing_table(packed_runs(found), to_si(found.settings)["packing"], tmp_path)


@pytest.mark.solver
def test_packings_of_the_study(tmp_path):
    """The largest scale in a narrow container, shaken for a moment: three layers of four diameters in each state."""
    found = study(rows=["S8"], packing={"width_diameters": 4, "fill_height_mm": 300, "shaking_s": 0.05})
    asked = {"S8_plain": found.run("S8_plain").parameters}, to_si(found.settings)["packing"], tmp_path
    table = packing_table(*asked)
    cost = packing_costs(*asked)
    assert cost["particle_scale"].tolist() == [8.0]
    assert (cost[["solver_s", "processor_s", "steps", "particles"]] > 0).all(axis=None)
    assert cost["processor_s"].iloc[0] <= cost["solver_s"].iloc[0]
    expected = packing_work(*asked[:2]).stages
    assert sum(stage.steps for stage in expected) == pytest.approx(cost["steps"].iloc[0], rel=CONTAINER)
    assert expected[0].particles == pytest.approx(cost["particles"].iloc[0], rel=CONTAINER)
    assert isinstance(table, pd.DataFrame) and set(table["particle_scale"]) == {8.0}
    assert table.groupby("state")["layer"].max().to_dict() == {"dense": 3, "difference": 3, "loose": 3}
    assert table.loc[table["state"] == "loose", "height_mm"].iloc[0] == pytest.approx(0.5 * 4 * 8 * 2.65, rel=ROUNDING)


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({}, None),
        ({"packing": {"shaking_s": 0.5}}, "its containers are others"),
        ({"rows": ["S8"], "packing": {"every_scale": False}}, "its particle scales are others"),
    ],
)
def test_what_finished_containers_answer(tmp_path, asked, said):
    """Their tests and scales, of a table and the folders beside it."""

    def containers(**overrides):
        found = study(**overrides)
        return packed_runs(found), to_si(found.settings)["packing"]

    runs, packing = containers()
    for run in by_scale(runs).values():
        simulation_folder(container(run, packing), tmp_path).mkdir()
    pd.DataFrame({"particle_scale": list(by_scale(runs)) * 2}).to_csv(tmp_path / "profiles.csv", index=False)
    assert other_containers(*containers(**asked), tmp_path / "profiles.csv") == said
