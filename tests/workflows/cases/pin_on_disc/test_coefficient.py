"""Calibration of the wear coefficient against hand numbers of the laboratory's test."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.wear.coefficient import coefficient_of_volume, laboratory_coefficient, scaling_factor
from bulkwear.workflows.cases.pin_on_disc.coefficient import (
    PUBLISHED_FITS,
    TOUCHED,
    calibrated,
    calibration_table,
    coefficient_of_laboratory,
    scaling_limits,
    step_cap_limits,
)
from tests import PUBLISHED
from tests.support import pin_study

VOLUME, ERROR, LOAD, DISTANCE, REVOLUTIONS = 0.565e-9, 0.089e-9, 5.0, 180.0, 1302.5  # m3, m3, N, m, -
CIRCLE = DISTANCE / REVOLUTIONS  # m
VALUES = pd.read_csv(PUBLISHED / "pin_on_disc.csv")
FITS = pd.read_csv(PUBLISHED / "pin_on_disc_volume.csv")


def test_laboratory_coefficient():
    """0.565 mm3 over 900 J are 6.28e-13 1/Pa, +- 0.99e-13: the thesis' (6.3 +- 1)e-13."""
    found, error = laboratory_coefficient(VOLUME, ERROR, LOAD, DISTANCE)
    assert found == pytest.approx(6.278e-13, rel=1e-3)
    assert error == pytest.approx(0.989e-13, rel=1e-3)
    assert error / found == pytest.approx(ERROR / VOLUME)
    assert coefficient_of_laboratory(VALUES) == pytest.approx((found, error))


def test_scaling_factors():
    """1302.5 revolutions by 8 are 162.8, by 12 they are 108.5."""
    np.testing.assert_allclose(scaling_factor(REVOLUTIONS, [8, 12]), [162.8, 108.5], atol=0.05)


def test_power_law_is_met_between_and_proportion_beyond():
    """V = c alpha^1.5 is met exactly between simulated coefficients; beyond them the volume goes on in proportion."""
    alpha = np.array([5e-11, 1e-11, 2e-11])
    volumes = alpha**1.5
    assert coefficient_of_volume(alpha, volumes, 3e-11**1.5) == (pytest.approx(3e-11), True)
    assert coefficient_of_volume(alpha, volumes, 2.0 * volumes[0]) == (pytest.approx(1e-10), False)
    assert coefficient_of_volume(alpha, volumes, 0.5 * volumes[1]) == (pytest.approx(0.5e-11), False)


def test_one_coefficient_gives_the_proportion():
    assert coefficient_of_volume([1e-11], [1e-10], 3e-10) == (pytest.approx(3e-11), False)


def test_volumes_that_do_not_grow_are_refused():
    with pytest.raises(ValueError, match="do not grow"):
        coefficient_of_volume([1e-11, 2e-11], [2e-10, 1e-10], 1.5e-10)


def test_calibration_by_archard_alone():
    """Where the volume is alpha F L, N revolutions need the laboratory's coefficient times the scaling factor."""
    simulated = pd.DataFrame(
        [
            {"scheme": "conserving", "revolution": n, "wear_coefficient_per_pa": alpha}
            | {"volume_m3": alpha * LOAD * CIRCLE * n}
            for n in (8, 12)
            for alpha in (1e-11, 5e-11, 2e-10)
        ]
    )
    table = calibration_table(simulated, VOLUME, ERROR, REVOLUTIONS)
    law, error = laboratory_coefficient(VOLUME, ERROR, LOAD, DISTANCE)
    for column, value in (("", law), ("least_", law - error), ("largest_", law + error)):
        found = table[f"{column}wear_coefficient_per_pa"]
        np.testing.assert_allclose(found, value * table["scaling_factor"], rtol=1e-12)
    assert table["interpolated"].all()
    assert table.loc[1, "wear_coefficient_per_pa"] == pytest.approx(6.81e-11, rel=1e-3)


def test_limit_of_the_scaling_factor():
    """Eight revolutions of run-in allow 162.8; a run-in that has not ended allows no factor yet."""
    run_in = pd.DataFrame({"run": ["a", "b"], "run_in_revolution": [8.0, np.nan]})
    np.testing.assert_allclose(scaling_limits(run_in, REVOLUTIONS)["largest_factor"], [162.8125, np.nan])


def test_limit_by_the_cap_of_steps():
    """Steps at a hundredth of their cap in the last revolution allow a hundred times the coefficient's own factor."""
    volumes = pd.DataFrame(
        {"run": "a", "revolution": [1, 2], "wear_coefficient_per_pa": 6.0e-11, "step_demand": [0.005, 0.01]}
    )
    assert step_cap_limits(volumes, 6.0e-13)["largest_factor_by_step_cap"].tolist() == [pytest.approx(1e4)]


def test_calibration_of_all_schemes(pins):
    """Volumes in proportion to the coefficient need the laboratory's coefficient times the scaling over the excess."""
    *_, volumes = pins
    table = calibrated(volumes, FITS, VALUES)
    ours = table[table["scheme"] == "per_triangle"].iloc[-1]
    circle = 2.0 * np.pi * pin_study.TRACK
    expected = 0.565e-9 / (pin_study.LOAD * circle * 3 * pin_study.RISE * 6.0)
    assert ours["wear_coefficient_per_pa"] == pytest.approx(expected, rel=1e-6)
    touched = table[table["scheme"] == TOUCHED].iloc[-1]  # Eq 5.9 finds half: twice the coefficient
    assert touched["wear_coefficient_per_pa"] == pytest.approx(2.0 * expected, rel=1e-6)
    assert set(table["scheme"]) == {"conserving", "per_triangle", TOUCHED, PUBLISHED_FITS}


@pytest.mark.parametrize("runs", [["c"], ["a", "b", "c", "d", "h"]])
def test_another_load_gives_the_same_coefficient(pins, runs):
    """Runs of twice the load, one or all, wear twice as much, and the laboratory's test asks for the same of them."""
    *_, volumes = pins
    other = volumes.copy()
    other.loc[other["run"].isin(runs), ["load_n", "removed_volume_m3", "touched_centroid_path_volume_m3"]] *= 2.0
    pd.testing.assert_frame_equal(calibrated(other, FITS, VALUES), calibrated(volumes, FITS, VALUES))


@pytest.mark.parametrize(("revolutions", "theirs"), [(1, False), (2, False), (3, True)])
def test_few_revolutions_are_calibrated_without_the_published_fits(pins, revolutions, theirs):
    """After 1 and 2 revolutions the published fits do not grow with the coefficient: ours alone are calibrated."""
    *_, volumes = pins
    table = calibrated(volumes[volumes["revolution"] <= revolutions], FITS, VALUES)
    assert set(table["revolutions"]) == {revolutions}
    assert {"conserving", "per_triangle"} < set(table["scheme"])
    assert (PUBLISHED_FITS in set(table["scheme"])) == theirs
