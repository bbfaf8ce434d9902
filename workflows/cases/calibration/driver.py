"""Calibrate contact parameters on bulk tests: from a study's parameters to simulations, and from these to tables.

Parameters are those of a run, SI; the first run's box is the calibration's, all runs' are compared by size. One job
each, resumable: a simulation that was done is not done again.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.flow.bulk_test import RESPONSES
from bulkwear.postproc.inference.loop import Posterior, Request, calibrate, packing_seed, posterior
from bulkwear.postproc.inference.problem import Experiment, Parameter, Problem
from bulkwear.workflows.cases.calibration.boxes import FIRST_REPEAT, SHEAR_BOX, SIMULATIONS, simulated_width, test_of
from bulkwear.workflows.cases.calibration.responses import FOUND_FIRST, RECOMMENDED, read_measured
from bulkwear.workflows.cases.calibration.simulations import BLOCKED, FOLDERS, answer, packings_of, simulate_all
from bulkwear.workflows.cases.calibration.told import told_sentences
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.bulk_simulations import simulation_folder
from bulkwear.workflows.engine.case import Parameters
from bulkwear.workflows.engine.job import Progress

SHEAR_ANGLE = "shear_angle_deg"


def problem_of(parameters: Parameters, measured: str | Path) -> Problem:
    """Return the calibration that a study's parameters ask for; `measured` is the table of measured responses."""
    asked = parameters["calibration"]
    return Problem(
        parameters=tuple(Parameter(each["name"], each["low"], each["high"]) for each in asked["parameters"]),
        tests=tuple(
            Experiment(kind, RESPONSES[kind], asked["initial"][kind], asked["most"][kind]) for kind in asked["tests"]
        ),
        measured=read_measured(measured, asked["model_discrepancy"]),
        parallel=asked["batch"],
        surrogate_share=asked["surrogate_share"],
        seed=asked["seed"],
    )


def pair_of(
    pairs: pd.DataFrame, row: str, names: Sequence[str], parameters: Parameters, kind: str = ""
) -> dict[str, float]:
    """Return the values of a row of a table of pairs; a parameter of which it has none keeps the value that it has in a
    test of that kind, the calibration's last one where none is named.
    """
    found = pairs[pairs["row"] == row].iloc[0].dropna()
    present = test_of(parameters, kind or parameters["calibration"]["tests"][-1], {}, 0)
    return {name: float(found[name]) if name in found else _value_at(present, name) for name in names}


def _value_at(test: Mapping[str, Any], name: str) -> float:
    found: Any = test
    for key in name.split("."):
        found = found[key]
    return float(found)


# ---------------------------------------------------------------- jobs


def run_calibration(
    parameters: Parameters, measured: Path, pairs: Path, folder: Path, workers: int
) -> tuple[pd.DataFrame, pd.DataFrame, pd.DataFrame]:
    """Calibrate, then simulate the pair found and the compared one with several seeds, and with what that tells the
    recommended one.

    workers: simulations at the same time. Returns the simulations, the looks at the surrogate and the repeats, one row
    each. Raises SolverError; what was simulated is kept in the folder.
    """
    say = Progress("calibration", 1).say
    problem = problem_of(parameters, measured)
    with state.only_driver(folder / SIMULATIONS, say):

        def simulate(requests: Sequence[Request]) -> list[dict[str, float]]:
            tests = [test_of(parameters, each.test, each.values, each.seed) for each in requests]
            return [answer(found) for found in simulate_all(tests, folder / SIMULATIONS, workers, say)]

        result = calibrate(problem, simulate, say)
        compared = compared_pairs(problem, result.posterior, parameters, pd.read_csv(pairs))
        compared = {FOUND_FIRST: compared.pop(RECOMMENDED), **compared}
        repeats = repeated(parameters, compared, folder, workers, say)
        known = posterior(problem, everything_of(problem, result.simulations, repeats))
        again = repeated(parameters, {RECOMMENDED: values_at(problem, known)}, folder, workers, say)
        repeats = pd.concat([repeats, again], ignore_index=True)
    result.simulations[FOLDERS] = folders_of(result.simulations, parameters, problem.names)
    for sentence in told_sentences(problem, posterior(problem, everything_of(problem, result.simulations, repeats))):
        say(sentence)
    return result.simulations, result.shares, repeats


def everything_of(problem: Problem, simulations: pd.DataFrame, repeats: pd.DataFrame) -> pd.DataFrame:
    """Return all simulations of a calibration, each once, in whichever table it stands."""
    both = pd.concat([simulations, repeats], ignore_index=True)
    return both.drop_duplicates(["test", "seed", *problem.names], ignore_index=True)


def values_at(problem: Problem, known: Posterior) -> dict[str, float]:
    """Return {name: value} of the point that a posterior recommends."""
    values = problem.from_unit(known.points[known.recommended][None])[0]
    return dict(zip(problem.names, map(float, values), strict=True))


