"""Surfaces for comparison: what is shown at a node, which cycles of which runs, and what a page unpacks."""

import zlib

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.mesh import HOLDER_PART, SurfaceMesh, node_areas, write_surface
from bulkwear.postproc.tables import compared_surfaces as compared
from bulkwear.postproc.tables.compared_surfaces import Shown, packed, quantities, shown_surfaces
from bulkwear.postproc.wear.thickness import LOCAL_THICKNESS

SIDE, TIME, DEPTH, THICKNESS = 0.01, 0.5, 3e-6, 2e-3  # m, s, m, m
IMPULSE = 4e-3  # N s, of each of the two triangles
ROUNDED = 1.0 / compared.LEVELS  # -, of a box and of the largest value


def square(depth=DEPTH, **data):
    """A square of two triangles and one of the holder beside it, worn to a depth."""
    points = SIDE * np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.5], [2, 0, 0]], dtype=float)
    triangles = np.array([[0, 1, 2], [0, 2, 3], [1, 4, 2]])
    loads = {"normal_impulse_N_s": IMPULSE, "sliding_work_J": 0.0, "impact_energy_J": 0.0, "worn_volume_m3": 1e-12}
    cells = {"part": np.array([0, 1, HOLDER_PART])} | {name: np.full(3, value) for name, value in loads.items()}
    nodes = {"removed_thickness_m": np.full(5, depth), "carried_volume_m3": np.zeros(5)} | data
    return SurfaceMesh(points, triangles, cells, nodes)


def as_shown(mesh, run="R9", cycle=1):
    return Shown(run, cycle, TIME * cycle, f"cycle {cycle}", compared.without_skirt(mesh))


def unpacked(told, block):
    """Points (mm) and values by key of each surface, as a page reads them."""
    numbers, (low, high) = zlib.decompress(block), np.array(told["box"])
    for entry in told["surfaces"]:
        raw = np.frombuffer(numbers, "<u2", 3 * entry["nodes"], entry["points"]).reshape(-1, 3)
        triangles = np.frombuffer(numbers, "<u4", 3 * entry["faces"], entry["triangles"]).reshape(-1, 3)
        values = {
            key: np.frombuffer(numbers, "<u2", entry["nodes"], at) / (compared.LEVELS - 1.0)
            for key, at in entry["values"].items()
        }
        yield low + (high - low) * raw / compared.LEVELS, triangles, values


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


def test_a_page_unpacks_what_was_packed():
    """Places to a step of the box, values to a step of their largest; what is alike is kept once, zeros left out."""
    surfaces = [as_shown(square(DEPTH * factor), cycle=cycle) for cycle, factor in ((1, 0.5), (2, 1.0))]
    told, block = packed(surfaces, True)
    first, second = unpacked(told, block)
    for (points, triangles, values), each in zip((first, second), surfaces, strict=True):
        np.testing.assert_allclose(points, each.mesh.points * 1e3, atol=ROUNDED * np.ptp(told["box"]))
        assert triangles.tolist() == each.mesh.triangles.tolist()
        depth = values["depth"] * told["quantities"]["depth"]["largest"]
        np.testing.assert_allclose(depth, quantities(True)["depth"].values(each), atol=ROUNDED * DEPTH * 1e6)
    entries = told["surfaces"]
    assert entries[0]["triangles"] == entries[1]["triangles"] and entries[0]["points"] == entries[1]["points"]
    assert entries[0]["values"]["depth"] != entries[1]["values"]["depth"]
    assert set(told["quantities"]) == {"depth", "removed", "pressure"}


@pytest.mark.parametrize(("depth", "unit", "top"), [(DEPTH, "µm", 3.0), (DEPTH * 1000, "mm", 3.0)])
def test_thousands_of_micrometres_are_millimetres(depth, unit, top):
    """The unit of a scale fits its largest value."""
    told, _ = packed([as_shown(square(depth))], True)
    scale = told["quantities"]["depth"]
    assert scale["unit"] == unit and scale["top"] == pytest.approx(top)


def test_the_part_of_a_node_is_told():
    """A node between two parts counts to the higher one."""
    assert compared.node_parts(compared.without_skirt(square())).tolist() == [1, 0, 1, 1]


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


@pytest.mark.parametrize(("most", "runs", "cycles"), [(32, 2, 3), (16, 2, 1), (9, 1, 1)])
def test_a_large_study_shows_fewer_cycles_then_fewer_runs(left, monkeypatch, most, runs, cycles):
    """Never more nodes than a page takes, but for one run; the last cycle is always there."""
    monkeypatch.setattr(compared, "MOST_NODES", most)
    shown = shown_surfaces(*left)
    assert [each.run for each in shown] == [run for run in list(left[0])[:runs] for _ in range(1 + cycles)]
    assert shown[-1].cycle == 6
