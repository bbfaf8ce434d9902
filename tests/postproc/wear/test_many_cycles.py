"""The wear core over many cycles of random loads, with patches and remeshing, as the driver strings them together."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from bulkwear.postproc.mesh import areas, nonmanifold_edges
from bulkwear.postproc.wear.balance import BALANCE_TOLERANCE, lost_volume, volume_balance
from bulkwear.postproc.wear.caps import edge_limit
from bulkwear.postproc.wear.mesh_faults import Bounds, with_target_edges
from bulkwear.postproc.wear.patch import ContactPatch
from bulkwear.postproc.wear.remesh import remesh
from bulkwear.postproc.wear.update import wear_update
from tests.support.shapes import box, moved_rigidly, plate, sheet

BOUNDS = Bounds()
ROUNDING = 1e-9  # -, of the whole worn volume, in what a node carries
SHAPES = {
    "plate": lambda: plate(0.1, 0.08, 9),
    "body": lambda: box((0.1, 0.08, 0.06), 5),
    "waves": lambda: sheet(
        np.linspace(-0.05, 0.05, 12), np.linspace(-0.05, 0.05, 12), lambda x, y: (x, y, 0.01 * np.sin(60.0 * x))
    ),
}


def loads(mesh, generator, spots, depth, spread):
    """Worn volume (m,) m3 about some random spots, and where each triangle was touched."""
    middle = mesh.points[mesh.triangles].mean(axis=1)
    volume = np.zeros(len(middle))
    for spot in middle[generator.integers(len(middle), size=spots)]:
        near = np.exp(-((middle - spot) ** 2).sum(axis=1) / (2.0 * spread**2))
        volume += depth * generator.random() * near * areas(mesh.points, mesh.triangles)
    touched = volume > 0.01 * volume.max()
    volume = np.where(touched, volume, 0.0)
    place = np.where(touched[:, None], middle, np.nan)
    return volume, ContactPatch(place, np.where(touched, generator.uniform(0.2, 2.0) * spread, np.nan))


@settings(max_examples=8, deadline=None)
@given(
    st.sampled_from(sorted(SHAPES)),
    st.integers(0, 2**32 - 1),
    st.tuples(*[st.floats(-np.pi, np.pi)] * 3),
    st.integers(1, 4),
    st.floats(1e-5, 3e-3),
    st.floats(3e-3, 3e-2),
    st.booleans(),
)
def test_what_the_law_took_is_lost_or_carried_after_every_cycle(shape, seed, angles, spots, depth, spread, patched):
    """Whatever shape, attitude and loads: no volume comes or goes, no face is turned inside out or without area, and
    the surface stays one, cycle after cycle."""
    generator = np.random.default_rng(seed)
    pristine = with_target_edges(moved_rigidly(SHAPES[shape](), angles, (0.3, -0.2, 0.5)))
    present, law = pristine, 0.0
    for _ in range(6):
        volume, patch = loads(present, generator, spots, depth, spread)
        cap = edge_limit(present.points, present.triangles, 0.2)
        worn, record = wear_update(present, volume, cap, patch=patch if patched else None)
        law += record["worn_volume_m3"]
        present = remesh(worn, BOUNDS).mesh
        lost, rounding = lost_volume(pristine, present)
        carried = present.point_data["carried_volume_m3"]
        assert volume_balance(lost, float(carried.sum()), law, rounding) <= BALANCE_TOLERANCE
        assert carried.min() >= -ROUNDING * law and np.isfinite(present.points).all()
        assert (areas(present.points, present.triangles) > 0.0).all()
        assert not len(nonmanifold_edges(present.triangles))
