"""Coarse graining keeps a contact in units of its size (Yan 2022, Eq 4.1 to 4.7): single collisions with LIGGGHTS."""

import math

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.sliding_sample.particle_size.collision import (
    EXACT_STEP,
    MODELS,
    Spheres,
    collision_deck,
    collision_measures,
    collision_tables,
    collision_tests,
    dimensionless,
    read_collisions,
    simulate,
    spheres_of,
    spread_over_scales,
)
from bulkwear.workflows.cases.sliding_sample.particle_size.study import packed_runs
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.bulk_tests import time_step
from tests.support.tiny import OF_ANY_MODEL

SCALES = [1.0, 8.0]  # the source's smallest and largest
SAME = 1e-3  # -, between scales; measured: 6e-10, the digits of a dump
CLOSED = 1e-3  # -, of the closed form at that step; measured: 2.3e-4 of overlap and force, 6e-4 of the duration
STUDY_STEP = 0.2  # -, of the Rayleigh time, as beds use it
ROLLING = (
    0.02  # -, of the closed form of rolling torques, whose lever is taken as shorter by the overlap; measured: 1 %
)
COARSE = 0.03  # -, of the closed form at that step; measured: 2.7 % of the overlap of pairs


def asked(scale, model="cdt", fraction=EXACT_STEP):
    """A collision at 1 m/s of the study's gravel, coarse-grained, with steel."""
    study = load_study("calibration", overrides={"fidelity": "paper"})
    parameters = study.runs[0].parameters
    real = {**parameters["particle"], "contact": study.materials["particles"][OF_ANY_MODEL]["contact"]}
    particle = {
        **real,
        "scale": scale,
        "median_diameter_m": scale * real["median_diameter_m"],
        "diameters_m": [scale * diameter for diameter in real["diameters_m"]],
    }
    return {
        "particle": particle,
        "wall_material": parameters["walls"]["steel"],
        "solver": {**parameters["solver"], "rayleigh_fraction": fraction, "rolling_friction": model},
        "deck": parameters["deck"],
        "collision": {"speed_m_per_s": 1.0, "sideways_speed_m_per_s": 0.5},
    }


def measured(test, folder):
    """Histories of all collisions of a test."""
    names = {"particle_scale": test["particle"]["scale"], "rolling_friction": test["solver"]["rolling_friction"]}
    return read_collisions(simulate(test, folder), spheres_of(test), time_step(test)).assign(**names)


def measures(histories):
    """One row per scale, rolling type and collision."""
    keys = ["particle_scale", "rolling_friction"]
    groups = histories.groupby(keys, sort=False)
    return pd.concat([collision_measures(one).assign(**dict(zip(keys, key, strict=True))) for key, one in groups])


@pytest.fixture(scope="module")
def histories(tmp_path_factory):
    """Collisions of all rolling models at both scales."""
    folder = tmp_path_factory.mktemp("collisions")
    cases = [asked(scale, model) for model in MODELS for scale in SCALES]
    return pd.concat([measured(test, folder / str(k)) for k, test in enumerate(cases)], ignore_index=True)


def gravel():
    """Spheres of the study and its closed forms; no solver."""
    return spheres_of(asked(1.0))


@pytest.mark.solver
def test_scales_collide_alike(histories):
    """Restitution, overlap, forces, torque, spin and duration are those of scale 1, for all rolling models."""
    spread = spread_over_scales(measures(histories))
    assert len(spread) == len(MODELS) * (2 * 4 + 2 * 7)  # head-on ones without tangential force, torque and spin
    assert spread["spread"].max() < SAME


@pytest.mark.solver
def test_whole_histories_are_alike(histories):
    """Not only the peaks: every instant has the overlap, force and torque of scale 1."""
    for _, table in histories.groupby(["rolling_friction", "collision"]):
        first, other = (table[table["particle_scale"] == scale] for scale in SCALES)
        for name in ("time", "overlap", "normal_force", "tangential_force", "torque"):
            assert np.abs(other[name].to_numpy() - first[name].to_numpy()).max() <= SAME * first[name].abs().max()


@pytest.mark.solver
@pytest.mark.parametrize("kind", ["pair", "wall"])
def test_the_solver_is_the_closed_form(histories, kind):
    """Hertz with viscoelastic damping: restitution as asked for, largest overlap and force, duration."""
    table = (
        measures(histories).query("collision == @kind and rolling_friction == 'cdt' and particle_scale == 8.0").iloc[0]
    )
    spheres = spheres_of(asked(8.0))
    closed = dimensionless(spheres.closed_form(kind, 1.0), spheres.units(kind))
    assert table["restitution"] == pytest.approx(0.45 if kind == "pair" else 0.6, rel=CLOSED)
    assert table["largest_overlap"] == pytest.approx(closed["overlap"].max(), rel=CLOSED)
    assert table["largest_force"] == pytest.approx(closed["normal_force"].max(), rel=CLOSED)
    assert table["duration"] == pytest.approx(closed["time"].iloc[-1], rel=CLOSED)


@pytest.mark.solver
def test_the_rolling_types_differ(histories):
    """The oblique collisions do load the rolling friction: the two types leave another torque."""
    torque = (
        measures(histories).query("collision == 'oblique pair'").groupby("rolling_friction")["largest_torque"].first()
    )
    assert abs(torque["cdt"] / torque["epsd2"] - 1.0) > 10.0 * SAME


