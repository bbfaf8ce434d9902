"""Which rolling model did the source run? Pairs of frictions that it simulated, in its shear box and draw-down test,
under each of our four models: the responses that it prints beside ours. And what a wall shear test, which it does not
have, shows of a plate under each of them.

    python -m benchmarks.rolling_models --cores 2    # in the root of the repository
    python -m benchmarks.rolling_models --models own_spin epsd2    # these before the others
    python -m benchmarks.rolling_models --pairs calibrated --tests shear_box --packings 3
    python -m benchmarks.rolling_models --finished   # while it runs, or after it was stopped: of the simulations so far
    python -m benchmarks.rolling_models --redraw

Simulations stay in `--folder`, where a stopped one goes on. Writes into docs: rolling_models.csv (every simulation;
what was not asked for stays in it, with the version of the code that simulated it), figure and
rolling_models_results.md; `--redraw` makes the last two from the first.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from datetime import date
from pathlib import Path
from typing import Any

import pandas as pd

from benchmarks.command_line import at_least_one, command, output_folder, read_table
from benchmarks.plots.rolling_models import against_source
from benchmarks.rolling_case import FIDELITY, KINDS, MODELS, wanted
from benchmarks.rolling_page import NO_REST, differences, results_page
from benchmarks.runs import BY, side_by_side, simulated_by, with_earlier
from bulkwear.postproc.plots.style import save, save_small
from bulkwear.workflows.cases.calibration.case import pairs_file
from bulkwear.workflows.cases.calibration.simulations import answer, flowing, is_answered
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.bulk_simulations import simulation_folder
from bulkwear.workflows.engine.job import Progress
from bulkwear.workflows.engine.solver import SolverError
from bulkwear.workflows.report.fillings import filling_columns

PACKINGS = 2
RESTLESS = "did not come to rest"  # in the words of `bulk_simulations.check_rest`
KEYS = ["packing", "pair", "test", "model"]  # of a row in the table of every simulation
FILE, PAGE, FIGURE = "rolling_models.csv", "rolling_models_results.md", "rolling_models.png"


def simulated(rows: Sequence[dict[str, Any]], folder: Path, cores: int, alone: bool = True) -> pd.DataFrame:
    """Return the rows with the responses of each, simulated unless they were before; a test that never came to rest
    has the solver's words in NO_REST instead. Raises SolverError.

    alone: waits until nobody else simulates in that folder; else what is finished is read beside them
    """
    name = "rolling models"
    say = Progress(name, 1).say
    with state.only_driver(folder, say) if alone else nullcontext():
        answers = side_by_side(
            name, rows, lambda row: is_finished(row, folder), lambda row: answer_of(row["asked"], folder, say), cores
        )
    told = [_told(row) | filling_of(row, folder) | {BY: version(row, folder)} for row in rows]
    return pd.DataFrame([row | given for row, given in zip(told, answers, strict=True)])


def answer_of(test: dict[str, Any], folder: Path, say: Callable[[str], None]) -> dict[str, Any]:
    """Return the responses of a test, or that it never came to rest, which is kept: to try again delete that file."""
    kept = restless_file(test, folder)
    if not kept.is_file():
        try:
            return answer(flowing(test, folder, say)[0])
        except SolverError as fault:
            if RESTLESS not in str(fault):
                raise
            kept.write_text(f"{fault}\n", encoding="utf-8")
    words = kept.read_text(encoding="utf-8").strip()
    say(f"{words} ({kept})")
    return {NO_REST: words.partition(": ")[2].partition(" (")[0]}


def version(row: Mapping[str, Any], folder: Path) -> str:
    """Return the version of the code that simulated the packing of a row."""
    return simulated_by(simulation_folder(row["asked"], folder))


def filling_of(row: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return what a row's box was filled with, as the table of fillings tells it; nothing of one that never rested."""
    kept = simulation_folder(row["asked"], folder)
    return filling_columns(kept) if (state.cycle_folder(kept, 0) / state.STATE).is_file() else {}


def restless_file(test: dict[str, Any], folder: Path) -> Path:
    """Return the file that says that a test never came to rest."""
    return simulation_folder(test, folder).with_suffix(".txt")


def finished(rows: Sequence[dict[str, Any]], folder: Path) -> list[dict[str, Any]]:
    """Return those rows whose simulation is there, or was given up."""
    return [row for row in rows if is_finished(row, folder)]


def is_finished(row: Mapping[str, Any], folder: Path) -> bool:
    """Return whether the simulation of a row is there, or was given up.

    Where an arch blocked it, so are those packings that take its place, up to the first one that flowed.
    """
    test = row["asked"]
    return restless_file(test, folder).is_file() or is_answered(test, folder)


def _told(row: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in row.items() if name != "asked"}


def publish(output: Path, runs: pd.DataFrame, published: pd.DataFrame) -> str:
    """Write page and figure, which needs something of the source's, of the simulations; return the page.

    runs: as from `simulated`
    """
    page = results_page(runs, published)
    (output / PAGE).write_text(page, encoding="utf-8")
    if differences(runs, published).empty:
        return page
    packings = runs.groupby(["model", "test", "pair"])["packing"].nunique()
    several = f"{packings.min()} to {packings.max()}" if packings.min() < packings.max() else f"{packings.max()}"
    remarks = [
        f"study calibration at {FIDELITY} fidelity, pairs of Tables 3.3, 3.5 and 3.6 of Yan 2022; packings of each:"
        f" {several}; bars are 95 % intervals, models stand beside one another",
        f"made by benchmarks/rolling_models.py, {date.today():%Y-%m-%d}",
    ]
    save(against_source(runs, published, remarks), output / FIGURE)
    save_small(output / FIGURE, output / FIGURE)
    return page


def parser_of(published: pd.DataFrame) -> argparse.ArgumentParser:
    """Return the command line, which knows the pairs of the published table by name."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=output_folder, default="docs")
    parser.add_argument(
        "--packings", type=at_least_one, default=PACKINGS, help=f"of each pair, model and test, else {PACKINGS}"
    )
    parser.add_argument("--models", nargs="+", choices=MODELS, default=MODELS, help="else all")
    parser.add_argument("--tests", nargs="+", choices=KINDS, default=KINDS, help="else all")
    parser.add_argument("--pairs", nargs="+", choices=list(published["row"]), default=(), help="else all")
    parser.add_argument("--folder", type=Path, default=Path("results/benchmarks/full/rolling_models"))
    parser.add_argument("--cores", type=at_least_one, default=1, help="simulations side by side")
    parser.add_argument("--finished", action="store_true", help="simulate nothing, take what is finished")
    parser.add_argument("--redraw", action="store_true", help="from the table of an earlier run")
    return parser


def main() -> None:
    """Simulate what is missing, then write table, figure and page."""
    published = pd.read_csv(pairs_file(load_study("calibration")))
    parser = parser_of(published)
    given = parser.parse_args()
    file = given.output / FILE
    if not given.redraw:
        rows = wanted(given.packings, given.models, given.tests, given.pairs)
        rows = finished(rows, given.folder) if given.finished else rows
        if not rows:
            none = (
                f"{given.folder}: none asked for is finished" if given.finished else "--pairs, --tests: none are both"
            )
            parser.error(f"{none}; allowed are pairs of which the source prints a response of that test.")
        found = simulated(rows, given.folder, given.cores, alone=not given.finished)
        with_earlier(file, found, KEYS).sort_values(KEYS).to_csv(file, index=False, float_format="%.6g")
    print(publish(given.output, read_table(file, KEYS), published), flush=True)


if __name__ == "__main__":
    command(main)
