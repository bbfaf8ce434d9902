"""Rounds of a search on made-up runs: they find the best pattern, keep to the budget, and go on after a stop."""

import json
import shutil

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.inference.improvement import Tried
from bulkwear.workflows.cases.sliding_sample.search.results import (
    left_after,
    loss_limit,
    run_results,
    tried_of,
    tried_patterns,
)
from bulkwear.workflows.cases.sliding_sample.search.rounds import lowest_predicted, short_reason
from bulkwear.workflows.config.rounds import core_hours
from bulkwear.workflows.forecast.limits import fault_of_budget
from bulkwear.workflows.report.markdown import as_decided
from tests.support.searched import BEST_HEIGHT_MM, LEAST, STUDY, costs_of, decided_round, small_search, write_runs

BUDGET_H = 0.25
STEP_MM = 0.5  # of the searched heights
WITHIN = 0.03  # -, of the least wear over plain: scatter of packings, 0.01, and the surrogate's error


def test_a_search_finds_the_best_height(finished):
    """To a step of it, and predicts what it wears; it is confirmed beside the reference, in more packings."""
    _, decided = finished
    last = decided[-1]
    best = last["confirmed"][0]
    assert abs(last["rows"].get(best, {"height_mm": BEST_HEIGHT_MM})["height_mm"] - BEST_HEIGHT_MM) <= STEP_MM
    assert last["predicted"][best]["predicted"] == pytest.approx(LEAST, abs=WITHIN)
    assert last["confirmed"][-1] == "R5" and {last["packings"][name] for name in last["confirmed"]} == {3}
    assert [each["enough"] for each in decided] == [False, False, True]


def test_patterns_that_cannot_be_made_are_counted_by_reason(finished):
    """Before anything of them is meshed."""
    _, decided = finished
    assert set(decided[0]["excluded"]) == {"bump too high for its foot", "sample.element_size_mm"}
    assert short_reason("bumps overlap: minor radius 8 mm needs 3 mm") == "bumps overlap"
    assert short_reason("sample.element_size_mm is 4, allowed is at most 2 mm") == "sample.element_size_mm"


def test_a_stopped_search_goes_on_as_if_it_had_not_been(finished, tmp_path):
    """The rounds that are left decide what they decided; those before are not asked for."""
    root, decided = finished
    shutil.copytree(root, tmp_path / "again")
    rounds = tmp_path / "again" / "results" / STUDY / "rounds"
    for number in (2, 3):
        (rounds / f"round_{number}.json").unlink()
    for number in (2, 3):
        assert decided_round(tmp_path / "again", number, decided[number - 2]["packings"]) == decided[number - 1]
    assert json.loads((rounds / "round_1.json").read_text()) == json.loads(json.dumps(decided[0]))


@pytest.mark.verify
def test_a_round_that_the_budget_does_not_hold_is_not_begun(tmp_path):
    """Ten runs of patterns, two plain twins and two beds are done; a round and the confirmation would exceed the
    quarter of an hour asked for, the confirmation alone does not.
    """
    packings = small_search(tmp_path).first_packings
    decided = decided_round(tmp_path, 1, packings, most_core_h=BUDGET_H)
    assert decided["enough"] and "the budget ends here, 0.16 core hours are used" in decided["said"]
    assert len(decided["rows"]) <= 1 and decided["confirmed"][-1] == "R5"  # a round has two
    folder = tmp_path / "results" / STUDY
    confirmed = small_search(tmp_path, most_core_h=BUDGET_H).with_packings(decided["packings"])
    write_runs(confirmed, folder)
    assert core_hours(costs_of(confirmed, folder)) <= BUDGET_H


def test_a_budget_that_does_not_hold_one_round_is_refused(tmp_path):
    """Before anything is simulated, in one sentence with what it must be."""
    assert fault_of_budget(small_search(tmp_path)) is None
    fault = fault_of_budget(small_search(tmp_path, most_core_h=1e-4))
    assert fault.startswith(f"{STUDY}: optimise.most_core_h is 0.0001, allowed are about 0.") and fault.count(".") > 1


def tried_in_a_row(limit):
    """Nine patterns in a row: the less one wears over plain, the more of it goes per hour; the middle one loses 1."""
    places = np.linspace(0.0, 1.0, 9)
    exact = 1e-6 * np.eye(9)
    return Tried(places[:, None], np.log(1.0 + places), exact, 1.5 - places, exact, limit)