def compared_pairs(
    problem: Problem, known: Posterior, parameters: Parameters, pairs: pd.DataFrame
) -> dict[str, dict[str, float]]:
    """Return {name: values} of the recommended pair and of the one that it is compared with."""
    other = parameters["calibration"]["compared_pair"]
    return {RECOMMENDED: values_at(problem, known), other: pair_of(pairs, other, problem.names, parameters)}


def repeated(
    parameters: Parameters,
    pairs: Mapping[str, Mapping[str, float]],
    folder: Path,
    workers: int,
    say: Callable[[str], None],
) -> pd.DataFrame:
    """Return one row per pair, test and seed: pair, test, seed, the parameters and the responses."""
    asked = [
        (name, kind, seed)
        for kind in parameters["calibration"]["tests"]
        for name in pairs
        for seed in repeat_seeds(parameters)
    ]
    tests = [test_of(parameters, kind, pairs[name], seed) for name, kind, seed in asked]
    found = simulate_all(tests, folder / SIMULATIONS, workers, say)
    rows = [
        {"pair": name, "test": kind, "seed": seed, **pairs[name], **answer(each)}
        for (name, kind, seed), each in zip(asked, found, strict=True)
    ]
    table = pd.DataFrame(rows)
    table[FOLDERS] = folders_of(table, parameters, list(next(iter(pairs.values()))))
    return table


def folders_of(table: pd.DataFrame, parameters: Parameters, names: Sequence[str]) -> list[str]:
    """Return the names of the folders of every row's simulations, those that arches blocked before the one that flowed.

    table: test, seed, the parameters' names, and BLOCKED where there may be some
    """
    rows = table if BLOCKED in table else table.assign(**{BLOCKED: 0})
    tests = [
        test_of(parameters, test, dict(zip(names, values, strict=True)), seed)
        for test, seed, values in zip(rows["test"], rows["seed"], rows[list(names)].to_numpy(float), strict=True)
    ]
    return [
        " ".join(simulation_folder(packing, Path()).name for packing in packings_of(test)[: int(blocked) + 1])
        for test, blocked in zip(tests, rows[BLOCKED], strict=True)
    ]


def repeat_seeds(parameters: Parameters) -> list[int]:
    """Return the seeds of the packings that are repeated."""
    asked = parameters["calibration"]
    return [packing_seed(asked["seed"], FIRST_REPEAT + number) for number in range(asked["repeats"])]


def run_box_sizes(runs: Mapping[str, Parameters], pairs: Path, folder: Path, workers: int) -> pd.DataFrame:
    """Return one row per box size: the shear angle at the pair of the sizes, its mean and scatter over seeds."""
    say = Progress("box sizes", 1).say
    table = pd.read_csv(pairs)
    asked = [(name, seed) for name, parameters in runs.items() for seed in repeat_seeds(parameters)]
    tests = [test_of(runs[name], SHEAR_BOX, _pair_of_sizes(runs[name], table), seed) for name, seed in asked]
    with state.only_driver(folder / SIMULATIONS, say):
        found = simulate_all(tests, folder / SIMULATIONS, workers, say)
    angles = [each.responses[SHEAR_ANGLE] for each in found]
    kept = [simulation_folder(test, Path()).name for test in tests]
    rows = []
    for name, parameters in runs.items():
        own = [number for number, (row, _) in enumerate(asked) if row == name]
        folders = {FOLDERS: " ".join(kept[number] for number in own)}
        rows.append(_size_row(name, parameters, [angles[number] for number in own]) | folders)
    return pd.DataFrame(rows)


def _pair_of_sizes(parameters: Parameters, table: pd.DataFrame) -> dict[str, float]:
    asked = parameters["calibration"]
    return pair_of(table, asked["sizes_pair"], [each["name"] for each in asked["parameters"]], parameters, SHEAR_BOX)


def _size_row(name: str, parameters: Parameters, angles: Sequence[float]) -> dict[str, Any]:
    box, particle = parameters[SHEAR_BOX], parameters["particle"]
    width = simulated_width(box, particle)
    return {
        "row": name,
        "varied": parameters["varied"],
        "length_mm": 1e3 * box["length_m"],
        "width_mm": 1e3 * width,
        "width_in_diameters": width / particle["median_diameter_m"],
        "mean": float(np.mean(angles)),
        "deviation": float(np.std(angles, ddof=1)) if len(angles) > 1 else np.nan,
        "seeds": len(angles),
    }


def read_posterior(
    parameters: Parameters, measured: Path, simulations: Path, repeats: Path
) -> tuple[Problem, pd.DataFrame, Posterior]:
    """Return the calibration, its simulations and the posterior of all of them, from finished tables.

    The recommended pair is what the simulations lead to with the repeats of the first pair found and of the compared
    one; its own repeats then tell as much as any other simulation, above all how far packings scatter.
    """
    problem, table, repeated_rows = problem_of(parameters, measured), pd.read_csv(simulations), pd.read_csv(repeats)
    before = repeated_rows[repeated_rows["pair"] != RECOMMENDED]
    chosen = posterior(problem, everything_of(problem, table, before)).recommended
    return problem, table, replace(posterior(problem, everything_of(problem, table, repeated_rows)), chosen=chosen)
