"""The table of a mill's lifters against hours, of runs whose surfaces are drums with lifters of known heights."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.mesh import SurfaceMesh, write_surface
from bulkwear.postproc.statistics.intervals import estimate
from bulkwear.workflows.cases.equipment import lifter_figures
from bulkwear.workflows.cases.equipment.figures import LIFTERS
from bulkwear.workflows.cases.equipment.lifters import LEADING, LOSS, TRAILING, lifters_table
from bulkwear.workflows.report.products import job_of
from tests.support.charts import drawn_chart, values
from tests.workflows.cases.equipment import scenes

HEIGHT, COUNT = 0.1, 8  # m, of lifters as built, and how many
FACET = 0.02  # mm: what a crest of chords of 10 mm is off its circle of 1 m
UPDATES = 7  # of the first packing: more than figures show
WORN = {1: 0.004, 2: 0.005}  # m that the crests of a packing lose in an update
HOURS = {1: 100.0, 2: 110.0}  # of an update


def drum(worn=0.0, lean=0.0, height=HEIGHT):
    """A drum with lifters; lean: rad per m of height by which they are bent ahead, about +y."""
    mesh = scenes.drum(width=0.02, lifters=COUNT, height=height, edge=0.01, worn=worn)
    x, y, z = mesh.points.T
    radius = np.hypot(x, z)
    angle = np.arctan2(x, z) + lean * np.maximum(1.0 - radius, 0.0)
    return SurfaceMesh(np.column_stack([radius * np.sin(angle), y, radius * np.cos(angle)]), mesh.triangles)


def upright(mesh):
    """A drum about y as one about z."""
    return SurfaceMesh(mesh.points[:, [0, 2, 1]], mesh.triangles)


def write_run(folder, packing, shapes, motion=scenes.TURN):
    """The folder of a run with a surface as built and after each update; return what jobs are told of it."""
    place, rows = folder / f"A-{packing}", []
    for cycle, mesh in enumerate(shapes):
        inside = place / f"cycle_{cycle:03d}" if cycle else place
        inside.mkdir(parents=True)
        write_surface(inside / "surface.vtu", SurfaceMesh(mesh.points, mesh.triangles, {"part": _labels(mesh)}))
        hours = HOURS[packing]
        if cycle:
            rows.append({"cycle": cycle, "operation_h": hours * (cycle - 1), "stands_for_h": hours})
    wear = pd.DataFrame([{"cycle": 0, "operation_h": 0.0, "stands_for_h": 0.0}, *rows])
    wear.to_csv(place / "wear.csv", index=False)
    parts = {"shell": {"wears": True, "motion": motion}}
    return {"run": place.name, "setting": "A", "packing": packing, "parts": parts}


def _labels(mesh):
    return np.zeros(len(mesh.triangles), dtype=np.int64)


@pytest.fixture(scope="module")
def mill(tmp_path_factory):
    """Folder and runs of two packings; the second has an update more."""
    folder = tmp_path_factory.mktemp("mill")
    updates = {1: UPDATES, 2: UPDATES + 1}
    courses = {packing: [drum(k * WORN[packing]) for k in range(updates[packing] + 1)] for packing in updates}
    return folder, [write_run(folder, packing, shapes) for packing, shapes in courses.items()]


@pytest.fixture(scope="module")
def table(mill):
    """The table of both packings."""
    return lifters_table(mill[1], mill[0])


@pytest.fixture(scope="module")
def table_of_one(mill):
    """The table of the first packing alone."""
    return lifters_table(mill[1][:1], mill[0])


def test_the_chart_shows_heights_and_faces(table):
    """Against hours, each with its interval over packings."""
    found = drawn_chart(lifter_figures.lifter_profiles.product, table)
    for panel, name in enumerate(("height_mm", "leading_face_angle_deg")):
        assert values(found, "A", panel) == [pytest.approx(table[name], rel=1e-5)]
        assert found["panels"][panel]["data"][0]["error_y"]["array"] == pytest.approx(
            table[f"{name}_high"] - table[name], rel=1e-4, abs=1e-9
        )


def test_heights_against_hours(table):
    """A row per update of the first packing: means of hours and heights over packings, with their interval."""
    update = np.arange(UPDATES + 1)
    assert (table["lifters"] == COUNT).all() and (table["packings"] == 2).all()
    np.testing.assert_allclose(table["operation_h"], 105.0 * update)
    np.testing.assert_allclose(table["height_mm"], 100.0 - 4.5 * update, atol=FACET)
    expected = [estimate([100.0 - 4.0 * k, 100.0 - 5.0 * k]).interval() for k in update]
    np.testing.assert_allclose(table[["height_mm_low", "height_mm_high"]], expected, atol=13.0 * FACET)  # t of 1


def test_loss_is_taken_packing_by_packing(table):
    """Of one packing's height over its own hours; as built there is none."""
    assert np.isnan(table[LOSS].iloc[0])
    each = [1000.0 * 4.0 / 100.0, 1000.0 * 5.0 / 110.0]
    np.testing.assert_allclose(table[LOSS].iloc[1:], np.mean(each), rtol=0.01)


