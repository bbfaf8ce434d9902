"""What is refused: the sentence has file, part, place and what is allowed; the error has the faces of the picture."""

import numpy as np
import pytest

from bulkwear.meshes.own import refine
from bulkwear.meshes.own.mesh import own_mesh
from bulkwear.meshes.own.refine import Ball, Box, NearPlaces
from bulkwear.meshes.own.solids import RefusedMeshError
from tests.support.own_solids import MM, box, write_ascii

SIDE = 100.0  # mm
NEAR = 1e-9  # m


def refused(tmp_path, facets, said, **options):
    """The error for facets (m, 3, 3) mm, which says that, and names file, part, both units and what is allowed."""
    facets = np.asarray(facets, dtype=float)
    write_ascii(tmp_path / "a.stl", {"wall": (facets.reshape(-1, 3), np.arange(3 * len(facets)).reshape(-1, 3))})
    with pytest.raises(
        RefusedMeshError, match=rf"a\.stl: part 'wall' {said}.* m, \(.*\) mm in the file; allowed "
    ) as error:
        own_mesh(tmp_path / "a.stl", "mm", **options)
    fault = error.value
    assert len(fault.faces) > 0
    assert fault.faces.max() < len(fault.surface.triangles)
    near = fault.surface.points[fault.surface.triangles[fault.faces]].reshape(-1, 3)
    assert (near.min(axis=0) - NEAR <= fault.place).all()
    assert (fault.place <= near.max(axis=0) + NEAR).all()
    return fault


def cube_facets(corner=(0.0, 0.0, 0.0), size=SIDE):
    """Facets (12, 3, 3) mm of a cube."""
    points, triangles = box((size, size, size), corner)
    return points[triangles]


def test_a_part_that_cuts_itself(tmp_path):
    """Two cubes in one solid that overlap."""
    facets = np.concatenate([cube_facets(), cube_facets((50.0, 30.0, 20.0))])
    fault = refused(tmp_path, facets, r"cuts itself, faces pass through one another, \d+ pairs")
    low, high = np.array([50.0, 30.0, 20.0]) * MM, np.full(3, SIDE) * MM
    assert (fault.place > low - 0.1).all()
    assert (fault.place < high + 0.1).all()


def test_a_part_that_covers_itself(tmp_path):
    """A plate over half of another one in the same plane, in one solid."""
    plate = np.array([[[0, 0, 0], [SIDE, 0, 0], [0, SIDE, 0]]], dtype=float)
    both = np.concatenate([plate, plate + np.array([20.0, 10, 0])])
    fault = refused(tmp_path, both, "covers itself, faces lie on one another, 1 pairs")
    assert sorted(fault.faces) == [0, 1]
    assert fault.place[2] == pytest.approx(0.0, abs=NEAR)


def test_three_faces_at_an_edge(tmp_path):
    """A rib that is one sheet with the plate below it."""
    foot, ends = [0.0, 0.0, 0.0], [SIDE, 0.0, 0.0]
    sheets = [[foot, ends, tip] for tip in ([50.0, 60.0, 0.0], [50.0, -60.0, 0.0], [50.0, 0.0, 60.0])]
    fault = refused(tmp_path, sheets, r"has 1 edges with three or more faces \(3 at most\)")
    assert fault.place == pytest.approx([0.05, 0.0, 0.0], abs=NEAR)
    assert len(fault.faces) == 3


def test_a_strip_with_one_side(tmp_path):
    """Moebius' strip has no winding."""
    angle = np.linspace(0.0, 2.0 * np.pi, 25)
    middle = SIDE * np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    across = 20.0 * np.column_stack(
        [np.cos(angle) * np.cos(angle / 2.0), np.sin(angle) * np.cos(angle / 2.0), np.sin(angle / 2.0)]
    )
    left, right = middle + across, middle - across
    quads = [[left[:-1], right[:-1], right[1:]], [left[:-1], right[1:], left[1:]]]
    facets = np.concatenate([np.stack(each, axis=1) for each in quads])
    fault = refused(tmp_path, facets, "has a piece with one side only, like a Moebius strip")
    assert len(fault.faces) == 2  # whose windings do not fit at the edge between them


def test_a_hairline_gap(tmp_path):
    """A node that misses an edge by a few tolerances is no gap that anybody drew; a larger tolerance closes it."""
    facets = cube_facets()
    edge = facets[0][:2]
    middle = edge.mean(axis=0) + np.array([0, 0, 6e-4])  # mm; the weld tolerance is 1.7e-4 mm
    pieces = [[edge[0], middle, facets[0][2]], [middle, edge[1], facets[0][2]]]
    whole = np.concatenate([pieces, facets[1:]])
    fault = refused(tmp_path, whole, r"has \d nodes beside open edges that they miss, the nearest by 0\.0006 mm")
    assert fault.place == pytest.approx(MM * middle, abs=NEAR)
    assert own_mesh(tmp_path / "a.stl", "mm", weld_m=1e-6).parts[0].closed


def test_a_face_too_sharp_for_the_solver(tmp_path):
    """LIGGGHTS refuses angles below 0.256 degrees; a needle that a target edge cannot mend, because both its long edges
    are creases, is refused before."""
    facets = [[[0, 0, 0], [SIDE, 0, 0], [SIDE, 0.3, 0]]]
    fault = refused(tmp_path, facets, r"has 1 faces that are too sharp for the solver, the sharpest of 0\.17 degrees")
    assert fault.faces.tolist() == [0]


