"""Simulate a pair that a calibration found in a test, or at a particle scale, that the calibration did not use.

python -m bulkwear.workflows.cases.calibration.checked_pairs [--study calibration] [--pair recommended]
    [--test draw_down] [--fidelity standard] [--seeds 2]

Reads the pair from results/<study>/repeats.csv and adds a row per packing to results/<study>/checked_pairs.csv; what is
there already is not simulated again. The simulations lie beside those of the calibration.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import pandas as pd

from bulkwear.postproc.flow.bulk_test import RESPONSES
from bulkwear.postproc.inference.problem import Problem
from bulkwear.workflows.cases.calibration.boxes import DRAW_DOWN, SIMULATIONS, simulated_width
from bulkwear.workflows.cases.calibration.case import published
from bulkwear.workflows.cases.calibration.driver import repeated
from bulkwear.workflows.cases.calibration.responses import RECOMMENDED, repeat_table, with_bands
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.case import Parameters
from bulkwear.workflows.engine.job import Progress
from bulkwear.workflows.engine.project import work_here
from bulkwear.workflows.engine.solver import SolverError

CASE = "calibration"
CHECKED = "checked_pairs.csv"
MARKS = ["pair", "test", "seed", "particle_scale", "width_mm"]  # tell one row from another, with the parameters


def pair_found(repeats: pd.DataFrame, pair: str, names: list[str]) -> dict[str, float]:
    """Return {parameter: value} of a pair in a calibration's table of repeats. Raises ValueError when it has none, or
    not all parameters.
    """
    if other := [name for name in names if name not in repeats]:
        raise ValueError(f"repeats.csv has no column {other[0]}, which calibration.parameters has: calibrate again.")
    rows = repeats[repeats["pair"] == pair]
    if rows.empty:
        there = ", ".join(dict.fromkeys(repeats["pair"]))
        raise ValueError(f"repeats.csv has no pair {pair!r}, there are {there}.")
    return {name: float(rows[name].iloc[0]) for name in names}


def asked_run(study: str, fidelity: str, test: str, seeds: int) -> Parameters:
    """Return the parameters of a study's first box for one test with so many packings.

    Where something was measured in the test, they are checked as those of a study of that test: the study's own may not
    have it. Raises ConfigError.
    """

    def run_of(**asked: Any) -> Parameters:
        overrides = {"fidelity": fidelity, "calibration": {"repeats": seeds, **asked}}
        return load_study(study, overrides=overrides).all_runs[0].parameters

    if (case := load_study(study, overrides={"fidelity": fidelity}).case.name) != CASE:
        raise ConfigError(f"study {study}: its case is {case}, allowed is one of case {CASE}.")

    run = run_of()
    if set(published(run["calibration"]["measured"])["response"]) & set(RESPONSES[test]):
        return run_of(tests=[test])
    return {**run, "calibration": {**run["calibration"], "tests": [test]}}


def check_pair(parameters: Parameters, pair: str, folder: Path, workers: int) -> pd.DataFrame:
    """Simulate a pair in the tests of `parameters`, add its rows to the table in the folder, and return the table."""
    say = Progress("checked pairs", 1).say
    names = [each["name"] for each in parameters["calibration"]["parameters"]]
    if not (repeats := folder / "repeats.csv").is_file():
        raise ValueError(
            f"{repeats} is missing, allowed is a study whose calibration is finished: snakemake {folder.name}"
        )
    values = pair_found(pd.read_csv(repeats), pair, names)
    with state.only_driver(folder / SIMULATIONS, say):
        rows = repeated(parameters, {pair: values}, folder, workers, say)
    rows.insert(3, "particle_scale", parameters["particle"]["scale"])
    widths = {kind: 1e3 * simulated_width(parameters[kind], parameters["particle"]) for kind in set(rows["test"])}
    rows.insert(4, "width_mm", rows["test"].map(widths))
    before = [pd.read_csv(folder / CHECKED)] if (folder / CHECKED).is_file() else []
    table = pd.concat([*before, rows]).drop_duplicates([*MARKS, *names], keep="last", ignore_index=True)
    table.to_csv(folder / CHECKED, index=False)
    return table


def checked_means(rows: pd.DataFrame, problem: Problem) -> pd.DataFrame:
    """Return the means of such rows beside the measured bands; only packings of one pair, test, scale and width count
    together."""
    names = [name for name in problem.measured if name in rows]
    same = [*(name for name in MARKS if name not in ("pair", "seed")), *problem.names]
    tables = [
        with_bands(repeat_table(group, names), problem.measured).assign(**dict(zip(same, values, strict=True)))
        for values, group in rows.groupby(same, sort=False)
    ]
    return pd.concat(tables, ignore_index=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--study", default="calibration")
    parser.add_argument("--pair", default=RECOMMENDED)
    parser.add_argument("--test", default=DRAW_DOWN, choices=RESPONSES)
    parser.add_argument("--fidelity", default="standard")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--workers", type=int, default=1, help="simulations at the same time")
    given = parser.parse_args()
    if given.workers < 1:
        parser.error(f"argument --workers: {given.workers}, allowed is a whole number from 1")
    try:
        work_here()
        run = asked_run(given.study, given.fidelity, given.test, given.seeds)
        table = check_pair(run, given.pair, Path("results") / given.study, given.workers)
    except (ValueError, SolverError) as fault:  # of settings, the project and tables, and of a simulation
        sys.exit(str(fault))
    print(table.to_string(index=False))


if __name__ == "__main__":
    main()
