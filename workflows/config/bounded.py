"""Files that a user gives are read within bounds: a wrong one costs a sentence, never the machine or its contents.

The bounds are far above any configuration that a person writes. Reasons: YAML that refers to itself over and over
grows to any size when it is made into values, nesting ends in the interpreter's own stack, and devices have no end.
"""

from __future__ import annotations

import re
import stat
from collections.abc import Iterator
from pathlib import Path

import yaml

LARGEST_YAML, LARGEST_TABLE = 500_000, 20_000_000  # bytes
DEEPEST = 20  # blocks within blocks
MOST_VALUES = 20_000  # keys and values, with all that is referred to more than once
LONGEST_KEY = 200  # letters
SURROGATE = re.compile("[\ud800-\udfff]")  # no text can be written with one
LONGEST_NUMBER = 40  # letters of a value that spells a number


class BoundsError(ValueError):
    """A file that cannot be read within the bounds: what was found and what is allowed, without the file's name.

    line: where in the file, from 1; None for the file as a whole
    """

    def __init__(self, fault: str, line: int | None = None):
        super().__init__(fault)
        self.line = line


def bounded_text(path: Path, largest: int) -> str:
    """Return a UTF-8 text file, with or without byte order mark. Raises FileNotFoundError and BoundsError."""
    try:
        found = path.stat()
        if not stat.S_ISREG(found.st_mode):
            kind = "folder" if stat.S_ISDIR(found.st_mode) else "device or pipe"
            raise BoundsError(f"it is a {kind}, allowed is a text file")
        if found.st_size > largest:
            raise BoundsError(f"it has {found.st_size} bytes, allowed are at most {largest}")
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        byte, line = error.object[error.start], error.object.count(b"\n", 0, error.start) + 1
        raise BoundsError(f"the byte {byte:#04x} is not UTF-8, allowed is UTF-8 text", line) from None
    except (FileNotFoundError, BoundsError):
        raise
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else "its name is none of a file"
        raise BoundsError(f"it cannot be read ({reason}), allowed is a readable text file") from None
    if "\0" in text:
        line = text.count("\n", 0, text.index("\0")) + 1
        raise BoundsError("there is a NUL byte in it, allowed is text", line)
    return text


def check_yaml(events: Iterator[yaml.Event]) -> None:
    """Raise BoundsError for YAML that is too deep or too much, refers to itself, or has tags of its own.

    events: of the parser, which keeps nothing and makes no values
    """
    sizes: dict[str, int] = {}  # of what has a name, once it is whole
    blocks: list[tuple[str | None, int]] = []  # name of each block that is open, and how many values it began after
    count = 0
    for event in events:
        line = event.start_mark.line + 1
        if isinstance(event, yaml.AliasEvent):
            if event.anchor in (name for name, _ in blocks):
                raise BoundsError(f"*{event.anchor} refers to the block that it stands in, allowed is none", line)
            count += sizes.get(event.anchor, 1)
        elif isinstance(event, yaml.ScalarEvent | yaml.CollectionStartEvent):
            if event.tag is not None:
                raise BoundsError("there is a tag (!) in it, allowed are values without tags", line)
            if isinstance(event, yaml.ScalarEvent) and SURROGATE.search(event.value):
                raise BoundsError("there is half a letter (\\ud800 to \\udfff) in it, allowed is text", line)
            count += 1
            if isinstance(event, yaml.CollectionStartEvent):
                blocks.append((event.anchor, count))
            elif event.anchor:
                sizes[event.anchor] = 1
        elif isinstance(event, yaml.CollectionEndEvent):
            name, before = blocks.pop()
            if name:
                sizes[name] = count - before + 1
        if len(blocks) > DEEPEST:
            raise BoundsError(f"blocks stand {len(blocks)} deep in one another, allowed are {DEEPEST}", line)
        if count > MOST_VALUES:
            raise BoundsError(f"there are more than {MOST_VALUES} values in it, allowed are so many", line)
