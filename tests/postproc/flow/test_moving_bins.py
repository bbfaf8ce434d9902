"""Bins that travel with the sample, against flows in closed form."""

import tracemalloc

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.flow.moving_bins import (
    MovingBins,
    bin_history,
    joined,
    merged_bins,
    relative_velocity_history,
    surcharge_history,
    velocity_profile,
)
from bulkwear.postproc.readers.dump_text import ContactDumpError

BINS = MovingBins(width=0.08, length=0.08, side_width=0.02, layer_height=0.005, layers=4)
STEP = 1e-4  # m of travel per step
SIX_DIGITS = 2e-5  # relative: numbers in a dump have six digits
BED = 2.0  # m/s

# a lattice with every particle in the middle of its cell of 10 x 10 x 2.5 mm: means over bins are exact
LATTICE = np.stack(
    np.meshgrid(np.arange(-0.065, 0.07, 0.01), np.arange(-0.125, 0.13, 0.01), np.arange(0.00125, 0.02, 0.0025)), -1
).reshape(-1, 3)


def frame(step, places, velocity, spin):
    """Text of one frame as the deck's `dump bed` writes it."""
    table = np.column_stack([np.arange(1, len(places) + 1), places, velocity, spin, np.full(len(places), 0.001)])
    heading = "ITEM: ATOMS id x y z vx vy vz omegax omegay omegaz radius "
    box = "ITEM: BOX BOUNDS pp ff fm\n-0.35 0.35\n-0.35 0.35\n-0.008 0.05"
    rows = "\n".join(" ".join([str(int(row[0])), *(f"{value:.6g}" for value in row[1:])]) + " " for row in table)
    return f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{len(places)}\n{box}\n{heading}\n{rows}\n"


def write(path, flow, steps=(0,), places=LATTICE):
    """A dump with a frame per step of a flow: velocity (n, 3) and spin (n, 3) of places (n, 3) at a step."""
    path.write_text("".join(frame(step, places, *flow(places, step)) for step in steps))
    return [(path, 0.0)]


def shear(places, _step=0):
    """Shear flow: the bed passes with 2 m/s at the top, 0.4 m/s at the floor; particles roll with the shear."""
    speed = 0.4 + 80.0 * places[:, 2]
    zero = np.zeros(len(places))
    return np.column_stack([zero, speed, zero]), np.column_stack([np.full(len(places), -40.0), zero, zero])


def rotation(places, _step=0):
    """Rigid rotation about the vertical through (0.3, -0.1) at 3 rad/s."""
    x, y = places[:, 0] - 0.3, places[:, 1] + 0.1
    zero = np.zeros(len(places))
    return 3.0 * np.column_stack([-y, x, zero]), np.column_stack([zero, zero, zero + 3.0])


def spreading(places, _step=0):
    """Flow away from the middle plane, and upwards: vx = x, vz = 2 z."""
    return np.column_stack([places[:, 0], np.ones(len(places)), 2.0 * places[:, 2]]), np.zeros((len(places), 3))


def test_shear_flow(tmp_path):
    """Every layer has the flow's velocity at its middle; the relative velocity is its mean over the bed."""
    history = bin_history(write(tmp_path / "bed_0.dump", shear), BINS, STEP, 0.01)
    expected = 0.4 + 80.0 * history["height_m"]
    np.testing.assert_allclose(history["velocity_y_m_per_s"], expected, rtol=SIX_DIGITS)
    np.testing.assert_allclose(history["angular_velocity_x_rad_per_s"], -40.0, rtol=SIX_DIGITS)
    np.testing.assert_allclose(history["mean_angular_speed_rad_per_s"], 40.0, rtol=SIX_DIGITS)
    relative = relative_velocity_history(history, BED, 0.02)
    np.testing.assert_allclose(relative["relative_velocity"], 1.0 - (0.4 + 80.0 * 0.01) / BED, rtol=SIX_DIGITS)
    lower = relative_velocity_history(history, BED, 0.01)
    np.testing.assert_allclose(lower["relative_velocity"], 1.0 - (0.4 + 80.0 * 0.005) / BED, rtol=SIX_DIGITS)


