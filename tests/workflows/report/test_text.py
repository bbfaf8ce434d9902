"""What pages say of a study in words."""

import pandas as pd
import pytest

from bulkwear.workflows.report.text import number, range_text, worn_through_words

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
    one = TWO_RUNS.assign(through_nodes=[1, 0])
    assert worn_through_words(wear, one)[0][1].endswith("Worn through: R9_convex (1 node by 0.4 s).")


@pytest.mark.parametrize(
    ("values", "digits", "said"),
    [
        ([4.0], 2, "4"),
        ([0.5, 1.25], 2, "0.5 to 1.2"),
        ([123.0, 123.4], 2, "120"),
        ([162.8, 4.0e4], 2, "160 to 40\u202f000"),
        ([1234.5], 3, "1\u202f230"),
        ([6.0e7], 2, "6e+07"),
        ([0.00012], 2, "0.00012"),
    ],
)
def test_ranges_have_no_exponent_that_hides_a_number(values, digits, said):
    """Up to a million; alike ones are told once."""
    assert range_text(values, digits) == said


def test_names_are_words_and_text_stays():
    """Of a name underscores are spaces; files and sentences keep theirs."""
    assert number("steel_lost") == "steel lost"
    assert number("chute/liner_r9.step") == "chute/liner_r9.step"
    assert number("told in charge_angles.py") == "told in charge_angles.py"
