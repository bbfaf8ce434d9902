"""The sliding sample against closed forms, and all published geometries."""

import math
import threading
from dataclasses import replace

import numpy as np
import pytest

from bulkwear.meshes.lattice import narrowest_gap, pattern_centres
from bulkwear.meshes.pattern import ConvexPattern
from bulkwear.meshes.sample import (
    SKIRT_DEPTH,
    SMALLEST_ANGLE,
    floor_fault,
    sample_top,
    skirt_fall,
    skirt_width,
    sliding_sample,
)
from bulkwear.meshes.shell import foot_nodes
from bulkwear.postproc.mesh import area_vectors, boundary_edges, nonmanifold_edges, smallest_angles, volume_above_plane
from bulkwear.workflows.config.run_checks import LEAST_GAP

HEIGHT, SLOPE = 0.3e-3, math.radians(3)  # m, rad: the defaults of the sliding study
ROUNDING = 1e-11  # relative: sums of 1e5 float64 terms
MM = 1e-3
TABLE_3_8 = {  # run: a, b, d, h in mm (Yan 2022)
    "R1": (8, 4, 60, 1.5),
    "R2": (2, 8, 60, 1.5),
    "R3": (8, 2, 60, 3),
    "R4": (4, 2, 20, 1.5),
    "R5": (4, 8, 60, 6),
    "R6": (4, 4, 40, 3),
    "R7": (8, 8, 40, 6),
    "R8": (2, 8, 20, 3),
    "R9": (8, 2, 20, 6),
    "R10": (2, 2, 60, 6),
    "R11": (2, 4, 20, 6),
    "R12": (8, 8, 20, 1.5),
    "R13": (2, 2, 40, 1.5),
}
IN_EVERY_RUN = ("R2", "R12")  # slender and flat; crowded; the sample of the tester is slender and tall


def pattern_of(run, row_spacing=40 * MM):
    """The pattern of a run of Table 3.8."""
    a, b, d, h = TABLE_3_8[run]
    return ConvexPattern(a * MM, b * MM, h * MM, row_spacing, d * MM)


def is_one_loop(edges):
    """True when directed boundary edges form one closed ring."""
    after = dict(edges.tolist())
    node, seen = edges[0, 0], 0
    while seen < len(edges):
        node, seen = after[node], seen + 1
        if node == edges[0, 0]:
            break
    return len(after) == len(edges) == seen


def check_geometry(pattern, size, element_size=MM):
    """Footprint, volume, angles, topology and labels of a square sliding sample."""
    mesh = sliding_sample(size, size, element_size, pattern, HEIGHT, SLOPE)
    part, vectors = mesh.cell_data["part"], area_vectors(mesh.points, mesh.triangles)
    centres, _ = pattern_centres(pattern, size, size)
    assert (np.unique(part) == np.arange(-1, len(centres) + 1)).all()
    assert vectors[part >= 0, 2].sum() == pytest.approx(size**2, rel=ROUNDING)
    volumes = [volume_above_plane(mesh.points, mesh.triangles[part == k], HEIGHT) for k in (1, len(centres))]
    exact = 2 / 3 * math.pi * pattern.major_radius * pattern.minor_radius * pattern.height
    assert volumes[0] == pytest.approx(volumes[1], rel=1e-9)
    assert 0.96 * exact < volumes[0] < exact  # R1 is the worst: four edges up a height of 1.5 mm, -3.2 %
    angles = smallest_angles(mesh.points, mesh.triangles)
    assert angles.min() > 20
    assert all(np.percentile(angles[where], 1) > 30 for where in (part == 0, part > 0, part < 0))
    assert nonmanifold_edges(mesh.triangles).size == 0
    assert is_one_loop(boundary_edges(mesh.triangles))
    assert len(np.unique(mesh.triangles)) == len(mesh.points)  # no stray nodes


