"""Figures of the flow: readable, and what they show is the flow that was written."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.equipment import flow_figures, flow_panels
from bulkwear.workflows.cases.equipment.flow_views import (
    Side,
    filling_field,
    flow_side,
    outlines,
    read_particles,
    seen,
    side_along,
    velocity_field,
)
from bulkwear.workflows.cases.equipment.histories import WINDOW, flow_series, phase_spans
from bulkwear.workflows.cases.equipment.tables import read_runs
from tests.support.charts import drawn_chart, names, values
from tests.workflows.cases.equipment import scenes

FIGURES = [each for each in vars(flow_figures).values() if hasattr(each, "product")]
OF_ANY = [make for make in FIGURES if make.product.name != "charge_shape"]
REPORT = scenes.BLOCK / scenes.REPORTS  # s
ONE_PARTICLE = scenes.PARTICLE / REPORT * 3.6  # t/h, by which a rate of one report is rounded
EVENED = 0.05  # -, of a batch over a window: what is left of it in the rates
ANGLE = 6.0  # degrees: scatter of a charge of which some hundred particles lie at the shell


@pytest.fixture(scope="module")
def chute(tmp_path_factory):
    """Folder and runs of the chute."""
    folder = tmp_path_factory.mktemp("chute")
    return folder, scenes.chute_study(folder)


@pytest.fixture(scope="module")
def mill(tmp_path_factory):
    """Folder and runs of the mill."""
    folder = tmp_path_factory.mktemp("mill")
    return folder, scenes.drum_study(folder)


@pytest.mark.parametrize("make", OF_ANY, ids=lambda make: make.product.name)
def test_figures_of_a_chute_are_readable(chute, make):
    """Two designs, as built and as worn; no text is small, cut off or over other text; a table stands beside it."""
    figure, table = make(scenes.job_of_study(*chute))
    assert scenes.faults_of(figure) == []
    assert len(table) > 0 and set(table["setting"]) == {"plain", "convex"}
    assert make.product.finding(table).endswith(".")


@pytest.mark.parametrize("make", FIGURES, ids=lambda make: make.product.name)
def test_figures_of_a_mill_are_readable(mill, make):
    """No feed, a part with power, and a charge with toe and shoulder."""
    figure, table = make(scenes.job_of_study(*mill))
    assert scenes.faults_of(figure) == []
    assert len(table) > 0
    assert make.product.finding(table).endswith(".")


# ---------------------------------------------------------------- over time


def test_charts_of_the_flow_have_a_panel_for_each_unit(chute, mill):
    """A feed in and out where there is one, mass held, and the power of each part that moves, by its name."""
    product = flow_figures.flow_over_time.product
    fed, filled = (flow_series(read_runs(runs, folder)) for folder, runs in (chute, mill))
    assert names(drawn_chart(product, fed))[:3] == ["in", "out", "held"]
    found = drawn_chart(product, filled)
    assert names(found) == ["held", "power of shell"]
    assert [panel["layout"]["yaxis"]["title"]["text"] for panel in found["panels"]] == ["Mass held (kg)", "Power (kW)"]
    first = filled[filled["run"] == filled["run"].iloc[0]]
    assert values(found, "power of shell", 1)[0] == pytest.approx(first["power_shell_kW"], rel=1e-5)


def test_rates_are_those_of_the_feed(chute):
    """What comes in is the feed to a particle, nothing goes out until the machine is full, held mass stays then."""
    folder, runs = chute
    series = flow_series(read_runs(runs, folder))
    assert set(series["run"]) == {run["run"] for run in runs}
    np.testing.assert_allclose(series["in_t_per_h"], 3.6 * scenes.RATE, atol=ONE_PARTICLE)
    full = scenes.HELD / scenes.RATE
    steady = series[series["time_s"] > full + scenes.BLOCK]
    np.testing.assert_allclose(steady["out_t_per_h"], 3.6 * scenes.RATE, atol=ONE_PARTICLE)
    np.testing.assert_allclose(steady["held_kg"], scenes.HELD)


@pytest.mark.parametrize("every", [0.8, 4.0])
def test_a_feed_in_batches_is_even(chute, every):
    """Rates do not leap where one batch more or less falls into a window."""
    folder, runs = chute
    read = read_runs(runs, folder)
    batch = every * REPORT  # s
    mass = scenes.RATE * batch * np.floor(read.flow["time_s"] / batch + 1e-6)
    series = flow_series(replace(read, flow=read.flow.assign(inserted_mass_kg=mass)))
    leap = 3.6 * scenes.RATE * batch / (WINDOW * REPORT)
    assert np.ptp(series["in_t_per_h"]) < EVENED * leap


def test_nothing_flows_in_a_machine_that_is_filled_once(mill):
    """Not even as much as rounding would have it, whatever is held."""
    folder, runs = mill
    read = read_runs(runs, folder)
    series = flow_series(replace(read, flow=read.flow.assign(inserted_mass_kg=3799.7 / 3.0, out_mass_kg=0.0)))
    assert (series[["in_t_per_h", "out_t_per_h"]] == 0.0).all(axis=None)


def test_power_is_in_kilowatts(mill):
    folder, runs = mill
    np.testing.assert_allclose(flow_series(read_runs(runs, folder))["power_shell_kW"], 1.5)


def test_power_that_is_not_known_is_none(mill):
    """No curve there, and no rise from 0 after it."""
    folder, runs = mill
    read = read_runs(runs, folder)
    unknown = read.flow["time_s"].median()
    flow = read.flow.assign(power_shell_W=read.flow["power_shell_W"].mask(read.flow["time_s"] <= unknown))
    series = flow_series(replace(read, flow=flow))
    after = series["time_s"] > unknown
    assert after.any() and not after.all() and series.loc[~after, "power_shell_kW"].isna().all()
    np.testing.assert_allclose(series.loc[after, "power_shell_kW"], 1.5)


def test_phases_follow_one_another(chute):
    """From 0 to the end of the run without gaps, for every setting."""
    folder, runs = chute
    spans = phase_spans(read_runs(runs, folder))
    counts = pd.Series(scenes.PHASES).value_counts()
    for _, rows in spans.groupby("setting"):
        assert list(rows["phase"]) == ["start_up", "pristine", "wearing", "worn"]
        assert rows["start_s"].iloc[0] == 0.0
        np.testing.assert_allclose(rows["start_s"].iloc[1:], rows["end_s"].iloc[:-1])
        np.testing.assert_allclose(rows["end_s"] - rows["start_s"], scenes.BLOCK * counts[rows["phase"]])


# ---------------------------------------------------------------- from the side


def particles_of(rows):
    """A table as of a snapshot from (n, 7): place, velocity, radius."""
    names = [*(f"{axis}_m" for axis in "xyz"), *(f"v{axis}_m_per_s" for axis in "xyz"), "radius_m"]
    return pd.DataFrame(np.asarray(rows, dtype=float), columns=names).assign(step=0)


def test_snapshots_are_read_as_written(tmp_path):
    rows = scenes.stream(0.0, count=20)
    scenes._write_picture(tmp_path / "picture_40.dump", 40, rows)
    found = read_particles(tmp_path / "picture_40.dump")
    assert set(found["step"]) == {40}
    np.testing.assert_allclose(
        found[["x_m", "y_m", "z_m", "vx_m_per_s", "vy_m_per_s", "vz_m_per_s"]], rows[:, :6], rtol=1e-5
    )
    np.testing.assert_allclose(found["radius_m"], rows[:, 6])


@pytest.mark.parametrize(
    ("axis", "right", "up"),
    [
        ((0, 1, 0), (1, 0, 0), (0, 0, 1)),
        ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
        ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
        ((0, 0, -1), (1, 0, 0), (0, 1, 0)),
    ],
)
def test_sides(axis, right, up):
    """z is up and the positive x or y to the right; along z one looks from above."""
    side = side_along(np.array(axis))
    np.testing.assert_allclose(side.right, right, atol=1e-12)
    np.testing.assert_allclose(side.up, up, atol=1e-12)


def test_the_side_is_chosen_by_slice_then_axis_then_motion():
    """A slice is seen along its axis, a machine that turns along that, others across most of their motion."""
    falling = particles_of(scenes.stream(0.0))
    np.testing.assert_allclose(flow_side(falling, "x", np.array([0.0, 1.0, 0.0])).right, [0.0, 1.0, 0.0])
    np.testing.assert_allclose(flow_side(falling, None, np.array([1.0, 0.0, 0.0])).right, [0.0, 1.0, 0.0])
    np.testing.assert_allclose(flow_side(falling, None, None).right, [1.0, 0.0, 0.0])
    sideways = falling.rename(columns={"vx_m_per_s": "vy_m_per_s", "vy_m_per_s": "vx_m_per_s"})
    np.testing.assert_allclose(flow_side(sideways, None, None).right, [0.0, 1.0, 0.0])


def test_particles_in_front_are_drawn_last():
    """Seen against y, what has the smallest y is nearest; speeds and places are kept, in mm."""
    table = seen(particles_of(scenes.stream(0.0)), side_along(np.array([0.0, 1.0, 0.0])))
    assert table["depth_mm"].is_monotonic_increasing
    assert (table["radius_mm"] == 20.0).all()
    speed = np.hypot(1.1, 2.8 * (table["right_mm"] + 300.0) / 1100.0)
    np.testing.assert_allclose(table["speed_m_per_s"], speed, rtol=1e-6)


def test_mean_velocities_of_a_flow_that_turns():
    """A solid body that turns has the velocity of each cell's middle, to half a cell."""
    side, generator = Side(np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])), np.random.default_rng(1)
    places = generator.uniform(-1.0, 1.0, (20_000, 3))
    velocity = np.cross([0.0, 2.0, 0.0], places)
    rows = np.column_stack([places, velocity, np.full(len(places), 0.02)])
    field = velocity_field([particles_of(rows[::2]), particles_of(rows[1::2])], side)
    off = 2.0 * 0.5 * field["side_mm"].iloc[0] / 1e3
    np.testing.assert_allclose(field["velocity_right_m_per_s"], 2e-3 * field["up_mm"], atol=off)
    np.testing.assert_allclose(field["velocity_up_m_per_s"], -2e-3 * field["right_mm"], atol=off)
    assert field["particles"].sum() <= len(places)


