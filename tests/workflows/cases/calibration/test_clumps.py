"""Bulk tests of clumps on the real solver: filled by mass, at rest, none lost, measured as those of spheres."""

import math

import pytest

from bulkwear.postproc.flow.bed import read_snapshot
from bulkwear.postproc.flow.bulk_test import HEAP
from bulkwear.postproc.readers.solver_log import thermo_table
from bulkwear.workflows.cases.calibration.boxes import shear_box, with_values
from bulkwear.workflows.cases.calibration.simulations import measured
from bulkwear.workflows.engine.bulk_simulations import LOG, filling_measures, simulated
from tests.support.bulk_boxes import NOT_ROLLING, asked

pytestmark = pytest.mark.solver

PAIRS = {
    "bulk": {"shape": "pair", "material": "river_gravel_published"},
    "solver": {"rolling_friction": "none"},
    "calibration": {"parameters": NOT_ROLLING},
}
WALL_FRICTION = 0.2  # -, low enough that clumps slide over the plate and do not turn
WALL = "wall_material.contact.sliding_friction"
SLIDES = 0.1  # deg, of the mean over the drag; measured 1e-8, and 0.013 over twice the way
FLOWED = (0.2, 0.9)  # -, of the clumps


def box(kind, **sizes):
    """A bulk test of some hundred pairs without rolling friction, five times as large as gravel."""
    test = asked(kind, particle_scale=5.0, **PAIRS)
    return {**test, "box": {**test["box"], "width_m": 0.054, **sizes}}


@pytest.mark.verify
def test_a_shear_box_of_clumps(tmp_path):
    """The mass asked for; after the opening all are there, in the box as a slope or at rest in the pit."""
    test = box("shear_box", length_m=0.135, fill_height_m=0.12)
    folder = simulated(test, tmp_path)
    mass, _ = filling_measures(folder, test)
    assert abs(mass.found - mass.asked) <= mass.tolerance
    table, heap = thermo_table(folder / LOG), read_snapshot(folder / HEAP)
    assert len(set(table["Atoms"][1:])) == 1 and len(heap) == table["Atoms"][-1]
    assert FLOWED[0] < (heap["z_m"] < 0.0).mean() < FLOWED[1]
    assert (heap["z_m"] > shear_box(test)["pit_bottom_m"]).all()
    assert 15.0 < measured(test, folder).responses["shear_angle_deg"] < 50.0


@pytest.mark.verify
def test_clumps_that_slide_have_the_friction_of_the_plate(tmp_path):
    """Under a plate that is drawn they slide, as they cannot roll: the wall friction angle is atan mu."""
    test = with_values(box("wall_shear", length_m=0.06, fill_height_m=0.06, drag_m=0.02), {WALL: WALL_FRICTION})
    found = measured(test, simulated(test, tmp_path)).responses["wall_friction_angle_deg"]
    assert found == pytest.approx(math.degrees(math.atan(WALL_FRICTION)), abs=SLIDES)
