"""Units leave SI by the suffix of a column and nowhere else."""

import pandas as pd
import pytest

from bulkwear.postproc.tables.display import display_unit, few_digits, in_display_units

RELATIVE = 1e-12  # rounding of one product


@pytest.mark.parametrize(
    ("column", "shown", "factor"),
    [
        ("travel_m", "travel_mm", 1e3),
        ("worn_volume_m3", "worn_volume_mm3", 1e9),
        ("area_m2", "area_mm2", 1e6),
        ("largest_depth_m", "largest_depth_um", 1e6),
        ("worn_volume_per_metre_m3_per_m", "worn_volume_per_metre_mm3_per_m", 1e9),
        ("angular_speed_rad_per_s", "angular_speed_deg_per_s", 57.29577951308232),
        ("drag_per_m", "drag_per_m", 1.0),
        ("normal_force_N", "normal_force_N", 1.0),
        ("speed_m_per_s", "speed_m_per_s", 1.0),
        ("surface", "surface", 1.0),
    ],
)
def test_unit_follows_the_suffix(column, shown, factor):
    """A column's name tells its unit; only lengths, depths, areas, volumes and angles are scaled."""
    assert display_unit(column) == (shown, factor)


def test_values_are_scaled_with_their_names():
    """1e-9 m3 is 1 mm3; words pass through."""
    table = in_display_units(pd.DataFrame({"run": ["a"], "worn_volume_m3": [1e-9], "x_m": [0.5]}))
    assert list(table) == ["run", "worn_volume_mm3", "x_mm"]
    assert table["worn_volume_mm3"].iloc[0] == pytest.approx(1.0, rel=RELATIVE)
    assert table["x_mm"].iloc[0] == pytest.approx(500.0, rel=RELATIVE)


@pytest.mark.parametrize(
    ("value", "digits", "shown"),
    [(5523.4, 3, "5,520"), (12345.6, 4, "12,350"), (500.0, 4, "500"), (0.0123456, 3, "0.0123"), (1e6, 3, "1,000,000")],
)
def test_few_digits_without_an_exponent(value, digits, shown):
    """Thousands apart by commas."""
    assert few_digits(value, digits) == shown
