"""What a study of the circular wear tester answers: no more than its packings tell, from any rows that have a pair."""

import pandas as pd
import pytest

from bulkwear.postproc.statistics.verdicts import AGREES, CONTRADICTS, UNSAID
from bulkwear.workflows.cases.circular_tester import answers, page
from tests.support.tester_study import PUBLISHED, PUBLISHED_FITS

NAN = float("nan")
ONE = "(one packing, scatter unknown)"
MEAN = {"shape": "channel", "particle_scale": 6.0, "revolutions": 4, "packings": 1, "ratio": 0.504}
SCALE = pd.Series(
    {
        "packings": 1,
        "hours_per_revolution": 9.0,
        "revolutions_of_short_test": 6.0,
        "revolutions_of_short_test_low": NAN,
        "revolutions_of_short_test_high": NAN,
        "simulated_revolutions": 4.0,
    }
)


def test_pattern_against_plain():
    """One packing has a number, several an interval and what it says; of several machines each is named."""
    one = pd.DataFrame([MEAN | {"ratio_low": NAN, "ratio_high": NAN}])
    assert answers.ratios(one, "convex") == [
        f"The convex sample loses 0.5 {ONE} of the plain one's volume over 4 revolutions."
    ]
    (said,) = answers.ratios(one.assign(ratio_low=0.4, ratio_high=0.6, packings=3), "convex")
    assert "0.5 (95 % interval 0.4 to 0.6, 3 packings)" in said and said.endswith(": 50 % less (40 to 60 %).")
    (said,) = answers.ratios(one.assign(ratio_low=0.4, ratio_high=1.6, packings=3), "convex")
    assert said.endswith("revolutions: neither less nor more can be said.")
    ring = answers.ratios(pd.concat([one, one.assign(shape="ring", revolutions=1)]), "convex")[1]
    assert "loses in the ring, with particles at scale 6, 0.5" in ring and ring.endswith("over 1 revolution.")


def test_hours_of_a_revolution():
    """By the plain sample's volume; more revolutions in the short test are fewer hours each."""
    said = answers.hours(SCALE)
    assert f"for 9 h {ONE} of the real test" in said and said.endswith(
        "4 revolutions that are simulated stand for 36 h."
    )
    ends = {"revolutions_of_short_test_low": 5.4, "revolutions_of_short_test_high": 6.75, "packings": 3}
    assert "9 h (95 % interval 8 to 10, 3 packings)" in answers.hours(pd.Series({**SCALE, **ends}))


def test_volume_beside_the_experiment():
    """Where both are known, with the interval of one further packing and whether the measured volume is in it."""
    row = {"hours": 56.0, "quantity": "convex volume", "experiment": 80.0, "ours": 72.0, "note": "ours extrapolated"}
    alone = pd.DataFrame([row | {"interval_low": NAN, "interval_high": NAN}])
    assert answers.beside_experiment(alone, "convex") == [
        "After 56 h the convex sample has lost 72 mm³ (one packing, scatter unknown, extrapolated), 0.9 times the"
        " measured 80 mm³."
    ]
    for high, inside in ((90.0, True), (75.0, False)):
        several = alone.assign(interval_low=60.0, interval_high=high, note=NAN)
        (said,) = answers.beside_experiment(several, "convex")
        assert ("is within the interval" in said) == inside and ("which is outside the interval." in said) != inside
    assert answers.beside_experiment(alone.assign(ours=NAN), "convex") == []
    assert answers.beside_experiment(alone, "disc") == []


@pytest.mark.parametrize(
    ("value", "low", "high", "said"),
    [
        (7.5, 15.0, 18.0, "0.5 times the least published (15 to 18 N)"),
        (36.0, 15.0, 18.0, "2 times the largest published (15 to 18 N)"),
        (16.0, 15.0, 18.0, "within the published 15 to 18 N"),
        (14.0, 28.0, 28.0, "0.5 times the published 28 N"),
        (28.0, 28.0, 28.0, "as the published 28 N"),
    ],
)
def test_a_value_beside_published_ones(value, low, high, said):
    """Over the nearest end of a range, or within it."""
    assert answers.beside(value, low, high, "N") == said


