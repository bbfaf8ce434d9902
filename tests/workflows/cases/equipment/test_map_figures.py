"""Figures of where parts wear, how long they last and what is left, of machines whose wear is known."""

import shutil
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.mesh import (
    SurfaceMesh,
    areas,
    centroids,
    read_surface,
    sum_over_nodes,
    unit_normals,
    worn_faces,
    write_surface,
)
from bulkwear.postproc.tables.display import few_digits
from bulkwear.postproc.wear.fields import CARRIED_VOLUME
from bulkwear.postproc.wear.side import turned_to_flow, with_sides
from bulkwear.workflows.cases.equipment import map_figures, pictures, remaining
from bulkwear.workflows.cases.equipment.life_tables import BEYOND, SIMULATED
from bulkwear.workflows.cases.equipment.plots import views
from bulkwear.workflows.cases.equipment.sections import COLUMNS, _plane, shown_shapes, worst_sections
from bulkwear.workflows.config.schema import case_schema
from tests.support.charts import drawn_chart, names, values
from tests.support.shapes import plate
from tests.workflows.cases.equipment import scenes

FIGURES = [each for each in vars(map_figures).values() if hasattr(each, "product")]
SCATTER = 0.02  # -, a life is the inverse of a geometric mean of loads, the line an arithmetic mean of depths
ROUNDED = 1e-6  # -, relative: numbers of tables are written with nine digits


