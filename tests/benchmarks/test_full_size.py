"""The full size in small: the solver's files are what each step of Python reads, and every step runs."""

import pytest

from benchmarks.full_size import (
    LEDGER,
    RESTART,
    SNAPSHOT,
    STEPS_OF_PYTHON,
    Size,
    simulated,
    with_sheets,
)
from bulkwear.postproc.flow.bed import read_snapshot
from bulkwear.postproc.readers.load_ledger import read_load_ledger
from bulkwear.postproc.readers.restart_file import read_restart

SIZE = Size(side=6, cells=24)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("full_size")
    assert simulated(place, SIZE) > 0.0
    with_sheets(place, SIZE.cells)
    return place


def test_the_solver_leaves_a_lattice_that_presses_on_its_floor(folder):
    """As many particles as asked for in snapshot and restart file, as many triangles in the ledger, and a load."""
    assert len(read_snapshot(folder / SNAPSHOT)) == read_restart(folder / RESTART).particles == SIZE.side**3
    ledger = read_load_ledger(folder / LEDGER)
    assert ledger.triangles == 2 * SIZE.cells**2
    assert ledger.columns["normal_impulse_N_s"].sum() > 0.0


@pytest.mark.parametrize("name", STEPS_OF_PYTHON)
def test_every_step_runs(folder, name):
    STEPS_OF_PYTHON[name](folder)
