"""Settings in SI: lists, rates, speeds of rotation, masses, and names of blocks that end like a unit."""

from __future__ import annotations

import math

import pytest

from bulkwear.workflows.config.units import TO_SI, to_si
from bulkwear.workflows.config.validation import UNIT_OF_SUFFIX

ROUNDING = 1e-15  # relative; of a product


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"rate_t_per_h": 36.0}, {"rate_kg_per_s": 10.0}),
        ({"speed_rpm": -30.0}, {"speed_rad_per_s": -math.pi}),
        ({"throughput_mt": 0.5}, {"throughput_kg": 5e8}),
        ({"turn_deg_per_s": 180.0}, {"turn_rad_per_s": math.pi}),
        ({"duration_h": 2.0}, {"duration_s": 7200.0}),
        ({"size_mm": [500.0, -2.0, 0.0]}, {"size_m": [0.5, -0.002, 0.0]}),
        ({"velocity_m_per_s": [1.0, 2.0, 3.0]}, {"velocity_m_per_s": [1.0, 2.0, 3.0]}),
        ({"phase_deg": [90.0]}, {"phase_rad": [math.pi / 2]}),
        ({"hours_per_year_h": 1.0}, {"hours_per_year_s": 3600.0}),
    ],
)
def test_a_value_or_each_of_a_list_is_converted_with_its_key(given, expected):
    """Key and value change together; every value of a list does; SI stays."""
    ((key, value),) = to_si(given).items()
    assert {key} == set(expected) and value == pytest.approx(expected[key], rel=ROUNDING)


def test_the_name_of_a_block_stays_whatever_it_ends_in():
    """Parts and materials may be called as they like; only a block `deck` at the top is the user's own words."""
    parts = {"wall_h": {"edge_mm": 20.0}, "gravel_3_mm": {"edge_mm": 30.0}, "deck": {"edge_mm": 40.0}}
    converted = to_si({"parts": parts, "deck": {"width_mm": 7}})
    assert converted["parts"] == {"wall_h": {"edge_m": 0.02}, "gravel_3_mm": {"edge_m": 0.03}, "deck": {"edge_m": 0.04}}
    assert converted["deck"] == {"width_mm": 7}


def test_every_unit_that_is_converted_can_be_written():
    """Each end of a key that is converted is one that the schemas spell, and none hides behind a shorter one."""
    assert set(TO_SI) <= set(UNIT_OF_SUFFIX)
    ends = list(TO_SI)
    hidden = [(a, b) for k, a in enumerate(ends) for b in ends[k + 1 :] if b.endswith(f"_{a}")]
    assert hidden == []