@pytest.fixture(scope="module", autouse=True)
def small_pictures():
    """Figures place pictures by their shape; with how many pixels does not matter here."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(views, "LONGEST", 250)
        yield


@pytest.fixture(scope="module")
def studies(tmp_path_factory):
    """Folder, what jobs are told of the runs, and the tables of studies by name, each made once."""

    @cache
    def made(name):
        folder = tmp_path_factory.mktemp(name)
        runs = getattr(scenes, f"{name}_study")(folder)
        return folder, runs, scenes.write_tables(folder, runs)

    return made


@pytest.fixture(scope="module", params=["chute", pytest.param("drum", marks=pytest.mark.verify)])
def study(request, studies):
    return studies(request.param)


@pytest.mark.parametrize("make", FIGURES, ids=lambda make: make.product.name)
def test_every_figure_is_readable(study, make):
    """Drawn of the files that runs leave; no text is small, cut off or over other text; a table stands beside it, and a
    sentence says what it shows.
    """
    folder, runs, _ = study
    figure, table = make(scenes.job_of_study(folder, runs))
    assert scenes.faults_of(figure) == []
    assert len(table) > 0 and {"setting", "part"} <= set(table)
    assert make.product.finding(table).endswith(".")


def test_maps_hold_the_rates_of_the_table(study):
    """A face has the mean over packings of its patch, what nothing wears has no value, marks are worst places."""
    folder, runs, tables = study
    rates, worst = tables["rates"], tables["worst_places"]
    for shown in pictures.recession_maps(runs, folder, rates, worst):
        rows = rates[(rates["setting"] == shown.setting) & (rates["part"] == shown.part)]
        values = shown.values[pictures.RECESSION]
        known = np.unique(values[np.isfinite(values)])
        told = np.unique(rows.loc[rows["pristine_mm_per_1000h"] > 0.0, "pristine_mm_per_1000h"])
        np.testing.assert_allclose(known, told, rtol=ROUNDED)
        assert not (values <= 0.0).any()
        first = worst[(worst["setting"] == shown.setting) & (worst["part"] == shown.part) & (worst["rank"] == 1)]
        np.testing.assert_allclose(1e3 * shown.marks["1"], first[["x_mm", "y_mm", "z_mm"]].to_numpy()[0])
        assert len(shown.marks) == pictures.MARKED


def test_what_is_left_is_what_was_there_less_what_was_lost(study):
    """Now the given thickness, at the end less the removed thickness of the first packing, by face and by patch."""
    folder, runs, _ = study
    maps = remaining.remaining_maps(runs, folder)
    first, several = pictures.first_runs(runs)[0], len(pictures.first_runs(runs)) > 1
    hours = scenes.UPDATE_HOURS * scenes.PHASES.count("wearing")
    states = ["as built", f"after {few_digits(hours, 4)} h"]
    named = [f"{first['setting']}, {state}" if several else state for state in states]
    assert list(dict.fromkeys(each.setting for each in maps))[:2] == named
    now = next(each for each in maps if each.setting.endswith("as built"))
    np.testing.assert_allclose(now.values[pictures.REMAINING], 1e3 * scenes.THICKNESS, rtol=ROUNDED)
    late = next(each for each in maps if each.part == now.part and not each.setting.endswith("as built"))
    worn = read_surface(folder / first["run"] / "worn_surface.vtu")
    mesh, _ = pictures.part_mesh(worn, pictures.labels_of(first)[late.part])
    lost = mesh.point_data["removed_thickness_m"][mesh.triangles].mean(axis=1)
    np.testing.assert_allclose(late.values[pictures.REMAINING], 1e3 * (scenes.THICKNESS - lost), rtol=ROUNDED)
    rows = remaining.remaining_rows(runs, folder)
    least = rows[(rows["setting"] == first["setting"]) & (rows["part"] == late.part)]["least_remaining_mm"].min()
    assert least == pytest.approx(late.values[pictures.REMAINING].min(), rel=ROUNDED)


HELD_M = 1e-3  # m, that caps hold back everywhere
MUCH_LATER = 20.0  # -, of the simulated hours: the worst place is worn through by then


def with_wanted_hours(runs, *hours):
    """The runs with hours of operation that the study wants told."""
    wanted = {"told_at_s": [3600.0 * each for each in hours]}
    return [run | {"operation": run["operation"] | wanted} for run in runs]


def test_wanted_hours_lie_between_and_beyond_those_of_the_surfaces(study):
    """From the surface before each face loses as much as its patch does in the hours since, until nothing is left."""
    folder, runs, _ = study
    early, end = 0.5 * scenes.UPDATE_HOURS, scenes.UPDATE_HOURS * scenes.PHASES.count("wearing")
    later, latest = end + early, MUCH_LATER * end
    (run,) = with_wanted_hours(pictures.first_runs(runs)[:1], early, later, latest)
    states = remaining.states_of(run, folder)
    assert [state.hours for state in states] == pytest.approx([0.0, early, end, later, latest])
    assert [state.how for state in states] == [SIMULATED] * 3 + [BEYOND] * 2
    named = [f"after {few_digits(hours)} h" for hours in (early, end, later, latest)]
    said = ["as built", *named[:2], *(f"{name}, {BEYOND}" for name in named[2:])]
    assert [remaining.words(state) for state in states] == said
    left = remaining.remaining_rows([run], folder).pivot(
        index=["part", "patch"], columns="operation_h", values="mean_remaining_mm"
    )
    rates = pd.read_csv(folder / run["run"] / "cycle_001" / "patches.csv").set_index(["part", "patch"])
    step = 1e3 * early * rates["recession_m_per_h"].reindex(left.index)
    np.testing.assert_allclose(left[0.0] - left[early], step, rtol=ROUNDED, atol=ROUNDED)
    np.testing.assert_allclose(left[end] - left[later], step, rtol=ROUNDED, atol=ROUNDED)
    assert left[latest].min() == 0.0


def test_what_caps_hold_back_is_lost_on_maps(study, tmp_path):
    """A patch's carried volume over its area, beside what is gone from the surface."""
    folder, runs, _ = study
    (run,) = pictures.first_runs(runs)[:1]
    place = shutil.copytree(folder / run["run"], tmp_path / run["run"])
    before = remaining.states_of(run, tmp_path)[-1]
    worn = read_surface(place / remaining.WORN_SURFACE)
    faces = worn.triangles[worn_faces(worn)]
    node_area = sum_over_nodes(faces, areas(worn.points, faces), len(worn.points)) / 3.0
    fields = worn.point_data | {CARRIED_VOLUME: HELD_M * node_area}
    write_surface(place / remaining.WORN_SURFACE, replace(worn, point_data=fields))
    after = remaining.states_of(run, tmp_path)[-1]
    enough = before.left > 2.0 * HELD_M
    assert enough.any()
    np.testing.assert_allclose((before.left - after.left)[enough], HELD_M, rtol=ROUNDED)


def test_figure_of_many_wanted_hours_is_readable(study):
    """As many as are allowed: of the first design alone."""
    folder, runs, _ = study
    schema = case_schema("equipment", "settings")["properties"]["operation"]["properties"]["told_at_h"]
    hours = scenes.UPDATE_HOURS * (0.25 + np.arange(schema["maxItems"]))
    many = with_wanted_hours(runs, *hours)
    figure, table = map_figures.remaining_thickness(scenes.job_of_study(folder, many))
    assert scenes.faults_of(figure) == []
    own = table[table["setting"] == runs[0]["setting"]]
    assert set(hours) <= set(own["operation_h"])


