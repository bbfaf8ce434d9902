"""A solver whose torque of `rvd` no time step ends: what is changed of ours, and which runs stand in the table."""

import pandas as pd
import pytest

from benchmarks.constant_torque import CHANGED, FILE, FRACTIONS, FUNCTION, KEYS, PROGRAM, asked_for, changed_source
from bulkwear.workflows.engine.project import PACKAGE


def function():
    return (PACKAGE / "benchmarks" / "solver_programs" / PROGRAM).read_text()


def test_one_function_of_the_solver_is_another_and_no_more():
    """Its text stands in place of ours; lines before and behind stay."""
    source = (PACKAGE / "solver" / CHANGED).read_text()
    changed = changed_source(source, function())
    start = source.index(FUNCTION)
    assert changed[:start] == source[:start] and changed.count(FUNCTION) == 1
    assert "least_energy_share(free)" not in changed[start : changed.index("}\n\n", start)]
    assert changed.endswith(source[source.index("// Returns the sum of squares of the largest torques") :])


def test_a_solver_without_that_function_is_refused():
    with pytest.raises(ValueError, match=r"found void FixTurningFriction::act.* 0 times, allowed is once"):
        changed_source("int main() {\n}\n", function())


def test_the_table_has_the_runs_that_are_asked_for(tmp_path):
    """The shortest steps are the source's 5e-6 s."""
    every = list(asked_for(list(FRACTIONS), None, tmp_path))
    asked = {(case.scale, fraction, case.surface, case.seed) for case, fraction, _ in every}
    table = pd.read_csv(PACKAGE / "docs" / FILE)
    assert asked == set(table[KEYS].itertuples(index=False, name=None))
    shortest = min(chain.parameters["derived"]["largest_time_step_s"] for case, _, chain in every if case.scale == 8)
    assert shortest == pytest.approx(5e-6, rel=1e-3)