def test_rigid_rotation(tmp_path):
    """Mean velocities are those at the middle of each zone; averaged angular velocity and mean angular speed are both
    that of the rotation. On the two sides of the sample it is no mirror image of itself, and cancels like vx.
    """
    history = bin_history(write(tmp_path / "bed_0.dump", rotation), BINS, STEP, 0.01)
    middles = {"central": (0.0, 0.0), "ahead": (0.0, -0.08), "behind": (0.0, 0.08)}
    for zone, (x, y) in middles.items():
        found = history[history["zone"] == zone]
        np.testing.assert_allclose(found["velocity_x_m_per_s"], -3.0 * (y + 0.1), rtol=SIX_DIGITS)
        np.testing.assert_allclose(found["velocity_y_m_per_s"], 3.0 * (x - 0.3), rtol=SIX_DIGITS)
    side = history[history["zone"] == "side"]
    np.testing.assert_allclose(side["velocity_x_m_per_s"], 0.0, atol=SIX_DIGITS)  # out on one side, in on the other
    np.testing.assert_allclose(history["mean_angular_speed_rad_per_s"], 3.0, rtol=SIX_DIGITS)
    averaged = velocity_profile(history, BED, 0.0, 0.01).set_index("zone")["averaged_angular_velocity_rad_per_s"]
    np.testing.assert_allclose(averaged.drop("side"), 3.0, rtol=SIX_DIGITS)
    np.testing.assert_allclose(averaged["side"], 0.0, atol=SIX_DIGITS)


def rolling_in(places, _step=0):
    """Particles that roll to the middle plane on both sides of it, mirror images of each other: spin along y."""
    zero = np.zeros(len(places))
    return np.zeros((len(places), 3)), np.column_stack([zero, -7.0 * np.sign(places[:, 0]), zero])


def test_mirror_images_add_up_beside_the_sample_and_cancel_over_it(tmp_path):
    """Side bins are one bin and its mirror image; the central bins are one bin, in which the two halves cancel."""
    history = bin_history(write(tmp_path / "bed_0.dump", rolling_in), BINS, STEP, 0.01)
    profile = velocity_profile(history, BED, 0.0, 0.01).set_index("zone")
    np.testing.assert_allclose(profile["mean_angular_speed_rad_per_s"], 7.0, rtol=SIX_DIGITS)
    averaged = profile["averaged_angular_velocity_rad_per_s"]
    np.testing.assert_allclose(averaged["side"], 7.0, rtol=SIX_DIGITS)
    np.testing.assert_allclose(averaged["central"], 0.0, atol=SIX_DIGITS)


def test_spins_in_all_directions_average_to_nothing(tmp_path):
    """Magnitude 5 rad/s about random axes: the mean speed is 5, the averaged vector falls with the root of the number
    of particles that it is averaged over, frames included.
    """
    generator = np.random.default_rng(20220317)

    def turning(places, _step):
        axes = generator.normal(size=places.shape)
        return np.zeros(places.shape), 5.0 * axes / np.linalg.norm(axes, axis=1, keepdims=True)

    history = bin_history(write(tmp_path / "bed.dump", turning, (25, 50, 75, 100)), BINS, STEP, 0.01)
    profile = velocity_profile(history, BED, 0.0, 0.01)
    np.testing.assert_allclose(profile["mean_angular_speed_rad_per_s"], 5.0, rtol=SIX_DIGITS)
    by_chance = 5.0 / np.sqrt(4 * profile["particles"])
    assert (profile["averaged_angular_velocity_rad_per_s"] < 3.0 * by_chance).all()  # 6e-6 of bins have more


def test_side_bins_count_outwards(tmp_path):
    """Flow away from the sample is positive on both sides, and cancels over the sample."""
    history = bin_history(write(tmp_path / "bed_0.dump", spreading), BINS, STEP, 0.01)
    profile = velocity_profile(history, BED, 0.0, 0.01).set_index(["zone", "layer"])
    np.testing.assert_allclose(profile.loc["side", "sideways_ratio"], 0.05 / (BED - 1.0), rtol=SIX_DIGITS)
    np.testing.assert_allclose(profile.loc["central", "sideways_ratio"], 0.0, atol=SIX_DIGITS)
    heights = profile.loc["central", "height_m"].to_numpy()
    np.testing.assert_allclose(profile.loc["central", "upward_ratio"], 2.0 * heights, rtol=SIX_DIGITS)


def test_particles_are_counted_once(tmp_path):
    """Zones hold the lattice's particles: 64 columns over the sample, 32 beside it, 2 to a layer; none twice."""
    history = bin_history(write(tmp_path / "bed_0.dump", shear), BINS, STEP, 0.01)
    counts = history.groupby("zone")["particles"].unique()
    assert counts.to_dict() == {"central": [128.0], "side": [64.0], "ahead": [128.0], "behind": [128.0]}
    surcharge = surcharge_history(history, 256.0)
    assert surcharge["surcharge"].tolist() == [2.0]


