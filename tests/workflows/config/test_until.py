"""Packings until an interval is narrow enough: rounds, budgets, and which runs a study then has."""

import json

import pandas as pd
import pytest

from bulkwear.workflows.config.design import ConfigError, load_study
from bulkwear.workflows.config.packings import possible_packings
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


def decided(hours=1.0, finished=(), possible=None, **ratios):
    found = answers(summary(**ratios))
    packings = {setting: len(values) for setting, values in ratios.items()}
    possible = dict.fromkeys(packings, UNTIL.most_packings) | (possible or {})
    return next_round(UNTIL, found, packings, possible, dict.fromkeys(finished, True), hours)


def known(study):
    """What a study knows of its rows."""
    return study.design_rows, study.setting_of, study.packing_of


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
    """There are no more rows of it: it is finished, costs nothing, and rounds end with those that may have more."""
    found = decided(possible={"mesh": 1}, hours=1.4, R9=WIDE, mesh=(0.5,))
    assert found["packings"] == {"R9": 8, "mesh": 1} and found["finished"] == {"R9": False, "mesh": True}
    assert found["said"].endswith("; 4 packings more") and not found["enough"]
    alone = decided(possible={"mesh": 1}, mesh=(0.5,))
    assert alone["enough"] and alone["packings"] == {"mesh": 1}


@pytest.mark.parametrize("study", ["circular_tester", "tester_sensitivity"])
def test_rows_that_are_there_say_how_many_packings_a_setting_may_have(study):
    """Those with a number of their own that many, the others what the goal allows."""
    loaded = load_study(study, overrides={"until": ASKED})
    assert set(possible_packings(*known(loaded)).values()) == {1, ASKED["most_packings"]}
    only = load_study("demo", overrides={"until": ASKED, "rows": ["R5-2"]})
    assert possible_packings(*known(only)) == {"R5": 2}


@pytest.mark.parametrize("without", [0.0, float("nan")])
def test_a_packing_without_a_value_is_not_taken_back(without):
    """It is no packing of the interval, so another one takes its place."""
    found = decided(R9=(*WIDE[:3], without))
    assert found["packings"] == {"R9": 5} and not found["enough"]
    assert decided(R9=(*WIDE * 2, *WIDE[:3], without))["packings"] == {"R9": 12}


def test_a_width_beyond_the_mean_is_no_power_of_ten():
    """It is told in whole per cent, not as 2e+03 %."""
    scattered = (0.1, 1.0, 0.1, 3.0)
    width = answers(summary(R9=scattered))["R9"].width()
    assert width > 1.0 and f"widest interval: {100.0 * width:.0f} % of R9" in decided(R9=scattered)["said"]


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
