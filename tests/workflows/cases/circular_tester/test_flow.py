"""Steadiness and flow of the circular wear tester per revolution."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.steady import DRIFTING, STEADY
from bulkwear.workflows.cases.circular_tester.flow import (
    LOG,
    MEAN_SPIN,
    SPIN,
    STEADINESS,
    lowest_layer,
    revolution_means,
    revolution_numbers,
    revolutions_over_packings,
    series_of,
    steady_revolutions,
)
from tests.support import tester_study as study


def test_variation_of_a_known_wave():
    """Eq 6.1: the deviation of whole waves over their mean is what they were made with, in every settled revolution."""
    table = revolution_means(study.series(settled_after=1e-3), ["velocity_m_per_s"])
    assert sorted(table["revolution"].unique()) == list(range(1, 11))
    later = table[table["revolution"] > 1]
    sample = np.sqrt(40 / 39)  # the deviation is that of a sample
    assert later["variation"].to_numpy() == pytest.approx(np.full(len(later), 0.05 * sample), rel=1e-6)
    plain = later[later["surface"] == "plain"]
    assert plain["mean"].to_numpy() == pytest.approx(np.full(len(plain), 0.52))
    assert (table["instants"] == 40).all()


def test_the_start_varies_more():
    """The transient is seen in the first revolution, as in Fig 6.7."""
    table = revolution_means(study.series(), list(STEADINESS))
    first = table[table["revolution"] == 1].set_index(["run", "measure"])["variation"]
    last = table[table["revolution"] == 10].set_index(["run", "measure"])["variation"]
    assert (first > 2.0 * last).all()


def test_an_instant_on_a_whole_revolution_begins_the_next():
    assert revolution_numbers(np.array([0.0, 0.999, 1.0, 2.0 - 1e-9, 2.5])).tolist() == [1, 1, 2, 3, 3]


def test_a_revolution_of_few_instants_is_left_out():
    series = study.series().query("revolution < 1.04")
    assert revolution_means(series, ["normal_force_N"])["revolution"].unique().tolist() == [1]


def test_steady_from():
    """Steady where the transient has died away, packing by packing; a flow that drifts on is not."""
    table = steady_revolutions(study.series(revolutions=12, packings=2)).set_index(["run", "measure"])
    assert set(table.index.get_level_values("run")) == {"plain", "convex", "plain-2", "convex-2"}
    assert table.loc[("plain", "all"), "answer"] == STEADY
    assert 0.5 < table.loc[("plain", "all"), "start_revolutions"] < 5.0
    drifting = study.series(revolutions=12)
    drifting["bed_height_m"] *= 1.0 + 0.05 * drifting["revolution"]
    table = steady_revolutions(drifting).set_index(["run", "measure"])
    assert table.loc[("plain", "bed_height_m"), "answer"] == DRIFTING
    assert np.isnan(table.loc[("plain", "all"), "start_revolutions"])
    with pytest.raises(ValueError, match="5 instants"):
        steady_revolutions(drifting.groupby("run").head(5))


def test_means_over_packings():
    """A hundredth more in the second packing is half of that in the mean; of one packing there is no interval."""
    one, two = (
        revolutions_over_packings(revolution_means(study.series(packings=n), ["normal_force_N"]), "mean")
        for n in (1, 2)
    )
    keys = ["surface", "revolution"]
    one, two = one.set_index(keys), two.set_index(keys)
    assert (two["mean"] / one["mean"]).to_numpy() == pytest.approx(np.full(len(one), 1.005))
    assert one["interval_low"].isna().all() and (two["interval_low"] < two["mean"]).all()
    assert (two["packings"] == 2).all()


def written_log(path, *pieces):
    """A log of runs of the solver, each from its set-up row on: (first step, steps after it)."""
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = []
    for first, steps in pieces:
        lines += ["Step sample_v sample_h", *(f"{step} 0.{step} 0.1" for step in (first, *steps)), "Loop time of 1"]
    path.write_text("\n".join(lines) + "\n")


@pytest.mark.parametrize("pieces", [[(0, (50, 100, 150, 200))], [(0, (50, 100)), (100, ()), (100, (150, 200))]])
def test_a_run_in_of_several_pieces_is_there_from_its_start(tmp_path, pieces):
    """After two revolutions of the bed, half a revolution each row, whether the solver went through or began again."""
    run = SimpleNamespace(folder=tmp_path / "plain", bed_folder=tmp_path / "bed", name="plain", surface="plain")
    run.packing, run.revolution_steps, run.bed_revolution_steps, run.revolution_s = 1, 100, 100, 1.0
    run.bed_revolutions, run.before = 2.0, 4.0
    written_log(run.bed_folder / LOG, (0, (300,)), (300, (400, 500)))
    written_log(run.folder / "cycle_000" / LOG, *pieces)
    cycle = run.folder / "cycle_001"
    cycle.mkdir()
    row = {"revolution": [0.5], "velocity_over_m_per_s": 0.4, "height_over_m": 0.1}
    pd.DataFrame(row).to_csv(cycle / "forces.csv", index=False)
    row = {"time_s": [1.0], "worn_volume_m3": 1e-9, "mean_normal_force_N": 1.0}
    pd.DataFrame(row).to_csv(cycle / "wear_history.csv", index=False)
    row = {"revolution": [0.5], "velocity_m_per_s": 0.4}
    spins = {"averaged_angular_velocity_rad_per_s": 1.0, "mean_angular_speed_rad_per_s": 1.0}
    pd.DataFrame(row | spins).to_csv(cycle / "lowest_layer.csv", index=False)
    table = series_of(run).dropna(subset="velocity_m_per_s")
    assert table["revolution"].tolist() == [1.0, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5]
    assert table["velocity_m_per_s"].tolist() == [0.4, 0.5, 0.5, 0.1, 0.15, 0.2, 0.4]


def test_tables_of_the_layer_that_averaged_otherwise_are_refused(tmp_path):
    """Both ways of averaging are read; a table with one of them alone names its column and what to remove."""
    table = pd.DataFrame({"revolution": [0.5], "velocity_m_per_s": [0.2], "averaged_angular_velocity_rad_per_s": [1.0]})
    (tmp_path / "cycle_001").mkdir()
    file = tmp_path / "cycle_001" / "lowest_layer.csv"
    table.assign(mean_angular_speed_rad_per_s=3.0).to_csv(file, index=False)
    assert lowest_layer(tmp_path)[[SPIN, MEAN_SPIN]].to_numpy().tolist() == [[1.0, 3.0]]
    table.to_csv(file, index=False)
    with pytest.raises(ValueError, match=r"lowest_layer.csv has no column mean_angular_speed_rad_per_s.*remove these"):
        lowest_layer(tmp_path)
