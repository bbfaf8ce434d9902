"""Wear by column and bump, forces by column, mesh size: sums are kept and land where they belong."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bulkwear.meshes.pattern import ConvexPattern
from bulkwear.meshes.plate import flat_plate
from bulkwear.meshes.sample import sample_top
from bulkwear.postproc.mesh import SurfaceMesh, areas, centroids, write_surface
from bulkwear.postproc.tables.depths import WORN_VOLUME
from bulkwear.workflows.cases.circular_tester.distribution import (
    column_borders,
    column_numbers,
    columns_over_packings,
    contour_losses,
    force_by_column,
    losses_at_volume,
    mesh_size_effect,
    on_finest_mesh,
    share_of_bumps,
    wear_by_bump,
    wear_by_column,
    worn_contours,
)

PATTERN = ConvexPattern(8e-3, 2e-3, 6e-3, 20e-3, 20e-3)  # of R9; rows 20 mm apart (Fig 6.1)
BORDERS = np.array([-0.03, -0.01, 0.01, 0.03])  # m, of its columns
SIDE, ELEMENT = 0.1, 4e-3  # m
ROUNDING = 1e-12


def with_volume(mesh, volume):
    return SurfaceMesh(mesh.points, mesh.triangles, {**mesh.cell_data, WORN_VOLUME: volume})


@pytest.fixture(scope="module")
def convex():
    mesh = sample_top(SIDE, SIDE, ELEMENT, PATTERN)
    return with_volume(mesh, 1e-9 * (1.0 + (mesh.cell_data["part"] > 0) * mesh.cell_data["row"]))


@pytest.fixture(scope="module")
def plain():
    """Each strip of 20 mm wears its number times as deep as the first."""
    mesh = flat_plate(SIDE, SIDE, 5e-3)
    strip = np.floor((centroids(mesh.points, mesh.triangles)[:, 1] + 0.05) / 0.02) + 1.0
    return with_volume(mesh, 1e-6 * strip * areas(mesh.points, mesh.triangles))


def test_strips_of_a_plain_sample(plain):
    """2000 mm2 times depth of 1, 2 ... 5 um."""
    table = wear_by_column({"plain": plain}, BORDERS)
    assert table["column"].tolist() == [1, 2, 3, 4, 5]
    assert table["base_mm3"].to_numpy() == pytest.approx(2.0 * np.arange(1, 6))
    assert (table["bumps_mm3"] == 0.0).all()


def test_nothing_is_lost_between_columns(convex):
    """Columns add up to the sample; bumps stay whole in their column: 5 + 4 + 5 + 4 + 5."""
    table = wear_by_column({"convex": convex}, BORDERS)
    total = 1e9 * convex.cell_data[WORN_VOLUME].sum()
    assert table[["base_mm3", "bumps_mm3"]].to_numpy().sum() == pytest.approx(total, rel=ROUNDING)
    per_bump = (convex.cell_data["part"] == 1).sum()
    expected = per_bump * np.array([5, 4, 5, 4, 5]) * (1.0 + np.arange(1, 6))
    assert table["bumps_mm3"].to_numpy() == pytest.approx(expected)
    share = share_of_bumps(table.assign(surface="convex", packing=1))
    assert share.value == pytest.approx(expected.sum() / total) and not share.known


def test_columns_follow_labels_on_bumps(convex):
    number, row = column_numbers(convex, BORDERS), convex.cell_data["row"]
    assert (number[row > 0] == row[row > 0]).all()
    assert number.min() == 1


def test_columns_of_the_source_meet_midway_between_its_rows(convex):
    assert column_borders(convex) == pytest.approx(BORDERS, abs=ROUNDING)


@pytest.mark.parametrize(("apart", "rows"), [(0.01, 10), (0.04, 3), (0.08, 2), (0.2, 1)])
def test_a_pattern_has_a_column_per_row(apart, rows):
    """Whatever the number of rows, each bump stands in the column of the base round it, and nothing is lost; a plain
    sample has columns at the same places.
    """
    narrow = ConvexPattern(4e-3, 2e-3, 3e-3, apart, 20e-3)
    mesh = sample_top(SIDE, SIDE, ELEMENT, narrow)
    volume = 1e-9 * np.ones(len(mesh.triangles))
    flat = flat_plate(SIDE, SIDE, 5e-3)
    meshes = {"convex": with_volume(mesh, volume), "plain": with_volume(flat, np.full(len(flat.triangles), 1e-9))}
    borders = column_borders(mesh)
    table = wear_by_column(meshes, borders)
    assert table["column"].tolist() == [*range(1, rows + 1)] * 2
    sums = table.groupby("run")[["base_mm3", "bumps_mm3"]].sum().sum(axis=1)
    assert sums.to_dict() == pytest.approx({"convex": len(mesh.triangles), "plain": len(flat.triangles)})
    number, part = column_numbers(mesh, borders), mesh.cell_data["part"]
    along = centroids(mesh.points, mesh.triangles)[:, 1]
    for column in range(1, rows + 1):
        base, bumps = (along[(number == column) & which] for which in (part == 0, part > 0))
        assert base.min() < bumps.min() and bumps.max() < base.max()


def test_the_holder_is_in_no_column(convex):
    part = np.where(centroids(convex.points, convex.triangles)[:, 1] > 0.045, -1, convex.cell_data["part"])
    mesh = SurfaceMesh(convex.points, convex.triangles, {**convex.cell_data, "part": part})
    assert (column_numbers(mesh, BORDERS)[part == -1] == 0).all()


def test_volume_of_every_bump(convex):
    table = wear_by_bump({1: convex, 2: convex})
    assert table["bump"].tolist()[:6] == ["C11", "C12", "C13", "C14", "C15", "C21"]
    assert len(table) == 46 and table["packing"].value_counts().to_dict() == {1: 23, 2: 23}
    per_bump = (convex.cell_data["part"] == 1).sum()
    assert table["volume_mm3"].to_numpy() == pytest.approx(per_bump * (1.0 + table["row"].to_numpy(float)))


def test_force_is_impulse_over_time(convex):
    """The columns' forces add up to the whole impulse over the duration."""
    impulse = np.random.default_rng(1).uniform(0.0, 1e-3, len(convex.triangles))
    table = force_by_column(convex, impulse, 0.5, BORDERS)
    assert table[["base_N", "bumps_N"]].to_numpy().sum() == pytest.approx(impulse.sum() / 0.5, rel=ROUNDING)


