"""Columns of design tables that stand for settings: those that a case names, and where it allows it any setting.

A column of the second kind is the path of a setting, with points: parts.liner.file. Its cells are one number, one word,
or the numbers of a list with spaces between.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bulkwear.workflows.config.chosen import ROWS
from bulkwear.workflows.config.layers import ConfigError, KeyPath, Layer, display_name, merge, overridden, read_csv_rows
from bulkwear.workflows.config.optimise import OPTIMISE
from bulkwear.workflows.config.schema import case_schema, leaves, subschema
from bulkwear.workflows.config.until import UNTIL
from bulkwear.workflows.config.validation import allowed_text, check_alternatives, is_list_of_numbers, unknown_key
from bulkwear.workflows.engine.project import Project

ANY_SETTING = "x-any-setting"  # key of the schema of a design table
OF_STUDY = (UNTIL, OPTIMISE, "solver.ranks")  # sections and settings that are the whole study's


def setting_columns(schema: dict[str, Any]) -> dict[str, str]:
    """Return {setting: column} of all columns that stand for a setting of their row."""
    return {inner["x-setting"]: column for (column,), inner in leaves(schema) if "x-setting" in inner}


def row_overrides(row: Layer, schema: dict[str, Any]) -> dict[str, str]:
    """Return {setting: column} of the settings that a design row overrides: the schema of such a column names one."""
    named = {setting: column for setting, column in setting_columns(schema).items() if column in row.values}
    return named | {column: column for column in row.values if "." in column}


def as_settings(row: Layer, columns: dict[str, str]) -> Layer:
    """Return the settings that a design row overrides as a layer; columns: as from `row_overrides`."""
    values: dict[str, Any] = {}
    for setting, column in columns.items():
        value = row.values[column]
        for key in reversed(setting.split(".")):
            value = {key: value}
        values = merge(values, value)
    return Layer(row.source, values, {(): row.line(())}, row.block)


def check_heard(command: Layer, rows: Sequence[Layer], schema: dict[str, Any]) -> None:
    """Raise ConfigError for a setting of the command line that every row of a design has its own of."""
    named = setting_columns(schema) | {column: column for row in rows for column in row.values if "." in column}
    for setting, column in named.items():
        path = tuple(setting.split("."))
        if command.holds(path) and rows and all(column in row.values for row in rows):
            raise ConfigError(
                f"{command.where(path)}: {setting} changes nothing, for every row of {rows[0].source} has its own"
                f" {column}; allowed is to choose among them ({ROWS}), or another design."
            )


def with_row(settings: dict[str, Any], row: Layer, alternatives: Sequence[Sequence[KeyPath]]) -> dict[str, Any]:
    """Return the settings of one design row; row: as from `as_settings`.

    alternatives: groups of settings; of each the row's stands for all others

    Raises ConfigError for a row with two of them.
    """
    for each in alternatives:
        check_alternatives(row, each, required=False)
    return overridden(settings, row, alternatives)


def opened(schema: dict[str, Any], path: Path, project: Project, case: str) -> dict[str, Any]:
    """Return the schema of a case's design table; where any setting may be a column of it, those of the table's header.

    Raises ConfigError for a path in the header that is no setting, or one that no cell can hold.
    """
    if not schema.get(ANY_SETTING):
        return schema
    header, _ = read_csv_rows(path, project.folder)
    settings, own = case_schema(case, "settings"), setting_columns(schema)
    found = {}
    for name in (name for name in header if "." in name):
        fault, inner = _fault(name, settings, own)
        if fault:
            raise ConfigError(f"{display_name(path, project.folder)}, header: {fault}.")
        found[name] = inner
    return {**schema, "properties": {**schema["properties"], **found}}


def _fault(name: str, settings: dict[str, Any], own: dict[str, str]) -> tuple[str, dict[str, Any]]:
    """Return what is wrong with a column that is the path of a setting, "" where nothing is, and its schema."""
    key = tuple(name.split("."))
    inner = subschema(settings, key)
    if name in own:
        return f"column {name} has a name of its own, write {own[name]}", {}
    if key[0] in OF_STUDY or name in OF_STUDY:
        return f"column {name} is a setting of the whole study, allowed are those of a run", {}
    if not inner:
        return unknown_key(key, settings, noun="setting"), {}
    if is_list_of_numbers(inner):
        return "", {**inner, "x-allowed": f"{allowed_text(inner)}, with spaces between"}
    if inner.get("type") in ("object", "array"):
        kind = {"object": "a block of keys", "array": "a list of words or blocks"}[inner["type"]]
        return f"column {name} is {kind}, allowed are settings that are a number, a word or a list of numbers", {}
    return "", inner
