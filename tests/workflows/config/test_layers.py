"""What files and the command line give is read as it was meant, or refused by file and line."""

from __future__ import annotations

import pytest

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import command_line_layer, merge, read_yaml
from tests.support.small_study import message_of
from tests.support.wrong_settings import MATERIALS, OWN_SETTINGS, SETTINGS, STUDY, TABLE


def test_text_in_another_encoding_is_refused(config):
    """A table saved as UTF-16 is refused by name."""
    config.path(TABLE).write_bytes(config.path(TABLE).read_text(encoding="utf-8").encode("utf-16"))
    assert message_of(config) == "config/designs/small.csv, line 1: the byte 0xff is not UTF-8, allowed is UTF-8 text."


def test_a_table_from_a_spreadsheet_is_read(config):
    """Byte order mark, CRLF, spaces, blank lines and empty columns on the right change nothing."""
    plain = load_study("small", config.project)
    text = config.path(TABLE).read_text(encoding="utf-8")
    spread = "\ufeff" + text.replace("\n", ",,\r\n,,\r\n").replace(",", " , ")
    config.path(TABLE).write_bytes(spread.encode())
    assert load_study("small", config.project) == plain


def test_broken_yaml_is_refused_with_its_line(config):
    """What is no YAML is refused with file and line."""
    config.edit(OWN_SETTINGS, "  seed: 20220317\n", "  seed: 20220317\n\tx: 1\n")
    assert message_of(config).startswith("config/cases/sliding_sample.yaml, line 21: found character '\\t'")


def test_a_file_that_is_no_mapping_is_refused(config):
    """A list where keys are expected is refused."""
    config.write(STUDY, "- a\n")
    assert message_of(config) == "config/studies/small.yaml: found a list, allowed is a mapping of keys to values."


def test_a_folder_in_place_of_a_study_is_told(config):
    config.path(STUDY).unlink()
    config.path(STUDY).mkdir()
    assert message_of(config) == (
        f"config/{STUDY}: found no such file, a folder perhaps; allowed is the file of a study."
    )


def test_a_missing_file_is_named(config):
    """Without materials.yaml the message says which files there are."""
    config.path(MATERIALS).unlink()
    assert message_of(config) == ("config/materials.yaml: there is no such file, found in its folder: default.yaml.")


@pytest.mark.parametrize("text", ["6.3e-13", "6.3E-13", "63e-14", "+6.3e-13", ".63e-12", "0.00000000000063"])
def test_every_way_to_write_a_float_is_a_number(config, text):
    """YAML 1.2 floats are numbers, also without a point before the exponent (YAML 1.1: 63e-14 is text)."""
    config.edit(SETTINGS, "6.3e-13", text)
    study = load_study("small", config.project)
    assert study.settings["wear"]["wear_coefficient_per_pa"] == 6.3e-13


@pytest.mark.parametrize(("text", "value"), [("010", 10), ("1_0", "1_0"), ("1:30", "1:30"), ("on", "on"), ("~", None)])
def test_yaml_1_1_surprises_do_not_happen(tmp_path, text, value):
    """No octal 010, no base-60 1:30, no boolean `on`, no underscores in numbers."""
    (tmp_path / "a.yaml").write_text(f"key: {text}\n", encoding="utf-8")
    assert read_yaml(tmp_path / "a.yaml", tmp_path).values == {"key": value}


def test_command_line_text_becomes_numbers():
    """A shell knows only text; numbers and booleans in it are read as in the files, words stay words."""
    given = {"a": "2", "b": {"c": "1e-9", "d": "True", "e": "steel"}, "f": [{"low": "0.1"}, ["3"], "4"]}
    read = {"a": 2, "b": {"c": 1e-9, "d": True, "e": "steel"}, "f": [{"low": 0.1}, [3], 4]}
    assert command_line_layer(given).values == read


def test_names_of_rows_stay_words():
    """A row may be called 5."""
    assert command_line_layer({"rows": ["5", "R9"]}).values == {"rows": ["5", "R9"]}


def test_merge_is_deep_and_changes_nothing():
    """Keys of the upper mapping win at every depth; both arguments stay as they were."""
    lower, upper = {"a": {"b": 1, "c": 2}, "d": {"g": 3}}, {"a": {"c": 4}, "e": {"f": 5}}
    merged = merge(lower, upper)
    merged["a"]["b"] = merged["d"]["g"] = merged["e"]["f"] = 9
    assert merged == {"a": {"b": 9, "c": 4}, "d": {"g": 9}, "e": {"f": 9}}
    assert (lower, upper) == ({"a": {"b": 1, "c": 2}, "d": {"g": 3}}, {"a": {"c": 4}, "e": {"f": 5}})
