"""Measures of beds: what is missed, what is said of it, and where it is written."""

import math

import pandas as pd
import pytest

from bulkwear.workflows.engine.beds import MEASURES, BedMeasure, bed_fault, level_measure, mass_measure, write_measures

MASS, LEVEL = BedMeasure("mass", "kg", 20.5, 20.4, 0.2), BedMeasure("level", "m", 0.15, 0.131, 0.008)


def test_a_bed_that_misses_one_measure_is_told_with_all():
    """Found, asked and tolerance of each, with units."""
    assert bed_fault([MASS]) is None and bed_fault([]) is None
    said = "the bed is not as asked: mass 20.4 kg (asked 20.5 within 0.2), level 0.131 m (asked 0.15 within 0.008)"
    cause = "it settles to 1.1 times the bulk density of its material (bulk_solid_fraction)"
    assert bed_fault([MASS, LEVEL]) == f"{said}; {cause}"


def test_a_bed_that_lacks_mass_says_nothing_of_its_density():
    """Its level is low because particles are missing."""
    said = bed_fault([BedMeasure("mass", "kg", 20.5, 17.0, 0.2), LEVEL])
    assert said.startswith("the bed is not as asked: mass 17 kg") and "bulk_solid_fraction" not in said


def test_no_number_is_missed():
    """Nothing lay where the level is looked for."""
    assert BedMeasure("level", "m", 0.15, math.nan, 0.008).missed


def test_measures_are_written(tmp_path):
    """A row each; a bed of a case that asks for nothing has no table."""
    write_measures([], tmp_path)
    assert not (tmp_path / MEASURES).exists()
    write_measures([MASS, LEVEL], tmp_path)
    table = pd.read_csv(tmp_path / MEASURES)
    assert table["missed"].tolist() == [False, True] and table["unit"].tolist() == ["kg", "m"]


GRAIN = {"diameters_m": [0.008, 0.012], "median_diameter_m": 0.01, "density_kg_per_m3": 2500.0}


def test_tolerances_are_those_of_grains():
    """A hundredth of the mass, or two of the largest grains; half a grain of level and a twentieth of the height."""
    grain = 2500.0 * math.pi / 6.0 * 0.012**3
    assert mass_measure(GRAIN, 20.0, 20.0).tolerance == pytest.approx(0.2, rel=1e-12)
    assert mass_measure(GRAIN, 0.1, 0.1).tolerance == pytest.approx(2.0 * grain, rel=1e-12)
    assert level_measure(GRAIN, 0.05, 0.05).tolerance == pytest.approx(0.0075, rel=1e-12)
    assert level_measure(GRAIN, 0.3, 0.3).tolerance == pytest.approx(0.02, rel=1e-12)


def test_depth_is_what_lies_over_something():
    """0.15 m of bed over a sample whose middle is 0.09 m deep; the level's fault is the depth's."""
    depth = level_measure(GRAIN, 0.15, 0.13, "depth", covering=0.06)
    assert (depth.measure, depth.asked, depth.found) == ("depth", pytest.approx(0.09), pytest.approx(0.07))
    assert depth.missed
