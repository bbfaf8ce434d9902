"""Times of the runs of a deck, as LIGGGHTS 3.8.0 prints them."""

import numpy as np

from bulkwear.postproc.readers.solver_log import run_times

LOG = """\
Loop time of 0.25 on 1 procs for 300 steps with 18148 atoms, finish time Fri Nov 20 19:46:39 2026


Pair  time (%) = 0.313413 (50.1117)
Neigh time (%) = 0.0288474 (4.61241)
Total # of neighbors = 35757
Neighbor list builds = 4
Dangerous builds = 0
run             40 pre no post no
Loop time of 9.5 on 1 procs for 40 steps with 18148 atoms, finish time Fri Nov 20 19:46:40 2026
run             5
Loop time of 0.125 on 1 procs for 5 steps with 9634 atoms, finish time Fri Nov 20 19:46:41 2026
Neigh time (%) = 0 (0)
Neighbor list builds = 0
"""


def test_runs_with_times_in_order(tmp_path):
    """Each run has its own times; one that was told to print none is left out and gets none of its neighbour's."""
    (tmp_path / "log").write_text(LOG)
    found = run_times(tmp_path / "log")
    expected = {
        "loop_s": [0.25, 0.125],
        "neighbour_s": [0.0288474, 0.0],
        "steps": [300, 5],
        "particles": [18148, 9634],
        "builds": [4, 0],
    }
    assert {name: list(column) for name, column in found.items()} == expected


def test_a_log_without_a_finished_run(tmp_path):
    """Nothing finished, nothing told: columns without rows."""
    (tmp_path / "log").write_text("Step Atoms\n0 1\n")
    assert all(np.shape(column) == (0,) for column in run_times(tmp_path / "log").values())
