"""Radial contours against closed forms: a groove of the pin's shape on an unstructured ring, round and tilted."""

import functools

import numpy as np
import pandas as pd
import pytest

from bulkwear.meshes.disc import track_disc
from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.workflows.cases.pin_on_disc.comparison import mesh_series
from bulkwear.workflows.cases.pin_on_disc.contours import (
    CONTOURS,
    EXAMPLE_ANGLES,
    OPENING_LEVEL,
    contour_table,
    depth_map,
    example_sections,
    mesh_sections,
    opening_width,
    radial_crossings,
    track_map,
    track_radii,
    track_table,
    width_of_area,
)
from bulkwear.workflows.cases.pin_on_disc.run_in import statistics_of
from bulkwear.workflows.cases.pin_on_disc.runs import reference_discs
from tests import PUBLISHED
from tests.verification import groove_cases

VALUES = pd.read_csv(PUBLISHED / "pin_on_disc.csv")
TRACK, PIN = 22e-3, 3e-3  # m
DEPTH = 0.05e-3  # m, of the groove
HALF_WIDTH = np.sqrt(2.0 * PIN * DEPTH - DEPTH**2)  # m, of its opening at the surface
FIFTH, TENTH = 2.0 * HALF_WIDTH / 5.0, 2.0 * HALF_WIDTH / 10.0  # m, elements
RADII = TRACK + np.linspace(-1e-3, 1e-3, 401)
# a chord of one edge h over the pin's radius cuts off at most h^2 / (8 R): 0.2 of 50 um at a fifth of the width
CHORD = FIFTH**2 / (8.0 * PIN) / DEPTH
MESHED = 5e-3  # -, of errors: another version of the mesher lays other triangles
ROUNDING = 1e-12  # m, of interpolation along 360 contours of some 10 mm laid one behind the other


@functools.cache
def ring(element_size=TENTH):
    """Flat unstructured ring."""
    return track_disc(TRACK, 20e-3, 24e-3, float(element_size), 0.8e-3)


def worn(mesh, depth=DEPTH):
    """The ring with a groove of the pin's shape; depth: m, or a function of the angle (rad)."""
    x, y, _ = mesh.points.T
    deepest = depth(np.arctan2(y, x)) if callable(depth) else depth
    bottom = deepest - PIN + np.sqrt(PIN**2 - (np.hypot(x, y) - TRACK) ** 2)
    return SurfaceMesh(np.column_stack([x, y, -np.maximum(bottom, 0.0)]), mesh.triangles)


