"""Snapshots of the bed."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.flow.bed import behind_cut, lag, last_snapshot, read_snapshot

HEADER = """ITEM: TIMESTEP
7
ITEM: NUMBER OF ATOMS
{count}
ITEM: BOX BOUNDS pp ff ff
-1 1
-1 1
-1 1
ITEM: ATOMS id x y z vx vy vz omegax omegay omegaz radius{space}
"""
ROWS = "2 0.1 0.2 0.3 3.0 0.0 4.0 1 2 2 0.001 \n1 -0.1 0.2 0.3 0.0 2.0 0.0 1 2 3 0.002 \n"


def write_dump(path, count=2, rows=ROWS):
    """A dump as the solver writes it, with its spaces at the ends of lines."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(HEADER.format(count=count, space=" ") + rows)
    return path


def test_snapshot_is_read_in_si(tmp_path):
    """Places and radii pass unchanged; speeds are the lengths of velocity and angular velocity."""
    table = read_snapshot(write_dump(tmp_path / "bed_0.dump"))
    assert table["id"].tolist() == [2, 1]
    assert table["speed_m_per_s"].tolist() == [5.0, 2.0]
    assert table["angular_speed_rad_per_s"][0] == 3.0
    assert table["radius_m"].tolist() == [0.001, 0.002]
    assert table["x_m"].tolist() == [0.1, -0.1]


def test_bed_that_lags_is_told_by_place(tmp_path):
    """The mean of the velocity along the travel of what is between two places, over that of the floor."""
    table = read_snapshot(write_dump(tmp_path / "bed_0.dump"))
    assert lag(table, 0.1, 0.3, 4.0) == pytest.approx(1.0 - (0.0 + 2.0) / 2.0 / 4.0)
    assert np.isnan(lag(table, 0.3, 0.4, 4.0))


@pytest.mark.parametrize("rows", [ROWS[:-40], ROWS + "3 0.1 0.2\n"])
def test_broken_snapshot_is_named(tmp_path, rows):
    """A dump with too few or cut rows is refused with its name."""
    with pytest.raises(ValueError, match=r"bed_0\.dump"):
        read_snapshot(write_dump(tmp_path / "bed_0.dump", rows=rows))


def test_dumps_of_a_users_own_deck_are_left_alone(tmp_path):
    """A project's template may dump what it likes beside the snapshots: the newest of these is still the last one."""
    write_dump(tmp_path / "cycle_001" / "bed_200.dump")
    (tmp_path / "cycle_001" / "bed_mine_900.dump").write_text("of another kind")
    assert last_snapshot(tmp_path).name == "bed_200.dump"


def test_other_dumps_are_refused(tmp_path):
    """A dump without the columns is refused with what is needed."""
    path = tmp_path / "bed_0.dump"
    path.write_text(HEADER.replace("vx vy vz", "").format(count=0, space=""))
    with pytest.raises(ValueError, match="vx"):
        read_snapshot(path)


def test_newest_snapshot_counts_steps_as_numbers(tmp_path):
    """bed_1000 is newer than bed_900, and the last cycle that has a snapshot counts."""
    for name in ("cycle_001/bed_5000.dump", "cycle_002/bed_900.dump", "cycle_002/bed_1000.dump"):
        write_dump(tmp_path / name)
    (tmp_path / "cycle_003").mkdir()
    assert last_snapshot(tmp_path).relative_to(tmp_path).as_posix() == "cycle_002/bed_1000.dump"
    with pytest.raises(FileNotFoundError, match="cycle_003"):
        last_snapshot(tmp_path / "cycle_003")


def test_cut_keeps_what_is_nearest_to_it():
    """Nothing on the viewer's side or far along the travel is drawn; of the rest the nearest to the cut stay."""
    random = np.random.default_rng(5)
    particles = pd.DataFrame(random.uniform(-1.0, 1.0, (500, 3)), columns=["x_m", "y_m", "z_m"])
    kept = behind_cut(particles, stretch=0.5, most=50)
    assert len(kept) == 50
    assert (kept["x_m"] <= 0.0).all()
    assert (kept["y_m"].abs() <= 0.5).all()
    hidden = behind_cut(particles, stretch=0.5, most=500)["x_m"].iloc[50:]
    assert hidden.max() <= kept["x_m"].min()
