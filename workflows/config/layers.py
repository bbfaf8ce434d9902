"""Read configuration files and remember where every value stands.

YAML is read by the scalar rules of YAML 1.2 (core schema): `1e-9` is a number; `yes`, `010` and `1:30` are
not what YAML 1.1 makes of them. Every key keeps its line, so that a message can name it.
"""

from __future__ import annotations

import copy
import csv
import io
import math
import re
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from bulkwear.workflows.config.bounded import (
    LARGEST_TABLE,
    LARGEST_YAML,
    LONGEST_KEY,
    LONGEST_NUMBER,
    BoundsError,
    bounded_text,
    check_yaml,
)

KeyPath = tuple[Hashable, ...]

INTEGER = re.compile(r"[-+]?[0-9]+\Z")
NUMBER = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?\Z")
NAMES = ("rows",)  # settings that are lists of names
LONGEST_CELL, SHOWN_LETTERS = 1000, 40  # letters of a table's cell, and of one in a message


class ConfigError(ValueError):
    """A configuration that cannot be run, in one sentence: file, key or row, value found, what is allowed."""


@dataclass(frozen=True)
class Layer:
    """One source of settings: a file, a block of a file, or the command line.

    `lines` maps the path of each key, relative to this layer, to its line in the file (from 1), `files` that of each
    key of another file, which this one extends, to that file.
    """

    source: str
    values: dict[str, Any]
    lines: dict[KeyPath, int] = field(default_factory=dict)
    block: str = ""
    files: dict[KeyPath, str] = field(default_factory=dict)

    def where(self, path: KeyPath = ()) -> str:
        """Return file, line and block of a key (of its nearest parent whose line is known)."""
        while path and path not in self.lines:
            path = path[:-1]
        line = f", line {self.lines[path]}" if path in self.lines else ""
        return f"{self.files.get(path, self.source)}{line}{', ' + self.block if self.block else ''}"

    def line(self, path: KeyPath) -> float:
        """Return the line of a key, infinity where it is not known."""
        return self.lines.get(path, math.inf)

    def holds(self, path: KeyPath) -> bool:
        """Return whether the key at `path` stands in this layer."""
        value: Any = self.values
        for key in path:
            if not isinstance(value, dict) or key not in value:
                return False
            value = value[key]
        return True

    def part(self, keys: set[str]) -> Layer:
        """Return the layer with these top-level keys only; lines are kept."""
        return replace(self, values={k: v for k, v in self.values.items() if k in keys})

    def inner(self, path: KeyPath, block: str) -> Layer:
        """Return the mapping at `path` as a layer of its own (empty where it is missing or null)."""
        values: Any = self.values
        for key in path:
            values = (values or {}).get(key)
        lines, files = (
            {p[len(path) :]: told for p, told in of_paths.items() if p[: len(path)] == path}
            for of_paths in (self.lines, self.files)
        )
        return Layer(self.source, values or {}, lines, block, files)


def _number(make: Callable[[str], float]) -> Callable[[yaml.Loader, yaml.ScalarNode], float]:
    def construct(loader: yaml.Loader, node: yaml.ScalarNode) -> float:
        text = loader.construct_scalar(node)
        if len(text) > LONGEST_NUMBER:
            line = node.start_mark.line + 1
            raise BoundsError(f"found a number of {len(text)} letters, allowed are at most {LONGEST_NUMBER}", line)
        return make(text)

    return construct


def _of_yaml_1_2(base: type) -> type:
    """Return a safe loader with the scalars of YAML 1.2."""
    loader = type(f"_{base.__name__}", (base,), {"yaml_implicit_resolvers": {}})
    for tag, pattern, first in (
        ("tag:yaml.org,2002:bool", re.compile(r"(true|True|TRUE|false|False|FALSE)\Z"), "tTfF"),
        ("tag:yaml.org,2002:int", INTEGER, "-+0123456789"),
        ("tag:yaml.org,2002:float", NUMBER, "-+.0123456789"),
        ("tag:yaml.org,2002:null", re.compile(r"(~|null|Null|NULL|)\Z"), ["~", "n", "N", ""]),
    ):
        loader.add_implicit_resolver(tag, pattern, list(first))
    loader.add_constructor("tag:yaml.org,2002:int", _number(int))
    loader.add_constructor("tag:yaml.org,2002:float", _number(float))
    return loader


# PyYAML's parser in C takes a tenth of the time, where it was built; its own says better what is wrong with a text.
_QUICK, _EXACT = (_of_yaml_1_2(base) for base in (getattr(yaml, "CSafeLoader", yaml.SafeLoader), yaml.SafeLoader))


def display_name(path: Path, root: Path) -> str:
    """Return the path as messages show it: relative to the repository where possible."""
    return path.relative_to(root).as_posix() if path.is_relative_to(root) else path.as_posix()


