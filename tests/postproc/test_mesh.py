"""Surface geometry against closed forms, and surfaces written and read back."""

import math

import numpy as np
import pytest

from bulkwear.meshes.plate import closed_box, flat_plate, sphere
from bulkwear.postproc import mesh as pm
from tests.support.stl import stl_facets

ROUNDING = 1e-12  # relative: sums of a few thousand float64 terms
STL_DIGITS = 5e-9  # relative: nine significant digits


@pytest.fixture
def triangle():
    """A 3-4-5 triangle in the plane z = 0, normal up."""
    return np.array([[0.0, 0, 0], [3, 0, 0], [0, 4, 0]]), np.array([[0, 1, 2]])


def test_right_triangle(triangle):
    """3-4-5: area 6, normal +z, angle atan(3/4), edges 3, 5, 4, centroid a third of the way."""
    assert pm.area_vectors(*triangle) == pytest.approx(np.array([[0, 0, 6.0]]))
    assert pm.areas(*triangle) == pytest.approx([6.0])
    assert pm.unit_normals(*triangle) == pytest.approx(np.array([[0, 0, 1.0]]))
    assert pm.smallest_angles(*triangle) == pytest.approx([math.degrees(math.atan2(3, 4))])
    assert pm.edge_lengths_per_triangle(*triangle) == pytest.approx(np.array([[3.0, 5.0, 4.0]]))
    assert pm.shortest_edge_at_nodes(*triangle) == pytest.approx([3.0, 3.0, 4.0])
    assert pm.centroids(*triangle) == pytest.approx(np.array([[1.0, 4 / 3, 0]]))


def test_node_of_no_triangle(triangle):
    """A node that no triangle uses has an infinite shortest edge and no area."""
    points = np.vstack([triangle[0], [9.0, 9, 9]])
    assert np.isinf(pm.shortest_edge_at_nodes(points, triangle[1])[3])
    assert (pm.node_area_vectors(points, triangle[1])[3] == 0).all()


def test_degenerate_triangle_has_zero_angle_and_no_normal():
    """Three nodes on a line: angle 0, area 0, normal NaN; no division warning hides it."""
    points, triangles = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), np.array([[0, 1, 2]])
    assert pm.smallest_angles(points, triangles)[0] == 0
    assert pm.areas(points, triangles)[0] == 0
    assert np.isnan(pm.unit_normals(points, triangles)).all()


def test_area_vectors_of_a_closed_surface_sum_to_zero():
    """The area vectors of a closed surface cancel (divergence theorem), those of its nodes too."""
    ball = sphere(2.0, 3)
    scale = pm.areas(ball.points, ball.triangles).sum()
    assert np.abs(pm.area_vectors(ball.points, ball.triangles).sum(axis=0)).max() < ROUNDING * scale
    assert np.abs(pm.node_area_vectors(ball.points, ball.triangles).sum(axis=0)).max() < ROUNDING * scale


def test_node_area_vector_is_the_volume_gradient():
    """Moving a node by w changes the volume by w . A_n to first order: A_n is its gradient."""
    box = closed_box(1.0, 2.0, 3.0, 0.5)
    step, node = np.array([1e-5, -2e-5, 3e-5]), 17
    moved = box.points.copy()
    moved[node] += step
    change = pm.enclosed_volume(moved, box.triangles) - pm.enclosed_volume(box.points, box.triangles)
    gradient = pm.node_area_vectors(box.points, box.triangles)[node]
    second_order = np.linalg.norm(step) ** 2  # times an edge of 0.5 m or so
    assert change == pytest.approx(step @ gradient, abs=second_order)
    assert abs(step @ gradient) > 100 * second_order  # so the line above can fail


def test_volume_of_a_box_wherever_it_stands():
    """Width x length x height, wherever the box stands; the sign turns when it is turned inside out."""
    box = closed_box(1.0, 2.0, 3.0, 0.4)
    assert pm.enclosed_volume(box.points, box.triangles) == pytest.approx(6.0, rel=ROUNDING)
    assert pm.enclosed_volume(box.points + 1e3, box.triangles) == pytest.approx(6.0, rel=1e3 * ROUNDING)
    assert pm.enclosed_volume(box.points, box.triangles[:, ::-1]) == pytest.approx(-6.0, rel=ROUNDING)


def test_volume_above_plane():
    """Plate 0.5 m above a plane: half its area; a closed surface: its own volume above any plane."""
    plate = flat_plate(2.0, 3.0, 0.5)
    assert pm.volume_above_plane(plate.points, plate.triangles, -0.5) == pytest.approx(3.0, rel=ROUNDING)
    assert pm.volume_above_plane(plate.points, plate.triangles, 0.5) == pytest.approx(-3.0, rel=ROUNDING)
    ball = sphere(1.0, 2)
    volume = pm.enclosed_volume(ball.points, ball.triangles)
    assert pm.volume_above_plane(ball.points, ball.triangles, 7.0) == pytest.approx(volume, rel=1e-10)


