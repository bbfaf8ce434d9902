"""Displacement schemes: the registry and the rule of single triangles."""

import numpy as np
import pytest

from bulkwear.meshes.disc import track_disc
from bulkwear.meshes.plate import flat_plate, sphere
from bulkwear.postproc.mesh import areas, enclosed_volume, volume_above_plane
from bulkwear.postproc.wear.directions import rim_directions
from bulkwear.postproc.wear.displacement import StepTooLargeError, displace
from bulkwear.postproc.wear.schemes import SCHEMES, centroid_path_volume, per_triangle, scheme_of
from bulkwear.postproc.wear.update import wear_update

ROUNDING = 1e-12  # relative: sums over a few thousand numbers
GEOMETRY = 1e-9  # relative: volumes of bodies are differences of numbers some 1e4 times larger
SIX = 6.0  # triangles at a node of a regular mesh, each moves it
# of the two limits on an unstructured mesh: 3 and 6 are those of a regular one, seen 3.24 and 6.15
IRREGULAR = 0.1


def regular_plate(cells=20, edge=1e-3):
    """Plane of right-angled triangles with all diagonals alike, six at each inner node: points, triangles."""
    i, j = np.meshgrid(np.arange(cells + 1), np.arange(cells + 1), indexing="ij")
    points = np.column_stack((i.ravel() * edge, j.ravel() * edge, np.zeros(i.size)))
    corner = (i[:-1, :-1] * (cells + 1) + j[:-1, :-1]).ravel()
    a, b, c, d = corner, corner + cells + 1, corner + cells + 2, corner + 1
    return points, np.concatenate((np.column_stack((a, b, c)), np.column_stack((a, c, d))))


def test_registry_names_the_schemes():
    """Both schemes are found by name; another name is refused with the allowed ones."""
    assert scheme_of("conserving") is displace and scheme_of("per_triangle") is per_triangle
    assert set(SCHEMES) == {"conserving", "per_triangle"}
    with pytest.raises(ValueError, match="scheme 'thesis' is unknown, allowed are: conserving, per_triangle"):
        scheme_of("thesis")


def test_one_triangle_moves_its_nodes_by_its_depth():
    """Yan 2022, Eq 5.4-5.7: the three nodes go V / A along the normal; the dip holds six times V."""
    points, triangles = regular_plate()
    volume = np.zeros(len(triangles))
    volume[210] = 1e-13
    result = per_triangle(points, triangles, volume)
    depth = 1e-13 / 0.5e-6
    nodes = triangles[210]
    np.testing.assert_allclose(result.points[nodes, 2], -depth, rtol=ROUNDING)
    others = np.setdiff1d(np.arange(len(points)), nodes)
    assert result.points[others].tobytes() == points[others].tobytes()
    assert -volume_above_plane(result.points, triangles) == pytest.approx(SIX * 1e-13, rel=GEOMETRY)
    assert result.applied_volume.sum() == pytest.approx(SIX * 1e-13, rel=GEOMETRY)


def test_even_wear_goes_six_times_too_deep():
    """Every inner node of a regular plate is moved by six triangles: six times the depth V / A."""
    points, triangles = regular_plate()
    depth = 1e-6
    result = per_triangle(points, triangles, depth * areas(points, triangles))
    inner = (points[:, :2] > 0.5e-3).all(axis=1) & (points[:, :2] < 19.5e-3).all(axis=1)
    np.testing.assert_allclose(result.step[inner], SIX * depth, rtol=ROUNDING)


def test_what_it_removes_is_told():
    """applied is what the body lost; the record's excess is what the wear law never asked for."""
    mesh = sphere(0.05, 3)
    volume = 1e-6 * areas(mesh.points, mesh.triangles)
    result = per_triangle(mesh.points, mesh.triangles, volume)
    lost = enclosed_volume(mesh.points, mesh.triangles) - enclosed_volume(result.points, mesh.triangles)
    assert result.applied_volume.sum() == pytest.approx(lost, rel=1e-7)  # the loss is 1e-4 of the body
    worn, record = wear_update(mesh, volume, wall=None, scheme="per_triangle")
    np.testing.assert_array_equal(worn.points, result.points)
    assert record["excess_volume_m3"] == pytest.approx(lost - volume.sum(), rel=1e-7)
    assert record["excess_volume_m3"] > 4.0 * volume.sum()
    _, ours = wear_update(mesh, volume, wall=None)
    assert abs(ours["excess_volume_m3"]) < GEOMETRY * volume.sum()


def test_capped_steps_are_carried_as_wear():
    """At a third of the step a third of the wear is taken up, two thirds are carried; later updates release them."""
    points, triangles = regular_plate()
    volume = np.zeros(len(triangles))
    volume[210] = 1e-13
    nodes, depth = triangles[210], 1e-13 / 0.5e-6
    first = per_triangle(points, triangles, volume, None, np.full(len(points), depth / 3.0))
    np.testing.assert_allclose(first.step[nodes], depth / 3.0, rtol=ROUNDING)
    np.testing.assert_allclose(first.carried_volume[nodes], 2.0 / 9.0 * 1e-13, rtol=ROUNDING)
    second = per_triangle(first.points, triangles, 0.0 * volume, first.carried_volume)
    assert not second.carried_volume.any() and (second.step[nodes] > 0.0).all()


def test_no_motion_where_none_is_allowed():
    """A limit of zero keeps every bit and carries all; without load nothing moves either."""
    mesh = flat_plate(0.01, 0.01, 1e-3)
    volume = 1e-6 * areas(mesh.points, mesh.triangles)
    still = per_triangle(mesh.points, mesh.triangles, volume, step_limit=np.zeros(len(mesh.points)))
    assert still.points.tobytes() == mesh.points.tobytes()
    assert still.carried_volume.sum() == pytest.approx(volume.sum(), rel=ROUNDING)
    assert per_triangle(mesh.points, mesh.triangles, 0.0 * volume).points.tobytes() == mesh.points.tobytes()


