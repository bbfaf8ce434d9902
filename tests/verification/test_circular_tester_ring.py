"""The whole ring of a circular wear tester with LIGGGHTS: a trough whose surface moves takes its bed round.

Takes some two minutes.
"""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.flow.bed import last_snapshot, read_snapshot
from bulkwear.postproc.readers.solver_log import thermo_table
from bulkwear.workflows.cases.circular_tester import decks as tester_deck
from bulkwear.workflows.engine import cycles
from tests.support.tiny import tiny_chain
from tests.support.tiny_tester import tiny_tester

pytestmark = [pytest.mark.solver, pytest.mark.verify]

RING = {"shape": "ring", "inner_radius_mm": 40, "outer_radius_mm": 140}
LEAST_PACE = 0.5  # -, of the bed over its trough: sample and consolidator hold it back
RIGID = 0.35  # -, relative; angular speed of the outer half of the bed over that of the inner one: nearly rigid
PARTICLE = 0.5  # -, of the largest diameter: how far centres stay off the walls at least, less chords and overlaps


@pytest.fixture(scope="module")
def ring(tmp_path_factory):
    """A plain sample in a small ring, one revolution of 45 degrees worn."""
    study = tiny_tester(
        tester=RING,
        sliding={
            "angular_speed_deg_per_s": 380,
            "revolution_deg": 45,
            "steady_revolutions": 4,
            "run_in_revolutions": 0.33,
            "revolutions": 1,
        },
    )
    chain = tiny_chain(study, tmp_path_factory.mktemp("ring"), "plain")
    cycles.run_chain(chain)
    return chain


def test_no_particle_leaves_the_trough(ring):
    """As many in every line of every log; all between the walls and above the floor."""
    bed = thermo_table(ring.bed_restart.parent / "log.liggghts")["Atoms"][-1]
    logs = [thermo_table(folder / "log.liggghts") for folder in sorted(ring.folder.glob("cycle_*"))]
    assert set(np.concatenate([log["Atoms"] for log in logs])) == {bed}
    radius, _ = polar(ring)
    off = PARTICLE * min(ring.parameters["particle"]["diameters_m"])
    tester = ring.parameters["tester"]
    margin = tester_deck.TROUGH_ELEMENT**2 / (8.0 * tester["inner_radius_m"])  # chords lie inside their circle
    assert radius.min() > tester["inner_radius_m"] - margin
    assert radius.max() < tester["outer_radius_m"] - 0.5 * off
    assert read_snapshot(last_snapshot(ring.folder))["z_m"].min() > tester_deck.floor(tester)


def test_the_bed_goes_round_nearly_as_a_rigid_body(ring):
    """Never faster than the trough; outer and inner half turn about as fast, so that the outer one is faster."""
    wear = pd.read_csv(ring.folder / "wear.csv")
    assert wear["bed_over_floor_velocity"].between(LEAST_PACE, 1.0).all()
    radius, speed = polar(ring)
    outer = radius > np.median(radius)
    assert speed[outer].mean() / speed[~outer].mean() == pytest.approx(1.0, rel=RIGID)
    assert (speed * radius)[outer].mean() > (speed * radius)[~outer].mean()


def test_the_sample_wears(ring):
    """Loaded from above, worn by the law, without a particle lost on the way."""
    wear = pd.read_csv(ring.folder / "wear.csv")
    assert (wear["mean_normal_force_N"] > 0.0).all() and (wear["worn_volume_m3"] > 0.0).all()


def polar(chain):
    """Radius (m) and angular speed about the trough's axis (rad/s) of the particles at the end."""
    bed = read_snapshot(last_snapshot(chain.folder))
    x, y = bed["x_m"] + tester_deck.mean_radius(chain.parameters["tester"]), bed["y_m"]
    radius = np.hypot(x, y).to_numpy()
    turning = (x * bed["velocity_y_m_per_s"] - y * bed["velocity_x_m_per_s"]).to_numpy()
    return radius, turning / radius**2
