"""The same part from different files, wound either way, wears the same."""

import gmsh
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bulkwear.meshes.own.mesh import own_mesh
from bulkwear.postproc.mesh import SurfaceMesh, areas, centroids, unit_normals, write_stl
from bulkwear.postproc.wear.balance import lost_volume
from bulkwear.postproc.wear.built_shape import with_built_shape
from bulkwear.postproc.wear.thickness import with_thickness
from bulkwear.postproc.wear.update import wear_update, with_depths

SIZE = (0.2, 0.12, 0.03)  # m, of a liner
TURN = Rotation.from_euler("xyz", (0.5, 0.3, -0.8))
TARGET = 0.006  # m
SPOT, WIDTH = np.array([0.08, 0.05, 0.03]), 0.03  # m, where and how wide it wears, in the liner's own frame
VOLUME = 2e-6  # m3
EXACT = 1e-9  # relative
# Meshes of other triangles integrate the spot's load by one point per triangle: (edge / width)^2 / 24, some 0.2 %, and
# the deepest node of either lies up to half an edge off its middle: (edge / (2 width))^2 / 2 of the depth.
SAMPLED = 0.01
DEEPEST = 0.03


@pytest.fixture(scope="module")
def step_file(tmp_path_factory):
    """A liner, drilled at one end, as STEP in mm, lying askew in space."""
    path = tmp_path_factory.mktemp("liner") / "liner.step"
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Verbosity", 0)
    gmsh.model.add("liner")
    block = gmsh.model.occ.addBox(0, 0, 0, *(1e3 * length for length in SIZE))
    hole = gmsh.model.occ.addCylinder(170, 60, -10, 0, 0, 50, 15)
    (solid,), _ = gmsh.model.occ.cut([(3, block)], [(3, hole)])
    matrix = np.eye(4)
    matrix[:3, :3] = TURN.as_matrix()
    gmsh.model.occ.affineTransform([solid], matrix.ravel().tolist())
    gmsh.model.occ.synchronize()
    gmsh.write(str(path))
    gmsh.finalize()
    return path


def worn(mesh: SurfaceMesh, flip: bool = False):
    """(lost volume, its centroid, deepest normal depth, least remaining thickness), m3 and m, after the spot wore."""
    pristine = with_thickness(
        with_built_shape(SurfaceMesh(mesh.points, mesh.triangles, {"part": mesh.cell_data["part"]}))
    )
    area, middle = areas(mesh.points, mesh.triangles), TURN.inv().apply(centroids(mesh.points, mesh.triangles))
    upward = TURN.inv().apply(unit_normals(mesh.points, mesh.triangles))[:, 2] > 0.9
    load = upward * area * np.exp(-(((middle - SPOT)[:, :2] / WIDTH) ** 2).sum(axis=1))
    volume = VOLUME * load / load.sum()
    present = pristine
    if flip:
        present = SurfaceMesh(
            pristine.points, pristine.triangles[:, [0, 2, 1]], pristine.cell_data, pristine.point_data
        )
    pressed = (0.0 * load, load) if flip else (load, 0.0 * load)
    start = present
    for _ in range(4):
        present, _ = wear_update(present, 0.25 * volume, pressed=pressed)
        pressed = (load, 0.0 * load)
    fields = with_depths(present, pristine).point_data
    removed = fields["removed_thickness_m"]
    place = (removed[:, None] * TURN.inv().apply(mesh.points)).sum(axis=0) / removed.sum()
    left = np.nanmin(fields["remaining_thickness_m"])
    return lost_volume(start, present)[0], place, np.nanmax(fields["normal_depth_m"]), left


@pytest.mark.verify
def test_stl_step_and_flipped_wear_the_same(step_file, tmp_path):
    """A spot of wear on a liner: the same volume, place, depth and remaining thickness whatever file it came from."""
    cad = own_mesh(step_file, "mm", edges=TARGET).surface
    write_stl(tmp_path / "liner.stl", 1e3 * cad.points, cad.triangles)
    tessellated = own_mesh(tmp_path / "liner.stl", "mm", edges=0.5 * TARGET).surface
    assert len(tessellated.triangles) > 2 * len(cad.triangles)
    depth = VOLUME / (np.pi * WIDTH**2)
    expected = worn(cad)
    assert expected[2] == pytest.approx(depth, rel=2 * DEEPEST, abs=0.0)
    for mesh, flip in ((cad, True), (tessellated, False), (tessellated, True)):
        lost, place, deepest, left = worn(mesh, flip)
        assert lost == pytest.approx(VOLUME, rel=EXACT, abs=0.0)
        assert place == pytest.approx(expected[1], abs=SAMPLED * WIDTH)
        assert deepest == pytest.approx(expected[2], rel=DEEPEST, abs=0.0)
        assert left == pytest.approx(expected[3], rel=DEEPEST * deepest / SIZE[2], abs=0.0)
    again = worn(cad, flip=True)
    assert again[0] == pytest.approx(expected[0], rel=EXACT, abs=0.0)
    assert again[2] == pytest.approx(expected[2], rel=EXACT, abs=0.0)
