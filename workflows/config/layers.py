"""Read configuration files and remember where every value stands.

YAML is read by the scalar rules of YAML 1.2 (core schema): `1e-9` is a number; `yes`, `010` and `1:30` are
not what YAML 1.1 makes of them. Every key keeps its line, so that a message can name it.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Hashable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

KeyPath = tuple[Hashable, ...]

INTEGER = re.compile(r"[-+]?[0-9]+\Z")
NUMBER = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?\Z")


class ConfigError(ValueError):
    """A configuration that cannot be run, in one sentence: file, key or row, value found, what is allowed."""


@dataclass(frozen=True)
class Layer:
    """One source of settings: a file, a block of a file, or the command line.

    `lines` maps the path of each key, relative to this layer, to its line in the file (from 1).
    """

    source: str
    values: dict[str, Any]
    lines: dict[KeyPath, int] = field(default_factory=dict)
    block: str = ""

    def where(self, path: KeyPath = ()) -> str:
        """Return file, line and block of a key (of its nearest parent whose line is known)."""
        while path and path not in self.lines:
            path = path[:-1]
        line = f", line {self.lines[path]}" if path in self.lines else ""
        return f"{self.source}{line}{', ' + self.block if self.block else ''}"

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
        return Layer(self.source, {k: v for k, v in self.values.items() if k in keys}, self.lines, self.block)

    def inner(self, path: KeyPath, block: str) -> Layer:
        """Return the mapping at `path` as a layer of its own (empty where it is missing or null)."""
        values: Any = self.values
        for key in path:
            values = (values or {}).get(key)
        lines = {p[len(path) :]: n for p, n in self.lines.items() if p[: len(path)] == path}
        return Layer(self.source, values or {}, lines, block)


class _Loader(yaml.SafeLoader):
    """Safe loader with the scalars of YAML 1.2."""


_Loader.yaml_implicit_resolvers = {}
for _tag, _pattern, _first in (
    ("tag:yaml.org,2002:bool", re.compile(r"(true|True|TRUE|false|False|FALSE)\Z"), "tTfF"),
    ("tag:yaml.org,2002:int", INTEGER, "-+0123456789"),
    ("tag:yaml.org,2002:float", NUMBER, "-+.0123456789"),
    ("tag:yaml.org,2002:null", re.compile(r"(~|null|Null|NULL|)\Z"), ["~", "n", "N", ""]),
):
    _Loader.add_implicit_resolver(_tag, _pattern, list(_first))
_Loader.add_constructor("tag:yaml.org,2002:int", lambda loader, node: int(loader.construct_scalar(node)))
_Loader.add_constructor("tag:yaml.org,2002:float", lambda loader, node: float(loader.construct_scalar(node)))


def display_name(path: Path, root: Path) -> str:
    """Return the path as messages show it: relative to the repository where possible."""
    return path.relative_to(root).as_posix() if path.is_relative_to(root) else path.as_posix()


def read_text(path: Path, source: str) -> str:
    """Return a UTF-8 text file, with or without byte order mark. Raises ConfigError if there is none."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        folder = path.parent
        names = sorted(p.name for p in folder.glob(f"*{path.suffix}")) if folder.is_dir() else []
        raise ConfigError(
            f"{source}: there is no such file, found in its folder: {', '.join(names) or 'nothing'}."
        ) from None
    except UnicodeDecodeError as error:
        raise ConfigError(f"{source}: byte {error.start} is not UTF-8, allowed is UTF-8 text.") from None


def read_yaml(path: Path, root: Path) -> Layer:
    """Return a YAML file as a layer.

    Raises ConfigError if the file is missing, is no YAML, is no mapping, or names a key twice.
    """
    source = display_name(path, root)
    loader = _Loader(read_text(path, source))
    try:
        node = loader.get_single_node()
        lines: dict[KeyPath, int] = {}
        _collect_lines(node, (), lines, source)
        values = loader.construct_document(node) if node is not None else {}
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f", line {mark.line + 1}" if mark else ""
        problem = getattr(error, "problem", None) or str(error).splitlines()[0]
        raise ConfigError(f"{source}{line}: {problem}, allowed is valid YAML.") from None
    finally:
        loader.dispose()
    if not isinstance(values, dict):
        raise ConfigError(f"{source}: found {values!r}, allowed is a mapping of keys to values.")
    return Layer(source, values, lines)


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
            raise ConfigError(f"{source}, line {line}: found the key {name!r}, allowed are words as keys.")
        if name in seen:
            full = dotted((*path, name))
            raise ConfigError(
                f"{source}, line {line}: {full} stands here and in line {seen[name]}, allowed is each key once."
            )
        seen[name] = lines[(*path, name)] = line
        _collect_lines(value, (*path, name), lines, source)


def command_line_layer(overrides: dict[str, Any] | None) -> Layer:
    """Return overrides as a layer; text that spells a number or a boolean becomes one."""
    return Layer("command line", _reread(overrides or {}))


def _reread(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _reread(inner) for key, inner in value.items()}
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


def dotted(path: KeyPath) -> str:
    """Return a key path as people write it: `sample.width_mm`, `size_distribution.mass_fraction[1]`."""
    text = ""
    for key in path:
        text += f"[{key + 1}]" if isinstance(key, int) else f".{key}" if text else str(key)
    return text


def read_csv_rows(path: Path, root: Path) -> tuple[list[str], list[tuple[int, dict[str, str]]]]:
    """Return the header and, for every row that is not blank, (line in the file, {column: text}).

    Raises ConfigError for an empty file, no rows, an unnamed or repeated column, or a row of another length.
    """
    source = display_name(path, root)
    reader = csv.reader(read_text(path, source).splitlines())
    lines = [(reader.line_num, [cell.strip() for cell in cells]) for cells in reader]
    filled = [(line, cells) for line, cells in lines if any(cells)]
    if not filled:
        raise ConfigError(f"{source}: the file is empty, allowed is a header and one row per run.")
    (header_line, header), rows = filled[0], filled[1:]
    if len(header) == 1 and re.search(r"[;\t]", header[0]):
        raise ConfigError(f"{source}, line {header_line}: found {header[0]!r}, allowed is the comma between columns.")
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
