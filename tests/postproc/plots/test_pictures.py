"""Rendered pictures: right place, right colour, right scale. One sample is rendered for all tests."""

from itertools import combinations

import numpy as np
import pandas as pd
import pytest
from matplotlib import colormaps

from bulkwear.meshes.sample import sliding_sample
from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.plots import pictures
from bulkwear.postproc.plots.scene import OBLIQUE, surface_plan, trimmed, worn_side
from bulkwear.postproc.plots.style import MAP, remarks_of
from bulkwear.postproc.tables.depths import depth_table

REMARKS = ["particles at scale 4", "sample 40 x 40 mm of 200 x 200 mm"]
WIDTH = 0.04  # m
DEPTH = 2e-6  # m
COLOUR_TOLERANCE = 0.12  # -, of full scale: light dims the colours of the map a little
FILLED = 0.45  # -, of a page by its pictures, at least
PIXEL = 1.5  # pixels: edges fall within one and are drawn with a line


@pytest.fixture(scope="module")
def mesh():
    """A plain sample with skirt, worn by DEPTH for x > 0 and not at all for x < 0."""
    sample = sliding_sample(WIDTH, WIDTH, 0.004, None, 3e-4, np.radians(3.0))
    thickness = np.where(sample.points[:, 0] > 1e-6, DEPTH, 0.0)
    point_data = {"removed_thickness_m": thickness, "carried_volume_m3": np.zeros(len(sample.points))}
    cells = {**sample.cell_data, "worn_volume_m3": np.zeros(len(sample.triangles))}
    return SurfaceMesh(sample.points, sample.triangles, cells, point_data)


@pytest.fixture(scope="module")
def plan(mesh):
    """Pixels of the sample from above and what they cover (mm)."""
    return surface_plan(mesh, True, (0.0, DEPTH * 1e6), longest=300)


def colour_at(plan, x, y):
    """Colour (3,) from 0 to 1 at a place in mm."""
    pixels, (left, right, bottom, top) = plan
    column = int((x - left) / (right - left) * pixels.shape[1])
    line = int((top - y) / (top - bottom) * pixels.shape[0])
    return pixels[line, column] / 255.0


def test_colours_follow_depth(plan):
    """Worn faces have the top colour of the map, others its bottom colour, the skirt is grey."""
    np.testing.assert_allclose(colour_at(plan, 12.0, 5.0), colormaps[MAP](1.0)[:3], atol=COLOUR_TOLERANCE)
    np.testing.assert_allclose(colour_at(plan, -12.0, 5.0), colormaps[MAP](0.0)[:3], atol=COLOUR_TOLERANCE)
    skirt = colour_at(plan, 0.0, 23.0)
    assert np.ptp(skirt) < COLOUR_TOLERANCE


