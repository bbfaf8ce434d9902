"""Figures of volumes in the circular wear tester show what they are given, beside what is published."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.circular_tester.comparison import (
    mean_ratios,
    pattern_left,
    ratios_by_revolution,
    worn_out_at,
)
from bulkwear.workflows.cases.circular_tester.plots import volume as tester_volume
from bulkwear.workflows.cases.circular_tester.plots.volume import channel_and_ring, worn_out
from bulkwear.workflows.cases.circular_tester.tables import comparison_table
from bulkwear.workflows.cases.circular_tester.volume import (
    chosen_fit,
    crossing,
    element_increments,
    predictions,
    rate_crossing,
    time_scale,
    volume_fits,
)
from tests.support import tester_study as study
from tests.support.tester_study import REMARKS, missing_words


@pytest.fixture(scope="module")
def fits():
    return volume_fits(study.volumes())


@pytest.fixture(scope="module")
def predicted(fits):
    scale = time_scale(chosen_fit(fits, "plain_3"), 5e-9, study.PUBLISHED, 1.071, 0.01)
    return predictions(fits, scale, [56.0, 184.0])


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
    assert tester_volume.crossing_words(next(never.itertuples()), "convex") == "scale 1: convex never wears faster"


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
