"""Figures of a screening regression draw their tables, with units and remarks."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.plots.style import remarks_of
from bulkwear.postproc.statistics.factors import Factor
from bulkwear.workflows.cases.sliding_sample.screening.plots import regression
from bulkwear.workflows.cases.sliding_sample.screening.study_regression import (
    chance_test,
    chosen_coefficients,
    effects,
    pairs_to_show,
    residuals,
    response_surface,
    screen,
)
from tests import REPOSITORY
from tests.support.screening_study import factors_of

REMARKS = ["particles at scale 2", "travel 160 mm of 1000 mm"]
LABELS = {name: f"{name} (mm)" for name in "abdhvt"}
ROUNDING = 1e-12


@pytest.fixture(scope="module")
def published():
    """Tables 3.9 and 3.10."""
    return pd.read_csv(REPOSITORY / "config/published/screening_coefficients.csv")


@pytest.fixture(scope="module")
def study(published):
    """Wear by the published model and the parents of its product, at the runs of Table 3.8, with little noise."""
    design = pd.read_csv(REPOSITORY / "config/designs/screening.csv")
    columns = list(design.columns[1:])
    found = zip("abdhvt", factors_of(design, columns), strict=True)
    factors = {factor.name: Factor(short, factor.low, factor.high, factor.spacing) for short, factor in found}
    a, b, d, _, v, t = (factor.coded(design[column]) for column, factor in factors.items())
    constant, *slopes = published["coefficient"]
    noise = np.random.default_rng(4).normal(0.0, 0.03, 13)
    return screen(design, factors, np.exp(constant + np.dot(slopes, [a, v, t, b * d]) + b - d + noise))


def test_coefficients_stand_beside_the_published(study, published):
    """Both sets are drawn as tabled, on one line per term, with the source named and p values of both kinds."""
    table = chosen_coefficients(study, chance_test(study, 19))
    figure = regression.coefficients(table, published, REMARKS)
    axes = figure.axes[0]
    assert [label.get_text() for label in axes.get_yticklabels()] == ["Constant", "a", "b", "d", "v", "t", "b·d"]
    drawn = {line.get_label(): line.get_xdata().astype(float) for line in axes.lines if len(line.get_xdata()) > 2}
    np.testing.assert_allclose(drawn["Yan 2022, Table 3.10"], published["coefficient"], rtol=ROUNDING)
    np.testing.assert_allclose(axes.containers[0][0].get_xdata().astype(float), table["coefficient"], rtol=ROUNDING)
    texts = [text.get_text() for text in axes.texts]
    assert texts[0] == "p < 0.001"
    assert all("by permutation" in text for text in texts[1:7])
    assert texts[7:] == ["p < 0.001", "p 0.032", "p 0.007", "p < 0.001", "p 0.013"]
    assert "(-)" in axes.get_xlabel()
    assert remarks_of(figure) == "; ".join(REMARKS)


def test_a_term_of_one_side_only_has_a_line(study, published):
    """A term that only one of the two models has is shown, with the other's place empty."""
    table = chosen_coefficients(study, chance_test(study, 19))
    figure = regression.coefficients(table[table["term"] != "a"], published[published["term"] != "v"], REMARKS)
    labels = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert sorted(labels) == sorted(["Constant", "a", "b", "d", "v", "t", "b·d"])


def test_residuals_are_drawn_twice(study):
    """Against normal scores and against fitted values; the largest are named with their runs."""
    table = residuals(study)
    figure = regression.residual_plots(table, REMARKS)
    normal, fitted = figure.axes
    np.testing.assert_allclose(normal.lines[0].get_xydata(), table[["residual", "normal_score"]], rtol=ROUNDING)
    np.testing.assert_allclose(fitted.lines[0].get_xydata(), table[["fitted", "residual"]], rtol=ROUNDING)
    largest = set(table.loc[table["residual"].abs().nlargest(3).index, "row"])
    for axes in figure.axes:
        assert {text.get_text() for text in axes.texts} == largest
    assert remarks_of(figure) == "; ".join(REMARKS)


def test_half_normal_plot_names_the_largest(study):
    """Sizes against scores as tabled; the published terms are named, the line has Lenth's error as slope."""
    table = effects(study)
    figure = regression.half_normal(table, REMARKS)
    points, line = figure.axes[0].lines
    np.testing.assert_allclose(points.get_ydata(), table["contrast"].abs(), rtol=ROUNDING)
    slope = line.get_ydata()[1] / line.get_xdata()[1]
    assert slope == pytest.approx(table["pseudo_error"][0])
    assert {"a", "v", "t", "b·d"} <= {text.get_text() for text in figure.axes[0].texts}
    assert remarks_of(figure) == "; ".join(REMARKS)


def test_contours_have_real_units(study):
    """One panel per pair with the factors' levels as ticks, doubling ones on a logarithmic axis, and a labelled bar."""
    surface = response_surface(study, pairs_to_show(study), 11).assign(published_wear=np.nan)
    figure = regression.response_contours(surface, LABELS, ["a", "b", "v", "t"], REMARKS)
    *panels, bar = figure.axes
    assert [(axes.get_xlabel(), axes.get_ylabel()) for axes in panels] == [
        ("b (mm)", "d (mm)"),
        ("d (mm)", "t (mm)"),
        ("b (mm)", "t (mm)"),
        ("v (mm)", "t (mm)"),
    ]
    assert (panels[0].get_xscale(), panels[0].get_yscale()) == ("log", "linear")
    assert [label.get_text() for label in panels[0].get_yticklabels()] == ["20", "40", "60"]
    assert [label.get_text() for label in panels[0].get_xticklabels()] == ["2", "4", "8"]
    assert "(-)" in bar.get_ylabel()
    assert remarks_of(figure) == "; ".join(REMARKS)


def test_a_surface_that_is_flat_is_drawn():
    """A model of nothing gives one even panel, not an error."""
    rng = np.random.default_rng(1)
    design = pd.DataFrame({"row": [f"R{k}" for k in range(4)], "x": [1.0, 2.0, 3.0, 4.0], "z": [2.0, 1.0, 4.0, 3.0]})
    factors = {"x": Factor("a", 1.0, 4.0), "z": Factor("b", 1.0, 4.0)}
    study = screen(design, factors, rng.uniform(1.0, 2.0, 4))
    assert study.model.terms == ()
    surface = response_surface(study, pairs_to_show(study), 5).assign(published_wear=np.nan)
    figure = regression.response_contours(surface, LABELS, [], REMARKS)
    assert len(figure.axes) == 2


def test_surface_is_the_models_prediction(study):
    """At the middle of every factor the surface has e to the constant."""
    surface = response_surface(study, [(1, 2)], 3).assign(published_wear=np.nan)
    middle = surface[(surface["x"] == 4.0) & (surface["y"] == 40.0)]["normalised_wear"].item()
    assert middle == pytest.approx(np.exp(study.model.coefficients[0]))
