"""Compare the tables of two folders of results: the same numbers before and after a change that should change none.

python -m benchmarks.same_results before/results after/results [--tolerance 0] [--renamed old=new ...]

Every CSV that both have is compared cell by cell, and the solver's tables byte by byte are the strongest part of it:
wear.csv and summary.csv. Times and costs differ from run to run and are left out. Renamed columns, files and words are
given as old=new. Exit code 1 where a number differs or a table is missing.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks.command_line import command

TIMED = ("cost.csv", "solver_cost.csv", "forecast.csv", "ranks.csv")  # of tables that tell of the machine
OF_MACHINE_OR_CODE = ("simulated_by", "solver_s", "processor_s", "other_s", "other_processor_s", "wall_s")
SKIPPED_FOLDERS = ("logs", "decks", "superseded")


def tables(folder: Path) -> dict[str, Path]:
    """Return {path from the folder: file} of all tables of results that do not tell of the machine."""
    found = (path for path in sorted(folder.rglob("*.csv")) if path.name not in TIMED)
    named = {path.relative_to(folder).as_posix(): path for path in found}
    return {name: path for name, path in named.items() if not set(name.split("/")) & set(SKIPPED_FOLDERS)}


def renamed(name: str, names: Mapping[str, str]) -> str:
    """Return a name with every old word replaced by its new one, the longest first."""
    for old in sorted(names, key=len, reverse=True):
        name = name.replace(old, names[old])
    return name


def difference(before: pd.DataFrame, after: pd.DataFrame, names: Mapping[str, str], tolerance: float) -> str:
    """Return how two tables differ, a phrase, or "" where they are the same; tolerance is relative."""
    before = before.rename(columns={name: renamed(str(name), names) for name in before})
    if missing := sorted(set(before) - set(after)):
        return f"columns are missing: {', '.join(missing)}"
    if len(before) != len(after):
        return f"{len(after)} rows instead of {len(before)}"
    worst, where = 0.0, ""
    for name in before.columns.difference(OF_MACHINE_OR_CODE):
        old, new = before[name], after[name]
        if pd.api.types.is_numeric_dtype(old) and pd.api.types.is_numeric_dtype(new):
            apart = _apart(old.to_numpy(dtype=float), new.to_numpy(dtype=float))
            if apart > worst:
                worst, where = apart, str(name)
        elif any(renamed(str(a), names) != str(b) for a, b in zip(old, new, strict=True)):
            return f"words of {name} differ"
    return f"{where} differs by {worst:.2g} of itself" if worst > tolerance else ""


def _apart(old: np.ndarray, new: np.ndarray) -> float:
    """Return the largest relative difference; infinite where only one is not a number."""
    if (np.isnan(old) != np.isnan(new)).any():
        return np.inf
    same = (old == new) | np.isnan(old)
    apart = np.abs(np.where(same, 0.0, old) - np.where(same, 0.0, new))  # infinite ones that are the same are 0 apart
    size = np.maximum(np.maximum(np.abs(old), np.abs(new)), np.finfo(float).tiny)
    return float((apart / np.where(np.isfinite(size), size, 1.0)).max(initial=0.0))


def compare(before: Path, after: Path, names: Mapping[str, str], tolerance: float) -> list[str]:
    """Return a sentence for every table that is missing or differs, and say how many are the same."""
    old, new = tables(before), tables(after)
    faults = []
    for name, path in old.items():
        there = new.get(renamed(name, names), new.get(name))
        if there is None:
            faults.append(f"{name}: is missing")
        elif phrase := difference(pd.read_csv(path), pd.read_csv(there), names, tolerance):
            faults.append(f"{name}: {phrase}")
    print(f"{len(old) - len(faults)} of {len(old)} tables are the same, {len(set(new) - set(old))} are new.")
    return faults


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--tolerance", type=float, default=0.0, help="relative, of numbers")
    parser.add_argument("--renamed", nargs="*", default=[], metavar="OLD=NEW")
    given = parser.parse_args(words)
    names = dict(pair.split("=", 1) for pair in given.renamed)
    faults = compare(given.before, given.after, names, given.tolerance)
    print("\n".join(faults), file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    command(main)
