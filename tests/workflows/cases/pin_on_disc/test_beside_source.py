"""Numbers of the source's pin on disc beside ours, by made-up tables of the page."""

import pandas as pd
import pytest

from bulkwear.postproc.statistics.verdicts import UNSAID
from bulkwear.workflows.cases.pin_on_disc.beside_source import (
    ARITHMETIC,
    coefficients_beside_source,
    differences_beside_source,
    sizes_beside_source,
)
from bulkwear.workflows.cases.pin_on_disc.comparison import comparison
from bulkwear.workflows.report.published import GIVEN, published_numbers
from bulkwear.workflows.report.sections import Section, Table
from tests import PUBLISHED

SOURCE = pd.read_csv(PUBLISHED / "pin_on_disc.csv")
CASES = pd.DataFrame(
    [
        ("conserving, 1.7e-11/Pa", "c17", 0.002, 0.7, 0.14),
        ("conserving, 6.8e-11/Pa", "c68", 0.007, 0.6, 0.566),
        ("per triangle, 1.7e-11/Pa", "t17", 0.038, 1.07, 0.9),
        ("pin's shape", "", 0.01, 0.5, 0.565),
    ],
    columns=["case", "run", "depth_mm", "width_mm", "volume_mm3"],
)


def told(beside):
    """The lines that the page of published numbers gets, by finding."""
    table = published_numbers([Section("Pin", [Table(pd.DataFrame({"shown": [1]}), beside_source=beside)])])
    return table.set_index("finding")


def test_sizes_of_laboratory_and_thesis_stand_beside_the_run_of_their_rule():
    """The conserving run of the laboratory's volume, which is given; the thesis' own rule; a shape is no run."""
    table = told(sizes_beside_source(comparison(SOURCE, CASES), SOURCE))
    laboratory, thesis = "laboratory, conserving, 6.8e-11/Pa", "thesis, per triangle, 1.7e-11/Pa"
    names = ("depth", "width", "volume")
    assert list(table.index) == [f"{name}, {of}" for of in (laboratory, thesis) for name in names]
    assert table["factor"].tolist() == pytest.approx([0.5, 0.75, 0.566 / 0.565, 2.0, 1.0, 0.9 / 0.532])
    assert table["verdict"].tolist() == [UNSAID, UNSAID, GIVEN, UNSAID, UNSAID, UNSAID]
    assert table.loc[f"volume, {thesis}", "published"] == "0.532 mm³"
    assert table.loc[f"depth, {laboratory}", "source"] == "Yan 2022, Table 5.4"


def test_a_volume_that_no_coefficient_was_chosen_for_is_not_given():
    """Without the run of the laboratory's volume the other conserving one stands there."""
    table = told(sizes_beside_source(comparison(SOURCE, CASES[CASES["run"] != "c68"]), SOURCE))
    row = table.loc["volume, laboratory, conserving, 1.7e-11/Pa"]
    assert row["verdict"] == UNSAID and row["factor"] == pytest.approx(0.14 / 0.565)
    assert sizes_beside_source(comparison(SOURCE, CASES[CASES["run"] == ""]), SOURCE).empty


def test_coefficients_stand_beside_those_that_make_as_many_revolutions_the_test():
    """Of twelve revolutions, by each rule of ours; the laboratory's is arithmetic on its own volume."""
    calibration = pd.DataFrame(
        [("conserving", 12, 6.8e-11), ("per_triangle", 12, 3.4e-11), ("conserving", 8, 9e-11), ("Yan 2022", 12, 2e-11)],
        columns=["scheme", "revolutions", "wear_coefficient_per_pa"],
    )
    table = told(coefficients_beside_source(calibration, SOURCE))
    assert list(table.index) == [
        "wear coefficient, laboratory",
        "wear coefficient, thesis, conserving, 12 revolutions",
        "wear coefficient, thesis, per triangle, 12 revolutions",
    ]
    assert table["factor"].tolist() == pytest.approx([1.0, 4.0, 2.0], rel=0.01)  # 6.28e-13 is printed as 6.3e-13
    assert table["verdict"].tolist() == [GIVEN, UNSAID, UNSAID] and table["reason"].iloc[0] == ARITHMETIC


def test_the_largest_difference_of_all_scales_stands_beside_the_bound():
    """Whichever its sign; without an interval nothing is decided."""
    sizes = pd.DataFrame({"particle_scale": [1, 2, 8], "difference_percent": [0.1, -1.2, 0.3]})
    row = told(differences_beside_source(sizes, SOURCE)).loc["difference to Archard, particle scales 1 to 8"]
    assert (row["published"], row["verdict"]) == ("up to 0.6 %", UNSAID) and row["found"].startswith("1.2 %")
