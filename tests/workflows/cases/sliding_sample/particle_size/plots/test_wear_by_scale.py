"""Figures of wear against particle scale and of motion round a circle."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_rgba

from bulkwear.postproc.plots.style import remarks_of
from bulkwear.postproc.reference.size_ratios import PUBLISHED_DIAMETER, PUBLISHED_PATTERN, size_ratios
from bulkwear.postproc.statistics.crossing import Crossing
from bulkwear.postproc.statistics.intervals import estimate
from bulkwear.workflows.cases.sliding_sample.particle_size.plots.contacts import ASIDE, MEAN_SIZE
from bulkwear.workflows.cases.sliding_sample.particle_size.plots.wear_by_scale import (
    CRITICAL,
    INTERVAL_COLOUR,
    curves_by_scale,
    steady_by_scale,
    wear_against_scale,
    wear_against_size_ratios,
)
from bulkwear.workflows.cases.sliding_sample.particle_size.wear_by_scale import (
    PARTS,
    critical_scale,
    published_by_size_ratio,
    velocity_bounds,
    wear_by_scale,
    wear_by_size_ratio,
)
from tests.workflows.cases.sliding_sample.particle_size.test_published_sizes import RESULTS, profiles, steady_rows
from tests.workflows.cases.sliding_sample.particle_size.test_wear_by_scale import LINES, SCALES, TRUTH, summary


def labels_of(axes):
    return [line.get_label() for line in axes.lines]


def test_wear_has_points_lines_and_published_lines_for_every_curve():
    """Four curves, each with its points, its line and the published line; the critical scale is marked."""
    wear = wear_by_scale(summary(noise=0.02, packings=3))
    figure = wear_against_scale(wear, LINES, critical_scale(wear)[0], ["shrunk"])
    axes = figure.axes[0]
    for curve in ("plain", "convex", "base", "bumps"):
        assert {curve, f"{curve} line", f"{curve} published"} <= set(labels_of(axes))
    assert {bars.get_label() for bars in axes.containers} == {f"{name} mean" for name in ("plain", "convex", *PARTS)}
    critical = next(line for line in axes.lines if line.get_label() == "critical")
    assert critical.get_xdata()[0] == pytest.approx(TRUTH, rel=0.05)
    assert "shrunk" in remarks_of(figure)


def test_a_critical_scale_without_a_value_is_a_field_alone():
    """The legend shows the field of the interval, and no line that the axes do not have."""
    wear = wear_by_scale(summary(noise=0.02, packings=3))
    critical = replace(critical_scale(wear)[0], value=np.nan)
    figure = wear_against_scale(wear, LINES, critical, [])
    assert "critical" not in labels_of(figure.axes[0])
    (entry,) = [each for each in figure.legends[0].get_patches() if each.get_label() == CRITICAL]
    assert entry.get_facecolor() == to_rgba(INTERVAL_COLOUR)


def test_two_scales_show_points_only():
    """No line and no critical scale is drawn through two points; the published lines stay."""
    wear = wear_by_scale(summary([4.0, 8.0]))
    figure = wear_against_scale(wear, LINES, critical_scale(wear)[0], [])
    names = labels_of(figure.axes[0])
    assert "convex" in names and "convex line" not in names and "critical" not in names and "convex published" in names


def test_an_interval_beyond_the_axis_is_cut():
    """An interval that reaches further than the scales does not stretch the axis."""
    wear = wear_by_scale(summary([4.0, 6.0, 8.0]))
    figure = wear_against_scale(wear, LINES, Crossing(4.2, -np.inf, 90.0, np.nan, np.nan, 1, 1, 3), [])
    assert figure.axes[0].get_xlim() == pytest.approx((3.68, 8.32))


def test_wear_is_shown_against_four_ratios():
    """A panel per ratio with our points on the published curve, where the study follows it."""
    ratios = {scale: size_ratios(scale * PUBLISHED_DIAMETER, *PUBLISHED_PATTERN) for scale in SCALES}
    table = wear_by_size_ratio(wear_by_scale(summary()), ratios)
    figure = wear_against_size_ratios(table, published_by_size_ratio(LINES, SCALES), [])
    assert len(figure.axes) == 4
    for axes in figure.axes:
        published, ours = axes.lines[:2]
        assert np.allclose(np.array(published.get_xydata()), np.array(ours.get_xydata()))


def spins():
    tables = []
    for surface, level in (("convex", 300.0), ("plain", 120.0)):
        for scale in (1.0, 4.0, 8.0):
            count = round(200.0 / (5.0 * scale))
            along = (np.arange(count) + 0.5) * 200.0 / count
            table = {"surface": surface, "particle_scale": scale, "along_mm": along}
            tables.append(pd.DataFrame({**table, "averaged_angular_velocity_deg_per_s": level / np.sqrt(scale)}))
    return pd.concat(tables, ignore_index=True)


def test_curves_by_scale_share_their_axes():
    """A panel per surface, a curve per scale, its places level and its values in their unit; all on the same axes."""
    labels = ("angular speed (°/s)", "distance behind the front edge (mm)")
    figure = curves_by_scale(spins(), "averaged_angular_velocity_deg_per_s", "along_mm", labels, ["a remark"])
    assert len({(*axes.get_xlim(), *axes.get_ylim()) for axes in figure.axes}) == 1
    for axes, (surface, level) in zip(figure.axes, (("convex", 300.0), ("plain", 120.0)), strict=True):
        curves = [line for line in axes.lines if line.get_label().startswith("scale")]
        for line, scale in zip(curves, (1.0, 4.0, 8.0), strict=True):
            along = spins().query(f"surface == {surface!r} and particle_scale == {scale}")["along_mm"]
            assert (
                len(along)
                and line.get_xdata() == pytest.approx(along)
                and line.get_ydata() == pytest.approx(level / np.sqrt(scale))
            )


def test_published_bounds_reach_up_to_their_layer():
    """Heights are upright. Over the plain sample up to the highest layer, over the convex one up to the lowest."""
    table = profiles()
    labels = ("velocity (m/s)", "height (mm)")
    figure = curves_by_scale(table, "velocity_m_per_s", "height_mm", labels, [], velocity_bounds(RESULTS, table))
    ends = {}
    for axes, surface in zip(figure.axes, dict.fromkeys(table["surface"]), strict=True):
        bound = next(line for line in axes.lines if line.get_label().startswith("Yan 2022"))
        ends[surface] = (bound.get_xdata()[0], bound.get_ydata()[-1])
        assert axes.get_ylabel() in ("height (mm)", "") and axes.get_xlabel() == "velocity (m/s)"
    assert ends["plain"][0] == 0.35 and ends["convex"][0] == 0.9
    assert ends["plain"][1] == pytest.approx(3.0 * ends["convex"][1])  # 30 mm over 10 mm
    slow = table.assign(velocity_m_per_s=0.1 * table["velocity_m_per_s"])
    figure = curves_by_scale(slow, "velocity_m_per_s", "height_mm", labels, [], velocity_bounds(RESULTS, slow))
    assert all(axes.get_xlim()[1] > 0.9 for axes in figure.axes)  # also a bound that ours stay far below is seen
    told = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"Yan 2022: below 0.35", "Yan 2022: above 0.9"} <= set(told)


def test_means_by_scale_show_deviations_and_published_values():
    """A panel per measure; windows that are not steady are hollow, and means of them; published marks stand on their
    measure only.
    """
    figure = steady_by_scale(steady_rows(), RESULTS, ["shrunk"])
    velocity, rate = figure.axes
    assert len([line for line in velocity.lines if line.get_label() == "published"]) == 5
    assert not [line for line in rate.lines if line.get_label() == "published"]
    drawn = {axes: [line for line in axes.lines if line.get_marker() in "os"] for axes in (velocity, rate)}
    assert all(line.get_markerfacecolor() == "white" for line in drawn[rate])
    ours = [line for line in drawn[velocity] if line.get_label() != "published"]
    assert ours and all(line.get_markerfacecolor() == line.get_color() for line in ours)
    assert len([bars for bars in velocity.containers if "deviation" in bars.get_label()]) == 2
    assert "shrunk" in remarks_of(figure)


def test_packings_of_a_scale_are_marks_that_no_line_joins():
    """Small ones, with the mean of every scale and its interval; one that is not steady makes its mean hollow alone."""
    table = steady_rows()
    table.loc[table["run"] == "S5-2_plain", "steady"] = False
    velocity = steady_by_scale(table, RESULTS, []).axes[0]
    packings = [line for line in velocity.lines if line.get_label() == "plain"]
    assert {line.get_linestyle() for line in packings} == {"None"}
    assert sorted(len(line.get_xdata()) for line in packings) == [1, 5]
    means = [bars for bars in velocity.containers if bars.get_label() == "plain mean"]
    values = {bars.lines[0].get_xdata()[0]: bars.lines[0].get_ydata()[0] for bars in means}
    assert values == pytest.approx({scale + ASIDE: 12.0 for scale in (4.0, 5.0)})  # beside the convex sample's
    assert [bars.lines[0].get_markerfacecolor() == "white" for bars in means] == [False, True]
    found = estimate(table.query("run.str.startswith('S4') and surface == 'plain'")["mean_percent"][::2])
    low, high = means[0].lines[2][0].get_segments()[0][:, 1]
    assert (low, high) == pytest.approx(found.interval())


def test_one_packing_is_a_large_mark():
    """Its scatter is unknown, so it has no interval, and its deviation along the travel stays."""
    table = steady_rows()
    velocity = steady_by_scale(table[~table["run"].str.contains("-")], RESULTS, []).axes[0]
    (packings,) = [line for line in velocity.lines if line.get_label() == "plain"]
    assert packings.get_markersize() == MEAN_SIZE and len(packings.get_xdata()) == 2
    assert {bars.get_label() for bars in velocity.containers} == {"plain deviation", "convex deviation"}
