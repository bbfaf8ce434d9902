"""The simulations of `benchmarks.rolling_models`: pairs of frictions that the source simulated, in its tests, under
each rolling model."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import pandas as pd

from bulkwear.postproc.flow.bulk_test import RESPONSES
from bulkwear.postproc.inference.loop import packing_seed
from bulkwear.workflows.cases.calibration.boxes import DRAW_DOWN, SHEAR_BOX, WALL_SHEAR, test_of
from bulkwear.workflows.cases.calibration.case import pairs_file
from bulkwear.workflows.cases.calibration.driver import FIRST_REPEAT, pair_of
from bulkwear.workflows.config.design import Study, load_study
from bulkwear.workflows.report.sentences import listed

MODELS = ("cdt", "epsd2", "own_spin", "rvd")  # of docs/rolling_friction.md
# A slope under the constant torque of `cdt` creeps, the faster the larger the time step (docs/calibration.md).
SETTINGS = {model: {"rolling_friction": model} for model in MODELS} | {
    "cdt": {"rolling_friction": "cdt", "rayleigh_fraction": 0.1}
}
FIDELITY = "standard"  # the largest particles that the slot lets pass
KINDS, CALIBRATED = (SHEAR_BOX, DRAW_DOWN, WALL_SHEAR), "calibrated"  # the pair of Table 3.6
PLATE = "plate_sliding_friction"  # column, the coefficient (-) of particles and plate of a wall shear test


def study_of(model: str, fidelity: str = FIDELITY) -> Study:
    """Return the calibration under a rolling model."""
    return load_study("calibration", overrides={"fidelity": fidelity, "solver": dict(SETTINGS[model])})


def time_steps_said(fidelity: str = FIDELITY) -> str:
    """Return in a sentence which fraction of the Rayleigh time each model has."""
    fractions = {model: study_of(model, fidelity).settings["solver"]["rayleigh_fraction"] for model in MODELS}
    ((usual, _),) = Counter(fractions.values()).most_common(1)
    others = [f"`{model}` has {fraction:g}" for model, fraction in fractions.items() if fraction != usual]
    return f"{listed(others)} of the Rayleigh time, the others {usual:g}."


def wanted(
    packings: int, models: Sequence[str] = MODELS, kinds: Sequence[str] = KINDS, pairs: Sequence[str] = ()
) -> list[dict[str, Any]]:
    """Return what is to be simulated: model, test, pair, packing, frictions, of a wall shear test the plate's too;
    `asked` is the test itself.

    kinds: the tests; pairs: rows of the published table, all where none is named

    In an order in which models stand beside one another early: a packing of all before the next, the calibrated pair in
    all tests before the other pairs, a pair under all models before the next pair.
    """
    rows = []
    studies = {model: study_of(model) for model in MODELS if model in models}
    published = pd.read_csv(pairs_file(next(iter(studies.values()))))
    asked = [
        (packing, kind, pair)
        for packing in range(packings)
        for kind in kinds
        for pair in pairs_of(published, kind)
        if not pairs or pair in pairs
    ]
    asked.sort(key=lambda each: (each[0], each[2] != CALIBRATED))
    for packing, kind, pair in asked:
        for model, study in studies.items():
            run = study.all_runs[0].parameters
            names = [each["name"] for each in run["calibration"]["parameters"]]
            seed = packing_seed(run["calibration"]["seed"], FIRST_REPEAT + packing)
            values = pair_of(published, pair, names, run)
            told = {name.rpartition(".")[2]: value for name, value in values.items()}
            asked_test = test_of(run, kind, values, seed)
            if kind == WALL_SHEAR:
                told[PLATE] = asked_test["wall_material"]["contact"]["sliding_friction"]
            rows.append(
                {"model": model, "test": kind, "pair": pair, "packing": packing + 1, **told, "asked": asked_test}
            )
    return rows


def pairs_of(published: pd.DataFrame, kind: str) -> list[str]:
    """Return the pairs of which the source prints a response of a test, its calibrated one first; that one alone where
    it prints none.
    """
    names = [name for name in RESPONSES[kind] if name in published]
    found = published.loc[published[names].notna().any(axis=1), "row"]
    return sorted(found, key=lambda pair: pair != CALIBRATED) or [CALIBRATED]