def test_rates_and_forces_are_set_beside_the_source():
    """The plain sample's rate at the source's coefficient; at twice it the source's is doubled. Forces of the source's
    pattern alone are compared.
    """
    rates = pd.DataFrame([{"surface": "plain", "particle_scale": 6.0, "packings": 1, "rate_mm3_per_revolution": 36.82}])
    rates = rates.assign(rate_mm3_per_revolution_low=NAN, rate_mm3_per_revolution_high=NAN)
    (said,) = answers.plain_rates(rates, PUBLISHED_FITS, PUBLISHED, 5e-9)
    assert f"takes 37 mm³ {ONE}" in said and "0.5 times the least published (74 to 77 mm³)" in said
    assert "0.25 times" in answers.plain_rates(rates, PUBLISHED_FITS, PUBLISHED, 1e-8)[0]
    force = pd.DataFrame(
        {"surface": ["plain", "convex", "convex"], "revolution": [1, 2, 1], "mean": [16.0, 20.0, 14.0]}
    )
    plain, convex = answers.forces(force, PUBLISHED, "convex")
    assert plain.endswith("with 16 N, within the published 15 to 18 N.")
    assert convex.endswith("on the convex one with 14 N, 0.5 times the published 28 N.")
    assert answers.forces(force[force["surface"] == "plain"], PUBLISHED, "convex") == [plain]
    assert "published" not in answers.forces(force.replace("convex", "disc"), PUBLISHED, "disc", {"disc"})[1]
    foreign = {"plain", "convex"}
    assert answers.plain_rates(rates, PUBLISHED_FITS, PUBLISHED, 5e-9, foreign) == [
        f"A revolution takes 37 mm³ {ONE} off the plain sample at particle scale 6."
    ]
    assert not any("published" in words for words in answers.forces(force, PUBLISHED, "convex", foreign))


def test_a_pattern_that_is_gone_is_told_in_hours():
    """Of a pattern that stays nothing is said."""
    left = pd.DataFrame(
        {
            "run": "worn-out",
            "revolution": [100.0, 200.0],
            "pattern_share": [0.5, 0.01],
            "lost_mm3": [1.0, 3.0],
            "mean_per_revolution_mm3": [0.01, 0.02],
            "plain_per_revolution_mm3": 0.015,
        }
    )
    (said,) = answers.gone(left, 10.0)
    assert said.startswith("The pattern of worn-out is gone after 200 revolutions (2\u202f000 h); its sample wears")
    assert said.endswith("faster than plain from 200 revolutions (2\u202f000 h) on.")
    assert answers.gone(left.head(1), 10.0) == []


def test_claims_are_counted():
    """Those that agree first, others beside; a study without a pair has nothing to say but that."""
    verdicts = pd.DataFrame({"verdict": [AGREES, UNSAID, UNSAID, CONTRADICTS]})
    assert answers.claims(verdicts) == "Of the source's findings 1 of 4 agree (contradicts 1, cannot be said 2)."
    assert answers.claims(verdicts.head(1)) == "Of the source's findings 1 of 1 agree."


def test_rows_without_a_pair_are_not_compared(tmp_path):
    """Each is told by itself, whatever tables there are: two packings of 2 and 4 mm3 a revolution under 10 N, of which
    the bed slides over a half; a sample that nothing touches is not told.
    """
    summary = pd.DataFrame(
        {
            "setting": ["mine", "mine", "high"],
            "surface": "plain",
            "revolutions": 2.0,
            "travel_m": 3.0,
            "worn_volume_m3": [4e-9, 8e-9, 0.0],
            "mean_normal_force_N": [10.0, 10.0, 0.0],
            "sliding_work_J": [15.0, 15.0, 0.0],
        }
    )
    summary.to_csv(tmp_path / "summary.csv", index=False)
    (told, unpaired) = page.facts({"told": {"paired": False}, "figures": {}}, tmp_path)
    assert unpaired == page.UNPAIRED
    assert (
        told.startswith("A revolution takes 3 mm³ (95 % interval ")
        and "2 packings) off the plain sample of mine; " in told
    )
    assert "the bed presses on it with 10 N (95 % interval 10 to 10 N, 2 packings)" in told.replace(
        "10 to 10, ", "10 to 10 N, "
    )
    assert "slides over it by 50 %" in told and told.endswith(" of the travel.")
