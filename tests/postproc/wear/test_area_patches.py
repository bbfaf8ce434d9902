"""Area patches: near, alike, of one part, about as large as a square, and found again on the worn surface."""

import time

import numpy as np
import pytest

from bulkwear.postproc.mesh import SurfaceMesh, areas, centroids, unit_normals
from bulkwear.postproc.wear import area_patches as module
from bulkwear.postproc.wear.area_patches import area_patches, patch_means, patch_sums, patch_table, patches_of
from bulkwear.postproc.wear.side import turned_to_flow, with_sides
from tests.support.shapes import box, cone, flipped, plate, sheet, shifted, welded

LENGTH = 0.1  # m, of a patch
EXTENT = 1.5  # -, of the length: a square's diagonal is 1.41; a little more after evening out
EVEN = (0.25, 1.3)  # -, of the length squared: area of patches on a plane; a square of the diagonal 2 REACH has 1
USUAL = 0.5  # -, of the length squared: most patches are larger
SAME = 1e-12  # -, of sums of numbers near 1
FACES, MOST_SECONDS = 30_000, 2.0  # of the processor; a twentieth is needed


def thin_box():
    """A plate with a front, a back a fifth of the length away, and rims."""
    return box((0.6, 0.4, 0.2 * LENGTH), 24)


def extents(mesh, patches):
    """Largest distance (count,) m between two centroids of each patch."""
    places = centroids(mesh.points, mesh.triangles)
    groups = [places[patches == number] for number in range(patches.max() + 1)]
    return np.array([np.linalg.norm(group[:, None] - group[None], axis=2).max() for group in groups])


def angles(mesh, patches):
    """Largest angle (count,) degrees between two normals of each patch."""
    normals = unit_normals(mesh.points, mesh.triangles)
    groups = [normals[patches == number] for number in range(patches.max() + 1)]
    return np.degrees([np.arccos(np.clip((group @ group.T).min(), -1.0, 1.0)) for group in groups])


def rough_sheet():
    """A sheet with bumps smaller than the length, so that many faces that look alike lie apart."""
    ticks = np.linspace(0.0, 0.5, 61)
    return sheet(ticks, ticks, lambda x, y: (x, y, 0.01 * np.sin(x / 0.008) * np.sin(y / 0.008)))


def test_a_plate_is_covered_by_even_patches():
    """Near one another, of even areas, each face in one; the areas sum to the plate's."""
    mesh = plate(1.0, 0.7, 60)
    patches = area_patches(mesh, LENGTH)
    table = patch_table(mesh, patches)
    assert np.array_equal(np.unique(patches), np.arange(patches.max() + 1))
    assert extents(mesh, patches).max() < EXTENT * LENGTH
    assert EVEN[0] * LENGTH**2 < table["area_m2"].min()
    assert table["area_m2"].max() < EVEN[1] * LENGTH**2
    assert np.median(table["area_m2"]) > USUAL * LENGTH**2
    assert table["area_m2"].sum() == pytest.approx(0.7, rel=SAME)


def test_front_and_back_of_a_thin_plate_are_two():
    """No patch of a thin box has faces of two sides, though all are nearer than the length."""
    mesh = thin_box()
    patches = area_patches(mesh, LENGTH)
    assert angles(mesh, patches).max() == pytest.approx(0.0, abs=1e-5)  # arc cosine of a rounded 1
    assert extents(mesh, patches).max() < EXTENT * LENGTH


def test_a_gentle_curve_is_not_cut_up():
    """On a pipe of five lengths' radius patches are as large as on a plane; on a narrow one normals end them."""
    gentle, narrow = (cone(radius, 1.0, 0.0, 120, 60, inward=True) for radius in (5.0 * LENGTH, 0.5 * LENGTH))
    patches = area_patches(gentle, LENGTH)
    assert (angles(gentle, patches) > 3.0).all()  # a face of the pipe is 3 degrees wide
    assert np.median(patch_table(gentle, patches)["area_m2"]) > USUAL * LENGTH**2
    narrow_angles = angles(narrow, area_patches(narrow, LENGTH))
    assert narrow_angles.max() < 2.0 * module.ALIKE_DEGREES + 3.0  # two that were merged
    assert np.median(narrow_angles) > 0.5 * module.ALIKE_DEGREES