@pytest.mark.parametrize("run", IN_EVERY_RUN)
def test_published_geometry(run):
    """Geometries of Table 3.8 at 1 mm on half the side: footprint, volume, angles, topology, labels."""
    check_geometry(pattern_of(run), 100 * MM)


@pytest.mark.verify
@pytest.mark.parametrize("row_spacing", [40 * MM, 20 * MM])
@pytest.mark.parametrize("run", TABLE_3_8)
def test_every_published_geometry(run, row_spacing):
    """All thirteen, 200 x 200 mm, with c read as the distance of rows or of rows of one phase."""
    check_geometry(pattern_of(run, row_spacing), 200 * MM)


@pytest.mark.parametrize("row_spacing", [40 * MM, pytest.param(20 * MM, marks=pytest.mark.verify)])
def test_circular_tester_sample(row_spacing):
    """The 100 x 100 mm sample of the circular wear tester (pattern of R9) at 1 mm."""
    check_geometry(pattern_of("R9", row_spacing), 100 * MM)


@pytest.mark.parametrize("element_size", [pytest.param(0.5 * MM, marks=pytest.mark.verify), 2 * MM, 4 * MM])
def test_other_element_sizes(element_size):
    """A small sample at other element sizes keeps angles, footprint and topology."""
    mesh = sliding_sample(60 * MM, 80 * MM, element_size, pattern_of("R9"), HEIGHT, SLOPE)
    part = mesh.cell_data["part"]
    assert area_vectors(mesh.points, mesh.triangles)[part >= 0, 2].sum() == pytest.approx(0.06 * 0.08, rel=ROUNDING)
    angles = smallest_angles(mesh.points, mesh.triangles)
    assert angles.min() > 20
    assert nonmanifold_edges(mesh.triangles).size == 0
    assert is_one_loop(boundary_edges(mesh.triangles))


def test_plain_sample_is_flat():
    """Without a pattern the top is a plane of area width x length at z = 0, all base."""
    mesh = sample_top(50 * MM, 40 * MM, 2 * MM, None)
    assert (mesh.points[:, 2] == 0).all()
    assert (mesh.cell_data["part"] == 0).all()
    assert area_vectors(mesh.points, mesh.triangles)[:, 2].sum() == pytest.approx(0.05 * 0.04, rel=ROUNDING)
    assert area_vectors(mesh.points, mesh.triangles)[:, 2].min() > 0


def test_base_has_holes_of_the_size_of_the_feet():
    """Base area = width x length - number of bumps x area of the foot polygon (shoelace)."""
    pattern = pattern_of("R6")
    mesh = sample_top(100 * MM, 100 * MM, MM, pattern)
    foot = foot_nodes(4 * MM, 4 * MM, MM)
    polygon = (
        0.5
        * np.cross(
            np.column_stack([foot, 0 * foot[:, 0]]),
            np.column_stack([np.roll(foot, -1, axis=0), 0 * foot[:, 0]]),
        )[:, 2].sum()
    )
    bumps = len(pattern_centres(pattern, 100 * MM, 100 * MM)[0])
    base = area_vectors(mesh.points, mesh.triangles)[mesh.cell_data["part"] == 0, 2].sum()
    assert base == pytest.approx(0.01 - bumps * polygon, rel=ROUNDING)


