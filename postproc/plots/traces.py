"""Curves, points, bars and levels of an interactive figure: rows of a table as plotly's traces."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.plots.chart import BARS, LINES, Axis, Layer
from bulkwear.postproc.plots.legend import LETTERS, Look, plain
from bulkwear.postproc.tables.display import few_digits

Trace = dict[str, Any]
DIGITS = 6  # significant ones of what is drawn
MOST_MARKS = 40  # on a curve: with more of them it is a line alone
SHORT, EXACT = ",.4~r", ".4~g"  # d3 formats of numbers that people read, and of very small or large ones
PLAIN_NUMBERS = 1e-3, 1e7  # of the largest value on an axis
BAND = 0.18  # opacity
WITHOUT_END = 1.08  # -, over the largest value: there an interval without an end stops


def traces_of(
    layer: Layer, rows: pd.DataFrame, axes: tuple[Axis, Axis], look: Look, told: Sequence[str], words: bool
) -> list[Trace]:
    """Return a curve, its points or bars, behind them the field of its intervals.

    axes: of x and y; told: what the pointer says first; words: whether places along x are words and not numbers
    """
    level = not pd.api.types.is_numeric_dtype(rows[layer.y])  # bars that lie
    along = rows[layer.x] if level else rows[layer.y]
    across = [plain(value) for value in rows[layer.y]] if level else places(layer, rows, words)
    values = layer.factor * along.to_numpy(float)
    low, high = ends(layer, rows, values)
    trace = {
        "legendgroup": look.name,
        "name": escape(look.name, quote=False),
        ("y" if level else "x"): across,
        ("x" if level else "y"): numbers(values),
        "hovertemplate": _pointed(layer, axes, values, across, told, level),
        "customdata": interval_words(low, high),
        **_kind(layer, look, len(rows), level),
    }
    if not layer.band and np.isfinite(low).any():
        trace["error_x" if level else "error_y"] = _bars(
            values, low, high, LETTERS if layer.kind == BARS else look.colour
        )
    field = [_field(across, low, high, look)] if layer.band and np.isfinite(low).any() else []
    return [*field, trace]


def places(layer: Layer, rows: pd.DataFrame, words: bool) -> list[Any]:
    """Return the places of rows along x: numbers, or the words of all columns together."""
    if words:
        columns = [rows[name] for name in layer.along]
        return [" ".join(_word(value) for value in row) for row in zip(*columns, strict=True)]
    return numbers(rows[layer.along[0]].to_numpy(float))


def ends(layer: Layer, rows: pd.DataFrame, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return both ends of intervals (k,), NaN where there are none."""
    if layer.spread:
        half = layer.factor * rows[layer.spread].to_numpy(float)
        return values - half, values + half
    if not layer.low:
        return np.full_like(values, np.nan), np.full_like(values, np.nan)
    return tuple(layer.factor * rows[name].to_numpy(float) for name in (layer.low, layer.high))


def numbers(values: np.ndarray) -> list[float | None]:
    """Return numbers with few digits, None for what is none."""
    return [float(f"{value:.{DIGITS}g}") if np.isfinite(value) else None for value in values]


def interval_words(low: np.ndarray, high: np.ndarray) -> list[str]:
    """Return intervals in words, as they stand behind values."""
    pairs = zip(low, high, strict=True)
    return [f" ({_end(a)} to {_end(b)})" if np.isfinite(a) or np.isfinite(b) else "" for a, b in pairs]


def number_format(values: np.ndarray) -> str:
    """Return the format of numbers of an axis for the pointer."""
    known = np.abs(values[np.isfinite(values)])
    largest = known.max(initial=0.0)
    return SHORT if largest == 0.0 or PLAIN_NUMBERS[0] <= largest < PLAIN_NUMBERS[1] else EXACT


def _pointed(
    layer: Layer, axes: tuple[Axis, Axis], values: np.ndarray, across: list[Any], told: Sequence[str], level: bool
) -> str:
    """Return what the pointer says at a value: whose it is, its place, the value with its interval and unit."""
    valued, placed = axes if level else axes[::-1]
    named = {name: escape(name, quote=False) for name in (layer.said or valued.title, placed.title, *told)}
    known = np.array([each for each in across if not isinstance(each, str) and each is not None], dtype=float)
    form = f":{number_format(known)}" if len(known) else ""
    place = f"%{{{'y' if level else 'x'}{form}}}"
    value = f"%{{{'x' if level else 'y'}:{number_format(values)}}}%{{customdata}} {_unit(valued)}"
    lines = [f"<b>{', '.join(named[name] for name in told)}</b>"] if told else []
    lines += [f"{named[placed.title]}: {place} {_unit(placed)}".strip(" :")]
    return "<br>".join([*lines, f"{named[layer.said or valued.title]}: {value}".strip()]) + "<extra></extra>"


def _unit(axis: Axis) -> str:
    return escape(axis.unit, quote=False) if axis.unit != "-" else ""


def _kind(layer: Layer, look: Look, count: int, level: bool) -> Trace:
    if layer.kind == BARS:
        pattern = {"shape": "/", "fillmode": "overlay", "solidity": 0.3} if layer.published else {"shape": ""}
        return {
            "type": "bar",
            "orientation": "h" if level else "v",
            "marker": {"color": look.colour, "opacity": 0.85, "pattern": pattern},
        }
    marker = {"color": look.colour, "symbol": look.symbol, "size": 5 if layer.thin else 10 if layer.published else 7}
    if layer.kind != LINES:
        return {"type": "scatter", "mode": "markers", "marker": marker}
    marked = count <= MOST_MARKS and not layer.thin
    line = {"color": look.colour, "dash": look.dash, "width": 1 if layer.thin else 2}
    return {"type": "scatter", "mode": "lines+markers" if marked else "lines", "line": line, "marker": marker}


def _bars(values: np.ndarray, low: np.ndarray, high: np.ndarray, colour: str) -> Trace:
    known = np.concatenate([values, high])
    high = np.where(np.isposinf(high), WITHOUT_END * known[np.isfinite(known)].max(initial=0.0), high)
    up, down = (np.clip(each, 0.0, None) for each in (high - values, values - low))
    arrays = {"array": numbers(up), "arrayminus": numbers(down)}
    return {"type": "data", "symmetric": False, **arrays, "color": colour, "thickness": 1.2, "width": 4}


def _field(across: list[Any], low: np.ndarray, high: np.ndarray, look: Look) -> Trace:
    """Return the field between the ends of intervals, where both are known."""
    known = np.flatnonzero(np.isfinite(low) & np.isfinite(high))
    there = [across[k] for k in known]
    shape = {"x": [*there, *there[::-1]], "y": [*numbers(low[known]), *numbers(high[known][::-1])]}
    look_of = {"mode": "lines", "line": {"width": 0}, "fill": "toself", "fillcolor": look.colour, "opacity": BAND}
    return {"type": "scatter", "legendgroup": look.name, "name": "", "hoverinfo": "skip", **shape, **look_of}


def _end(value: float) -> str:
    return few_digits(value) if np.isfinite(value) else "no end"


def _word(value: Any) -> str:
    return f"{value:g}" if isinstance(value, (int, float)) else plain(value)
