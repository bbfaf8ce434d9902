"""Check configuration against the schemas and say in one sentence what is wrong.

Checks of one value (type, range, unit) come from the schemas; checks that compare values of a run are in
run_checks.py. Nothing here needs the solver.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.config.bounded import LONGEST_NUMBER
from bulkwear.workflows.config.layers import (
    INTEGER,
    NUMBER,
    ConfigError,
    KeyPath,
    Layer,
    display_name,
    dotted,
    read_csv_rows,
)
from bulkwear.workflows.config.schema import leaves, load_schema, subschema, validator

if TYPE_CHECKING:
    from jsonschema import ValidationError

# Suffix of a key -> unit as written in the schemas (x-unit); no suffix: "-".
UNIT_OF_SUFFIX = {
    "mm": "mm",
    "deg": "deg",
    "deg_per_s": "deg/s",
    "n": "N",
    "pa": "Pa",
    "per_pa": "1/Pa",
    "pa_s": "Pa s",
    "kg_per_m3": "kg/m3",
    "j_per_m3": "J/m3",
    "n_per_m": "N/m",
    "m_per_s": "m/s",
    "rpm": "rpm",
    "t_per_h": "t/h",
    "mt": "Mt",
    "s": "s",
    "steps": "steps",
    "h": "h",
}
# Suffixes that people write instead; recognised only to explain the mistake.
FOREIGN_SUFFIXES = (
    *("nm", "um", "cm", "dm", "m", "km", "in", "inch", "ft", "kn", "rad_per_s"),
    *("rad", "degrees", "radians", "percent"),
    *("kpa", "mpa", "gpa", "per_kpa", "per_mpa", "per_gpa"),
    *("mm_per_s", "cm_per_s", "km_per_h", "g_per_cm3", "t_per_m3"),
    *("ms", "min", "kg", "g"),
)
ALL_SUFFIXES = sorted([*UNIT_OF_SUFFIX, *FOREIGN_SUFFIXES], key=len, reverse=True)
OTHER_BASE = re.compile(r"[-+]?0[xXoObB][0-9A-Fa-f]+\Z")
VALUE_WITH_UNIT = re.compile(r"(?P<number>[-+]?[0-9][0-9.]*(?:[eE][-+]?[0-9]+)?)\s*(?P<unit>[A-Za-z°%/][\w/%^°]*)\Z")


NEEDED = "x-needed"  # of the schema of a block: keys that a study gives, for which there are no defaults
NUMBERS = ("number", "integer")  # types of the schemas that have a range and a unit
REMARKS = "note"  # column of a design table that people read alone
LONGEST_ROW = 60  # letters of a row's name
LONGEST_VALUE = 60  # characters of a value that a message shows
ALIKE, ALIKE_PATHS = 0.6, 0.7  # -, least likeness of a key and of its whole path to a known one that is named instead


def check_layer(layer: Layer, schema: dict[str, Any], columns: Collection[str] = ()) -> None:
    """Raise ConfigError for the first fault of a layer against a schema by lines, missing keys last.

    columns: of the design table that stand for no setting: one that an unknown key means is named
    """
    errors = list(validator()(schema).iter_errors(layer.values))
    faults = [(path, said, False) for path, said in _faults(errors, schema, columns)]
    faults += [(path, said, True) for path, said in _missing(errors)]
    if faults:
        path, said, _ = min(faults, key=lambda item: (item[2], layer.line(item[0]), dotted(item[0])))
        raise ConfigError(f"{layer.where(path)}: {said()}.")


def check_alternatives(layer: Layer, alternatives: Sequence[KeyPath], required: bool) -> None:
    """Raise ConfigError for a layer with both of two alternatives, or with neither where one is `required`."""
    given = [path for path in alternatives if layer.holds(path)]
    both, neither = len(given) > 1, required and alternatives and not given
    if both or neither:
        names = " and ".join(map(dotted, alternatives))
        found = "are both given" if both else "are both missing"
        where = layer.where(given[-1] if given else alternatives[0])
        raise ConfigError(f"{where}: {names} {found}, allowed is one of them.")


def _faults(
    errors: Sequence[ValidationError], schema: dict[str, Any], columns: Collection[str]
) -> Iterator[tuple[KeyPath, Callable[[], str]]]:
    """Yield (key path, what makes the sentence without its end) for every value that is wrong and every unknown key."""
    for error in errors:
        path = tuple(error.absolute_path)
        if error.validator == "additionalProperties":
            for key in [key for key in error.instance if key not in error.schema.get("properties", {})]:
                found = show(error.instance[key])
                if column := next((name for name in columns if name in _columns_meant(path, key)), None):
                    yield (*path, key), partial(_is_column, (*path, key), found, column)
                else:
                    yield (*path, key), partial(unknown_key, (*path, key), schema, found=found)
        elif error.validator != "required":
            yield path, partial(wrong_value, path, error.instance, error.schema)


def own_columns(schema: dict[str, Any]) -> list[str]:
    """Return the columns of numbers of a design table that stand for no setting; schema: of its rows."""
    return [name for (name,), inner in leaves(schema) if inner.get("type") in NUMBERS and "x-setting" not in inner]


def _columns_meant(path: KeyPath, key: Any) -> tuple[str, ...]:
    """Return the names of columns that a key of a block may mean: its own, and its own after its block's."""
    return (str(key), f"{path[-1]}_{key}") if path else (str(key),)


