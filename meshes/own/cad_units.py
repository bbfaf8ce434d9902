"""The unit of lengths that a STEP or IGES file says itself, read from its text."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from pathlib import Path

SI_PREFIX = {"$": "m", ".CENTI.": "cm", ".MILLI.": "mm", ".MICRO.": "um"}
CONVERSIONS = {"INCH": "in", "FOOT": "ft"}
IGES_UNITS = {"1": "in", "2": "mm", "4": "ft", "6": "m", "9": "um", "10": "cm"}  # field 14 of the global section
# STEP: entities of several types in one, as units and contexts are, each `#12 = ( ONE(...) TWO(...) );`
STEP_ENTITY = re.compile(r"#(\d+)\s*=\s*\(((?:'[^']*'|[^;'])*+);")
STEP_CONTEXT = re.compile(r"GLOBAL_UNIT_ASSIGNED_CONTEXT\s*\(\s*\(([^)]*)\)")
STEP_LENGTH = re.compile(r"\bLENGTH_UNIT\s*\(\s*\)")
STEP_CONVERSION = re.compile(r"CONVERSION_BASED_UNIT\s*\(\s*'([^']*)'")
STEP_SI = re.compile(r"SI_UNIT\s*\(\s*([^,\s]+)\s*,\s*\.METRE\.")
HOLLERITH = re.compile(r"\s*(\d{1,6})H")


def step_unit(text: str) -> str | None:
    """Unit of lengths of a STEP file, by its first context that assigns one, None where it is none that is known.

    A unit that others are converted to, as mm are of inches, is no unit of the file; without a context the converted
    one counts.
    """
    entities = dict(STEP_ENTITY.findall(text))
    lengths = {number: words for number, words in entities.items() if STEP_LENGTH.search(words)}
    assigned = [
        number
        for words in entities.values()
        for context in STEP_CONTEXT.findall(words)
        for number in re.findall(r"\d+", context)
        if number in lengths
    ]
    converted = [number for number, words in lengths.items() if STEP_CONVERSION.search(words)]
    first = next(iter([*assigned, *converted, *lengths]), None)
    return None if first is None else _unit_of(lengths[first])


def _unit_of(words: str) -> str | None:
    """Unit that the entity of a length unit is, from its words."""
    if found := STEP_CONVERSION.search(words):
        return CONVERSIONS.get(found[1].strip().upper())
    found = STEP_SI.search(words)
    return SI_PREFIX.get(found[1]) if found else None


def iges_unit(text: str) -> str | None:
    """Unit of lengths of an IGES file, by the flag in its global section, None where it is none that is known."""
    section = "".join(line[:72].ljust(72) for line in text.splitlines() if line[72:73] == "G")
    flag = next(itertools.islice(_iges_fields(section), 13, None), "")
    return IGES_UNITS.get(flag)


def _iges_fields(section: str) -> Iterator[str]:
    """Yield the fields of a global section, texts without their length; the first two may name the delimiters.

    A text may hold delimiters itself: it is as long as it says, as in `5Ha,b;c`.
    """
    delimiters, place = [",", ";"], 0  # between fields, at the end
    for number in itertools.count():
        text = HOLLERITH.match(section, place)
        if text:
            place = text.end() + int(text[1])
            field = section[text.end() : place]
            if number < len(delimiters) and field:
                delimiters[number] = field
        stop = re.compile("|".join([*map(re.escape, delimiters), "$"])).search(section, place)
        yield field if text else section[place : stop.start()].strip()
        if stop[0] != delimiters[0]:
            return
        place = stop.end()


def said_unit(path: Path) -> str | None:
    """Unit of lengths that a STEP or IGES file says itself, None where it says none that is known."""
    read = UNIT_READERS.get(path.suffix.lower())
    return read(path.read_text(encoding="latin-1")) if read else None


UNIT_READERS = {".step": step_unit, ".stp": step_unit, ".iges": iges_unit, ".igs": iges_unit}
