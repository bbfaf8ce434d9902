"""Lifters of drums that are drawn with known heights and face angles are found with them, however the drum lies."""

from itertools import pairwise

import numpy as np
import pytest

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.wear.lifter_profile import LEAST_HEIGHT, lifter_profile
from tests.support.shapes import moved_rigidly, sheet, welded

RADIUS, LENGTH, LIFTERS = 2.0, 0.2, 24  # m, m, -
HEIGHT, WIDTH = 0.065, 0.1  # m, of a lifter, and half way up it
LEADING, TRAILING = 14.0, 35.0  # degrees
AXIS, ORIGIN = (0.0, 1.0, 0.0), (0.0, 0.0, 0.0)
EXACT_M = 1e-6  # m: a corner of the shell's facets lies between two steps of the profile, 0.35 mm apart
EXACT_DEG = 0.02  # degrees: feet stand on a round shell, so the middle is not just half way between equal heights
HIDDEN_DEG = np.degrees(0.5 * WIDTH / RADIUS)  # the crest hides a face from the axis that stands steeper than this
STEP_DEG = 0.6  # degrees: such a face is told as wide as one step of the profile besides, 0.35 of 39 mm
FACET_DEG = 0.2  # degrees: plates in few facets lie 0.8 mm off the round shell, of lifters 26 mm high
NOISE_M, NOISE_DEG = 0.002, 2.5  # m, degrees: nodes are moved by 0.5 mm, and a height is between two extremes of them


def corners_of(height, leading, trailing, width=WIDTH):
    """(ahead, out) m of foot, crest, crest and foot of a lifter whose faces stand at angles (degrees)."""
    found = []
    for way, degrees in ((-1.0, trailing), (1.0, leading)):
        slope = np.tan(np.radians(degrees))
        crest = 0.5 * width - 0.5 * height * slope
        foot = crest
        for _ in range(50):  # it stands on the shell
            foot = crest + slope * (np.sqrt(RADIUS**2 - foot**2) - (RADIUS - height))
        pair = [(way * foot, np.sqrt(RADIUS**2 - foot**2)), (way * crest, RADIUS - height)]
        found += pair if way < 0.0 else pair[::-1]
    return np.array(found)


def outline(heights, leading, trailing, cells, width=WIDTH):
    """(ahead, out) m of a closed outline in the sense of rotation: trapezoids, and a round shell between them."""
    pieces, pitch = [], 2.0 * np.pi / len(heights)
    for number, height in enumerate(heights):
        corners = corners_of(height, leading, trailing, width)
        lines = [a + np.linspace(0.0, 1.0, cells, endpoint=False)[:, None] * (b - a) for a, b in pairwise(corners)]
        ahead, behind = np.arctan2(*corners[3]), np.arctan2(*corners[0]) + pitch
        angle = np.linspace(ahead, behind, 4 * cells, endpoint=False)
        local = np.concatenate([*lines, RADIUS * np.column_stack([np.sin(angle), np.cos(angle)])])
        c, s = np.cos(number * pitch), np.sin(number * pitch)
        pieces.append(local @ np.array([[c, -s], [s, c]]))
    return np.concatenate(pieces)


def extruded(ring, cells):
    """A drum about +y, turning from z to x, of an outline (k, 2) (x, z) m."""
    closed = np.concatenate([ring, ring[:1]])
    along = np.linspace(-0.5, 0.5, cells + 1) * LENGTH
    number = np.arange(len(closed))
    return welded(sheet(number, along, lambda k, y: (closed[k.astype(int), 0], y, closed[k.astype(int), 1])))


def drum(heights=(HEIGHT,) * LIFTERS, leading=LEADING, trailing=TRAILING, cells=4, width=WIDTH):
    return extruded(outline(heights, leading, trailing, cells, width), cells)


def smooth(facets=60, radius=RADIUS, oval=0.0):
    """A drum without lifters; oval: m by which it is wider along x."""
    angle = np.linspace(0.0, 2.0 * np.pi, facets, endpoint=False)
    return extruded(np.column_stack([(radius + oval) * np.sin(angle), radius * np.cos(angle)]), 4)


def found_in(mesh, point=ORIGIN, axis=AXIS):
    return lifter_profile(mesh.points, mesh.triangles, np.array(point), np.array(axis))


def assert_lifters(found, heights=(HEIGHT,) * LIFTERS, leading=LEADING, trailing=TRAILING, tolerance=EXACT_DEG):
    assert len(found) == len(heights)
    np.testing.assert_allclose(np.sort(found.height_m), np.sort(heights), atol=EXACT_M)
    np.testing.assert_allclose(found.leading_face_deg, leading, atol=tolerance)
    np.testing.assert_allclose(found.trailing_face_deg, trailing, atol=tolerance)


@pytest.mark.parametrize("cells", [1, 4, 9])
def test_heights_and_faces_of_trapezoids(cells):
    """As drawn, whatever the elements are."""
    assert_lifters(found_in(drum(cells=cells)))