def test_sections_pass_through_the_worst_place(study):
    """The outline as built runs through the origin; what is removed grows with the hours."""
    folder, runs, tables = study
    lines, sections = worst_sections(runs, folder, tables["worst_places"])
    assert len(sections) == sum(len(pictures.wearing(run)) for run in pictures.first_runs(runs))
    for section in sections.itertuples():
        own = lines[lines["section"] == section.section]
        hours = np.sort(own["operation_h"].unique())
        longer = 1.6 if section.setting == "convex" else 1.0
        np.testing.assert_allclose(hours, longer * scenes.UPDATE_HOURS * np.arange(len(hours)))
        ends = own.loc[own["operation_h"] == 0.0, list(COLUMNS[:4])].to_numpy().reshape(-1, 2, 2)
        start, way = ends[:, 0], ends[:, 1] - ends[:, 0]
        share = np.clip(-(start * way).sum(axis=1) / (way**2).sum(axis=1), 0.0, 1.0)
        assert np.linalg.norm(start + share[:, None] * way, axis=1).min() < 1e-6
        deepest = own.groupby("operation_h")["depth_1_mm"].max().to_numpy()
        np.testing.assert_allclose(deepest, deepest[-1] * hours / hours[-1], rtol=ROUNDED, atol=1e-12)
        assert deepest[-1] > 0.0


def test_sections_see_the_file_s_faces_turned_as_those_of_worn_shapes_are(tmp_path):
    """A sheet whose normals look away from the particles: all shapes look out of the body."""
    built = plate(0.4, 0.4, 4)
    turned, told = turned_to_flow(with_sides(built), np.zeros(32), np.ones(32))
    (tmp_path / "cycle_001").mkdir()
    for place, mesh in (("surface.vtu", built), ("cycle_001/surface.vtu", turned)):
        write_surface(tmp_path / place, mesh)
    row = {"cycle": 1, "operation_h": 0.0, "stands_for_h": 100.0}
    pd.DataFrame([row]).to_csv(tmp_path / "wear.csv", index=False)
    normals = [unit_normals(mesh.points, mesh.triangles)[:, 2] for _, mesh in shown_shapes(tmp_path)]
    assert len(told) == 1 and len(normals) == 2 and (np.concatenate(normals) < 0.0).all()


def test_a_bump_does_not_turn_the_section_of_its_plate():
    """Through its steep flank: out is the normal of the plate, its back does not count."""
    plate = scenes.box((0.6, 0.4, 0.03), 0.02)
    top, away = plate.points[:, 2] > 0.0, np.hypot(plate.points[:, 0], plate.points[:, 1])
    height = np.where(top, 0.06 * np.clip(1.0 - away / 0.05, 0.0, 1.0), 0.0)
    points = plate.points + height[:, None] * [0.0, 0.0, 1.0]
    surface = SurfaceMesh(points, plate.triangles, {"part": np.ones(len(plate.triangles), dtype=int)})
    place = SimpleNamespace(x_mm=25.0, y_mm=2.0, z_mm=45.0)
    plane = _plane(surface, 1, None, place, 0.2)
    nearest = np.abs(centroids(points, plate.triangles) - plane.place).sum(axis=1).argmin()
    flank = unit_normals(points, plate.triangles)[nearest]
    assert flank[2] < 0.8 and plane.out[2] == pytest.approx(1.0, abs=0.01)


def test_a_section_of_a_mill_is_square_to_its_axis(studies):
    """Its outlines reach from lifters to shell: out is to the axis, and the far side lies two radii away."""
    folder, runs, tables = studies("drum")
    lines, sections = worst_sections(runs, folder, tables["worst_places"])
    assert sections["turns"].all()
    places = lines.loc[lines["operation_h"] == 0.0, ["along_1_mm", "out_1_mm"]].to_numpy()
    radius = 1e3 * np.hypot(*(sections[["x_mm", "z_mm"]].to_numpy()[0] / 1e3))
    distance = np.hypot(places[:, 0], places[:, 1] - radius)
    assert distance.max() == pytest.approx(1080.0, rel=0.01) and distance.min() == pytest.approx(900.0, rel=0.02)


def test_mm_per_mt_and_back():
    """At 1,000 t/h a Mt takes 1,000 h; without an inlet nothing is told."""
    run = {"setting": "A", "rate_kg_per_s": 1000.0 / 3.6, "parts": {}}
    assert pictures.mm_per_mt([run])["A"] == pytest.approx(1.0)
    assert pictures.hours_per_mt([run])["A"] == pytest.approx(1000.0)
    assert np.isnan(pictures.mm_per_mt([run | {"rate_kg_per_s": None}])["A"])


