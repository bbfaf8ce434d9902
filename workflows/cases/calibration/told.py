"""What a calibration says in words of the parameters that no measured response tells: their values are assumptions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from bulkwear.postproc.flow.bulk_test import RESPONSES
from bulkwear.postproc.inference.loop import Posterior
from bulkwear.postproc.inference.problem import Problem
from bulkwear.postproc.inference.told import LEFT, NOT_TOLD, TOGETHER, told_table
from bulkwear.workflows.cases.calibration.boxes import WALL_SHEAR
from bulkwear.workflows.cases.calibration.responses import PARAMETER_NAMES, parameter_name

WALL_FRICTION = "wall_material.contact.sliding_friction"


def told_sentences(problem: Problem, known: Posterior) -> list[str]:
    """Return what is to be said of the parameters that are not told, and of those that are not looked for."""
    said = [_sentence(row) for row in told_table(problem, known).itertuples() if row.told in (NOT_TOLD, TOGETHER)]
    return [*said, *_not_looked_for(problem.names), *_wall_friction(problem)]


def _sentence(row: Any) -> str:
    """Return what is to be said of a parameter of `told_table` that is not told, or not alone."""
    name, left, alone = _words(row.parameter), f"{row.left:.0%}", f"{row.left_others_known:.0%}"
    if row.told == NOT_TOLD:
        return (
            f"{name} is not told by any response that was measured: {left} of its range is left, {alone} where all"
            f" others are known (told: at most {LEFT:.0%}). Its value is an assumption."
        )
    return (
        f"{name} is told only together with the others: alone {left} of its range is left, where they are known"
        f" {alone}. Its value holds with theirs."
    )


def _words(parameter: str) -> str:
    return parameter_name(parameter).removesuffix(" (-)")


def _not_looked_for(names: Sequence[str]) -> list[str]:
    """Return the sentence about parameters that keep the value of the materials file."""
    others = "; ".join(_words(name).lower() for name in PARAMETER_NAMES if name not in names)
    return (
        [f"Not looked for, so their values, those of the materials file, are assumptions: {others}."] if others else []
    )


def _wall_friction(problem: Problem) -> list[str]:
    """Return what would tell the friction that sliding wear rests on, where nothing measured does."""
    (response,) = RESPONSES[WALL_SHEAR]
    simulated = any(test.name == WALL_SHEAR for test in problem.tests)
    if WALL_FRICTION in problem.names and simulated and response in problem.measured:
        return []
    return [
        "Sliding wear rests on the sliding friction between particles and wall, and no response measured here is made"
        f" to tell it. A wall shear test is: {response} in the table of measured responses, {WALL_SHEAR} among"
        f" calibration.tests, {WALL_FRICTION} among calibration.parameters."
    ]
