"""The lowest layer over a sample of the circular wear tester: which particles are in it, and their relative motion."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.meshes.tester import submerged_pose
from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.workflows.cases.circular_tester.layer import LayerOverSample, outlines, reduce_layer, relative_motion


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


def test_components_are_averaged_before_their_magnitude(tmp_path):
    """Of two particles that turn about x, one to and one fro: 1 rad/s averaged, 3 rad/s as a mean of magnitudes."""
    heading = "ITEM: ATOMS id x y z vx vy vz omegax omegay omegaz radius"
    rows = ["1 0 0 0.001 0 0.4 0 4 0 0 0.004", "2 0.01 0 0.002 0 0.2 0 -2 0 0 0.004", "3 0 0 0.05 0 9 0 9 9 9 0.004"]
    head = "ITEM: TIMESTEP\n50\nITEM: NUMBER OF ATOMS\n3\nITEM: BOX BOUNDS pp pp ff\n-1 1\n-1 1\n-1 1\n"
    (tmp_path / "bed_50.dump").write_text(head + "\n".join([heading, *rows]) + "\n")
    assert reduce_layer(tmp_path, LayerOverSample(0.1, 0.1, 0.016, np.eye(3)), 2.0, 0.01) == []
    (found,) = pd.read_csv(tmp_path / "lowest_layer.csv").to_dict("records")
    assert found == pytest.approx(
        {
            "revolution": 2.5,
            "particles": 2,
            "velocity_m_per_s": 0.3,
            "averaged_angular_velocity_rad_per_s": 1.0,
            "mean_angular_speed_rad_per_s": 3.0,
        }
    )