@pytest.mark.parametrize("height", [HEIGHT, 0.5 * HEIGHT, 0.2 * HEIGHT])
def test_lifters_of_any_height(height):
    """Half of the height is found as half, with the same faces."""
    assert_lifters(found_in(drum((height,) * LIFTERS)), (height,) * LIFTERS)


@pytest.mark.parametrize(("number", "width"), [(12, 0.02), (8, 0.02), (8, 0.01), (4, 0.01), (3, 0.004)])
def test_narrow_lifters(number, width):
    """Bars that take 2 % of the turn to 0.1 % are found as wide ones are."""
    heights = (HEIGHT,) * number
    assert_lifters(found_in(drum(heights, 2.0, 2.0, width=width)), heights, 2.0, 2.0)


def test_narrow_lifters_on_coarse_facets():
    """Plates of 36 facets vary by 0.4 % of the radius, and are no lifters where there are."""
    ring = outline((HEIGHT,) * 9, 2.0, 2.0, 1, width=0.01)
    found = found_in(extruded(ring, 4))
    assert len(found) == 9
    assert (found.height_m > 0.9 * HEIGHT).all()


def test_one_higher_bar_hides_no_narrow_lifters():
    """Though they are below half of its height: crests are where several come to."""
    heights = [0.4 * HEIGHT] * 6 + [HEIGHT]
    assert_lifters(found_in(drum(heights, 2.0, 2.0, width=0.01)), heights, 2.0, 2.0, FACET_DEG)


@pytest.mark.parametrize(("leading", "trailing"), [(5.0, 5.0), (30.0, 12.0), (20.0, 45.0)])
def test_faces_at_any_angle(leading, trailing):
    assert_lifters(found_in(drum(leading=leading, trailing=trailing)), leading=leading, trailing=trailing)


def test_upright_faces():
    """Their feet are out of sight from the axis: they lean as the ray past the crest, to a step of the profile."""
    assert_lifters(
        found_in(drum(leading=0.0, trailing=0.0)), leading=HIDDEN_DEG, trailing=HIDDEN_DEG, tolerance=STEP_DEG
    )


def test_faces_along_rays():
    """A face that lies on a ray from the axis has both its ends there, and leans as that ray."""
    half, pitch = np.radians(1.5), 2.0 * np.pi / LIFTERS
    turn = np.array([-half, -half, 0.0, half, half, 0.25 * pitch, 0.5 * pitch, 0.75 * pitch])
    angle = (np.arange(LIFTERS)[:, None] * pitch + turn).ravel()
    radius = np.tile(RADIUS - HEIGHT * np.array([0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0]), LIFTERS)
    found = found_in(extruded(radius[:, None] * np.column_stack([np.sin(angle), np.cos(angle)]), 3))
    crest = (RADIUS - HEIGHT) * np.cos(0.5 * half)  # of two chords
    assert_lifters(found, [RADIUS - crest] * LIFTERS, np.degrees(half), np.degrees(half), STEP_DEG)


def test_reversed_rotation_swaps_the_faces():
    """What leads one way round trails the other way."""
    assert_lifters(found_in(drum(), axis=(0.0, -3.0, 0.0)), leading=TRAILING, trailing=LEADING)


@pytest.mark.parametrize("angles", [(0.0, 0.3, 0.0), (0.0, 0.0, 0.5 * np.pi), (0.4, -1.1, 2.0)])
def test_wherever_the_drum_lies(angles):
    """Turned about its axis, about others, and moved."""
    along = moved_rigidly(SurfaceMesh(np.array([AXIS]), np.zeros((0, 3), dtype=int)), angles, ORIGIN).points[0]
    by = np.array([0.3, -2.0, 1.5])
    assert_lifters(found_in(moved_rigidly(drum(), angles, by), point=by + 0.7 * along, axis=2.0 * along))


def test_with_and_without_a_back():
    """The inside of a liner that is a body counts alone, whichever way its faces look."""
    inside = drum()
    both = welded(SurfaceMesh(inside.points, inside.triangles[:, ::-1]), smooth(90, RADIUS + 0.05))
    assert_lifters(found_in(both))


def test_lifters_stand_in_their_order():
    """In the sense of rotation: of two neighbours the higher one comes first in a run round."""
    heights = np.linspace(HEIGHT, 0.7 * HEIGHT, LIFTERS)
    found = found_in(drum(heights))
    assert_lifters(found, heights)
    first = int(found.height_m.argmax())
    np.testing.assert_allclose(np.roll(found.height_m, -first), heights, atol=EXACT_M)


def test_worn_out_lifters_are_not_found():
    """Below half of the others' height they are taken for plates, and their neighbours are as before."""
    heights = [HEIGHT if number % 3 else 0.3 * HEIGHT for number in range(LIFTERS)]
    assert_lifters(found_in(drum(heights)), [each for each in heights if each == HEIGHT])


