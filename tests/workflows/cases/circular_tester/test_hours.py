"""Hours of the test: the plain sample sets them, what lies beyond a run is marked, of one packing nothing is sure."""

from types import SimpleNamespace

import numpy as np
import pytest

from bulkwear.workflows.cases.circular_tester.hours import TOO_FAR, TOO_FEW, predictions, time_scale
from tests.support import tester_study as study

COEFFICIENT = 5e-9  # 1/Pa, of the synthetic runs
SECTOR = 2.142 / 2  # m per revolution (Yan 2022, section 6.4.1: 2.142 m in two)
AREA = 0.01  # m2
RUN = SimpleNamespace(coefficient=COEFFICIENT, width=0.1, length=0.1, distance_per_revolution=SECTOR)
TRIALS = 100
LEAST_INSIDE = 0.95 - 3.0 * np.sqrt(0.95 * 0.05 / TRIALS)  # three deviations of the count


def scale_of(lost):
    return time_scale(lost[lost["surface"] == "plain"], RUN, study.PUBLISHED)


def test_time_scale_rests_on_the_plain_sample():
    """56 h are as many revolutions as wear 145.2 mm3; the coefficient for two revolutions is in proportion."""
    scale = scale_of(study.volumes(packings=2))
    assert scale.revolutions(56.0) == pytest.approx(145.2 / 75.0)
    assert scale.wear_coefficient.value == pytest.approx(COEFFICIENT * 145.2 / 150.0)
    assert scale.laboratory_coefficient == pytest.approx(145.2e-9 / (1200.0 * AREA * 0.6 * 56.0 * 3600.0))
    assert scale.distance_scale == pytest.approx(0.6 * 56.0 * 3600.0 / (145.2 / 75.0 * SECTOR))


def test_beyond_the_plain_run_its_mean_rate_tells_the_hours():
    """One revolution of 75 mm3 tells where 145.2 mm3 would be; that it is beyond is in the table."""
    row = scale_of(study.volumes(packings=2, revolutions=1)).table().iloc[0]
    assert row["revolutions_of_short_test"] == pytest.approx(145.2 / 75.0) and row["simulated_revolutions"] == 1.0


def test_predictions():
    """The plain sample is met at 56 h by construction; the convex one is predicted; beyond a run is said; beyond twice
    of it nothing is made.
    """
    lost = study.volumes(packings=2)
    table = predictions(lost, scale_of(lost), [56.0, 184.0, 600.0, 2000.0])
    table = table.set_index(["surface", "particle_scale", "hours"])
    assert table.loc[("plain", 3.0, 56.0), "volume_mm3"] == pytest.approx(145.2)
    x = 600.0 / 56.0 * 145.2 / 75.0
    row = table.loc[("convex", 3.0, 600.0)]
    assert row["volume_mm3"] == pytest.approx(45.0 * x + 0.75 * x**2)
    assert row["reduction_percent"] == pytest.approx(100.0 * (1.0 - (45.0 + 0.75 * x) / 75.0))
    assert table.loc[("plain", 3.0, 184.0), "reduction_percent"] == pytest.approx(0.0, abs=1e-9)
    assert np.isnan(table.loc[("convex", 1.0, 56.0), "reduction_percent"])  # no plain run of its scale
    assert table["extrapolated"].to_dict() == {key: key[2] >= 600.0 for key in table.index}
    far = table.xs(2000.0, level="hours")
    assert far["volume_mm3"].isna().all() and (far["reason"] == TOO_FAR).all()
    assert (table.drop(index=2000.0, level="hours")["reason"] == "").all()
    one = study.volumes(packings=2, revolutions=1)
    assert predictions(one, scale_of(one), [56.0])["reason"].unique().tolist() == [TOO_FEW]


def test_a_patterned_volume_is_as_unsure_as_its_ratio_to_the_plain_one():
    """The same packings tell the hours: what both samples of a bed wear more of is no scatter."""
    lost = study.volumes(packings=3, scatter=0.1)
    table = predictions(lost, scale_of(lost), [56.0]).set_index(["surface", "particle_scale"])
    row = table.loc[("convex", 3.0)]
    left = 1.0 - row[["reduction_percent_high", "reduction_percent", "reduction_percent_low"]].to_numpy(float) / 100.0
    volumes = row[["volume_mm3_low", "volume_mm3", "volume_mm3_high"]].to_numpy(float)
    np.testing.assert_allclose(volumes / volumes[1], left / left[1])


def test_one_packing_has_no_prediction_interval():
    """Volumes and reductions are there, their intervals are not."""
    lost = study.volumes(noise=0.05)
    scale = scale_of(lost)
    table = predictions(lost, scale, [56.0])
    ends = [f"{name}_{end}" for name in ("volume_mm3", "reduction_percent") for end in ("low", "high")]
    assert table[ends].isna().all(axis=None) and table["volume_mm3"].notna().all()
    assert not scale.revolutions_of_short_test.known


@pytest.mark.verify
def test_a_further_packing_falls_into_the_prediction_interval():
    """In at least 95 % of trials: four packings of which each goes on beyond its run, and a fifth that is simulated."""
    inside = []
    for seed in range(TRIALS):
        lost = study.volumes({("plain", 3): (75.0, 0.0)}, 5, 0.03, 0.05, revolutions=12, seed=seed)
        seen = lost[(lost["packing"] < 5) & (lost["revolution"] <= 8.0)]
        hours = 12.0 * scale_of(seen).hours_per_revolution
        row = predictions(seen, scale_of(seen), [hours]).iloc[0]
        fifth = 1e9 * lost[(lost["packing"] == 5) & (lost["revolution"] == 12.0)]["volume_m3"].item()
        inside.append(row["volume_mm3_low"] < fifth < row["volume_mm3_high"])
    assert np.mean(inside) >= LEAST_INSIDE
