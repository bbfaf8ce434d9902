"""Runs of pins on discs: which stand for the source's, what figures say of their coefficients, their forces."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.pin_on_disc.runs import (
    CALIBRATED,
    REFERENCE,
    force_boxes,
    pin_runs,
    reference_remark,
    reference_runs,
    same_coefficient,
    window_forces,
)
from tests import PUBLISHED
from tests.support import pin_study

VALUES = pd.read_csv(PUBLISHED / "pin_on_disc.csv")


def test_design_without_its_columns_is_refused(tmp_path):
    pd.DataFrame({"run": ["a"], "scheme": ["conserving"]}).to_csv(tmp_path / "design.csv", index=False)
    with pytest.raises(ValueError, match="column series, wear_coefficient_per_pa"):
        pin_runs(tmp_path / "design.csv")


def test_reference_runs_have_the_thesis_coefficient(pins):
    """5e-11 for the reference simulations, 1.7e-11 for Table 5.4, of the series of coefficients, one run per scheme."""
    _, runs, *_ = pins
    assert reference_runs(runs, VALUES, REFERENCE) == {"conserving": "c", "per_triangle": "d"}
    assert reference_runs(runs, VALUES, CALIBRATED) == {"conserving": "a", "per_triangle": "b"}
    assert same_coefficient(runs, 1.7e-11)["run"].tolist() == ["a", "b"]


def test_other_coefficient_than_the_thesis_is_said(pins):
    """Without the wanted coefficient the nearest one stands for it, scheme by scheme, and the remark says so."""
    _, runs, *_ = pins
    assert reference_remark(runs, VALUES, REFERENCE) == "wear coefficient 5e-11 1/Pa"
    others = runs[runs["wear_coefficient_per_pa"] != 1.7e-11]
    assert reference_runs(others, VALUES, CALIBRATED) == {"conserving": "c", "per_triangle": "d"}
    said = "wear coefficient 5e-11 1/Pa instead of the published 1.7e-11 (Yan 2022, section 5.4.3)"
    assert reference_remark(others, VALUES, CALIBRATED) == said
    one = runs[runs["run"] != "d"]
    assert reference_runs(one, VALUES, REFERENCE) == {"conserving": "c", "per_triangle": "b"}
    assert reference_remark(one, VALUES, REFERENCE) == (
        "wear coefficient, conserving: 5e-11 1/Pa, "
        "per triangle: 1.7e-11 1/Pa instead of the published 5e-11 (Yan 2022, Table 5.2)"
    )


def test_forces_fall_into_their_revolution(pins):
    """360 windows per revolution, the one that ends at 360 degrees in the first; the mean is the load."""
    folder, *_ = pins
    forces = window_forces(folder / "a")
    assert forces["revolution"].value_counts().to_dict() == {1: 360, 2: 360, 3: 360}
    boxes = force_boxes(forces.assign(run="a"))
    vertical, normal = (boxes[boxes["force"] == name] for name in ("vertical_force", "normal_force"))
    np.testing.assert_allclose(vertical["mean_N"], pin_study.LOAD)
    np.testing.assert_allclose(normal["mean_N"], pin_study.RISE * pin_study.LOAD)
    np.testing.assert_allclose(vertical[["least_N", "largest_N"]], [[4.5, 5.5]] * 3)
    with pytest.raises(FileNotFoundError, match=r"no cycle_\*/forces.csv"):
        window_forces(folder / "none")