def test_rim_slides_down_the_wall():
    """Nodes with a direction of their own move along it only, by the part of the motion that points there."""
    mesh = sphere(0.05, 2)
    worn = mesh.points[mesh.triangles].mean(axis=1)[:, 2] > 0.0
    rim = rim_directions(mesh.points, mesh.triangles, worn)
    volume = 1e-5 * areas(mesh.points, mesh.triangles)
    result = per_triangle(mesh.points, mesh.triangles, volume, directions=rim, worn=worn)
    at_rim = np.isfinite(rim).all(axis=1)
    np.testing.assert_array_equal(result.points[at_rim, :2], mesh.points[at_rim, :2])
    below = np.setdiff1d(np.arange(len(mesh.points)), mesh.triangles[worn])
    assert result.points[below].tobytes() == mesh.points[below].tobytes()


def test_turned_faces_are_refused():
    """A step that turns faces over is an error with the node, and so is wear on a face without area."""
    mesh = sphere(0.05, 2)
    volume = np.zeros(len(mesh.triangles))
    volume[10] = 1e-5
    with pytest.raises(StepTooLargeError, match=r"faces turn over at \d+ nodes, first at node \d+"):
        per_triangle(mesh.points, mesh.triangles, volume)
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    with pytest.raises(ValueError, match="without area is worn"):
        per_triangle(points, np.array([[0, 1, 2]]), np.array([1.0]))


def test_volume_by_centroid_paths():
    """Yan 2022, Eq 5.8-5.10: area times path; right for a plate going down, not for one sliding in its plane."""
    mesh = flat_plate(0.02, 0.01, 1e-3)
    down, aside = (mesh.points + shift for shift in ((0.0, 0.0, -1e-5), (1e-5, 0.0, 0.0)))
    for moved in (down, aside):
        assert centroid_path_volume(mesh.points, moved, mesh.triangles) == pytest.approx(2e-4 * 1e-5, rel=GEOMETRY)


def test_centroid_paths_of_the_triangles_in_contact():
    """One triangle worn: six times Archard's volume over all that move, once over the one in contact.

    A row of squares worn alike: an inner triangle of the row is moved by its own depth and by those of its neighbours
    there, 2/3 by each of two across an edge and 1/3 by each of two at a corner: three times Archard's volume.
    """
    points, triangles = regular_plate()
    volume = np.zeros(len(triangles))
    volume[210] = 1e-13
    moved = per_triangle(points, triangles, volume).points
    assert centroid_path_volume(points, moved, triangles) == pytest.approx(SIX * 1e-13, rel=GEOMETRY)
    assert centroid_path_volume(points, moved, triangles, volume > 0.0) == pytest.approx(1e-13, rel=GEOMETRY)
    middle = points[triangles].mean(axis=1)
    row = (middle[:, 1] > 10e-3) & (middle[:, 1] < 11e-3)
    moved = per_triangle(points, triangles, 1e-13 * row).points
    inner = row & (middle[:, 0] > 2e-3) & (middle[:, 0] < 18e-3)
    expected = 3.0 * 1e-13 * np.count_nonzero(inner)
    assert centroid_path_volume(points, moved, triangles, inner) == pytest.approx(expected, rel=GEOMETRY)


def track_triangles(mesh, track_radius, arc):
    """Triangles of a flat disc that a circle (m) passes through, between 0 and an angle (degrees)."""
    corners = mesh.points[mesh.triangles]
    radius = np.hypot(corners[:, :, 0], corners[:, :, 1])
    angle = np.degrees(np.arctan2(*corners.mean(axis=1)[:, 1::-1].T))
    passed = (radius.min(axis=1) < track_radius) & (radius.max(axis=1) > track_radius)
    return np.flatnonzero(passed & (angle > 0.0) & (angle < arc))


def updates_by_centroid_paths(mesh, updates, volume):
    """Eq 5.9 over the touched and over all triangles, over the law's volume: one wear update after the other.

    updates: (k,) triangles of each update, every one of which wears by `volume` (m3)
    """
    points, sums = mesh.points, np.zeros(2)
    for worn in updates:
        volumes = np.zeros(len(mesh.triangles))
        volumes[worn] = volume
        moved = per_triangle(points, mesh.triangles, volumes).points
        sums += [centroid_path_volume(points, moved, mesh.triangles, *counted) for counted in ((volumes > 0.0,), ())]
        points = moved
    return sums / (volume * sum(np.size(worn) for worn in updates))


def test_centroid_paths_depend_on_the_length_of_an_update():
    """Flat disc, every triangle of a track worn alike: Eq 5.9 over touched ones has two limits, over all ones none.

    One triangle per update (Yan 2022, Eq 5.3 to 5.9, step by step): exactly the law's volume. All triangles of an arc
    of 30 degrees in one update: about three times. Over all triangles: about six times, either way.
    """
    mesh = track_disc(22e-3, 20e-3, 24e-3, 0.2e-3, 0.4e-3)
    few, many = (track_triangles(mesh, 22e-3, arc) for arc in (5.0, 30.0))
    assert len(many) > 100
    touched, every = updates_by_centroid_paths(mesh, list(few), 1e-18)
    assert touched == pytest.approx(1.0, rel=GEOMETRY)
    assert every == pytest.approx(SIX, rel=IRREGULAR)
    touched, every = updates_by_centroid_paths(mesh, [many], 1e-18)
    assert touched == pytest.approx(SIX / 2.0, rel=IRREGULAR)
    assert every == pytest.approx(SIX, rel=IRREGULAR)