def test_open_surface_has_no_volume():
    """The volume of an open surface is refused, with the number of open edges."""
    plate = flat_plate(1.0, 1.0, 0.5)
    with pytest.raises(ValueError, match="8 boundary edges"):
        pm.enclosed_volume(plate.points, plate.triangles)


def test_boundary_of_a_plate_is_its_rim():
    """Boundary edges run round the plate with the surface on their left; a closed surface has none."""
    plate = flat_plate(2.0, 1.0, 0.5)
    edges = pm.boundary_edges(plate.triangles)
    assert len(edges) == 12
    start, end = plate.points[edges[:, 0]], plate.points[edges[:, 1]]
    assert np.cross(start, end)[:, 2].min() >= 0  # anticlockwise round the centre
    on_rim = (np.abs(plate.points[:, 0]) == 1.0) | (np.abs(plate.points[:, 1]) == 0.5)
    assert (pm.boundary_nodes(plate.triangles) == np.flatnonzero(on_rim)).all()
    assert len(pm.boundary_edges(sphere(1.0, 1).triangles)) == 0


def test_nonmanifold_edges():
    """Edges of three triangles and edges between opposite orientations are found; a sphere has none."""
    fin = np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]])
    assert pm.nonmanifold_edges(fin).tolist() == [[0, 1]]
    assert pm.nonmanifold_edges(np.array([[0, 1, 2], [0, 1, 3]])).tolist() == [[0, 1]]
    assert pm.nonmanifold_edges(sphere(1.0, 1).triangles).shape == (0, 2)


@pytest.mark.parametrize(
    ("points", "triangles", "cell_data", "message"),
    [
        (np.zeros((3, 2)), [[0, 1, 2]], {}, "points of a surface"),
        (np.zeros((3, 3)), [[0, 1, 3]], {}, "name nodes 0 to 3, allowed are 0 to 2"),
        (np.zeros((3, 3)), [[0, 1, -1]], {}, "name nodes -1"),
        (np.zeros((3, 3)), [[0, 1, 2]], {"part": np.zeros(2)}, "'part' must have 1 entries, found 2"),
    ],
)
def test_inconsistent_surface_is_refused(points, triangles, cell_data, message):
    """Arrays that do not belong together are refused when the surface is made."""
    with pytest.raises(ValueError, match=message):
        pm.SurfaceMesh(points, np.array(triangles), cell_data)


def labelled_surface():
    """A surface with awkward numbers in every kind of data."""
    ball = sphere(1 / 3, 1)
    random = np.random.default_rng(5)
    cells, nodes = len(ball.triangles), len(ball.points)
    cell_data = {
        "part": np.arange(cells) - 1,
        "load_J": random.normal(size=cells),
        "n": random.normal(size=(cells, 3)),
    }
    depth = np.where(np.arange(nodes) % 5 == 0, np.nan, 1e-300 * random.random(nodes))
    return pm.SurfaceMesh(ball.points, ball.triangles, cell_data, {"ray_depth_m": depth})


def test_vtu_loses_nothing(tmp_path):
    """Points, triangles and data come back bit for bit with their types; written again, the same file."""
    surface = labelled_surface()
    pm.write_surface(tmp_path / "a.vtu", surface)
    back = pm.read_surface(tmp_path / "a.vtu")
    assert back.points.tobytes() == surface.points.tobytes()
    assert back.triangles.tobytes() == surface.triangles.tobytes()
    assert back.cell_data.keys() == surface.cell_data.keys()
    for data, original in ((back.cell_data, surface.cell_data), (back.point_data, surface.point_data)):
        for name, array in original.items():
            assert data[name].dtype == array.dtype
            assert data[name].shape == array.shape
            assert data[name].tobytes() == array.tobytes()
    pm.write_surface(tmp_path / "b.vtu", back)
    assert (tmp_path / "a.vtu").read_bytes() == (tmp_path / "b.vtu").read_bytes()


def test_failed_write_leaves_the_old_file(tmp_path):
    """A write that fails keeps the previous file and leaves no temporary one behind."""
    path = tmp_path / "a.stl"
    plate = flat_plate(1.0, 1.0, 1.0)
    pm.write_stl(path, plate.points, plate.triangles)
    before = path.read_bytes()
    with pytest.raises(RuntimeError, match="disk"):
        pm._write_atomically(path, lambda name: (name.write_text("half"), (_ for _ in ()).throw(RuntimeError("disk"))))
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["a.stl"]


