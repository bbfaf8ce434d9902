"""Rounds of a study, which say how many packings or which rows come next: what each decided, and what runs have cost.

Each round is a file results/<study>/rounds/round_<number>.json. The settings `until` and `optimise` ask for rounds.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

ROUNDS = "rounds"  # folder below results/<study>
SECONDS_PER_HOUR = 3600.0


def core_hours(costs: Sequence[str | Path]) -> float:
    """Return the core hours of the solver in tables of costs of runs and beds."""
    return float(sum(pd.read_csv(path)["processor_s"].sum() for path in costs)) / SECONDS_PER_HOUR


def round_path(folder: Path, number: int) -> Path:
    """Return the file of a round; folder: results/<study>"""
    return folder / ROUNDS / f"round_{number}.json"


def read_round(path: str | Path) -> dict[str, Any]:
    """Return what a round decided."""
    return json.loads(Path(path).read_text(encoding="utf-8"))


def last_round(folder: Path) -> str:
    """Return what the last round of a study said; "" where there were none. folder: results/<study>"""
    rounds = sorted((folder / ROUNDS).glob("round_*.json"), key=lambda path: int(path.stem.partition("_")[2]))
    return read_round(rounds[-1])["said"] if rounds else ""


def after_round(folder: Path, number: int, digest: str) -> str:
    """Return the hash that round `number` + 1 must have been made after; digest: as from `search_digest`."""
    return digest_of_text(f"{digest}{round_path(folder, number).read_text(encoding='utf-8')}") if number else digest


def rounds_of(folder: Path, digest: str) -> Iterator[dict[str, Any]]:
    """Yield what the rounds of a search decided, as long as each was made after the one before it, as it is now."""
    number = 0
    while round_path(folder, number + 1).is_file():
        found = read_round(round_path(folder, number + 1))
        if found.get("after") != after_round(folder, number, digest):
            return
        yield found
        number += 1


def digest_of_text(text: str) -> str:
    """Return the hash of a text."""
    return hashlib.sha256(text.encode()).hexdigest()
