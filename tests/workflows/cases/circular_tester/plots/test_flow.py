"""Figures of the flow in the circular wear tester show what they are given, beside what is published."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.workflows.cases.circular_tester.flow import (
    STEADINESS,
    revolution_means,
    revolutions_over_packings,
    steady_revolutions,
)
from bulkwear.workflows.cases.circular_tester.layer import relative_motion
from bulkwear.workflows.cases.circular_tester.plots import flow as tester
from tests.support import tester_study as study
from tests.support.tester_study import REMARKS, missing_words


def test_steadiness(tmp_path):
    """Where each packing is steady stands over its measure."""
    series = study.series(packings=2)
    variations = revolutions_over_packings(revolution_means(series, STEADINESS), "variation")
    figure = tester.steadiness(variations, steady_revolutions(series), study.PUBLISHED, REMARKS)
    assert missing_words(figure, tmp_path / "a.png", ["plain: steady from", "Yan 2022"]) == []


@pytest.mark.parametrize(
    ("answers", "words"),
    [
        ([("steady", 3.0), ("steady", 4.5)], "steady from 3, 4.5"),
        ([("steady", 3.0), ("cannot be said", 1.0)], "steady from 3; 1 x cannot be said"),
        ([("drifting", 1.0), ("drifting", 2.0)], "2 x drifting"),
    ],
)
def test_words_on_steadiness(answers, words):
    """No packing is left out, whatever is said of it."""
    assert tester.steady_words(pd.DataFrame(answers, columns=["answer", "start_revolutions"])) == words


@pytest.mark.parametrize("packings", [1, 3])
@pytest.mark.parametrize("measure", tester.MEASURES)
def test_by_revolution(tmp_path, measure, packings):
    means = revolutions_over_packings(revolution_means(study.series(packings=packings), [measure]), "mean")
    figure = tester.by_revolution(means, measure, study.PUBLISHED, REMARKS)
    assert missing_words(figure, tmp_path / "a.png", ["plain, Yan 2022", "convex"]) == []


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
