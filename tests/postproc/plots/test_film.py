"""The film: one frame per surface, one colour scale, small enough for the page."""

import numpy as np
import pandas as pd
import pytest
from PIL import Image

from bulkwear.meshes.sample import sliding_sample
from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.plots import film
from bulkwear.postproc.plots.style import WIDTH
from bulkwear.postproc.tables.film import frame_table

REMARKS = ["particles at scale 4", "sample 40 x 40 mm of 200 x 200 mm"]
DEPTH = 2e-6  # m, removed from the half x > 0 by the last frame
FRAMES = 3
CHANGED = 30  # of 255: far above what shading and palette do to a colour that stays
PALETTE_ERROR = 24  # of 255, of colours in a film of 192 colours without dithering


@pytest.fixture(scope="module")
def surfaces():
    """A plain sample, whose half x > 0 wears evenly to DEPTH."""
    sample = sliding_sample(0.04, 0.04, 0.004, None, 3e-4, np.radians(3.0))
    half = np.where(sample.points[:, 0] > 1e-6, DEPTH, 0.0)
    return [
        SurfaceMesh(sample.points, sample.triangles, sample.cell_data, {"removed_thickness_m": half * share})
        for share in np.linspace(0.0, 1.0, FRAMES)
    ]


@pytest.fixture(scope="module")
def pictures(surfaces):
    """Its frames."""
    cycle = np.arange(FRAMES)
    frames = pd.DataFrame({"cycle": cycle, "travel_m": 0.01 * cycle, "applied_volume_m3": 1e-9 * cycle})
    table = frame_table(frames, surfaces)
    return film.film_pictures("R9_convex", surfaces, table, "Removed thickness", REMARKS)


def test_one_frame_per_surface(pictures):
    """Frames are 800 pixels wide and of one size."""
    assert {picture.shape for picture in pictures} == {pictures[0].shape}
    assert (len(pictures), pictures[0].shape[1]) == (FRAMES, WIDTH * film.FRAME_RESOLUTION)


def test_only_what_wears_changes(pictures):
    """Layout, colour bar and remarks stand still; colours of the worn half and the words above the frame change."""
    first, last = pictures[0].astype(int), pictures[-1].astype(int)
    changed = (np.abs(first - last) > CHANGED).any(axis=2)
    height, width = changed.shape
    assert changed[: height // 10].any()
    assert changed[height // 10 : height // 2].sum() > 0.02 * changed.size
    assert not changed[:, int(0.9 * width) :].any()
    assert not changed[int(0.92 * height) :].any()
    assert (first[int(0.92 * height) :] < 200).any()


def test_the_scale_is_that_of_the_last_frame(surfaces):
    """Colours end at the depth that 99 % of the area does not exceed in the end; an unworn surface has a scale too."""
    assert film.film_limits(surfaces[-1]) == (0.0, pytest.approx(DEPTH * 1e6))
    assert film.film_limits(surfaces[0])[1] > 0.0


@pytest.mark.parametrize(
    ("travel", "left", "words"),
    [
        (120.0, np.nan, "120 mm of travel, 0.542 mm³ worn off"),
        (12345.6, 43.2, "12346 mm of travel, 0.542 mm³ worn off, 43 % of the pattern left"),
        (1.234, 4.36, "1.23 mm of travel, 0.542 mm³ worn off, 4.4 % of the pattern left"),
    ],
)
def test_a_frame_says_where_it_stands(travel, left, words):
    """Run, cycle, travel and volume with units, and what is left of the pattern where there is one."""
    names = ["cycle", "travel_mm", "applied_volume_mm3", "bumps_left_percent"]
    frame = next(pd.DataFrame([[3, travel, 0.5416, left]], columns=names).itertuples())
    assert film.frame_title("R9_convex", frame) == f"R9 convex: cycle 3, {words}"


def test_a_film_has_all_frames_in_order(pictures, tmp_path):
    """The GIF repeats, has every frame in its size with its own colours, and rests on the last one."""
    path = tmp_path / "film.gif"
    film.save_film(pictures, path)
    assert path.stat().st_size <= film.LARGEST_BYTES
    with Image.open(path) as found:
        assert (found.n_frames, found.size, found.info["loop"]) == (FRAMES, pictures[0].shape[1::-1], 0)
        for k, picture in enumerate(pictures):
            found.seek(k)
            shown = np.asarray(found.convert("RGB")).astype(int)
            error = np.abs(shown - picture)
            assert (shown[(picture == 255).all(axis=2)] == 255).all()
            assert np.quantile(error, 0.99) <= PALETTE_ERROR
        assert found.info["duration"] == 1000.0 * film.LAST_FRAME


def test_the_still_of_a_film_is_its_last_frame(pictures, tmp_path):
    """To the pixel, whatever palette the film has."""
    film.save_still(pictures, tmp_path / "film.png")
    with Image.open(tmp_path / "film.png") as found:
        np.testing.assert_array_equal(np.asarray(found), pictures[-1])


def test_a_large_film_is_made_small(tmp_path):
    """Frames that are too many for the bound are thinned; the first and the last one stay."""
    random = np.random.default_rng(4)
    noise = [random.integers(0, 255, (60, 80, 3), dtype=np.uint8) for _ in range(9)]
    noise[0][:], noise[-1][:] = 10, 240
    largest = 20_000
    film.save_film(noise, tmp_path / "film.gif", largest)
    assert (tmp_path / "film.gif").stat().st_size <= largest
    with Image.open(tmp_path / "film.gif") as found:
        assert 2 <= found.n_frames < len(noise)
        assert np.asarray(found.convert("RGB")).mean() < 60
        found.seek(found.n_frames - 1)
        assert np.asarray(found.convert("RGB")).mean() > 200