def test_averages_over_travel(tmp_path):
    """Frames of an interval are averaged: the mean over its frames of a flow that speeds up, frame by frame."""

    def speeding(places, step):
        velocity, spin = shear(places)
        return velocity * (1.0 + step / 100.0), spin

    history = bin_history(write(tmp_path / "bed.dump", speeding, (50, 100, 150, 200)), BINS, STEP, 0.01)
    assert history["frames"].unique().tolist() == [2]
    for start, factor in ((0.0, 1.75), (0.01, 2.75)):
        found = history[np.isclose(history["travel_start_m"], start)]
        expected = factor * (0.4 + 80.0 * found["height_m"])
        np.testing.assert_allclose(found["velocity_y_m_per_s"], expected, rtol=SIX_DIGITS)
        assert (found.loc[found["zone"] == "central", "particles"] == 128.0).all()
    profile = velocity_profile(history, BED, 0.0, 0.02)
    np.testing.assert_allclose(profile["velocity_m_per_s"], BED - 2.25 * (0.4 + 80.0 * profile["height_m"]), rtol=1e-4)


def test_one_file_or_many(tmp_path):
    """Frames in one file, in files of one frame with steps of their own, or in small blocks give the same table."""
    once = bin_history(write(tmp_path / "all.dump", shear, (0, 60, 120)), BINS, STEP, 0.01)
    files = [(write(tmp_path / f"bed_{k}.dump", shear)[0][0], k * 60 * STEP) for k in range(3)]
    pd.testing.assert_frame_equal(bin_history(files, BINS, STEP, 0.01), once, rtol=1e-12)
    small = bin_history([(tmp_path / "all.dump", 0.0)], BINS, STEP, 0.01, block_bytes=10_000)
    pd.testing.assert_frame_equal(small, once, rtol=1e-12)


def test_memory_does_not_grow_with_the_frames(tmp_path):
    """Four times as many frames of the same travel take no more memory: what is kept are the sums."""

    def peak(frames):
        dumps = write(tmp_path / f"{frames}.dump", shear, range(frames))
        tracemalloc.start()
        bin_history(dumps, BINS, STEP, 0.01, block_bytes=200_000)
        largest = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return largest

    peak(2)  # compiles
    assert peak(48) < 1.5 * peak(12)  # the blocks are as large; the rest is noise of the allocator


def test_empty_bins_have_no_velocity(tmp_path):
    """A layer without particles has a count of zero and no mean; what is above the layers is in none."""
    high = LATTICE[LATTICE[:, 2] > 0.015] + [0.0, 0.0, 0.005]
    history = bin_history(write(tmp_path / "bed.dump", shear, places=high), BINS, STEP, 0.01)
    assert (history["particles"] == 0.0).all()
    assert history["velocity_y_m_per_s"].isna().all()
    merged = merged_bins(history, ["zone"])
    assert merged["velocity_y_m_per_s"].isna().all()
    assert (merged["particles"] == 0.0).all()


@pytest.mark.parametrize(
    ("x", "y", "zone"),
    [
        (0.0, 0.0, 0),
        (0.0399, -0.0399, 0),
        (0.0401, 0.0, 1),
        (-0.0599, 0.0399, 1),
        (0.0601, 0.0, -1),
        (0.05, 0.0401, -1),
        (0.0, -0.0401, 2),
        (0.0, 0.0401, 3),
        (0.0, 0.1201, -1),
    ],
)
def test_zones(x, y, zone):
    """Central over the sample, side bins beside it, ahead against the bed's motion, behind with it."""
    assert BINS.zone(np.array([x]), np.array([y])).tolist() == [zone]


def test_faults_are_named(tmp_path):
    """A damaged dump, one without velocities and a window without data are refused, each in a sentence."""
    dump = write(tmp_path / "bed.dump", shear, places=LATTICE[:10])
    text = dump[0][0].read_text()
    dump[0][0].write_text(text[: len(text) // 2])
    with pytest.raises(ContactDumpError, match=r"bed\.dump, line"):
        bin_history(dump, BINS, STEP, 0.01)
    dump[0][0].write_text(text.replace(" vy ", " fy "))
    with pytest.raises(ValueError, match=r"bed\.dump, line 9: column vy is missing"):
        bin_history(dump, BINS, STEP, 0.01)
    dump[0][0].write_text(text)
    with pytest.raises(ValueError, match=r"no interval between 1 and 1\.7 m of travel"):
        velocity_profile(bin_history(dump, BINS, STEP, 0.01), BED, 1.0, 1.7)
    assert bin_history([], BINS, STEP, 0.01).empty


def test_cycles_are_joined(tmp_path):
    """Histories of two cycles that meet inside an interval are that of all their frames."""
    dumps = [(write(tmp_path / f"bed_{k}.dump", shear)[0][0], k * 50 * STEP) for k in range(5)]
    dumps[1] = (write(tmp_path / "bed_1.dump", rotation)[0][0], dumps[1][1])
    once = bin_history(dumps, BINS, STEP, 0.01)
    parts = [bin_history(dumps[:1], BINS, STEP, 0.01), bin_history(dumps[1:], BINS, STEP, 0.01)]
    pd.testing.assert_frame_equal(joined(parts), once, rtol=1e-12)