def rotated(mesh, angle):
    """The surface turned about the z axis by an angle (rad)."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return SurfaceMesh(mesh.points @ np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0, 0, 1]]), mesh.triangles)


def test_a_plane_cuts_exactly():
    """Heights of a tilted plane are met to rounding in every contour: triangles are plane, crossings exact."""
    flat = ring()
    tilted = SurfaceMesh(flat.points + np.outer(0.02 * flat.points[:, 0] - 0.01 * flat.points[:, 1], (0, 0, 1)),
                         flat.triangles)  # fmt: skip
    angle = 2.0 * np.pi / CONTOURS * np.arange(CONTOURS)
    expected = -RADII * (0.02 * np.cos(angle) - 0.01 * np.sin(angle))[:, None]
    np.testing.assert_allclose(depth_map(tilted, RADII), expected, atol=ROUNDING)


def test_every_contour_is_met_on_both_sides_and_sorted():
    """Crossings lie on their half-plane within the ring, from rim to rim, sorted by radius."""
    contour, radius, height = radial_crossings(ring(), CONTOURS)
    assert np.array_equal(np.unique(contour), np.arange(CONTOURS))
    assert (np.diff(radius)[np.diff(contour) == 0] >= 0.0).all()
    assert (height == 0.0).all()
    first = np.flatnonzero(np.diff(contour, prepend=-1))
    assert radius[first].max() < 20.01e-3  # the rims, polygons of chords
    assert radius[np.append(first[1:], len(radius)) - 1].min() > 23.9e-3


def test_nodes_on_the_contours_are_counted_once():
    """A ring of quadrilaterals with nodes right on every contour: no contour is missed, none loses its height."""
    angle, radius = np.meshgrid(np.radians(np.arange(360)), np.linspace(20e-3, 24e-3, 9), indexing="ij")
    number = np.arange(360 * 9).reshape(360, 9)
    a, b = number[:, :-1].ravel(), number[:, 1:].ravel()
    c, d = np.roll(number, -1, axis=0)[:, 1:].ravel(), np.roll(number, -1, axis=0)[:, :-1].ravel()
    points = np.column_stack([(radius * np.cos(angle)).ravel(), (radius * np.sin(angle)).ravel(), -angle.ravel()])
    mesh = SurfaceMesh(points, np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])]))
    np.testing.assert_allclose(depth_map(mesh, RADII), np.broadcast_to(angle[:, :1], (360, len(RADII))), atol=1e-9)


@pytest.mark.parametrize("element_size", [FIFTH, TENTH])
def test_groove_of_the_pin(element_size):
    """Depth, area (of a circular segment) and both widths; the error is that of chords and falls with the mesh.

    The opening is taken at a level, where the segment is sqrt(1 - level) as wide; a node that only just is worn lets
    the section fade out over the rest of its edge, half an edge either side at the most on average.
    """
    table = contour_table(worn(ring(element_size)), TRACK)
    chord = CHORD * (element_size / FIFTH) ** 2
    assert len(table) == CONTOURS
    assert table["depth_m"].mean() == pytest.approx(DEPTH, rel=chord)
    assert (table["depth_m"] <= DEPTH).all()
    segment = 2.0 / 3.0 * 2.0 * HALF_WIDTH * DEPTH
    assert table["area_m2"].mean() == pytest.approx(segment, rel=chord)
    opening = 2.0 * HALF_WIDTH * np.sqrt(1.0 - OPENING_LEVEL)
    assert opening * (1.0 - chord) < table["opening_width_m"].mean() < opening + element_size
    assert table["area_width_m"].mean() == pytest.approx(parabola_width(), rel=0.5 * element_size / HALF_WIDTH)


@pytest.mark.parametrize(
    ("elements", "unlevelled", "opening", "area_width", "depth"),
    [
        (5, 0.168, 0.062, 0.060, -0.0111),
        (10, 0.103, 0.0128, 0.0142, -0.0034),
        pytest.param(20, 0.053, 0.0011, 0.0041, -0.0007, marks=pytest.mark.verify),
    ],
)
def test_errors_fall_with_the_elements(elements, unlevelled, opening, area_width, depth):
    """What docs/pin_on_disc.md says of contours: without a level the opening's error halves, others fall faster."""
    mesh = worn(ring(2.0 * HALF_WIDTH / elements))
    radii = track_radii(mesh, TRACK)
    table = contour_table(mesh, TRACK).mean()
    width = 2.0 * HALF_WIDTH
    found = opening_width(depth_map(mesh, radii), radii, 0.0).mean() / width - 1.0
    assert found == pytest.approx(unlevelled, abs=MESHED)
    at_level = width * np.sqrt(1.0 - OPENING_LEVEL)
    assert table["opening_width_m"] / at_level - 1.0 == pytest.approx(opening, abs=MESHED)
    assert table["area_width_m"] / parabola_width() - 1.0 == pytest.approx(area_width, abs=MESHED)
    assert table["depth_m"] / DEPTH - 1.0 == pytest.approx(depth, abs=0.1 * MESHED)


def parabola_width():
    """Width that holds 95 % of the area of the groove: its root u of (3 u - u^3) / 2 = 0.95, times the opening."""
    roots = np.roots([0.5, 0.0, -1.5, 0.95])
    return 2.0 * HALF_WIDTH * roots[(roots > 0.0) & (roots < 1.0)].item()


def test_depth_that_varies_round_the_disc():
    """A groove that is deeper on one side: each contour has the depth of its angle, to the error of the chords."""
    table = contour_table(worn(ring(), lambda angle: DEPTH * (1.0 + 0.5 * np.cos(angle))), TRACK)
    expected = DEPTH * (1.0 + 0.5 * np.cos(np.radians(table["angle_deg"])))
    assert (np.abs(table["depth_m"] - expected) < CHORD * DEPTH).all()
    assert table["angle_deg"].iloc[table["depth_m"].argmax()] in (*range(20), *range(340, 360))


def test_rotation_moves_the_contours_and_nothing_else():
    """A disc turned by 37 degrees has the same contours, 37 places on."""
    mesh = worn(ring(), lambda angle: DEPTH * (1.0 + 0.3 * np.sin(2.0 * angle)))
    before, after = (contour_table(each, TRACK) for each in (mesh, rotated(mesh, np.radians(37.0))))
    for name in ("depth_m", "opening_width_m", "area_width_m"):
        np.testing.assert_allclose(after[name], np.roll(before[name], 37), atol=1e-10)


