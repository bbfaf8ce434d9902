"""Shells of shapes given by their height over the plane: a cone, cut or whole, that stands up or hangs down."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from bulkwear.meshes.estimate import sample_triangles
from bulkwear.meshes.lattice import Pattern, dimension, pattern_faults
from bulkwear.meshes.sample import sample_top, sliding_sample
from bulkwear.meshes.shell import foot_nodes, height_area
from bulkwear.meshes.tester import sample_block
from bulkwear.postproc.mesh import area_vectors, boundary_edges, nonmanifold_edges, smallest_angles, volume_above_plane

MM = 1e-3
SIZE, ELEMENT = 30 * MM, 1 * MM
CHORDS = 0.03  # relative; chords of 26 edges lie inside a circle by less
AREA = 2e-3  # relative; of 64 profiles
SMALLEST = 25.0  # degrees, of walls up to 70 degrees steep


@dataclass(frozen=True)
class Cone(Pattern):
    """Elliptical cones, cut where they are `height` high: below the plane with `sign` -1."""

    name = "conical"
    noun = "cone"

    half_foot: float = dimension("mm", 0.1, 100, "half the foot's width")
    height: float = dimension("mm", 0.1, 100, "height")
    top: float = 0.5  # of the foot
    aspect: float = 1.0
    sign: int = -1
    row_spacing: float = 15 * MM
    column_spacing: float = 15 * MM
    row_offset: float = 0.0

    @property
    def foot(self):
        return ("half foot", self.half_foot), ("half foot", self.aspect * self.half_foot)

    def height_at(self, x, y):
        out = np.hypot(x, y / self.aspect) / self.half_foot
        return self.sign * self.height * np.clip((1.0 - out) / (1.0 - self.top), 0.0, 1.0)

    @property
    def highest_point(self):
        return max(self.sign * self.height, 0.0)

    @property
    def deepest_point(self):
        return max(-self.sign * self.height, 0.0)

    @property
    def creases(self):
        return (self.top,)

    @property
    def volume(self):
        return math.pi / 3.0 * self.aspect * self.half_foot**2 * self.height * (1.0 + self.top + self.top**2)


CONES = [
    Cone(5 * MM, 2 * MM),
    Cone(5 * MM, 2 * MM, 0.5, 1.0, 1),
    Cone(5 * MM, 4 * MM, 0.7),  # 70 degrees steep
    Cone(3 * MM, 1 * MM, 0.4, 2.0),
    Cone(5 * MM, 2 * MM, 0.2),  # a floor of two elements
]


@pytest.mark.parametrize("cone", CONES)
def test_volume_angles_and_topology(cone):
    """A cut cone's volume from below, no bad angle, one conforming surface that fills the sample's plane."""
    mesh = sample_top(SIZE, SIZE, ELEMENT, cone)
    part, vectors = mesh.cell_data["part"], area_vectors(mesh.points, mesh.triangles)
    volume = cone.sign * volume_above_plane(mesh.points, mesh.triangles[part == 1])
    assert (1.0 - CHORDS) * cone.volume < volume < cone.volume
    assert smallest_angles(mesh.points, mesh.triangles).min() > SMALLEST
    assert not len(nonmanifold_edges(mesh.triangles))
    assert len(boundary_edges(mesh.triangles)) == 4 * round(SIZE / ELEMENT)
    assert (vectors[:, 2] > 0.0).all()
    assert vectors[:, 2].sum() == pytest.approx(SIZE**2)


def test_volume_converges():
    """Half the edge, a quarter of what is missing."""
    cone = Cone(5 * MM, 2 * MM)
    missing = []
    for size in (1.0, 0.5):
        mesh = sample_top(SIZE, SIZE, size * MM, cone)
        inside = mesh.triangles[mesh.cell_data["part"] == 1]
        missing.append(1.0 + volume_above_plane(mesh.points, inside) / cone.volume)
    assert missing[0] / missing[1] == pytest.approx(4.0, rel=0.2)


def test_nodes_lie_on_surface_foot_and_crease():
    """Every node has the height of its place; the foot's nodes come first, and the crease has its own."""
    cone = CONES[3]
    points, _, feet = cone.shell(0.5 * MM)
    assert points[:, 2] == pytest.approx(cone.height_at(*points[:, :2].T), abs=1e-12)
    assert (points[:feet, :2] == foot_nodes(cone.half_width, cone.half_length, 0.5 * MM)).all()
    out = np.hypot(points[:, 0] / cone.half_width, points[:, 1] / cone.half_length)
    crease = foot_nodes(cone.top * cone.half_width, cone.top * cone.half_length, 0.5 * MM)
    assert np.isclose(out, cone.top, atol=1e-9).sum() == len(crease)


def test_area_of_a_cone():
    """A whole cone's mantle is pi r times its slant height."""
    cone = Cone(3 * MM, 4 * MM, 0.0)
    assert height_area(3 * MM, 3 * MM, cone.height_at) == pytest.approx(math.pi * 15 * MM**2, rel=AREA)


@pytest.mark.parametrize("cone", CONES)
def test_triangles_are_estimated(cone):
    """As for bumps, from areas."""
    given = (SIZE, SIZE, ELEMENT, cone, 5 * MM, math.radians(45.0))
    made = len(sliding_sample(*given).triangles)
    assert sample_triangles(*given) == pytest.approx(made, rel=0.12)


def test_a_hollow_ends_above_the_floor_and_within_the_sample():
    """As deep as the sample is high above the floor, or thick, is too deep; a bump of that height is not."""
    hollow, bump = Cone(5 * MM, 2 * MM), Cone(5 * MM, 2 * MM, 0.5, 1.0, 1)
    with pytest.raises(
        ValueError, match="a cone is 2 mm deep, allowed is less than the sample's height above the floor"
    ):
        sliding_sample(SIZE, SIZE, ELEMENT, hollow, 2 * MM, 0.1)
    with pytest.raises(ValueError, match="a cone is 2 mm deep, allowed is less than the sample's thickness, 2 mm"):
        sample_block(SIZE, SIZE, 2 * MM, ELEMENT, hollow)
    sample_block(SIZE, SIZE, 2 * MM, ELEMENT, bump)
    mesh = sliding_sample(SIZE, SIZE, ELEMENT, hollow, 2.1 * MM, 0.1)
    worn = mesh.cell_data["part"] >= 0
    assert mesh.points[mesh.triangles[worn], 2].min() == pytest.approx(0.1 * MM)


def test_faults_speak_of_the_shape():
    """What is wrong is said of the shape by its own name."""
    assert pattern_faults(Cone(5 * MM, 2 * MM), 8 * MM, 8 * MM).startswith("no cone fits")
    assert pattern_faults(Cone(5 * MM, 2 * MM, row_spacing=4 * MM), SIZE, SIZE).startswith(
        "cones overlap: half foot 5 mm"
    )
    assert pattern_faults(Cone(5 * MM, 0.0), SIZE, SIZE) == "height must be greater than 0 mm, found 0 mm"
