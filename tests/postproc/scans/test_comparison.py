"""Depth, sections and volumes of a scan of known wear."""

import numpy as np
import pytest

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.scans import comparison as scan_comparison
from bulkwear.postproc.scans.comparison import (
    POINTS_PER_CELL,
    bump_names,
    bump_sections,
    depth_cells,
    depth_of_faces,
    largest_losses,
    surface_heights,
    thinned_scan,
    volume_table,
)
from bulkwear.postproc.scans.start import IDENTITY
from tests.support import scanned_sample as sample

CROP = 2e-3  # m
MEDIANS = 5.0  # -, standard errors of a median that the worst of thousands may lie off
LESS_SURE = 1.2533  # -, standard error of a median over that of a mean
BUMP_VOLUME = 0.4  # -, of the volume that the scanner's accuracy makes of a bump: cells at its foot are shared by label
VOLUME = 0.05  # -, of the lost volume of all bumps: noise throws points of a steep flank to the base
BASE_VOLUME = 0.02  # -, the same seen from the base
SAMPLE_VOLUME = 0.005  # -, where labels play no part


@pytest.fixture(scope="module")
def pristine():
    return sample.pristine_sample()


@pytest.fixture(scope="module")
def worn(pristine):
    return sample.worn_sample(pristine)


@pytest.fixture(scope="module")
def scan(pristine, worn):
    points = sample.scan_of(worn, IDENTITY, 150_000)
    return thinned_scan(np.array_split(points, 7), IDENTITY, pristine, CROP)


@pytest.fixture(scope="module")
def cells(scan, pristine, worn):
    return depth_cells(scan.points, pristine, {"same": worn, "twice": sample.worn_sample(pristine, 2.0)})


def test_depth_of_the_base_is_the_known_loss_to_the_noise(cells):
    """Every cell of the base within the standard error of its median; their mean within 0.5 um."""
    inside = (cells[["x_mm", "y_mm"]].abs() < 28.0).all(axis=1)
    base = cells[(cells["part"] == 0) & inside & (cells["points"] >= 5)]
    flat = base[base["z_mm"] < 1e3 * sample.HEIGHT]
    away = flat["measured_depth_um"] - 1e6 * sample.BASE_LOSS
    error = LESS_SURE * 1e6 * sample.NOISE / np.sqrt(flat["points"])
    assert len(flat) > 5000
    assert (away.abs() / error < MEDIANS).mean() > 0.999  # the rest hold an outlier among few points
    assert abs(away.mean()) < 0.5


def test_deviation_tells_who_wore_more(cells):
    """Zero against the surface that was scanned; the base's loss again against the one worn twice as much."""
    flat = cells[(cells["part"] == 0) & (cells[["x_mm", "y_mm"]].abs() < 28.0).all(axis=1)]
    assert abs(flat["same_deviation_um"].mean()) < 0.5
    assert flat["twice_deviation_um"].median() == pytest.approx(1e6 * sample.BASE_LOSS, abs=0.5)
    assert flat["twice_depth_um"].median() == pytest.approx(2e6 * sample.BASE_LOSS, abs=0.5)


def test_the_holder_has_no_depth(cells):
    assert abs(cells.loc[cells["part"] == -1, "measured_depth_um"].mean()) < 1.0


def test_the_hole_stays_a_hole(cells):
    away = np.hypot(cells["x_mm"] - 1e3 * sample.HOLE[0], cells["y_mm"] - 1e3 * sample.HOLE[1])
    within = cells[away < 1e3 * sample.HOLE_RADIUS - 1.0]
    assert within["points"].sum() <= 5  # outliers that fell there


def test_volumes(cells, pristine, worn):
    """Lost volume of base and of bumps that are wholly scanned is that of the worn mesh."""
    table = volume_table(cells, pristine, {"same": worn}, sample.NOISE)
    bumps = table[(table["part"] > 0) & (table["covered_percent"] > 99.0)]
    assert len(bumps) >= 6
    away = (bumps["measured_volume_mm3"] - bumps["same_volume_mm3"]).abs() / bumps["band_mm3"]
    assert away.max() < BUMP_VOLUME
    total = bumps[["measured_volume_mm3", "same_volume_mm3"]].sum()
    assert total.iloc[0] == pytest.approx(total.iloc[1], rel=VOLUME)
    base = table[table["of"] == "base"].iloc[0]
    assert base["measured_volume_mm3"] == pytest.approx(base["same_volume_mm3"], rel=BASE_VOLUME)
    whole = table[table["of"] == "sample"].iloc[0]
    assert whole["measured_volume_mm3"] == pytest.approx(whole["same_volume_mm3"], rel=SAMPLE_VOLUME)
    assert whole["area_mm2"] == pytest.approx(1e6 * sample.SIDE**2)
    assert whole["band_mm3"] == pytest.approx(1e9 * sample.SIDE**2 * sample.NOISE)
    assert whole["same_volume_mm3"] == pytest.approx(table["same_volume_mm3"].iloc[:-1].sum())