def test_the_lowest_pattern_is_one_of_which_enough_is_left():
    """Those to the right of the middle keep to a limit half a step below it; the lowest of all, 1, is told of none."""
    step = 1.0 / 8.0
    said = lowest_predicted(tried_in_a_row(limit=1.0 - step / 2))
    begin, _, lowest = said.rpartition(" ")
    assert begin == (
        "of 4 of 9 patterns enough is left with a chance of 0.9 or more, their lowest predicted wear over plain is"
    )
    assert float(lowest) == pytest.approx(1.5 + step, abs=WITHIN)
    none = lowest_predicted(tried_in_a_row(limit=0.0))
    assert none.startswith("of 0 of 9 patterns enough is left with a chance of 0.9 or more, the most likely one has ")


def summary(ratios, worn=1e-9, hours=0.5):
    """A summary of a convex and a plain run of each packing of these settings."""
    rows = []
    for setting, values in ratios.items():
        for packing, ratio in enumerate(values, 1):
            for surface, over in (("convex", ratio), ("plain", 1.0)):
                told = {"run": f"{setting}-{packing}_{surface}", "setting": setting, "packing": packing}
                told |= {"surface": surface, "wear_over_plain": over, "pattern_worn_volume_m3": worn}
                rows.append({**told, "time_s": 3600.0 * hours, "height_mm": 4.0, "minor_radius_mm": 6.0})
    return pd.DataFrame(rows)


def test_what_is_left_follows_from_the_loss_per_hour(tmp_path):
    """0.5 of 1000 mm3 in half an hour that stands for a whole one: 0.005 of it in ten hours."""
    search = small_search(tmp_path, after_h=10.0).optimise
    table = summary({"A": [0.5]}, worn=0.5e-9)
    volumes = dict.fromkeys(table["run"], 1e-6)
    loss = run_results(table, volumes, search, acceleration=2.0)["ln_loss_per_h"]
    assert np.exp(loss.to_numpy()) == pytest.approx([5e-4])
    assert left_after(loss.to_numpy(), search) == pytest.approx([0.995])
    assert left_after(loss_limit(search), search) == pytest.approx(search.least_left)
    assert left_after(np.log(1.0), search) == 0.0


def test_patterns_of_a_packing_share_its_plain_twin(tmp_path):
    """The twin of one packing wears twice as much as that of the other: all ratios over it halve, in A, B and C alike.

    Patterns differ by their own scatter, +-0.01 of A, which a noise of each pattern's own would hide.
    """
    search = small_search(tmp_path).optimise
    twin, own = np.log([1.0, 2.0]), np.array([0.01, -0.01])
    ratios = {"A": np.exp(-twin + own), "B": np.exp(0.05 - twin), "C": np.exp(0.3 - twin)}
    table = summary(ratios).assign(height_mm=np.repeat([3.0, 4.0, 5.0], 4))
    runs = run_results(table, dict.fromkeys(table["run"], 1e-6), search, acceleration=1.0)
    assert tried_patterns(runs, search)["setting"].tolist() == ["A", "B", "C"]
    tried = tried_of(runs, search)
    assert tried.values - tried.values[0] == pytest.approx([0.0, 0.05, 0.3])
    own_square = (2 * own[0] ** 2 - (2 * own[0]) ** 2 / 6) / 2.0  # of the rest, of 2 degrees of freedom
    apart = np.array([1.0, -1.0, 0.0])
    assert apart @ tried.noise @ apart == pytest.approx(own_square, rel=1e-6)
    assert np.sqrt(tried.noise.diagonal().min()) > 0.2
    alone = tried_of(runs[runs["packing"] == 1], search)
    assert not alone.noise.any()


def test_the_page_in_docs_is_of_what_the_last_round_decided(finished):
    """Packings of first rows, those found, and those confirmed; before any round all that there may be."""
    root, decided = finished
    study = small_search(root)
    found = as_decided(study, root / "results" / STUDY)
    assert found.runs == study.with_packings(decided[-1]["packings"]).runs != study.runs
    assert as_decided(study, root / "nothing").runs == study.runs