def test_axes_of_the_plan_fit_the_picture(plan, mesh):
    """What the axes say the pixels cover is the mesh; the sample's edge lies where its width says."""
    pixels, extent = plan
    np.testing.assert_allclose(extent[:2], [mesh.points[:, 0].min() * 1e3, mesh.points[:, 0].max() * 1e3])
    line = pixels[pixels.shape[0] // 4].astype(float)
    coloured = np.flatnonzero(np.ptp(line, axis=1) > 40.0)
    per_pixel = (extent[1] - extent[0]) / pixels.shape[1]
    assert abs((coloured[-1] - coloured[0] + 1) * per_pixel - WIDTH * 1e3) <= 2.0 * PIXEL * per_pixel


def test_held_back_wear_is_hatched(mesh, plan):
    """Lines cross the half of the sample where a cap held wear back, and none the other half."""
    held = np.where(mesh.points[:, 0] > 1e-6, DEPTH, 0.0) * 1e-6  # m3, of nodes: more than a tenth of the depth
    carrying = SurfaceMesh(mesh.points, mesh.triangles, mesh.cell_data, {**mesh.point_data, "carried_volume_m3": held})
    pixels, _ = surface_plan(carrying, True, (0.0, DEPTH * 1e6), longest=300)
    differs = np.ptp([pixels, plan[0]], axis=0).max(axis=2) > 40
    half, face = pixels.shape[1] // 2, 30  # pixels, of a face that belongs to both halves
    inside = slice(40, -40)  # pixels, clear of the sample's outline
    lines = differs[inside, half + face : -40]
    assert lines.any() and not lines.all()
    assert not differs[inside, 40 : half - face].any()


def test_figure_of_worn_surfaces(mesh):
    """The figure shows each run obliquely and from above, mm on the axes, µm on the colour bar, and the remarks."""
    runs = pd.DataFrame({"run": ["R9_convex", "R9_plain"], "row": "R9", "surface": ["convex", "plain"]})
    meshes = dict.fromkeys(runs["run"], mesh)
    depths = depth_table(meshes, True)
    limits = pictures.colour_limits(depths)
    assert limits == (0.0, pytest.approx(DEPTH * 1e6))
    figure = pictures.worn_surface(meshes, runs, True, depths, "Removed thickness", REMARKS)
    *_, bar = figure.axes
    assert bar.get_ylabel() == "Removed thickness (µm)"
    assert bar.get_ylim() == pytest.approx(limits)
    assert [axes.get_title() for axes in figure.axes[:2]] == ["R9 convex", "R9 plain"]
    assert all("(mm)" in axes.get_xlabel() for axes in figure.axes[2:4])
    assert remarks_of(figure) == "; ".join(REMARKS)


def test_the_still_of_a_page_shows_its_first_views(mesh):
    """Of five runs four are drawn, in two lines, on one scale; the rest is told of."""
    meshes = {f"R{k}_plain": mesh for k in range(pictures.MOST_VIEWS + 1)}
    figure = pictures.surface_views(meshes, True, depth_table(meshes, True), "Removed thickness", REMARKS)
    *views, bar = figure.axes
    assert [axes.get_title() for axes in views] == [f"R{k} plain" for k in range(pictures.MOST_VIEWS)]
    assert len({axes.get_subplotspec().rowspan.start for axes in views}) == 2
    assert bar.get_ylim() == pytest.approx((0.0, DEPTH * 1e6))
    assert remarks_of(figure) == "; ".join([*REMARKS, "the first 4 of 5 runs are shown"])


def test_many_rows_share_one_scale(mesh):
    """A row worn half as deep has the colours of half the depth; pictures end at the sample's edge."""
    shallow = SurfaceMesh(mesh.points, mesh.triangles, mesh.cell_data, dict(mesh.point_data))
    shallow.point_data["removed_thickness_m"] = 0.5 * mesh.point_data["removed_thickness_m"]
    runs = pd.DataFrame({"run": ["A_plain", "B_plain"], "row": ["A", "B"], "surface": ["plain", "convex"]})
    meshes = {"A_plain": mesh, "B_plain": shallow}
    depths = depth_table(meshes, True)
    figure = pictures.worn_surface(meshes, runs, True, depths, "Wear depth", REMARKS)
    assert [axes.get_title() for axes in figure.axes[:2]] == ["A", "B"]
    assert figure.axes[-1].get_ylabel() == "Wear depth (µm)"
    assert figure.axes[-1].get_ylim() == pytest.approx(pictures.colour_limits(depths))
    first, second = (axes.images[0].get_array() for axes in figure.axes[:2])
    assert (np.asarray(first) != np.asarray(second)).any()
    assert np.ptp(first[first.shape[0] // 2, -3].astype(float)) > 40.0


def test_a_run_worn_right_off_does_not_make_the_others_look_unworn(mesh):
    """Its depth is beyond the scale of the others, and the remarks say so; of two runs both count."""
    table = depth_table({"a_plain": mesh}, True)
    runs = {"a_plain": 1.0, "b_plain": 2.0, "c_convex": 0.0, "worn_out": 1000.0}
    depths = pd.concat([table.assign(run=run, depth_um=k * table["depth_um"]) for run, k in runs.items()])
    assert pictures.beyond_scale(depths) == ["worn_out"]
    assert pictures.colour_limits(depths) == pytest.approx((0.0, 2.0 * DEPTH * 1e6))
    two = depths[depths["run"].isin(["a_plain", "worn_out"])]
    assert pictures.beyond_scale(two) == [] and pictures.colour_limits(two)[1] == pytest.approx(1000.0 * DEPTH * 1e6)
    figure = pictures.surface_views(dict.fromkeys(runs, mesh), True, depths, "Removed thickness", REMARKS)
    assert "beyond the scale: worn out" in remarks_of(figure)


def test_names_of_many_settings_stay_in_their_columns(mesh):
    """Pictures of eighteen settings with long names are as large as the page lets them be, and no name is covered."""
    names = [f"friction-rolling-thin-convex-{k}" for k in range(18)]
    runs = pd.DataFrame({"run": names, "row": names, "surface": "convex"})
    meshes = dict.fromkeys(names, mesh)
    figure = pictures.worn_surface(meshes, runs, True, depth_table(meshes, True), "Wear depth", REMARKS)
    figure.draw_without_rendering()
    *views, bar = figure.axes
    boxes = [axes.title.get_window_extent() for axes in views] + [bar.get_window_extent()]
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))
    assert [axes.title.get_text().replace("\n", "") for axes in views] == names
    assert 18 * views[0].get_window_extent().width ** 2 > FILLED * figure.bbox.width * figure.bbox.height


def test_of_too_many_rows_the_first_and_the_least_worn_are_drawn(mesh):
    """Of a row more than are drawn the deepest worn one is left out, unless it is the first, and the remarks say so."""
    names = [f"O{k}_convex" for k in range(pictures.MOST_ROWS + 1)]
    runs = pd.DataFrame({"run": names, "row": [name[:-7] for name in names], "surface": "convex"})
    table = depth_table({"": mesh}, True)
    deep = {names[0]: 9.0, names[5]: 3.0}
    depths = pd.concat([table.assign(run=run, depth_um=deep.get(run, 1.0) * table["depth_um"]) for run in names])
    figure = pictures.worn_surface(dict.fromkeys(names, mesh), runs, True, depths, "Wear depth", REMARKS)
    assert {axes.get_title() for axes in figure.axes} - {""} == set(runs["row"]) - {"O5"}
    told = f"of {len(names)} rows the first and the {pictures.MOST_ROWS - 1} least worn ones are shown"
    assert remarks_of(figure) == "; ".join([*REMARKS, told])


def test_figure_of_the_bed(mesh):
    """The bed is coloured by speed in m/s; its table holds the particles drawn, in mm."""
    random = np.random.default_rng(2)
    cut = pd.DataFrame(random.uniform(-0.02, 0.0, (20, 3)), columns=["x_m", "y_m", "z_m"])
    cut = cut.assign(id=range(20), radius_m=0.002, speed_m_per_s=np.linspace(0.5, 1.0, 20))
    figure = pictures.bed({"R9_convex": cut}, {"R9_convex": mesh}, REMARKS)
    assert "(m/s)" in figure.axes[-1].get_ylabel()
    assert remarks_of(figure) == "; ".join(REMARKS)
    table = pictures.bed_table({"R9_convex": cut})
    np.testing.assert_allclose(table["x_mm"], cut["x_m"] * 1e3)
    assert table["speed_m_per_s"].tolist() == cut["speed_m_per_s"].tolist()


def test_wear_is_looked_at_from_its_side(mesh):
    """A sample worn from above is seen from above as ever; turned upside down, from below."""
    assert worn_side([mesh], True) == OBLIQUE
    turned = SurfaceMesh(mesh.points * [1, -1, -1], mesh.triangles, mesh.cell_data, mesh.point_data)
    assert worn_side([turned], True)[2] == -OBLIQUE[2]


def test_margins_are_cut_off():
    """Only margins that all pictures have go, so that their scales stay equal; white pictures stay as they are."""
    white = np.full((10, 12, 3), 255, np.uint8)
    assert trimmed([white])[0].shape == (10, 12, 3)
    first, second = white.copy(), white.copy()
    first[3, 4], second[6, 9] = 0, 10
    cuts = trimmed([first, second])
    assert [cut.shape for cut in cuts] == [(4, 6, 3)] * 2
    assert (cuts[0][0, 0] == 0).all()
    assert (cuts[1][3, 5] == 10).all()


def test_wear_maps_have_a_column_per_scale(mesh):
    """Surface by surface, small beside large, all on one colour scale; titles tell sample and scale."""
    runs = pd.DataFrame(
        {
            "run": ["S2_convex", "S2_plain", "S8_convex", "S8_plain"],
            "row": ["S2", "S2", "S8", "S8"],
            "surface": ["convex", "plain"] * 2,
            "particle_scale": [2.0, 2.0, 8.0, 8.0],
        }
    )
    meshes = dict.fromkeys(runs["run"], mesh)
    figure = pictures.wear_maps(meshes, runs, True, depth_table(meshes, True), "Removed thickness", REMARKS)
    titles = [axes.get_title() for axes in figure.axes if axes.get_title()]
    assert titles[:2] == ["convex sample,\nparticle scale 2", "convex sample,\nparticle scale 8"] and len(titles) == 4
    assert REMARKS[0] in remarks_of(figure)
