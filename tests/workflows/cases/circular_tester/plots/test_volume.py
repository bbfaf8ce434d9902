"""Figures of volumes in the circular wear tester show what they are given, beside what is published."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.circular_tester import figures, key_numbers
from bulkwear.workflows.cases.circular_tester.comparison import (
    MACHINE,
    mean_ratios,
    pattern_left,
    ratios_by_revolution,
    worn_out_at,
)
from bulkwear.workflows.cases.circular_tester.hours import predictions, time_scale
from bulkwear.workflows.cases.circular_tester.packings import over_packings
from bulkwear.workflows.cases.circular_tester.plots import volume as tester_volume
from bulkwear.workflows.cases.circular_tester.plots.volume import channel_and_ring, worn_out
from bulkwear.workflows.cases.circular_tester.volume import mean_increments, mean_volumes, rates
from tests.support import tester_study as study
from tests.support.charts import drawn_chart, names, values
from tests.support.tester_study import REMARKS, missing_words

UNKNOWN = "one packing, scatter unknown"
RUN = SimpleNamespace(coefficient=5e-9, width=0.1, length=0.1, distance_per_revolution=1.071)


@pytest.fixture(scope="module", params=[1, 3])
def lost(request):
    """Volumes of one packing, and of three that scatter."""
    return study.volumes(packings=request.param, scatter=0.02 * (request.param > 1))


def of_main(lost):
    return lost[lost["particle_scale"] == 3.0]


@pytest.fixture(scope="module")
def scale(lost):
    return time_scale(of_main(lost)[of_main(lost)["surface"] == "plain"], RUN, study.PUBLISHED)


def several(lost):
    return lost["packing"].nunique() > 1


def test_volume_by_revolution(lost, tmp_path):
    """Our cases and the source's by name; without intervals where the scatter is unknown."""
    figure = tester_volume.volume_by_revolution(mean_volumes(lost), study.PUBLISHED_FITS, REMARKS)
    assert missing_words(figure, tmp_path / "a.png", ["convex, particle scale 3", "Eq 6.5"]) == []
    bars = [each for each in figure.axes[0].containers if each.has_yerr]
    assert len(bars) == (len(figure.axes[0].containers) if several(lost) else 0)


def test_rates_stand_beside_the_source(lost):
    """Yan's fit of the convex sample of scale 3 takes 43.9 % more in the last of as many revolutions than in the first;
    what is not published has no number.
    """
    found = key_numbers.with_fits(rates(lost), study.PUBLISHED_FITS).set_index(["surface", "particle_scale"])
    assert found.loc[("convex", 3.0), "fit_change_percent"] == pytest.approx(43.9, abs=0.05)
    assert found.loc[("plain", 3.0), "fit_mm3_per_revolution"] > 0.0


def test_element_increments(lost, tmp_path):
    ratios = mean_ratios(ratios_by_revolution(lost), shared=False)
    figure = tester_volume.element_increments(mean_increments(lost), ratios, study.PUBLISHED, REMARKS)
    words = ["scale 3: patterned over plain 0.", "change ", "Fig 6.12"]
    assert missing_words(figure, tmp_path / "a.png", words) == []
    assert missing_words(figure, tmp_path / "a.png", [UNKNOWN]) == ([UNKNOWN] if several(lost) else [])


def test_benchmark(lost, scale, tmp_path):
    predicted = predictions(lost, scale, [56.0, 184.0])
    figure = tester_volume.benchmark(predicted, study.PUBLISHED, study.PUBLISHED_FITS, REMARKS)
    assert missing_words(figure, tmp_path / "a.png", ["plain, ours", "convex, thesis' model"]) == []
    heights = [bar.get_height() for bar in figure.axes[0].patches]
    assert any(np.isclose(heights, 145.2, rtol=1e-3)) and any(np.isclose(heights, 2 * 73.64))


def test_volume_by_hours(lost, scale, tmp_path):
    """Ours ends at the hours that its revolutions stand for, beside what was measured."""
    curves = mean_volumes(of_main(lost))
    figure = tester_volume.volume_by_hours(curves, scale.hours_per_revolution, study.PUBLISHED, REMARKS)
    assert missing_words(figure, tmp_path / "a.png", ["plain, measured", "the plain sample sets our hours"]) == []
    ours = [line.get_xdata().max() for line in figure.axes[0].lines if str(line.get_label()).endswith("ours")]
    assert ours == pytest.approx([scale.hours_per_revolution * curves["revolution"].max()] * len(ours)) and ours


def test_channel_and_ring(lost, tmp_path):
    """Ratios of both machines, of the revolutions that both have, stand on the figure."""
    table = of_main(lost)
    ring = table[table["revolution"] < 6].assign(shape="ring", run=table["run"] + "_ring")
    both = pd.concat([table, ring])
    ratios = ratios_by_revolution(both)
    by_revolution = over_packings(ratios, [*MACHINE, "revolution"], "ratio", log=True)
    figure = channel_and_ring(mean_volumes(both), mean_ratios(ratios, shared=True), by_revolution, REMARKS)
    words = ["convex, ring, scale 3", "channel, scale 3: 0.6", "first 5 revolutions"]
    assert missing_words(figure, tmp_path / "a.png", words) == []


def test_worn_out(tmp_path):
    """The share that is left, and the revolution at which it is nothing, of the run with the larger coefficient."""
    x = np.arange(18.0)
    parts = [
        pd.DataFrame({"revolution": x, "law_volume_m3": 4e-8 * each * x})
        .assign(pattern_volume_m3=1e-6 * np.clip(1.0 - each * x / 300.0, 0.0, None), coefficient=each * 5e-9)
        .assign(run=run, surface="convex", particle_scale=6.0, packing=1)
        for run, each in (("convex", 1.0), ("worn-out", 40.0))
    ]
    left = pattern_left(pd.concat(parts, ignore_index=True), 5e-9, 45.0)
    figure = worn_out(left, worn_out_at(left), REMARKS)
    words = ["worn-out, coefficient x 40", "worn-out: gone at 320", "convex: 94.3 % left", "plain sample"]
    words += ["convex: slower than plain throughout"]
    assert missing_words(figure, tmp_path / "a.png", words) == []
    found = drawn_chart(figures.tester_worn_out.product, left)
    assert names(found) == ["convex", "worn-out", "plain sample"]
    assert values(found, "worn-out")[0][0] == 100.0 and values(found, "plain sample", 1) == [[45.0, 45.0]]