def test_one_packing_has_no_interval(table_of_one):
    assert table_of_one["height_mm"].notna().all() and table_of_one["height_mm_low"].isna().all()


def test_lifters_that_differ(tmp_path):
    """Bent ahead their leading face is the steeper one; turning the other way it is the other."""
    bent = [drum(lean=0.3)]
    ahead, back = (
        lifters_table(
            [write_run(tmp_path / str(speed), 1, bent, scenes.TURN | {"speed_rad_per_s": speed})],
            tmp_path / str(speed),
        ).iloc[0]
        for speed in (2.0, -2.0)
    )
    assert ahead[LEADING] < ahead[TRAILING] - 10.0
    np.testing.assert_allclose(back[[LEADING, TRAILING]].tolist(), ahead[[TRAILING, LEADING]].tolist(), rtol=1e-3)


def test_lifters_worn_away(tmp_path):
    """Their row is there, without numbers."""
    run = write_run(tmp_path, 1, [drum(), drum(worn=0.5 * HEIGHT), drum(worn=HEIGHT)])
    table = lifters_table([run], tmp_path)
    assert table["lifters"].tolist() == [COUNT, COUNT, 0]
    assert table["height_mm"].isna().tolist() == [False, False, True]


@pytest.mark.parametrize(
    ("mesh", "motion"),
    [
        (drum(worn=HEIGHT), scenes.TURN),
        (drum(), None),
        (upright(drum()), scenes.TURN | {"axis": [0.0, 0.0, 1.0]}),
    ],
    ids=["smooth", "at rest", "upright axis"],
)
def test_parts_without_lifters(tmp_path, mesh, motion):
    """There is a table, without rows."""
    table = lifters_table([write_run(tmp_path, 1, [mesh, mesh], motion)], tmp_path)
    assert table.empty and "height_mm" in table


@pytest.mark.parametrize("found", [True, False])
def test_figure_is_readable(table, tmp_path, found):
    """With intervals, and without any lifters; its table is the one that it is drawn of."""
    table = table if found else table.iloc[:0]
    path = tmp_path / "lifters.csv"
    table.to_csv(path, index=False)
    figure, drawn = lifter_figures.lifter_profiles(job_of({"lifters": str(path)}, {}, scenes.REMARKS))
    assert scenes.faults_of(figure) == []
    np.testing.assert_allclose(drawn["height_mm"].to_numpy(float), table["height_mm"].to_numpy(float))
    shown = [line.get_ydata() for axes in figure.axes for line in axes.lines[:1]]
    for line, name in zip(shown, ("height_mm", LEADING), strict=True) if found else ():
        np.testing.assert_allclose(np.asarray(line, float), table[name].to_numpy(float))


def test_the_job_makes_the_table(mill, table_of_one):
    """From the files that runs leave."""
    folder, runs = mill[0], mill[1][:1]
    made = lifter_figures.lifters(job_of({"wear": [str(folder / runs[0]["run"] / "wear.csv")]}, {"runs": runs}, []))
    assert set(made) == set(LIFTERS)
    pd.testing.assert_frame_equal(made["lifters"], table_of_one)
