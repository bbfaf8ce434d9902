"""Views of parts, pictures in grids, curves and bars: what is drawn is what was given, and can be read."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from matplotlib import colormaps
from matplotlib.colors import Normalize, to_rgb
from matplotlib.figure import Figure

from bulkwear.postproc.mesh import SurfaceMesh, area_vectors, centroids, unit_normals
from bulkwear.workflows.cases.equipment.flow_panels import FlowPanel
from bulkwear.workflows.cases.equipment.pictures import RECESSION, REMAINING, PartMap
from bulkwear.workflows.cases.equipment.plane_cuts import cut, part_plane, turning_plane, values_on
from bulkwear.workflows.cases.equipment.plots import curves, flow, maps, panels, scales, sections, views
from tests.workflows.cases.equipment import scenes
from tests.workflows.cases.equipment.scenes import REMARKS, faults_of

PIXELS = 0.03  # -, of an area seen in a few thousand pixels
SHADE = 0.02  # -, of a colour: light falls square on the face


@pytest.fixture(autouse=True)
def small_pictures(monkeypatch):
    """Figures place pictures by their shape; with how many pixels does not matter here."""
    monkeypatch.setattr(views, "LONGEST", 250)


def facing(mesh, normal):
    """Weight 1 of the faces that look along a normal."""
    return (unit_normals(mesh.points, mesh.triangles) @ np.array(normal) > 0.9).astype(float)


def part_map(setting="A", part="liner", mesh=None, value=1.0, quantity=RECESSION, **given):
    """A map of a plate that wears evenly on top."""
    mesh = mesh or scenes.box((1.0, 0.6, 0.05), 0.1)
    wear = facing(mesh, (0.0, 0.0, 1.0))
    return PartMap(setting, part, mesh, {quantity: np.where(wear > 0.0, value, np.nan)}, wear, **given)


# ---------------------------------------------------------------- views


def test_a_box_shows_its_faces():
    """From any side the area seen is that of the faces there, foreshortened; what looks away shows nothing."""
    box = scenes.box((0.4, 0.3, 0.2), 0.1)
    slanted = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)
    seen = views.seen_areas(box, np.array([[0.0, 0.0, 1.0], slanted]))
    vectors = area_vectors(box.points, box.triangles)
    for k, towards in enumerate(([0.0, 0.0, 1.0], slanted)):
        expected = np.maximum(vectors @ towards, 0.0)
        assert seen[k].sum() == pytest.approx(expected.sum(), rel=PIXELS)
        assert not seen[k][vectors @ towards <= 0.0].any()


def test_what_is_behind_is_not_seen():
    """A plate hides the one behind it."""
    both = scenes.joined([(scenes.box((0.4, 0.4, 0.02), 0.1, (0.0, 0.0, z)), z) for z in (0, 1)])
    seen = views.seen_areas(both, np.array([[0.0, 0.0, 1.0]]))[0]
    assert seen[both.cell_data["part"] == 0].sum() < 1e-3 * seen[both.cell_data["part"] == 1].sum()


@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)])
def test_a_plate_is_seen_along_its_worn_side(normal):
    box = scenes.box((0.5, 0.4, 0.3), 0.1)
    (found,) = views.best_views(box, facing(box, normal))
    np.testing.assert_allclose(found, normal, atol=1e-9)


def test_a_patterned_plate_is_seen_square():
    """Wear that leans, as on the upstream sides of bumps, does not tilt the view of a plate."""
    plate = scenes.box((1.0, 0.6, 0.05), 0.05)
    lean = facing(plate, (0.0, 0.0, 1.0)) + 3.0 * facing(plate, (1.0, 0.0, 0.0))
    normal = views.mean_normal(plate, lean)
    assert 0.8 < normal[2] < 0.99
    (found,) = views.best_views(plate, lean)
    np.testing.assert_allclose(found, [0.0, 0.0, 1.0], atol=1e-9)


def test_a_part_worn_on_both_sides_has_two_views():
    """Neither side hides behind the other one."""
    paddle = scenes.box((0.02, 0.4, 0.6), 0.1)
    found = views.best_views(paddle, facing(paddle, (1, 0, 0)) + facing(paddle, (-1, 0, 0)))
    assert len(found) == 2 and found[0] @ found[1] < -0.5


def test_without_wear_there_is_a_view():
    box = scenes.box((0.4, 0.3, 0.2), 0.1)
    assert views.best_views(box, np.zeros(len(box.triangles)))


def test_a_view_takes_in_all_and_keeps_lengths():
    """Points across the view are as far apart as they are, in mm; up is up."""
    points = np.array([3.0, 0.0, -2.0]) + np.random.default_rng(1).uniform(-1.0, 1.0, (50, 3))
    view = views.view_of(points, (1.0, 1.0, 0.5))
    places, (left, right, low, high) = view.places_mm(points), view.extent_mm
    assert places[:, 0].min() > left and places[:, 0].max() < right
    assert places[:, 1].min() > low and places[:, 1].max() < high
    across = points @ np.array([view.right, view.up]).T
    np.testing.assert_allclose(places - places[0], 1e3 * (across - across[0]))
    assert view.up[2] > 0.0 and abs(view.up @ view.towards) < 1e-12
    width, height = view.size
    assert width / height == pytest.approx(view.width / view.height, rel=0.01)


def test_colours_are_those_of_the_scale():
    """A face in the light has the colour of its value, one without a value is grey."""
    mesh = scenes.box((1.0, 0.6, 0.05), 0.1)
    middle = centroids(mesh.points, mesh.triangles)
    values = np.where(middle[:, 0] < 0.0, 0.5, np.nan)
    view = views.view_of(mesh.points, (0.0, 0.0, 1.0))
    pixels = views.part_picture(mesh, values, (0.0, 1.0), "viridis", view) / 255.0
    height, width, _ = pixels.shape
    np.testing.assert_allclose(pixels[height // 2, width // 4], colormaps["viridis"](0.5)[:3], atol=SHADE)
    np.testing.assert_allclose(pixels[height // 2, 3 * width // 4], to_rgb(views.NO_VALUE), atol=0.1)


# ---------------------------------------------------------------- unrolled parts


def drum_map(setting="A", **given):
    mesh = scenes.drum(radius=1.0, lifters=8, height=0.1, edge=0.05)
    wear = scenes.drum_recession("shell", mesh)
    return PartMap(setting, "shell", mesh, {RECESSION: 1e6 * wear}, wear, turns_about=turning(), **given)


def turning():
    return np.zeros(3), np.array([0.0, 1.0, 0.0])


def test_a_drum_is_unrolled():
    """Lengths along the circumference and the axis are true, lifters stand up, the window is a sixth of the turn."""
    (shown,), found = maps.shown_parts([drum_map()])
    points, reach = shown.mesh.points, 0.5 * np.radians(maps.WINDOW_DEG)
    assert np.ptp(points[:, 1]) == pytest.approx(0.3)
    worst = np.hypot(
        *centroids(*(lambda m: (m.points, m.triangles))(drum_map().mesh))[drum_map().wear.argmax(), [0, 2]]
    )
    assert np.ptp(points[:, 0]) == pytest.approx(2.0 * reach * worst, abs=0.12)
    assert np.ptp(points[:, 2]) == pytest.approx(
        0.18, abs=0.01
    )  # from the outer side of the shell to the lifters' tops
    (view,) = found["shell"]
    assert view.towards[2] > 0.5  # from inside


def test_an_unrolled_part_moves_to_the_left():
    """What the rotation takes to is further left; outward normals stay outward."""
    strip = maps.Strip.of(drum_map())
    here, later = (
        strip.radius * (np.cos(strip.origin + turn) * strip.first + np.sin(strip.origin + turn) * strip.second)
        for turn in (0.0, np.radians(5.0))
    )
    ahead = np.cross(turning()[1], here)
    assert (later - here) @ ahead > 0.0
    np.testing.assert_allclose(strip.places(here)[0, [0, 2]], 0.0, atol=1e-12)
    assert strip.places(later)[0, 0] == pytest.approx(-np.radians(5.0) * strip.radius)
    flat = maps.unrolled(drum_map(), strip)
    assert flat.wear @ area_vectors(flat.mesh.points, flat.mesh.triangles)[:, 2] > 0.0


def test_the_window_is_round_the_first_mark():
    mark = np.array([0.0, 0.0, -0.9])
    strip = maps.Strip.of(drum_map(marks={"1": mark}))
    np.testing.assert_allclose(strip.places(mark)[0, [0, 2]], 0.0, atol=1e-12)


# ---------------------------------------------------------------- grids of pictures


@pytest.mark.parametrize(("most", "found"), [(1.0, 1.0), (1.9, 1.0), (260.0, 200.0), (999.0, 500.0), (0.05, 0.05)])
def test_scale_bars_have_round_lengths(most, found):
    assert panels.round_length(most) == pytest.approx(found)


def picture(width, height, **given):
    corners = np.array([[-width, -height, 0.0], [width, height, 0.0]]) / 2.0
    return panels.Picture(np.zeros((4, 4, 3), np.uint8), views.view_of(corners, (0.0, 0.0, 1.0)), **given)


@pytest.mark.parametrize(("shape", "lines_are_settings"), [((3.0, 1.0), False), ((0.4, 1.0), True)])
def test_settings_are_lines_of_tall_pictures_and_columns_of_flat_ones(shape, lines_are_settings):
    """On a page as wide as high pictures are larger that way: of two settings with three views each."""
    shown = {(setting, view): picture(*shape) for setting in "AB" for view in "xyz"}
    plan = panels._best_plan(shown, (4.0, 4.0))
    if plan.side is not None:
        assert ({key[0] for key in plan.cells[0] if key} == {"A"}) is lines_are_settings
    keys = [key for line in plan.cells for key in line if key]
    assert sorted(keys) == sorted(shown)
    sizes = [plan.height_of(*place, shown) for place in plan.places()]
    assert min(sizes) > 0.3 and sum(plan.widths) <= 4.0 and sum(plan.heights) <= 4.0


PARTS = {"impact plate": (0.6, 0.4), "liner of the hood": (1.2, 0.3), "rock box": (0.3, 0.3), "rim": (0.2, 1.4)}


@pytest.mark.parametrize("settings", [1, 2, 3, 6])
@pytest.mark.parametrize("parts", [1, 2, 4])
@pytest.mark.parametrize("name", ["R{}", "design {} at 1,200 t/h"])
def test_grids_of_many_designs_are_readable(settings, parts, name):
    """Names fit over columns and beside lines; every picture is there."""
    shown = {
        (name.format(k), part): picture(
            *PARTS[part], marks={"1": np.zeros(3)}, note="60° of it unrolled" * (parts == 1)
        )
        for k in range(settings)
        for part in list(PARTS)[:parts]
    }
    figure = maps.page(REMARKS)
    panels.picture_grid(figure, shown, maps.room(figure))
    assert faults_of(figure) == []
    assert len(figure.axes) == len(shown)
    words = words_of(figure).replace("\n", " ").replace("\N{NO-BREAK SPACE}", " ")
    for setting, part in shown:
        assert settings == 1 or setting in words
        assert parts == 1 or part in words


def test_numbers_of_marks_keep_apart():
    """Also of places that nearly coincide and of one at the rim."""
    marks = {"1": np.zeros(3), "2": np.array([0.01, 0.0, 0.0]), "3": np.array([0.0, 0.012, 0.0])}
    marks["4"] = np.array([0.49, 0.49, 0.0])
    figure = maps.page(REMARKS)
    panels.picture_grid(figure, {("", "liner"): picture(1.0, 1.0, marks=marks)}, panels.Box(0.5, 0.5, 6.0, 3.5))
    assert faults_of(figure) == []


# ---------------------------------------------------------------- maps


def test_per_mt_is_a_second_scale_or_a_remark(tmp_path):
    """Where designs have one feed the bar has both units; else the remarks tell what a mm per 1,000 h is."""
    shown = [part_map("A"), part_map("B")]
    figure = maps.wear_map(shown, {}, {"A": 0.5, "B": 0.5}, REMARKS)
    assert "mm per Mt" in words_of(figure)
    figure = maps.wear_map(shown, {}, {"A": 0.5, "B": 0.25}, REMARKS)
    assert "mm per Mt: 0.5 (A), 0.25 (B)" in words_of(figure).replace("\n", " ")
    figure = maps.wear_map(shown, {}, {"A": np.nan, "B": np.nan}, REMARKS)
    assert "per Mt" not in words_of(figure)


def words_of(figure):
    figure.draw_without_rendering()
    texts = figure.findobj(lambda artist: hasattr(artist, "get_fontsize"))
    return "\n".join(text.get_text() for text in texts)


def test_maps_share_a_scale_that_single_faces_do_not_set():
    """It ends where 99 % of the area of the most worn part does."""
    mesh = scenes.box((1.0, 1.0, 0.05), 0.05)
    worn = facing(mesh, (0.0, 0.0, 1.0))
    values = np.where(worn > 0.0, 2.0, np.nan)
    values[np.flatnonzero(worn)[0]] = 100.0
    most = PartMap("A", "plate", mesh, {RECESSION: values}, worn)
    assert scales.top_of([most, part_map("B", value=1.0)], RECESSION) == 2.0
    assert scales.top_of([], RECESSION) > 0.0


def test_a_part_far_below_another_one_has_colours_too():
    """Then the scale is of decades, from a tenth of the lowest part's rates on, and four decades long at most."""
    near, far, further = (part_map(part=f"p{value:g}", value=value) for value in (5.0, 0.1, 1e-6))
    fast = part_map(part="fast", value=20.0)
    assert type(scales.scale_of([fast, near], RECESSION)) is Normalize
    found = scales.scale_of([fast, near, far], RECESSION)
    assert (found.vmin, found.vmax) == pytest.approx((0.01, 20.0))
    assert scales.scale_of([fast, further], RECESSION).vmin == pytest.approx(20.0 / 1e4)
    (shares,) = (each.values[RECESSION] for each in scales.on_scale([far], RECESSION, found))
    assert np.nanmax(shares) == pytest.approx(np.log(10.0) / np.log(2000.0)) and np.isnan(shares).any()
    figure = maps.wear_map([fast, far], {}, {}, REMARKS)
    (bar,) = (axes for axes in figure.axes if axes.get_ylabel().startswith("Recession"))
    assert bar.get_yscale() == "log" and not faults_of(figure)


