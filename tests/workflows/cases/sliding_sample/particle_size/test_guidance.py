"""Guidance: what sizes let expect, on the source's pattern and on made-up ones."""

import pandas as pd
import pytest

from bulkwear.workflows.cases.sliding_sample.particle_size.guidance import (
    Particles,
    Pattern,
    guidance,
    guidance_table,
    published_bias,
)
from tests import PUBLISHED

LINES = pd.read_csv(PUBLISHED / "particle_size_lines.csv")
R5 = Pattern(4e-3, 8e-3, 6e-3, gap=44e-3)
GRAVEL = Particles(2.65e-3, [2.12e-3, 2.65e-3, 3.18e-3], [0.25, 0.5, 0.25])
ROUNDING = 1e-12  # relative


def scaled(factor):
    """Gravel whose real particles are that many times larger."""
    return Particles(factor * GRAVEL.median_diameter, [factor * d for d in GRAVEL.diameters], GRAVEL.mass_fractions)


def test_the_sources_pattern_helps_its_gravel():
    """R5 with gravel: alpha_ER 0.289, helps up to 3.46 times the size; 44 mm are free between its bumps."""
    told = guidance(R5, GRAVEL)
    assert told["equivalent_radius"] == pytest.approx(0.2894, abs=5e-5) and told["helps"]
    assert told["largest_scale"] == pytest.approx(3.456, abs=5e-4)
    assert told["published_largest_scale"] == pytest.approx(4.0, rel=ROUNDING)
    assert told["gap_over_diameter"] == pytest.approx(44.0 / 2.65, rel=ROUNDING)
    assert told["larger_share"] == 0.0


def test_larger_gravel_is_not_helped():
    """At 3.2 times the size the coarsest quarter is larger than the bumps; at 4 times most of it, and no help."""
    some, most = guidance(R5, scaled(3.2)), guidance(R5, scaled(4.0))
    assert some["helps"] and some["larger_share"] == 0.25
    assert not most["helps"] and most["larger_share"] == 0.75 and most["largest_scale"] < 1.0


def test_the_published_line_tells_what_scale_does_to_wear():
    """Eq 4.15 at scales 2 and 4 over that at 1; a pattern of half the size sees it at half the scale."""
    assert published_bias(R5, GRAVEL, 1.0, LINES) == 1.0
    assert published_bias(R5, GRAVEL, 2.0, LINES) == pytest.approx(0.44 / 0.18, rel=ROUNDING)
    half = Pattern(2e-3, 4e-3, 3e-3, gap=22e-3)
    assert published_bias(half, GRAVEL, 2.0, LINES) == pytest.approx(0.96 / 0.44, rel=1e-9)
    assert pd.isna(published_bias(R5, scaled(0.3), 2.0, LINES))  # the line is below zero there


def test_the_table_has_a_row_for_each_pattern():
    """Scale beside its limit, row by row."""
    table = guidance_table(
        {"R5": R5, "small": Pattern(2e-3, 2e-3, 1.5e-3, gap=36e-3)}, GRAVEL, {"R5": 2.0, "small": 2.0}, LINES
    )
    assert list(table["row"]) == ["R5", "small"]
    assert list(table["within_largest_scale"]) == [True, False]
    assert table["published_bias"].notna().all()
