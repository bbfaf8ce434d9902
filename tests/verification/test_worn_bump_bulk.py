"""A bump that a bed of coarse particles wears right through in LIGGGHTS: the study worn_bump at quick, as users run it.

Some ten minutes of one core.
"""

from itertools import pairwise

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.mesh import read_surface
from bulkwear.postproc.mesh_checks import intersecting_faces
from bulkwear.postproc.readers.solver_log import thermo_table
from bulkwear.postproc.wear.balance import lost_volume
from bulkwear.postproc.wear.mesh_faults import TARGET_EDGE, folded_faces, with_target_edges
from bulkwear.postproc.wear.old_surface import OldSurface
from bulkwear.postproc.wear.pattern_left import pattern_volume
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.cycles import run_chain
from tests.support.tiny import tiny_chain

pytestmark = [pytest.mark.solver, pytest.mark.verify]

LEFT = 0.1  # -, of the bump's volume, at most: a low rise, in a base that wears too; seen 0.07 after all 16 m of travel
BALANCE = 1e-6  # relative to alpha * work: pristine minus present volume plus carried
OUTWARD = 0.01  # -, over the target edge: how far a surface may stand outside the one before it, and the pristine one
LARGEST_FOLD = 165.0  # degrees between the normals of neighbours: a flipped face has 180
LEAST_DRIVE = 0.85  # -, velocity of the bed over that of its floor; seen 0.95


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The run's folder and the surfaces of all its cycles, the pristine one first."""
    study = load_study("worn_bump", overrides={"fidelity": "quick"})
    chain = tiny_chain(study, tmp_path_factory.mktemp("worn_bump"), "bump_convex")
    run_chain(chain)
    files = [chain.surface, *sorted(chain.folder.glob("cycle_*/surface.vtu"))]
    return chain.folder, [read_surface(path) for path in files]


def test_the_bump_is_gone(run):
    """Less than a tenth of its volume is left; base and bump keep their labels."""
    _, surfaces = run
    assert pattern_volume(surfaces[-1]) < LEFT * pattern_volume(surfaces[0])
    assert all(set(np.unique(mesh.cell_data["part"])) == {-1, 0, 1} for mesh in surfaces)


def test_no_surface_is_folded_or_cuts_itself(run):
    """No flipped normal and no intersection on the surface of any cycle."""
    for mesh in run[1]:
        assert not folded_faces(mesh.points, mesh.triangles, LARGEST_FOLD).any()
        assert len(intersecting_faces(mesh.points, mesh.triangles)) == 0


def test_nothing_grows(run):
    """No surface stands outside that of the cycle before, nor outside the pristine one, by 1 % of the edge."""
    surfaces = [with_target_edges(run[1][0]), *run[1][1:]]
    pairs = [*pairwise(surfaces), (surfaces[0], surfaces[-1])]
    for before, after in pairs:
        old = OldSurface(before.points, before.triangles)
        reach = old.range_over_faces(after.points, after.triangles, after.point_data[TARGET_EDGE])
        assert reach[:, 1].max() <= OUTWARD


def test_the_volume_balance_is_closed(run):
    """In every cycle pristine minus present volume plus carried is coefficient times work."""
    folder, surfaces = run
    wear = pd.read_csv(folder / "wear.csv")
    assert len(wear) == len(surfaces) - 1
    for mesh, row in zip(surfaces[1:], wear.itertuples(), strict=True):
        removed = lost_volume(surfaces[0], mesh)[0] + mesh.point_data["carried_volume_m3"].sum()
        assert removed == pytest.approx(row.total_worn_volume_m3, rel=BALANCE)


def test_no_particle_is_lost(run):
    """All logs have the same number of particles in every line; the bed follows its floor."""
    folder = run[0]
    counts = [set(thermo_table(path)["Atoms"]) for path in sorted(folder.glob("cycle_*/log.liggghts"))]
    assert len(set.union(*counts)) == 1
    assert (pd.read_csv(folder / "wear.csv")["bed_over_floor_velocity"] > LEAST_DRIVE).all()
