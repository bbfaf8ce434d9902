"""Error rates of selection: how trials are made and counted, and that the table of the docs still holds."""

import numpy as np
import pandas as pd
import pytest

from benchmarks import selection_error_rates as benchmark
from benchmarks.selection_error_rates import Case, page, rates, rates_of, simulated
from bulkwear.postproc.statistics.model_terms import candidate_terms
from tests import REPOSITORY

TABLE = REPOSITORY / "docs/selection_error_rates.csv"
KEYS = {"factors": 6, "fake_factors": 2, "main_effects": 3, "second_order_terms": 2, "effect_over_error": 3.0}
TRIALS = 40
SURE = 4.0  # standard deviations of the difference of two shares of trials


def test_trials_have_what_they_say():
    """Terms of a trial obey heredity, main effects first, and leave an error of one."""
    coded, responses, true = simulated(Case(5, 2, 3, 2, 2.0), 200)
    terms = candidate_terms(5)
    for each in true:
        acting = [term for term, acts in zip(terms, each, strict=True) if acts]
        assert [len(term) for term in acting] == [1, 1, 1, 2, 2]
        assert {k for term in acting[3:] for k in term} <= {k for (k,) in acting[:3]}
    noise = simulated(Case(5, 2, 0, 0, 0.0), 200)[1]
    assert noise.std() == pytest.approx(1.0, abs=SURE / np.sqrt(2 * noise.size))
    assert responses.shape == (200, len(coded))


def test_rates_are_counted():
    """One trial right, one with a false term, one with a missed one, one with both."""
    true = np.tile([True, True, False], (4, 1))
    found = np.array([[1, 1, 0], [1, 1, 1], [1, 0, 0], [1, 0, 1]], dtype=bool)
    assert rates(found, true) == {"exact_percent": 25.0, "false_terms": 0.5, "missed_terms": 0.5}


def test_the_table_of_the_docs_holds(monkeypatch):
    """Other trials of six factors with two fake ones give the shares of the table, within the scatter of both counts;
    the default finds the model more often than AICc, four terms never hold it.
    """
    monkeypatch.setattr(benchmark, "SEED", 1)
    now = pd.DataFrame(rates_of(Case(6, 2, 3, 2, 3.0), TRIALS)).set_index("method")
    table = pd.read_csv(TABLE)
    for column, value in KEYS.items():
        table = table[table[column] == value]
    before = table.set_index("method")
    for method in benchmark.METHODS:
        share = before.loc[method, "exact_percent"] / 100.0
        scatter = np.sqrt(share * (1.0 - share) * (1.0 / TRIALS + 1.0 / before.loc[method, "trials"]))
        assert abs(now.loc[method, "exact_percent"] / 100.0 - share) <= SURE * scatter
    assert now["exact_percent"].idxmax() == "search"
    assert now.loc["four terms by AICc", "exact_percent"] == 0.0


def test_the_page_is_written_from_its_table():
    """The page of the docs is that of the table beside it."""
    assert TABLE.with_suffix(".md").read_text(encoding="utf-8") == page(pd.read_csv(TABLE))
