"""Errors of sampled ledgers: what is compared with what."""

import numpy as np
import pytest

from benchmarks.sampling_error import LEDGER_LINE, deck_of_both, sampling_errors, with_whole_windows
from bulkwear.workflows.engine.chain import Chain
from tests.support.tiny import tiny_study

EXACT = np.array([6.0, 2.0, 0.0])  # J per triangle
ROUNDING = 1e-12  # relative; the sums have a handful of terms


@pytest.fixture
def errors():
    """Two windows, three triangles: stride 1 has the exact sums, stride 5 moves 1 J and loses 1 J of 8 J."""
    every_step = np.array([[3.0, 1.0, 0.0], [3.0, 1.0, 0.0]])
    sampled = np.array([[3.0, 0.0, 0.0], [2.0, 1.0, 1.0]])
    return sampling_errors({1: every_step, 5: sampled}, EXACT, dump_bytes=1000, ledger_bytes=10).set_index(
        "stride_steps"
    )


def test_no_error_where_every_step_is_sampled(errors):
    """Stride 1 with the solver's own sums has no error of any kind."""
    assert (errors.loc[1, ["total_error", "short_window_error", "map_error"]] == 0.0).all()


def test_total_and_map_are_told_apart(errors):
    """The total misses 1 of 8 J; the map counts the magnitude of each triangle's error: 1 + 1 + 1 of 8 J."""
    assert errors.loc[5, "total_error"] == pytest.approx(1 / 8, rel=ROUNDING)
    assert errors.loc[5, "map_error"] == pytest.approx(3 / 8, rel=ROUNDING)


def test_short_windows_are_compared_one_by_one(errors):
    """Windows of 4 J that miss 1 and 0 J have a root mean square error of 1/4/sqrt(2)."""
    assert errors.loc[5, "short_window_error"] == pytest.approx(0.25 / np.sqrt(2.0), rel=ROUNDING)


def test_dumps_shrink_with_the_stride_and_the_ledger_does_not(errors):
    """Disk of the dumps goes with one over the stride; the solver's file has one size."""
    assert errors.loc[5, "dumps_MB"] == pytest.approx(errors.loc[1, "dumps_MB"] / 5, rel=ROUNDING)
    assert errors["solver_ledger_MB"].nunique() == 1


def test_the_deck_has_both_ledgers(tmp_path):
    """It dumps the contacts of every step, and the solver's own ledger begins before steps count from 0."""
    study = tiny_study()
    run, bed = study.run("R9_convex").parameters, next(iter(study.beds.values()))
    chain = Chain("R9_convex", tmp_path, study.case, run, tmp_path / "surface.vtu", bed, tmp_path / "bed.restart")
    before, after = deck_of_both(with_whole_windows(chain)).split(LEDGER_LINE)
    assert "contacts.dump" in after and "reset_timestep 0" in after and "reset_timestep 0" not in before