def test_what_is_due_is_red():
    """Up to the thickness at which a part is changed, nothing without a rule."""
    colours = maps._with_due(10.0, 40.0)
    assert colours(0.2)[:3] == to_rgb(maps.DUE_COLOUR) and colours(0.3)[:3] != to_rgb(maps.DUE_COLOUR)
    np.testing.assert_allclose(maps._with_due(np.nan, 40.0)(0.1), colormaps["viridis"](0.1), atol=0.01)


def test_edges_do_not_set_the_scale_of_thickness():
    """The rim of a plate is as thick as the plate is long."""
    mesh = scenes.box((1.0, 0.6, 0.05), 0.1)
    top = facing(mesh, (0.0, 0.0, 1.0))
    shown = PartMap("as built", "plate", mesh, {REMAINING: np.where(np.abs(top) > 0.0, 50.0, 1000.0)}, 1e-12 * top)
    figure = maps.remaining_thickness([shown], {"plate": 10.0}, REMARKS)
    bar = next(axes for axes in figure.axes if axes.get_ylabel().startswith("Remaining"))
    assert bar.get_ylim() == pytest.approx((0.0, 50.0))
    assert faults_of(figure) == []


def test_what_does_not_wear_does_not_set_the_scale_of_thickness():
    """The end of a shaft is as thick as the shaft is long: the scale ends at what the worn face had as built."""
    mesh = scenes.box((1.0, 0.6, 0.05), 0.1)
    top, end = (facing(mesh, normal) for normal in ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0)))
    left = np.where(top > 0.0, 6.0, np.where(end > 0.0, 1000.0, 50.0))
    shown = PartMap("after 100 h", "plate", mesh, {REMAINING: left}, 4e-3 * (top > 0.0))
    figure = maps.remaining_thickness([shown], {"plate": 2.0}, REMARKS)
    bar = next(axes for axes in figure.axes if axes.get_ylabel().startswith("Remaining"))
    assert bar.get_ylim() == pytest.approx((0.0, 10.0))


