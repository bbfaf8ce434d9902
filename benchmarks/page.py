"""The page of all benchmarks, from their table."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Mapping
from typing import Any

import pandas as pd

from benchmarks.scaling import measured_cost, scaling_table

HEAD = ["measure", "median (range)", "against", "ratio (range)", "repeats"]


def page(table: pd.DataFrame, machine: Mapping[str, Any]) -> str:
    """Return docs/benchmarks.md: a section per benchmark of the table, then the model of more ranks."""
    facts = f"{machine['processor']}, {machine['cores']} cores, {machine['memory_gb']:g} GB, {machine['system']}"
    parts = [
        "# Benchmarks",
        f"Written by `python -m benchmarks` from [benchmarks.csv](benchmarks.csv). Machine: {facts}. Ratios are"
        " those of things measured in turn, repeat by repeat. Load is the number of other processes before a benchmark"
        " began; wall times under load mean little.",
    ]
    for name, lines in table.groupby("benchmark", sort=False):
        said = inspect.getdoc(importlib.import_module(f"benchmarks.{name}")).strip()
        when = f"{span(lines['date'])}, load {span(lines['load_before'])}; `--only {name}`"
        parts += [f"## {name.replace('_', ' ').capitalize()}", said, f"({when})", markdown(HEAD, cells(lines))]
    cost = measured_cost(table)
    if cost is not None:
        parts += ["## More ranks", *scaling_section(cost)]
    return "\n\n".join(parts) + "\n"


def scaling_section(cost: float) -> list[str]:
    """Return the paragraphs of the model of more ranks."""
    import benchmarks.scaling_model as model

    rows = [
        [
            *(str(value) for value in (row.study, f"{row.particles:,}", row.ranks)),
            *(f"{row.split_across:.2f}", row.deck_grid, f"{row.of_decks:.2f}"),
            *(row.best_grid, f"{row.best:.2f}", f"{row.bed_as_wide_again:.2f}"),
        ]
        for row in scaling_table(cost).itertuples()
    ]
    head = ["study, paper", "particles", "ranks", "all across", "the decks' grid", "its efficiency"]
    head += ["best grid", "its efficiency", "bed as much wider"]
    said = inspect.getdoc(model).strip()
    return [
        f"{said} Here a ghost costs {cost:.2f} of a particle. Grids are ranks across by ranks along the travel,"
        " efficiencies (-):",
        markdown(head, rows),
    ]


def cells(lines: pd.DataFrame) -> list[list[str]]:
    """Return the cells of `HEAD` of each line of a table."""
    return [
        [
            row["name"],
            f"{number(row['value'])} {row['unit']}{scatter(row['low'], row['high'], row['repeats'])}",
            row["against"] if isinstance(row["against"], str) else "",
            ""
            if pd.isna(row["ratio"])
            else f"{row['ratio']:.3f}{scatter(row['ratio_low'], row['ratio_high'], row['repeats'])}",
            str(row["repeats"]),
        ]
        for row in lines.to_dict("records")
    ]


def span(values: pd.Series) -> str:
    """Return the least and the largest of dates or numbers, one where they are the same."""
    ends = (values.min(), values.max())
    return " to ".join(dict.fromkeys(each if isinstance(each, str) else f"{each:g}" for each in ends))


def scatter(low: float, high: float, repeats: int) -> str:
    """Return a range in brackets, nothing of a single value."""
    return f" ({number(low)} to {number(high)})" if repeats > 1 else ""


def number(value: float) -> str:
    """Return three digits at least, thousands apart."""
    return f"{value:,.0f}" if abs(value) >= 1000.0 else f"{value:.3g}"


def markdown(head: list[str], rows: list[list[str]]) -> str:
    """Return a table of cells."""
    return "\n".join(f"| {' | '.join(row)} |" for row in [head, ["---"] * len(head), *rows])


def table_text(lines: pd.DataFrame) -> str:
    """Return the lines of a benchmark for the terminal, columns aligned."""
    rows = [HEAD, *cells(lines)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(HEAD))]
    padded = ("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows)
    return "\n".join(padded) + "\n"
