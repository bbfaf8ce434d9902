"""Calibrate contact parameters on bulk tests: from a study's settings to simulations, and from these to a result.

Settings are those of `case: calibration` in SI (config/cases/calibration.yaml tells what they mean).
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from postproc.analysis.bulk_test import RESPONSES
from postproc.calibration.loop import Request, Result, calibrate
from postproc.calibration.problem import Experiment, Measured, Parameter, Problem
from workflows.bulk_simulations import answer, simulate_all

LEAST_WIDTH_DIAMETERS = 4.0  # -, of a periodic slice; narrower ones hold the slope up (Yan 2022, section 3.3.2)
SIMULATIONS = "simulations"

Settings = Mapping[str, Any]


def problem_of(settings: Settings, measured: Mapping[str, Measured]) -> Problem:
    """Return the calibration that the settings ask for."""
    calibration = settings["calibration"]
    return Problem(
        parameters=tuple(
            Parameter(name, bounds["low"], bounds["high"]) for name, bounds in calibration["parameters"].items()
        ),
        tests=tuple(
            Experiment(kind, RESPONSES[kind], calibration["initial"][kind], calibration["most"][kind])
            for kind in calibration["tests"]
        ),
        measured=measured,
        parallel=calibration["parallel"],
        surrogate_share=calibration["surrogate_share"],
        seed=calibration["seed"],
    )


def test_of(
    settings: Settings, materials: Mapping[str, Any], kind: str, values: Mapping[str, float], seed: int
) -> dict[str, Any]:
    """Return the parameters of a bulk test (see bulk_tests.py).

    materials: particle (coarse-grained), and walls by name, SI; values: of the calibrated parameters, by dotted name
    """
    box = dict(settings[kind])
    walls = materials["walls"]
    floor = box.pop("floor_material") if kind == "shear_box" else box.pop("front_material")
    diameter = materials["particle"]["median_diameter_m"]
    if box.get("front_and_back", "periodic") == "periodic":
        box["width_m"] = max(box["width_m"], LEAST_WIDTH_DIAMETERS * diameter)
    test = {
        "kind": kind,
        "wall_material": walls[box.pop("wall_material")],
        "floor_material": walls[floor],
        "box": box,
        "rest": dict(settings["rest"]),
        "particle": materials["particle"],
        "solver": {key: settings["solver"][key] for key in ("rayleigh_fraction", "rolling_friction", "rolling_radius")},
        "seed": seed,
    }
    return with_values(test, values)


def with_values(test: Mapping[str, Any], values: Mapping[str, float]) -> dict[str, Any]:
    """Return a test with other values at dotted names, e.g. particle.contact.sliding_friction."""
    changed = copy.deepcopy(dict(test))
    for name, value in values.items():
        *sections, key = name.split(".")
        target = changed
        for section in sections:
            target = target[section]
        target[key] = value
    return changed


def calibrated(
    settings: Settings,
    materials: Mapping[str, Any],
    measured: Mapping[str, Measured],
    folder: Path,
    say: Callable[[str], None],
) -> Result:
    """Return the calibration; its simulations are kept in the folder and are not done again. Raises SolverError."""

    def simulate(requests: Sequence[Request]) -> list[dict[str, float]]:
        tests = [test_of(settings, materials, each.test, each.values, each.seed) for each in requests]
        parallel = settings["calibration"]["parallel"]
        return [answer(found) for found in simulate_all(tests, folder / SIMULATIONS, parallel, say)]

    return calibrate(problem_of(settings, measured), simulate, say)


def repeated(
    settings: Settings,
    materials: Mapping[str, Any],
    pairs: Mapping[str, Mapping[str, float]],
    folder: Path,
    say: Callable[[str], None],
) -> pd.DataFrame:
    """Return one row per pair, test and seed: the responses of pairs simulated with several seeds.

    pairs: {name: values of the calibrated parameters}. The seeds follow those of the calibration.
    """
    calibration = settings["calibration"]
    first = calibration["seed"] + 1000
    asked = [
        (name, kind, seed)
        for kind in calibration["tests"]
        for name in pairs
        for seed in range(first, first + calibration["repeats"])
    ]
    tests = [test_of(settings, materials, kind, pairs[name], seed) for name, kind, seed in asked]
    found = simulate_all(tests, folder / SIMULATIONS, calibration["parallel"], say)
    rows = [
        {"pair": name, "test": kind, "seed": seed, **pairs[name], **answer(each)}
        for (name, kind, seed), each in zip(asked, found, strict=True)
    ]
    return pd.DataFrame(rows)
