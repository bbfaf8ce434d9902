"""The generated page of results: its tables are those of the study's figures, its words follow from them."""

import pandas as pd
import pytest

from workflows import pin_results
from workflows.pin_results import PUBLISHED, markdown

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


def test_sentence_of_the_meshes(tmp_path):
    """The largest difference is named, and whether it is within 5 %; one mesh alone is no comparison."""
    text = " ".join(pin_results.mesh_text(tmp_path, STABILITY, PUBLISHED_VALUES).split("\n\n")[0].split())
    assert text == (
        "Meshes with elements up to 1/5 of the groove's width differ by: conserving: up to 3.2 % among 2 meshes, "
        "within 5 %; per triangle: fewer than two meshes are that fine, nothing is compared."
    )


def test_coefficient_of_the_laboratory_is_stated(tmp_path):
    """(6.28 +- 0.99)e-13 beside the published (6.3 +- 1)e-13."""
    (tmp_path / "figures").mkdir()
    pd.DataFrame({"run": ["a"], "largest_factor": [162.8]}).to_csv(tmp_path / "figures" / "scaling_limits.csv")
    text = pin_results.calibration_text(tmp_path, pd.DataFrame({"revolutions": [12]}), PUBLISHED_VALUES)
    assert "(6.28 ± 0.99)e-13 1/Pa" in text
    assert "162.8" in text


def test_only_sections_with_a_table_are_written(tmp_path):
    """A study without a series of meshes has no section on it."""
    (tmp_path / "figures").mkdir()
    assert pin_results.sections(tmp_path) == []
    STABILITY.to_csv(tmp_path / "figures" / "mesh_stability.csv", index=False)
    (section,) = pin_results.sections(tmp_path)
    assert section.startswith("## Dependence on the mesh\n")
    assert "![mesh series](pin_on_disc_mesh_series.png)" in section


def test_a_study_that_is_not_finished_is_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"design.csv"):
        pin_results.write_results(tmp_path, tmp_path)
