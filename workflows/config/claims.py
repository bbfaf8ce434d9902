"""Claims on published findings, from config/published/verdicts.yaml: checked, one sentence per fault."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any

from bulkwear.postproc.statistics.verdicts import Claim
from bulkwear.workflows.config.layers import ConfigError, read_yaml
from bulkwear.workflows.engine.project import current_project

CLAIMS_FILE = "config/published/verdicts.yaml"
KEYS = {
    *("finding", "source", "quantity", "unit", "direction", "reference", "magnitude", "margin", "range", "range_unit"),
    "why",
}
NEEDED = ("finding", "source", "quantity")
DIRECTIONS = ("above", "below")
# -, margin of a value told as "about": what is read off a figure's axis and told in whole tens of per cent; since
# 2026-11-23, as in config/published/verdicts.yaml
ABOUT = 0.15


def claims_of(part: str, path: str | Path | None = None) -> dict[str, Claim]:
    """Return {key: claim} of one part of the file, such as a study's. Raises ConfigError."""
    path = Path(path or current_project().path(CLAIMS_FILE))
    parts = _read(path).get("claims", {})
    if part not in parts:
        raise ConfigError(f"{path.name}: found no claims of {part}, allowed are {', '.join(parts) or 'none'}.")
    return {key: _claim(key, told, f"{path.name}: claims.{part}.{key}") for key, told in parts[part].items()}


def about(quantity: str, low: float, high: float, unit: str, source: str = "", margin: float | None = None) -> Claim:
    """Return a published value or range as a claim of its sign and size; without a margin of its own it is ABOUT.

    What agrees on both sides of 0, by its ends or by a margin of its own, claims no sign.
    """
    told = [end for end in (low, high) if math.isfinite(end)]  # of a range with one end that end alone
    size = {"magnitude": (low, high), "margin": ABOUT * abs(sum(told) / len(told)) if margin is None else margin}
    words = f"about {low:g}" if low == high else f"{low:g} to {high:g}"
    least, most = low - (margin or 0.0), high + (margin or 0.0)
    direction = "above" if low > 0.0 and least >= 0.0 else "below" if high < 0.0 and most <= 0.0 else None
    return Claim(quantity, words, source, quantity, unit, direction, told_side=False, **size)


def date_of_rules(part: str = "", path: str | Path | None = None) -> str:
    """Return the date from which rules and margins of a part hold, by default the latest of all parts."""
    dates = _read(Path(path or current_project().path(CLAIMS_FILE)))["dates"]
    return str(dates[part] if part else max(dates.values()))


@cache
def _read(path: Path) -> dict[str, Any]:
    return read_yaml(path, current_project().folder).values


def _claim(key: str, told: dict[str, Any], where: str) -> Claim:
    """Return one claim. Raises ConfigError."""
    if unknown := sorted(set(told) - KEYS):
        raise ConfigError(f"{where}: found {unknown[0]}, allowed are {', '.join(sorted(KEYS))}.")
    if missing := [name for name in NEEDED if name not in told]:
        raise ConfigError(f"{where}: {missing[0]} is missing, allowed is a text.")
    direction, size = told.get("direction"), told.get("magnitude")
    if direction not in (None, *DIRECTIONS):
        raise ConfigError(f"{where}: direction is {direction}, allowed are {' and '.join(DIRECTIONS)}.")
    if direction is None and size is None:
        raise ConfigError(f"{where}: found neither direction nor magnitude, allowed is a claim with one or both.")
    if size is not None and not told.get("margin", 0.0) > 0.0:
        raise ConfigError(f"{where}: margin is {told.get('margin')}, allowed with a magnitude is a number above 0.")
    claim = Claim(
        key=key,
        finding=told["finding"],
        source=told["source"],
        quantity=told["quantity"],
        unit=told.get("unit", ""),
        direction=direction,
        reference=float(told.get("reference", 0.0)),
        magnitude=None if size is None else _pair(size, f"{where}: magnitude"),
        margin=float(told.get("margin", 0.0)),
        reach=_pair(told["range"], f"{where}: range") if "range" in told else None,
        reach_unit=told.get("range_unit", ""),
    )
    if direction and size is not None and not _on_one_side(claim):
        raise ConfigError(
            f"{where}: magnitude with margin is {claim.region[0]:g} to {claim.region[1]:g}, allowed with direction"
            f" {direction} is all of it {direction} {claim.reference:g}."
        )
    return claim


def _pair(value: Any, where: str) -> tuple[float, float]:
    low, high = value if isinstance(value, list) and len(value) == 2 else (value, value)
    high = math.inf if high is None and isinstance(value, list) else high
    if not all(isinstance(end, int | float) and not math.isnan(end) for end in (low, high)) or low > high:
        raise ConfigError(f"{where} is {value}, allowed is a number, [low, high] or [low, null].")
    return float(low), float(high)


def _on_one_side(claim: Claim) -> bool:
    low, high = claim.region
    return low >= claim.reference if claim.direction == "above" else high <= claim.reference
