"""Numbers in sentences have readable units, and say no more than their intervals do."""

import math

import pytest

from bulkwear.workflows.report.sentences import (
    friction_between,
    less_or_more,
    listed,
    measured,
    sentence,
    side,
    with_interval,
)


@pytest.mark.parametrize(
    ("value", "unit", "said"),
    [
        (12.34, "µm", "12 µm"),
        (18_234.0, "µm", "18 mm"),
        (999.9, "µm", "1 mm"),
        (994.0, "µm", "990 µm"),
        (2.5e6, "µm", "2.5 m"),
        (-1500.0, "mm", "-1.5 m"),
        (18_234.0, "mm³", "18\u202f000 mm³"),
        (0.5, "-", "0.5"),
        (math.nan, "µm", "\u2013 µm"),
    ],
)
def test_units_are_readable(value, unit, said):
    """From a thousand on the coarser one, by the number as it is shown; no exponent hides a number."""
    assert measured(value, unit) == said


def test_an_interval_has_the_unit_of_its_mean():
    """Of one packing the scatter is unknown; of several without an interval it is, too."""
    assert with_interval(1800.0, 900.0, 2700.0, 3, "µm") == "1.8 mm (95 % interval 0.9 to 2.7, 3 packings)"
    assert with_interval(1.8, math.nan, math.nan, 1) == "1.8 (one packing, scatter unknown)"
    assert with_interval(1.8, math.nan, math.nan, 2) == "1.8 (scatter unknown)"


def test_less_or_more_is_said_where_the_interval_says_so():
    """On one side of 1 with its ends in order; across 1 neither; without an interval nothing."""
    assert less_or_more(0.5, 0.4, 0.6) == ": 50 % less (40 to 60 %)"
    assert less_or_more(1.25, 1.1, 1.4) == ": 25 % more (10 to 40 %)"
    assert less_or_more(0.9, 0.7, 1.1) == ": neither less nor more can be said"
    assert less_or_more(0.9, math.nan, math.nan) == ""
    assert [side(*ends) for ends in ((1.1, 2.0), (0.1, 0.9), (0.9, 1.1), (math.nan, math.nan))] == [1, -1, 0, 0]


def test_words_make_a_sentence():
    """Items with commas and an and, a capital, a full stop; nothing of nothing."""
    assert [listed(items) for items in ([], ["a"], ["a", "b"], ["a", "b", "c"])] == ["", "a", "a and b", "a, b and c"]
    assert sentence("no more") == "No more." and sentence("") == ""


def test_the_friction_between_particles_is_told_with_their_material():
    """A range where runs differ; each material once."""
    gravel = {"name": "gravel", "contact": {"sliding_friction": 0.24, "rolling_friction": 0.4}}
    said = "Between particles (gravel) sliding friction is 0.24, rolling friction 0.4."
    assert friction_between([gravel, gravel]) == said
    ore = {"name": "ore", "contact": {"sliding_friction": 0.24, "rolling_friction": 0.1}}
    assert friction_between([gravel, ore]).endswith(
        "(gravel and ore) sliding friction is 0.24, rolling friction 0.1 to 0.4."
    )
