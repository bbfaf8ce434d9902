"""Runs share a bed where they settle alike, and only there."""

from __future__ import annotations

import pytest

from bulkwear.workflows.cases.sliding_sample.case import bed_parameters
from bulkwear.workflows.config.design import load_study


def test_convex_and_plain_share_a_bed_and_another_thickness_does_not(config):
    """Runs with equal bed parameters start from one bed."""
    study = load_study("small", config.project)
    assert study.bed_of("R9_convex") == study.bed_of("R9_plain") == "bed_R9"
    assert study.bed_of("R5_convex") == study.bed_of("R5_plain") == "bed_R5"
    assert list(study.beds) == ["bed_R9", "bed_R5"]
    assert [bed["thickness_m"] for bed in study.beds.values()] == [0.04, 0.03]


def test_velocity_and_pattern_do_not_make_another_bed(config):
    """Rows that differ in velocity, radii, spacing and height share a bed: it settles at rest."""
    config.edit("designs/small.csv", "R5,4,8,60,6.0,2.0,30", "R5,4,8,60,3.0,2.0,40")
    assert list(load_study("small", config.project).beds) == ["bed_R9"]


@pytest.mark.parametrize(
    "overrides",
    [
        {"particle_scale": 1.5},
        {"bed": {"seed": 7}},
        {"bed": {"width_mm": 130}},
        {"bed": {"ahead_mm": 151}},
        {"bed": {"ends": "periodic"}},
        {"bed": {"floor_material": "steel"}},
        {"sliding": {"travel_mm": 900}},
        {"solver": {"rolling_friction": "epsd2"}},
        {"solver": {"rolling_radius": "reduced"}},
        {"solver": {"rayleigh_fraction": 0.1}},
        {"solver": {"contact_model": "hooke", "characteristic_velocity_m_per_s": 1.0}},
    ],
)
def test_what_settles_differently_is_another_bed(config, overrides):
    """Each setting that changes the settled bed changes the bed's parameters."""
    run, other = (load_study("small", config.project, o).run("R9_plain") for o in (None, overrides))
    assert bed_parameters(run) != bed_parameters(other)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("sliding_friction: 0.36", "sliding_friction: 0.37"),
        ("restitution: 0.4,", "restitution: 0.5,"),
        ("sliding_friction: 0.21", "sliding_friction: 0.22"),
        ("[0.8, 1.0, 1.2]", "[0.8, 1.0, 1.3]"),
    ],
)
def test_another_contact_or_distribution_is_another_bed(config, old, new):
    """Each property of the particles, and of their contact with the floor, belongs to the bed."""
    before = bed_parameters(load_study("small", config.project).run("R9_plain"))
    config.edit("materials.yaml", old, new)
    assert bed_parameters(load_study("small", config.project).run("R9_plain")) != before


@pytest.mark.parametrize(
    "overrides",
    [
        {"sample": {"material": "perspex"}},
        {"sample": {"element_size_mm": 1.2}},
        {"wear": {"acceleration": 3}},
        {"sliding": {"cycles": 5}},
        {"solver": {"picture_interval_mm": 7}},
        {"solver": {"ranks": 2}},
        {"solver": {"characteristic_velocity_m_per_s": 2.0}},
    ],
)
def test_what_does_not_touch_the_bed_keeps_it(config, overrides):
    """Sample, wear and output settings do not ask for another bed."""
    run, other = (load_study("small", config.project, o).run("R9_plain") for o in (None, overrides))
    assert bed_parameters(run) == bed_parameters(other)


def test_beds_settle_above_the_highest_bump_of_the_study(config):
    """The temporary floor of every bed is higher than every sample of the study, and the same for all."""
    study = load_study("small", config.project)
    floors = {bed["temporary_floor_m"] for bed in study.beds.values()}
    assert len(floors) == 1
    assert floors.pop() > 0.0003 + 0.006
