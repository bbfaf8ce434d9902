"""Columns of a design that are the path of a setting: which there may be, what they override, where faults stand."""

from __future__ import annotations

import math

import pytest

from bulkwear.workflows.config.columns import as_settings, row_overrides, with_row
from bulkwear.workflows.config.layers import ConfigError, Layer
from tests.support.own_machine_project import SETTINGS, machine_study

TABLE = "config/designs/machine.csv"


def message_of(folder, rows, **changes) -> str:
    with pytest.raises(ConfigError) as caught, machine_study(folder, rows, **changes):
        pass
    return str(caught.value)


def test_any_setting_that_is_one_number_or_word_may_be_a_column(tmp_path):
    """Numbers, words and settings of a named part change from row to row; an empty cell leaves the study's."""
    header = "row,parts.liner.edge_mm,inlet.rate_t_per_h,parts.plate.material,parts.paddle.motion.speed_rpm"
    rows = f"{header}\nA,20,1.2,perspex,90\nB,,,,\n"
    with machine_study(tmp_path, rows, parts={"liner": {"edge_mm": 10}}) as study:
        own, as_written = (study.run(name).parameters for name in "AB")
    assert own["parts"][0]["edge_m"] == 0.02
    assert as_written["parts"][0]["edge_m"] == 0.01
    assert own["inlet"]["rate_kg_per_s"] == pytest.approx(1200 / 3600)
    assert as_written["inlet"]["rate_kg_per_s"] == pytest.approx(1500 / 3600)
    assert [own["parts"][1][key] for key in ("material", "type")] == ["perspex", 3]
    assert own["parts"][2]["motion"]["speed_rad_per_s"] == pytest.approx(90 * 2.0 * math.pi / 60.0)


def test_a_list_of_numbers_may_be_a_column(tmp_path):
    """As the velocity of a belt and of what it feeds; numbers have spaces between, an empty cell leaves the study's."""
    header = "row,inlet.velocity_m_per_s,parts.paddle.motion.point_mm,operation.told_at_h"
    rows = f"{header}\nA,0.5 0  -1e0,60 0 -210,100 200\nB,,,\n"
    with machine_study(tmp_path, rows) as study:
        own, as_written = (study.run(name).parameters for name in "AB")
        assert study.setting_of == {"A": "A", "B": "B"}
        table = study.design_table()
    assert own["inlet"]["velocity_m_per_s"] == [0.5, 0.0, -1.0]
    assert as_written["inlet"]["velocity_m_per_s"] == SETTINGS["inlet"]["velocity_m_per_s"]
    assert own["parts"][2]["motion"]["point_m"] == pytest.approx([0.06, 0.0, -0.21])
    assert own["operation"]["told_at_s"] == pytest.approx([100 * 3600, 200 * 3600])
    assert table[0]["inlet.velocity_m_per_s"] == "0.5 0 -1"


def test_remarks_in_a_table_are_read_by_people_alone(tmp_path):
    """A column of them changes no run and no setting: rows that differ in it alone are packings of one another."""
    with machine_study(tmp_path, "row,inlet.rate_t_per_h\nA,1.2\nB,1.3\n") as study:
        plain = [run.parameters for run in study.runs]
    with machine_study(tmp_path, 'row,note,inlet.rate_t_per_h\nA,"as ordered, 2024",1.2\nB,,1.3\n') as study:
        assert [run.parameters for run in study.runs] == plain
        assert "note" not in study.design_table()[0]


def test_a_key_may_be_given_by_rows_alone(tmp_path):
    """What no file gives, but every row, is not missing; a row without it is the one that is named."""
    rows = "row,inlet.rate_t_per_h,parts.liner.material\nA,1.2,steel\n"
    left_out = {"inlet": {"rate_t_per_h": None}, "parts": {"liner": {"material": None}}}
    with machine_study(tmp_path, rows, **left_out) as study:
        assert study.runs[0].parameters["inlet"]["rate_kg_per_s"] == pytest.approx(1200 / 3600)
    said = message_of(tmp_path, f"{rows}B,1.3,\n", **left_out)
    assert "parts.liner.material is missing" in said


