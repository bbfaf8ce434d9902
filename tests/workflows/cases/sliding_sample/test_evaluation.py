"""Wear gradients, relative wear, wear rate, regimes and steady windows, on histories in closed form."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.sliding_sample.evaluation import (
    CONTINUOUS,
    DISCONTINUOUS,
    MEASURES,
    UNDECIDED,
    flow_regime,
    gradient_history,
    regime_table,
    relative_to_largest,
    steady_table,
    wear_gradient,
    wear_rate,
)

ROUNDING = 1e-12
TRAVEL = np.arange(0.0, 1000.0, 10.0)
NAMES = {"row": "R1", "surface": "convex", "travel_mm": TRAVEL}


def history_of(**volumes):
    """History of runs with cycles every 100 mm, from volume functions of the travel (mm)."""
    travel = np.arange(0.0, 1001.0, 100.0)
    tables = [
        pd.DataFrame(
            {"run": run, "row": run[:2], "surface": "convex", "travel_mm": travel, "worn_volume_mm3": volume(travel)}
        )
        for run, volume in volumes.items()
    ]
    return pd.concat(tables, ignore_index=True)


def test_gradient_of_a_parabola():
    """The gradient of s^2 over an increment is twice its middle, whatever the increments."""
    travel = np.array([0.0, 1.0, 3.0, 7.0])
    np.testing.assert_allclose(wear_gradient(travel, travel**2), [1.0, 4.0, 10.0], rtol=ROUNDING)
    with pytest.raises(ValueError, match="the travel does not increase"):
        wear_gradient(np.array([0.0, 1.0, 1.0]), np.zeros(3))


def test_gradients_are_relative_to_the_largest_of_all_runs():
    """Of runs that wear at 1 and at 4 mm3/mm, one has 1/4 and the other 1, all along (Eq 3.8)."""
    table = gradient_history(history_of(R1_convex=lambda s: s, R2_convex=lambda s: 4.0 * s))
    found = table.groupby("run")["relative_gradient"].unique().to_dict()
    assert {run: list(values) for run, values in found.items()} == {"R1_convex": [0.25], "R2_convex": [1.0]}
    assert table["travel_mm"].iloc[:2].tolist() == [50.0, 150.0]
    assert gradient_history(history_of(R1_convex=np.zeros_like))["relative_gradient"].isna().all()


def test_relative_wear_is_within_the_group():
    """The largest of each group, convex or plain, has 1 (Eq 3.10)."""
    volume = pd.Series([1.0, 3.0, 8.0, 2.0])
    group = pd.Series(["A", "A", "B", "B"])
    assert relative_to_largest(volume, group).tolist() == [1.0 / 3.0, 1.0, 1.0, 0.25]


def test_wear_rate_is_per_mass_flow():
    """1e-9 m3 at 2 m/s over 0.04 x 0.3 m of 1500 kg/m3: 36 kg/s pass, by hand (Eq 3.11)."""
    assert wear_rate(1e-9, 2.0, 0.04, 0.3, 1500.0) == pytest.approx(1e-9 / 36.0, rel=ROUNDING)


@pytest.mark.parametrize(
    ("velocity", "surcharge", "regime"),
    [
        (0.15, 1.5, CONTINUOUS),
        (0.70, 1.5, CONTINUOUS),
        (0.98, 2.0, DISCONTINUOUS),
        (0.85, 1.01, DISCONTINUOUS),
        (0.98, 0.9, UNDECIDED),
        (0.98, float("nan"), UNDECIDED),
        (float("nan"), 2.0, UNDECIDED),
    ],
)
def test_regimes(velocity, surcharge, regime):
    """Particles that pass are continuous; that ride along and heap up, discontinuous; else it is not decided."""
    assert flow_regime(velocity, surcharge) == regime


def test_regimes_by_run():
    """A run without a surcharge is not called discontinuous."""
    table = regime_table({"R5_convex": 0.3, "R2_convex": 0.97, "R4_convex": 0.97}, {"R5_convex": 1.4, "R2_convex": 1.8})
    assert table["regime"].tolist() == [CONTINUOUS, DISCONTINUOUS, UNDECIDED]


def wavy(mean):
    """A measure that alternates by 1 % about its mean."""
    return mean * (1.0 + 0.01 * (-1.0) ** np.arange(len(TRAVEL)))


@pytest.fixture
def table():
    """R1_convex becomes steady after 300 mm in its flow alone; R1_plain wears ever more."""
    flow = np.where(TRAVEL < 300.0, 0.1 * TRAVEL, wavy(30.0))
    along = [pd.DataFrame({"run": run, **NAMES, MEASURES[0]: flow}) for run in ("R1_convex", "R1_plain")]
    gradients = [
        pd.DataFrame({"run": "R1_convex", **NAMES, MEASURES[1]: wavy(0.5)}),
        pd.DataFrame({"run": "R1_plain", **NAMES, MEASURES[1]: TRAVEL}),
    ]
    return steady_table(pd.concat(along), pd.concat(gradients), (500.0, 900.0)).set_index(["run", "measure"])


def test_both_measures_must_be_steady(table):
    """Together they are steady from the later start on; where one drifts there is no such place."""
    assert table["steady"].tolist() == [True, True, True, False]
    assert table["answer"].tolist() == ["steady"] * 3 + ["drifting"]
    assert 270.0 <= table.loc[("R1_convex", MEASURES[0]), "start_mm"] <= 320.0
    starts = table["common_start_mm"].groupby("run").first()
    assert starts["R1_convex"] == table.loc[("R1_convex", MEASURES[0]), "start_mm"]
    assert np.isnan(starts["R1_plain"])


def test_the_given_window_stands_beside(table):
    """Its mean is that of the values inside; a window that the travel does not fill has none."""
    assert table.loc[("R1_convex", MEASURES[0]), "published_mean"] == pytest.approx(30.0, rel=1e-3)
    line = pd.DataFrame({"run": "R1_convex", **NAMES, MEASURES[0]: 1.0, MEASURES[1]: 1.0})
    assert steady_table(line, line, (500.0, 1700.0))["published_mean"].isna().all()


def test_few_values_are_not_steady():
    """Of three values there is no window, and no claim."""
    line = pd.DataFrame({"run": "R1_convex", **NAMES, MEASURES[0]: 1.0, MEASURES[1]: 1.0})[:3]
    found = steady_table(line, line, (500.0, 900.0))
    assert found["steady"].tolist() == [False, False]
    assert found["answer"].tolist() == ["cannot be said"] * 2
    assert found[["mean", "common_start_mm"]].isna().all(axis=None)