def test_skirt_is_a_ramp_to_below_the_floor():
    """The skirt starts at the rim, falls at the slope on all four sides and ends below the floor."""
    mesh = sliding_sample(50 * MM, 40 * MM, MM, None, HEIGHT, SLOPE)
    skirt = mesh.cell_data["part"] == -1
    vectors = area_vectors(mesh.points, mesh.triangles)[skirt]
    tilt = np.arctan2(np.linalg.norm(vectors[:, :2], axis=1), vectors[:, 2])
    assert tilt == pytest.approx(SLOPE, rel=1e-6)  # heights of 1e-3 m carry 1e-16 m of rounding over 1 mm edges
    assert (np.abs(vectors[:, :2]).min(axis=1) < 1e-12).all()  # four planes, one facing each side
    rim = np.unique(boundary_edges(mesh.triangles[~skirt]))
    assert (mesh.points[rim, 2] == HEIGHT).all()
    outer = np.unique(boundary_edges(mesh.triangles))
    assert mesh.points[outer, 2] == pytest.approx(-SKIRT_DEPTH * HEIGHT, rel=1e-9)
    assert np.abs(mesh.points[outer, :2]).max() == pytest.approx(0.025 + 1.2 * HEIGHT / math.tan(SLOPE), rel=1e-9)


def test_a_curved_skirt_begins_and_ends_level():
    """Two parabolas z = -x^2/2R down from the rim and up to the foot: no kink at either end."""
    radius, height = 0.41, 0.05 * MM
    mesh = sliding_sample(50 * MM, 40 * MM, MM, None, height, math.radians(1.0), radius)
    beyond = np.max(np.abs(mesh.points[:, :2]) - (0.025, 0.02), axis=1)
    drop, width = 1.2 * height, 2.0 * math.sqrt(1.2 * height * radius)
    upper = (beyond >= 0.0) & (beyond <= width / 2.0)
    lower = beyond > width / 2.0
    assert min(upper.sum(), lower.sum()) > 100
    assert beyond.max() == pytest.approx(width, rel=1e-9)
    assert mesh.points[upper, 2] == pytest.approx(height - beyond[upper] ** 2 / (2.0 * radius), abs=ROUNDING * MM)
    foot = height - drop + (width - beyond[lower]) ** 2 / (2.0 * radius)
    assert mesh.points[lower, 2] == pytest.approx(foot, abs=ROUNDING * MM)
    edges = mesh.points[:, :2][mesh.triangles[mesh.cell_data["part"] == -1]]
    assert np.linalg.norm(np.diff(edges, axis=1), axis=2).max() < 2.0 * MM  # fine enough to be curved


def test_a_steep_curved_skirt_is_straight_between_its_curves():
    """Where the curves reach the slope before half the fall, the slope goes on between them; the fall is the same."""
    slope, radius, height = math.radians(3.0), 0.02, MM
    width = skirt_width(height, slope, radius)
    assert width == pytest.approx(1.2 * height / math.tan(slope) + radius * math.tan(slope))
    beyond = np.linspace(0.0, width, 20_001)
    fall = skirt_fall(beyond, height, slope, radius)
    gradient = np.diff(fall) / np.diff(beyond)
    assert (gradient >= 0.0).all() and gradient.max() == pytest.approx(math.tan(slope))
    assert np.abs(np.diff(gradient)).max() <= (beyond[1] / radius) * 1.001  # curvature is bounded: no kink anywhere
    assert (fall[0], fall[-1]) == (0.0, pytest.approx(1.2 * height))
    assert skirt_fall(beyond, height, slope, 0.0) == pytest.approx(math.tan(slope) * beyond)


def test_labels():
    """Each bump's triangles stand on its foot and carry its column and row, base and skirt 0."""
    pattern = pattern_of("R9")
    mesh = sliding_sample(100 * MM, 100 * MM, 2 * MM, pattern, HEIGHT, SLOPE)
    centres, column = pattern_centres(pattern, 100 * MM, 100 * MM)
    labels = mesh.cell_data
    assert all(label.dtype == np.int64 for label in labels.values())
    on_bump = labels["part"] > 0
    offset = mesh.points[mesh.triangles[on_bump], :2].mean(axis=1) - centres[labels["part"][on_bump] - 1]
    assert np.linalg.norm(offset / (2 * MM, 8 * MM), axis=1).max() < 1
    assert (labels["column"][on_bump] == column[labels["part"][on_bump] - 1]).all()
    assert sorted(set(labels["row"][on_bump].tolist())) == [1, 2, 3]
    assert (labels["column"][~on_bump] == 0).all() and (labels["row"][~on_bump] == 0).all()
    assert mesh.points[mesh.triangles[~on_bump], 2].max() == HEIGHT


