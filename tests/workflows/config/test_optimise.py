"""Searches in the configuration: which rows they add, which rounds count, what does not go together with them."""

import json

import pytest

from bulkwear.workflows.config.design import ConfigError, load_study
from bulkwear.workflows.config.layers import Layer
from bulkwear.workflows.config.optimise import (
    NO_PROPOSAL_CHANGES,
    fault_of,
    fault_of_search,
    found_rows,
    optimise_of,
)
from bulkwear.workflows.config.rounds import after_round
from bulkwear.workflows.engine.inputs import run_digest
from bulkwear.workflows.engine.project import Project
from tests.support.searched import SMALL, STUDY, small_search

CHANGED = {  # other values than the study's
    "solver.ranks": 2,
    "solver.search": "stock",
    "solver.kept_restarts": "all",
    "wear.wear_coefficient_error": 0.3,
    "beyond_machine": True,
}
FOUND = {"O5": {"height_mm": 3.0, "minor_radius_mm": 6.5}}


@pytest.fixture
def study(tmp_path):
    return small_search(tmp_path)


def nested(path, value):
    """Settings that give a key, whose path has points, a value."""
    section, _, key = path.rpartition(".")
    return {section: {key: value}} if section else {key: value}


def merged(settings, changed):
    """Settings with others in their place, section by section."""
    found = {key: {**settings.get(key, {}), **value} for key, value in changed.items() if isinstance(value, dict)}
    return {**settings, **changed, **found}


def write_round(root, number, study, rows, after=None):
    folder = root / "results" / STUDY
    (folder / "rounds").mkdir(parents=True, exist_ok=True)
    told = {"rows": rows, "after": after or after_round(folder, number - 1, study.search_digest)}
    (folder / "rounds" / f"round_{number}.json").write_text(json.dumps(told))


def test_a_search_adds_its_rows_behind_the_reference(study):
    """All that it may add; simulated are the reference and the first ones, in as many packings as asked."""
    assert list(study.first_packings) == ["R5", *(f"O{k}" for k in range(1, 10))]
    assert list(study.first_packings.values()) == [2] * 5 + [0] * 5
    first = study.with_packings(study.first_packings)
    assert {run.row for run in first.runs} == {
        f"{row}{packing}" for row in ("R5", "O1", "O2", "O3", "O4") for packing in ("", "-2")
    }
    heights = [row["height_mm"] for row in study.design_rows if row["row"].startswith("O")]
    assert min(heights) >= 2.0 and max(heights) <= 6.0 and len(set(heights)) > 3


@pytest.mark.parametrize(("high", "allowed"), [(0.3, True), (0.29, False), (0.2, False), (0.1, False)])
def test_a_range_is_a_step_long_or_more(high, allowed):
    """From 0.2 to 0.3 by 0.1 is one, though their sum as numbers of the machine is more; less is refused."""
    factor = {"name": "row_offset_fraction", "low": 0.2, "high": high, "step": 0.1}
    asked = optimise_of(nested_goals(factors=[factor]))
    fault = fault_of_search(asked, {}, {"surfaces": ["convex", "plain"]})
    assert (fault is None) == allowed
    assert allowed or fault.endswith(f"has row_offset_fraction from 0.2 to {high:g}, allowed is a step or more")


def nested_goals(**asked):
    """The settings that say what the small search asks, with others in their place."""
    goals = {"most_core_h": 1.0, "least_left_fraction": 0.5, "largest_height_over_radius": 1.0, "seed": 1}
    return {"packings": SMALL["packings"], "optimise": {**goals, **SMALL["optimise"], **asked}}


def test_all_patterns_of_a_packing_share_a_bed_and_a_plain_sample(study):
    """One bed per packing, and the plain twin of the reference stands for that of every other pattern."""
    assert list(study.beds) == ["bed_R5", "bed_R5-2", "bed_R5-3"]
    assert study.bed_of("O1_convex") == study.bed_of("R5_plain") and study.same_as("O1_plain") == "R5_plain"


