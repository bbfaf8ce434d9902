"""Packings until an interval is narrow enough: rounds, budgets, and which runs a study then has."""

import json

import pandas as pd
import pytest

from bulkwear.workflows.config.design import ConfigError, load_study
from bulkwear.workflows.config.until import Until, answers, next_round, until_of

ASKED = {"width_fraction": 0.05, "most_packings": 12, "most_core_h": 3}
UNTIL = Until(0.05, 12, 3.0)
NARROW, WIDE = (0.6, 0.601, 0.599, 0.6), (0.5, 0.6, 0.7, 0.65)


def summary(**ratios):
    """A summary of settings with these ratios of patterned to plain wear, a packing each."""
    rows = []
    for setting, values in ratios.items():
        for packing, ratio in enumerate(values, 1):
            for surface, volume in (("plain", 2e-9), ("convex", 2e-9 * ratio)):
                over = ratio if surface == "convex" else 1.0
                told = {"setting": setting, "packing": packing, "surface": surface}
                rows.append({**told, "worn_volume_m3": volume, "wear_over_plain": over})
    return pd.DataFrame(rows)


def decided(hours=1.0, finished=(), **ratios):
    found = answers(summary(**ratios))
    packings = {setting: len(values) for setting, values in ratios.items()}
    return next_round(UNTIL, found, packings, dict.fromkeys(finished, True), hours)


def test_what_a_study_tells_is_patterned_over_plain_wear():
    """By setting, in the same bed; where there are no twins the worn volume."""
    assert answers(summary(R9=WIDE))["R9"].value == pytest.approx(0.6081, abs=1e-3)
    alone = summary(R9=WIDE).assign(wear_over_plain=float("nan")).query("surface == 'convex'")
    assert answers(alone)["R9"].value == pytest.approx(2e-9 * 0.6081, rel=1e-3)


def test_a_round_adds_packings_where_they_are_needed():
    """The narrow setting gets its last ones, the wide one at most as many again; then rounds go on until both are."""
    found = decided(R5=NARROW, R9=WIDE)
    assert found["packings"] == {"R5": 7, "R9": 8} and not found["enough"]
    assert found["finished"] == {"R5": True, "R9": False} and "of R9" in found["said"]
    found = decided(R5=NARROW + NARROW[:3], R9=NARROW * 2, finished=["R5"])
    assert found["packings"] == {"R5": 7, "R9": 11} and found["enough"]
    assert json.loads(json.dumps(found)) == found


def test_a_round_counts_in_words_what_it_adds():
    """One packing is not packings: eleven of the twelve allowed leave one, ten leave two."""
    assert decided(R9=(WIDE * 3)[:11])["said"].endswith("; 1 packing more")
    assert decided(R9=(WIDE * 3)[:10])["said"].endswith("; 2 packings more")


def test_the_most_packings_end_it():
    """However wide the interval is."""
    found = decided(R9=WIDE * 3)
    assert found["packings"] == {"R9": 12} and found["enough"] and "no more packings" in found["said"]


def test_a_round_that_the_budget_does_not_hold_is_not_begun():
    """Four packings took 1.6 core hours, four more would make 3.2 of 3."""
    found = decided(hours=1.6, R9=WIDE)
    assert found["packings"] == {"R9": 4} and found["enough"]
    assert "the budget of 3 core hours ends here, 1.6 are used" in found["said"]


def test_a_setting_with_packings_of_its_own_keeps_them():
    """It is not looked at."""
    found = next_round(UNTIL, answers(summary(R9=WIDE)), {"R9": 4, "mesh": 1}, {}, 0.1)
    assert found["packings"] == {"R9": 8, "mesh": 1}


def test_a_study_has_all_packings_that_it_may_need():
    """Runs of later rounds are known; with the packings of a round it has those alone, as with a number of them. Rows
    that are not run have none, so that they do not lower what a packing seems to cost.
    """
    study = load_study("demo", overrides={"until": ASKED})
    assert study.until == UNTIL and study.first_packings == {"R5": 4}
    assert len(study.runs) == 2 * 12
    first = study.with_packings(study.first_packings)
    fixed = load_study("demo", overrides={"packings": 4})
    assert first.runs == fixed.runs and first.beds == fixed.beds and fixed.until is None
    assert [row["row"] for row in first.design_rows] == ["R5", "R5-2", "R5-3", "R5-4"]
    assert until_of({}) is None


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        ({**ASKED, "width_fraction": 0}, "until.width_fraction is 0"),
        ({**ASKED, "most_packings": 2}, "until.most_packings is 2"),
        ({"width_fraction": 0.05}, "until.most"),
        ({**ASKED, "width": 5}, "until.width"),
    ],
)
def test_bad_goals_are_one_sentence(asked, found):
    """Which names the key, what was found and what is allowed."""
    with pytest.raises(ConfigError, match=found.replace(".", r"\.")):
        load_study("demo", overrides={"until": asked})
