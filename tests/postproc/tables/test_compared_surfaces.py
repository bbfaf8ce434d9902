"""Surfaces for comparison: what is shown at a node, and which cycles of which runs."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.mesh import node_areas, write_surface
from bulkwear.postproc.tables import compared_surfaces as compared
from bulkwear.postproc.tables.compared_surfaces import quantities, shown_surfaces
from bulkwear.postproc.wear.thickness import LOCAL_THICKNESS
from tests.support.worn_square import DEPTH, IMPULSE, THICKNESS, TIME, as_shown, square


def test_loads_are_means_over_area_and_time():
    """An impulse on each triangle over area and time is a pressure; carried wear adds to what is removed."""
    carried = np.array([1e-12, 0.0, 0.0, 0.0, 0.0])
    shown = as_shown(square(carried_volume_m3=carried, **{LOCAL_THICKNESS: np.full(5, THICKNESS)}))
    found = {key: quantity.values(shown) for key, quantity in quantities(True).items()}
    area = node_areas(shown.mesh)
    np.testing.assert_allclose((found["pressure"] * area).sum(), 2 * IMPULSE / TIME * 1e-3)
    np.testing.assert_allclose(found["removed"], DEPTH * 1e6)
    np.testing.assert_allclose(found["carried"], carried[:4] / area * 1e6, atol=1e-9)
    np.testing.assert_allclose(found["depth"], found["removed"] + found["carried"])
    np.testing.assert_allclose(found["remaining"], (THICKNESS - DEPTH) * 1e3)


def test_a_rigid_study_shows_an_equivalent_depth():
    """Worn volume over area; nothing is removed, carried or left."""
    shown = as_shown(square())
    assert {"removed", "carried", "remaining"}.isdisjoint(quantities(False))
    depth = quantities(False)["depth"].values(shown)
    np.testing.assert_allclose((depth * node_areas(shown.mesh)).sum(), 2e-12 * 1e6)


@pytest.fixture
def left(tmp_path):
    """Folders and wear.csv of two runs with six cycles each."""
    runs, wear = {}, {}
    for run in ("R9", "R5"):
        runs[run] = tmp_path / run
        cycles = np.arange(1, 7)
        wear[run] = pd.DataFrame({"cycle": cycles, "time_s": TIME * cycles, "travel_m": 0.1 * cycles})
        for folder in (runs[run], *(runs[run] / f"cycle_{cycle:03d}" for cycle in cycles)):
            folder.mkdir()
            write_surface(folder / compared.SURFACE, square())
    return runs, wear


def test_all_cycles_of_a_small_study_are_shown(left):
    """The unworn surface first, each called by its cycle and travel."""
    shown = shown_surfaces(*left)
    assert [(each.run, each.cycle) for each in shown] == [(run, cycle) for run in ("R9", "R5") for cycle in range(7)]
    assert shown[0].said == compared.UNWORN and shown[6].said == "cycle 6, 0.6 m"
    assert shown[6].time_s == pytest.approx(6 * TIME)


def test_hours_of_operation_call_a_block(left):
    """A machine's cycles are told by the hours that its shape stands for."""
    runs, wear = left
    hours = {run: table.assign(operation_h=100.0 * table["cycle"], stands_for_h=20.0) for run, table in wear.items()}
    assert shown_surfaces(runs, hours)[6].said == "620 h (block 6)"


NODES = 8  # of the unworn surfaces of both runs, without skirt


@pytest.mark.parametrize(
    ("cost", "runs", "cycles", "whole"),
    [
        ((1, 6, 0), 2, 6, 6),  # all values of all cycles
        ((1, 4, 0), 2, 4, 4),
        ((1, 1, 3), 2, 4, 1),  # the last one whole, depths of three before it
        ((1, 1, 0), 2, 1, 1),
        ((0.5, 0.5, 0), 1, 1, 1),
    ],
)
def test_a_large_study_shows_fewer_values_then_fewer_cycles_then_fewer_runs(
    left, monkeypatch, cost, runs, cycles, whole
):
    """Never more than a page takes, but for one run; the last cycle is always there, with all values."""
    each = (compared.UNWORN_NODE, compared.WHOLE_NODE, compared.DEPTH_NODE)
    monkeypatch.setattr(compared, "MOST_BYTES", NODES * sum(a * b for a, b in zip(cost, each, strict=True)) + 1e-6)
    shown = shown_surfaces(*left)
    assert [each.run for each in shown] == [run for run in list(left[0])[:runs] for _ in range(1 + cycles)]
    assert shown[-1].cycle == 6 and shown[-1].whole
    assert sum(each.whole for each in shown) == runs * (1 + whole)
