"""Experiment, thesis and runs of the circular wear tester side by side: every number stands in its place."""

import math
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.postproc.statistics.verdicts import AGREES, OTHER_SIZE
from bulkwear.workflows.cases.circular_tester.hours import predictions, time_scale
from bulkwear.workflows.cases.circular_tester.key_numbers import (
    measured_beside_ours,
    predicted_rates,
    with_fits,
)
from bulkwear.workflows.cases.circular_tester.model_numbers import fits_beside_ours
from bulkwear.workflows.cases.circular_tester.tables import (
    BEYOND,
    LABORATORY,
    OURS,
    THESIS,
    THESIS_ALIKE,
    comparison_table,
    loss_rows,
)
from bulkwear.workflows.cases.circular_tester.volume import fits_beside, times_source
from bulkwear.workflows.report.published import published_numbers as collected
from bulkwear.workflows.report.sections import Section, Table
from tests.support import tester_study as study

RUN = SimpleNamespace(coefficient=5e-9, width=0.1, length=0.1, distance_per_revolution=1.071)
LAWS = {name: law for name, law in study.LAWS.items() if name[1] == 3}


def compared(foreign=(), **changes):
    lost = study.volumes(LAWS, **changes)
    scale = time_scale(lost[lost["surface"] == "plain"], RUN, study.PUBLISHED)
    predicted = predictions(lost, scale, [56.0, 184.0])
    table = comparison_table(predicted, study.PUBLISHED, study.PUBLISHED_FITS, 3.0, foreign)
    return table.set_index(["hours", "quantity"])


def test_comparison_table():
    """Three columns beside each other; the thesis' model from its equations at its own two revolutions per 56 h."""
    table = compared(packings=2)
    columns = [LABORATORY, THESIS, THESIS_ALIKE, OURS]
    assert table.loc[(56.0, "plain volume"), columns].to_list() == pytest.approx([145.2, 147.28, 154.06, 145.2])
    assert table.loc[(56.0, "convex volume"), THESIS_ALIKE] == pytest.approx(2 * 47.12 + 4 * 0.78)
    assert table.loc[(184.0, "reduction"), THESIS] == pytest.approx(56.0, abs=0.2)
    assert table.loc[(184.0, "reduction"), LABORATORY] == pytest.approx(49.4, abs=0.1)
    x = 145.2 / 75.0
    convex = 45.0 + 0.75 + (45.0 + 3.0 * 0.75) * (x - 1.0)  # one revolution, and of the next what its line has
    assert table.loc[(56.0, "reduction"), OURS] == pytest.approx(100.0 * (1.0 - convex / 145.2))
    assert "swaps" in table.loc[(184.0, "convex volume"), "note"]
    assert table.loc[(56.0, "convex volume"), "note"] == ""
    assert table.loc[(56.0, "reduction"), "note"] == "the thesis' text has 68.9 % for its model"


def test_notes_say_what_is_extrapolated_and_what_is_not_sure():
    """Three revolutions are beyond 56 h but not half of 184; one packing has no interval, several have."""
    table = compared(revolutions=3, packings=3, scatter=0.02)
    assert table.loc[(56.0, "convex volume"), "note"] == "" and table.loc[(56.0, "convex volume"), "packings"] == 3
    row = table.loc[(56.0, "convex volume")]
    assert row["interval_low"] < row[OURS] < row["interval_high"]
    assert "more than 2 times" in table.loc[(184.0, "reduction"), "note"]
    assert np.isnan(table.loc[(184.0, "reduction"), OURS])
    assert BEYOND in compared(revolutions=5, packings=3).loc[(184.0, "reduction"), "note"]
    alone = compared()
    assert alone["note"].str.contains(UNKNOWN).all() and alone["interval_low"].isna().all()


def test_measured_volumes_are_published_numbers():
    """The experiment's volumes, and the model's with its reduction; those of the plain sample, which sets the scale of
    time, are given, as is its share of eight hours; one not reached is missing."""
    ours = compared(revolutions=3, packings=3, scatter=0.02)
    table = measured_beside_ours(ours.reset_index())
    found = {(row.quantity, row.setting): row for row in table.itertuples()}
    measured = {name: row.published_value for name, row in found.items()}
    assert sorted(measured.values()) == pytest.approx(
        [10.2, 17.9, 68.9, 82.8, 145.2, 154.06, 212.9, 240.3, 474.5, 483.9]
    )
    assert table.loc[table["given"] == "yes", "published_value"].tolist() == [*(145.2, 474.5, 17.9, 154.06, 483.9)]
    early, late = (found["convex volume", f"experiment after {hours} h"] for hours in (56, 184))
    assert early.computed_low < early.computed_value < early.computed_high and early.packings == 3
    ratio = 1.0 - ours.loc[(56.0, "reduction"), ["interval_high", OURS, "interval_low"]].to_numpy(float) / 100.0
    further = np.log(ratio[[0, 2]] / ratio[1])  # of one further packing: twice the reach of a mean of three
    mean = np.log(np.array([early.computed_low, early.computed_high]) / early.computed_value)
    np.testing.assert_allclose(further, 2.0 * mean, rtol=1e-9)  # by the ratio, as the plain sample tells the hours
    assert np.isnan(late.computed_value) and "more than 2 times" in late.reason
    share, model = (
        found["convex volume", "experiment per 8 h"],
        found["reduction", "model after 56 h, particle scale 1"],
    )
    assert [share.computed_value, share.computed_high] == pytest.approx(
        [early.computed_value / 7.0, early.computed_high / 7.0]
    )
    assert model.unit == "%" and model.computed_value == pytest.approx(
        100.0 * (1.0 - early.computed_value / found["plain volume", "experiment after 56 h"].computed_value), rel=0.02
    )