def read_text(path: Path, source: str, largest: int) -> str:
    """Return a UTF-8 text file, with or without byte order mark. Raises ConfigError where it cannot be read within the
    bounds.
    """
    try:
        return bounded_text(path, largest)
    except FileNotFoundError:
        folder = path.parent
        names = sorted(p.name for p in folder.glob(f"*{path.suffix}")) if folder.is_dir() else []
        raise ConfigError(
            f"{source}: there is no such file, found in its folder: {', '.join(names) or f'no {path.suffix}'}."
        ) from None
    except BoundsError as fault:
        raise ConfigError(f"{_place(source, fault.line)}: {fault}.") from None


def _place(source: str, line: int | None) -> str:
    return f"{source}, line {line}" if line else source


def read_yaml(path: Path, root: Path) -> Layer:
    """Return a YAML file as a layer.

    Raises ConfigError if the file is missing, is no YAML, is no mapping, names a key twice, or exceeds the bounds.
    """
    source = display_name(path, root)
    values, lines = _read(read_text(path, source, LARGEST_YAML), source)
    return Layer(source, copy.deepcopy(values), dict(lines))


@lru_cache(maxsize=64)  # studies share most of their files, and to parse one takes longer than all else
def _read(text: str, source: str) -> tuple[dict[str, Any], dict[KeyPath, int]]:
    """Return what a text of YAML says, and the line of each key."""
    try:
        return _parsed(text, source, _QUICK)
    except (yaml.YAMLError, ConfigError):
        return _parsed(text, source, _EXACT)


def _parsed(text: str, source: str, kind: type) -> tuple[dict[str, Any], dict[KeyPath, int]]:
    """Return the same as a loader of a kind reads it. Raises ConfigError."""
    loader = kind(text)
    try:
        check_yaml(yaml.parse(text, kind))
        node = loader.get_single_node()
        lines: dict[KeyPath, int] = {}
        _collect_lines(node, (), lines, source)
        values = loader.construct_document(node) if node is not None else {}
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        problem = getattr(error, "problem", None) or str(error).splitlines()[0]
        raise ConfigError(f"{_place(source, mark and mark.line + 1)}: {problem}, allowed is valid YAML.") from None
    except BoundsError as fault:
        raise ConfigError(f"{_place(source, fault.line)}: {fault}.") from None
    finally:
        loader.dispose()
    if not isinstance(values, dict):
        found = "a list" if isinstance(values, list) else "one value"
        raise ConfigError(f"{source}: found {found}, allowed is a mapping of keys to values.")
    return values, lines


def _collect_lines(node: yaml.Node | None, path: KeyPath, lines: dict[KeyPath, int], source: str) -> None:
    """Fill `lines` with the line of every key below a node; a key named twice is an error."""
    if isinstance(node, yaml.SequenceNode):
        for index, item in enumerate(node.value):
            lines[(*path, index)] = item.start_mark.line + 1
            _collect_lines(item, (*path, index), lines, source)
    if not isinstance(node, yaml.MappingNode):
        return
    seen: dict[str, int] = {}
    for key, value in node.value:
        name, line = key.value, key.start_mark.line + 1
        if not isinstance(key, yaml.ScalarNode) or key.tag != "tag:yaml.org,2002:str":
            comma = isinstance(value, yaml.ScalarNode) and value.value == "" and node.flow_style
            why = "; decimals have a point, a comma ends a value" if comma else ""
            raise ConfigError(f"{source}, line {line}: found {_key_words(key)}, allowed are words as keys{why}.")
        if len(name) > LONGEST_KEY:
            raise ConfigError(
                f"{source}, line {line}: found a key of {len(name)} letters, allowed are words of {LONGEST_KEY}."
            )
        if not name.isprintable():
            raise ConfigError(
                f"{source}, line {line}: found the key {name!a}, in which a letter does not print, such as the space of"
                " a web page; allowed are plain words."
            )
        if name in seen:
            full = dotted((*path, name))
            raise ConfigError(
                f"{source}, line {line}: {full} stands here and in line {seen[name]}, allowed is each key once."
            )
        seen[name] = lines[(*path, name)] = line
        _collect_lines(value, (*path, name), lines, source)


def _key_words(key: yaml.Node) -> str:
    if not isinstance(key, yaml.ScalarNode):
        return "a block as a key"
    return f"the key {key.value!r}" if len(key.value) <= LONGEST_KEY else "a long key"


def command_line_layer(overrides: dict[str, Any] | None) -> Layer:
    """Return overrides as a layer; text that spells a number or a boolean becomes one, but for the names of rows."""
    given = overrides or {}
    return Layer("command line", _reread(given) | {key: _names(given[key]) for key in NAMES if key in given})


def _names(value: Any) -> Any:
    """Return names as text, where whole numbers are meant as such: rows may be called 1, 2, 3."""
    if not isinstance(value, list):
        return value
    return [str(each) if isinstance(each, int) and not isinstance(each, bool) else each for each in value]