def _is_column(path: KeyPath, found: str, column: str) -> str:
    """Return the fault of a key that is a column of the design table."""
    return f"{dotted(path)} ({found}) is no known key, it is the column {column} of the study's design table"


def _missing(errors: Sequence[ValidationError]) -> Iterator[tuple[KeyPath, Callable[[], str]]]:
    """Yield (path of the block, what makes the sentence) for every block in which a key is missing."""
    for error in errors:
        if error.validator == "required":
            path = tuple(error.absolute_path)
            key = next(key for key in error.validator_value if key not in error.instance)
            allowed = allowed_text(error.schema["properties"][key])
            yield path, partial(str, f"{dotted((*path, key))} is missing, allowed is {allowed}")


def check_given(
    layers: tuple[Layer, ...],
    settings: dict[str, Any],
    schema: dict[str, Any],
    path: KeyPath = (),
    beside: Sequence[str] = (),
) -> None:
    """Raise ConfigError for a key that a block of the settings needs (`x-needed`), and nobody gives.

    It is said to be missing in the strongest layer that has the block, at the top in the last file.
    beside: names of the other blocks in the one round it
    """
    for key in schema.get(NEEDED, ()):
        if key not in settings:
            inner = schema["properties"][key]
            where = locate(layers if path else files_of(layers), path)
            hint = _meant_for(layers, path, beside)
            raise ConfigError(f"{where}: {dotted((*path, key))} is missing, allowed is {allowed_text(inner)}{hint}.")
    for key, value in settings.items():
        if isinstance(value, dict) and (inner := subschema(schema, (key,))):
            check_given(layers, value, inner, (*path, key), [other for other in settings if other != key])


def _meant_for(layers: tuple[Layer, ...], path: KeyPath, beside: Sequence[str]) -> str:
    """Return a hint for a block that a layer adds to those of the others, with a name that is nearly one of theirs."""
    added = path and any(layer.holds(path[:-1]) and not layer.holds(path) for layer in layers)
    near = difflib.get_close_matches(path[-1], beside, n=1) if added else []
    return f" (or was {dotted((*path[:-1], near[0]))} meant)" if near else ""


def allowed_text(schema: dict[str, Any]) -> str:
    """Return in words what a schema allows: 'a number from 5 to 2000 mm', 'one of cdt, epsd2'."""
    kind = schema.get("type")
    if "x-allowed" in schema:
        return schema["x-allowed"]
    if "enum" in schema:
        return "one of " + ", ".join(map(str, schema["enum"]))
    if kind in NUMBERS:
        return f"{'a number' if kind == 'number' else 'a whole number'} {_range_text(schema)}".rstrip()
    block = "a block of one key or more" if "minProperties" in schema else "a block of keys"
    return {"boolean": "true or false", "string": "text", "array": "a list"}.get(str(kind), block)


def _range_text(schema: dict[str, Any]) -> str:
    unit = "" if schema.get("x-unit", "-") == "-" else f" {schema['x-unit']}"
    inclusive = "minimum" in schema and "maximum" in schema
    if inclusive:
        return f"from {schema['minimum']:.10g} to {schema['maximum']:.10g}{unit}"
    words = {
        "exclusiveMinimum": "above",
        "minimum": "at least",
        "exclusiveMaximum": "below",
        "maximum": "at most",
    }
    return " and ".join(f"{word} {schema[key]:.10g}" for key, word in words.items() if key in schema) + unit


