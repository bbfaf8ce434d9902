"""The table of filled boxes: asked and found, from what simulations recorded of themselves."""

import json

import pytest

from bulkwear.workflows.engine.bulk_tests import filled_mass
from bulkwear.workflows.report.fillings import filling_columns, fillings_of, fillings_table
from tests.support.bulk_boxes import asked, small

EXACT = 1e-12  # relative: the same formula


def kept(folder, test, mass, level):
    """Return the folder of a simulation whose filled box has these shares of the mass and the level asked for."""
    filling = {"mass": mass * filled_mass(test), "level": level * test["box"]["fill_height_m"]}
    (folder / "cycle_000").mkdir(parents=True)
    (folder / "cycle_000" / "state.json").write_text(json.dumps({"test": test, "filling": filling}))
    return folder


def test_bulk_density_is_that_of_the_box(tmp_path):
    """Mass over length, width and level; also of a box whose mass is told and not that of its height."""
    test = asked("draw_down")
    test = {**test, "box": {**test["box"], "fill_mass_kg_per_m": 40.0}}
    found, box = filling_columns(kept(tmp_path / "a", test, 0.99, 1.2)), test["box"]
    assert found["mass_found_kg"] == pytest.approx(0.99 * 40.0 * box["width_m"], rel=EXACT)
    density = 0.99 * 40.0 / (box["length_m"] * 1.2 * box["fill_height_m"])
    assert found["bulk_density_found_kg_per_m3"] == pytest.approx(density, rel=EXACT)
    assert found["bulk_density_over_asked"] == pytest.approx(density / (0.59 * 2460.0), rel=EXACT)


def test_boxes_of_a_size_are_one_row(tmp_path):
    """With the least and the largest of what was found; another box is another row."""
    test, other = small(), asked("draw_down")
    shares = {"a": (test, 0.995, 1.1), "b": (test, 1.0, 1.2), "c": (other, 1.0, 1.0)}
    folders = [kept(tmp_path / name, *each) for name, each in shares.items()]
    first, second = fillings_table(fillings_of(folders)).to_dict("records")
    assert (first["test"], first["fillings"], second["test"], second["fillings"]) == ("shear box", 2, "draw down", 1)
    height = 1e3 * test["box"]["fill_height_m"]
    levels = [first[f"{end}_level_found_mm"] for end in ("least", "largest")]
    assert levels == pytest.approx([1.1 * height, 1.2 * height], rel=EXACT)
    ratios = [first[f"{end}_bulk_density_over_asked"] for end in ("least", "largest")]
    assert ratios == pytest.approx([1.0 / 1.2, 0.995 / 1.1], rel=EXACT)
