"""Compared surfaces as a block of numbers: what a page unpacks is what was packed."""

import zlib
from dataclasses import replace

import numpy as np
import pytest

from bulkwear.postproc.mesh import HOLDER_PART, SurfaceMesh
from bulkwear.postproc.tables.compared_surfaces import quantities
from bulkwear.postproc.tables.film import without_skirt
from bulkwear.postproc.tables.packed_surfaces import LEVELS, neighbours_together, node_parts, packed
from tests.support.shapes import plate
from tests.support.worn_square import DEPTH, IMPULSE, as_shown, square

ROUNDED = 1.0 / LEVELS  # -, of a box and of the largest value


def unpacked(told, block):
    """Points (mm), triangles and values by key of each surface, as a page reads them."""
    numbers, (low, high) = zlib.decompress(block), np.array(told["box"])

    def planes(at, count, kind):
        size = np.dtype(kind).itemsize
        return np.frombuffer(numbers, "u1", size * count, at).reshape(size, -1).T.copy().view(kind).ravel()

    for entry in told["surfaces"]:
        raw = planes(entry["points"], 3 * entry["nodes"], "<u2")
        if entry["over"] is not None:
            raw = raw + planes(entry["over"], 3 * entry["nodes"], "<u2")
        triangles = planes(entry["triangles"], 3 * entry["faces"], "<u4").reshape(-1, 3).copy()
        triangles[:, 0] = np.cumsum(triangles[:, 0], dtype="<u4")
        triangles[:, 1:] += triangles[:, :1]
        values = {key: planes(at, entry["nodes"], "<u2") / (LEVELS - 1.0) for key, at in entry["values"].items()}
        yield low + (high - low) * raw.reshape(3, -1).T / LEVELS, triangles, values


def order_of(shown):
    return neighbours_together(shown.mesh.triangles, len(shown.mesh.points))[0]


def test_a_page_unpacks_what_was_packed():
    """Places to a step of the box, values to a step of their largest; what is alike is kept once, zeros left out."""
    surfaces = [as_shown(square(DEPTH * factor), cycle=cycle) for cycle, factor in ((1, 0.5), (2, 1.0))]
    told, block = packed(surfaces, True)
    first, second = unpacked(told, block)
    for (points, triangles, values), each in zip((first, second), surfaces, strict=True):
        order = order_of(each)
        np.testing.assert_allclose(points, each.mesh.points[order] * 1e3, atol=ROUNDED * np.ptp(told["box"]))
        assert {tuple(np.roll(face, -face.argmin())) for face in order[triangles]} == {
            tuple(np.roll(face, -face.argmin())) for face in each.mesh.triangles
        }
        depth = values["depth"] * told["quantities"]["depth"]["largest"]
        np.testing.assert_allclose(depth, quantities(True)["depth"].values(each)[order], atol=ROUNDED * DEPTH * 1e6)
    entries = told["surfaces"]
    assert entries[0]["triangles"] == entries[1]["triangles"] and entries[1]["over"] == entries[0]["points"]
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
    assert node_parts(without_skirt(square())).tolist() == [1, 0, 1, 1]


def test_a_worn_surface_is_kept_over_the_unworn_one():
    """Whichever way nodes moved; after remeshing, with other nodes, by itself."""
    unworn, moved = square(0.0), square()
    moved.points[:] += 1e-5 * np.array([[1, -1, -2]] * 5)
    points, triangles = np.vstack([moved.points, moved.points[:1]]), np.vstack([moved.triangles, [0, 1, 5]])
    more = SurfaceMesh(points, triangles, {"part": np.array([0, 1, HOLDER_PART, 0])})
    surfaces = [as_shown(unworn, cycle=0), as_shown(moved), as_shown(more), as_shown(moved, run="R5")]
    told, block = packed(surfaces, True)
    assert [entry["over"] is None for entry in told["surfaces"]] == [True, False, True, True]
    for (points, _, _), each in zip(unpacked(told, block), surfaces, strict=True):
        kept = each.mesh.points[order_of(each)] * 1e3
        np.testing.assert_allclose(points, kept, atol=ROUNDED * np.ptp(told["box"]))


def test_an_order_puts_neighbours_together():
    """Every node once, every triangle as it was with its normal; numbers of a shuffled mesh differ less than before."""
    mesh, random = plate(0.01, 0.01, 12), np.random.default_rng(1)
    shuffle = random.permutation(len(mesh.points))
    mixed = np.argsort(shuffle)[mesh.triangles][random.permutation(len(mesh.triangles))]
    order, found = neighbours_together(mixed, len(mesh.points))
    assert sorted(order) == list(range(len(mesh.points)))
    points = mesh.points[shuffle]
    wanted, got = (np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]) for p in (points[mixed], points[order][found]))
    np.testing.assert_allclose(got[:, 2], wanted[0, 2])
    assert len(np.unique(order[found], axis=0)) == len(mixed)
    assert np.ptp(found, axis=1).max() <= 2 * 14 < np.ptp(mixed, axis=1).mean()  # a row of nodes and the next


def test_a_surface_that_is_not_whole_has_its_depth_alone():
    """Its loads are left out, and do not count for the colours of the others."""
    loads = {"normal_impulse_N_s": np.full(3, 10 * IMPULSE)}
    middle = square()
    middle.cell_data.update(loads)
    shown = [replace(as_shown(middle), whole=False), as_shown(square(), cycle=2)]
    told, _ = packed(shown, True)
    assert [set(entry["values"]) for entry in told["surfaces"]] == [{"depth"}, {"depth", "removed", "pressure"}]
    alone, _ = packed(shown[1:], True)
    assert told["quantities"]["pressure"] == alone["quantities"]["pressure"]