def test_fillings_add_up_to_the_volume_of_the_particles():
    """Solid fraction times volume of the cells, over the mean of the instants, is the particles' volume."""
    side = side_along(np.array([0.0, 1.0, 0.0]))
    snapshots = [particles_of(scenes.mill_charge(time)) for time in (0.1, 0.2, 0.3)]
    field = filling_field(snapshots, side, 0.3)
    volume = (field["solid_fraction"] * 0.3 * (field["side_mm"] / 1e3) ** 2).sum()
    assert volume == pytest.approx(len(snapshots[0]) * 4.0 / 3.0 * np.pi * 0.02**3, rel=1e-9)


def test_outlines_are_sections_of_the_parts_as_seen():
    """A box is cut to its rectangle, where it stands in the view."""
    box = scenes.box((0.4, 1.0, 0.2), 0.2, (1.0, 0.0, 3.0))
    lines = outlines([box], side_along(np.array([0.0, 1.0, 0.0])), np.array([0.3, 0.13, -2.0]))
    corners = lines.reshape(-1, 2)
    np.testing.assert_allclose(corners.min(axis=0), [800.0, 2900.0])
    np.testing.assert_allclose(corners.max(axis=0), [1200.0, 3100.0])


def test_a_phase_shows_its_last_instant_once(chute):
    """As built the last pristine cycle, as worn the worn one; instants at the seam of cycles count once."""
    folder, runs = chute
    built, worn = flow_panels.scenes(runs[0], folder)
    assert [(scene.phase, scene.hours) for scene in (built, worn)] == [("as built", 0.0), ("as worn", 2000.0)]
    last = [scene.snapshots[-1]["step"].iloc[0] * scenes.TIME_STEP for scene in (built, worn)]
    np.testing.assert_allclose(last, [3.0 * scenes.BLOCK, 6.0 * scenes.BLOCK])
    assert len(built.snapshots) == scenes.PICTURES * scenes.PHASES.count("pristine")


