"""Whether finished tables of a calibration still answer what is asked, where Snakemake has no record that tells it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pandas as pd

from bulkwear.workflows.cases.calibration.boxes import SHEAR_BOX, test_of
from bulkwear.workflows.cases.calibration.driver import folders_of, pair_of, problem_of, repeat_seeds
from bulkwear.workflows.cases.calibration.simulations import FOLDERS
from bulkwear.workflows.engine.bulk_simulations import simulation_folder
from bulkwear.workflows.engine.case import Parameters

OTHER_COLUMNS, OTHER_TESTS = "its columns are others", "its tests are others"


def other_calibration(parameters: Parameters, measured: Path, simulations: Path) -> str | None:
    """Return in a phrase why a table of simulations is not of this calibration; None where it may be.

    Its tests are compared by the names of their folders, which are hashes of all that they were simulated from.
    """
    problem, table = problem_of(parameters, measured), _read(simulations)
    if not {"test", "seed", FOLDERS, *problem.names} <= set(table):
        return OTHER_COLUMNS
    for each in problem.parameters:
        if not table[each.name].between(each.low, each.high).all():
            return f"the range of {each.name} is {each.low:g} to {each.high:g}"
    if {each.name for each in problem.tests} != set(table["test"]):
        return OTHER_TESTS
    return None if folders_of(table, parameters, problem.names) == list(table[FOLDERS]) else OTHER_TESTS


def other_box_sizes(runs: Mapping[str, Parameters], pairs: Path, sizes: Path) -> str | None:
    """Return in a phrase why a table of box sizes is not of these runs; None where it is."""
    table, known = _read(sizes), pd.read_csv(pairs)
    if not {"row", FOLDERS} <= set(table):
        return OTHER_COLUMNS
    asked = {name: _folders_of_size(parameters, known) for name, parameters in runs.items()}
    return None if asked == dict(zip(table["row"], table[FOLDERS], strict=True)) else OTHER_TESTS


def _folders_of_size(parameters: Parameters, pairs: pd.DataFrame) -> str:
    asked = parameters["calibration"]
    names = [each["name"] for each in asked["parameters"]]
    values = pair_of(pairs, asked["sizes_pair"], names, parameters, SHEAR_BOX)
    tests = [test_of(parameters, SHEAR_BOX, values, seed) for seed in repeat_seeds(parameters)]
    return " ".join(simulation_folder(test, Path()).name for test in tests)


def _read(table: Path) -> pd.DataFrame:
    return pd.read_csv(table, dtype={"row": str})