def wrong_value(path: KeyPath, value: Any, schema: dict[str, Any]) -> str:
    """Return the fault of a value, with its key, what was found and what is allowed."""
    name = dotted(path) or "the file"
    if isinstance(value, str) and schema.get("type") in NUMBERS:
        with_unit = VALUE_WITH_UNIT.match(value.strip())
        if OTHER_BASE.match(value.strip()):
            return f"{name} is {value.strip()}, allowed is {allowed_text(schema)}, in decimal digits"
        if with_unit:
            return _unit_in_value(path, with_unit["number"], with_unit["unit"], schema)
        if NUMBER.match(value.strip()):
            return f"{name} is the text {value!r}, allowed is {allowed_text(schema)}, without quotation marks"
    whole = schema.get("type") == "integer" or "anyOf" in schema
    found = repr(value) if isinstance(value, float) and whole else show(value)
    percent = isinstance(value, (int, float)) and 2.0 <= value <= 100.0 and schema.get("maximum") == 1
    hint = ", no percentage" if percent and any("fraction" in str(key) for key in path) else ""
    return f"{name} is {found}, allowed is {allowed_text(schema)}{hint}"


def _unit_in_value(path: KeyPath, number: str, unit: str, schema: dict[str, Any]) -> str:
    name, expected = dotted(path), schema.get("x-unit", "-")
    if unit == expected:
        return f"{name} is '{number} {unit}', write the number alone: {path[-1]}: {number}"
    stem = ".".join([*map(str, path[:-1]), _split_known(str(path[-1]), expected)])
    allowed = allowed_text(schema)
    return f"unit {unit} is not allowed for {stem}, write {name}, {allowed} (found '{number} {unit}')"


def show(value: Any) -> str:
    """Return a value as a message shows it."""
    if value is None:
        return "empty"
    if isinstance(value, dict):
        return "a block of keys"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list):
        text = f"[{', '.join(map(show, value))}]"
    else:
        text = repr(value) if isinstance(value, str) else f"{value:.10g}" if isinstance(value, float) else str(value)
    return text if len(text) <= LONGEST_VALUE else text[:LONGEST_VALUE] + "..."


def _split_known(key: str, unit: str) -> str:
    """Return a known key without the suffix of its unit."""
    suffixes = [suffix for suffix, name in UNIT_OF_SUFFIX.items() if name == unit]
    return key.removesuffix(f"_{suffixes[0]}") if suffixes else key


def _split_unknown(key: str) -> tuple[str, str]:
    """Return (stem, suffix) of a key; the suffix is empty where it spells no unit."""
    suffix = next((s for s in ALL_SUFFIXES if key.lower().endswith(f"_{s}")), "")
    return (key[: -len(suffix) - 1], suffix) if suffix else (key, "")


def unknown_key(path: KeyPath, schema: dict[str, Any], found: str = "", noun: str = "key") -> str:
    """Return the fault of an unknown key: another unit of a known key, or the nearest known key."""
    parent, key = path[:-1], str(path[-1])
    known = (subschema(schema, parent) or {}).get("properties", {})
    inner = (*parent, *key.split("."))
    if len(inner) > len(path) and subschema(schema, inner) is not None:
        nested = "".join(f"{name}: {{" for name in inner[len(parent) : -1])
        return f"{key} is written as blocks, {nested}{inner[-1]}: ...{'}' * (len(inner) - len(path))}"
    stem, unit = _split_unknown(key)
    found_key = f"(found {key}: {found})" if found else f"(found {key})"
    for name, inner in known.items():
        if stem in (_split_known(name, inner.get("x-unit", "-")), name) and inner.get("type") in NUMBERS:
            written, right = dotted((*parent, stem)), dotted((*parent, name))
            if unit:
                return f"unit {unit} is not allowed for {written}, write {right} {found_key}"
            return f"{written} has no unit, write {right} {found_key}"
    value = f" ({found})" if found else ""
    rest = _of_material(path, known) or f", {_nearest(path, known, schema)}"
    return f"{dotted(path)}{value} is no known {noun}{rest}"


def _of_material(path: KeyPath, known: Collection[str]) -> str | None:
    """Return where a property of a material is given, for one asked of a block that names a material; else None."""
    naming = next((name for name in known if name.rpartition("_")[-1] == "material"), None)
    properties = {key for of_one, _ in leaves(load_schema("materials")) for key in of_one[2:]}  # of a kind and a name
    if naming is None or path[-1] not in properties:
        return None
    return (
        f" but a property of the material that {dotted((*path[:-1], naming))} names, which config/materials.yaml gives,"
        " or a file of yours as --config materials=<file>"
    )


def _nearest(path: KeyPath, known: dict[str, Any], schema: dict[str, Any]) -> str:
    """Return the known key that resembles an unknown one, in its own block first, or all that are allowed."""
    parent, key = path[:-1], str(path[-1])
    near = [dotted((*parent, name)) for name in difflib.get_close_matches(key, known, n=1, cutoff=ALIKE)]
    everywhere = {dotted(p): str(p[-1]) for p, _ in leaves(schema)}
    near += [full for full, leaf in everywhere.items() if leaf == key]
    paths = difflib.get_close_matches(dotted(path), everywhere, n=1, cutoff=ALIKE_PATHS)
    near += [full for full in paths if difflib.get_close_matches(key, [everywhere[full]], cutoff=ALIKE)]
    return f"the nearest is {near[0]}" if near else f"allowed are {', '.join(known)}"


