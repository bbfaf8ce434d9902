"""A bed without ends: a channel closed on itself, whose floor takes the particles round."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.flow.bed import last_snapshot, read_snapshot
from bulkwear.postproc.readers.solver_log import thermo_table
from bulkwear.postproc.tables.summary import run_summary
from bulkwear.workflows.engine import cycles
from bulkwear.workflows.engine.derived import neighbour_skin
from tests.support.tiny import tiny_chain, tiny_study

pytestmark = pytest.mark.solver

LENGTH = 0.02 + 0.04 + 0.08  # m: behind the sample, the sample, ahead of it
TRAVEL = 0.1  # m, in two cycles
LEAST_DRIVE = 0.75  # -, of the floor's velocity; the sample covers a third of this short channel; seen 0.83
SIDEWAYS = 0.06  # -, of the floor's velocity, at one moment: 275 particles jostle, nothing drives them; seen 0.02


@pytest.fixture(scope="module")
def channel(tmp_path_factory):
    """A run in which the bed goes more than once round its channel."""
    study = tiny_study(
        pattern={"row_spacing_between": "neighbouring_rows"},
        bed={"ends": "periodic", "ahead_mm": 80},
        sliding={"run_in_mm": 60, "travel_mm": 1000 * TRAVEL, "cycles": 2},
    )
    chain = tiny_chain(study, tmp_path_factory.mktemp("channel"))
    cycles.run_chain(chain)
    return chain


def test_no_particle_is_lost_and_none_leaves_the_channel(channel):
    """Every deck has as many particles in every line of its log; all are within the period; there are no end walls."""
    logs = [thermo_table(folder / "log.liggghts") for folder in sorted(channel.folder.glob("cycle_*"))]
    counts = np.concatenate([log["Atoms"] for log in logs])
    assert len(logs) == 3 and len(set(counts)) == 1
    y = read_snapshot(last_snapshot(channel.folder))["y_m"]
    assert len(y) == counts[0]
    assert channel.bed["start_m"] == pytest.approx(-0.1)
    skin = neighbour_skin(channel.bed["particle"])  # a particle comes round when the lists are made anew
    assert y.between(-0.1 - skin, -0.1 + LENGTH + skin).all()
    assert not (channel.folder / "end_wall.stl").exists()


def test_the_floor_takes_the_bed_along(channel):
    """The bed never overtakes its floor, follows it closely, and does not drift across the channel."""
    wear = pd.read_csv(channel.folder / "wear.csv")
    assert wear["bed_over_floor_velocity"].between(LEAST_DRIVE, 1.0).all()
    mean = run_summary(wear)["bed_over_floor_velocity"]  # of two cycles of equal length
    assert mean == pytest.approx(wear["bed_over_floor_velocity"].mean(), rel=1e-9)
    dump = pd.read_csv(last_snapshot(channel.folder), sep=r"\s+", skiprows=9, header=None)
    across = np.average(dump[4], weights=dump[10] ** 3)
    assert abs(across) < SIDEWAYS * channel.parameters["sliding"]["velocity_m_per_s"]


def test_the_bed_passes_round(channel):
    """The particles of cycle 1's end are those of cycle 2's; all have gone on, and some of them through the period."""
    ends = [max(part.glob("bed_*.dump"), key=_step) for part in sorted(channel.folder.glob("cycle_*"))[1:]]
    before, after = (read_snapshot(path).set_index("id")["y_m"].sort_index() for path in ends)
    assert before.index.equals(after.index)
    assert (after < before).any()
    assert np.median(np.mod(after - before, LENGTH)) == pytest.approx(TRAVEL / 2, rel=0.2)


def _step(dump):
    return int(dump.stem.removeprefix("bed_"))
