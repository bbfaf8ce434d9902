"""Coverage of the interval of a service life: every row is counted on few trials, and made-up places are as told."""

import numpy as np
import pandas as pd
import pytest

from benchmarks import service_life_coverage
from benchmarks.service_life_coverage import COLUMNS, TABLE, Places, rows
from bulkwear.postproc.statistics.worst_place import SHARED_BY_PACKINGS

TRIALS = 5
LEAST = 92.0  # %, of the worst place and its life in the table: nominal less what correlated blocks cost
SURE = 4.0  # standard errors


def test_every_row_says_what_it_is_of(monkeypatch):
    """All parts are there, in percent; equal seeds give equal tables."""
    monkeypatch.setattr(service_life_coverage, "CORRELATIONS", (0.2,))
    monkeypatch.setattr(service_life_coverage, "MADE", [Places(3), Places(3, packings=1)])
    table = rows(TRIALS)
    assert list(table) == COLUMNS
    assert table["found_percent"].between(0.0, 100.0).all()
    assert not table.duplicated(["what", "case"]).any()
    assert table["what"].nunique() == 5
    pd.testing.assert_frame_equal(rows(TRIALS), table)


def test_made_up_places():
    """Their means are the truth, their neighbouring blocks are correlated as told."""
    made = Places(3000, packings=1, blocks=20, correlation=0.4)
    values, packings = made.values(np.random.default_rng(1))
    assert (values.shape, set(packings)) == ((20, 3000), {0})
    assert values.mean() == pytest.approx(1.0, abs=SURE * values.mean(axis=0).std() / np.sqrt(3000))
    rest = values - 1.0
    assert (rest[1:] * rest[:-1]).mean() / (rest**2).mean() == pytest.approx(0.4, abs=SURE / np.sqrt(values.size))
    assert made.told() == "3000 places alike, one packing of 20 blocks, r = 0.4"
    assert Places(3, 0.5).truth.tolist() == [1.0, 0.75, 0.5]


def test_the_table_holds_what_is_promised():
    """Intervals of the worst place and its life hold the truth often enough; by all blocks but one they would not."""
    table = pd.read_csv(TABLE)
    assert list(table) == COLUMNS
    done = table[table["what"].isin(["load of the worst place", "its life, coefficient known to 20 %"])]
    assert len(done) == 2 * len(service_life_coverage.MADE)
    assert done["found_percent"].min() >= LEAST
    assert table.loc[table["what"].str.startswith("not done"), "found_percent"].min() < 75.0


@pytest.mark.parametrize(("packings", "most"), [(2, 0.5), (3, 0.4), (5, SHARED_BY_PACKINGS)])
def test_values_that_name_places_for_one_another_share_no_more(packings, most):
    """The variance of their mean over that of independent ones, of places alike and graded."""
    random, trials = np.random.default_rng(3), 2000
    for count, grade in ((2, 0.0), (5, 0.1), (20, 0.5), (200, 1.0)):
        truth = 1.0 - grade * np.linspace(0.0, 1.0, count)
        values = truth * (1.0 + 0.05 * random.standard_normal((trials, packings, count)))
        named = (values.sum(axis=1, keepdims=True) - values).argmax(axis=2)
        chosen = np.take_along_axis(values, named[..., None], axis=2)[..., 0]
        pairs = np.corrcoef(chosen.T)[np.triu_indices(packings, 1)]
        assert pairs.mean() < most + SURE / np.sqrt(trials)
