"""The comparison of a full bed with windows: means, their errors, costs, and what a second surface leaves alone."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.travelling_window import BEDS, BLOCK, FULL, at_source_size, comparison, results_page, with_other_surface

WINDOW = list(BEDS)[-1]
VALUES = {FULL: [1.0, 3.0], WINDOW: [2.0, 2.4]}  # J in each block


def tables(surface="plain"):
    work = [
        {"surface": surface, "bed": bed, "block": k + 1, "sliding_work_J": value}
        for bed, values in VALUES.items()
        for k, value in enumerate(values)
    ]
    names = {"bed_length_m": 2.0, "particles": 100.0, "bed_processor_s": 1.0}
    cost = [
        {"surface": surface, "bed": bed, **names, "particle_steps": steps, "processor_s": seconds}
        for bed, steps, seconds in ((FULL, 1000.0, 60.0), (WINDOW, 200.0, 15.0))
    ]
    return work, cost


def test_means_errors_and_costs_are_those_of_the_blocks():
    """Per metre; the standard error of two values is half their difference; ratios are against the full bed."""
    work, cost = map(pd.DataFrame, tables())
    table = comparison(work, cost).set_index("bed")
    assert list(table["sliding_work_J_per_m"] * BLOCK) == pytest.approx([2.0, 2.2])
    assert list(table["standard_error_J_per_m"] * BLOCK) == pytest.approx([1.0, 0.2])
    assert list(table["wear_over_full"]) == pytest.approx([1.0, 1.1])
    joint = np.hypot(1.0, 0.2)
    assert table["deviations_apart"][WINDOW] == pytest.approx(0.2 / joint)
    assert table["error_of_that"][WINDOW] == pytest.approx(joint / 2.0)
    assert table.loc[FULL, ["deviations_apart", "error_of_that"]].isna().all()
    assert list(table["cheaper_in_particle_steps"]) == [1.0, 5.0]
    assert list(table["cheaper_in_processor_time"]) == [1.0, 4.0]
    page = results_page(table.reset_index())
    assert "| plain | bed of 2 m | 20 | 10 | 2 | 1 |" in page and "window 100 + 50" in page


def test_rows_of_the_other_surface_stay(tmp_path):
    """A second run of one surface replaces its rows only."""
    file = tmp_path / "table.csv"
    with_other_surface(file, "plain", tables("plain")[0]).to_csv(file, index=False)
    both = with_other_surface(file, "convex", tables("convex")[0])
    both.to_csv(file, index=False)
    assert len(both) == 8
    assert with_other_surface(file, "plain", tables("plain")[0]).equals(
        pd.concat([both[4:], both[:4]], ignore_index=True)
    )


def test_the_shortest_window_is_five_times_shorter_than_the_sources_bed():
    """200 mm of sample, 100 + 50 of bed, 20 between exchanges, three particles and their skin."""
    rows = at_source_size().set_index("bed")
    length = 0.2 + 0.1 + 0.05 + 0.02 + 3 * 1.2 * 2.65e-3 + 0.2 * 0.8 * 2.65e-3
    assert rows["length_m"][WINDOW] == pytest.approx(length, rel=1e-9)
    assert rows["length_m"][FULL] == pytest.approx(2.0)
    assert rows["cheaper_in_particle_steps"][WINDOW] == pytest.approx(2.0 / length)
    assert rows["cheaper_in_particle_steps"][WINDOW] > 5.0
