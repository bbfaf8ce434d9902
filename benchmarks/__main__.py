"""Every benchmark of this project, as one table: speed, overhead, scaling.

    python -m benchmarks                     # in the root of the repository, on an idle machine: about 50 minutes
    python -m benchmarks --only ranks        # one of them; its lines in the table are replaced
    python -m benchmarks --quick             # tiny sizes, printed only: does everything run?
    python -m benchmarks --redraw            # the page from its table, nothing measured

Writes benchmarks.csv and benchmarks.md into docs. Benchmarks that make a figure of their own are commands of their own
(benchmarks/groove.py and others).
"""

from __future__ import annotations

import argparse
import importlib
import os
import time
from collections.abc import Sequence
from dataclasses import asdict
from datetime import date
from pathlib import Path

import pandas as pd

from benchmarks.command_line import command, output_folder, read_table
from benchmarks.page import page, table_text
from bulkwear.workflows.forecast.rates import machine_facts

# modules with `measures(folder, quick)`; what simulates comes last
MODULES = (
    *("dry_run", "contact_reader", "displacement", "remesh", "wear_steps", "meshing", "own_mesh", "study_share"),
    *("ledger_overhead", "solver_speed", "rolling_cost", "ranks", "full_size"),
)
BY_STUDY = "study_share"  # whose lines of a study begin with its name and fidelity, up to a comma
BUSY = 0.5  # -, load of the machine, in processes, above which wall times mean little


def lines_of(module: str, folder: Path, quick: bool) -> pd.DataFrame:
    """Return the measures of a benchmark as a table, with its name, date and the load of the machine before it."""
    load, started = os.getloadavg()[0], time.monotonic()
    found = importlib.import_module(f"benchmarks.{module}").measures(folder, quick)
    print(f"{module}: {time.monotonic() - started:.0f} s", flush=True)
    told = {"benchmark": module, "date": f"{date.today():%Y-%m-%d}", "load_before": round(load, 2)}
    return pd.DataFrame([told | asdict(measure) for measure in found])


def replaced(before: pd.DataFrame, now: Sequence[pd.DataFrame]) -> pd.DataFrame:
    """Return the table with the lines of the benchmarks that were run now instead of their earlier ones, in order; one
    that found nothing to measure, as without finished studies, leaves them, and studies without results here keep
    theirs.
    """
    now = [table for table in now if len(table)]
    if not now:
        return before
    names = {name for table in now for name in table["benchmark"]}
    kept = [before[~before["benchmark"].isin(names) | _of_other_studies(before, now)]] if len(before) else []
    whole = pd.concat([*kept, *now], ignore_index=True)
    order = whole["benchmark"].map({name: place for place, name in enumerate(MODULES)})
    return whole.loc[order.sort_values(kind="stable").index].reset_index(drop=True)


def _of_other_studies(before: pd.DataFrame, now: Sequence[pd.DataFrame]) -> pd.Series:
    """Return the mask of the lines of studies that were not looked at now."""
    seen = {name.split(",")[0] for table in now for name in table["name"]}
    return (before["benchmark"] == BY_STUDY) & ~before["name"].str.split(",").str[0].isin(seen)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", metavar="NAME", choices=MODULES, action="append", help=f"of {', '.join(MODULES)}")
    parser.add_argument("--quick", action="store_true", help="tiny sizes; nothing is written")
    parser.add_argument("--folder", type=Path, default=Path("results/benchmarks"), help="for simulations")
    parser.add_argument("--output", type=output_folder, default="docs")
    parser.add_argument("--redraw", action="store_true", help="write the page from the table of earlier measurements")
    given = parser.parse_args()
    file = given.output / "benchmarks.csv"
    if given.redraw:
        write_page(file)
        return
    folder = given.folder / ("quick" if given.quick else "full")
    if (load := os.getloadavg()[0]) > BUSY:
        print(f"This machine is busy (load {load:.1f}): wall times, and all of `ranks`, will mean little.")
    found = []
    for module in given.only or MODULES:
        found.append(lines_of(module, folder, given.quick))
        print(table_text(found[-1]), flush=True)
        if not given.quick:
            before = pd.read_csv(file) if file.is_file() else pd.DataFrame()
            table = replaced(before, [found[-1]])
            table.to_csv(file, index=False, float_format="%.4g")
            write_page(file)


def write_page(file: Path) -> None:
    """Write the page of a table of benchmarks beside it. The machine named is this one."""
    file.with_suffix(".md").write_text(page(read_table(file), machine_facts()), encoding="utf-8")


if __name__ == "__main__":
    command(main)
