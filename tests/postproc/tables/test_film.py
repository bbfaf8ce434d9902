"""Frames of a film: which run and cycles, their surfaces, the section through the bump that loses most."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.meshes.pattern import ConvexPattern
from bulkwear.meshes.sample import sliding_sample
from bulkwear.postproc.mesh import SurfaceMesh, write_surface
from bulkwear.postproc.tables.film import (
    DEEPEST_DRAWN,
    DRAWN_DEPTH,
    PLAIN_HEIGHT,
    drawn_height,
    exaggerated,
    exaggeration,
    film_frames,
    film_run,
    film_surfaces,
    frame_table,
    section,
    section_place,
    without_skirt,
)

HALF, SLOPE = 0.01, 0.3  # m, -: a tilted square
NODE = 1e-8  # m, of a section through nodes: the plane is moved beside them
EXACT = 1e-12  # m, rounding of one interpolation


def wear_table(cycles):
    """wear.csv as far as a film reads it: every cycle removes 1 mm3 over 10 mm."""
    cycle = np.arange(1, cycles + 1)
    return pd.DataFrame({"cycle": cycle, "travel_m": 0.01 * cycle, "total_applied_volume_m3": 1e-9 * cycle})


def tilted_square(lost=0.0):
    """Four triangles round a middle node, z = SLOPE y - lost."""
    corners = HALF * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, 0.0]])
    points = np.column_stack([corners, SLOPE * corners[:, 1] - lost])
    triangles = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    thickness = {"removed_thickness_m": np.full(5, lost)} if lost else {}
    return SurfaceMesh(points, triangles, {"part": np.zeros(4, dtype=np.int64)}, thickness)


def test_the_patterned_run_of_the_row_in_detail_is_filmed():
    """Of the row with the lowest relative wear the run that is not plain; a plain run where there is no other."""
    summary = pd.DataFrame(
        {
            "run": ["A_plain", "A_convex", "B_plain", "B_convex"],
            "row": ["A", "A", "B", "B"],
            "setting": ["A", "A", "B", "B"],
            "packing": 1,
            "surface": ["plain", "convex"] * 2,
            "wear_over_plain": [1.0, 0.9, 1.0, 0.7],
        }
    )
    assert film_run(summary) == "B_convex"
    assert film_run(summary[summary["surface"] == "plain"]) == "A_plain"


@pytest.mark.parametrize(("lost", "factor"), [(1e-9, 500_000.0), (1e-6, 500.0), (1e-5, 50.0), (5e-3, 1.0), (0.0, 1.0)])
def test_wear_is_drawn_as_deep_as_is_seen(lost, factor):
    """By 1, 2 or 5 times a power of ten, so that it reaches no more than a share of the height; never shallower."""
    unworn = tilted_square()
    assert drawn_height(unworn) == pytest.approx(2 * HALF * SLOPE)
    worn = SurfaceMesh(unworn.points, unworn.triangles, {}, {"removed_thickness_m": np.full(5, lost)})
    assert exaggeration(unworn, worn) == pytest.approx(factor)
    assert factor == 1.0 or 0.4 * DRAWN_DEPTH <= factor * lost / drawn_height(unworn) <= DRAWN_DEPTH


def test_a_plain_sample_has_a_share_of_its_length_as_height():
    """It has no pattern."""
    flat = SurfaceMesh(tilted_square().points * [1.0, 1.0, 0.0], tilted_square().triangles, {})
    assert drawn_height(flat) == pytest.approx(PLAIN_HEIGHT * 2 * HALF)


def test_wear_is_drawn_along_the_normal():
    """Worn nodes go deeper, up to a bound; others stay."""
    unworn = tilted_square()
    thickness, most = np.array([0.0, 1e-6, 2e-6, 0.0, 1e-3]), DEEPEST_DRAWN * HALF
    worn = SurfaceMesh(unworn.points, unworn.triangles, {}, {"removed_thickness_m": thickness})
    moved = exaggerated(worn, 101.0, most).points - unworn.points
    normal = np.array([0.0, -SLOPE, 1.0]) / np.hypot(1.0, SLOPE)
    np.testing.assert_allclose(moved, -np.minimum(100.0 * thickness, most)[:, None] * normal, atol=EXACT)


@pytest.mark.parametrize(("cycles", "most", "shown"), [(3, 60, [0, 1, 2, 3]), (100, 5, [0, 25, 50, 75, 100])])
def test_frames_are_thinned_evenly(cycles, most, shown):
    """One frame per cycle after the unworn surface, or evenly spaced ones with the last cycle among them."""
    frames = film_frames(wear_table(cycles), most)
    assert frames["cycle"].tolist() == shown
    np.testing.assert_allclose(frames["travel_m"], 0.01 * np.array(shown))
    np.testing.assert_allclose(frames["applied_volume_m3"], 1e-9 * np.array(shown))


def test_surfaces_of_the_cycles_are_read(tmp_path):
    """The first frame is the pristine surface, which has lost nothing; the table tells depth and height of each."""
    (tmp_path / "cycle_001").mkdir()
    write_surface(tmp_path / "surface.vtu", tilted_square())
    write_surface(tmp_path / "cycle_001" / "surface.vtu", tilted_square(1e-4))
    frames = film_frames(wear_table(1))
    table = frame_table(frames, film_surfaces(tmp_path, frames))
    np.testing.assert_allclose(table["largest_depth_um"], [0.0, 100.0])
    np.testing.assert_allclose(table["highest_point_mm"], [3.0, 2.9])
    np.testing.assert_allclose(table["applied_volume_mm3"], [0.0, 1.0])


def test_the_skirt_is_left_out():
    """Faces of the holder go with the nodes that only they have; what stays keeps its place and its data."""
    square = tilted_square(1e-4)
    square.cell_data["part"][:] = [-1, 0, 0, -1]
    square.point_data["removed_thickness_m"][:] = np.arange(5)
    found = without_skirt(square)
    np.testing.assert_array_equal(found.points[found.triangles], square.points[square.triangles[1:3]])
    assert found.point_data["removed_thickness_m"].tolist() == [1.0, 2.0, 3.0, 4.0]
    assert found.cell_data["part"].tolist() == [0, 0]


def test_a_missing_cycle_is_named(tmp_path):
    """The message names the first surface that is not there."""
    write_surface(tmp_path / "surface.vtu", tilted_square())
    with pytest.raises(FileNotFoundError, match="cycle_001"):
        film_surfaces(tmp_path, film_frames(wear_table(2)))


@pytest.mark.parametrize(("x", "error"), [(0.004, EXACT), (0.0, NODE), (-HALF / 2.0, EXACT)])
def test_a_section_lies_on_the_surface(x, error):
    """A plane cuts a tilted square in a line from edge to edge with the square's slope, also through a node."""
    lines = section(tilted_square(), x)
    np.testing.assert_allclose(lines[..., 1], SLOPE * lines[..., 0], atol=error)
    lengths = np.abs(np.diff(lines[..., 0], axis=1))
    assert lengths.sum() == pytest.approx(2.0 * HALF, abs=error)
    assert (lines[..., 0].min(), lines[..., 0].max()) == pytest.approx((-HALF, HALF), abs=error)


def test_the_section_goes_through_the_bump_that_lost_most():
    """Its place is the middle of that bump on the pristine surface; of a plain sample the sample's own middle."""
    pattern = ConvexPattern(0.008, 0.002, 0.006, row_spacing=0.02, column_spacing=0.015)
    sample = sliding_sample(0.04, 0.04, 0.0015, pattern, 3e-4, np.radians(3.0))
    part = sample.cell_data["part"]
    chosen = int(part.max())
    nodes = np.unique(sample.triangles[part == chosen])
    thickness = np.full(len(sample.points), 1e-7)
    thickness[nodes] = 1e-6
    worn = SurfaceMesh(sample.points, sample.triangles, sample.cell_data, {"removed_thickness_m": thickness})
    middle = (sample.points[nodes, 0].min() + sample.points[nodes, 0].max()) / 2.0
    assert section_place(sample, worn) == pytest.approx(middle)
    plain = tilted_square(1e-4)
    assert section_place(plain, plain) == pytest.approx(0.0, abs=EXACT)