@pytest.mark.parametrize(
    ("rule", "due"),
    [
        ({"change_out_remaining_m": 0.01}, 10.0),
        ({"change_out_remaining_fraction": 0.5}, 15.0),
        ({"change_out_remaining_m": 0.02, "change_out_remaining_fraction": 0.5}, 20.0),
        ({"change_out_worn_mass_fraction": 0.3}, np.nan),
    ],
)
def test_thickness_at_which_a_part_is_changed(rule, due):
    """The larger of what rules ask to be left; by mass there is no such thickness."""
    part = {"wears": True, "thickness_m": 0.03}
    run = {"setting": "A", "operation": rule, "parts": {"liner": part}}
    np.testing.assert_allclose(pictures.change_out_mm([run])["liner"], due)


@pytest.mark.parametrize(("told", "left_out"), [((), {"remaining_thickness"}), ((3600.0,), set())])
def test_a_study_without_updates_has_no_sections(told, left_out):
    """All else is drawn of any study of the case; what is left, where it is asked for at some hours."""
    own = {"operation": {"told_at_s": told} if told else {}, "updates": {"most": 0}}
    run, every = SimpleNamespace(parameters=own), {make.product.name for make in FIGURES}
    rigid = SimpleNamespace(settings={"updates": {"most": 0}}, runs=[run])
    assert {make.product.name for make in FIGURES if make.product.when(rigid)} == every - {
        "profile_sections"
    } - left_out
    worn = SimpleNamespace(parameters=own | {"updates": {"most": 1}})  # by a column of the design
    some = SimpleNamespace(settings=rigid.settings, runs=[run, worn])
    assert {make.product.name for make in FIGURES if make.product.when(some)} == every


def test_lives_in_the_table_are_those_beside_the_figure(study):
    """The table of the figure is the study's table of lives."""
    folder, runs, tables = study
    _, table = map_figures.life_bars(scenes.job_of_study(folder, runs))
    np.testing.assert_allclose(table["life_h"], tables["life"]["life_h"], rtol=ROUNDED)


def test_depths_of_deciding_places(study):
    """The mean is that of the packings; the dashed line ends at the allowed depth, here at the life."""
    folder, runs, tables = study
    _, depths = map_figures.recession_against_time(scenes.job_of_study(folder, runs))
    for (setting, part), rows in depths.groupby(["setting", "part"]):
        simulated = rows[rows["simulated"]]
        at_end = simulated[simulated["operation_h"] == simulated["operation_h"].max()]
        mean, each = (at_end.loc[test, "depth_mm"] for test in (at_end["packing"] == 0, at_end["packing"] > 0))
        assert mean.iloc[0] == pytest.approx(each.mean(), rel=ROUNDED)
        own = tables["life"].set_index(["setting", "part"]).loc[(setting, part)]
        beyond = rows[~rows["simulated"]]
        asked = runs[0]["operation"]["duration_s"] / 3600.0
        assert beyond["depth_mm"].max() <= own["allowed_mm"] * (1.0 + ROUNDED)
        if own["life_h"] < 2.0 * asked:
            assert beyond["depth_mm"].iloc[-1] == pytest.approx(own["allowed_mm"], rel=ROUNDED)
            assert beyond["operation_h"].iloc[-1] == pytest.approx(own["life_h"], rel=SCATTER)


def test_charts_of_lives_and_depths_show_their_tables(study):
    """Lives as bars that lie, with both ends; per part the mean depth, packings, what follows and the change-out."""
    folder, runs, tables = study
    job, life = scenes.job_of_study(folder, runs), tables["life"]
    (_, table), product = map_figures.life_bars(job), map_figures.life_bars.product
    found = drawn_chart(product, table)
    drawn = [value for name in names(found) for bars in values(found, name, along="x") for value in bars]
    known = life["life_h"][np.isfinite(life["life_h"])]
    assert sorted(value for value in drawn if value is not None) == pytest.approx(sorted(known), rel=1e-5)
    (_, depths), product = map_figures.recession_against_time(job), map_figures.recession_against_time.product
    found = drawn_chart(product, depths, life=life)
    assert [panel["title"] for panel in found["panels"]] == list(dict.fromkeys(depths["part"].str.replace("_", " ")))
    entries = names(found)
    of_setting = entries[0]
    means = depths[(depths["packing"] == 0) & depths["simulated"] & (depths["part"] == depths["part"].iloc[0])]
    own = means[means["setting"] == means["setting"].iloc[0]]
    assert values(found, of_setting) == [pytest.approx(own["depth_mm"], rel=1e-5)]
    for words in ("extrapolated", "packings", "change-out"):
        assert any(words in entry for entry in entries), words


def test_figures_of_the_page_are_declared():
    """A study of the package has them all, in the order of the modules."""
    assert [make.product.name for make in FIGURES] == [
        *("life_bars", "recession_against_time", "wear_map"),
        *("remaining_thickness", "impact_and_sliding", "profile_sections"),
    ]
