"""Figures of the pin-on-disc study: what is drawn is what the tables hold, published values are drawn as published."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.plots.style import LARGEST_HEIGHT, SMALLEST_FONT, remarks_of
from bulkwear.workflows.cases.pin_on_disc.plots import contours as contour_plots
from bulkwear.workflows.cases.pin_on_disc.plots.contours import coefficient_name
from bulkwear.workflows.cases.pin_on_disc.runs import window_forces
from bulkwear.workflows.cases.pin_on_disc.volume import published_volume
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.worn_pair import LAW_FIGURES
from bulkwear.workflows.report.products import figures_of, products_of
from tests import PUBLISHED
from tests.support import pin_study
from tests.support.charts import drawn_chart, names, values

FITS = pd.read_csv(PUBLISHED / "pin_on_disc_volume.csv")
NORMALITY = pd.read_csv(PUBLISHED / "pin_on_disc_normality.csv")
RANGES = ["Yan 2022, Fig 5.10, revolution 10", "Yan 2022, Fig 5.11, revolution 10"]
OF_SERIES = {"mesh": {"mesh_series", "mesh_contours"}, "size": {"size_invariance"}}  # where the design has it


@pytest.mark.parametrize("left_out", ["mesh", "size"])
def test_a_design_without_a_series_has_no_figures_of_it(left_out):
    """It leaves out the figures of that series, and no other."""

    def names(*series):
        rows = [{"series": name} for name in series]
        return {each.name for each in figures_of(SimpleNamespace(case=find_case("pin_on_disc"), design_rows=rows))}

    whole, fewer = names("coefficient", *OF_SERIES), names("coefficient", *(OF_SERIES.keys() - {left_out}))
    assert whole - fewer == OF_SERIES[left_out] and fewer < whole


def test_the_comparison_comes_first():
    """What answers the question of a study stands before the source's other figures, all of which it has."""
    names = [each.name for each in figures_of(load_study("pin_on_disc", overrides={"fidelity": "standard"}))]
    assert names[:3] == ["pin_comparison", "excess_volume", "wear_volume"] and len(names) == 19


def test_every_figure_is_drawn_and_leaves_its_table(figures, pins):
    """Seventeen figures, a table beside each, and the tables that go with them."""
    folder = pins[0] / "figures"
    further = {"wear_volume_trends", "run_in_change_points", "scaling_limits", "mesh_stability"}
    assert {path.stem for path in folder.glob("*.csv")} == {*figures, *further} and len(figures) == 17


def test_charts_show_the_tables_beside_published_values(figures, pins):
    """Volumes by coefficient with the source's fit and Archard's; coefficients with the laboratory's; both sizes."""
    products = products_of(find_case("pin_on_disc"))
    charted = [name for name, product in products.items() if product.charts and name not in LAW_FIGURES]
    tables = {name: pd.read_csv(pins[0] / "figures" / f"{name}.csv") for name in charted}
    volume = drawn_chart(products["wear_volume"], tables["wear_volume"])
    table = tables["wear_volume"]
    of_first = table[table["wear_coefficient_per_pa"] == table["wear_coefficient_per_pa"].iloc[0]]
    conserving = of_first[of_first["scheme"] == "conserving"]
    assert values(volume, "conserving") == [pytest.approx(1e9 * conserving["removed_volume_m3"], rel=1e-5)]
    work = conserving["wear_coefficient_per_pa"] * conserving["load_n"] * 2e9 * np.pi * conserving["track_radius_m"]
    assert values(volume, "alpha F L") == [pytest.approx(work * conserving["revolution"], rel=1e-5)]
    assert "Yan 2022, Eq 5.11 to 5.15" in names(volume)
    assert len(volume["panels"]) == table["wear_coefficient_per_pa"].nunique()
    assert set(names(drawn_chart(products["force_rise"], tables["force_rise"]))) == set(
        table["scheme"].str.replace("_", " ")
    )
    calibrated = drawn_chart(products["calibration"], tables["calibration"])
    law = 6.3e-13 * 1302.5 / tables["calibration"]["revolutions"].drop_duplicates()
    assert values(calibrated, "laboratory's, by Archard") == [pytest.approx(law, rel=0.01)]  # 6.3 is rounded
    sizes = drawn_chart(products["run_in"], tables["run_in"])
    depth = tables["run_in"].query("size == 'depth'")
    drawn = [value for scheme in names(sizes) for curve in values(sizes, scheme) for value in curve]
    assert sorted(drawn) == pytest.approx(sorted(1e6 * depth["mean_m"]), rel=1e-5)
    meshes, mesh = drawn_chart(products["mesh_series"], tables["mesh_series"]), tables["mesh_series"]
    widths = [value for scheme in names(meshes) for curve in values(meshes, scheme, 1) for value in curve]
    assert sorted(widths) == pytest.approx(sorted(mesh.query("size == 'opening width'")["mean_mm"]), rel=1e-5)
    bound = drawn_chart(
        products["size_invariance"],
        tables["size_invariance"],
        published=pd.read_csv(PUBLISHED / "pin_on_disc.csv"),
    )
    assert values(bound, "Yan 2022, at most") == [[0.6, 0.6], [-0.6, -0.6]]
    compared = drawn_chart(products["pin_comparison"], tables["pin_comparison"])
    assert values(compared, "volume", 2, "x") == [pytest.approx(tables["pin_comparison"]["volume_mm3"], rel=1e-5)]


