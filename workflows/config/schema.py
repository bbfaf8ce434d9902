"""The schemas of the configuration: where they lie, what of them is filled in from registries, and their keys."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache, reduce
from pathlib import Path
from typing import Any

from bulkwear.postproc.wear.laws import LAWS
from bulkwear.workflows.config.layers import ConfigError, KeyPath, display_name, read_yaml
from bulkwear.workflows.config.patterns import with_patterns
from bulkwear.workflows.engine.cases import case_folders, case_names, find_case
from bulkwear.workflows.engine.project import current_project

SCHEMA_FOLDER = Path(__file__).parent / "schemas"
OF_PACKAGE = Path(__file__).parents[1]  # where its schemas lie
LAW = "law"  # key of settings whose allowed words are the registered wear laws
# unit -> the least that a quantity above 0 can sensibly be, in every schema that says "above 0" and no more
LEAST = {
    "mm": 1e-3,  # a micrometre: finer than surfaces are drawn and particles are
    "1/Pa": 1e-20,  # wear coefficient k of 1e-9, the mildest known, over the hardness of diamond, 1e11 Pa
    "s": 1e-6,  # a few time steps of a stiff small particle
    "h": 1e-9,  # as seconds
    "t/h": 1e-3,
    "Mt": 1e-9,
    "kg/m": 1e-3,
    "deg/s": 1e-3,
    "-": 1e-9,  # fractions below drown in the rounding of the lengths and sums that they are of
}
OF_CASES = "cases/"  # names of schemas that are a case's: cases/<case>/<kind>


def _is_number(_checker: Any, value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _is_integer(_checker: Any, value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


@cache
def validator() -> type:
    """Return the validator of the schemas (class of jsonschema), for which a number is finite and no boolean."""
    from jsonschema import Draft202012Validator, validators  # slow to import, and most jobs validate nothing

    types = Draft202012Validator.TYPE_CHECKER.redefine_many({"number": _is_number, "integer": _is_integer})
    return validators.extend(Draft202012Validator, type_checker=types)


def schema_files(name: str) -> list[Path]:
    """Return the files of a schema; those of a case (cases/<case>/<kind>) lie in its folder, and in those of the cases
    that it extends, first.
    """
    if not name.startswith(OF_CASES):
        return [SCHEMA_FOLDER / f"{name}.schema.yaml"]
    case, kind = name.removeprefix(OF_CASES).split("/")
    files = (folder / f"{kind}.schema.yaml" for folder in reversed(case_folders(find_case(case))))
    return [path for path in files if path.is_file()]


@cache
def load_schema(name: str) -> dict[str, Any]:
    """Return the schema of that name, empty without a file. Raises ConfigError for one of a project that is none."""
    parts = map(_read_schema, schema_files(name))
    schema = reduce(joined, parts, {}) or {"type": "object", "additionalProperties": False, "properties": {}}
    for path, inner in leaves(schema):
        if path[-1] == LAW and inner.get("enum") == []:
            inner["enum"] = sorted(LAWS)
    if name == "study":
        schema["properties"]["case"]["enum"] = case_names()
    return schema


def _read_schema(path: Path) -> dict[str, Any]:
    """Return one file of a schema. Raises ConfigError for one that is none: a project may bring it. Tests look at those
    of the package, because to do so takes longer than to read them.
    """
    schema = _with_least(with_patterns(read_yaml(path, current_project().folder).values))
    shown = display_name(path, current_project().folder)
    if not isinstance(schema.get("properties"), dict):
        raise ConfigError(
            f"{shown}: there are no properties in it, allowed is a JSON schema of a block with properties."
        )
    if path.is_relative_to(OF_PACKAGE):
        return schema
    from jsonschema import SchemaError

    try:
        validator().check_schema(schema)
    except SchemaError as fault:
        place = ".".join(map(str, fault.absolute_path)) or "the schema"
        raise ConfigError(f"{shown}: {place} is {fault.instance!r}, allowed is a JSON schema.") from None
    return schema


def _with_least(schema: Any, unit: str = "") -> Any:
    """Return a schema in which quantities that are only said to be above 0 have the least that is sensible."""
    if isinstance(schema, list):
        return [_with_least(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    unit = schema.get("x-unit", unit)
    inner = {key: _with_least(value, unit if key == "items" else "") for key, value in schema.items()}
    above_zero = inner.get("type") == "number" and inner.get("exclusiveMinimum") == 0 and "minimum" not in inner
    if not above_zero or unit not in LEAST:
        return inner
    return {key: value for key, value in inner.items() if key != "exclusiveMinimum"} | {"minimum": LEAST[unit]}


def joined(first: dict[str, Any], second: dict[str, Any]) -> dict[str, Any]:
    """Return the schema of blocks with the keys of both; a block that both have is joined in turn."""
    properties = dict(first.get("properties", {}))
    for key, inner in second["properties"].items():
        blocks = "properties" in inner and "properties" in properties.get(key, {})
        properties[key] = joined(properties[key], inner) if blocks else inner
    required = list(dict.fromkeys([*first.get("required", []), *second.get("required", [])]))
    return {**second, **first, "properties": properties, "required": required}


@cache
def case_schema(case: str, kind: str) -> dict[str, Any]:
    """Return the schema of a case's settings or studies: what all cases share, and its own."""
    return joined(load_schema(kind), load_schema(f"{OF_CASES}{case}/{kind}"))


def without_required(schema: Any) -> Any:
    """Return the schema with nothing required: for a layer that overrides some keys."""
    if isinstance(schema, dict):
        return {key: without_required(value) for key, value in schema.items() if key != "required"}
    return [without_required(value) for value in schema] if isinstance(schema, list) else schema


def subschema(schema: dict[str, Any], path: KeyPath) -> dict[str, Any] | None:
    """Return the schema of the key at a path, None where the schema does not know it."""
    for key in path:
        inner = schema.get("properties", {}).get(key, schema.get("additionalProperties"))
        schema = schema.get("items") if isinstance(key, int) else inner
        if not isinstance(schema, dict):
            return None
    return schema


def leaves(schema: dict[str, Any], path: KeyPath = ()) -> Iterator[tuple[KeyPath, dict[str, Any]]]:
    """Yield (key path, schema) of every key that holds a value; `<name>` stands for a free name."""
    for key, inner in _children(schema):
        if "x-allowed" not in inner and any(True for _ in _children(inner)):
            yield from leaves(inner, (*path, key))
        else:
            yield (*path, key), inner


def _children(schema: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    yield from schema.get("properties", {}).items()
    if isinstance(schema.get("additionalProperties"), dict):
        yield "<name>", schema["additionalProperties"]


def coerce_numbers(values: Any, schema: dict[str, Any] | None) -> Any:
    """Return the values with every `number` as float, so that 2 and 2.0 give the same parameters."""
    if schema is None:
        return values
    if isinstance(values, dict):
        return {key: coerce_numbers(inner, subschema(schema, (key,))) for key, inner in values.items()}
    if isinstance(values, list):
        return [coerce_numbers(inner, schema.get("items")) for inner in values]
    return float(values) if schema.get("type") == "number" else values
