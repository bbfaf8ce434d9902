"""Views of the flow regimes: what each shows, where, and in which colour."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.meshes.pattern import ConvexPattern
from bulkwear.meshes.sample import sliding_sample
from bulkwear.postproc.plots.style import remarks_of
from bulkwear.workflows.cases.sliding_sample.plots.flow_views import (
    ACROSS,
    BOTTOM,
    SIDE,
    flow_views,
    flow_views_table,
    sample_lines,
    seen_particles,
)

REMARKS = ["particles at scale 4", "sample 40 x 40 mm of 200 x 200 mm"]
WIDTH = 0.04  # m
RADIUS = 0.001  # m
EXACT = 1e-9  # m


@pytest.fixture(scope="module")
def sample():
    """A sample with bumps, and skirt."""
    pattern = ConvexPattern(0.004, 0.002, 0.003, 0.04, 0.02)
    return sliding_sample(WIDTH, WIDTH, 0.002, pattern, 1e-4, np.radians(3.0))


@pytest.fixture(scope="module")
def particles():
    """A block of particles that spin the faster the farther they have gone; single file in x, y and z."""
    axis = np.arange(-0.05, 0.0501, 2.0 * RADIUS)
    places = np.stack(np.meshgrid(axis, axis, np.arange(RADIUS, 0.01, 2.0 * RADIUS)), -1).reshape(-1, 3)
    table = pd.DataFrame(places, columns=["x_m", "y_m", "z_m"])
    return table.assign(id=np.arange(len(table)), radius_m=RADIUS, angular_speed_rad_per_s=table["y_m"] + 0.06)


def test_each_view_is_one_layer(particles, sample):
    """Side view: particles at x = 0; cross-section: at y = 0; bottom view: the lowest; in the axes of the view."""
    views = seen_particles(particles, sample)
    columns, lines, layers = 51, 51, 5
    counts = views.groupby("view", sort=False).size().to_dict()
    assert counts == {SIDE: lines * layers, BOTTOM: lines * columns, ACROSS: columns * layers}
    merged = views.merge(particles, on="id")
    for view, (horizontal, vertical, along) in {SIDE: "yzx", BOTTOM: "yxz", ACROSS: "xzy"}.items():
        shown = merged[merged["view"] == view]
        np.testing.assert_array_equal(shown["horizontal_m"], shown[f"{horizontal}_m"])
        np.testing.assert_array_equal(shown["vertical_m"], shown[f"{vertical}_m"])
        assert np.ptp(shown[f"{along}_m"]) < EXACT


def test_far_particles_are_left_out(particles, sample):
    """Beyond one and a half lengths of the sample from its middle nothing is shown."""
    far = particles.assign(y_m=particles["y_m"] + 0.2)
    assert seen_particles(far, sample).empty


def test_lines_are_the_samples(sample):
    """Cuts lie on their planes' profile between the skirt's ends; from below there are the edge and the bumps' feet."""
    lines = sample_lines(sample)
    assert lines[BOTTOM].shape[1:] == (2, 2)
    corners = np.abs(lines[BOTTOM]).max(axis=(0, 1))
    np.testing.assert_allclose(corners, WIDTH / 2.0, atol=EXACT)
    for view in (SIDE, ACROSS):
        assert np.abs(lines[view][:, :, 0]).max() >= WIDTH / 2.0
        assert lines[view][:, :, 1].max() <= 0.003 + 1e-4 + EXACT
    # at y = 0 and x = 0 stands a bump, or not, in both cuts alike: they cross there
    middle = [lines[view][np.abs(lines[view][:, :, 0]).min(axis=1) < 1e-3][:, :, 1].max() for view in (SIDE, ACROSS)]
    assert middle[0] == pytest.approx(middle[1], abs=3e-4)


def test_figure_shows_all_views_of_all_runs(particles, sample):
    """A column per run, a panel per view with units; circles as tabled; colours by angular speed in degrees."""
    views = {"R9_convex": seen_particles(particles, sample), "R9_plain": seen_particles(particles, sample)}
    lines = dict.fromkeys(views, sample_lines(sample))
    figure = flow_views(views, lines, REMARKS)
    *panels, bar = figure.axes
    assert len(panels) == 6
    assert "(°/s)" in bar.get_ylabel()
    assert panels[2].get_xlabel() == "y (mm)"
    assert panels[0].get_ylabel() == "z (mm)"
    assert [axes.get_title(loc="left") for axes in panels[:2]] == [
        f"R9 {kind}, bed →\nside view" for kind in ("convex", "plain")
    ]
    circles = panels[0].collections[0]
    side = views["R9_convex"][views["R9_convex"]["view"] == SIDE]
    np.testing.assert_allclose(circles.get_offsets(), 1e3 * side[["horizontal_m", "vertical_m"]])
    np.testing.assert_allclose(circles.get_array(), np.degrees(side["angular_speed_rad_per_s"]))
    assert remarks_of(figure) == "; ".join(REMARKS)
    table = flow_views_table(views)
    assert list(table) == [
        "view",
        "id",
        "horizontal_mm",
        "vertical_mm",
        "radius_mm",
        "angular_speed_deg_per_s",
        "run",
    ]
    assert len(table) == sum(map(len, views.values()))