def test_the_worn_disc_has_the_table_of_its_track(figures, pins):
    """Picture and map of the track show the same depths."""
    tables = [pd.read_csv(pins[0] / "figures" / f"{name}.csv") for name in ("worn_disc", "unrolled_track")]
    pd.testing.assert_frame_equal(*tables)
    assert tables[0]["scheme"].nunique() == 2


def test_the_set_up_tells_the_run_that_is_drawn(figures, pins):
    """One row, of the run with the thesis' coefficient, all columns of the design."""
    row = pd.read_csv(pins[0] / "figures" / "disc_setup.csv")
    assert row["run"].tolist() == ["c"] and set(pins[1]) == set(row)


def test_the_excess_says_how_long_an_update_is(figures):
    """What the published groove holds comes first, then the length of an update."""
    said = remarks_of(figures["excess_volume"])
    assert said.startswith("a round groove of the published depth") and f"; {pin_study.UPDATES}; " in said


def line(axes, label):
    """Values of the line with a label."""
    return next(drawn for drawn in axes.get_lines() if drawn.get_label() == label).get_xydata()


def test_every_figure_says_what_is_reduced(figures):
    """Remarks below every figure, legible type, a size that a page shows."""
    for name, figure in figures.items():
        assert remarks_of(figure).endswith("; ".join(pin_study.REMARKS)), name
        assert figure.get_figheight() <= LARGEST_HEIGHT, name
        texts = [text for axes in figure.axes for text in axes.texts if text.get_text()]
        assert all(text.get_fontsize() >= SMALLEST_FONT for text in texts), name


def test_axes_have_units(figures):
    """Every labelled axis names its unit in parentheses, or that it has none; counts and places are exceptions."""
    without = {"Revolution", "Revolutions", "Row of the table below", "Simulated revolutions that stand for the test"}
    for name, figure in figures.items():
        labels = {label for axes in figure.axes for label in (axes.get_xlabel(), axes.get_ylabel()) if label}
        labels |= {label for label in (figure.get_supxlabel(), figure.get_supylabel()) if label}
        assert {label for label in labels - without if "(" not in label} == set(), name
        assert labels or name == "worn_disc", name


def test_published_p_values_are_drawn_as_published(figures):
    """Crosses at the values of Table 5.3 where they are not below the axis."""
    drawn = line(figures["run_in"].axes[2], "Yan 2022, Table 5.3")
    np.testing.assert_allclose(drawn[:, 0], NORMALITY["revolution"])
    np.testing.assert_allclose(drawn[5:, 1], NORMALITY["depth_p_value"][5:])


def test_published_ranges_are_drawn_as_published(figures):
    """Shaded from 42 to 70 um and from 0.8 to 1.6 mm, named in the legend."""
    figure = figures["contour_distribution"]
    for axes, label, bounds in zip(figure.axes[::2], RANGES, ((42.0, 70.0), (0.8, 1.6)), strict=True):
        band = next(patch for patch in axes.patches if patch.get_label() == label)
        np.testing.assert_allclose([band.get_y(), band.get_y() + band.get_height()], bounds)
    assert set(RANGES) < {text.get_text() for text in figure.legends[0].get_texts()}