def test_impact_and_sliding_of_two_designs_is_readable():
    """Four quarters with a scale each; colours end at the highest value of both designs."""
    names = ("design 0 at 1,200 t/h", "design 1 at 1,200 t/h")
    shown = [part_map(name, value=1.0 + k) for k, name in enumerate(names)]
    told = [replace(each, values={q: (k + 1.0) * each.wear for q in maps.QUANTITIES}) for k, each in enumerate(shown)]
    figure = maps.impact_and_sliding(told, REMARKS)
    assert faults_of(figure) == []
    words = words_of(figure)
    assert all(f"{title} (" in words for title, _, _ in maps.QUANTITIES.values())


# ---------------------------------------------------------------- sections


def test_a_plane_holds_the_normal_and_is_square_to_the_long_side():
    plate = scenes.box((0.5, 2.0, 0.05), 0.1, (1.0, 0.0, 0.0))
    plane = part_plane(plate, np.array([1.1, 0.3, 0.025]), np.array([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(np.abs(plane.across), [0.0, 1.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(plane.out, [0.0, 0.0, 1.0])
    np.testing.assert_allclose(plane.along, [1.0, 0.0, 0.0], atol=1e-6)


def test_the_end_of_a_long_part_is_cut_along_its_next_side():
    """The normal of its end is the long direction itself: the plane is square to the next longest side."""
    plate = scenes.box((0.5, 2.0, 0.05), 0.1)
    plane = part_plane(plate, np.array([0.0, 1.0, 0.0]), np.array([0.0, 1.0, 0.0]))
    np.testing.assert_allclose(np.abs(plane.across), [1.0, 0.0, 0.0], atol=1e-6)


def test_a_cut_is_the_outline_of_the_body():
    """Its lines are as long as the rectangle's sides together, and carry the nodes' values."""
    plate = scenes.box((0.5, 2.0, 0.05), 0.1)
    plane = part_plane(plate, np.array([0.1, 0.333, 0.025]), np.array([0.0, 0.0, 1.0]))
    lines, faces, shares = cut(plate, plane)
    assert np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1).sum() == pytest.approx(2.0 * (0.5 + 0.05))
    np.testing.assert_allclose([lines[..., 0].min(), lines[..., 0].max()], [-0.35, 0.15], atol=1e-9)
    np.testing.assert_allclose([lines[..., 1].min(), lines[..., 1].max()], [-0.05, 0.0], atol=1e-9)
    values = values_on(plate, plate.points[:, 0], faces, shares)
    np.testing.assert_allclose(values, lines[..., 0] + 0.1, atol=1e-9)


def test_a_cut_through_nodes_is_whole():
    """A plane that runs through nodes cuts the same outline."""
    plate = scenes.box((0.5, 2.0, 0.05), 0.1)
    plane = part_plane(plate, np.array([0.1, 0.3, 0.025]), np.array([0.0, 0.0, 1.0]))
    lines, _, _ = cut(plate, plane)
    assert np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1).sum() == pytest.approx(1.1, rel=1e-6)


def test_a_part_that_turns_is_cut_square_to_its_axis():
    plane = turning_plane(np.array([0.9, 0.1, 0.0]), np.zeros(3), np.array([0.0, 2.0, 0.0]))
    np.testing.assert_allclose(plane.out, [-1.0, 0.0, 0.0], atol=1e-12)
    velocity = np.cross([0.0, 1.0, 0.0], plane.place)
    assert velocity @ plane.along < 0.0  # to the left


def test_hours_have_colours():
    """Black as built, then darker with the hours, of whichever design."""
    assert sections.hour_colour(0.0, [0.0, 5.0]) == "black"
    light = [sum(sections.hour_colour(hour, [0.0, 5.0])[:3]) for hour in (1.0, 3.0, 5.0)]
    assert light == sorted(light, reverse=True)


# ---------------------------------------------------------------- curves and bars


def lives(*rows):
    table = pd.DataFrame(rows, columns=["setting", "part", "life_h", "life_low_h", "life_high_h"])
    return table.assign(packings=3, rule="10 mm left", allowed_mm=20.0)


@pytest.mark.parametrize(
    ("row", "per_mt", "words"),
    [
        ((5234.0, 4300.0, 6512.0, 3), np.nan, "5,230 h (4,300 to 6,510)"),
        ((5234.0, 4300.0, 6512.0, 1), np.nan, "5,230 h (4,300 to 6,510, one packing)"),
        ((5234.0, 4300.0, np.inf, 3), np.nan, "5,230 h (4,300 to no end)"),
        ((5234.0, np.nan, np.nan, 1), np.nan, "5,230 h"),
        ((1e6, np.nan, np.nan, 3), 1000.0, "1,000,000 h, 1,000 Mt"),
        ((0.5, 0.4, 0.6, 2), 1000.0, "0.5 h (0.4 to 0.6), 0.0005 Mt"),
    ],
)
def test_words_of_a_life(row, per_mt, words):
    names = ("life_h", "life_low_h", "life_high_h", "packings")
    assert curves.life_words(SimpleNamespace(**dict(zip(names, row, strict=True))), per_mt) == words


@pytest.mark.parametrize("factors", [{}, {"A": 800.0, "B": 800.0}, {"A": 800.0, "B": 1000.0}])
def test_bars_of_lives_are_readable(factors):
    """Without ends, without an interval, a hundred times apart, never worn; with one feed, with two and without."""
    rows = [("A", "liner", 5200.0, 4300.0, 6500.0), ("B", "liner", 7400.0, 5100.0, np.inf)]
    figure = curves.life_bars(lives(*rows), factors, REMARKS)
    assert faults_of(figure) == []
    assert ("Life (Mt)" in words_of(figure)) is (len(set(factors.values())) == 1)
    rows += [("A", "impact_plate", 40.0, 30.0, 60.0), ("B", "impact_plate", np.nan, np.nan, np.nan)]
    figure = curves.life_bars(lives(*rows), factors, REMARKS)
    assert faults_of(figure) == []
    assert "no life is known" in words_of(figure) and figure.axes[0].get_xscale() == "log"


def test_bars_of_many_parts_are_readable():
    """Six designs of four parts."""
    rows = [
        (f"design {k}", f"part_{m}", 1e3 * (k + 1) * (m + 1), 9e2 * (k + 1) * (m + 1), 1.2e3 * (k + 1) * (m + 1))
        for m in range(4)
        for k in range(6)
    ]
    figure = curves.life_bars(lives(*rows), {f"design {k}": 100.0 for k in range(6)}, REMARKS)
    assert faults_of(figure) == []


def test_bars_end_where_lives_do():
    figure = curves.life_bars(lives(("A", "liner", 5200.0, 4300.0, 6500.0)), {}, REMARKS)
    (bar,) = figure.axes[0].patches
    assert (bar.get_x(), bar.get_width()) == (0.0, 5200.0)


def test_an_interval_that_tells_nothing_is_not_drawn():
    """A few packings that scatter by decades: the bar stands without it, the axis is not stretched, a line says why."""
    rows = [("A", "liner", 5200.0, 4300.0, 6500.0), ("B", "liner", 1.4e4, 1.8e2, 1e10)]
    figure = curves.life_bars(lives(*rows), {}, REMARKS)
    assert faults_of(figure) == [] and figure.axes[0].get_xlim()[1] < 1e5
    assert "14,000 h" in words_of(figure) and "do not tell the life within a factor of 100" in words_of(figure)
    assert "do not tell" not in words_of(curves.life_bars(lives(rows[0]), {}, REMARKS))


def test_an_axis_is_as_long_as_what_is_drawn():
    """It goes past the longest bar for an interval without an end, and not for one that is not drawn."""
    bar, open_ended, untold = (
        ("A", "liner", 5200.0, *ends) for ends in ((4300.0, 6500.0), (4300.0, np.inf), (1.0, 1e9))
    )
    drawn, longer, without = (
        curves.life_bars(lives(row), {}, REMARKS).axes[0].get_xlim()[1] for row in (bar, open_ended, untold)
    )
    assert without == pytest.approx(5200.0 / 6500.0 * drawn) and longer > without


def test_a_recession_that_is_not_drawn_to_its_end():
    """A life beyond the drawn hours has no mark, and the axis does not reach to it."""
    rows = [("A", "liner", 1, h, 1e-3 * h, True) for h in (0.0, 500.0, 1000.0)]
    rows += [("A", "liner", 0, h, 1e-3 * h, True) for h in (0.0, 500.0, 1000.0)]
    rows += [("A", "liner", 0, h, 1e-3 * h, False) for h in (1000.0, 3000.0)]
    columns = ["setting", "part", "packing", "operation_h", "depth_mm", "simulated"]
    table = pd.DataFrame(rows, columns=columns)
    figure = curves.recession_against_time(table, lives(("A", "liner", 20000.0, np.nan, np.nan)), REMARKS)
    assert figure.axes[0].get_xlim()[1] < 4000.0
    assert faults_of(figure) == []
    drawn = [line.get_xydata() for line in figure.axes[0].get_lines() if line.get_linestyle() == "--"]
    np.testing.assert_allclose(drawn[0], [[1000.0, 1.0], [3000.0, 3.0]])


@pytest.mark.parametrize(("allowed", "named"), [(15.0, False), (40.0, True)])
def test_a_change_out_far_below_all_depths_is_named_and_does_not_stretch_the_axis(allowed, named):
    """Lines of some millimetres stay lines beside a liner that may lose many times as much."""
    columns = ["setting", "part", "packing", "operation_h", "depth_mm", "simulated"]
    rows = [("A", "liner", 0, 0.0, 0.0, True), ("A", "liner", 0, 1000.0, 2.0, False)]
    own = lives(("A", "liner", 20000.0, np.nan, np.nan)).assign(allowed_mm=allowed)
    figure = curves.recession_against_time(pd.DataFrame(rows, columns=columns), own, REMARKS)
    assert (figure.axes[0].get_ylim()[1] < 5.0) == named
    assert ("changed at 40 mm" in words_of(figure)) == named and faults_of(figure) == []


@pytest.mark.parametrize("settings", [1, 3, 5])
def test_flow_over_time_is_readable(settings):
    """Lines hold what the table does; of more settings than fit the first are shown."""
    time = np.linspace(0.0, 12.0, 100)
    columns = {"time_s": time, "in_t_per_h": 1000.0, "out_t_per_h": 80.0 * time, "held_kg": 300.0, "power_drum_kW": 4.0}
    series = pd.concat(
        [
            pd.DataFrame(columns).assign(run=f"{k}{p}", setting=f"design {k}", packing=p)
            for k in range(settings)
            for p in (1, 2)
        ]
    )
    spans = [("start_up", 0.0, 3.0), ("pristine", 3.0, 7.0), ("wearing", 7.0, 10.0), ("worn", 10.0, 12.0)]
    rows = [(f"design {k}", *span) for k in range(settings) for span in spans]
    phases = pd.DataFrame(rows, columns=["setting", "phase", "start_s", "end_s"])
    figure = curves.flow_over_time(series, phases, REMARKS)
    assert faults_of(figure) == []
    shown = min(settings, curves.MOST_SETTINGS)
    assert len(figure.axes) == 3 * shown
    put, out = (line.get_xydata() for line in figure.axes[0].get_lines()[::2])
    np.testing.assert_allclose(put, np.column_stack([time, np.full(100, 1000.0)]))
    np.testing.assert_allclose(out, np.column_stack([time, 80.0 * time]))


# ---------------------------------------------------------------- flow from the side


def flow_panel(setting, phase, **given):
    generator = np.random.default_rng(1)
    table = pd.DataFrame(generator.uniform(-1000.0, 1000.0, (300, 2)), columns=["right_mm", "up_mm"])
    table = table.assign(radius_mm=20.0, speed_m_per_s=generator.uniform(0.0, 3.0, 300))
    square = 1000.0 * np.array([[[-1, -1], [1, -1]], [[1, -1], [1, 1]], [[1, 1], [-1, 1]], [[-1, 1], [-1, -1]]])
    return FlowPanel(setting, phase, table, square, **given)


@pytest.mark.parametrize("settings", [1, 2, 4])
def test_pictures_of_many_designs_are_readable(settings):
    """As built and as worn of up to four designs, each after hours of its own."""
    shown = [
        flow_panel(f"design {k}", phase) for k in range(settings) for phase in ("as built", "as worn, after 2,000 h")
    ]
    assert faults_of(flow.flow_pictures(shown, REMARKS)) == []


def test_cells_lie_where_they_are():
    """The colour of a cell is in its place, cells without particles are white."""
    table = pd.DataFrame({"right_mm": [5.0, 25.0], "up_mm": [-15.0, 5.0], "side_mm": 10.0, "speed_m_per_s": [1.0, 2.0]})
    axes = Figure().subplots()
    flow._cells(axes, table, "speed_m_per_s", (0.0, 2.0))
    mesh = axes.collections[0]
    corners, values = mesh.get_coordinates(), np.ma.filled(mesh.get_array(), np.nan)
    np.testing.assert_allclose(corners[0, 0], [0.0, -20.0])
    np.testing.assert_allclose(corners[-1, -1], [30.0, 10.0])
    np.testing.assert_allclose(values[0, 0], 1.0)
    np.testing.assert_allclose(values[2, 2], 2.0)
    assert np.isnan(values).sum() == 7


@pytest.mark.parametrize(("clockwise", "sign"), [(True, 1.0), (False, -1.0)])
def test_angles_are_drawn_in_the_sense_of_rotation(clockwise, sign):
    """90 degrees is at 3 o'clock of a mill that is seen to turn clockwise, at 9 o'clock of one that turns the other
    way.
    """
    axes = Figure().subplots()
    flow._angle(axes, flow_panel("A", "as built", radius_mm=500.0, clockwise=clockwise), "toe", 90.0)
    np.testing.assert_allclose(axes.get_lines()[0].get_xydata()[1], [sign * 500.0, 0.0], atol=1e-9)
    assert axes.texts[0].get_text() == "toe 90°"


def test_a_surface_without_faces_of_a_kind_is_drawn():
    """All faces without a value: grey, no error."""
    mesh = SurfaceMesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    view = views.view_of(mesh.points, (0.0, 0.0, 1.0))
    assert views.part_picture(mesh, np.array([np.nan]), (0.0, 1.0), "viridis", view).shape[2] == 3