def test_unreadable_surfaces_are_named(tmp_path):
    """Missing, cut and foreign files raise an error that names the file."""
    with pytest.raises(FileNotFoundError, match=r"none\.vtu"):
        pm.read_surface(tmp_path / "none.vtu")
    pm.write_surface(tmp_path / "a.vtu", labelled_surface())
    cut = tmp_path / "cut.vtu"
    cut.write_bytes((tmp_path / "a.vtu").read_bytes()[:500])
    with pytest.raises(ValueError, match=r"cut\.vtu"):
        pm.read_surface(cut)
    with pytest.raises(ValueError, match=r"written as \.vtu"):
        pm.write_surface(tmp_path / "a.vtk", labelled_surface())


def test_stl_keeps_order_and_digits(tmp_path):
    """Facet i of the STL is triangle i, to nine significant digits; the count is the number of triangles."""
    ball = sphere(0.1, 2)
    pm.write_stl(tmp_path / "a.stl", ball.points, ball.triangles)
    facets = stl_facets(tmp_path / "a.stl")
    assert len(facets) == len(ball.triangles)
    assert facets == pytest.approx(ball.points[ball.triangles], rel=STL_DIGITS, abs=1e-300)


def test_obtuse_corners_come_last(tmp_path):
    """A facet begins after its obtuse corner, wherever that stood, with the same normal; others stay as they are."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [-0.5, 1, 0], [0.5, 1, 0], [0, 1, 0]])
    obtuse, others = np.array([[0, 1, 2], [1, 2, 0], [2, 0, 1]]), np.array([[0, 1, 3], [0, 1, 4]])  # acute and right
    assert pm.obtuse_last(points, obtuse).tolist() == [[1, 2, 0]] * 3
    assert pm.obtuse_last(points, others).tolist() == others.tolist()
    pm.write_stl(tmp_path / "a.stl", points, np.concatenate([obtuse, others]))
    facets = stl_facets(tmp_path / "a.stl")
    assert facets[0].tolist() == points[[1, 2, 0]].tolist() and facets[3].tolist() == points[[0, 1, 3]].tolist()


def test_stl_in_blocks_is_the_same_file(tmp_path, monkeypatch):
    """The block size of the writer is no part of the result."""
    ball = sphere(0.1, 1)
    pm.write_stl(tmp_path / "a.stl", ball.points, ball.triangles)
    monkeypatch.setattr(pm, "STL_FACETS_PER_BLOCK", 7)
    pm.write_stl(tmp_path / "b.stl", ball.points, ball.triangles)
    assert (tmp_path / "a.stl").read_bytes() == (tmp_path / "b.stl").read_bytes()


def test_stl_refuses_a_facet_without_area(tmp_path):
    """A facet without area, which the solver would drop and so shift ids, is refused; nothing written."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]])
    with pytest.raises(ValueError, match="facet 1 has no area"):
        pm.write_stl(tmp_path / "a.stl", points, np.array([[0, 1, 2], [0, 1, 3]]))
    assert list(tmp_path.iterdir()) == []


def test_geometry_of_columns_is_that_of_rows():
    """Arithmetic on whole columns gives, bit for bit, what numpy's own functions give for rows."""
    random = np.random.default_rng(20220317)
    points, triangles = random.normal(size=(50, 3)), random.integers(0, 50, (200, 3))
    corners = points[triangles]
    spokes = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    vectors = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sine = np.linalg.norm(np.cross(*spokes), axis=2)
    angles = np.degrees(np.arctan2(sine, (spokes[0] * spokes[1]).sum(axis=2)))
    assert np.array_equal(pm.area_vectors(points, triangles), vectors)
    assert np.array_equal(pm.areas(points, triangles), np.linalg.norm(vectors, axis=1))
    assert np.array_equal(pm.edge_lengths_per_triangle(points, triangles), np.linalg.norm(spokes[0], axis=2))
    assert np.array_equal(pm.smallest_angles(points, triangles), angles.min(axis=1))
    assert np.array_equal(pm.centroids(points, triangles), corners.mean(axis=1))


@pytest.mark.parametrize("seed", range(8))
def test_boundary_edges_are_those_without_their_reverse(seed):
    """In the order of the triangles, also where these are turned, doubled, meet in threes or have a node twice."""
    triangles = np.random.default_rng(seed).integers(0, 4 + 2 * seed, (5 * seed, 3))
    edges = pm.directed_edges(triangles)
    there = {tuple(edge) for edge in edges.tolist()}
    expected = [edge for edge in edges.tolist() if tuple(edge[::-1]) not in there]
    assert pm.boundary_edges(triangles).tolist() == expected