def test_parts_are_kept_apart():
    """A patch has one part; numbers run part by part; rigid parts have none."""
    mesh = welded(plate(0.2, 0.2, 12), shifted(plate(0.2, 0.2, 12), (0.2, 0.0, 0.0)), plate(0.1, 0.1, 3), labels=True)
    part = np.array([1, 0, -2])[mesh.cell_data["part"]]
    mesh = SurfaceMesh(mesh.points, mesh.triangles, {"part": part})
    patches = area_patches(mesh, 1.5 * LENGTH)
    assert (patches[part < 0] == -1).all()
    assert patches[part == 0].min() == 0
    assert patches[part == 1].min() == patches[part == 0].max() + 1
    table = patch_table(mesh, patches)
    assert np.array_equal(table["part"], np.sort(table["part"]))
    assert set(table["part"]) == {0, 1}


def test_small_patches_are_merged(monkeypatch):
    """Of a rough sheet fewer small patches are left, and a merged one is still near and alike, by its mean normal."""
    mesh = rough_sheet()
    merged = patch_table(mesh, area_patches(mesh, LENGTH))["area_m2"]
    monkeypatch.setattr(module, "SMALLEST_AREA", 0.0)
    left = patch_table(mesh, area_patches(mesh, LENGTH))["area_m2"]
    least = 0.25 * LENGTH**2
    assert (left < least).sum() > 10  # there is something to merge
    assert (merged < least).sum() < 0.2 * (left < least).sum()
    assert merged.sum() == pytest.approx(left.sum(), rel=SAME)


def test_a_small_patch_without_a_like_neighbour_stays():
    """Two small plates back to back are two patches."""
    one = plate(0.02, 0.02, 2)
    mesh = welded(one, shifted(flipped(one), (0.0, 0.0, -0.01)))
    assert set(area_patches(mesh, LENGTH)) == {0, 1}


def test_units_do_not_matter_and_nothing_is_random():
    """The same numbers again, and of the surface in millimetres with a length in millimetres."""
    mesh = thin_box()
    first = area_patches(mesh, 0.125)  # lengths are scaled exactly by powers of two
    assert np.array_equal(first, area_patches(mesh, 0.125))
    assert np.array_equal(first, area_patches(SurfaceMesh(1024.0 * mesh.points, mesh.triangles), 128.0))


def test_the_pristine_surface_has_its_own_patches():
    """Looked up on itself, every face finds its patch; rigid faces have none."""
    mesh = welded(thin_box(), shifted(plate(0.3, 0.3, 9), (0.0, 0.0, 1.0)), labels=True)
    mesh = SurfaceMesh(mesh.points, mesh.triangles, {"part": np.where(mesh.cell_data["part"] == 0, 0, -2)})
    patches = area_patches(mesh, LENGTH)
    assert np.array_equal(patches_of(mesh, mesh, patches), patches)


def test_a_worn_surface_keeps_its_patches():
    """A front that receded nearly to its back is still the front, and faces of a finer mesh are where they were."""
    mesh, thickness = thin_box(), 0.2 * LENGTH
    patches = area_patches(mesh, LENGTH)
    finer = box((0.6, 0.4, thickness), 37)
    points = finer.points.copy()
    front = points[:, 2] > 0.999 * thickness
    points[front, 2] = 0.1 * thickness
    worn = SurfaceMesh(points, finer.triangles)
    found, table = patches_of(worn, mesh, patches), patch_table(mesh, patches)
    normals, places = unit_normals(worn.points, worn.triangles), centroids(worn.points, worn.triangles)
    assert (table["normal_z"][found[normals[:, 2] > 0.5]] > 0.999).all()
    assert (table["normal_z"][found[normals[:, 2] < -0.5]] < -0.999).all()
    flat = np.abs(normals[:, 2]) > 0.5
    away = np.hypot(*(places[:, k] - table[f"{axis}_m"][found] for k, axis in enumerate("xy")))
    assert away[flat].max() < EXTENT * LENGTH


