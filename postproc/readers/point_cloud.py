"""Scanned points from PLY, STL and text files, as blocks: a scan of any size is read in bounded memory.

A scan has a unit of its own; what leaves this module is in m. Points that are not finite (holes of some scanners) are
left out. Of an STL the corners of its facets are the points, so a corner counts once per facet.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from itertools import islice
from pathlib import Path

import numpy as np

METRES = {"mm": 1e-3, "m": 1.0, "um": 1e-6, "cm": 1e-2, "inch": 0.0254}  # per unit of a scan
POINTS_PER_BLOCK = 200_000
TEXT_KINDS = (".xyz", ".txt", ".csv", ".asc", ".pts")
PLY_TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
PLY_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": ""}
STL_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
STL_HEAD = 84  # bytes before the facets of a binary STL, the last four their number
QUOTED = 40  # letters of a line that is wrong
LONGEST_HEADER = 100_000  # bytes of a PLY header; more is no header
SEPARATORS = re.compile(r"[,;]")
# numbers with commas within, and blanks, tabs or semicolons between them
DECIMAL_COMMAS = re.compile(r"\s*[-+]?\d+,\d+(?:[;\t ]\s*[-+]?\d+(?:,\d+)?){2,}\s*$")


def point_blocks(path: str | os.PathLike, unit: str = "mm") -> Iterator[np.ndarray]:
    """Yield the points of a scan in blocks (k, 3) m, k up to `POINTS_PER_BLOCK`.

    path: .ply (text or binary), .stl (text or binary), or text with a point per line and x y z in its first columns
    (.xyz, .txt, .csv, .asc, .pts); unit: of the file, one of `METRES`.
    Raises ValueError with file and place for an unknown kind or unit, a damaged or truncated file, and one without
    points; FileNotFoundError when it does not exist.
    """
    path = Path(path)
    if unit not in METRES:
        raise ValueError(f"{path}: unit of the scan is '{unit}', allowed are {', '.join(METRES)}")
    if not os.path.isfile(path):
        raise FileNotFoundError(f"{path}: no such scan")
    readers = {".ply": _ply_blocks, ".stl": _stl_blocks, **dict.fromkeys(TEXT_KINDS, _text_blocks)}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise ValueError(f"{path}: kind of scan is '{path.suffix}', allowed are {', '.join(readers)}")
    found = False
    for block in reader(path):
        kept = np.asarray(block, dtype=float)[np.isfinite(block).all(axis=1)]
        found = found or len(kept) > 0
        yield kept * METRES[unit]
    if not found:
        raise ValueError(f"{path}: the scan has no points, allowed is one or more")


def inside_box(blocks: Iterable[np.ndarray], box: np.ndarray) -> Iterator[np.ndarray]:
    """Yield of blocks (k, 3) m the points within a box (3, 2) m, from and to along each axis of the scan.

    Raises ValueError when a side of the box has no length, and at the end when there was no point within.
    """
    if not (box[:, 0] < box[:, 1]).all():
        raise ValueError(f"the box round the sample must have from < to on each axis, found {box.tolist()} m")
    found = False
    for block in blocks:
        kept = block[((block >= box[:, 0]) & (block <= box[:, 1])).all(axis=1)]
        found = found or len(kept) > 0
        yield kept
    if not found:
        raise ValueError("no scanned point lies in the box round the sample, allowed is one or more")


def random_points(blocks: Iterable[np.ndarray], count: int, seed: int = 0) -> tuple[np.ndarray, int]:
    """Return up to `count` points (k, 3) m of a scan, every one with the same chance, and how many there are."""
    generator = np.random.default_rng(seed)
    points, keys, total = np.empty((0, 3)), np.empty(0), 0
    for block in blocks:
        total += len(block)
        points, keys = np.concatenate([points, block]), np.concatenate([keys, generator.random(len(block))])
        if len(keys) > count:
            lowest = np.argpartition(keys, count)[:count]
            points, keys = points[lowest], keys[lowest]
    return points, total


LOOSE_BYTES = 2  # that may follow the last point: a line end
LARGEST_COORDINATE = 1e9  # of a point, in any unit of length: no scan reaches so far


def _quoted(line: str) -> str:
    """Return the beginning of a line that may be of a damaged file, fit for a sentence."""
    return "".join(filter(str.isprintable, line.strip()))[:QUOTED]


def _ply_header(path: Path) -> tuple[str, list[tuple[str, int, list[list[str]]]], int]:
    """Return format, elements (name, count, properties as words) and the byte where the data begin."""
    with open(path, "rb") as file:
        if file.readline().strip() != b"ply":
            raise ValueError(f"{path}: line 1: a PLY begins with the word ply")
        kind, elements = "", []
        for number, raw in enumerate(file, start=2):
            words = raw.decode("latin-1").split()
            if words == ["end_header"]:
                break
            if file.tell() > LONGEST_HEADER:
                raise ValueError(f"{path}: no end_header in the first {LONGEST_HEADER} bytes")
            if words[:1] == ["format"] and len(words) == 3:
                kind = words[1]
            elif words[:1] == ["element"] and len(words) == 3 and words[2].isdigit():
                elements.append((words[1], int(words[2]), []))
            elif words[:1] == ["property"] and len(words) >= 3 and elements:
                elements[-1][2].append(words[1:])
            elif words and words[0] not in ("comment", "obj_info"):
                raise ValueError(f"{path}: line {number}: '{' '.join(words)}' does not belong in a PLY header")
        else:
            raise ValueError(f"{path}: the header has no end_header")
        start = file.tell()
    if kind not in PLY_ORDERS:
        raise ValueError(f"{path}: format of the PLY is '{kind}', allowed are {', '.join(PLY_ORDERS)}")
    return kind, elements, start


def _ply_type(path: Path, name: str, properties: list[list[str]], order: str) -> np.dtype:
    """Return the layout of one item of an element."""
    for words in properties:
        if words[0] not in PLY_TYPES or len(words) != 2:
            raise ValueError(f"{path}: element {name}: property '{' '.join(words)}', allowed are numbers, no lists")
    return np.dtype([(words[1], order + PLY_TYPES[words[0]]) for words in properties])


def _ply_blocks(path: Path) -> Iterator[np.ndarray]:
    kind, elements, start = _ply_header(path)
    names = [name for name, _, _ in elements]
    if "vertex" not in names:
        raise ValueError(f"{path}: the PLY has no element vertex, found {', '.join(names) or 'none'}")
    before, (_, count, properties) = elements[: names.index("vertex")], elements[names.index("vertex")]
    layout = _ply_type(path, "vertex", properties, PLY_ORDERS[kind])
    if not {"x", "y", "z"} <= set(layout.names):
        raise ValueError(f"{path}: element vertex has the properties {', '.join(layout.names)}, it needs x, y and z")
    columns = [layout.names.index(axis) for axis in "xyz"]
    with open(path, "rb") as file:
        file.seek(start)
        if kind == "ascii":
            list(islice(file, sum(number for _, number, _ in before)))
            lines = (line.decode("latin-1") for line in islice(file, count))
            yield from _counted(path, _rows(path, lines, 0, len(layout.names), columns), count)
            return
        _check_ply_size(path, start, elements)
        sizes = [number * _ply_type(path, name, each, "<").itemsize for name, number, each in before]
        file.seek(start + sum(sizes))
        yield from _counted(path, _records(file, layout, count), count)


def _check_ply_size(path: Path, start: int, elements: list[tuple[str, int, list[list[str]]]]) -> None:
    """Raise ValueError for a binary file that is longer than its header says, where that tells its length."""
    if any(words[0] not in PLY_TYPES for _, _, properties in elements for words in properties):  # lists tell none
        return
    expected = start + sum(number * _ply_type(path, name, each, "<").itemsize for name, number, each in elements)
    if (size := path.stat().st_size) > expected + LOOSE_BYTES:
        raise ValueError(
            f"{path}: the header tells of {expected} bytes, found {size}: a binary file that was copied as text, which"
            " changes its line ends, cannot be read"
        )


def _records(file, layout: np.dtype, count: int) -> Iterator[np.ndarray]:
    while count > 0:
        data = np.fromfile(file, layout, min(count, POINTS_PER_BLOCK))
        if not len(data):
            return
        count -= len(data)
        points = np.column_stack([data[axis].astype(float) for axis in "xyz"])
        if not (np.abs(points) <= LARGEST_COORDINATE).all():
            raise ValueError(
                f"{file.name}: found coordinates beyond {LARGEST_COORDINATE:g}: the numbers are not as the header says,"
                " as in a binary file that was copied as text, which changes its line ends"
            )
        yield points


def _counted(path: Path, blocks: Iterator[np.ndarray], count: int) -> Iterator[np.ndarray]:
    """Yield blocks; ValueError when they hold less than the header says."""
    found = 0
    for block in blocks:
        found += len(block)
        yield block
    if found < count:
        raise ValueError(f"{path}: the header promises {count} points, found {found}: the file is cut short")


def _stl_blocks(path: Path) -> Iterator[np.ndarray]:
    size = path.stat().st_size
    with open(path, "rb") as file:
        head = file.read(STL_HEAD)
        facets = int.from_bytes(head[-4:], "little") if len(head) == STL_HEAD else -1
        if size == STL_HEAD + facets * STL_FACET.itemsize:
            for first in range(0, facets, POINTS_PER_BLOCK // 3):
                yield np.fromfile(file, STL_FACET, min(POINTS_PER_BLOCK // 3, facets - first))["corners"].reshape(-1, 3)
            return
    if not head.lstrip().startswith(b"solid"):
        raise ValueError(
            f"{path}: {size} bytes are no binary STL of {max(facets, 0)} facets, and a text one begins with 'solid'"
        )
    yield from _stl_text_blocks(path)


def _stl_text_blocks(path: Path) -> Iterator[np.ndarray]:
    last = ""

    def vertices(file) -> Iterator[str]:
        nonlocal last
        for line in file:
            last = line.strip() or last
            if last.startswith("vertex"):
                yield last[len("vertex") :]

    with open(path, encoding="latin-1") as file:
        yield from _rows(path, vertices(file), 0, 3, [0, 1, 2], what="vertex")
    if not last.startswith("endsolid"):
        raise ValueError(f"{path}: a text STL ends with 'endsolid', found '{_quoted(last)}': the file is cut short")


def _text_blocks(path: Path) -> Iterator[np.ndarray]:
    with open(path, encoding="latin-1") as file:
        skipped = 0
        for line in file:
            words = SEPARATORS.sub(" ", line).split()
            if len(words) >= 3 and _are_numbers(words[:3]):
                if DECIMAL_COMMAS.match(line):
                    raise ValueError(
                        f"{path}: line {skipped + 1}: '{_quoted(line)}', allowed are decimals with a point"
                    )
                break
            skipped += 1
            if words and not words[0].startswith(("#", "//")) and skipped > 2:
                raise ValueError(f"{path}: line {skipped}: '{_quoted(line)}', allowed are x, y and z as numbers")
        else:
            return
        file.seek(0)
        lines = islice(file, skipped, None)
        yield from _rows(path, lines, skipped, len(words), [0, 1, 2])


def _are_numbers(words: list[str]) -> bool:
    try:
        return len([float(word) for word in words]) > 0
    except ValueError:
        return False


def _rows(
    path: Path, lines: Iterator[str], before: int, width: int, columns: list[int], what: str = "line"
) -> Iterator[np.ndarray]:
    """Yield three columns of lines of `width` words; `before`: lines ahead of them in the file, for errors."""
    while block := list(islice(lines, POINTS_PER_BLOCK)):
        words = SEPARATORS.sub(" ", "".join(line if line.endswith("\n") else f"{line}\n" for line in block)).split()
        try:
            rows = np.array(words, dtype=float).reshape(-1, width)
            if len(rows) != len(block):  # blank lines and comments take part in neither
                raise ValueError
        except ValueError:
            rows = np.array(_one_by_one(path, block, before, columns, what)).reshape(-1, 3)
            yield rows
        else:
            yield rows[:, columns]
        before += len(block)


def _one_by_one(path: Path, lines: list[str], before: int, columns: list[int], what: str) -> list[list[float]]:
    """Read lines that are not all alike; ValueError names the first that holds no point."""
    rows = []
    for number, line in enumerate(lines, start=before + 1):
        words = SEPARATORS.sub(" ", line).split()
        if not words or words[0].startswith(("#", "//")):
            continue
        chosen = [words[column] for column in columns if column < len(words)]
        if len(chosen) < 3 or not _are_numbers(chosen):
            raise ValueError(f"{path}: {what} {number}: '{_quoted(line)}', allowed are x, y and z as numbers")
        rows.append([float(word) for word in chosen])
    return rows