def test_beds_stay_the_same_whatever_is_proposed(tmp_path, study):
    """They settle above the highest pattern of the ranges, not above that of those found so far."""
    write_round(tmp_path, 1, study, {"O5": {"height_mm": 2.0, "minor_radius_mm": 5.0}})
    assert small_search(tmp_path).beds == study.beds


def test_a_round_gives_rows_their_values(tmp_path, study):
    """Those of the later round too, where it was made after the one before."""
    write_round(tmp_path, 1, study, FOUND)
    write_round(tmp_path, 2, study, {**FOUND, "O6": {"height_mm": 2.5, "minor_radius_mm": 5.0}})
    rows = {row["row"]: row for row in small_search(tmp_path).design_rows}
    assert (rows["O5"]["height_mm"], rows["O5-2"]["minor_radius_mm"], rows["O6"]["height_mm"]) == (3.0, 6.5, 2.5)
    assert rows["O5"]["velocity_m_per_s"] == rows["R5"]["velocity_m_per_s"]
    folder = tmp_path / "results" / STUDY
    assert list(found_rows(folder, study.search_digest, before=2)) == ["O5"]


def test_a_found_pattern_is_no_other_rows(tmp_path, study):
    """Where a round finds what an undecided row stood for, that row stands for another pattern: each is one setting."""
    names = study.optimise.names
    placed = {row["row"]: tuple(row[name] for name in names) for row in study.design_rows}
    write_round(tmp_path, 1, study, {"O5": dict(zip(names, placed["O7"], strict=True))})
    again = {row["row"]: tuple(row[name] for name in names) for row in small_search(tmp_path).design_rows}
    assert again["O5"] == placed["O7"] and len(set(again.values())) == 10


def test_rounds_of_another_question_or_another_past_do_not_count(tmp_path, study):
    """Not after another travel or other hours, not where the round before was decided anew; a larger budget is none."""
    write_round(tmp_path, 1, study, FOUND)
    write_round(tmp_path, 2, study, {**FOUND, "O6": {"height_mm": 2.5, "minor_radius_mm": 5.0}})
    folder = tmp_path / "results" / STUDY
    assert set(found_rows(folder, study.search_digest)) == {"O5", "O6"}
    assert set(found_rows(folder, small_search(tmp_path, most_core_h=20).search_digest)) == {"O5", "O6"}
    assert not found_rows(folder, small_search(tmp_path, after_h=0.5).search_digest)
    write_round(tmp_path, 1, study, {"O5": {"height_mm": 3.5, "minor_radius_mm": 6.5}})
    assert set(found_rows(folder, study.search_digest)) == {"O5"}


@pytest.mark.parametrize("path", [path for path in NO_PROPOSAL_CHANGES if not path.startswith("optimise.")])
def test_settings_that_simulate_nothing_again_keep_the_rounds(tmp_path, study, path):
    """Ranks, the search for contacts, kept restart files: no run is simulated again, so no round is lost."""
    changed = nested(path, CHANGED[path])
    again = load_study(STUDY, Project(tmp_path), overrides=merged(SMALL, changed))
    assert again.settings != study.settings
    assert again.search_digest == study.search_digest
    run, same = study.runs[0], again.runs[0]
    beds = [each.beds[each.bed_of(run.name)] for each in (study, again)]
    assert run_digest(again.case, same.parameters, beds[1]) == run_digest(study.case, run.parameters, beds[0])


@pytest.mark.parametrize(
    ("path", "value"), [("solver.rayleigh_fraction", 0.3), ("wear.wear_coefficient_per_pa", 1e-12), ("packings", 3)]
)
def test_settings_that_change_results_begin_anew(tmp_path, study, path, value):
    """What is simulated, what volumes follow from, and how many packings a pattern has."""
    again = load_study(STUDY, Project(tmp_path), overrides=merged(SMALL, nested(path, value)))
    assert again.search_digest != study.search_digest


