"""Figures of the circular wear tester show what they are given, beside what is published."""

import numpy as np
import pandas as pd
import pytest

from meshes.plate import flat_plate
from postproc.plots.style import remarks_of, save
from tests.support import tester_study as study
from workflows.cases.circular_tester.comparison import mean_ratios, pattern_left, ratios_by_revolution, worn_out_at
from workflows.cases.circular_tester.flow import STEADINESS, relative_motion, revolution_means, steady_revolutions
from workflows.cases.circular_tester.plots import flow as tester
from workflows.cases.circular_tester.plots import volume as tester_volume
from workflows.cases.circular_tester.plots.comparison import channel_and_ring, worn_out
from workflows.cases.circular_tester.volume import (
    chosen_fit,
    comparison_table,
    crossing,
    element_increments,
    predictions,
    rate_crossing,
    time_scale,
    volume_fits,
)

REMARKS = ["reduced scale, for tests"]
SMALLEST_PICTURE = 20_000  # bytes


@pytest.fixture(scope="module")
def fits():
    return volume_fits(study.volumes())


@pytest.fixture(scope="module")
def predicted(fits):
    scale = time_scale(chosen_fit(fits, "plain_3"), 5e-9, study.PUBLISHED, 1.071, 0.01)
    return predictions(fits, scale, [56.0, 184.0])


def missing_words(figure, path, words=()):
    """Return which words a figure does not say anywhere; it is drawn and has its remarks."""
    save(figure, path)
    assert path.stat().st_size > SMALLEST_PICTURE
    assert remarks_of(figure) == REMARKS[0]
    said = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    said += [axes.get_title(loc="left") for axes in figure.axes]
    said += [
        cell.get_text().get_text()
        for axes in figure.axes
        for table in axes.tables
        for cell in table.get_celld().values()
    ]
    return [word for word in words if not any(word in each for each in said)]


def test_volume_by_revolution(fits, tmp_path):
    figure = tester_volume.volume_by_revolution(study.volumes(), fits, study.PUBLISHED_FITS, REMARKS)
    assert (
        missing_words(figure, tmp_path / "a.png", ["convex, particle scale 3", "Eq 6.5", "47.12, 0.78", "0.75 ±"]) == []
    )


def test_element_increments(tmp_path):
    terms = study.LAWS[("plain", 3)], study.LAWS[("convex", 3)]
    crossings = pd.DataFrame(
        {"particle_scale": [3.0], "rate_crossing": [rate_crossing(*terms)], "crossing": [crossing(*terms)]}
    )
    figure = tester_volume.element_increments(element_increments(study.volumes()), crossings, study.PUBLISHED, REMARKS)
    assert missing_words(figure, tmp_path / "a.png", ["convex faster from 20, more in sum from 40", "Fig 6.12"]) == []
    never = pd.DataFrame({"particle_scale": [1.0], "rate_crossing": [np.inf], "crossing": [np.inf]})
    assert tester_volume.crossing_words(next(never.itertuples())) == "scale 1: convex never wears faster"


def test_benchmark(predicted, tmp_path):
    figure = tester_volume.benchmark(predicted, study.PUBLISHED, study.PUBLISHED_FITS, REMARKS)
    assert missing_words(figure, tmp_path / "a.png", ["plain, ours", "convex, thesis' model"]) == []
    heights = [bar.get_height() for bar in figure.axes[0].patches]
    assert any(np.isclose(heights, 145.2)) and any(np.isclose(heights, 2 * 73.64))


def test_volume_by_hours(fits, predicted, tmp_path):
    table = comparison_table(predicted, study.PUBLISHED, study.PUBLISHED_FITS, 3.0)
    figure = tester_volume.volume_by_hours(
        fits[fits["particle_scale"] == 3.0], 56.0 * 75.0 / 145.2, table, study.PUBLISHED, REMARKS
    )
    assert missing_words(figure, tmp_path / "a.png", ["plain, measured", "240.3", "swaps"]) == []


def test_steadiness(tmp_path):
    series = study.series()
    means, steady = revolution_means(series, STEADINESS), steady_revolutions(series)
    figure = tester.steadiness(means, steady, study.PUBLISHED, REMARKS)
    assert missing_words(figure, tmp_path / "a.png", ["steady from", "Yan 2022"]) == []


@pytest.mark.parametrize("measure", tester.MEASURES)
def test_by_revolution(tmp_path, measure):
    figure = tester.by_revolution(revolution_means(study.series(), [measure]), measure, study.PUBLISHED, REMARKS)
    assert missing_words(figure, tmp_path / "a.png", ["plain, Yan 2022", "convex"]) == []


