"""Every figure says what of the study is reduced; the hop off the ramp among it."""

from __future__ import annotations

import math

import pytest

from bulkwear.workflows.cases.sliding_sample.page import BEYOND_BUMPS
from bulkwear.workflows.cases.sliding_sample.parameters import ramp_hop
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.report.page_parameters import figure_remarks


def test_figures_say_what_is_reduced(config):
    """A reduced study names its scale, its smaller sample, bed and travel, and the acceleration."""
    config.edit("studies/small.yaml", "      width_mm: 120\n", "      width_mm: 120\n    sliding: {travel_mm: 400}\n")
    assert figure_remarks(load_study("small", config.project, {"wear": {"acceleration": 1e4}})) == [
        "particles at scale 2",
        "sample 80 x 90 mm of 200 x 200 mm",
        "bed width 120 mm of 300 mm",
        "travel 400 mm of 1000 mm",
        "particles hop off the ramp, up to 43 mm at the highest velocity",
        "wear accelerated 10000 times",
    ]


def test_a_full_study_has_nothing_to_say(config):
    """At full size, scale 1, with a gentle ramp and without acceleration there are no remarks."""
    gentle = {"fidelity": "standard", "sample": {"skirt_slope_deg": 0.5}}
    assert figure_remarks(load_study("small", config.project, gentle)) == []


def test_particles_scaled_beyond_their_bumps_are_said_on_every_figure(config):
    """R9's alpha_ER reaches 1 at scale 2.74 and R5's at 3.46: above, the rows are said with their scales."""
    thin = {"bed": {"allow_thin_bed": True}}
    fine, one, both = (
        load_study("small", config.project, {"particle_scale": scale, **thin}) for scale in (2.7, 3, 3.5)
    )
    assert not any(remark.startswith(BEYOND_BUMPS) for remark in figure_remarks(fine))
    assert f"{BEYOND_BUMPS}, row with scale and limit: R9 (3, 2.7)" in figure_remarks(one)
    assert f"{BEYOND_BUMPS}, row with scale and limit: R9 (3.5, 2.7), R5 (3.5, 3.5)" in figure_remarks(both)


def test_bumps_smaller_than_real_particles_are_no_matter_of_scale(config):
    """Where already real particles are larger than the bumps, the study simulates what it means to."""
    config.edit("designs/small.csv", "R9,8,2,20,6.0,1.0,40", "R9,1.5,1.5,20,1.0,1.0,40")
    study = load_study("small", config.project)
    assert not any(remark.startswith(BEYOND_BUMPS) for remark in figure_remarks(study))


def test_a_thin_bed_is_said_on_every_figure(config):
    """An allowed thin bed is marked in its runs and remarked with the rows it concerns and their layers."""
    study = load_study("small", config.project, {"particle_scale": 4, "bed": {"allow_thin_bed": True}})
    assert [run.parameters["derived"]["thin_bed"] for run in study.runs] == [False, False, True, True]
    assert "fewer than three layers of particles in the bed: R5 (2.8)" in figure_remarks(study)


def test_exactly_three_layers_are_enough(config):
    """31 mm over particles of a third of it is 2.9999999999999996 in floating point: still three layers."""
    config.edit("designs/small.csv", "R5,4,8,60,6.0,2.0,30", "R5,4,8,60,6.0,2.0,31")
    study = load_study("small", config.project, {"particle_scale": 31 / 3 / 2.65})
    assert study.run("R5_plain").parameters["derived"]["layers"] < 3.0
    assert study.run("R5_plain").parameters["derived"]["thin_bed"] is False


def test_the_hop_off_the_ramp_is_ballistic_and_told(config):
    """A particle leaving a slope with v tan(slope) upwards is back after 2 v tan(slope) / g; long hops are remarked."""
    assert ramp_hop(2.0, math.atan(0.01)) == pytest.approx(2.0 * (2.0 * 2.0 * 0.01 / 9.81))
    straight = load_study("screening", overrides={"sample": {"skirt_radius_mm": 0}})
    told = [remark for remark in figure_remarks(straight) if remark.startswith("particles hop off the ramp")]
    assert told == ["particles hop off the ramp, up to 14 mm at the highest velocity"]


def test_a_ramp_curved_by_v_squared_over_g_ends_the_hop():
    """A particle follows a curve of radius v^2/g in free fall; what is left is the last element's angle. A tighter
    curve than that of the fastest row is refused."""
    study = load_study("screening")
    hop = max(run.parameters["derived"]["ramp_hop_m"] for run in study.runs)
    assert hop == pytest.approx(2.0 * 2.0**2 * (0.0015 / 2.0 / 0.41) / 9.81, rel=1e-3)
    assert not any(remark.startswith("particles hop") for remark in figure_remarks(study))
    with pytest.raises(ConfigError, match=r"skirt_radius_mm is 400 for row R3, allowed is at least 407.747 mm"):
        load_study("screening", overrides={"sample": {"skirt_radius_mm": 400}})
    for fidelity in ("quick", "standard", "paper"):
        assert not any("hop" in each for each in figure_remarks(load_study("demo", overrides={"fidelity": fidelity})))