@pytest.mark.solver
@pytest.mark.parametrize("kind", ["oblique pair", "oblique wall"])
@pytest.mark.parametrize("model", ["cdt", "own_spin", "rvd"])
def test_rolling_torques_are_the_closed_form(histories, model, kind):
    """Early in the contact, before the spin is braked to half: coefficient times elastic force times the model's
    radius, besides the torque of the tangential force. `epsd2` has none: its spring carries the contact's history.
    """
    run, spheres = asked(1.0), gravel()
    alike = "collision == @kind and rolling_friction == @model and particle_scale == 1.0"
    table = histories.query(alike).query("approach > 0 and 3e-3 < overlap < 1e-2")
    table = table[table["spin"] > 0.5 * histories.query(alike)["spin"].iloc[0]]
    ratio = spheres.smaller_radius / spheres.radius
    reduced = 1.0 if kind == "oblique wall" else ratio / (1.0 + ratio)  # of the first sphere's
    elastic = 4.0 / 3.0 * np.sqrt(reduced) * table["overlap"] ** 1.5
    met = run["wall_material"] if kind == "oblique wall" else run["particle"]
    acting = 2.0 * reduced if kind == "oblique pair" and model != "own_spin" else 1.0  # coefficients are of full radii
    lever = 1.0 - table["overlap"] * (1.0 if kind == "oblique wall" else 0.5)
    rolling = table["torque"] - table["tangential_force"] * lever
    assert len(table) > 100
    expected = met["contact"]["rolling_friction"] * acting * elastic
    assert rolling.to_numpy() == pytest.approx(expected.to_numpy(), rel=ROLLING)


@pytest.mark.solver
def test_a_step_that_does_not_scale_is_seen(tmp_path):
    """The measurement can tell: at the time step of beds the overlap is off by more than scales may differ."""
    coarse = collision_measures(measured(asked(1.0, fraction=STUDY_STEP), tmp_path)).set_index("collision")
    closed = gravel().closed_form("pair", 1.0).overlap.max() / gravel().radius
    assert SAME < abs(coarse.loc["pair", "largest_overlap"] / closed - 1.0) < COARSE


@pytest.mark.verify
@pytest.mark.solver
@pytest.mark.parametrize("scale", [2.0, 3.0, 4.0, 5.0, 6.0, 7.0])
def test_every_scale_of_the_source_collides_alike(histories, tmp_path, scale):
    """The scales between, all rolling models."""
    for model in MODELS:
        first = histories[(histories["rolling_friction"] == model) & (histories["particle_scale"] == 1.0)]
        both = pd.concat([first, measured(asked(scale, model), tmp_path / model)])
        assert spread_over_scales(measures(both))["spread"].max() < SAME


def test_units_make_the_closed_form_one():
    """Without the solver: scaled spheres have the same dimensionless collision; another modulus has not."""

    def largest(radius, modulus=1.736e8):
        spheres = Spheres(radius, 0.8 * radius, 2460.0, modulus, 0.24, 2.028e11, 0.3, 0.45, 0.6)
        return dimensionless(spheres.closed_form("wall", 1.0), spheres.units("wall"))["overlap"].max()

    assert largest(0.008) == pytest.approx(largest(0.001), rel=1e-9)
    assert abs(largest(0.001, 2e8) / largest(0.001) - 1.0) > SAME


def test_a_spread_of_scales_is_measured():
    """Two scales that differ by 2 % in one measure: that is the spread; measures of zero are left out."""
    table = pd.DataFrame(
        {"collision": "pair", "rolling_friction": "cdt", "particle_scale": [1.0, 2.0], "largest_overlap": [0.98, 1.0]}
    ).assign(largest_torque=0.0)
    spread = spread_over_scales(table)
    assert list(spread["measure"]) == ["largest_overlap"] and math.isclose(spread["spread"].iloc[0], 0.02)


@pytest.mark.verify
@pytest.mark.solver
def test_collisions_of_the_study_are_alike_and_thinned_out(tmp_path):
    """Measures of two scales agree; histories are short enough for a table; the dumps are gone."""
    tests = collision_tests(packed_runs(load_study("particle_size", overrides={"rows": ["S4", "S8"]})))
    histories, table = collision_tables(tests, tmp_path)
    first, other = (table[table["particle_scale"] == scale].reset_index(drop=True) for scale in (4.0, 8.0))
    for name in ("restitution", "largest_overlap", "largest_force"):
        assert (first[name] / other[name] - 1.0).abs().max() < 1e-3
    assert len(histories) < 20_000 and not list(tmp_path.glob("*/*.dump"))


def test_collisions_are_of_the_studys_particles():
    """Each rolling model collides at each scale, and the deck says which; on any LIGGGHTS its own ones do."""
    scales = [4.0, 6.0, 8.0, 9.0, 10.0, 12.0]
    creeping = {"solver": {"rolling_friction": "cdt"}, "bed": {"material": OF_ANY_MODEL}}
    for overrides, models in ({}, MODELS), (creeping, ("cdt", "epsd2")):
        tests = collision_tests(packed_runs(load_study("particle_size", overrides=overrides)))
        assert [each["particle"]["scale"] for each in tests] == len(models) * scales
        found = [collision_deck(each)["solver"]["rolling_friction"] for each in tests]
        assert found == [model for model in models for _ in scales]