def test_columns_over_packings():
    """Half of what two packings differ by is their mean; the interval is that of base and pattern together."""
    table = pd.DataFrame({"surface": "convex", "column": [1, 2, 1, 2], "packing": [1, 1, 2, 2]})
    table = columns_over_packings(table.assign(base_N=[4.0, 1.0, 6.0, 1.0], bumps_N=[1.0, 2.0, 1.0, 2.0]), "N")
    assert table[["base_N", "bumps_N", "total_N"]].to_numpy().tolist() == [[5.0, 1.0, 6.0], [1.0, 2.0, 3.0]]
    reach = 12.7062 * 1.0  # t of one degree of freedom at 95 %; the standard error is half of the difference
    assert table["interval_low"].tolist() == pytest.approx([6.0 - reach, 3.0], rel=1e-5)


def test_mesh_size_effect():
    """Over the plain sample on the finest mesh in the same packing, and over the same surface on its finest."""
    volumes = pd.DataFrame(
        {
            "surface": ["plain"] * 3 + ["convex"] * 2,
            "element_size_mm": [1.0, 0.5, 0.1, 1.0, 0.1],
            "volume_m3": [0.96e-7, 0.98e-7, 1e-7, 0.5e-7, 0.6e-7],
            "packing": 1,
        }
    )
    other = volumes.assign(volume_m3=2.0 * volumes["volume_m3"], packing=2)
    table = mesh_size_effect(pd.concat([volumes, other]))
    assert table["relative_percent"].tolist() == pytest.approx([96.0, 98.0, 100.0, 50.0, 60.0])
    assert (table["packings"] == 2).all()
    finest = on_finest_mesh(volumes).set_index(["surface", "element_size_mm"])["ratio"].to_dict()
    assert finest == pytest.approx({("plain", 0.5): 0.98, ("plain", 1.0): 0.96, ("convex", 1.0): 5.0 / 6.0})
    with pytest.raises(ValueError, match="plain"):
        mesh_size_effect(volumes[volumes["surface"] == "convex"])


def test_contours_without_a_scan(convex):
    """Sections of the surfaces themselves: a sample lowered by 0.2 mm lies 0.2 mm lower everywhere."""
    lower = SurfaceMesh(convex.points - (0.0, 0.0, 2e-4), convex.triangles, convex.cell_data)
    table = worn_contours(convex, {"17": lower}, ["C11", "C15"])
    assert list(dict.fromkeys(table["name"])) == ["pristine", "17"]
    assert set(table["bump"]) == {"C11", "C15"}
    heights = table.pivot(index=["bump", "view", "along_mm"], columns="name", values="height_mm").dropna()
    assert len(heights) > 100
    assert (heights["pristine"] - heights["17"]).to_numpy() == pytest.approx(np.full(len(heights), 0.2))
    assert heights["pristine"].max() == pytest.approx(6.0, abs=0.15)


def test_losses_of_contours(convex):
    """A sample lowered by 0.2 mm has lost that everywhere; bumps that it does not have are left out."""
    lower = SurfaceMesh(convex.points - (0.0, 0.0, 2e-4), convex.triangles, convex.cell_data)
    losses = contour_losses(convex, lower, ["C11", "C15", "C99"])
    assert losses.to_dict() == pytest.approx({"C11": 0.2, "C15": 0.2})


@pytest.mark.parametrize(
    ("volume", "loss"), [(5.0, 0.1), (10.0, 0.2), (25.0, 0.25), (40.0, 0.3), (41.0, None), (0.0, None)]
)
def test_losses_at_a_volume(convex, tmp_path, volume, loss):
    """Two cycles that lower a sample by 0.2 and 0.3 mm at 10 and 40 mm3: straight between them, from the pristine one
    on, and nothing beyond the run.
    """
    for number, depth in enumerate((0.0, 2e-4, 3e-4)):
        folder = tmp_path / (f"cycle_{number:03d}" if number else "")
        folder.mkdir(exist_ok=True)
        lower = SurfaceMesh(convex.points - (0.0, 0.0, depth), convex.triangles, convex.cell_data)
        write_surface(folder / "surface.vtu", lower)
    table = pd.DataFrame({"cycle": [1, 2], "total_applied_volume_m3": [1e-8, 4e-8]})
    table.to_csv(tmp_path / "wear.csv", index=False)
    found = losses_at_volume(SimpleNamespace(folder=tmp_path), volume, ["C11", "C15"])
    assert found.to_dict() == pytest.approx({} if loss is None else {"C11": loss, "C15": loss})
