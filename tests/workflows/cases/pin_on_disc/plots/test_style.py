"""Figures of the pin-on-disc study: what is drawn is what the tables hold, published values are drawn as published."""

import numpy as np
import pandas as pd
import pytest
from workflows.cases.pin_on_disc.plots.style import coefficient_name
from workflows.cases.pin_on_disc.series import comparison, mesh_series, mesh_stability, size_invariance

from postproc.plots.style import LARGEST_HEIGHT, SMALLEST_FONT, remarks_of
from postproc.wear.coefficient import laboratory_coefficient
from tests import PUBLISHED
from tests.support import pin_study
from workflows.cases.pin_on_disc import figure_tables as pin_figures
from workflows.cases.pin_on_disc.coefficient import scaling_limits
from workflows.cases.pin_on_disc.plots import contours as contour_plots
from workflows.cases.pin_on_disc.plots import disc
from workflows.cases.pin_on_disc.plots import volume as pin_volume
from workflows.cases.pin_on_disc.run_in import run_in_table
from workflows.cases.pin_on_disc.runs import REFERENCE, reference_runs, window_forces
from workflows.cases.pin_on_disc.volume import excess_factors, published_volume

VALUES = pd.read_csv(PUBLISHED / "pin_on_disc.csv")
FITS = pd.read_csv(PUBLISHED / "pin_on_disc_volume.csv")
NORMALITY = pd.read_csv(PUBLISHED / "pin_on_disc_normality.csv")
REMARKS = ["pin softened", "coarse mesh"]
RANGES = ["Yan 2022, Fig 5.10, revolution 10", "Yan 2022, Fig 5.11, revolution 10"]


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """Folder, runs, contours and volumes of the small study."""
    folder = pin_study.write_study(tmp_path_factory.mktemp("pins"))
    return folder, *pin_study.tables(folder)


@pytest.fixture(scope="module")
def figures(study):
    """All figures, by name."""
    return drawn_figures(*study)


def drawn_figures(folder, runs, contours, volumes):
    """All figures of some runs, by name."""
    statistics = pin_figures.statistics_of(runs, contours)
    reference = pin_figures.only_reference(statistics, runs, VALUES, REFERENCE)
    chosen = reference_runs(runs, VALUES, REFERENCE)
    series = mesh_series(runs, statistics.drop(columns="scheme"))
    last = pin_figures.only_reference(contours[contours["revolution"] == 3], runs, VALUES, REFERENCE)
    ranges = pin_figures.published_ranges(VALUES).assign(label=RANGES)
    compared = pin_figures.compared_runs(runs, VALUES)
    cases = pin_figures.compared_cases(compared, contours, volumes, VALUES)
    coefficients = volumes[volumes["series"] == "coefficient"]
    factors = excess_factors(coefficients, FITS)
    meshes, track = pin_figures.reference_discs(folder, runs, VALUES)
    forces = pd.concat([window_forces(folder / run).assign(scheme=scheme) for scheme, run in chosen.items()])
    limits = scaling_limits(run_in_table(reference, NORMALITY), 1302.5)
    laboratory = laboratory_coefficient(*pin_figures.laboratory_volume(VALUES), 5.0, 180.0)
    bars = dict(list(pin_figures.histograms(last).groupby(["scheme", "size"])))
    examples = pin_figures.example_sections(folder, runs[runs["run"].isin(chosen.values())], contours)
    sections = pin_figures.laboratory_sections(folder, compared, cases)
    boxes, segment = pin_figures.laboratory_boxes(VALUES), pin_figures.laboratory_segment(VALUES)
    words = pin_figures.run_in_words(reference, NORMALITY)
    return {
        "run_in": contour_plots.run_in(reference, NORMALITY, words, REMARKS),
        "contour_distribution": contour_plots.contour_distribution(last, bars, ranges, REMARKS),
        "contour_examples": contour_plots.contour_examples(examples, REMARKS),
        "mesh_series": contour_plots.mesh_series(series, mesh_stability(series), REMARKS),
        "mesh_contours": contour_plots.mesh_contours(pin_figures.mesh_sections(folder, runs, series), REMARKS),
        "normal_force": contour_plots.normal_force(forces, dict.fromkeys(chosen, 5.0), REMARKS),
        "laboratory_contour": contour_plots.laboratory_contour(sections, boxes, segment, REMARKS),
        "wear_volume": pin_volume.wear_volume(coefficients, FITS, REMARKS),
        "force_rise": pin_volume.force_rise(factors, REMARKS),
        "excess_volume": pin_volume.excess_volume(pin_figures.shown_factors(factors, VALUES), REMARKS),
        "calibration": pin_volume.calibration(
            pin_figures.calibrated(volumes, FITS, VALUES), laboratory, 1302.5, limits, REMARKS
        ),
        "size_invariance": pin_volume.size_invariance(size_invariance(pin_figures.size_cases(volumes)), 0.6, REMARKS),
        "comparison": pin_volume.comparison(comparison(VALUES, cases), REMARKS),
        "disc_setup": disc.disc_setup(pin_study.ring(0.5), pin_study.TRACK, pin_study.PIN, 5.0, REMARKS),
        "contour_extraction": disc.contour_extraction(next(iter(meshes.values())), track, 90, REMARKS),
        "unrolled_track": disc.unrolled_track(
            {scheme: pin_figures.track_map(mesh, track) for scheme, mesh in meshes.items()}, REMARKS
        ),
        "worn_disc": disc.worn_disc(meshes, track, REMARKS),
    }