def polar(shape, points=400):
    """A drum whose radius falls by HEIGHT times shape(phase) below the shell's, phase from -0.5 to 0.5 of a pitch."""
    angle = np.linspace(0.0, 2.0 * np.pi, points * LIFTERS, endpoint=False)
    radius = RADIUS - HEIGHT * shape((angle * LIFTERS / (2.0 * np.pi) + 0.5) % 1.0 - 0.5)
    return extruded(radius[:, None] * np.column_stack([np.sin(angle), np.cos(angle)]), 3)


def test_rounded_lifters():
    """Of a wave the face is the line through its middle part, by least squares over heights."""
    found = found_in(polar(lambda phase: 0.5 * (1.0 + np.cos(2.0 * np.pi * phase))))
    share = np.linspace(0.2, 0.8, 1001)
    level, turn = RADIUS - share * HEIGHT, np.arccos(2.0 * share - 1.0) / LIFTERS
    slope = np.polyfit(level * np.cos(turn), level * np.sin(turn), 1)[0]
    assert_lifters(found, leading=np.degrees(np.arctan(slope)), trailing=np.degrees(np.arctan(slope)))


def test_slanting_crests():
    """A crest worn down to one side has the same middle, half way up, to which its faces are told."""
    ends, pitch = np.array([-0.14, -0.1, 0.08, 0.12]), 2.0 * np.pi / LIFTERS
    found = found_in(polar(lambda phase: np.interp(phase, ends, [0.0, 1.0, 0.85, 0.0])))
    rows = np.linspace(0.2, 0.8, 1001)
    middle = 0.5 * (np.interp(0.5, [0.0, 1.0], ends[:2]) + np.interp(0.5, [0.0, 0.85], ends[:1:-1]))
    expected = {}
    for name, way, phase in (
        ("leading", 1.0, np.interp(rows, [0.0, 0.85], ends[:1:-1])),
        ("trailing", -1.0, np.interp(rows, [0.0, 1.0], ends[:2])),
    ):
        level, turn = RADIUS - rows * HEIGHT, way * pitch * (phase - middle)
        expected[name] = np.degrees(np.arctan(np.polyfit(level * np.cos(turn), level * np.sin(turn), 1)[0]))
    assert_lifters(found, **expected)


def test_a_ledge_half_way_up_a_face():
    """It parts no lifter in two."""
    ledge = ([-0.12, -0.1, 0.1, 0.15, 0.17, 0.2], [0.0, 1.0, 1.0, 0.45, 0.55, 0.0])
    found = found_in(polar(lambda phase: np.interp(phase, *ledge)))
    np.testing.assert_allclose(found.height_m, [HEIGHT] * LIFTERS, atol=EXACT_M)


def test_rough_surfaces():
    """Nodes that lie 0.5 mm off change what is told by little, and make no further lifters."""
    mesh = drum(cells=4)
    noise = np.random.default_rng(5).normal(0.0, 5e-4, mesh.points.shape)
    found = found_in(SurfaceMesh(mesh.points + noise, mesh.triangles))
    assert len(found) == LIFTERS
    np.testing.assert_allclose(found.height_m, HEIGHT, atol=NOISE_M)
    np.testing.assert_allclose(found.leading_face_deg, LEADING, atol=NOISE_DEG)
    np.testing.assert_allclose(found.trailing_face_deg, TRAILING, atol=NOISE_DEG)


def test_a_pit_in_one_place_does_not_count():
    """A hole in a plate as deep as a lifter is high, in a third of the length."""
    mesh = drum(cells=6)
    angle = np.arctan2(mesh.points[:, 0], mesh.points[:, 2])
    there = (np.abs(angle - np.pi / LIFTERS) < 0.03) & (np.abs(mesh.points[:, 1]) < 0.1 * LENGTH)
    assert there.any()
    points = np.where(there[:, None], mesh.points * [1.03, 1.0, 1.03], mesh.points)
    assert_lifters(found_in(SurfaceMesh(points, mesh.triangles)))


@pytest.mark.parametrize(
    ("mesh", "point"),
    [
        (smooth(), ORIGIN),
        (smooth(), (0.05, 0.0, 0.0)),
        (smooth(oval=0.1), ORIGIN),
        (drum((0.9 * LEAST_HEIGHT * RADIUS,) * LIFTERS), ORIGIN),
        (drum(), (3.0 * RADIUS, 0.0, 0.0)),
    ],
    ids=["smooth", "axis beside the middle", "oval", "too low", "axis outside"],
)
def test_drums_without_lifters(mesh, point):
    assert len(found_in(mesh, point)) == 0


@pytest.mark.parametrize("gap", [0.01, 3.0], ids=["slit", "half"])
def test_a_part_that_is_no_drum_has_none(gap):
    """A liner that does not close round its axis; gap: rad, where a plate is."""
    mesh = drum()
    middle = mesh.points[mesh.triangles].mean(axis=1)
    kept = np.abs(np.arctan2(middle[:, 0], middle[:, 2]) - np.pi / LIFTERS) > 0.5 * gap
    assert not kept.all()
    assert len(found_in(SurfaceMesh(mesh.points, mesh.triangles[kept]))) == 0
