"""Normality of contours and the run-in: known distributions, hand-made p values, the published table."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.meshes.disc import track_disc
from bulkwear.postproc.mesh import SurfaceMesh, write_surface
from bulkwear.postproc.statistics.change_point import ENDED, NONE_FOUND
from bulkwear.workflows.cases.pin_on_disc.contours import CONTOURS
from bulkwear.workflows.cases.pin_on_disc.run_in import (
    SIGNIFICANCE,
    VOLUME_SERIES,
    change_points,
    chi_squared_normality,
    contours_of_run,
    corrected_significance,
    equiprobable_bins,
    neighbour_correlation,
    published_ranges,
    rate_of_no_run_in,
    revolution_statistics,
    run_in_revolution,
    run_in_table,
    run_in_words,
    size_histogram,
    statistics_of,
)
from bulkwear.workflows.cases.pin_on_disc.runs import REFERENCE, only_reference, whole_revolutions
from tests import PUBLISHED

VALUES = pd.read_csv(PUBLISHED / "pin_on_disc.csv")
NORMALITY = pd.read_csv(PUBLISHED / "pin_on_disc_normality.csv")
REPEATS = 400  # samples of a distribution
# of 400 samples 5 % fail by chance; parameters fitted to the values, not the classes, make it a little more
FEWEST_FAILURES, MOST_FAILURES = 0.01, 0.11
SHARE_ERROR = 0.08  # -, of a share of REPEATS near a third: three deviations, and a little for fitted parameters
ROUNDING = 1e-12  # -, of sums of 360 values


def samples(draw):
    """p values of REPEATS samples of 360."""
    return np.array([chi_squared_normality(draw()) for _ in range(REPEATS)])


def test_normal_values_fail_as_often_as_the_test_says():
    """Of normal samples about 5 % have a p value below 0.05, wherever their mean and whatever their spread."""
    rng = np.random.default_rng(5)
    failed = (samples(lambda: rng.normal(15e-6, 1e-6, CONTOURS)) < SIGNIFICANCE).mean()
    assert FEWEST_FAILURES < failed < MOST_FAILURES


@pytest.mark.parametrize("kind", ["exponential", "two heights", "outliers"])
def test_other_values_fail(kind):
    """A skew, a two-humped and a narrow distribution with outliers have p values near 0."""
    rng = np.random.default_rng(6)
    values = {
        "exponential": rng.exponential(1.0, CONTOURS),
        "two heights": np.repeat([0.0, 1.0], CONTOURS // 2) + rng.normal(0.0, 0.1, CONTOURS),
        "outliers": np.append(rng.normal(0.0, 1.0, CONTOURS - 5), np.full(5, 30.0)),
    }[kind]
    assert chi_squared_normality(values) < 1e-6  # -, of the least of the three 1e-20


def test_p_value_does_not_hang_on_the_unit():
    """m or mm, shifted or not: the classes follow the values."""
    values = np.random.default_rng(7).normal(0.0, 1.0, CONTOURS)
    assert chi_squared_normality(1e-6 * values + 20e-6) == pytest.approx(chi_squared_normality(values), rel=1e-9)


def test_p_value_by_hand():
    """Four values in four classes, one in each but for two in the first: chi2 = 1/1 + 1/1 with one degree of freedom.

    Values -0.75, -0.75, 0.25, 1.25 have mean 0 and standard deviation 0.957; the quartiles of that normal
    distribution are -0.646, 0 and 0.646: counts 2, 0, 1, 1. P(chi2_1 > 2) = 0.1573.
    """
    assert equiprobable_bins(4) == 4
    assert chi_squared_normality(np.array([-0.75, -0.75, 0.25, 1.25])) == pytest.approx(0.1573, abs=1e-4)


def test_the_sources_rule_finds_a_run_in_where_there_is_none():
    """Of discs that are normal from the start 0.95^24 = 29 % pass all tests of twelve revolutions at 5 % each; with the
    corrected significance 95 % do, but for the parameters that are fitted to the values.
    """
    rng = np.random.default_rng(11)
    sources, corrected = (rate_of_no_run_in(12, REPEATS, rng, each) for each in (False, True))
    assert abs(sources - 0.95**24) < SHARE_ERROR
    assert abs(corrected - 0.95) < SHARE_ERROR
    assert (1.0 - corrected_significance(24)) ** 24 == pytest.approx(0.95)


def test_a_volume_that_settles_has_its_change_point():
    """Volume per revolution falls to its level with revolution 5; what scatters about its mean has no run-in."""
    rng, revolution = np.random.default_rng(12), np.arange(1, 13)
    rate = 1.0 + 0.2 * np.maximum(5 - revolution, 0) + 0.01 * rng.standard_normal(12)
    volumes = pd.DataFrame({"run": "a", "revolution": revolution, "removed_volume_m3": np.cumsum(rate)})
    depth = {"size": "depth", "mean_m": 1.0, "deviation_m": 0.1 + 0.01 * rng.standard_normal(12)}
    statistics = pd.DataFrame({"run": "a", "revolution": revolution, **depth})
    found = change_points(statistics, volumes).set_index("series")
    volume, scatter = found.loc[VOLUME_SERIES], found.loc["deviation of depth over its mean"]
    assert volume["answer"] == ENDED
    assert volume["least_end_revolution"] <= 5 <= volume["last_end_revolution"] <= 6
    assert scatter["answer"] == NONE_FOUND and np.isnan(scatter["end_revolution"])


def test_equal_values_have_no_p_value():
    assert np.isnan(chi_squared_normality(np.full(CONTOURS, 3.0)))
    assert np.isnan(neighbour_correlation(np.full(CONTOURS, 3.0)))


def test_classes_of_360_contours():
    """2 * 360^0.4 = 21.06."""
    assert equiprobable_bins(CONTOURS) == 21


def test_neighbours_of_a_wave_and_of_noise():
    """cos(k angle) has the correlation cos(k * 1 degree); independent values have nearly none."""
    angle = np.radians(np.arange(CONTOURS))
    assert neighbour_correlation(np.cos(10.0 * angle)) == pytest.approx(np.cos(np.radians(10.0)), abs=ROUNDING)
    noise = np.random.default_rng(8).normal(size=CONTOURS)
    assert abs(neighbour_correlation(noise)) < 4.0 / np.sqrt(CONTOURS)  # four standard deviations


@pytest.mark.parametrize(
    ("depth", "width", "found"),
    [
        ([0.0, 0.2, 0.3], [0.0, 0.1, 0.2], 2),
        ([0.2, 0.0, 0.3], [0.2, 0.1, 0.2], 3),  # a later failure starts it again
        ([0.2, 0.2, 0.3], [0.2, 0.1, 0.2], 1),
        ([0.0, 0.2, 0.3], [0.0, 0.1, 0.01], None),
        ([0.0, 0.2, 0.3], [0.0, 0.1, float("nan")], None),
    ],
)
def test_run_in_by_hand(depth, width, found):
    """The first revolution from which on both stay above 5 %."""
    assert run_in_revolution([1, 2, 3], depth, width) == found


def test_run_in_of_the_published_table():
    """Table 5.3 gives revolution 8 by the same rule."""
    table = NORMALITY
    assert run_in_revolution(table["revolution"], table["depth_p_value"], table["width_p_value"]) == 8


def contours(spread):
    """Contours of two revolutions whose sizes are normal or exponential (the first one)."""
    rng = np.random.default_rng(9)
    kinds = {1: rng.exponential, 2: lambda spread, size: rng.normal(1.0, spread, size)}
    return pd.concat(
        pd.DataFrame(
            {name: draw(spread, CONTOURS) for name in ("depth_m", "opening_width_m", "area_width_m")}
            | {"run": "a", "revolution": revolution}
        )
        for revolution, draw in kinds.items()
    )


def test_statistics_and_run_in_of_a_run():
    """Each revolution and size has its mean, spread, extremes and p value; the run-in is the second revolution."""
    table = contours(0.1)
    statistics = revolution_statistics(table)
    assert len(statistics) == 2 * 3
    last = statistics[(statistics["revolution"] == 2) & (statistics["size"] == "depth")].iloc[0]
    depth = table.loc[table["revolution"] == 2, "depth_m"]
    assert (last["mean_m"], last["least_m"], last["largest_m"]) == (depth.mean(), depth.min(), depth.max())
    found = run_in_table(statistics, NORMALITY)
    assert found["run_in_revolution"].tolist() == [2, 8]
    assert found["corrected_run_in_revolution"].tolist() == [2, 7]  # 0.02 and 0.01 of 20 tests are no surprise
    assert found["revolutions"].tolist() == [2, 10]


def test_contours_are_taken_after_whole_revolutions(tmp_path):
    """Of cycles that end at 0.5, 1, 1.5 and 2 the second and fourth surface are read; depths are theirs."""
    flat = track_disc(22e-3, 20e-3, 24e-3, 0.5e-3, 0.8e-3)
    for cycle in range(1, 5):
        folder = tmp_path / f"cycle_{cycle:03d}"
        folder.mkdir()
        write_surface(folder / "surface.vtu", SurfaceMesh(flat.points - [0.0, 0.0, 1e-6 * cycle], flat.triangles))
    wear = pd.DataFrame({"cycle": [1, 2, 3, 4], "revolution": [0.5, 1.0, 1.5, 2.0 - 1e-12]})
    wear.to_csv(tmp_path / "wear.csv", index=False)
    table = contours_of_run(tmp_path, 22e-3)
    assert len(table) == 2 * CONTOURS
    np.testing.assert_allclose(table.groupby("revolution")["depth_m"].mean(), [2e-6, 4e-6], rtol=1e-9)
    wear[wear["cycle"] == 1].to_csv(tmp_path / "wear.csv", index=False)
    with pytest.raises(ValueError, match="no cycle ends with a whole revolution"):
        contours_of_run(tmp_path, 22e-3)


def test_whole_revolutions_are_whole():
    """Rounding is forgiven, a thousandth of a revolution is not."""
    wear = pd.DataFrame({"cycle": [1, 2, 3], "revolution": [0.999, 1.0 + 1e-9, 1.5]})
    assert whole_revolutions(wear)["cycle"].tolist() == [2]
    assert whole_revolutions(wear)["revolution"].tolist() == [1]


def test_published_ranges_are_in_metres():
    """42 to 70 um and 0.8 to 1.6 mm (Yan 2022, Fig 5.10 and 5.11)."""
    ranges = published_ranges(VALUES).set_index("size")
    np.testing.assert_allclose(ranges.loc["depth", ["least_m", "largest_m"]].astype(float), [42e-6, 70e-6])
    np.testing.assert_allclose(ranges.loc["opening width", ["least_m", "largest_m"]].astype(float), [0.8e-3, 1.6e-3])
    assert ranges["source"].tolist() == ["Yan 2022, Fig 5.10", "Yan 2022, Fig 5.11"]


def test_histogram_counts_every_contour():
    """Counts add up to the sample, and so does the normal curve but for its tails."""
    values = np.random.default_rng(3).normal(1.0, 0.1, 360)
    bars = size_histogram(values, 20)
    assert bars["count"].sum() == 360
    assert 350 < bars["normal_count"].sum() < 360


def test_words_of_the_run_in(pins):
    """A smooth wave round the disc is not normal: never for ours, 8 for the published depth."""
    _, runs, contours, _ = pins
    statistics = only_reference(statistics_of(runs, contours), runs, VALUES, REFERENCE)
    words = run_in_words(statistics, NORMALITY)
    assert words["depth"] == "normal from: conserving never, per triangle never, Yan 8"