@pytest.mark.parametrize(
    ("column", "said"),
    [
        ("parts.liner", "column parts.liner is a block of keys, allowed are settings that are a number, a word or a"),
        ("bulk.seed", "column bulk.seed has a name of its own, write seed."),
        ("until.width_fraction", "column until.width_fraction is a setting of the whole study, allowed are those of a"),
        ("solver.ranks", "column solver.ranks is a setting of the whole study, allowed are those of a run"),
        ("inlet.rate_kg_per_h", "inlet.rate_kg_per_h is no known setting, the nearest is inlet.rate_t_per_h."),
        ("parts.liner.edge_cm", "unit cm is not allowed for parts.liner.edge, write parts.liner.edge_mm"),
        ("wear.parameters.exponent", "wear.parameters.exponent is no known setting"),
    ],
)
def test_a_column_that_is_no_such_setting_is_named(tmp_path, column, said):
    """Blocks, settings with a column of their own, of the whole study, unknown ones and other units."""
    message = message_of(tmp_path, f"row,{column}\nA,1\n")
    assert message.startswith(f"{TABLE}, header: ") and said in message, message


@pytest.mark.parametrize(
    ("column", "cell", "said"),
    [
        ("inlet.rate_t_per_h", "-3", "inlet.rate_t_per_h is -3, allowed is a number from 0.001 to 50000 t/h."),
        ("parts.liner.role", "moves", "parts.liner.role is 'moves', allowed is one of wears, rigid."),
        ("parts.plate.material", "stel", "parts.plate.material is 'stel', allowed is one of"),
        ("bulk.material", "or", "bulk.material is 'or', allowed is one of"),
        (
            "inlet.velocity_m_per_s",
            "1 fast 0",
            "inlet.velocity_m_per_s is '1 fast 0', allowed is a list of three numbers from -100 to 100 m/s, with",
        ),
        ("inlet.velocity_m_per_s", "1 0", "inlet.velocity_m_per_s is [1, 0], allowed is a list of three numbers"),
        ("inlet.velocity_m_per_s", "1 0 900", "inlet.velocity_m_per_s[3] is 900, allowed is a number from -100 to 100"),
        ("parts.linr.edge_mm", "30", "parts.linr.file is missing, allowed is a file in meshes (or was parts.liner"),
    ],
)
def test_a_wrong_cell_of_such_a_column_is_named_with_its_row(tmp_path, column, cell, said):
    """Out of range, no word of the schema, no material, no such part: with line and row of the table."""
    message = message_of(tmp_path, f"row,{column}\nA,{cell}\n")
    assert message.startswith(f"{TABLE}, line 2, row A: ") and said in message, message


def test_a_row_replaces_the_alternative_that_the_study_gives(tmp_path):
    """Four tonnages in the rows of a study with hours: the row's stands; both in one row are refused."""
    rows = "row,operation.throughput_mt,operation.duration_h\nA,0.003,\nB,,100\n"
    with machine_study(tmp_path, rows) as study:
        by_mass, by_time = (study.run(name).parameters["derived"]["operation_s"] for name in "AB")
    assert by_mass == pytest.approx(3000 / 1.5 * 3600) and by_time == 360000
    both = "row,operation.throughput_mt,operation.duration_h\nA,0.003,100\n"
    assert message_of(tmp_path, both).startswith(
        f"{TABLE}, line 2, row A: operation.duration_h and operation.throughput_mt are both given"
    )


def test_rows_of_one_design_with_other_settings_are_other_designs(tmp_path):
    """Rows that differ in such a column are no packings of one another."""
    with machine_study(tmp_path, "row,inlet.rate_t_per_h\nA,1\nB,2\n", packings=2) as study:
        assert [run.name for run in study.runs] == ["A", "A-2", "B", "B-2"]
        assert study.setting_of == {"A": "A", "A-2": "A", "B": "B", "B-2": "B"}


def test_what_a_row_overrides():
    """Columns with a setting of their own, and those that are a path; the settings of before stay as they were."""
    schema = {"properties": {"row": {}, "seed": {"x-setting": "bulk.seed"}, "packings": {"x-setting": "packings"}}}
    row = Layer("t.csv", {"row": "A", "seed": 7, "parts.a.edge_mm": 2.0}, {(): 3}, "row A")
    columns = row_overrides(row, schema)
    assert columns == {"bulk.seed": "seed", "parts.a.edge_mm": "parts.a.edge_mm"}
    own = as_settings(row, columns)
    assert own.values == {"bulk": {"seed": 7}, "parts": {"a": {"edge_mm": 2.0}}}
    assert own.where(("parts", "a")) == "t.csv, line 3, row A"
    settings = {"bulk": {"seed": 1, "x": 2}, "parts": {"a": {"edge_mm": 1.0}, "b": {}}, "o": {"h": 1}}
    found = with_row(settings, own, [(("o", "h"), ("o", "mt"))])
    assert found == {"bulk": {"seed": 7, "x": 2}, "parts": {"a": {"edge_mm": 2.0}, "b": {}}, "o": {"h": 1}}
    assert settings["bulk"]["seed"] == 1
