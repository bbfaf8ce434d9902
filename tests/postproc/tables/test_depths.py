"""Depths of deformed and rigid samples, and their distribution over the area."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.mesh import SurfaceMesh, areas
from bulkwear.postproc.tables.depths import (
    area_quantile,
    area_share_above,
    carried_remark,
    carried_share,
    depth_distribution,
    depth_summary,
    depth_table,
    face_depth,
    held_back_faces,
    node_depth,
)

DEPTH = 3e-6  # m
RELATIVE = 1e-12  # rounding of sums over a few hundred triangles
ONE_FACE = 1 / 5000  # -, of the area: a share changes in steps of a face


def worn_plate(holder_beyond=0.0):
    """A plate with uniform wear of DEPTH; faces with x above `holder_beyond` (m) belong to the holder."""
    plate = flat_plate(0.04, 0.04, 0.005)
    part = np.where(plate.points[plate.triangles][:, :, 0].mean(axis=1) > holder_beyond, -1, 0)
    area = areas(plate.points, plate.triangles)
    worn_nodes = np.zeros(len(plate.points))
    worn_nodes[plate.triangles[part == 0]] = DEPTH
    return SurfaceMesh(
        plate.points,
        plate.triangles,
        {"part": part, "worn_volume_m3": area * DEPTH},
        {"removed_thickness_m": worn_nodes, "carried_volume_m3": np.zeros(len(plate.points))},
    )


@pytest.mark.parametrize("deformed", [True, False])
def test_uniform_wear_has_one_depth(deformed):
    """Volume over area and removed thickness agree where wear is uniform; the holder has no depth."""
    mesh = worn_plate()
    worn = mesh.cell_data["part"] == 0
    np.testing.assert_allclose(face_depth(mesh, deformed)[worn], DEPTH, rtol=RELATIVE)
    assert np.isnan(face_depth(mesh, deformed)[~worn]).all()
    at_nodes = node_depth(mesh, deformed)
    touched = np.unique(mesh.triangles[worn])
    np.testing.assert_allclose(at_nodes[touched], DEPTH, rtol=RELATIVE)
    assert np.isnan(np.delete(at_nodes, touched)).all()


def test_what_is_carried_counts_as_depth():
    """Half applied and half carried is as deep as all applied; over the area it is the whole worn volume."""
    mesh = worn_plate()
    worn = mesh.cell_data["part"] == 0
    area = areas(mesh.points, mesh.triangles)
    shares = np.bincount(mesh.triangles[worn].ravel(), np.repeat(area[worn] / 3.0, 3), len(mesh.points))
    mesh.point_data["removed_thickness_m"] *= 0.5
    mesh.point_data["carried_volume_m3"][:] = 0.5 * DEPTH * shares
    np.testing.assert_allclose(face_depth(mesh, True)[worn], DEPTH, rtol=RELATIVE)
    assert face_depth(mesh, True)[worn] @ area[worn] == pytest.approx(DEPTH * area[worn].sum(), rel=RELATIVE)


def test_equivalent_depth_conserves_volume():
    """Equivalent depth times area is the worn volume, face by face and at the nodes together."""
    mesh = worn_plate(holder_beyond=1.0)
    volume = np.random.default_rng(1).random(len(mesh.triangles)) * 1e-12
    mesh = SurfaceMesh(mesh.points, mesh.triangles, {**mesh.cell_data, "worn_volume_m3": volume})
    area = areas(mesh.points, mesh.triangles)
    np.testing.assert_allclose(face_depth(mesh, False) * area, volume, rtol=RELATIVE)
    share = np.bincount(mesh.triangles.ravel(), np.repeat(area / 3.0, 3))
    assert node_depth(mesh, False) @ share == pytest.approx(volume.sum(), rel=RELATIVE)


def test_a_map_says_what_is_carried_unless_it_is_rounding():
    """A quarter of the worn volume is told as 25 %; rounding is not told as a share."""
    mesh = worn_plate(holder_beyond=1.0)
    for share, words in ((0.25, "up to 25 % of a run's"), (1e-16, "nothing is carried")):
        mesh.point_data["carried_volume_m3"][:] = share * mesh.cell_data["worn_volume_m3"].sum() / len(mesh.points)
        assert words in carried_remark({"run": mesh}, deformed=True)


def test_faces_that_are_held_back():
    """Where a tenth or more of the depth is carried, and there alone; the remark of the map says what hatching is."""
    mesh = worn_plate()
    worn = mesh.cell_data["part"] == 0
    area = areas(mesh.points, mesh.triangles)
    shares = np.bincount(mesh.triangles[worn].ravel(), np.repeat(area[worn] / 3.0, 3), len(mesh.points))
    limited = mesh.points[:, 1] > 1e-9  # the upper half
    carried = np.where(limited, 0.2, 0.05)
    mesh.point_data["removed_thickness_m"] *= 1.0 - carried
    mesh.point_data["carried_volume_m3"] += carried * DEPTH * shares
    number = limited[mesh.triangles].sum(axis=1)
    held = held_back_faces(mesh)
    assert held[worn & (number == 3)].all() and not held[number == 0].any() and not held[~worn].any()
    assert "(hatched: 10 % or more of the depth there)" in carried_remark({"run": mesh}, True)
    mesh.point_data["carried_volume_m3"] *= 0.0
    assert not held_back_faces(mesh).any()


def test_carried_share():
    """Carried over worn volume; nothing worn carries nothing."""
    mesh = worn_plate(holder_beyond=1.0)
    mesh.point_data["carried_volume_m3"][:] = 0.25 * mesh.cell_data["worn_volume_m3"].sum() / len(mesh.points)
    assert carried_share(mesh) == pytest.approx(0.25, rel=RELATIVE)
    mesh.cell_data["worn_volume_m3"][:] = 0.0
    assert carried_share(mesh) == 0.0


def test_share_above_of_two_depths():
    """A quarter of the area at depth 2 and the rest at 1: shares are 1, 1/4 and 0 around them."""
    depth, area = np.array([1.0, 2.0, 1.0]), np.array([2.0, 1.0, 1.0])
    np.testing.assert_allclose(area_share_above(depth, area, np.array([0.5, 1.0, 1.5, 2.0])), [1.0, 0.25, 0.25, 0.0])
    assert area_quantile(depth, area, 0.75) == 1.0
    assert area_quantile(depth, area, 0.76) == 2.0


def test_distribution_of_uniform_depths():
    """Depths spread evenly over 0 to D leave the share 1 - d/D above d."""
    depth = (np.arange(5000) + 0.5) / 5000
    curve = depth_distribution(pd.DataFrame({"run": "a", "depth_um": depth, "area_mm2": 2.0}))
    np.testing.assert_allclose(curve["area_share_percent"], 100.0 * (1.0 - curve["depth_um"]), atol=100.0 * ONE_FACE)
    assert (curve["area_share_percent"].diff().dropna() <= 0.0).all()


def test_summary_of_a_table():
    """The mean is weighted by area, the touched share counts faces with any wear; holder faces are left out."""
    mesh = worn_plate()
    table = depth_table({"a": mesh}, deformed=False)
    assert len(table) == (mesh.cell_data["part"] == 0).sum()
    table.loc[table["x_mm"] < -10.0, "depth_um"] = 0.0
    found = depth_summary(table).iloc[0]
    assert found["largest_depth_um"] == pytest.approx(DEPTH * 1e6, rel=RELATIVE)
    assert found["mean_depth_um"] == pytest.approx(found["touched_area_percent"] / 100.0 * DEPTH * 1e6, rel=RELATIVE)
    assert 0.0 < found["touched_area_percent"] < 100.0