def test_area_width_is_that_of_one_section():
    """Many contours at once give what `groove_cases.width_of_area` gives one by one."""
    depth = depth_map(worn(ring()), RADII)[::30]
    single = [groove_cases.width_of_area(RADII, np.maximum(section, 0.0)) for section in depth]
    np.testing.assert_allclose(width_of_area(depth, RADII), single, rtol=1e-12)


def test_widths_of_a_rectangular_and_of_no_groove():
    """A trough of one depth is as wide as it is, at any level and 0.95 of it by area; an unworn contour has none."""
    radii = np.linspace(0.0, 1.0, 1001)
    depth = np.stack([np.where(np.abs(radii - 0.5) <= 0.2, 1.0, 0.0), np.zeros_like(radii)])
    np.testing.assert_allclose(opening_width(depth, radii), [0.4, 0.0], atol=2e-3)  # two steps of the places
    np.testing.assert_allclose(width_of_area(depth, radii), [0.38, 0.0], atol=2e-3)


def test_opening_that_ends_with_the_window():
    """A contour that is worn up to the ends of the window is as wide as the window."""
    assert opening_width(np.ones((1, 11)), np.linspace(0.0, 1.0, 11)) == pytest.approx([1.0])


def test_window_ends_before_the_rim():
    """Places lie evenly about the track, all on the disc; a track beside the disc is refused."""
    radii = track_radii(ring(), TRACK)
    assert radii[len(radii) // 2] == pytest.approx(TRACK)
    assert 20e-3 < radii[0] < 20.1e-3
    with pytest.raises(ValueError, match="allowed is one beyond the track"):
        track_radii(ring(), 25e-3)


def test_places_beside_the_disc_are_refused():
    with pytest.raises(ValueError, match="does not reach"):
        depth_map(ring(), np.linspace(19e-3, 23e-3, 11))


def test_sections_of_the_last_revolutions(pins):
    """Eight angles, three revolutions, nowhere less deep than the one before, and deeper on the whole."""
    folder, runs, contours, _ = pins
    chosen = runs[runs["run"].isin(["a", "b"])]
    sections = example_sections(folder, chosen, contours)
    assert set(sections["revolution"]) == {1, 2, 3}
    deepest = sections.groupby(["scheme", "angle_deg", "revolution"])["depth_um"].max().unstack()
    assert len(deepest) == 2 * len(EXAMPLE_ANGLES)
    assert (np.diff(deepest, axis=1) >= 0.0).all()
    assert (np.diff(deepest.mean()) > 0.0).all()


def test_sections_of_the_meshes(pins):
    """One section per mesh and scheme after one revolution, the conserving scheme first."""
    folder, runs, contours, _ = pins
    series = mesh_series(runs, statistics_of(runs, contours).drop(columns="scheme"))
    sections = mesh_sections(folder, runs, series)
    assert list(dict.fromkeys(sections["run"])) == ["c", "e", "d", "f"]
    assert set(sections["revolution"]) == {1}


def test_map_of_the_track(pins):
    """Depth over radius and angle: deepest in the middle of the track, a tenth deeper at 0 than at 180 degrees."""
    folder, runs, *_ = pins
    meshes, track = reference_discs(folder, runs, VALUES)
    shown = track_map(meshes["per_triangle"], track)
    assert shown.shape[1] == 360
    assert shown.index[0] == pytest.approx(20.8)
    assert abs(float(shown.mean(axis=1).idxmax()) - 22.0) < 0.25  # mm, half an element


def test_table_of_the_track_has_a_row_per_radius_and_scheme(pins):
    """Radius first, then a column per degree, the scheme last; the depths are those of the maps."""
    folder, runs, *_ = pins
    meshes, track = reference_discs(folder, runs, VALUES)
    maps = {scheme: track_map(mesh, track) for scheme, mesh in meshes.items()}
    table = track_table(maps)
    assert list(table) == ["radius_mm", *range(CONTOURS), "scheme"]
    ours = table[table["scheme"] == "per_triangle"]
    np.testing.assert_array_equal(ours[range(CONTOURS)], maps["per_triangle"])
    np.testing.assert_array_equal(ours["radius_mm"], maps["per_triangle"].index)