# ---------------------------------------------------------------- mills


def test_toe_and_shoulder_are_those_of_the_charge(mill):
    """Of every packing, as built and as worn; the panel tells the same, and which way the mill is seen to turn."""
    folder, runs = mill
    rows = flow_panels.charge_rows(runs, folder)
    assert rows["phase"].tolist() == ["pristine", "worn"]  # as in the other tables, for names of key numbers
    np.testing.assert_allclose(rows["toe_deg"], 130.0, atol=ANGLE)
    np.testing.assert_allclose(rows["shoulder_deg"], 300.0, atol=ANGLE)
    panel = flow_panels.charge_panels(runs, folder)[0]
    assert panel.angles == {"toe": rows["toe_deg"].iloc[0], "shoulder": rows["shoulder_deg"].iloc[0]}
    assert panel.clockwise  # +y goes away from who sees x to the right and z up
    assert panel.radius_mm == pytest.approx(990.0, rel=0.02)


def test_parts_stand_where_their_motion_has_taken_them(mill):
    """At the last instant of a phase the drum has turned by its speed times the time."""
    folder, runs = mill
    built = flow_panels.scenes(runs[0], folder)[0]
    time = built.snapshots[-1]["step"].iloc[0] * scenes.TIME_STEP
    drawn, stands = scenes.drum(edge=0.08).points, built.parts[0].points
    angle = [np.arctan2(points[:, 0], points[:, 2]) for points in (drawn, stands)]
    radius = [np.hypot(points[:, 0], points[:, 2]) for points in (drawn, stands)]
    lifter = [each[np.isclose(distance, distance.min())] for each, distance in zip(angle, radius, strict=True)]
    turned = (lifter[1].min() - lifter[0].min() - 2.0 * time) % (2.0 * np.pi / 8.0)
    assert min(turned, 2.0 * np.pi / 8.0 - turned) < 1e-6


def study_of(**run):
    """A study of one run with these sections of its parameters."""
    motion = {"kind": "rotation", "point_m": [0, 0, 0], "axis": [0, 1, 0], "speed_rad_per_s": 1.0}
    parameters = {"filling": {"fraction": 0.3}, "inlet": None, "parts": [{"motion": None}, {"motion": motion}]}
    return SimpleNamespace(runs=[SimpleNamespace(parameters=parameters | run)])


@pytest.mark.parametrize(
    ("run", "found"),
    [
        ({}, True),
        ({"filling": None}, False),
        ({"inlet": {"rate_kg_per_s": 1.0}}, False),
        ({"parts": [{"motion": None}]}, False),
        ({"parts": [{"motion": {"kind": "rotation", "axis": [0, 0, 1]}}]}, False),
        ({"parts": [{"motion": {"kind": "belt", "velocity_m_per_s": [1, 0, 0]}}]}, False),
    ],
)
def test_mills_have_a_charge(run, found):
    """Filled, without a feed, turning about a level axis."""
    assert flow_figures.is_mill(study_of(**run)) is found
