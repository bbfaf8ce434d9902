"""Whether a finished calibration still answers what is asked."""

import pandas as pd
import pytest

from bulkwear.workflows.cases.calibration.kept import OTHER_TESTS, other_box_sizes, other_calibration
from tests.support.calibration_study import MEASURED, PAIRS, SLIDING, study

NARROW = [
    {**each, "high": 0.5 * (each["low"] + each["high"])} if each["name"] == SLIDING else each
    for each in study().settings["calibration"]["parameters"]
]


def runs_of(**overrides):
    return {run.name: run.parameters for run in study(**overrides).runs}


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({}, (None, None)),
        ({"calibration": {"batch": 3}}, (None, None)),
        ({"shear_box": {"width_mm": 107}}, (OTHER_TESTS, OTHER_TESTS)),
        ({"particle_scale": 4.9}, (OTHER_TESTS, OTHER_TESTS)),
        ({"calibration": {"repeats": 3}}, (None, OTHER_TESTS)),
        ({"calibration": {"parameters": NARROW}}, (f"the range of {SLIDING} is", None)),
    ],
)
def test_what_a_finished_calibration_answers(done, asked, said):
    """Its tests, which their folders' hashes tell, and ranges; batch and number of repeats are no test of it."""
    runs, folder = runs_of(**asked), done.folder
    found = (
        other_calibration(next(iter(runs.values())), MEASURED, folder / "simulations.csv"),
        other_box_sizes(runs, PAIRS, folder / "box_sizes.csv"),
    )
    for phrase, expected in zip(found, said, strict=True):
        assert phrase is expected is None or phrase.startswith(expected)


def test_a_table_without_folders_answers_nothing(done, tmp_path):
    """What it was made from is not known."""
    for name in ("simulations.csv", "box_sizes.csv"):
        pd.read_csv(done.folder / name).drop(columns="folders").to_csv(tmp_path / name, index=False)
    runs = runs_of()
    assert other_calibration(next(iter(runs.values())), MEASURED, tmp_path / "simulations.csv")
    assert other_box_sizes(runs, PAIRS, tmp_path / "box_sizes.csv")
