"""A finished calibration as its figures, tables and page need it, and the materials file that other studies can use."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

from bulkwear.postproc.flow.bed import read_snapshot
from bulkwear.postproc.flow.bulk_test import HEAP, slope_table
from bulkwear.postproc.inference.loop import Posterior
from bulkwear.postproc.inference.problem import Problem
from bulkwear.workflows.cases.calibration.boxes import SIMULATIONS, test_of, walls_of
from bulkwear.workflows.cases.calibration.driver import compared_pairs, everything_of, read_posterior, repeat_seeds
from bulkwear.workflows.cases.calibration.responses import (
    RECOMMENDED,
    family_table,
    interval_table,
    repeat_table,
    statement_table,
)
from bulkwear.workflows.cases.calibration.simulations import flowing
from bulkwear.workflows.cases.calibration.told import told_sentences
from bulkwear.workflows.engine.case import Parameters
from bulkwear.workflows.engine.grains import shape_of

TITLES = {"shear_box": "Shear box", "draw_down": "Draw-down test", "wall_shear": "Wall shear test"}


@dataclass(frozen=True, eq=False)
class Calibrated:
    """A finished calibration as its tables and figures need it."""

    parameters: Parameters
    folder: Path
    problem: Problem
    simulations: pd.DataFrame
    known: Posterior
    repeats: pd.DataFrame
    pairs: Mapping[str, Mapping[str, float]]
    published: pd.DataFrame

    @property
    def repeat_means(self) -> pd.DataFrame:
        """Mean and scatter of every response of the pairs that were repeated."""
        return repeat_table(self.repeats, [name for test in self.problem.tests for name in test.responses])

    @property
    def statements(self) -> pd.DataFrame:
        """What is said about each pair and response."""
        return statement_table(self.problem, self.known, self.repeat_means, self.pairs)

    @property
    def everything(self) -> pd.DataFrame:
        """All simulations of the calibration, those of the pairs that were repeated too."""
        return everything_of(self.problem, self.simulations, self.repeats)

    @cached_property
    def family(self) -> pd.DataFrame:
        """What all simulations leave of every two parameters, see `responses.family_table`."""
        return family_table(self.problem, self.known)

    @property
    def compared(self) -> str:
        """Name of the pair that the recommended one is compared with."""
        return self.parameters["calibration"]["compared_pair"]


def read_calibrated(parameters: Parameters, measured_file: Path, pairs_file: Path, folder: Path) -> Calibrated:
    """Return a finished calibration from simulations.csv and repeats.csv in the study's folder."""
    simulations, repeats = folder / "simulations.csv", folder / "repeats.csv"
    problem, table, known = read_posterior(parameters, measured_file, simulations, repeats)
    published = pd.read_csv(pairs_file)
    pairs = compared_pairs(problem, known, parameters, published)
    return Calibrated(parameters, folder, problem, table, known, pd.read_csv(repeats), pairs, published)


def recommended_heaps(done: Calibrated) -> tuple[list[dict[str, Any]], list[pd.DataFrame]]:
    """Return the heaps of the recommended pair, one per test, as `plots.heaps` wants them, and their slopes."""
    pictures, tables = [], []
    values = done.pairs[RECOMMENDED]
    for experiment in done.problem.tests:
        test = test_of(done.parameters, experiment.name, values, repeat_seeds(done.parameters)[0])
        found, folder = flowing(test, done.folder / SIMULATIONS, print)
        pair = ", ".join(f"{value:.2f}" for value in values.values())
        pictures.append(
            {
                "title": f"{TITLES[experiment.name]}, ({pair})",
                "particles": read_snapshot(folder / HEAP),
                "slopes": [slope for slopes in found.slopes.values() for slope in slopes],
                "walls": walls_of(test),
            }
        )
        tables.append(pd.DataFrame(slope_table(found)).assign(test=experiment.name))
    return pictures, tables


# ---------------------------------------------------------------- materials


def calibrated_materials(done: Calibrated, materials: Mapping[str, Any], study: str) -> str:
    """Return a materials file with the recommended values in it and, above them, where they come from.

    materials: the content of the file that the study used, in its units
    """
    intervals = interval_table(done.problem, done.known, done.pairs[done.compared])
    written = yaml.safe_load(yaml.safe_dump(dict(materials)))
    bulk = done.parameters["particle"]["name"]
    walls = [done.parameters[test.name]["wall_material"] for test in done.problem.tests]
    for row in intervals.itertuples():
        section, *path, key = row.parameter.split(".")
        for target in [written["particles"][bulk]] if section == "particle" else [written["walls"][w] for w in walls]:
            for name in path:
                target = target[name]
            target[key] = round(float(row.recommended), 4)
    written["particles"][bulk]["calibrated"] = _provenance(done, intervals, study)
    head = (
        f"# Written by the study {study}: contact parameters of {bulk}, calibrated on"
        f" {' and '.join(TITLES[test.name].lower() for test in done.problem.tests)} with"
        f" {len(done.everything)} simulations.\n# Everything else is as in the materials file that the study used.\n\n"
    )
    return head + yaml.safe_dump(written, sort_keys=False, allow_unicode=True)


def _provenance(done: Calibrated, intervals: pd.DataFrame, study: str) -> dict[str, Any]:
    """Return what the materials file tells about the values calibrated: valid in this convention and model only."""
    solver = done.parameters["solver"]
    used = {name: aim for name, aim in done.problem.measured.items() if name in done.known.predicted}
    aims = ", ".join(
        f"{name} {aim.value:g} +- {aim.deviation:g} (with the model {aim.variance**0.5:.2g})"
        for name, aim in used.items()
    )
    return {
        "study": study,
        "rolling_radius": solver["rolling_radius"],
        "rolling_friction": solver["rolling_friction"],
        "particle_scale": float(done.parameters["particle"]["scale"]),
        "shape": shape_of(done.parameters["particle"]),
        "measured": aims,
        "intervals": "; ".join(
            f"{row.parameter} {row.recommended:.3f}, 95 % between {row.low:.3f} and {row.high:.3f}"
            for row in intervals.itertuples()
        ),
        "not_told": " ".join(told_sentences(done.problem, done.known)),
    }
