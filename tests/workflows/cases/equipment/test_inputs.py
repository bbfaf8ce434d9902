"""What simulates a machine again: the operation that its shape is worn for, not how that is judged."""

import pytest

from bulkwear.workflows.engine.inputs import run_digest
from tests.support.own_machine_project import machine_study

SHORTER = {"duration_h": 300}
TONNES = {"duration_h": None, "throughput_mt": 0.0003}


def digest(folder, **changes):
    """The hash of what the run of the tiny machine is simulated from, its settings changed."""
    with machine_study(folder, **changes) as study:
        return run_digest(study.case, study.runs[0].parameters, None)


@pytest.fixture(scope="module")
def before(tmp_path_factory):
    return digest(tmp_path_factory.mktemp("before"))


@pytest.mark.parametrize("operation", [SHORTER, TONNES])
def test_other_hours_are_another_simulation(tmp_path, before, operation):
    """The updates of the shape stand for shares of them."""
    assert digest(tmp_path, operation=operation) != before


def test_hours_of_a_shape_that_is_kept_are_not(tmp_path):
    """Without updates nothing is simulated from them."""
    kept = {"updates": {"most": 0}}
    assert digest(tmp_path / "a", **kept) == digest(tmp_path / "b", operation=SHORTER, **kept)


@pytest.mark.parametrize(
    "operation",
    [
        {"hours_per_year_h": 8000},
        {"change_out_remaining_mm": 1},
        {"change_out_remaining_mm": None, "change_out_worn_mass_fraction": 0.2},
    ],
)
def test_judging_simulates_nothing(tmp_path, before, operation):
    """When a liner is changed, and how many hours a year has, is told of the same runs."""
    assert digest(tmp_path, operation=operation) == before
