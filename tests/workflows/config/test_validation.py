"""Every wrong configuration is refused in one sentence: file, line, key or row, found, allowed."""

from __future__ import annotations

import pytest

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import ConfigError, read_yaml
from bulkwear.workflows.config.schema import load_schema
from bulkwear.workflows.config.validation import check_layer
from tests.support.small_study import message_of
from tests.support.wrong_settings import (
    BAD_COMBINATIONS,
    BAD_KEYS,
    BAD_ROWS,
    BAD_TABLES,
    BAD_VALUES,
    OWN_SETTINGS,
    STUDY,
    TABLE,
)


@pytest.mark.parametrize(("name", "old", "new", "message"), BAD_KEYS + BAD_VALUES)
def test_a_wrong_key_or_value_is_named_with_its_place_and_what_is_allowed(config, name, old, new, message):
    """One fault in one file gives one sentence: file, line, block, key, found, allowed."""
    config.edit(name, old, new)
    assert message_of(config) == message


@pytest.mark.parametrize(("old", "new", "message"), BAD_ROWS)
def test_a_wrong_design_row_is_named_with_line_row_and_column(config, old, new, message):
    """One fault in the design table gives one sentence: file, line, row, column, found, allowed."""
    config.edit(TABLE, old, new)
    assert message_of(config) == message


@pytest.mark.parametrize(("text", "message"), BAD_TABLES)
def test_a_table_without_rows_or_columns_is_refused(config, text, message):
    """A table that is empty, has no rows, another separator or too few columns is refused."""
    config.write(TABLE, text)
    assert message_of(config) == message


@pytest.mark.parametrize(("overrides", "message"), BAD_COMBINATIONS)
def test_values_that_do_not_fit_together_are_refused_before_any_solver(config, overrides, message):
    """Faults between values name the key to change, where it stands, and the limit with its reason."""
    assert message_of(config, overrides) == message


def test_every_message_is_one_sentence(config):
    """A message is one line and ends with one full stop."""
    messages = [case[-1] for case in BAD_KEYS + BAD_VALUES + BAD_ROWS + BAD_TABLES + BAD_COMBINATIONS]
    assert [text for text in messages if "\n" in text or not text.endswith(".") or ". " in text] == []


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            [(STUDY, "fidelities:", "sliding: {travel_mm: 500, test_duration_h: 2}\nfidelities:")],
            "config/studies/small.yaml, line 6: sliding.travel_mm and sliding.test_duration_h are both given, allowed"
            " is one of them.",
        ),
        (
            [(OWN_SETTINGS, " travel_mm: 1000,", "")],
            "config/cases/sliding_sample.yaml, line 23: sliding.travel_mm and sliding.test_duration_h are both missing,"
            " allowed is one of them.",
        ),
        (
            [(OWN_SETTINGS, "travel_mm: 1000", "test_duration_min: 2")],
            "config/cases/sliding_sample.yaml, line 23: unit min is not allowed for sliding.test_duration, write"
            " sliding.test_duration_h (found test_duration_min: 2).",
        ),
    ],
)
def test_either_a_travel_or_a_test_duration_is_given(config, changes, message):
    """Both in one place or none at all is a fault; hours are the unit."""
    for change in changes:
        config.edit(*change)
    assert message_of(config) == message


def test_a_key_of_another_case_tells_that_the_study_names_none(config):
    """It would be taken for one of the default's."""
    config.write(STUDY, config.path(STUDY).read_text() + "parts:\n  liner: {file: liner.stl}\n")
    said = "parts is a key of equipment, and the study names no case, which is sliding_sample then; allowed is case:"
    assert said in message_of(config)


def test_the_sampling_interval_matters_to_sampled_contacts_only(config):
    """With the solver's ledger no cycle is too short to be sampled, and the interval is no parameter of any run."""
    study = load_study("small", config.project, {"solver": {"sampling_interval_steps": 30000}})
    assert all("sampling_interval_steps" not in run.parameters["solver"] for run in study.runs)
    other = load_study("small", config.project, {"solver": {"sampling_interval_steps": 7}})
    assert [run.parameters for run in other.runs] == [run.parameters for run in study.runs]


def test_a_plain_sample_needs_elements_too(config):
    """A plain study, which no bump bounds, still has four elements along its shorter side."""
    config.edit(STUDY, "[convex, plain]", "[plain]")
    assert message_of(config, {"sample": {"element_size_mm": 20, "width_mm": 70}}) == (
        "command line: sample.element_size_mm is 20 for row R9, allowed is at most 17.5 mm,"
        " a quarter of the sample's shorter side."
    )


