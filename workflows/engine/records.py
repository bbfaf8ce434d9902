"""Records in JSON that know when a letter of them has changed: sealed by the hash of what they say."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

SEAL = "sealed"  # key of a record: the hash of all its others
HASH_LETTERS = 64
UNSEALED_HASHES = {"inputs", "origin"}  # hashes that a record of an earlier version has, which was not sealed


class RecordError(ValueError):
    """A record that is not as it was written; the message names the file."""


def write_record(path: Path, record: Mapping[str, Any]) -> None:
    """Write a record with its seal, whole or not at all."""
    part = path.with_name(f"{path.name}.part")
    part.write_text(json.dumps({**record, SEAL: digest(record)}, indent=1, sort_keys=False) + "\n")
    os.replace(part, path)


def read_record(path: Path) -> dict[str, Any]:
    """Return a record without its seal; one of an earlier version has none. Raises RecordError, and OSError without a
    file.
    """
    try:
        found = json.loads(path.read_text("utf-8"))
    except (ValueError, RecursionError):
        raise RecordError(f"{path}: the record is torn, allowed is JSON as it was written.") from None
    if not isinstance(found, dict):
        raise RecordError(f"{path}: the record is torn, allowed is JSON as it was written.")
    seal = found.pop(SEAL, None)
    if seal != (digest(found) if seal is not None or _lost_its_seal(found) else None):
        raise RecordError(f"{path}: the record is not as it was written, its seal is that of another one.")
    return found


def _lost_its_seal(record: Mapping[str, Any]) -> bool:
    """Return whether a record without a seal has one under a changed name."""
    return any(
        isinstance(value, str) and len(value) == HASH_LETTERS and key not in UNSEALED_HASHES
        for key, value in record.items()
    )


def digest(*parts: bytes | str | Mapping[str, Any]) -> str:
    """Return the SHA-256 of texts, bytes and mappings (as JSON with sorted keys), each told apart from the next."""
    total = hashlib.sha256()
    for part in parts:
        text = json.dumps(part, sort_keys=True) if isinstance(part, Mapping) else part
        data = text.encode() if isinstance(text, str) else text
        total.update(len(data).to_bytes(8, "big") + data)
    return total.hexdigest()
