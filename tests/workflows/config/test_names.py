"""Names that a table would lose."""

from __future__ import annotations

import io

import pandas as pd
import pytest
from pandas._libs.parsers import STR_NA_VALUES

from bulkwear.workflows.config.design import ConfigError
from bulkwear.workflows.config.run_checks import NO_VALUES, OTHER_VALUES
from tests.support.own_machine_project import SETTINGS, machine_study

LOST_PARTS = ("nan", "null", "true", "inf")
NUMBERS = ("1", "007", "1e5", "2E3", "1e400")
LOST_ROWS = ("NA", "NULL", "None", "True", "INF", *NUMBERS)
KEPT = ("na", "none", "all", "0x1", "5e", "12-2", "12a")  # of parts, and of rows


def read_again(name: str):
    """The name as pandas reads it from a column of nothing else."""
    return pd.read_csv(io.StringIO(f"name\n{name}\n"), skip_blank_lines=False)["name"].iloc[0]


def test_names_that_are_lost_are_those_of_pandas():
    """All of its spellings of no value, and what it reads as a truth value or a number."""
    assert set(NO_VALUES) == STR_NA_VALUES - {""}
    assert not any(isinstance(read_again(name), str) for name in (*NO_VALUES, *OTHER_VALUES, *NUMBERS))
    assert [read_again(name) for name in KEPT] == list(KEPT)


@pytest.mark.parametrize("name", LOST_PARTS)
def test_a_part_that_tables_would_lose_is_refused(tmp_path, name):
    """With its key, and what the name is taken for."""
    words = rf"parts\.{name} is .* for row A, allowed is another name: in a table '{name}' is taken for "
    hood = {"unit": "mm", "material": "steel", **SETTINGS["parts"]["hood"]}
    with pytest.raises(ConfigError, match=words), machine_study(tmp_path, parts={name: hood, "hood": None}):
        pass


@pytest.mark.parametrize("name", LOST_ROWS)
def test_a_row_that_tables_would_lose_is_refused(tmp_path, name):
    """With its line in the design."""
    words = rf"line 2, row {name}: row is '{name}', allowed is another name: in a table '{name}' is taken for "
    with pytest.raises(ConfigError, match=words), machine_study(tmp_path, f"row\n{name}\n"):
        pass


@pytest.mark.parametrize("name", KEPT)
def test_names_that_tables_keep_are_accepted(tmp_path, name):
    """As rows; those of parts are free."""
    with machine_study(tmp_path, f"row\n{name}\n") as study:
        assert study.runs[0].row == name
