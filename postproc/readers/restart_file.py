"""Whether a restart file of LIGGGHTS is whole: its particles are counted, rank by rank, up to its last byte.

LIGGGHTS does not look whether its writing succeeds. On a full disk it ends with exit code 0 and leaves a restart file
that is cut, or that lacks a piece in its middle. The file has no end marker; what proves it whole is its own layout
(write_restart.cpp, group.cpp, pair_gran.cpp and modify.cpp of LIGGGHTS 3.8.0): a header with the numbers of particles,
types and ranks, the groups, the contact model and a number per pair of types, the state of each fix after its length,
then for each rank the length of its record and in it one record per particle that begins with its own length. It is
whole where these lengths meet the file's last byte and the records are as many as the header has particles.
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import BinaryIO, NamedTuple

_TIME_STEP, _RANKS, _ATOM_STYLE, _PARTICLES, _TYPES = 5, 7, 22, 23, 24  # flags of the header
_WORDS = {0, 4, _ATOM_STYLE}
_LONG = {_TIME_STEP, _PARTICLES, 25, 28, 31, 34}
_FIRST_DOUBLE, _LAST = 37, 51
_ALWAYS = set(range(_LAST - 2))  # the last three are those of a skewed box
_NO_MORE = -1  # ends header, arrays of types and contact model
_PAIR_STYLE, _CONTACT_MODEL, _CONTACT_MODEL_BYTES = 0, b"gran", 8
MOST_GROUPS = 32  # of LIGGGHTS
LONGEST_WORD = 4096
BLOCK_NUMBERS = 1 << 22  # of particles' records, read at a time
_DOUBLE_BYTES = 8


class RestartFileError(ValueError):
    """A restart file that is not whole; the message names it."""


class RestartFile(NamedTuple):
    """What a whole restart file says of itself: its time step, particles, ranks that wrote it, and types."""

    step: int
    particles: int
    ranks: int
    types: int


class _BrokenError(Exception):
    """The bytes do not follow the layout."""


def read_restart(path: Path | str) -> RestartFile:
    """Return what a restart file holds, every record of it followed to the end. Raises RestartFileError."""
    try:
        with open(path, "rb") as stream:
            size = stream.seek(0, 2)
            stream.seek(0)
            try:
                header = _header(stream)
            except _BrokenError:
                raise _fault(path, size, "it ends within its header or begins with something else") from None
            if not _ends_well(stream, header, size):
                raise _fault(path, size, f"its records do not end with its {header.particles} particles")
            return header
    except OSError as fault:
        raise RestartFileError(f"{path}: the restart file cannot be read ({fault.strerror}).") from fault


def _fault(path: Path | str, size: int, what: str) -> RestartFileError:
    return RestartFileError(f"{path}: the restart file of {size} bytes is not whole, {what}.")


def _take(stream: BinaryIO, length: int) -> bytes:
    found = stream.read(length) if length >= 0 else b""
    if len(found) != length:
        raise _BrokenError
    return found


def _integer(stream: BinaryIO) -> int:
    return struct.unpack("<i", _take(stream, 4))[0]


def _word(stream: BinaryIO) -> bytes:
    length = _integer(stream)
    word = _take(stream, length) if 0 < length <= LONGEST_WORD else b""
    if word.find(b"\0") != length - 1:
        raise _BrokenError
    return word[:-1]


def _header(stream: BinaryIO) -> RestartFile:
    """Read the header: numbers behind their flags, until -1."""
    found = {}
    while (flag := _integer(stream)) != _NO_MORE:
        if flag in _WORDS:
            word = found[flag] = _word(stream)
            if flag == _ATOM_STYLE and word == b"hybrid":
                for _ in range(_integer(stream)):
                    _word(stream)
        elif flag in _LONG:
            found[flag] = struct.unpack("<q", _take(stream, 8))[0]
        elif 0 <= flag <= _LAST:
            found[flag] = _integer(stream) if flag < _FIRST_DOUBLE else _take(stream, 8)
        else:
            raise _BrokenError
    if not found.keys() >= _ALWAYS:
        raise _BrokenError
    return RestartFile(found[_TIME_STEP], found[_PARTICLES], found[_RANKS], found[_TYPES])


def _ends_well(stream: BinaryIO, header: RestartFile, size: int) -> bool:
    """Return whether groups, contact model, fixes and particles of a file end with it."""
    try:
        _skip_groups(stream)
        _skip_contact_model(stream, header.types)
        _skip_fixes(stream, size)
        return _count_particles(stream, header.ranks) == header.particles and stream.tell() == size
    except _BrokenError:
        return False


def _skip_groups(stream: BinaryIO) -> None:
    """Pass the names of all groups; one that was deleted leaves an empty name."""
    left, most = _count(stream), MOST_GROUPS
    while left and most:
        length = _integer(stream)
        if length:
            stream.seek(-4, 1)
            _word(stream)
        left, most = left - bool(length), most - 1
    if left:
        raise _BrokenError


def _skip_contact_model(stream: BinaryIO, types: int) -> None:
    """Pass the contact model: its name, its number, and whether it is set for each pair of types (1) or not (0)."""
    if _integer(stream) != _NO_MORE or _integer(stream) != _PAIR_STYLE or _word(stream) != _CONTACT_MODEL:
        raise _BrokenError
    _take(stream, _CONTACT_MODEL_BYTES)
    if any(_integer(stream) not in (0, 1) for _ in range(types * (types + 1) // 2)) or _integer(stream) != _NO_MORE:
        raise _BrokenError


def _skip_fixes(stream: BinaryIO, size: int) -> None:
    """Pass the state of all fixes, then the list of those with values per particle."""
    for with_state in (True, False):
        for _ in range(_count(stream)):
            for _ in ("id", "style"):
                if not _word(stream).isascii():
                    raise _BrokenError
            length = _integer(stream)
            if with_state:
                if not 0 < length <= size - stream.tell():
                    raise _BrokenError
                stream.seek(length, 1)


def _count(stream: BinaryIO) -> int:
    count = _integer(stream)
    if not 0 <= count <= LONGEST_WORD:
        raise _BrokenError
    return count


def _count_particles(stream: BinaryIO, ranks: int) -> int:
    """Return the particles of all ranks."""
    return sum(_particles_of_rank(stream, _integer(stream)) for _ in range(ranks))


def _particles_of_rank(stream: BinaryIO, left: int) -> int:
    """Return the particles in a rank's record of so many numbers, read block by block: gigabytes are not held."""
    if left < 0:
        raise _BrokenError
    particles, place = 0, 0  # place: of the next particle in the block, it may lie in a later one
    while left:
        block = memoryview(_take(stream, _DOUBLE_BYTES * min(left, BLOCK_NUMBERS))).cast("d")
        left -= len(block)
        while place < len(block):
            length = block[place]
            if not (1.0 <= length <= len(block) - place + left and length == int(length)):
                raise _BrokenError
            place, particles = place + int(length), particles + 1
        place -= len(block)
    return particles
