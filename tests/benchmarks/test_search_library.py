"""The search beside a library: closed forms, what a search is told and asked, how its end is counted."""

import json
import sys

import numpy as np
import pandas as pd
import pytest

from benchmarks import search_library as benchmark
from benchmarks.search_library import NOISE, State, ask_library, line_of, searches
from benchmarks.search_page import LIBRARY, MARGIN, OURS, SPREAD, difference, page, verdict
from benchmarks.search_truths import HALF, TRUTHS, branin, hartmann_3, hartmann_6, mean_of_factors
from tests import REPOSITORY

TABLE = REPOSITORY / "docs/search_library.csv"
SIMPLE = TRUTHS[0]
PUBLISHED = 1e-5  # of the least values, as many digits as are published
FIRST_OF_ALL = """
import json, sys
asked = json.load(open(sys.argv[1]))
told = [{"best": 0, "mean": 0.0, "deviation": 1.0, "next": list(range(each["count"]))} for each in asked]
json.dump(told, open(sys.argv[2], "w"))
"""


@pytest.fixture
def library(tmp_path, monkeypatch):
    """A library that takes the first candidates, and holds the first design for the best."""
    program = tmp_path / "library.py"
    program.write_text(FIRST_OF_ALL)
    monkeypatch.setattr(benchmark, "PROGRAM", program)
    return sys.executable


@pytest.mark.parametrize(
    ("response", "place", "least"),
    [
        (branin, [(np.pi + 5.0) / 15.0, 2.275 / 15.0], 0.397887),
        (hartmann_3, [0.114614, 0.555649, 0.852547], -3.86278),
        (hartmann_6, [0.20169, 0.150011, 0.476874, 0.275332, 0.311652, 0.6573], -3.32237),
    ],
)
def test_responses_have_their_published_least(response, place, least):
    assert response(np.array([place]))[0] == pytest.approx(least, abs=PUBLISHED)


@pytest.mark.parametrize("truth", TRUTHS, ids=lambda truth: truth.name)
def test_no_design_within_the_limit_is_less(truth):
    """Random designs on the grid, and the neighbours of the best of them."""
    designs = np.random.default_rng(1).integers(0, 21, (20_000, truth.factors)) / 20.0
    kept = truth.response(designs[mean_of_factors(designs) <= HALF])
    assert truth.least <= kept.min() < truth.at_random


def test_every_method_has_the_same_errors():
    """The k-th simulation of a seed is off by the same, whatever came between, and by as much as is said."""
    designs = np.full((400, 2), 0.5)
    one, two = State(SIMPLE, OURS, 3, designs), State(SIMPLE, LIBRARY, 3, designs[:10])
    two.add(designs[10:12])
    two.add(designs[12:])
    np.testing.assert_array_equal(one.simulated, two.simulated)
    errors = one.simulated - np.column_stack(SIMPLE.true_values(designs))
    np.testing.assert_allclose(errors.std(axis=0), NOISE * np.array(SIMPLE.spread), rtol=0.15)  # 4 / sqrt(2 * 400)


def test_what_the_library_is_asked(library):
    """Its candidates are those of ours, none of which was tried; what it chooses is simulated."""
    state = State(SIMPLE, LIBRARY, 1, np.array([[0.0, 0.0], [1.0, 0.5], [0.5, 1.0]]))
    candidates = state.search.candidates()
    asked = json.loads(json.dumps(state.asked(candidates, 2)))
    assert (len(asked["points"]), len(asked["candidates"])) == (3, len(candidates))
    assert asked["variances"][0] == pytest.approx((NOISE * SIMPLE.spread[0]) ** 2)
    (answer,) = ask_library(library, [state], 2)
    np.testing.assert_array_equal(answer["values"], candidates[:2])
    assert state.cpu_s > 0.0


def test_the_librarys_last_words_are_told(library, tmp_path):
    (tmp_path / "library.py").write_text("raise SystemExit('no torch here')")
    with pytest.raises(RuntimeError, match="no torch here"):
        ask_library(library, [State(SIMPLE, LIBRARY, 1, np.array([[0.0, 0.0]]))], 0)


@pytest.mark.parametrize(
    ("design", "keeps", "missed"),
    [([0.95, 0.95], False, 1.0), ([0.5, 0.5], True, None)],
)
def test_a_broken_limit_counts_as_a_design_at_random(design, keeps, missed):
    """Branin at the middle is 24.13; the corner breaks the limit although its response is not the worst."""
    state = State(SIMPLE, OURS, 1, np.array([design]))
    found = line_of(state, {"best": 0, "mean": 0.0, "deviation": 0.0})
    far = (branin(np.array([design]))[0] - SIMPLE.least) / (SIMPLE.at_random - SIMPLE.least)
    assert found["keeps_limit"] is keeps
    assert found["missed"] == pytest.approx(far if missed is None else missed, abs=1e-4)
    assert not found["in_interval"]


def test_a_tiny_comparison(library):
    """Each method ends with as many simulations; pairs are of the same seed."""
    found = searches(library, TRUTHS[:1], 4, 2, 6, 1)
    assert found.groupby("method")["simulations"].unique().map(list).to_dict() == {
        OURS: [6],
        LIBRARY: [6],
        SPREAD: [6],
    }
    assert difference(found[found["method"] != LIBRARY]) is None


def test_intervals_and_verdicts():
    """Student's interval of three values by hand (t = 4.3027 at 2 degrees of freedom): of searches, each of which has
    the same errors in all responses. And every verdict.
    """
    table = pd.DataFrame(
        {"response": response, "search": search, "method": method, "missed": search if method == OURS else 0.0}
        for response in ("a", "b")
        for search in (1, 2, 3)
        for method in (OURS, LIBRARY)
    )
    assert difference(table) == pytest.approx((2.0, 2.0 - 2.48414, 2.0 + 2.48414), abs=1e-4)
    in_words = [
        ((-3, -2), "ours comes nearer"),
        ((2, 3), f"{LIBRARY} comes nearer"),
        ((-1, 1), "both come as near"),
        ((-3, 1), "ours comes as near or nearer"),
        ((-1, 3), "not decided"),
    ]
    for (low, high), words in in_words:
        assert verdict(low * MARGIN, high * MARGIN) == words


def test_the_page_is_written_from_its_table():
    assert TABLE.with_suffix(".md").read_text(encoding="utf-8") == page(
        pd.read_csv(TABLE, keep_default_na=False), NOISE
    )
