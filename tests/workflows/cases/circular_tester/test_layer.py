"""The lowest layer over a sample of the circular wear tester: which particles are in it, and their relative motion."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.meshes.tester import submerged_pose
from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.workflows.cases.circular_tester.layer import LayerOverSample, outlines, relative_motion


def test_relative_motion():
    """Over the plain sample's mean, which is then 1."""
    particles = pd.DataFrame(
        {
            "surface": ["plain", "plain", "convex"],
            "vx_m_per_s": [0.3, 0.0, 0.0],
            "vy_m_per_s": [0.4, 0.3, 0.2],
            "angular_speed_rad_per_s": [1.0, 3.0, 4.0],
        }
    )
    table = relative_motion(particles)
    assert table["relative_speed"].tolist() == pytest.approx([1.25, 0.75, 0.5])
    assert table["relative_angular_speed"].tolist() == pytest.approx([0.5, 1.5, 2.0])
    with pytest.raises(ValueError, match="plain"):
        relative_motion(particles[particles["surface"] == "convex"])


def test_the_layer_is_that_of_the_inclined_sample():
    """A centre is inside by its place in the sample's own frame."""
    turn = submerged_pose(0.0, 0.15, 0.09, np.radians(20.0))[0]
    layer = LayerOverSample(0.1, 0.1, 0.016, turn)
    own = np.array([[0, 0.049, 0.015], [0, 0.051, 0.008], [0, 0, 0.017], [0, 0, -0.001], [0.049, -0.049, 0.001]])
    assert layer.inside(own @ turn.T).tolist() == [True, False, False, False, True]


def test_outlines_are_rim_and_feet():
    """Of a square of two parts: its four sides and the line between them."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    mesh = SurfaceMesh(points, np.array([[0, 1, 2], [0, 2, 3]]), {"part": np.array([0, 1])})
    found = {tuple(sorted(map(tuple, line))) for line in outlines(mesh)}
    assert len(found) == 5
    assert ((0.0, 0.0), (1.0, 1.0)) in found
    same = SurfaceMesh(points, mesh.triangles, {"part": np.array([0, 0])})
    assert len(outlines(same)) == 4
