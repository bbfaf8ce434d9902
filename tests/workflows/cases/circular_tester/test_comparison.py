"""Convex over plain by revolution, and patterns that wear off: known laws come back."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.circular_tester.comparison import (
    mean_ratios,
    pattern_left,
    ratios_by_revolution,
    worn_out_at,
)
from bulkwear.workflows.cases.circular_tester.volume import whole_revolutions

EXACT = 1e-9


def volumes(machines, packings=1, scatter=0.0):
    """Volumes by {(shape, scale): (plain, convex) mm3 per revolution}, three revolutions in halves; each bed wears
    alternately more and less by `scatter`, and its convex sample by as much again.
    """
    x = np.arange(0.0, 3.25, 0.5)
    parts = []
    for packing in range(1, packings + 1):
        for (shape, scale), rates in machines.items():
            for surface, rate in zip(("plain", "convex"), rates, strict=True):
                of_bed = (1.0 + scatter * (-1.0) ** packing) ** (2 if surface == "convex" else 1)
                case = {"surface": surface, "shape": shape, "particle_scale": scale, "packing": packing}
                case |= {"run": f"{shape}{scale}{surface}{packing}", "elements": 10}
                parts.append(pd.DataFrame({"revolution": x, "volume_m3": 1e-9 * of_bed * rate * x}).assign(**case))
    return pd.concat(parts, ignore_index=True)


def test_ratios_are_those_of_equal_machines():
    """Each pair has its own ratio; a machine or a packing without a pair has none; of one packing no interval."""
    table = volumes({("channel", 6.0): (80.0, 60.0), ("ring", 6.0): (80.0, 56.0)})
    table = table[~((table["shape"] == "ring") & (table["revolution"] > 2.0))]
    whole = whole_revolutions(table)
    assert set(whole["revolution"]) == {0.0, 1.0, 2.0, 3.0}
    ratios = ratios_by_revolution(whole)
    assert ratios.groupby("shape").size().to_dict() == {"channel": 3, "ring": 2}
    means = mean_ratios(ratios, shared=True).set_index("shape")
    assert means["ratio"].to_dict() == pytest.approx({"channel": 0.75, "ring": 0.7}, rel=EXACT)
    assert (means["revolutions"] == 2).all() and means[["ratio_low", "reduction_percent_high"]].isna().all(axis=None)
    assert mean_ratios(ratios, shared=False).set_index("shape")["revolutions"].to_dict() == {"channel": 3, "ring": 2}
    alone = whole[~((whole["shape"] == "ring") & (whole["surface"] == "plain"))]
    assert set(ratios_by_revolution(alone)["shape"]) == {"channel"}


def test_a_ratio_is_taken_packing_by_packing():
    """What a bed does to both samples is no scatter of their ratio; its interval is that of its logarithm."""
    ratios = ratios_by_revolution(whole_revolutions(volumes({("channel", 6.0): (80.0, 40.0)}, 4, 0.1)))
    row = mean_ratios(ratios, shared=False).iloc[0]
    logs = np.log(0.5 * np.array([0.9, 1.1, 0.9, 1.1]))
    reach = 3.182446 * logs.std(ddof=1) / 2.0  # t of three degrees of freedom at 95 %
    assert row["ratio"] == pytest.approx(np.exp(logs.mean()), rel=EXACT) and row["packings"] == 4
    assert row["ratio_low"] == pytest.approx(np.exp(logs.mean() - reach), rel=1e-6)
    assert row["reduction_percent_low"] == pytest.approx(100.0 * (1.0 - np.exp(logs.mean() + reach)), rel=1e-6)
    assert row["change_percent"] == pytest.approx(0.0, abs=1e-6)
    lacking = ratios_by_revolution(
        whole_revolutions(volumes({("channel", 6.0): (80.0, 40.0)}, 2).query("run != 'channel6.0plain2'"))
    )
    assert lacking["packing"].unique().tolist() == [1]


def test_a_larger_coefficient_is_told_in_revolutions_of_the_study():
    """Half the pattern gone after three revolutions at ten times the coefficient is half of it after thirty."""
    x = np.arange(7.0)
    rows = pd.DataFrame({"revolution": x, "law_volume_m3": 4e-7 * x, "pattern_volume_m3": 1e-6 * (1.0 - x / 6.0)})
    rows = rows.assign(run="worn-out", surface="convex", particle_scale=6.0, coefficient=5e-8, packing=1)
    left = pattern_left(rows, 5e-9, 45.0)
    half = left[np.isclose(left["pattern_share"], 0.5)].iloc[0]
    assert half["revolution"] == pytest.approx(30.0, rel=EXACT)
    assert half["lost_per_revolution_mm3"] == pytest.approx(40.0, rel=EXACT)
    assert worn_out_at(left)["worn_out_revolution"].tolist() == pytest.approx([60.0], rel=EXACT)
    assert worn_out_at(left[left["revolution"] < 50.0])["worn_out_revolution"].isna().all()
    assert worn_out_at(left)["lost_over_plain"].tolist() == pytest.approx([40.0 / 45.0], rel=EXACT)
    assert worn_out_at(left)["faster_revolution"].isna().all()


def test_when_a_pattern_that_wears_off_loses_more_than_plain():
    """A loss per revolution that grows like the revolutions passes the plain sample's where they say so."""
    x = np.arange(101.0)
    rows = pd.DataFrame({"revolution": x, "law_volume_m3": 1e-9 * x**2, "pattern_volume_m3": 1e-6 * (1.0 - x / 100.0)})
    rows = rows.assign(run="a", surface="convex", particle_scale=6.0, coefficient=5e-9, packing=1)
    left = pattern_left(rows, 5e-9, 120.0)
    end = worn_out_at(left).iloc[0]  # increments 2 x - 1, means of five of them the same
    assert end["faster_for_good_revolution"] == 61.0
    dips = left.assign(plain_per_revolution_mm3=np.where(left["revolution"] == 80.0, 1e9, 120.0))
    assert worn_out_at(dips)[["faster_revolution", "faster_for_good_revolution"]].iloc[0].tolist() == [61.0, 81.0]
    ends_below = worn_out_at(dips[dips["revolution"] <= 80.0]).iloc[0]
    assert ends_below["faster_revolution"] == 61.0 and np.isnan(ends_below["faster_for_good_revolution"])
    assert end["faster_revolution"] == 61.0 and end["faster_share"] == pytest.approx(0.39, rel=EXACT)
    assert end["lost_over_plain"] == pytest.approx(100.0 / 120.0, rel=EXACT)
