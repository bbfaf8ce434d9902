"""Measures of beds: what is missed, what is said of it, and where it is written."""

import math

import pandas as pd
import pytest

from bulkwear.workflows.engine import cycles
from bulkwear.workflows.engine.beds import (
    MEASURES,
    BedMeasure,
    bed_fault,
    level_measure,
    mass_measure,
    over_asked_density,
    read_measures,
    write_measures,
)
from bulkwear.workflows.engine.solver import LOG, SCREEN, SolverError
from tests.support.tiny import tiny_study

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
    assert read_measures(tmp_path) == [MASS, LEVEL]


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


def test_a_depth_is_held_to_a_part_of_itself():
    """A bed of 0.5 m may miss its level by 30 mm; a sample 0.05 m deep in it is not covered as asked then."""
    level, depth = (level_measure(GRAIN, 0.5, 0.52, covering=covering) for covering in (0.0, 0.45))
    assert (level.tolerance, depth.tolerance) == (pytest.approx(0.03, rel=1e-12), pytest.approx(0.0075, rel=1e-12))
    assert not level.missed and depth.missed


def test_a_level_bed_has_the_density_of_its_mass_and_level():
    """2 m2 of bed, 0.1 m high at 1500 kg/m3, that are 3 kg too heavy and a fifth too high, are mass over volume."""
    mass, level = BedMeasure("mass", "kg", 300.0, 303.0, 3.0), BedMeasure("level", "m", 0.1, 0.12, 0.01)
    assert 1500.0 * over_asked_density(mass, level) == pytest.approx(303.0 / (2.0 * 0.12), rel=1e-12)


def test_the_restart_file_of_an_earlier_filling_does_not_count(tmp_path, monkeypatch):
    """A solver that is asked to end ends without a fault and without a bed; what was there before is none."""
    study = tiny_study()
    name, bed = next(iter(study.beds.items()))
    (tmp_path / cycles.BED_RESTART).write_bytes(b"of an earlier filling")

    def asked_to_end(folder, *given, **named):
        for file in (LOG, SCREEN):
            (folder / file).write_text("Step Atoms KinEng\n0 1 0.0\n39 1 0.0\n")
        return 1.0

    monkeypatch.setattr(cycles, "run_deck", asked_to_end)
    with pytest.raises(SolverError, match=r"screen\.txt: LIGGGHTS ended at step 39 without bed\.restart; start again"):
        cycles.fill_bed(study.case, name, bed, tmp_path)
    assert not (tmp_path / cycles.BED_RESTART).exists()