def test_a_part_of_no_width(tmp_path):
    """What is left of it is nothing."""
    facets = np.array([[[0, 0, 0], [SIDE, 0, 0], [50, 0, 0]]], dtype=float)
    write_ascii(tmp_path / "a.stl", {"wire": (facets[0], np.array([[0, 1, 2]]))})
    with pytest.raises(ValueError, match=r"a\.stl: part 'wire' has no triangle wider than"):
        own_mesh(tmp_path / "a.stl", "mm")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"edges": {"floor": 0.01}}, r"edges name the part 'floor', allowed are wall and '\*'"),
        ({"edges": {"wall": 0.01, "*": -1.0}}, "target edge of all parts is -1 m, allowed is a finite length above 0"),
        ({"edges": {"wall": np.inf}}, "target edge of 'wall' is inf m, allowed is a finite length above 0"),
        ({"edges": np.nan}, "target edge of all parts is nan m"),
        ({"edges": 1e-6}, r"a\.stl: .* edge of part 'wall' is 1e-06 m, allowed are 1\.73205e-06 m or more, 10 weld"),
        ({"fine": [Ball((0, 0, 0), 0.01, 1e-6)]}, r"a\.stl: .* edge of ball 1 is 1e-06 m, allowed are 1\.73205e-06"),
        ({"edges": 0.01, "weld_m": 0.002}, "is 0.002 m, allowed is above 0 and up to 0.001 m, 10 % of the target edge"),
        ({"weld_m": 0.002}, "is 0.002 m, allowed is above 0 and up to 0.00173205 m, 1 % of the largest extent"),
        ({"weld_m": 0.0}, "weld tolerance is 0 m, allowed is a finite length above 0"),
        ({"weld_m": np.inf}, "weld tolerance is inf m, allowed is a finite length above 0"),
        ({"smallest_angle_deg": np.nan}, "smallest angle is nan degrees, allowed are 0 to 45"),
        ({"smallest_angle_deg": -1.0}, "smallest angle is -1 degrees, allowed are 0 to 45"),
        ({"smallest_angle_deg": 46.0}, "smallest angle is 46 degrees, allowed are 0 to 45"),
        ({"fine": [Ball((0, np.nan, 0), 0.01, 0.01)]}, r"the centre of ball 1 is \(0, nan, 0\) m, allowed are finite"),
        ({"fine": [Ball((0, 0, 0), np.inf, 0.01)]}, "the radius of ball 1 is inf m, allowed is a finite length"),
        ({"fine": [np.ravel, Ball((0, 0, 0), 0.01, 0.0)]}, "the target edge of ball 2 is 0 m, allowed is a finite"),
        ({"fine": [NearPlaces(np.zeros((1, 3)), 0.0, 0.01)]}, "the radius of nearplaces 1 is 0 m, allowed is a finite"),
        ({"fine": [Box((0, 0, 2), (1, 1, 1), 0.01)]}, "the corners of box 1 are .* allowed are finite numbers, the l"),
        ({"fine": [lambda places: np.zeros(len(places))]}, "a region gives target edges .* allowed are"),
    ],
)
def test_choices_that_make_no_sense(tmp_path, options, said):
    """One sentence, before anything long is done."""
    facets = cube_facets()
    write_ascii(tmp_path / "a.stl", {"wall": (facets.reshape(-1, 3), np.arange(36).reshape(-1, 3))})
    with pytest.raises(ValueError, match=said):
        own_mesh(tmp_path / "a.stl", "mm", **options)


@pytest.fixture
def cube(tmp_path):
    """The path of an STL with a cube."""
    facets = cube_facets()
    write_ascii(tmp_path / "a.stl", {"wall": (facets.reshape(-1, 3), np.arange(36).reshape(-1, 3))})
    return tmp_path / "a.stl"


def test_an_edge_for_too_many_triangles(cube, monkeypatch):
    """Area over that of an equilateral triangle, before any edge is halved; the smallest edge that is told is taken."""
    monkeypatch.setattr(refine, "_one_round", None)
    count, least = 6 * 0.1**2 / (np.sqrt(3.0) / 4.0 * 1e-4**2), np.sqrt(6 * 0.1**2 / (np.sqrt(3.0) / 4.0 * 4e6))
    said = rf"a\.stl: the target edges give about {count:.2g} triangles, most of them in part 'wall' with 0\.0001 m, "
    with pytest.raises(
        ValueError, match=f"{said}allowed are 4000000, which an edge of {least:.3g} m gives".replace("+", r"\+")
    ):
        own_mesh(cube, "mm", 1e-4)
    with pytest.raises(TypeError, match="not callable"):
        own_mesh(cube, "mm", 1.01 * least)


def test_a_surface_that_is_fine_enough_is_not_too_large(cube, monkeypatch):
    """Triangles that stay as they are count for nothing."""
    monkeypatch.setattr(refine, "MOST_TRIANGLES", 20)
    assert own_mesh(cube, "mm", 0.1).parts[0].triangles == 12


def test_more_triangles_than_a_solver_takes(cube, monkeypatch):
    """A region whose target is far too small ends in a sentence, not in a full memory."""
    monkeypatch.setattr(refine, "MOST_TRIANGLES", 5_000)
    with pytest.raises(ValueError, match=r"a\.stl: the target edges give more than 5000 triangles, allowed are fewer"):
        own_mesh(cube, "mm", fine=[Ball((0, 0, 0), 0.1, 1e-4)])
