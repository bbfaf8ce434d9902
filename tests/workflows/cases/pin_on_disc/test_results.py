"""The generated page of results: its tables are those of the study's figures, its words follow from them."""

import pandas as pd
import pytest

from tests.support import pin_study
from workflows.cases.pin_on_disc import results as pin_results
from workflows.cases.pin_on_disc.results import PUBLISHED
from workflows.report.markdown import markdown

PUBLISHED_VALUES = pd.read_csv(PUBLISHED / "pin_on_disc.csv")
STABILITY = pd.DataFrame(
    [
        ("conserving", "depth", 2, 1.5, True),
        ("conserving", "opening width", 2, 3.25, True),
        ("per_triangle", "depth", 1, float("nan"), False),
    ],
    columns=["scheme", "size", "meshes", "difference_percent", "stable"],
)


def test_table_in_markdown():
    """A head, a line, and a row per row; numbers with few digits, words without underscores."""
    table = pd.DataFrame({"scheme": ["per_triangle"], "depth_mm": [0.0123456], "revolutions": [12]})
    assert markdown(table).splitlines() == [
        "| scheme | depth mm | revolutions |",
        "| --- | --- | --- |",
        "| per triangle | 0.0123 | 12 |",
    ]


def write_series(folder):
    """A series of two meshes of each scheme as the figure leaves it."""
    rows = [
        (scheme, element, size, mean)
        for scheme, factor in (("conserving", 1.0), ("per_triangle", 3.0))
        for element, depth, width in ((0.1, 0.003, 0.9), (1.0, 0.001, 1.4))
        for size, mean in (("depth", factor * depth), ("opening width", width))
    ]
    (folder / "figures").mkdir()
    table = pd.DataFrame(rows, columns=["scheme", "element_size_mm", "size", "mean_mm"])
    table.assign(revolution=12).to_csv(folder / "figures" / "mesh_series.csv", index=False)


def test_sentence_of_the_meshes(tmp_path):
    """Both ends of the series are named, the largest difference, and whether it is within 5 %; one mesh alone is no
    comparison.
    """
    write_series(tmp_path)
    text = " ".join(pin_results.mesh_text(tmp_path, STABILITY, PUBLISHED_VALUES).split("\n\n")[0].split())
    assert text == (
        "After revolution 12: conserving, elements of 0.1 to 1 mm: depth 3 to 1 µm, opening 0.9 to 1.4 mm; per "
        "triangle, elements of 0.1 to 1 mm: depth 9 to 3 µm, opening 0.9 to 1.4 mm. Meshes "
        "with elements up to 1/5 of the groove's width differ by: conserving: up to 3.2 % among 2 meshes, "
        "within 5 %; per triangle: fewer than two meshes are that fine, nothing is compared."
    )


def test_coefficient_of_the_laboratory_is_stated(tmp_path):
    """(6.28 +- 0.99)e-13 beside the published (6.3 +- 1)e-13; the limit by the cap names cycles and elements."""
    pin_study.write_study(tmp_path)
    (tmp_path / "figures").mkdir()
    pd.DataFrame({"run": ["a"], "largest_factor": [162.8]}).to_csv(tmp_path / "figures" / "scaling_limits.csv")
    text = pin_results.calibration_text(tmp_path, pd.DataFrame({"revolutions": [12]}), PUBLISHED_VALUES)
    assert "(6.28 ± 0.99)e-13 1/Pa" in text
    assert "162.8" in text
    words = " ".join(text.split())
    assert "holds for 2 wear cycles per revolution and elements of 0.5 mm on the track only." in words
    assert "A run-in that ends with revolution 1 sets no limit" in words


def test_first_revolution_of_conserving_runs():
    """The product of rise and slip less 1, in per cent, least to largest; other runs and revolutions do not count."""
    factors = pd.DataFrame(
        [
            ("conserving", 1, 1.001, 1.0),
            ("conserving", 1, 1.002, 1.001),
            ("conserving", 2, 1.5, 1.0),
            ("per_triangle", 1, 2.0, 1.0),
        ],
        columns=["scheme", "revolution", "force_rise", "slip"],
    )
    assert "by 0.1 to 0.3 %." in pin_results.first_revolution(factors)


def test_scheme_without_runs_is_not_spoken_of():
    """A study of one scheme says nothing of the other."""
    columns = ["run", "scheme", "revolution", "wear_coefficient_per_pa", "force_rise", "slip", "published"]
    one = pd.DataFrame([("a", "per_triangle", 1, 1.7e-11, 1.0, 1.0, 3.1)], columns=columns)
    assert pin_results.first_revolution(one) == ""
    assert pin_results.what_is_left(one.assign(scheme="conserving")) == ""


def test_what_the_rules_leave():
    """Ranges over per-triangle runs with a published fit, and what is left at the end of each."""
    rows = [
        ("a", "per_triangle", 1, 1.7e-11, 1.0, 6.1, 0.5, 3.1, 1.02),
        ("a", "per_triangle", 2, 1.7e-11, 1.01, 6.3, 0.7, 4.0, 0.9),
        ("b", "per_triangle", 1, 6.8e-11, 1.5, 9.0, 0.1, float("nan"), float("nan")),
        ("c", "conserving", 1, 1.7e-11, 1.0, 1.0, 1.0, 3.1, 3.1),
    ]
    names = ("run", "scheme", "revolution", "wear_coefficient_per_pa", "force_rise", "displacement_rule")
    factors = pd.DataFrame(rows, columns=[*names, "summing_rule", "published", "unexplained"])
    text = pin_results.what_is_left(factors)
    assert "1 to 1.01 of the load" in text and "takes 6.1 to 6.3 times" in text and "finds 0.5 to 0.7 of that" in text
    assert text.endswith("0.9 to 1.02 times this product, after the last revolution 0.9 at 1.7e-11 1/Pa.")


def test_durations_are_those_of_all_cycles(tmp_path):
    """Seconds of solver and of the rest summed over the cycles: 2 minutes, three quarters the solver's."""
    pin_study.write_study(tmp_path)
    runs = pd.read_csv(tmp_path / "design.csv")["run"]
    for run in runs:
        rows = {"solver_s": [60.0, 30.0], "other_s": [10.0, 20.0], "steps": [100, 50], "particles": 1}
        pd.DataFrame(rows).to_csv(tmp_path / run / "cost.csv", index=False)
    lines = [line for line in pin_results.durations(tmp_path).splitlines() if line.startswith(f"| {runs.iloc[0]} ")]
    assert [cell.strip() for cell in lines[0].split("|")[-4:-1]] == ["150", "2", "0.75"]


def test_only_sections_with_a_table_are_written(tmp_path):
    """A study without a series of meshes has no section on it."""
    assert pin_results.sections(tmp_path) == []
    write_series(tmp_path)
    STABILITY.to_csv(tmp_path / "figures" / "mesh_stability.csv", index=False)
    (section,) = pin_results.sections(tmp_path)
    assert section.startswith("## Dependence on the mesh\n")
    assert "![mesh series](pin_on_disc_mesh_series.png)" in section


def test_a_study_that_is_not_finished_is_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"design.csv"):
        pin_results.write_results(tmp_path, tmp_path)
