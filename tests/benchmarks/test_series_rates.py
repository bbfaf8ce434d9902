"""Rates at which answers on series are wrong: every kind is counted, on few trials."""

import numpy as np
import pandas as pd

from benchmarks import series_rates
from benchmarks.series_rates import COLUMNS, HELD, contours, rows, run_ins, shares

TRIALS = 3
MOST_MISSED = 16.0  # %, of 40 trials at 5 %: more has one of a thousand


def test_every_row_says_what_it_is_of(monkeypatch):
    """All parts are there, in percent, with their nominal rates; equal seeds give equal tables."""
    monkeypatch.setattr(series_rates, "BLOCKS", (4,))
    monkeypatch.setattr(series_rates, "CORRELATIONS", (0.5,))
    table = rows(TRIALS)
    assert list(table) == COLUMNS
    assert set(table["nominal_percent"]) == {2.5, 5.0, HELD}
    assert table["found_percent"].between(0.0, 100.0).all() and (table["trials"] == TRIALS).all()
    assert not table.duplicated(["what", "case"]).any()
    pd.testing.assert_frame_equal(rows(TRIALS), table)


def test_shares_are_percent():
    """Two answers of which one is always true and the other never."""
    assert shares(4, lambda: (True, False)).tolist() == [100.0, 0.0]


def test_level_series_rarely_have_a_run_in():
    """Of level series and of discs normal from the start few are said to run in."""
    rng = np.random.default_rng(5)
    table = pd.DataFrame(list(run_ins(40, rng)), columns=COLUMNS[:-1])
    assert (table.loc[table["nominal_percent"] < HELD, "found_percent"] <= MOST_MISSED).all()
    *_, corrected = contours(40, rng)
    assert corrected[-1] >= 100.0 - MOST_MISSED
