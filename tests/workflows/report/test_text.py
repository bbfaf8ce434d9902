"""What pages say of a study in words."""

import pandas as pd
import pytest

from bulkwear.workflows.report.text import worn_through_words

TWO_RUNS = pd.DataFrame({"run": ["R9_convex", "R9_plain"], "through_nodes": [3, 0], "time_s": [0.4, 1.0]})


@pytest.mark.parametrize(
    ("then", "said"),
    [(None, "The run ends then."), ("stop", "The run ends then."), ("cap", "stops there."), ("go_on", "goes on.")],
)
def test_runs_that_are_worn_through_are_named(then, said):
    """With a thickness: what counts, what the study does, and which runs, with nodes and time; without, nothing."""
    wear = {"local_thickness_mm": 2.0} | ({} if then is None else {"worn_through": then})
    ((title, words),) = worn_through_words(wear, TWO_RUNS)
    assert title == "Worn through"
    assert "when 2 mm of thickness are removed." in words
    assert said in words
    assert words.endswith("Worn through: R9_convex (3 nodes by 0.4 s).")
    assert worn_through_words(wear, TWO_RUNS[1:])[0][1].endswith("No run is worn through.")
    assert worn_through_words({}, TWO_RUNS) == []