def test_sections(scan, pristine, worn):
    """Along and across every bump the measured height is that of the worn mesh, within noise; slopes raise the band."""
    sections = bump_sections(scan.points, pristine, {"same": worn}, sample.NOISE)
    assert sorted(sections["bump"].unique()) == ["C11", "C12", "C13", "C21", "C22", "C31", "C32", "C33"]
    flat = sections[sections["band_mm"] < 2e3 * sample.NOISE]  # up to 60 degrees
    away = (flat["measured_height_mm"] - flat["same_height_mm"]) / flat["band_mm"]
    assert away.count() > 300
    assert np.sqrt((away**2).mean()) < 1.0  # medians of a few points scatter less than the accuracy
    assert abs(away.mean()) < 0.05
    assert sections["band_mm"].min() == pytest.approx(1e3 * sample.NOISE, rel=1e-3)
    losses = largest_losses(sections).set_index("bump")
    known = 1e6 * (sample.BASE_LOSS + sample.CREST_LOSS * (0.5 + 20.0 / 60.0))
    assert losses.loc["C12", "same_um"] == pytest.approx(known, rel=0.03)
    assert (
        0.0 < losses.loc["C12", "measured_um"] - losses.loc["C12", "same_um"] < 3e6 * sample.NOISE
    )  # highest of noise


def test_names_are_those_of_figure_6_1(pristine):
    names = bump_names(pristine).set_index("bump")
    assert names.loc["C11", ["x_mm", "y_mm"]].to_numpy(float) == pytest.approx([-20.0, -20.0], abs=0.05)
    assert names.loc["C22", ["x_mm", "y_mm"]].to_numpy(float) == pytest.approx([10.0, 0.0], abs=0.05)


def test_names_of_many_bumps_are_unique():
    """Twelve rows of twelve: a hyphen tells bump 11 of row 1 from bump 1 of row 11; short numbers need none."""
    count = 12
    row, number = np.divmod(np.arange(count**2), count)
    corners = np.column_stack([number, row, np.zeros(count**2)])[:, None] + np.eye(3) / 4.0
    labels = {"part": np.arange(1, count**2 + 1), "row": row + 1}
    names = bump_names(SurfaceMesh(corners.reshape(-1, 3), np.arange(3 * count**2).reshape(-1, 3), labels))["bump"]
    assert names.is_unique and {"C11", "C99", "C1-11", "C11-1"} <= set(names)


def test_heights_are_exact_on_a_plane():
    """A tilted square, beside which there is no height."""
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.1], [1.0, 1.0, 0.3], [0.0, 1.0, 0.2]])
    mesh = SurfaceMesh(points, np.array([[0, 1, 2], [0, 2, 3]]))
    heights = surface_heights(mesh, np.array([[0.25, 0.5], [0.9, 0.2], [1.5, 0.5]]))
    assert heights[:2] == pytest.approx([0.125, 0.13])
    assert np.isnan(heights[2])


def test_memory_does_not_grow_with_the_scan(pristine, monkeypatch):
    """Ten times the points leave no more than the cells take; all are counted; what lies far off is dropped."""
    monkeypatch.setattr(scan_comparison, "CELL", 3e-3)
    points = sample.scan_of(pristine, IDENTITY, 20_000, outliers=0.0, hole=False)
    far = np.full((50, 3), 0.5)
    kept = thinned_scan(iter([points, far] * 10), IDENTITY, pristine, CROP)
    low, high = pristine.points.min(axis=0), pristine.points.max(axis=0)
    cells = np.prod(np.ceil((high - low)[:2] / 3e-3) + 1)
    assert kept.total == 10 * (len(points) + 50)
    assert 0.95 * 10 * len(points) < kept.on_sample <= 10 * len(points)
    assert len(kept.points) <= cells * POINTS_PER_CELL


def test_a_scan_of_something_else_is_refused(pristine):
    with pytest.raises(ValueError, match="no scanned point lies on the sample"):
        thinned_scan([np.full((10, 3), 1.0)], IDENTITY, pristine, CROP)


def test_faces_take_the_depth_of_the_nearest_cell(cells, pristine):
    depth = depth_of_faces(cells, pristine)
    centre = pristine.points[pristine.triangles].mean(axis=1)
    in_hole = np.linalg.norm(centre[:, :2] - sample.HOLE, axis=1) < 2e-3
    assert np.isnan(depth[in_hole & (pristine.cell_data["part"] == 0)]).mean() > 0.5
    assert np.nanmedian(depth[pristine.cell_data["part"] == 0]) == pytest.approx(sample.BASE_LOSS, rel=0.05)


def test_a_plain_surface_has_no_bumps_and_no_losses():
    """Its sections are an empty table with every column, and so are its losses."""
    corners, triangles = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), np.array([[0, 1, 2], [0, 2, 3]])
    plain = SurfaceMesh(corners, triangles, dict.fromkeys(("part", "row"), np.zeros(2, np.int64)), {})
    sections = bump_sections(np.zeros((0, 3)), plain, {"worn": plain}, 0.0)
    assert sections.empty and "worn_height_mm" in sections
    assert largest_losses(sections).columns.tolist() == ["bump", "measured_um", "worn_um"]
