"""Runs against each other, thesis and laboratory: selections, differences and closed forms by hand."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.tables.summary import published_value
from bulkwear.workflows.cases.pin_on_disc.comparison import (
    LABORATORY_ANGLES,
    circular_segment,
    compared_cases,
    compared_runs,
    comparison,
    laboratory_boxes,
    laboratory_sections,
    mesh_series,
    mesh_stability,
)
from bulkwear.workflows.cases.pin_on_disc.run_in import SIZES, statistics_of
from bulkwear.workflows.cases.pin_on_disc.runs import REFERENCE, coefficient_remark
from tests import PUBLISHED

VALUES = pd.read_csv(PUBLISHED / "pin_on_disc.csv")
RUNS = pd.DataFrame(
    [
        ("a", "coefficient", "conserving", 5e-11, 0.1),
        ("b", "mesh", "conserving", 5e-11, 0.2),
        ("c", "mesh", "conserving", 5e-11, 0.4),
        ("d", "mesh", "per_triangle", 5e-11, 0.2),
        ("e", "coefficient", "conserving", 1e-11, 0.1),
        ("f", "size", "conserving", 5e-11, 1.0),
    ],
    columns=["run", "series", "scheme", "wear_coefficient_per_pa", "element_size_mm"],
)
MEANS = {"a": 1.00e-3, "b": 1.04e-3, "c": 1.60e-3, "d": 2.0e-3, "e": 1.0e-3, "f": 1.0e-3}  # m
REVOLUTIONS = {"a": 12, "b": 3, "c": 2, "d": 2, "e": 12, "f": 1}


def statistics():
    """Statistics of the runs: every size of a run has the same mean, larger by a hundredth each revolution."""
    return pd.DataFrame(
        [
            {"run": run, "revolution": n, "size": size, "mean_m": mean * (1 + 0.01 * n), "deviation_m": 0.1 * mean}
            for run, mean in MEANS.items()
            for n in range(1, REVOLUTIONS[run] + 1)
            for size in SIZES
        ]
    )


def test_mesh_series_compares_like_with_like():
    """Only runs with the coefficient of the mesh series, at the last revolution that all have, by scheme and edge."""
    table = mesh_series(RUNS, statistics())
    assert list(dict.fromkeys(table["run"])) == ["a", "b", "c", "d"]
    assert set(table["revolution"]) == {2}
    depth = table[table["size"] == "depth"]
    np.testing.assert_allclose(depth["mean_mm"], [1.02, 1.0608, 1.632, 2.04])


def test_without_a_mesh_series_the_table_is_empty():
    assert mesh_series(RUNS[RUNS["series"] != "mesh"], statistics()).empty


def test_stability_counts_fine_meshes_only():
    """The groove of the finest mesh is 1.02 mm wide: 0.1 and 0.2 mm count (4 % apart), 0.4 does not; one mesh alone
    says nothing."""
    stable = mesh_stability(mesh_series(RUNS, statistics())).set_index(["scheme", "size"])
    of_ours = stable.loc[("conserving", "depth")]
    assert of_ours["meshes"] == 2
    assert of_ours["difference_percent"] == pytest.approx(4.0)
    assert of_ours["stable"]
    of_theirs = stable.loc[("per_triangle", "depth")]
    assert of_theirs["meshes"] == 1
    assert not of_theirs["stable"]


def test_segment_of_the_laboratory():
    """0.565 mm3 over a track of 138.2 mm in the shape of a 3 mm pin: 0.528 mm wide and 0.0116 mm deep."""
    depth, width = circular_segment(0.565e-9 / (2.0 * np.pi * 22e-3), 3e-3)
    assert width == pytest.approx(0.528e-3, rel=1e-3)
    assert depth == pytest.approx(11.6e-6, rel=3e-3)
    assert 2.0 / 3.0 * depth * width * 2.0 * np.pi * 22e-3 == pytest.approx(0.565e-9)


def test_comparison_has_the_published_differences():
    """Table 5.4: the thesis' depth, width and volume differ from the laboratory's by 36, 34 and 6 per cent."""
    ours = pd.DataFrame([{"case": "ours", "run": "a", "depth_mm": 0.0095, "width_mm": 0.535, "volume_mm3": 0.565}])
    table = comparison(VALUES, ours).set_index("case")
    to_laboratory = [f"{name}_to_laboratory_percent" for name in ("depth", "width", "volume")]
    np.testing.assert_allclose(table.loc["Yan 2022", to_laboratory].astype(float), [36, 34, -6], atol=0.5)
    assert table.loc["ours", "volume_to_laboratory_percent"] == pytest.approx(0.0)
    assert table.loc["ours", "depth_to_thesis_percent"] == pytest.approx(-50.0)


def test_a_value_that_is_not_published_is_refused():
    with pytest.raises(ValueError, match="is there 0 times"):
        published_value(VALUES, "colour", "laboratory")


def test_mesh_series_takes_its_finest_from_the_coefficients(pins):
    """The mesh that only the series of coefficients has is that of the same coefficient."""
    _, runs, contours, _ = pins
    series = mesh_series(runs, statistics_of(runs, contours).drop(columns="scheme"))
    finest = series[series["element_size_mm"] == 0.5]
    assert set(finest["run"]) == {"c", "d"}
    shown = runs[runs["run"].isin(series["run"])]
    assert coefficient_remark(shown, VALUES, REFERENCE) == "wear coefficient 5e-11 1/Pa"


def test_compared_cases(pins):
    """Reference runs, the run whose law has the laboratory's volume, then the pin's shape, at the last revolution.

    The means are those of the contours; the pin's shape has the laboratory's volume.
    """
    _, runs, contours, volumes = pins
    compared = compared_runs(runs, VALUES)
    cases = compared_cases(compared, contours, volumes, VALUES)
    assert cases["run"].tolist() == ["a", "b", "h", ""]
    last = contours[(contours["run"] == "b") & (contours["revolution"] == 3)]
    assert cases.loc[1, "depth_mm"] == pytest.approx(1e3 * last["depth_m"].mean())
    assert cases.loc[1, "case"] == "per triangle, 1.7e-11/Pa, 3 rev."
    table = comparison(VALUES, cases)
    assert table["case"].tolist()[:2] == ["laboratory", "Yan 2022"]
    assert table.iloc[-1]["volume_to_laboratory_percent"] == pytest.approx(0.0)


def test_another_load_has_the_laboratorys_volume_with_another_coefficient(pins):
    """At twice the load half the coefficient removes it, not the same; cases tell their load and the source's."""
    _, runs, contours, volumes = pins
    doubled = runs.assign(load_n=2.0 * runs["load_n"])
    half = doubled.assign(wear_coefficient_per_pa=0.5 * doubled["wear_coefficient_per_pa"])
    assert ["h" in set(compared_runs(each, VALUES)["run"]) for each in (runs, doubled, half)] == [True, False, True]
    cases = compared_cases(compared_runs(doubled, VALUES), contours, volumes, VALUES)
    assert cases.loc[1, "case"] == "per triangle, 1.7e-11/Pa, 3 rev., 10 N instead of 5 N"


def test_sections_beside_the_laboratory(pins):
    """Three angles of every compared run under the name of its case."""
    folder, runs, contours, volumes = pins
    compared = compared_runs(runs, VALUES)
    cases = compared_cases(compared, contours, volumes, VALUES)
    sections = laboratory_sections(folder, compared, cases)
    assert list(dict.fromkeys(sections["case"])) == cases["case"].tolist()[:3]
    assert set(sections["angle_deg"]) == set(LABORATORY_ANGLES)
    boxes = laboratory_boxes(VALUES)
    np.testing.assert_allclose(boxes[["depth_mm", "width_mm"]], [[0.010, 0.65], [0.014, 0.8]])