def read_design(
    path: Path, root: Path, schema: dict[str, Any], wanted: Callable[[str], bool] = lambda row: True
) -> list[Layer]:
    """Return the rows of a design table as layers that know their lines, after all checks of single values.

    An empty cell of a column that the schema does not require gives no value, and REMARKS are left out.
    wanted: whether a row of that name is to be simulated; one that is not, and has a fault, is left out

    Raises ConfigError naming file, line, row and column.
    """
    source = display_name(path, root)
    header, rows = read_csv_rows(path, root)
    check_columns([column for column in header if column != REMARKS], schema, source)
    lines: dict[str, int] = {}
    checked = []
    for line, cells in rows:
        name = cells["row"]
        if len(name) > LONGEST_ROW:
            raise ConfigError(
                f"{source}, line {line}: row is a name of {len(name)} letters, allowed are {LONGEST_ROW}, for it names"
                " folders and files."
            )
        if name in lines:
            raise ConfigError(
                f"{source}, line {line}: row is '{name}', which stands in line {lines[name]} too,"
                " allowed is each name once."
            )
        lines[name] = line
        cells.pop(REMARKS, None)
        values = {c: cell_value(v, schema["properties"][c]) for c, v in cells.items() if v or c in schema["required"]}
        layer = Layer(source, values, {(): line}, f"row {name}" if name else "")
        try:
            check_layer(layer, schema)
        except ConfigError:
            if wanted(name):
                raise
            continue
        checked.append(layer)
    return checked


def cell_value(text: str, schema: dict[str, Any]) -> Any:
    """Return the value of a cell: a number, a boolean or numbers with spaces between where it spells one and the column
    is no text.
    """
    if schema.get("type") == "boolean":
        return {"true": True, "false": False}.get(text, text)
    if schema.get("type") == "integer" and INTEGER.match(text) and len(text) <= LONGEST_NUMBER:
        return int(text)
    if is_list_of_numbers(schema):
        values = [cell_value(each, schema["items"]) for each in text.split()]
        return text if any(isinstance(each, str) for each in values) else values
    return float(text) if schema.get("type") in NUMBERS and NUMBER.match(text) else text


def as_told(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of a design row with its lists of numbers as a cell has them: 3 0 -0.3."""
    return {
        name: " ".join(f"{number:.10g}" for number in value) if isinstance(value, list) else value
        for name, value in values.items()
    }


def is_list_of_numbers(schema: dict[str, Any]) -> bool:
    """Return whether a schema is of a list of numbers."""
    return schema.get("type") == "array" and schema["items"].get("type") in NUMBERS


def check_columns(header: list[str], schema: dict[str, Any], source: str) -> None:
    """Raise ConfigError for a column of a table's header that its schema does not know, and one that it lacks."""
    for number, column in enumerate(header, start=1):
        if not column:
            raise ConfigError(f"{source}, header: column {number} has no name, allowed are names, with commas between.")
        if column not in schema["properties"]:
            raise ConfigError(f"{source}, header: {unknown_key((column,), schema, noun='column')}.")
    for column in schema["required"]:
        if column not in header:
            allowed = ", ".join(schema["required"])
            raise ConfigError(f"{source}, header: column {column} is missing, allowed are {allowed}.")


def unknown_name(source: str, noun: str, name: str, known: list[str]) -> str:
    """Return the sentence for a name that is not there."""
    near = difflib.get_close_matches(name, known, n=1)
    hint = f" (the nearest is {near[0]})" if near else ""
    return f"{source}: {noun} is {show(name)}, allowed is one of {', '.join(known) or 'none'}{hint}."


def files_of(layers: tuple[Layer, ...]) -> tuple[Layer, ...]:
    """Return the layers that are whole files: the last one is the study's."""
    return tuple(layer for layer in layers if layer.lines and not layer.block)


def locate(layers: tuple[Layer, ...], path: KeyPath) -> str:
    """Return where a setting stands: in the strongest layer that holds it."""
    return next(layer for layer in reversed(layers) if layer.holds(path)).where(path)


def with_place(layers: tuple[Layer, ...], sentence: str) -> str:
    """Return a sentence on a setting, which it begins with, after the place where that stands; others as they are."""
    path = tuple(sentence.partition(" ")[0].removesuffix(":").split("."))
    return f"{locate(layers, path)}: {sentence}" if any(layer.holds(path) for layer in layers) else sentence