@pytest.mark.parametrize(("foreign", "kept", "given"), [(["convex"], 5, 5), (["plain", "convex"], 2, 2)])
def test_nothing_published_stands_beside_samples_that_are_not_the_sources(foreign, kept, given):
    """Neither in the comparison nor among the published numbers; plain volumes, of which one sets the scale of time,
    stay, as given.
    """
    table = compared(foreign, packings=2)
    beside = [LABORATORY, THESIS, THESIS_ALIKE]
    known = table[table[beside].notna().any(axis=1)]
    assert set(known.index.get_level_values("quantity")) == {"plain volume"}
    assert table.loc[(56.0, "plain volume"), LABORATORY] == 145.2 and table[OURS].notna().all()
    assert not table["note"].str.contains("% for its model").any()
    numbers = measured_beside_ours(table.reset_index())
    assert set(numbers["quantity"]) == {"plain volume"} and len(numbers) == kept
    assert (numbers["given"] == "yes").sum() == given


def test_fits_are_told_at_the_coefficient_and_of_the_sources_samples():
    """At twice the coefficient a revolution takes twice as much, and as much more from one to the next; a rate of a
    surface that is not the source's has none beside it.
    """
    rates = pd.DataFrame({"surface": ["plain", "convex"], "particle_scale": 3.0, "revolutions": 10.0})
    twice = times_source(1e-8, study.PUBLISHED)
    own, doubled = (with_fits(rates, fits_beside(study.PUBLISHED_FITS, (), times)) for times in (1.0, twice))
    assert twice == 2.0 and own["fit_mm3_per_revolution"].tolist() == pytest.approx([77.03, 47.12 + 10 * 0.78])
    assert doubled["fit_mm3_per_revolution"].tolist() == pytest.approx((2.0 * own["fit_mm3_per_revolution"]).tolist())
    assert doubled["fit_change_percent"].tolist() == pytest.approx(own["fit_change_percent"].tolist())
    foreign = with_fits(rates, fits_beside(study.PUBLISHED_FITS, {"convex": "why"}))
    assert foreign["fit_mm3_per_revolution"].notna().tolist() == [True, False]


def test_fits_stand_beside_rates_of_their_surface_and_scale():
    """Scales that the source has none of leave no line; the interval over packings decides."""
    rates = pd.DataFrame(
        {
            "surface": ["plain", "convex", "convex"],
            "shape": "channel",
            "particle_scale": [1.0, 4.0, 6.0],
            "revolutions": 17.0,
            "rate_mm3_per_revolution": [73.0, 100.0, 40.0],
            "rate_mm3_per_revolution_low": [72.0, 99.0, 39.0],
            "rate_mm3_per_revolution_high": [74.0, 101.0, 41.0],
            "packings": 3,
        }
    )
    beside = fits_beside_ours(with_fits(rates, fits_beside(study.PUBLISHED_FITS, (), 1.0)))
    found = collected([Section("Volume", [Table(rates, beside_source=beside)])]).set_index("finding")
    names = ("plain, particle scale 1", "convex, particle scale 4")
    plain, convex = (f"worn volume per revolution, {name}, channel" for name in names)
    assert found["verdict"].to_dict() == {plain: AGREES, convex: OTHER_SIZE}
    assert found.loc[convex, "factor"] == pytest.approx(100.0 / (41.62 + 17.0 * 1.57))


def test_losses_stand_beside_the_scanned_ones():
    """Largest loss of each bump in mm after 184 h over packings; runs that end earlier say where."""
    losses = pd.DataFrame({"bump": ["C11", "C15"] * 2, "loss_mm": [0.4, 0.6, 0.6, 0.6], "packing": [1, 1, 2, 2]})
    table = loss_rows(losses, study.PUBLISHED, 6.5, 6.57).set_index("quantity")
    assert table[LABORATORY].to_dict() == {"largest loss of C11": 0.34, "largest loss of C15": 0.35}
    assert table[OURS].to_list() == pytest.approx([0.5, 0.6]) and (table["note"] == "").all()
    assert (table["hours"] == 184.0).all() and table[THESIS].isna().all() and (table["packings"] == 2).all()
    short = loss_rows(losses.head(2), study.PUBLISHED, 4.0, 6.57)
    assert short["note"].iloc[0] == f"ours after 4 revolutions, 184 h are 6.57; {UNKNOWN}"


def test_rates_with_the_error_of_the_coefficient():
    """Per revolution 10 (9 to 11) mm3 and a fifth of the coefficient; without an error nothing more is told."""
    row = {"surface": "plain", "shape": "channel", "particle_scale": 6.0, "packings": 3}
    ends = {"rate_mm3_per_revolution": 10.0, "rate_mm3_per_revolution_low": 9.0, "rate_mm3_per_revolution_high": 11.0}
    assert predicted_rates(pd.DataFrame([row | ends]), 0.0) == []
    (table,) = predicted_rates(pd.DataFrame([row | ends]), 0.2)
    found = table.data.iloc[0]
    assert found["high"] == pytest.approx(10.0 * math.exp(math.hypot(0.1, math.log(1.2))))
    assert found["low"] == pytest.approx(10.0 * math.exp(-math.hypot(0.1, math.log(0.8))))
    assert "the plain sample's measured volume sets them" in table.note
