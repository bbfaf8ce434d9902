"""The table of beds: asked and found in the units of pages, and the bulk density by mass and level."""

import pandas as pd
import pytest

from bulkwear.workflows.engine.beds import BedMeasure, write_measures
from bulkwear.workflows.report.beds import ASKED_DENSITY, beds_table, values_of_beds
from tests.support.tiny import tiny_study

EXACT = 1e-12  # relative: the same formula
LENGTH, WIDTH, HEIGHT, DENSITY = 2.0, 0.5, 0.04, 1500.0  # m, m, m, kg/m3
WORDS = {"settings": ["A", "B"], "packing": 1, "particle_scale": 2.0, ASKED_DENSITY: DENSITY}


def table_of(folder, found):
    """Return the table of a bed of LENGTH, WIDTH and HEIGHT, of which {measure: found} is found."""
    asked = {"mass": DENSITY * LENGTH * WIDTH * HEIGHT, "level": HEIGHT, "level in use": HEIGHT}
    units = {"mass": "kg", "level": "m", "level in use": "m"}
    measures = [BedMeasure(name, units[name], asked[name], value, 0.1 * asked[name]) for name, value in found.items()]
    (folder / "bed").mkdir()
    write_measures(measures, folder / "bed")
    return beds_table({"bed": WORDS}, [folder / "bed" / "cost.csv"])


def test_bulk_density_is_mass_over_area_and_level(tmp_path):
    """Whatever area the bed has, which no table tells: its asked mass, level and density do."""
    row = table_of(tmp_path, {"mass": 59.4, "level": 0.044, "level in use": 0.042}).iloc[0]
    found = 59.4 / (LENGTH * WIDTH * 0.044)
    assert row["bulk_density_found_kg_per_m3"] == pytest.approx(found, rel=EXACT)
    assert row["bulk_density_over_asked"] == pytest.approx(found / DENSITY, rel=EXACT)
    lengths = row[["level_found_mm", "level_tolerance_mm", "level_in_use_asked_mm", "level_in_use_found_mm"]]
    assert lengths.tolist() == pytest.approx([44.0, 4.0, 40.0, 42.0], rel=EXACT)
    assert row["settings"] == "A, B" and ASKED_DENSITY not in row


def test_a_bed_of_unknown_level_has_no_bulk_density(tmp_path):
    """Its mass is told alone."""
    assert not [name for name in table_of(tmp_path, {"mass": 59.4}) if "density" in name]


def test_the_density_asked_is_that_of_the_material():
    """Solid density times solid fraction, of every bed."""
    study = tiny_study()
    told = pd.DataFrame(values_of_beds(study)).T
    assert len(told) == len(study.beds) and set(told[ASKED_DENSITY]) == {2460.0 * 0.59}
