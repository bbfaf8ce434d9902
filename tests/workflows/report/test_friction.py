"""Friction's share of the sliding: whether contacts slide or flutter."""

import math

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.mesh import HOLDER_PART, SurfaceMesh, write_surface
from bulkwear.workflows.report.friction import LEAST_SHARE, LEDGER, SURFACE, friction_light, friction_share
from bulkwear.workflows.report.sections import CARE, SOUND, WEAK

FRICTIONS = {0: 0.4, 1: 0.2}
SLIDING = np.array([3.0, 5.0, 7.0])  # J, of faces of both parts and of the holder
LABELS = np.array([0, 1, HOLDER_PART])


def left_by_a_run(folder, shares, labels=LABELS, sliding=SLIDING):
    """A run of a cycle per share, in which friction does that of what it can; the holder's faces do none.

    In the second cycle the faces are in another order, as after remeshing.
    """
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [-1, 1, 0]], dtype=float)
    triangles = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4]])
    folder.mkdir()
    write_surface(folder / SURFACE, SurfaceMesh(points, triangles, {"part": labels}))
    for number, share in enumerate(shares, start=1):
        work = share * np.array([FRICTIONS.get(label, 0.0) for label in labels]) * sliding
        cycle = folder / f"cycle_{number:03d}"
        cycle.mkdir()
        table = {"triangle": range(len(labels)), "sliding_work_J": sliding, "tangential_work_J": work}
        pd.DataFrame(table).to_parquet(cycle / LEDGER)
        labels, sliding = labels[::-1], sliding[::-1]
        write_surface(cycle / SURFACE, SurfaceMesh(points, triangles, {"part": labels}))
    return folder


def test_the_share_is_that_of_all_cycles_and_of_faces_that_wear(tmp_path):
    """Friction's work over the limit of each part times its sliding; the holder does not count."""
    assert friction_share(left_by_a_run(tmp_path / "run", [1.0, 0.5]), FRICTIONS) == pytest.approx(0.75)


def test_the_part_where_it_is_smallest_decides(tmp_path):
    """One that flutters is not hidden by one that slides much more; one that is hardly touched says nothing."""
    labels = np.array([0, 1, 1])
    for sliding, share in (([1000.0, 50.0, 50.0], 0.3), ([1000.0, 1.0, 1.0], 1.0)):
        run = left_by_a_run(tmp_path / f"run{share}", [1.0], labels=labels, sliding=np.array(sliding))
        table = pd.read_parquet(run / "cycle_001" / LEDGER)
        table["tangential_work_J"] *= np.where(labels == 1, 0.3, 1.0)
        table.to_parquet(run / "cycle_001" / LEDGER)
        assert friction_share(run, FRICTIONS) == pytest.approx(share)


def test_one_friction_holds_for_all_faces(tmp_path):
    """Faces of one material: a number does."""
    share = friction_share(left_by_a_run(tmp_path / "run", [0.9], labels=np.zeros(3, dtype=int)), FRICTIONS[0])
    assert share == pytest.approx(0.9)


def test_a_run_without_ledgers_or_sliding_says_nothing(tmp_path):
    """No number, and the light says so."""
    still = left_by_a_run(tmp_path / "still", [1.0], sliding=np.zeros(3))
    empty = left_by_a_run(tmp_path / "empty", [])
    assert math.isnan(friction_share(still, FRICTIONS)) and math.isnan(friction_share(empty, FRICTIONS))
    light = friction_light({"frictions": {"still": FRICTIONS, "empty": FRICTIONS}}, tmp_path)
    assert light.state == CARE and "no ledger" in light.said


def test_the_run_that_flutters_most_is_named(tmp_path):
    """Above the least share all is well; below it the run, its share and the setting are told."""
    for name, share in {"fine": 0.97, "least": LEAST_SHARE + 0.01, "flutters": 0.16}.items():
        left_by_a_run(tmp_path / name, [share])
    frictions = dict.fromkeys(("fine", "least"), FRICTIONS)
    sound = friction_light({"frictions": frictions}, tmp_path)
    assert sound.state == SOUND and "51 %" in sound.said
    weak = friction_light({"frictions": frictions | {"flutters": FRICTIONS}}, tmp_path)
    assert weak.state == WEAK
    assert all(word in weak.said for word in ("In flutters", "16 %", "solver.rayleigh_fraction"))