def test_fewer_rows_than_were_found_are_refused(tmp_path, study):
    """Lowering the goal keeps rounds, so it cannot go below them."""
    rows = {f"O{5 + k}": {"height_mm": 3.0 + 0.5 * k, "minor_radius_mm": 6.5} for k in range(4)}
    write_round(tmp_path, 1, study, rows)
    with pytest.raises(ConfigError, match=r"optimise\.most_rows is 7, allowed are 8 or more, the rows"):
        small_search(tmp_path, most_rows=7)


def test_a_forecast_counts_every_row_and_the_packings_of_the_best(study):
    """Nine rows and the reference in two packings, three of them in a third one."""
    foreseen = study.foreseen
    assert len(foreseen.runs) == 2 * (10 * 2 + 3)
    assert load_study("demo").foreseen.runs == load_study("demo").runs


def test_patterns_that_cannot_be_made_are_named_with_the_reason(study):
    """Too high for their foot, or overlapping."""
    reference = Layer("", study.design_rows[0])
    assert fault_of(study.optimise, reference, study.runs_of, (3.0, 4.0)) is None
    assert fault_of(study.optimise, reference, study.runs_of, (6.0, 2.0)).startswith("bump too high for its foot: 6 mm")
    close = Layer("", {**study.design_rows[0], "row_spacing_mm": 9.0, "column_spacing_mm": 10.0})
    assert fault_of(study.optimise, close, study.runs_of, (2.0, 6.0)).startswith("bumps overlap: ")
    searched = [row for row in study.design_rows if row["row"].startswith("O")]
    assert all(row["height_mm"] <= 1.5 * min(row["minor_radius_mm"], 4.0) for row in searched)


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        ({"most_rows": 6}, "command line: optimise.most_rows is 6, allowed are 7 or more"),
        ({"confirming_packings": 1}, "optimise.confirming_packings is 1"),
        ({"factors": [*SMALL["optimise"]["factors"], SMALL["optimise"]["factors"][0]]}, "has height_mm twice"),
        ({"factors": [dict(each, high=each["low"]) for each in SMALL["optimise"]["factors"]]}, "from 2 to 2"),
        ({"least_left_fraction": 1}, "optimise.least_left_fraction is 1"),
        ({"largest_height_over_radius": 0.01}, "found 0 designs"),
    ],
)
def test_bad_goals_are_one_sentence(tmp_path, asked, found):
    """Which names the key, what was found and what is allowed."""
    with pytest.raises(ConfigError, match=found.replace(".", r"\.")):
        small_search(tmp_path, **asked)


@pytest.mark.parametrize(
    ("key", "value"), [("until", {"width_fraction": 0.1, "most_packings": 4, "most_core_h": 1}), ("rows", ["R5"])]
)
def test_what_chooses_rows_or_packings_does_not_stand_beside_a_search(tmp_path, key, value):
    """Each would undo what the other decides."""
    with pytest.raises(ConfigError, match=f"{key} stands beside optimise"):
        load_study(STUDY, Project(tmp_path), overrides={**SMALL, key: value})


@pytest.mark.parametrize("left", [("most_core_h",), ("most_core_h", "after_h", "factors")])
def test_a_search_without_all_of_its_keys_is_one_sentence(left):
    """Nothing has a default: the first key that is missing is named; so is what a factor lacks."""
    whole = load_study(STUDY).settings["optimise"]
    some = {key: whole[key] for key in left}
    with pytest.raises(ConfigError, match=r"optimise\.first_rows is missing, allowed is optimise with all of its keys"):
        load_study("demo", overrides={"optimise": some})
    stepless = [{key: value for key, value in each.items() if key != "step"} for each in whole["factors"]]
    with pytest.raises(ConfigError, match=r"optimise\.factors has .* allowed are factors with name, low, high, step"):
        load_study("demo", overrides={"optimise": {**whole, "factors": stepless}})
