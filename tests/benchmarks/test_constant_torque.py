"""The table of a solver whose torque of `rvd` no time step ends: which runs stand in it."""

import pandas as pd
import pytest

from benchmarks.constant_torque import CHANGE, FILE, FRACTIONS, KEYS, asked_for
from bulkwear.workflows.engine.project import PACKAGE


def test_no_step_ends_the_torque():
    """The changed function does not ask what ends within the step, as ours does."""
    source = (PACKAGE / "solver" / CHANGE.changed).read_text()
    ours, asks = source[source.index(CHANGE.function) :].split("\n}\n")[0], "least_energy_share("
    assert asks in ours and asks not in CHANGE.text()


def test_the_table_has_the_runs_that_are_asked_for(tmp_path):
    """The shortest steps are the source's 5e-6 s."""
    every = list(asked_for(list(FRACTIONS), None, tmp_path))
    asked = {(case.scale, fraction, case.surface, case.seed) for case, fraction, _ in every}
    table = pd.read_csv(PACKAGE / "docs" / FILE)
    assert asked == set(table[KEYS].itertuples(index=False, name=None))
    shortest = min(chain.parameters["derived"]["largest_time_step_s"] for case, _, chain in every if case.scale == 8)
    assert shortest == pytest.approx(5e-6, rel=1e-3)