def _reread(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _reread(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_reread(inner) for inner in value]
    if isinstance(value, str) and len(value) > LONGEST_NUMBER:
        return value
    if isinstance(value, str) and INTEGER.match(value):
        return int(value)
    if isinstance(value, str) and NUMBER.match(value):
        return float(value)
    if isinstance(value, str) and value.lower() in ("true", "false"):
        return value.lower() == "true"
    return value


def merge(lower: dict[str, Any], upper: dict[str, Any]) -> dict[str, Any]:
    """Return `lower` overridden key by key by `upper`, at every depth; neither is changed."""
    merged = {key: merge(value, {}) if isinstance(value, dict) else value for key, value in lower.items()}
    for key, value in upper.items():
        both = isinstance(value, dict) and isinstance(merged.get(key), dict)
        merged[key] = merge(merged[key] if both else {}, value) if isinstance(value, dict) else value
    return merged


def overridden(lower: dict[str, Any], layer: Layer, alternatives: Iterable[Sequence[KeyPath]] = ()) -> dict[str, Any]:
    """Return `lower` overridden by a layer as `merge` does, without the alternatives of what the layer gives.

    alternatives: groups of paths, of which one stands for all others
    """
    kept = merge(lower, {})
    for group in alternatives:
        for *block, key in group if any(layer.holds(path) for path in group) else ():
            inner: Any = kept
            for name in block:
                inner = inner.get(name, {})
            inner.pop(key, None)
    return merge(kept, layer.values)


def extended(lower: Layer, upper: Layer, replaced: Iterable[KeyPath] = ()) -> Layer:
    """Return the layer of a file that extends another one, key by key; replaced: paths of the other that fall away."""
    kept = merge(lower.values, {})
    for *block, key in replaced:
        inner: Any = kept
        for name in block:
            inner = inner.get(name) if isinstance(inner, dict) else None
        if isinstance(inner, dict):
            inner.pop(key, None)
    values = merge(kept, upper.values)
    lines = {path: line for path, line in lower.lines.items() if path not in upper.lines and _is_in(values, path)}
    files = {path: lower.files.get(path, lower.source) for path in lines}
    return Layer(upper.source, values, lines | upper.lines, upper.block, files)


def _is_in(values: Any, path: KeyPath) -> bool:
    for key in path:
        if not (key in values if isinstance(values, dict) else isinstance(values, list) and key in range(len(values))):
            return False
        values = values[key]
    return True


def dotted(path: KeyPath) -> str:
    """Return a key path as people write it: `sample.width_mm`, `size_distribution.mass_fraction[1]`."""
    text = ""
    for key in path:
        text += f"[{key + 1}]" if isinstance(key, int) else f".{key}" if text else str(key)
    return text


def read_csv_rows(path: Path, root: Path) -> tuple[list[str], list[tuple[int, dict[str, str]]]]:
    """Return the header and, for every row that is not blank, (line in the file, {column: text}); columns on the right
    that are empty all down are left out.

    Raises ConfigError for an empty file, no rows, an unnamed or repeated column, a row of another length, and a cell
    with a line break or other letters that do not print.
    """
    source = display_name(path, root)
    reader = csv.reader(io.StringIO(read_text(path, source, LARGEST_TABLE), newline=""))
    try:
        lines = [(reader.line_num, [cell.strip() for cell in cells]) for cells in reader]
    except csv.Error as error:
        raise ConfigError(f"{source}, line {reader.line_num}: {error}, allowed is a table of short cells.") from None
    filled = [(line, cells) for line, cells in lines if any(cells)]
    width = max((number for _, cells in filled for number, cell in enumerate(cells, start=1) if cell), default=0)
    filled = [(line, cells[: max(width, 1)]) for line, cells in filled]  # a spreadsheet leaves empty columns behind
    if not filled:
        raise ConfigError(f"{source}: the file is empty, allowed is a header and one row or more.")
    (header_line, header), rows = filled[0], filled[1:]
    if header[0].startswith("#"):
        raise ConfigError(f"{source}, line {header_line}: found a comment, allowed is the header: tables have none.")
    if len(header) == 1 and re.search(r"[;\t]", header[0]):
        raise ConfigError(f"{source}, line {header_line}: found {header[0]!r}, allowed is the comma between columns.")
    for line, cells in filled:
        if wrong := next((cell for cell in cells if not cell.isprintable() or len(cell) > LONGEST_CELL), None):
            raise ConfigError(
                f"{source}, line {line}: found {wrong[:SHOWN_LETTERS]!r}, a cell of {len(wrong)} letters, allowed is"
                f" one line of at most {LONGEST_CELL} letters that print."
            )
    repeated = [name for index, name in enumerate(header) if name in header[:index]]
    if repeated:
        raise ConfigError(
            f"{source}, line {header_line}: column {repeated[0]!r} stands there twice, allowed is each column once."
        )
    if not rows:
        raise ConfigError(f"{source}: found a header and no rows, allowed is one row or more.")
    for line, cells in rows:
        if len(cells) != len(header):
            raise ConfigError(
                f"{source}, line {line}, row {cells[0]}: found {len(cells)} values,"
                f" allowed are {len(header)}, one per column, with a point in decimals."
            )
    return header, [(line, dict(zip(header, cells, strict=True))) for line, cells in rows]
