"""A calibration says which of its parameters the measured responses tell."""

import pandas as pd
import pytest

from bulkwear.postproc.inference.loop import posterior
from bulkwear.postproc.inference.problem import Experiment, Measured, Parameter, Problem
from bulkwear.postproc.inference.told import LEFT, NOT_TOLD, TOGETHER, TOLD, told_table

NAMES = ["sliding", "rolling", "wall"]
RESPONSES = {"sum": (1.0, 1.0, 0.0), "wall_friction": (0.0, 0.0, 1.0), "difference": (1.0, -1.0, 0.0)}  # gradients
TRUTH = (0.5, 0.4, 0.6)
DEVIATION = 0.03  # of every response, whose ranges are 1 and 2


def told(*measured):
    """The table of a calibration on some of the responses, linear in three parameters from 0 to 1."""
    aims = {
        name: Measured(sum(g * t for g, t in zip(RESPONSES[name], TRUTH, strict=True)), DEVIATION, 0.0)
        for name in measured
    }
    tests = (Experiment("test", tuple(RESPONSES), 4, 9),)
    problem = Problem(tuple(Parameter(name, 0.0, 1.0) for name in NAMES), tests, aims, seed=3)
    table = pd.DataFrame(problem.spread_points(5), columns=NAMES)
    for name, gradient in RESPONSES.items():
        table[name], table[f"{name}_uncertainty"] = table[NAMES] @ list(gradient), 1e-3
    return told_table(problem, posterior(problem, table)).set_index("parameter")


@pytest.mark.parametrize(
    ("measured", "expected"),
    [
        (("sum",), (TOGETHER, TOGETHER, NOT_TOLD)),
        (("sum", "wall_friction"), (TOGETHER, TOGETHER, TOLD)),
        (("sum", "difference"), (TOLD, TOLD, NOT_TOLD)),
        (("sum", "difference", "wall_friction"), (TOLD, TOLD, TOLD)),
    ],
)
def test_a_parameter_is_told_by_a_response_that_depends_on_it(measured, expected):
    """A sum tells its parts together, a sum and a difference tell each, and what no response depends on stays open."""
    table = told(*measured)
    assert tuple(table["told"]) == expected
    alone = table["left_others_known"]
    assert (alone[table["told"] != NOT_TOLD] < 0.3).all()  # four deviations of 0.03, the surrogate's doubt beside
    assert (table.loc[table["told"] == NOT_TOLD, ["left", "left_others_known"]] > LEFT).all(axis=None)
