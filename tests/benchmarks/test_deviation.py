"""What values of a numerical choice change: known ratios, packings that share an effect, intervals, verdicts."""

import numpy as np
import pytest
from scipy import stats

from benchmarks.deviation import BEYOND, FAILED, UNDECIDED, WITHIN, changes, verdict

ROUNDING = 1e-9
LIMIT = 0.02
TRIALS = 400
SURE = 4.0  # standard deviations of a count of trials


def test_changes_of_known_runs():
    """Two packings with every value: means over them, the interval by hand from what packing and value leave over."""
    noise = 0.01 * np.array([1.0, -1.0, -1.0, 1.0])
    responses = np.array([5.0, 5.0 * 1.2, 5.5, 5.5 * 1.2]) * np.exp(noise)
    table = changes([1.0, 1.0, 2.0, 2.0], responses, ["a", "b"] * 2, 1.0, LIMIT).set_index("value")
    assert table["mean"].tolist() == pytest.approx([5.0 * 1.2**0.5, 5.5 * 1.2**0.5], rel=ROUNDING)
    scatter = np.sqrt(4 * 0.01**2 / 1)
    assert table["scatter"].tolist() == pytest.approx([scatter] * 2, rel=ROUNDING)
    reach = stats.t.ppf(0.975, 1) * scatter * np.sqrt(0.5 + 0.5)
    found = table.loc[2.0, ["change", "change_low", "change_high"]].tolist()
    assert found == pytest.approx([0.1, 1.1 * np.exp(-reach) - 1.0, 1.1 * np.exp(reach) - 1.0], rel=1e-8)
    assert table.loc[1.0, ["change", "change_low", "change_high"]].tolist() == [0.0, 0.0, 0.0]


def test_a_packing_that_wears_more_changes_nothing():
    """Missing values are compared within their packing: without chance the change is exact however they are missing."""
    values, packings = [1.0, 2.0, 3.0, 1.0, 2.0, 1.0, 3.0], ["a", "a", "a", "b", "b", "c", "c"]
    effect, worn = {1.0: 1.0, 2.0: 1.01, 3.0: 0.9}, {"a": 1.0, "b": 3.0, "c": 0.2}
    responses = [effect[value] * worn[packing] for value, packing in zip(values, packings, strict=True)]
    table = changes(values, responses, packings, 1.0, LIMIT)
    assert table["change"].tolist() == pytest.approx([0.0, 0.01, -0.1], abs=ROUNDING)
    assert table["verdict"].tolist() == [WITHIN, WITHIN, BEYOND]


def test_failed_runs_are_told():
    """A value whose run failed once has no verdict but that; one that failed always has no change either."""
    table = changes([1.0, 1.0, 2.0, 2.0, 3.0], [1.0, 1.0, 1.0, np.nan, np.nan], list("ababa"), 1.0, LIMIT)
    assert table["failed"].tolist() == [0, 1, 1] and table["runs"].tolist() == [2, 1, 0]
    assert table["verdict"].tolist() == [WITHIN, FAILED, FAILED]
    assert np.isnan(table["change"].iloc[2])


def test_the_interval_covers_the_true_change_as_often_as_it_says():
    """95 of 100 intervals of normal logarithms with a true change of 3 % hold it, whatever the packings do."""
    random = np.random.default_rng(20220317)
    held = 0
    for _ in range(TRIALS):
        packing = random.normal(0.0, 0.1, 4)
        logs = random.normal(0.0, 0.01, (3, 4)) + packing + np.log([[1.0], [1.03], [0.98]])
        table = changes(np.repeat([1.0, 2.0, 3.0], 4), np.exp(logs).ravel(), np.tile(range(4), 3), 1.0, LIMIT)
        held += table["change_low"][1] <= 0.03 <= table["change_high"][1]
    assert abs(held - 0.95 * TRIALS) < SURE * np.sqrt(0.95 * 0.05 * TRIALS)


@pytest.mark.parametrize(
    ("low", "high", "said"),
    [(-0.01, 0.019, WITHIN), (0.021, 0.04, BEYOND), (-0.05, -0.021, BEYOND), (0.01, 0.03, UNDECIDED)],
)
def test_verdicts(low, high, said):
    """An interval inside the limits, outside one of them, or across one."""
    assert verdict(low, high, LIMIT) == said


def test_a_single_packing_leaves_everything_undecided():
    """Nothing tells of chance."""
    table = changes([1.0, 2.0], [1.0, 1.0], ["a", "a"], 1.0, LIMIT)
    assert np.isnan(table["change_low"][1]) and table["verdict"][1] == UNDECIDED


def test_a_reference_that_was_not_run_is_refused():
    """The message tells the value and which there are."""
    with pytest.raises(ValueError, match=r"no run at the reference 0\.5, allowed are 1, 2"):
        changes([1.0, 2.0], [1.0, 1.0], ["a", "a"], 0.5, LIMIT)