def test_columns_of_a_pattern_are_needed_by_its_surface_only(config):
    """A plain study's design has no dimensions of a bump, and no pattern is asked for words that describe one."""
    config.edit(STUDY, "[convex, plain]", "[plain]")
    config.write(TABLE, "row,column_spacing_mm,velocity_m_per_s,bed_thickness_mm\nR9,20,1.0,40\n")
    config.edit(OWN_SETTINGS, "major_axis: along_travel, ", "")
    assert [run.parameters["pattern"] for run in load_study("small", config.project).runs] == [None]


def test_a_pattern_lacks_no_word_that_describes_it(config):
    """A key of the section `pattern` that only some surfaces need is named where one of them lacks it."""
    config.edit(OWN_SETTINGS, "major_axis: along_travel, ", "")
    assert message_of(config) == (
        "config/cases/sliding_sample.yaml, line 9: pattern.major_axis is missing,"
        " allowed is one of along_travel, across_travel, which its surface needs."
    )


def test_a_factor_is_a_column_of_the_design(config):
    """A regression on a dimension that the design does not give is refused."""
    config.edit(STUDY, "[convex, plain]", "[plain]\nfactors: {t: bed_thickness_mm, h: height_mm}")
    config.write(TABLE, "row,column_spacing_mm,velocity_m_per_s,bed_thickness_mm\nR9,20,1.0,40\nR5,20,1.0,50\n")
    assert message_of(config) == (
        "config/studies/small.yaml, line 5: factors.h is height_mm,"
        " allowed are columns that the design gives in every row."
    )


def test_a_travel_too_short_for_one_cycle_is_named(config):
    """Where no number of cycles helps, the travel is named."""
    config.edit(TABLE, "R9,8,2,20,6.0,1.0", "R9,8,2,20,6.0,20")
    message = message_of(config, {"sliding": {"travel_mm": 1}, "solver": {"sampling_interval_steps": 1}})
    assert message == (
        "command line: sliding.travel_mm is 1 for row R9, allowed is at least 17.2461 mm, 100 time steps."
    )


def test_the_first_fault_of_a_file_is_reported(config):
    """Of two faults in a file the upper one is named; a missing key, which has no line, comes last."""
    config.edit(OWN_SETTINGS, "length_mm: 200", "length_mm: 0")
    config.edit(OWN_SETTINGS, "  width_mm: 200\n", "")
    config.edit(OWN_SETTINGS, "seed: 20220317", "seed: 0")
    with pytest.raises(ConfigError, match=r"line 2: sample.length_mm is 0"):
        check_layer(read_yaml(config.path(OWN_SETTINGS), config.root), load_schema("cases/sliding_sample/settings"))


@pytest.mark.parametrize(
    ("given", "key", "column"),
    [
        ({"bed": {"thickness_mm": 46}}, "bed.thickness_mm (46)", "bed_thickness_mm"),
        ({"sliding": {"velocity_m_per_s": 1}}, "sliding.velocity_m_per_s (1)", "velocity_m_per_s"),
        ({"bed_thickness_mm": 46}, "bed_thickness_mm (46)", "bed_thickness_mm"),
    ],
)
def test_a_key_that_is_a_column_of_the_design_is_told(given, key, column):
    """What the design table gives is no setting; the refusal names the column."""
    with pytest.raises(ConfigError) as fault:
        load_study("demo", overrides=given)
    said = f"{key} is no known key, it is the column {column} of the study's design table."
    assert str(fault.value) == f"command line: {said}"


def test_a_setting_that_every_row_has_its_own_of_is_refused_on_the_command_line():
    """It would change nothing; where a row lacks the column, it does."""
    with pytest.raises(ConfigError) as fault:
        load_study("particle_size", overrides={"particle_scale": 20})
    assert str(fault.value) == (
        "command line: particle_scale changes nothing, for every row of config/designs/particle_size.csv has its own"
        " particle_scale; allowed is to choose among them (rows), or another design."
    )
    assert load_study("circular_tester", overrides={"particle_scale": 5}).runs
    with pytest.raises(ConfigError, match=r"parts\.liner\.file changes nothing, for every row of config/designs/chute"):
        load_study("chute", overrides={"fidelity": "standard", "parts": {"liner": {"file": "nope.step"}}})