def test_load_is_that_of_each_scheme(pins):
    """The line of a panel is at the load of its run."""
    folder, *_ = pins
    forces = pd.concat(
        [window_forces(folder / run).assign(scheme=name) for name, run in (("conserving", "c"), ("per_triangle", "d"))]
    )
    figure = contour_plots.normal_force(forces, {"conserving": 5.0, "per_triangle": 4.0}, pin_study.REMARKS)
    lines = [line(axes, label)[0, 1] for axes, label in zip(figure.axes, ("load 5 N", "load 4 N"), strict=True)]
    assert lines == [5.0, 4.0]


OTHERS_MISSING = (["d"], ["a", "c", "e", "g", "h"])  # rows


@pytest.mark.parametrize(
    "missing", [["b", "d", "f"], *(pytest.param(each, marks=pytest.mark.verify) for each in OTHERS_MISSING)]
)
def test_designs_with_one_scheme_are_drawn(pins, missing, tmp_path):
    """A coefficient that only one scheme has, or a study of one scheme alone: every figure is drawn that has runs."""
    figures = pin_study.drawn(pin_study.without(pins[0], missing, tmp_path))
    assert len(figures) >= 16
    for name, figure in figures.items():
        assert figure.axes, name


def test_published_volumes_are_drawn_as_published(figures):
    """The dashed line is the printed fit of the panel's coefficient, alpha F L passes through the origin; the title
    says how each reading grows, and of three revolutions that its scatter is unknown.
    """
    panel = figures["wear_volume"].axes[0]
    _, *changes = panel.get_title(loc="left").splitlines()
    assert [words.partition(":")[0] for words in changes] == ["conserving", "per triangle", "Eq 5.9, touched"]
    assert all(words.endswith("scatter unknown") for words in changes)
    drawn = line(panel, "Yan 2022, Eq 5.11 to 5.15")
    np.testing.assert_allclose(drawn[:, 1], 1e9 * published_volume(FITS, 1.7e-11, drawn[:, 0]))
    law = line(panel, r"$\alpha F L$")
    assert tuple(law[0]) == (0.0, 0.0)
    assert law[-1, 1] == pytest.approx(1e9 * 1.7e-11 * 5.0 * 2 * np.pi * 22e-3 * 3)


def test_stacked_factors_reach_the_product(figures, pins):
    """The last coloured bar ends at the product, the hatched one at the published factor."""
    factors = pd.read_csv(pins[0] / "figures" / "excess_volume.csv")
    bars = {group.get_label(): group for group in figures["excess_volume"].axes[0].containers if group.get_label()}
    tops = [bar.get_y() + bar.get_height() for bar in bars["Eq 5.9 over touched triangles"]]
    np.testing.assert_allclose(tops, factors["product"])
    tops = [bar.get_y() + bar.get_height() for bar in bars["left unexplained"]]
    np.testing.assert_allclose(tops, factors["published"])


def test_comparison_prints_the_published_differences(figures):
    """At the thesis' bars, the second ones: 36, 34 and -6 per cent off the laboratory, which has no words."""
    words = [[text.get_text() for text in axes.texts] for axes in figures["pin_comparison"].axes]
    assert [of_axes[:2] for of_axes in words] == [["", "+36 %"], ["", "+34 %"], ["", "-6 %"]]


def test_exaggeration_is_written_at_the_picture(figures):
    """Both pictures in 3-D say by how much depth and width are exaggerated."""
    titles = [axes.get_title() for axes in figures["worn_disc"].axes if axes.get_title()]
    assert len(titles) == 2
    assert all("depth exaggerated" in title and "width 5 times" in title for title in titles)


def test_pictures_in_3d_show_the_track(figures):
    """The rendered pictures are not blank."""
    for axes in figures["worn_disc"].axes[:2]:
        assert axes.get_images()[0].get_array().std() > 1.0


@pytest.mark.parametrize(
    ("coefficient", "digits"), [(1.7e-11, r"1.7·10$^{-11}$"), (5e-11, r"5·10$^{-11}$"), (6.3e-13, r"6.3·10$^{-13}$")]
)
def test_coefficients_are_written_with_their_power(coefficient, digits):
    assert digits in coefficient_name(coefficient)