def test_a_trough_that_was_turned_to_the_flow_keeps_its_patches():
    """Its file's normals look away from the particles: walls that face one another have patches of their own after the
    turn as before.
    """
    across = np.array([[-0.2, 0.3], [-0.2, 0.15], [-0.2, 0.0], [0.0, 0.0], [0.2, 0.0], [0.2, 0.15], [0.2, 0.3]])
    mesh = sheet(np.arange(7.0), np.linspace(0.0, 1.0, 8), lambda u, v: (*np.moveaxis(across[u.astype(int)], -1, 0), v))
    patches, pressed = area_patches(mesh, 0.16), np.ones(len(mesh.triangles))
    turned, told = turned_to_flow(with_sides(mesh), 0.0 * pressed, pressed)
    assert len(told) == 1 and (turned.triangles != mesh.triangles).any()
    assert np.array_equal(patches_of(turned, mesh, patches), patches)


def test_the_part_counts_before_the_place():
    """A face nearer to another part finds a patch of its own part; a part without patches is refused."""
    mesh = welded(plate(0.2, 0.2, 4), shifted(plate(0.2, 0.2, 4), (0.0, 0.0, 0.05)), labels=True)
    patches = area_patches(mesh, LENGTH)
    swapped = SurfaceMesh(mesh.points, mesh.triangles, {"part": 1 - mesh.cell_data["part"]})
    found = patches_of(swapped, mesh, patches)
    assert np.array_equal(patch_table(mesh, patches)["part"][found], swapped.cell_data["part"])
    third = SurfaceMesh(mesh.points, mesh.triangles, {"part": np.full(len(patches), 2)})
    with pytest.raises(ValueError, match="part 2 wears and has no face with a patch"):
        patches_of(third, mesh, patches)


def test_sums_and_means():
    """Sums over patches are the whole; means go by area; a patch without faces has none."""
    mesh = plate(0.4, 0.2, 8)
    patches, area = area_patches(mesh, LENGTH), areas(mesh.points, mesh.triangles)
    patches[0] = -1
    count = patches.max() + 2
    height = centroids(mesh.points, mesh.triangles)[:, 0]
    assert patch_sums(area, patches, count).sum() == pytest.approx(area[1:].sum(), rel=SAME)
    means = patch_means(height, area, patches, count)
    assert means[:-1] == pytest.approx(patch_table(mesh, patches)["x_m"], rel=SAME)
    assert np.isnan(means[-1])
    height[1] = np.nan
    there = (patches == patches[1]) & np.isfinite(height)
    left = patch_means(height, area, patches, count)[patches[1]]
    assert left == pytest.approx(np.average(height[there], weights=area[there]), rel=SAME)


def test_the_table_of_a_square():
    """One patch of a unit square with four cells: centre, normal, area, and its edges of 0.5 and 0.5 root 2."""
    mesh = plate(1.0, 1.0, 2)
    table = patch_table(mesh, np.zeros(8, dtype=np.int64))
    told = {name: float(column[0]) for name, column in table.items()}
    place = {"x_m": 0.5, "y_m": 0.5, "z_m": 0.0, "normal_x": 0.0, "normal_y": 0.0, "normal_z": 1.0}
    edge = {"edge_m": 0.5 * (2.0 + np.sqrt(2.0)) / 3.0}
    assert told == pytest.approx({"patch": 0, "part": 0, **place, "area_m2": 1.0, **edge})


@pytest.mark.parametrize("length", [0.0, -0.1, np.nan, np.inf])
def test_the_length_is_above_0(length):
    """A patch without a size is refused."""
    with pytest.raises(ValueError, match=r"the length of area patches is .* m, allowed is a finite length above 0"):
        area_patches(plate(1.0, 1.0, 2), length)


def test_patches_of_another_surface_are_refused():
    """As many patches as faces."""
    mesh = plate(1.0, 1.0, 2)
    with pytest.raises(ValueError, match="found patches of 7 faces, allowed is one of each of 8"):
        patch_table(mesh, np.zeros(7, dtype=np.int64))


def test_a_face_without_area_has_a_patch():
    """A sliver without a normal goes to the patch that is nearest."""
    mesh = plate(0.2, 0.2, 2)
    triangles = np.concatenate([mesh.triangles, [[0, 0, 1]]])
    assert (area_patches(SurfaceMesh(mesh.points, triangles), LENGTH) >= 0).all()


def test_large_surfaces_take_little_time():
    """Thirty thousand faces and five hundred patches."""
    mesh = plate(2.2, 2.2, 122)
    start = time.process_time()
    patches = area_patches(mesh, LENGTH)
    assert time.process_time() - start < MOST_SECONDS
    assert len(patches) > 0.95 * FACES
    assert patches.max() > 400