def test_by_column(tmp_path):
    table = pd.DataFrame({"run": np.repeat(["convex", "plain"], 5), "column": [1, 2, 3, 4, 5] * 2})
    table["base_mm3"], table["bumps_mm3"] = 44.0, [56.0] * 5 + [0.0] * 5
    figure = tester.by_column(table, "mm3", "Worn volume (mm³)", study.PUBLISHED, REMARKS)
    assert missing_words(figure, tmp_path / "a.png", ["bumps 56 % (Yan 2022: 56 %)", "base"]) == []
    forces = table.rename(columns={"base_mm3": "base_N", "bumps_mm3": "bumps_N"}).assign(deviation_N=5.0)
    assert (
        missing_words(
            tester.by_column(forces, "N", "Normal force (N)", study.PUBLISHED, REMARKS),
            tmp_path / "b.png",
            ["over 65 %"],
        )
        == []
    )


def test_by_bump(tmp_path):
    names = [f"C{row}{number}" for row in range(1, 6) for number in range(1, 6 - (row + 1) % 2)]
    rows = [int(name[1]) for name in names]
    table = pd.DataFrame({"bump": names, "row": rows, "volume_mm3": np.linspace(7.0, 30.0, len(names))})
    assert (
        missing_words(
            tester.by_bump(table, study.PUBLISHED, "after 17 revolutions", REMARKS), tmp_path / "a.png", ["after 17"]
        )
        == []
    )


def test_mesh_size(tmp_path):
    table = pd.DataFrame({"surface": np.repeat(["plain", "convex"], 3), "element_size_mm": [0.1, 0.5, 1.0] * 2})
    table["relative_percent"] = [100.0, 99.0, 98.0, 56.0, 57.0, 58.0]
    table["mean_percent"], table["deviation_percent"] = [99.0] * 3 + [57.0] * 3, 1.0
    assert (
        missing_words(tester.mesh_size(table, study.PUBLISHED, REMARKS), tmp_path / "a.png", ["97.9 ± 1.8", "99 ± 1 %"])
        == []
    )


def test_worn_contours(tmp_path):
    along = np.linspace(-10.0, 10.0, 41)
    parts = [
        pd.DataFrame({"bump": bump, "view": view, "along_mm": along, "name": name, "height_mm": height})
        for bump in ("C11", "C13")
        for view in ("side", "front")
        for name, height in (("pristine", 6.0), ("8", 5.5), ("17", 5.0))
    ]
    figure = tester.worn_contours(pd.concat(parts), "revolution", REMARKS)
    assert missing_words(figure, tmp_path / "a.png", ["C11, side", "17"]) == []


def test_channel_and_ring(tmp_path):
    """Ratios of both machines, of the revolutions that both have, stand on the figure."""
    table = study.volumes()
    table = table[table["particle_scale"] == 3.0]
    both = pd.concat(
        [
            table.assign(shape="channel", run=table["run"] + "_channel"),
            table[table["revolution"] < 6].assign(shape="ring", run=table["run"] + "_ring"),
        ]
    )
    ratios = ratios_by_revolution(both)
    figure = channel_and_ring(both, mean_ratios(ratios, shared=True), ratios, REMARKS)
    words = ["convex, ring, scale 3", "channel, scale 3: 0.65", "first 5 revolutions"]
    assert missing_words(figure, tmp_path / "a.png", words) == []


def test_worn_out(tmp_path):
    """The share that is left, and the revolution at which it is nothing, of the run with the larger coefficient."""
    x = np.arange(18.0)
    parts = [
        pd.DataFrame({"revolution": x, "law_volume_m3": 4e-8 * each * x})
        .assign(pattern_volume_m3=1e-6 * np.clip(1.0 - each * x / 300.0, 0.0, None), coefficient=each * 5e-9)
        .assign(run=run, surface="convex", particle_scale=6.0)
        for run, each in (("convex", 1.0), ("worn-out", 40.0))
    ]
    left = pattern_left(pd.concat(parts, ignore_index=True), 5e-9, 45.0)
    figure = worn_out(left, worn_out_at(left), REMARKS)
    words = ["worn-out, coefficient x 40", "worn-out: gone at 320", "convex: 94.3 % left", "plain sample"]
    words += ["convex: slower than plain throughout"]
    assert missing_words(figure, tmp_path / "a.png", words) == []


@pytest.mark.parametrize("quantity", ["relative_speed", "relative_angular_speed"])
def test_relative_motion(tmp_path, quantity):
    generator = np.random.default_rng(1)
    particles = pd.DataFrame(generator.uniform(-0.05, 0.05, (200, 2)), columns=["x_m", "y_m"])
    particles["surface"] = np.repeat(["convex", "plain"], 100)
    particles["radius_m"], particles["vx_m_per_s"], particles["vy_m_per_s"] = 4e-3, 0.0, 0.5
    particles["angular_speed_rad_per_s"] = generator.uniform(1.0, 2.0, 200)
    plate = flat_plate(0.1, 0.1, 0.1)
    edge = plate.points[[[0, 1], [1, 3], [3, 2], [2, 0]]][:, :, :2]
    figure = tester.relative_motion(
        relative_motion(particles), quantity, "Over the plain mean (-)", {"plain": edge, "convex": edge}, REMARKS
    )
    assert missing_words(figure, tmp_path / "a.png", ["plain"]) == []
    assert [axes.get_title(loc="left") for axes in figure.axes[:2]] == ["plain", "convex"]