def line(axes, label):
    """Values of the line with a label."""
    return next(drawn for drawn in axes.get_lines() if drawn.get_label() == label).get_xydata()


def test_every_figure_says_what_is_reduced(figures):
    """Remarks below every figure, legible type, a size that a page shows."""
    for name, figure in figures.items():
        assert remarks_of(figure) == "; ".join(REMARKS), name
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


def test_load_is_that_of_each_scheme(study):
    """The line of a panel is at the load of its run."""
    folder, *_ = study
    forces = pd.concat(
        [window_forces(folder / run).assign(scheme=name) for name, run in (("conserving", "c"), ("per_triangle", "d"))]
    )
    figure = contour_plots.normal_force(forces, {"conserving": 5.0, "per_triangle": 4.0}, REMARKS)
    lines = [line(axes, label)[0, 1] for axes, label in zip(figure.axes, ("load 5 N", "load 4 N"), strict=True)]
    assert lines == [5.0, 4.0]


@pytest.mark.parametrize("missing", [["d"], ["b", "d", "f"], ["a", "c", "e", "g", "h"]])
def test_designs_with_one_scheme_are_drawn(study, missing):
    """A coefficient that only one scheme has, or a study of one scheme alone: every figure is drawn that has runs."""
    folder, *tables = study
    runs, contours, volumes = (table[~table["run"].isin(missing)] for table in tables)
    for name, figure in drawn_figures(folder, runs, contours, volumes).items():
        assert figure.axes, name


def test_published_volumes_are_drawn_as_published(figures):
    """The dashed line is the printed fit of the panel's coefficient, alpha F L passes through the origin."""
    panel = figures["wear_volume"].axes[0]
    drawn = line(panel, "Yan 2022, Eq 5.11 to 5.15")
    np.testing.assert_allclose(drawn[:, 1], 1e9 * published_volume(FITS, 1.7e-11, drawn[:, 0]))
    law = line(panel, r"$\alpha F L$")
    assert tuple(law[0]) == (0.0, 0.0)
    assert law[-1, 1] == pytest.approx(1e9 * 1.7e-11 * 5.0 * 2 * np.pi * 22e-3 * 3)


def test_stacked_factors_reach_the_product(figures, study):
    """The last coloured bar ends at the product, the hatched one at the published factor."""
    *_, volumes = study
    factors = pin_figures.shown_factors(excess_factors(volumes[volumes["series"] == "coefficient"], FITS), VALUES)
    bars = {group.get_label(): group for group in figures["excess_volume"].axes[0].containers if group.get_label()}
    tops = [bar.get_y() + bar.get_height() for bar in bars["Eq 5.9 over touched triangles"]]
    np.testing.assert_allclose(tops, factors["product"])
    tops = [bar.get_y() + bar.get_height() for bar in bars["left unexplained"]]
    np.testing.assert_allclose(tops, factors["published"])


def test_comparison_prints_the_published_differences(figures):
    """The thesis' row of the printed table: 36, 34 and -6 per cent to the laboratory."""
    table = next(axes.tables[0] for axes in figures["comparison"].axes if axes.tables)
    cells = [table.get_celld()[2, column].get_text().get_text() for column in range(4, 7)]
    assert cells == ["+36", "+34", "-6"]


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
