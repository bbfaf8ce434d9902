"""Verdicts on claims: the four answers, what they need, and how rarely they are false."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from benchmarks.interval_coverage import RATES, RULES, SIDE, SIZE, rules_hash, verdict_rows
from bulkwear.postproc.statistics.intervals import UNKNOWN, Ends, Estimate, estimate
from bulkwear.postproc.statistics.verdicts import (
    AGREES,
    ALLOWED,
    CONTRADICTS,
    OTHER_SIZE,
    UNSAID,
    Claim,
    judged,
    not_said,
)

TRIALS = 60
CHANCE = 4.0 * 100.0 * math.sqrt(ALLOWED * (1.0 - ALLOWED) / TRIALS)  # %, four standard errors of a rate


def about(value, error=0.005):
    return Estimate(value, error, 10, 11)


@pytest.mark.parametrize(
    ("value", "verdict"),
    [
        (0.6, AGREES),
        (0.65, AGREES),
        (0.7, UNSAID),
        (0.8, OTHER_SIZE),
        (0.3, OTHER_SIZE),
        (1.0, UNSAID),
        (1.1, CONTRADICTS),
    ],
)
def test_a_magnitude_with_direction_has_four_answers(value, verdict):
    """Claimed: below 1, 0.6 within 0.1."""
    found = judged(SIZE, about(value))
    assert found.verdict == verdict
    if verdict == OTHER_SIZE:
        assert found.factor == pytest.approx((value - 1.0) / (0.6 - 1.0))
    assert bool(found.reason) == (verdict == UNSAID)


@pytest.mark.parametrize(("value", "verdict"), [(0.9, AGREES), (1.0, UNSAID), (1.1, CONTRADICTS)])
def test_a_direction_alone_has_no_size(value, verdict):
    """Claimed: below 1; above the other way round."""
    assert judged(SIDE, about(value)).verdict == verdict
    other = {AGREES: CONTRADICTS, CONTRADICTS: AGREES}.get(verdict, verdict)
    assert judged(replace(SIDE, direction="above"), about(value)).verdict == other


@pytest.mark.parametrize(("value", "verdict"), [(20.0, AGREES), (72.0, AGREES), (75.0, UNSAID), (90.0, CONTRADICTS)])
def test_a_magnitude_alone_is_contradicted_from_outside(value, verdict):
    """Claimed: 15 to 70, within 5."""
    claim = Claim("range", "", "", "share", magnitude=(15.0, 70.0), margin=5.0)
    assert judged(claim, about(value, 0.5)).verdict == verdict


def test_too_little_evidence_says_nothing():
    """One packing, a wide interval, no run at all, or runs that do not reach what is claimed."""
    assert judged(SIZE, estimate([0.6])).reason == UNKNOWN
    assert judged(SIZE, about(0.6, 0.2)).verdict == UNSAID
    assert "no run" in judged(SIZE, {}).reason
    reach = replace(SIZE, reach=(0.0, 17.0), reach_unit="revolutions")
    assert judged(reach, about(0.6), covers=(0.0, 17.0)).verdict == AGREES
    assert (
        judged(reach, about(0.6), covers=(0.0, 4.0)).reason == "claimed of 0 to 17 revolutions, the runs cover 0 to 4"
    )
    assert not_said("no plain twin").verdict == UNSAID


def test_what_stays_open_is_told():
    """Claimed: below 1, 0.6 within 0.1; the size, or the direction, or the direction of what is of another size."""
    assert judged(SIZE, about(0.7)).reason.startswith("the direction is as claimed, the size is open: ")
    assert judged(replace(SIZE, told_side=False), about(0.7)).reason == "the interval passes an end of the margin"
    wide, narrow = judged(SIZE, about(0.9, 0.2)).reason, judged(SIZE, about(1.0)).reason
    assert wide.endswith("the direction is open") and narrow == f"{wide}, the size is not as claimed"
    assert judged(SIDE, about(1.0)).reason == wide


def test_a_claim_about_several_needs_all_of_them():
    """It agrees where each does, and is contradicted by one that is sure even among so many."""
    good = {f"R{k}": about(0.6) for k in range(5)}
    assert judged(SIDE, good).verdict == AGREES
    assert judged(SIDE, good | {"R5": about(1.0)}).verdict == UNSAID
    assert judged(SIDE, good | {"R5": about(1.1)}).verdict == CONTRADICTS
    barely = Estimate(1.0 + 2.0 * 0.005, 0.005, 10, 11)  # sure at 5 %, not at 5 % over six
    assert judged(SIDE, barely).verdict == CONTRADICTS and judged(SIDE, good | {"R5": barely}).verdict == UNSAID
    assert judged(SIZE, good | {"R5": about(0.9)}).verdict == OTHER_SIZE
    assert "R5: 0.900 (95 % interval" in judged(SIZE, good | {"R5": about(0.9)}).found


def test_ends_are_judged_as_they_stand():
    """An interval that is no mean's, as that of a crossing; an open end excludes nothing there."""
    claim = Claim("critical", "", "", "scale", direction="above", magnitude=(4.0, 4.0), margin=0.6)
    assert judged(claim, Ends(4.0, 3.6, 4.4, 3)).verdict == AGREES
    assert judged(claim, Ends(9.0, 8.0, math.inf, 3)).verdict == OTHER_SIZE
    assert judged(claim, Ends(9.0, -math.inf, math.inf, 3)).verdict == UNSAID
    assert judged(claim, Ends(9.0, math.nan, math.nan, 1)).reason == UNKNOWN
    with pytest.raises(ValueError, match="allowed is 0\\.025"):
        judged(claim, {name: Ends(4.0, 3.6, 4.4, 3) for name in "abc"})


@pytest.mark.verify
def test_false_verdicts_are_rare():
    """On the edge of every claim each false answer has its rate, for two packings as for five."""
    for row in verdict_rows(TRIALS):
        assert row["largest_percent"] <= row["allowed_percent"] + CHANCE, row


def test_the_published_rates_are_those_of_these_rules():
    """The table beside the claims was made with the code there is, for every rule, and keeps the allowed rate."""
    table = pd.read_csv(RATES)
    assert set(table["code"]) == {rules_hash()}, "python -m benchmarks.interval_coverage"
    assert set(table["rule"]) == {rule.name for rule in RULES}
    assert (table["largest_percent"] <= table["allowed_percent"]).all()
    assert np.isfinite(table["largest_percent"]).all()