def test_same_input_same_bits():
    """The builder is deterministic: after other meshes, and off the main thread."""

    def build():
        return sliding_sample(60 * MM, 60 * MM, 2 * MM, pattern_of("R9"), HEIGHT, SLOPE)

    first, others = build(), []
    sample_top(30 * MM, 30 * MM, MM, pattern_of("R6"))
    thread = threading.Thread(target=lambda: others.append(build()))
    thread.start()
    thread.join()
    for other in [*others, build()]:
        assert other.points.tobytes() == first.points.tobytes()
        assert other.triangles.tobytes() == first.triangles.tobytes()
    assert len(others) == 1


def test_symmetry_of_turning():
    """Bumps with a along y are the same mesh as bumps with the radii exchanged and a along x."""
    along = pattern_of("R6")
    turned = replace(along, major_radius=3 * MM, minor_radius=5 * MM, major_axis="across_travel")
    along = replace(along, major_radius=5 * MM, minor_radius=3 * MM)
    meshes = [sample_top(50 * MM, 50 * MM, 2 * MM, pattern) for pattern in (along, turned)]
    assert meshes[0].points.tobytes() == meshes[1].points.tobytes()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.0, 0.1, MM, None, HEIGHT, SLOPE), "width of a sample must be greater than 0 m, found 0.0"),
        ((0.1, 0.1, float("nan"), None, HEIGHT, SLOPE), "element_size of a sample must be"),
        ((0.1, 0.1, MM, None, 0.0, SLOPE), "height_above_floor must be greater than 0 m"),
        ((0.1, 0.1, MM, None, HEIGHT, 1.0), r"skirt_slope must be in \(0, 0.7854\] rad, found 1.0"),
        ((0.015, 0.1, MM, pattern_of("R7"), HEIGHT, SLOPE), "does not fit the sample: no bump fits"),
        (
            (0.1, 0.1, MM, replace(pattern_of("R12"), column_spacing=16.05 * MM), HEIGHT, SLOPE),
            "too narrow for elements of 1 mm: smallest angle",
        ),
    ],
)
def test_senseless_samples_are_refused(arguments, message):
    """Faulty sizes, patterns and gaps too narrow for the elements are refused with one sentence."""
    with pytest.raises(ValueError, match=message):
        sliding_sample(*arguments)


@pytest.mark.parametrize("element_size", [0.8 * MM, 1.5 * MM, 2.0 * MM])
def test_the_narrowest_gap_that_is_allowed_is_meshed(element_size):
    """Between bumps beside one another, by what a study is checked for."""
    pattern = replace(pattern_of("R12"), column_spacing=16.0 * MM + LEAST_GAP * element_size)
    sample = sliding_sample(60 * MM, 60 * MM, element_size, pattern, HEIGHT, SLOPE)
    assert narrowest_gap(pattern, 60 * MM, 60 * MM) == pytest.approx(LEAST_GAP * element_size, rel=1e-6)
    assert smallest_angles(sample.points, sample.triangles).min() >= SMALLEST_ANGLE


def test_recession_to_the_floor_is_told():
    """A worn node at or under the floor is a fault; the skirt, which always reaches below it, is none."""
    sample = sliding_sample(60 * MM, 60 * MM, 4 * MM, None, 0.3 * MM, math.radians(3.0))
    assert sample.points[:, 2].min() < 0.0
    assert floor_fault(sample) is None
    assert "worn down to the floor" in floor_fault(sample, floor_z=0.3e-3)
    assert floor_fault(sample, clearance=0.29e-3) is None
    assert "allowed is above 0.00031 m" in floor_fault(sample, clearance=0.31e-3)
