"""How particles turn along the sample: every particle in its piece, every interval in its mean."""

import numpy as np
import pytest

from bulkwear.postproc.flow.spin import Segments, mean_spin, spin_along_sample

SEGMENTS = Segments(width=0.02, length=0.04, layer_height=0.01)  # four pieces
HEADING = "id x y z vx vy vz omegax omegay omegaz radius"
PRINTED = 1e-5  # relative, of six digits


def write_dump(path, frames):
    """frames: {step: rows of (x, y, z, omegax, omegay, omegaz)}"""
    parts = []
    for step, rows in frames.items():
        lines = [
            f"{k + 1} {x:g} {y:g} {z:g} 0 0 0 {a:g} {b:g} {c:g} 0.001" for k, (x, y, z, a, b, c) in enumerate(rows)
        ]
        bounds = "ITEM: BOX BOUNDS pp ff ff\n-1 1\n-1 1\n-1 1\n"
        parts.append(
            f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{len(lines)}\n{bounds}ITEM: ATOMS {HEADING} \n"
            + "".join(f"{line}\n" for line in lines)
        )
    path.write_text("".join(parts))
    return path


def test_pieces_run_from_the_front_and_end_with_the_sample():
    """The bed comes from -y: piece 1 is there. Above the layer, below the floor and beside the sample is outside."""
    places = SEGMENTS.place(
        np.array([0.0, 0.0, 0.0, 0.011, 0.0, 0.0, 0.0]),
        np.array([-0.0199, 0.0199, 0.0, 0.0, 0.021, 0.0, 0.0]),
        np.array([0.005, 0.005, 0.005, 0.005, 0.005, 0.0101, -0.001]),
    )
    assert list(places) == [0, 3, 2, -1, -1, -1, -1]


@pytest.mark.parametrize(("height", "count"), [(0.005, 40), (0.02, 10), (0.04, 5), (0.03, 7), (1.0, 1)])
def test_pieces_grow_with_the_layer(height, count):
    """As long as the layer is high, as nearly as whole pieces fill the sample."""
    assert Segments(0.2, 0.2, height).count == count


def test_means_are_over_particles_and_their_pieces(tmp_path):
    """Components and magnitudes of spin, averaged within a piece; an empty piece has none."""
    rows = [
        (0.0, -0.015, 0.002, 3.0, 4.0, 0.0),  # 5 rad/s, piece 1
        (0.005, -0.012, 0.004, 0.0, 0.0, -7.0),  # 7 rad/s, piece 1
        (0.0, 0.015, 0.004, 2.0, 0.0, 0.0),  # piece 4
        (0.0, 0.015, 0.014, 99.0, 0.0, 0.0),  # second layer
    ]
    dump = write_dump(tmp_path / "bed_10.dump", {10: rows})
    table = spin_along_sample([(dump, 0.0)], SEGMENTS, 1e-3, 0.01)
    means = {"mean_angular_speed_rad_per_s": [6.0, -1.0, -1.0, 2.0], "angular_velocity_x_rad_per_s": [1.5, -1, -1, 2]}
    means["angular_velocity_z_rad_per_s"] = [-3.5, -1.0, -1.0, 0.0]
    for name, expected in means.items():
        assert list(table[name].fillna(-1.0)) == pytest.approx(expected, rel=PRINTED)
    assert list(table["particles"]) == [2.0, 0.0, 0.0, 1.0]
    assert list(table["along_m"]) == pytest.approx([0.005, 0.015, 0.025, 0.035])
    assert set(table["travel_end_m"]) == {0.01}


def test_intervals_and_start_of_the_mean(tmp_path):
    """Frames fall into intervals of travel, dumps of later cycles further on; the mean leaves out what is before.

    Components are averaged over all of them first: what turns to and fro has a mean speed and no averaged velocity.
    """
    one = [(0.0, -0.015, 0.002, -12.0, 0.0, 0.0)]
    two = [(0.0, -0.015, 0.002, 4.0, 0.0, 0.0), (0.0, -0.011, 0.002, 6.0, 0.0, 0.0)]
    first = write_dump(tmp_path / "a.dump", {5: one, 10: two})
    second = write_dump(tmp_path / "b.dump", {10: [(0.0, -0.015, 0.002, 10.0, 0.0, 0.0)]})
    table = spin_along_sample([(first, 0.0), (second, 0.01)], SEGMENTS, 1e-3, 0.01)
    assert sorted(set(table["travel_end_m"])) == pytest.approx([0.01, 0.02])
    both = ["averaged_angular_velocity_rad_per_s", "mean_angular_speed_rad_per_s"]
    assert list(mean_spin(table, 0.0)[both].iloc[0]) == pytest.approx([(-12 + 4 + 6 + 10) / 4, 8.0], rel=PRINTED)
    assert list(mean_spin(table, 0.01)[both].iloc[0]) == pytest.approx([10.0, 10.0], rel=PRINTED)
    with pytest.raises(ValueError, match=r"no interval after 0\.02 m of travel"):
        mean_spin(table, 0.02)
