"""Measures of beds: what is missed, what is said of it, and where it is written."""

import math

import pandas as pd

from bulkwear.workflows.engine.beds import MEASURES, BedMeasure, bed_fault, write_measures

MASS, LEVEL = BedMeasure("mass", "kg", 20.5, 20.4, 0.2), BedMeasure("level", "m", 0.15, 0.131, 0.008)


def test_a_bed_that_misses_one_measure_is_told_with_all():
    """Found, asked and tolerance of each, with units."""
    assert bed_fault([MASS]) is None and bed_fault([]) is None
    said = "the bed is not as asked: mass 20.4 kg (asked 20.5 within 0.2), level 0.131 m (asked 0.15 within 0.008)"
    assert bed_fault([MASS, LEVEL]) == said


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
