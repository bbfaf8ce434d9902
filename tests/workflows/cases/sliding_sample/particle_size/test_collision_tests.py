"""Coarse graining keeps a contact in units of its size (Yan 2022, Eq 4.1 to 4.7): single collisions with LIGGGHTS."""

import math

import numpy as np
import pandas as pd
import pytest

from postproc.plots.style import remarks_of
from workflows.cases.sliding_sample.particle_size.collision import (
    COLLISIONS,
    Spheres,
    collision_measures,
    dimensionless,
    read_collisions,
    spread_over_scales,
)
from workflows.cases.sliding_sample.particle_size.collision_tests import simulate, spheres_of
from workflows.cases.sliding_sample.particle_size.plots.collision import collisions
from workflows.config.design import load_study
from workflows.engine.bulk_tests import time_step

SCALES = [1.0, 8.0]  # the source's smallest and largest
MODELS = ["cdt", "epsd2"]  # rolling types A and C
SAME = 1e-3  # -, between scales; measured: 6e-10, the digits of a dump
EXACT_STEP = 0.002  # -, of the Rayleigh time
CLOSED = 1e-3  # -, of the closed form at that step; measured: 2.3e-4 of overlap and force, 6e-4 of the duration
STUDY_STEP = 0.2  # -, of the Rayleigh time, as beds use it
COARSE = 0.03  # -, of the closed form at that step; measured: 2.7 % of the overlap of pairs


def asked(scale, model="cdt", fraction=EXACT_STEP):
    """A collision at 1 m/s of the study's gravel, coarse-grained, with steel."""
    parameters = load_study("calibration", overrides={"fidelity": "paper"}).runs[0].parameters
    real = parameters["particle"]
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
    """Collisions of both rolling types at both scales."""
    folder = tmp_path_factory.mktemp("collisions")
    cases = [asked(scale, model) for model in MODELS for scale in SCALES]
    return pd.concat([measured(test, folder / str(k)) for k, test in enumerate(cases)], ignore_index=True)


def gravel():
    """Spheres of the study and its closed forms; no solver."""
    return spheres_of(asked(1.0))


@pytest.mark.solver
def test_scales_collide_alike(histories):
    """Restitution, overlap, forces, torque, spin and duration are those of scale 1, for both rolling types."""
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
def test_a_step_that_does_not_scale_is_seen(tmp_path):
    """The measurement can tell: at the time step of beds the overlap is off by more than scales may differ."""
    coarse = collision_measures(measured(asked(1.0, fraction=STUDY_STEP), tmp_path)).set_index("collision")
    closed = gravel().closed_form("pair", 1.0).overlap.max() / gravel().radius
    assert SAME < abs(coarse.loc["pair", "largest_overlap"] / closed - 1.0) < COARSE


@pytest.mark.verify
@pytest.mark.solver
@pytest.mark.parametrize("scale", [2.0, 3.0, 4.0, 5.0, 6.0, 7.0])
def test_every_scale_of_the_source_collides_alike(histories, tmp_path, scale):
    """The scales between, both rolling types."""
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


def drawn_histories():
    """Half sines in the place of simulations."""
    time = np.linspace(0.0, 12.0, 60)
    tables = []
    for model in MODELS:
        for scale in (1.0, 3.0, 8.0):
            for kind in COLLISIONS:
                shape = np.sin(np.pi * time / 12.0)
                table = pd.DataFrame({"time": time, "overlap": 0.015 * shape, "normal_force": 0.0018 * shape})
                table = table.assign(tangential_force=0.4 * table["normal_force"], spin=0.01 - 0.5 * table["overlap"])
                tables.append(table.assign(collision=kind, particle_scale=scale, rolling_friction=model))
    return pd.concat(tables, ignore_index=True)


def test_the_figure_shows_every_scale_and_the_closed_form():
    """Six panels; each head-on panel has a line of the closed form and marks of three scales; remarks are printed."""
    spheres = gravel()
    closed = {kind: dimensionless(each, spheres.units(kind)) for kind, each in spheres.closed_forms(1.0).items()}
    figure = collisions(drawn_histories(), closed, ["a remark"])
    panels = figure.axes
    assert len(panels) == 6 and [len(axes.lines) for axes in panels] == [4, 4, 6, 4, 4, 6]
    assert max(panels[0].lines[0].get_ydata()) == pytest.approx(closed["pair"]["overlap"].max())
    assert panels[0].lines[1].get_linestyle() == "None"  # marks: joined, they would be a line of their own
    assert "a remark" in remarks_of(figure)
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"scale 1", "scale 3", "scale 8"} <= set(names)


def test_a_spread_of_scales_is_measured():
    """Two scales that differ by 2 % in one measure: that is the spread; measures of zero are left out."""
    table = pd.DataFrame(
        {"collision": "pair", "rolling_friction": "cdt", "particle_scale": [1.0, 2.0], "largest_overlap": [0.98, 1.0]}
    ).assign(largest_torque=0.0)
    spread = spread_over_scales(table)
    assert list(spread["measure"]) == ["largest_overlap"] and math.isclose(spread["spread"].iloc[0], 0.02)
