"""The flow over every run of a study, from snapshots of a flow that is known."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.flow.moving_bins import bin_history
from bulkwear.postproc.statistics.steady import UNSAID
from bulkwear.workflows.cases.sliding_sample import charts
from bulkwear.workflows.cases.sliding_sample.flow_history import (
    INTERVAL,
    RunFlow,
    flow_tables,
    published_window,
    reduce_snapshots,
    row_profiles,
    run_bins,
    settled_value,
    spin_profiles,
    study_regimes,
    undisturbed_particles,
)
from tests import REPOSITORY

RUN = RunFlow(
    width=0.04,
    length=0.04,
    bed_width=0.08,
    bed_length=0.16,
    bed_thickness=0.01,
    velocity=2.0,
    time_step=1e-5,
    particle_scale=1.0,
)
ROUND_OFF = 1e-12  # relative: the same sums in another order
SIX_DIGITS = 2e-5  # relative: numbers in a dump have six digits
LATTICE = np.stack(
    np.meshgrid(np.arange(-0.0375, 0.04, 0.005), np.arange(-0.0775, 0.08, 0.005), np.arange(0.00125, 0.01, 0.0025)), -1
).reshape(-1, 3)


def write_snapshot(path, step, speed):
    """A snapshot of a bed that passes with one speed."""
    rows = [f"{k} {x:g} {y:g} {z:g} 0 {speed:g} 0 1 2 2 0.001" for k, (x, y, z) in enumerate(LATTICE, 1)]
    heading = "ITEM: ATOMS id x y z vx vy vz omegax omegay omegaz radius"
    head = f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{len(rows)}\nITEM: BOX BOUNDS pp ff fm\n0 1\n0 1\n0 1\n"
    path.write_text("\n".join([head + heading, *rows, ""]))


def write_run(folder, speeds):
    """A run of cycles of 20 mm, each with a snapshot in its middle and one at its end."""
    for cycle, speed in enumerate(speeds, 1):
        where = folder / f"cycle_{cycle:03d}"
        where.mkdir(parents=True)
        for step in (600, 1000):
            write_snapshot(where / f"bed_{step}.dump", step, speed)
        write_snapshot(where / "bed_0.dump", 0, 9.0)  # the last one of the cycle before, counted there
        for path in reduce_snapshots(where, RUN, 0.02 * (cycle - 1)):
            path.unlink()
        (where / "bed_0.dump").unlink()
    folder.mkdir(exist_ok=True)
    pd.DataFrame({"particles": [len(LATTICE)]}).to_csv(folder / "cost.csv", index=False)
    return folder


def test_cycles_follow_each_other(tmp_path):
    """Steps count from the start of each cycle; intervals go on over the travel, each with its own velocity."""
    bins = run_bins(write_run(tmp_path / "run", [2.0, 1.0, 0.5]), RUN)
    middle = bins[(bins["zone"] == "central") & (bins["layer"] == 1)]
    np.testing.assert_allclose(middle["travel_start_m"], [0.01, 0.03, 0.05])
    np.testing.assert_allclose(middle["velocity_y_m_per_s"], [2.0, 1.0, 0.5], rtol=SIX_DIGITS)
    assert bins["frames"].unique().tolist() == [2]


def test_a_cycle_keeps_its_bins_and_its_last_snapshot(tmp_path):
    """Reduced to bins, a cycle tells the same flow as all its snapshots together, and keeps one of them."""
    folder = write_run(tmp_path / "run", [2.0, 1.0])
    whole = tmp_path / "snapshots"
    whole.mkdir()
    dumps = []
    for cycle, speed in enumerate((2.0, 1.0)):
        for step in (600, 1000):
            dumps.append((whole / f"bed_{cycle}{step}.dump", 0.02 * cycle))
            write_snapshot(dumps[-1][0], step, speed)
    expected = bin_history(dumps, RUN.bins, RUN.velocity * RUN.time_step, INTERVAL)
    pd.testing.assert_frame_equal(run_bins(folder, RUN)[expected.columns], expected, rtol=ROUND_OFF)
    assert [path.name for path in sorted(folder.glob("cycle_*/bed_*.dump"))] == ["bed_1000.dump"] * 2


def test_a_cycle_keeps_the_spin_along_its_sample(tmp_path):
    """Every piece of the lowest layer has the spin of (1, 2, 2) rad/s, from all snapshots after the start."""
    folder = write_run(tmp_path / "R1_convex", [2.0, 1.0])
    table = spin_profiles({"R1_convex": folder}, {"R1_convex": RUN}, {"R1_convex": 0.02})
    assert table["along_m"].tolist() == pytest.approx([0.0025 + 0.005 * k for k in range(8)])
    for name in ("averaged_angular_velocity_rad_per_s", "mean_angular_speed_rad_per_s"):
        np.testing.assert_allclose(table[name], 3.0, rtol=SIX_DIGITS)
    whole = spin_profiles({"R1_convex": folder}, {"R1_convex": RUN}, {"R1_convex": 0.0})
    assert whole["particles"].sum() == 4 * 2 * 8 * 8  # four frames, two sheets of the lattice, 40 x 40 mm
    assert table["particles"].sum() == 0.5 * whole["particles"].sum()


def test_a_run_without_spins_is_named(tmp_path):
    """A cycle that was simulated before spins were kept has none; its path and what to remove are said."""
    folder = write_run(tmp_path / "R1_convex", [2.0])
    (folder / "cycle_001" / "spin.parquet").unlink()
    with pytest.raises(FileNotFoundError, match=r"no cycle_\*/spin.parquet found"):
        spin_profiles({"R1_convex": folder}, {"R1_convex": RUN}, {"R1_convex": 0.0})


def test_bins_of_another_definition_are_not_taken(tmp_path):
    """Snapshots are gone, so bins made for layers of another height cannot be made anew: they are refused by name."""
    folder = write_run(tmp_path / "run", [2.0])
    with pytest.raises(ValueError, match=r"cycle_001/flow.parquet: its bins are not those asked for now.*layer_height"):
        run_bins(folder, replace(RUN, particle_scale=2.0))


def test_a_cycle_without_snapshots_is_named(tmp_path):
    """A cycle whose solver wrote no snapshot has no flow to tell of."""
    with pytest.raises(FileNotFoundError, match=r"no bed_<step>.dump found"):
        reduce_snapshots(tmp_path, RUN, 0.0)


def test_a_run_without_snapshots_is_named(tmp_path):
    """Without a snapshot there is no flow to tell of."""
    folder = write_run(tmp_path / "run", [])
    with pytest.raises(FileNotFoundError, match=r"run: no cycle_\*/flow.parquet found"):
        run_bins(folder, RUN)


def test_tables_of_a_study(tmp_path):
    """Regimes follow from velocity and heap: a bed that passes flows, one that rides along level is undecided."""
    speeds = {"R1_convex": [1.0] * 8, "R1_plain": [0.02] * 8}
    folders = {run: write_run(tmp_path / run, values) for run, values in speeds.items()}
    names = pd.DataFrame({"run": list(speeds), "row": "R1", "surface": ["convex", "plain"]})
    bins, along, regimes = flow_tables(folders, dict.fromkeys(speeds, RUN), names)
    assert regimes["regime"].tolist() == ["continuous", "undecided"]
    assert regimes["steady"].tolist() == [True, True]
    np.testing.assert_allclose(regimes["relative_velocity"], [0.5, 0.99], rtol=SIX_DIGITS)
    np.testing.assert_allclose(regimes["surcharge"], 1.0)  # as many particles over the sample as anywhere
    np.testing.assert_allclose(along.loc[along["run"] == "R1_convex", "relative_velocity_percent"], 50.0, rtol=1e-4)
    assert along["travel_mm"].max() == pytest.approx(155.0)
    assert charts.RELATIVE_VELOCITY.columns() <= set(along)
    assert set(bins["run"]) == set(speeds)
    profiles = row_profiles(bins, along, dict.fromkeys(speeds, RUN.velocity), ["R1"])
    plain = profiles[(profiles["surface"] == "plain") & (profiles["zone"] == "central")]
    np.testing.assert_allclose(plain["velocity_m_per_s"], 1.98, rtol=SIX_DIGITS)  # 2 m/s less that of the bed, 0.02
    spin = np.degrees(3.0)  # of (1, 2, 2) rad/s
    np.testing.assert_allclose(plain["averaged_angular_velocity_deg_per_s"], spin, rtol=SIX_DIGITS)
    assert plain["height_mm"].tolist() == [2.5, 7.5]
    assert plain["window_end_mm"].unique().tolist() == pytest.approx([160.0])


def test_the_undisturbed_bed_of_a_window_is_its_packing(tmp_path):
    """Particles come and go in a window; how many lie on a piece of undisturbed bed follows from its packing."""
    folder = write_run(tmp_path / "run", [1.0])
    pd.DataFrame({"particles": [2 * len(LATTICE)]}).to_csv(folder / "cost.csv", index=False)
    assert undisturbed_particles(folder) == 2 * len(LATTICE)
    (folder / "cycle_000").mkdir()
    write_snapshot(folder / "cycle_000" / "packing.dump", 0, 0.0)
    assert undisturbed_particles(folder) == len(LATTICE)


def test_few_values_are_not_called_steady():
    """Of fewer values than a steady window needs there is a mean, and no claim."""
    assert settled_value(np.arange(3.0), np.array([1.0, 2.0, 3.0])) == (2.0, UNSAID)
    value, answer = settled_value(np.arange(3.0), np.full(3, np.nan))
    assert np.isnan(value)
    assert answer == UNSAID


def test_riding_along_in_a_heap_is_discontinuous():
    """A steady relative velocity near 1 with twice the particles over the sample."""
    table = pd.DataFrame({"travel_m": np.arange(10) * 0.01, "relative_velocity": 0.97, "surcharge": 2.0})
    assert study_regimes({"R2_convex": table})["regime"].tolist() == ["discontinuous"]


def test_bins_end_where_the_bed_does():
    """Side bins are a quarter of the sample wide where the bed has room, layers as high as the particles are large."""
    assert RUN.bins.side_width == pytest.approx(0.01)
    narrow = RunFlow(0.08, 0.08, 0.1, 0.2, 0.04, 1.0, 1e-5, 2.0).bins
    assert narrow.side_width == pytest.approx(0.01)
    assert narrow.layer_height == pytest.approx(0.01)
    assert narrow.layers == 12


def test_published_window_counts_from_the_run_in():
    """The source's 1000 to 1700 mm count from the start; a study's travel starts after its run-in."""
    published = pd.read_csv(REPOSITORY / "config/published/screening_results.csv")
    assert published_window(published, 300.0) == (700.0, 1400.0)
    sizes = pd.read_csv(REPOSITORY / "config/published/particle_size_results.csv")  # one window for flow and wear
    assert published_window(sizes, 500.0) == (200.0, 1200.0)
