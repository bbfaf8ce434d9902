"""Distances to the surface before remeshing: by part of its faces and from memory they are those by all faces."""

import numpy as np
import pytest

from bulkwear.meshes.plate import closed_box
from bulkwear.postproc.mesh import centroids
from bulkwear.postproc.wear import old_surface
from bulkwear.postproc.wear.known_distances import KnownDistances
from bulkwear.postproc.wear.old_surface import OldSurface
from bulkwear.postproc.wear.remesh_kernels import probes

SIDE, HEIGHT, ELEMENT = 60e-3, 3e-3, 2e-3  # m
CORNER = 8e-3  # m: faces that are nearer to the origin lie in a corner of the box
SAME = 1e-12  # m: rounding where two faces are equally close


@pytest.fixture(scope="module")
def box():
    """A flat box: under its top lies, 3 mm away, another sheet."""
    return closed_box(SIDE, SIDE, HEIGHT, ELEMENT)


@pytest.fixture(scope="module")
def corner(box):
    """Mask of the faces in a corner of the box."""
    middle = centroids(box.points, box.triangles)
    return np.linalg.norm(middle - box.points.min(axis=0), axis=1) < CORNER


def random_places(box, count: int) -> np.ndarray:
    """Places (k, 3) m in and round the box, up to half of its side away."""
    low, high = box.points.min(axis=0) - SIDE / 2, box.points.max(axis=0) + SIDE / 2
    return np.random.default_rng(4).uniform(low, high, (count, 3))


def test_a_part_of_the_faces_tells_the_distances_to_all(box, corner, monkeypatch):
    """Near the part, beyond its box, and where a face that is not in it is closer."""
    whole, part = OldSurface(box.points, box.triangles), OldSurface(box.points, box.triangles, corner)
    asked, nearest = [], old_surface._Part.nearest

    def counted(*given):
        asked.append(nearest(*given))
        return asked[-1]

    monkeypatch.setattr(old_surface._Part, "nearest", counted)
    places = np.concatenate([probes(box.points, box.triangles)[0], random_places(box, 2000)])
    (distance, _, point), (expected, _, at) = part.closest(places), whole.closest(places)
    beyond = asked[0][-1]
    assert 0 < beyond.sum() < len(places)  # both ways are gone
    assert np.abs(distance - expected).max() < SAME
    assert np.abs(point - at).max() < SAME


def test_a_part_with_most_faces_is_not_cut_out(box):
    """Then all faces are sorted at once."""
    everywhere = np.ones(len(box.triangles), dtype=bool)
    assert OldSurface(box.points, box.triangles, everywhere)._part is None


def test_what_is_tangled_bounds_nothing_whatever_was_asked_before(box):
    """Surfaces with other tangled faces share the distances that are known, not what counts as outside."""
    old = OldSurface(box.points, box.triangles).without(np.zeros(len(box.triangles), dtype=bool))
    above, size = box.points + np.array([0.0, 0.0, 1e-3]), np.full(len(box.points), ELEMENT)
    top = box.triangles[centroids(box.points, box.triangles)[:, 2] > box.points[:, 2].max() - SAME]
    assert old.range_over_faces(above, top, size)[:, 1] == pytest.approx(1e-3 / ELEMENT)
    tangled = old.without(np.ones(len(box.triangles), dtype=bool))
    assert tangled.range_over_faces(above, top, size)[:, 1].max() == 0.0
    assert old.range_over_faces(above, top, size)[:, 1] == pytest.approx(1e-3 / ELEMENT)


@pytest.mark.parametrize("faces", [1, 40, 10_000], ids="a table for {} faces".format)
def test_known_distances_are_those_measured(box, faces):
    """Also where a table is too small for the places, and each takes the row of another."""
    surface, measured = OldSurface(box.points, box.triangles), []

    def measure(places):
        measured.append(len(places))
        return surface.closest(places)[:2]

    known, random = KnownDistances(faces, measure), np.random.default_rng(7)
    places = random_places(box, 3000)
    for _ in range(4):
        some = places[random.integers(len(places), size=2000)]
        distance, face = known.at(some)
        expected, closest, _ = surface.closest(some)
        assert np.array_equal(distance, expected)
        assert np.array_equal(face, closest)
    known.at(places[:1])
    before = len(measured)
    known.at(places[:1])
    assert len(measured) == before
