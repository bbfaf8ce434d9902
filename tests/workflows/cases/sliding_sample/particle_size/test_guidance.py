"""Guidance: what sizes let expect, on the source's pattern and on made-up ones."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.intervals import students_t
from bulkwear.workflows.cases.sliding_sample.particle_size.guidance import (
    PUBLISHED_SCALES,
    Particles,
    Pattern,
    guidance,
    guidance_table,
    line_ratio,
    own_line,
    published_at_scales,
    published_bias,
    published_line,
)
from tests import PUBLISHED

LINES = pd.read_csv(PUBLISHED / "particle_size_lines.csv")
R5 = Pattern(4e-3, 8e-3, 6e-3, gap=44e-3)
GRAVEL = Particles(2.65e-3, [2.12e-3, 2.65e-3, 3.18e-3], [0.25, 0.5, 0.25])
ROUNDING = 1e-12  # relative
RUNS = 2000
FOUR_ERRORS = 4.0 * (0.95 * 0.05 / RUNS) ** 0.5


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


def wear_of_scales(**curves):
    """Wear by curve and scale, a bed per value: rows S4-0, S4-1, ..."""
    rows = [
        (f"S{scale}-{bed}", curve, scale, wear)
        for curve, of in curves.items()
        for scale, wears in of.items()
        for bed, wear in enumerate(wears)
    ]
    return pd.DataFrame(rows, columns=["row", "curve", "particle_scale", "relative_wear"])


def test_the_published_lines_stand_beside_our_means():
    """At the least and the largest scale that the source has too; Eq 4.15 at 4 is 0.96, at 8 2.0."""
    plain = {4: (0.8, 1.25), 8: (0.9, 1.0)}
    wear = wear_of_scales(convex={4: (0.4, 0.6), 6: (0.8,), 8: (1.0, 1.2), 12: (1.3,)}, plain=plain)
    table = published_at_scales(wear, LINES).set_index("setting")
    named = ["convex at scale 4", "convex at scale 8", "plain at scale 4", "plain at scale 8"]
    assert sorted(table.index) == named
    np.testing.assert_allclose(table.loc[named[:2], "published_value"], [0.96, 2.0], rtol=ROUNDING)
    geometric = [(0.4 * 0.6) ** 0.5, (1.0 * 1.2) ** 0.5]
    np.testing.assert_allclose(table.loc[named[:2], "computed_value"], geometric, rtol=ROUNDING)
    assert (table["packings"] == 2).all()
    given = {"plain at scale 4": "yes"}  # over itself, 1 whatever is found
    assert table["given"].to_dict() == dict.fromkeys(named, "") | given
    alone = wear_of_scales(convex={4: (0.4,), 8: (1.0, 1.2)}, plain={4: (1.0,), 8: (0.9,)})
    assert published_at_scales(alone, LINES)["computed_low"].isna().all()  # the plain one that all is over has one bed


def test_beside_the_published_lines_both_samples_scatter():
    """Of one bed both wear in proportion, so that it leaves no scatter; at another scale that of both counts."""
    bed = np.array([0.8, 1.0, 1.25])
    wear = wear_of_scales(convex={4: 0.5 * bed, 8: 2.0 * bed}, plain={4: bed, 8: bed})
    table = published_at_scales(wear, LINES).set_index("setting")
    width = np.log(table["computed_high"] / table["computed_low"])
    assert width["convex at scale 4"] == pytest.approx(0.0, abs=ROUNDING)
    scatter = np.log(bed).std(ddof=1) * np.sqrt(2.0 / len(bed))
    freedom = 2.0 * (len(bed) - 1.0)  # by Welch, of two that scatter alike
    expected = 2.0 * students_t(0.975, freedom) * scatter
    np.testing.assert_allclose(width[["convex at scale 8", "plain at scale 8"]], expected, rtol=1e-9)


def test_the_published_line_tells_what_scale_does_to_wear():
    """Eq 4.15 at scales 2 and 4 over that at 1, 5.33; a pattern of half the size sees it at half the scale.

    It is not extended to particles smaller than the source's, nor beyond its largest scale.
    """
    assert published_bias(R5, GRAVEL, 1.0, LINES) == (1.0, 1.0, 1.0)
    assert published_bias(R5, GRAVEL, 2.0, LINES)[0] == pytest.approx(0.44 / 0.18, rel=ROUNDING)
    assert published_bias(R5, GRAVEL, 4.0, LINES)[0] == pytest.approx(0.96 / 0.18, rel=ROUNDING)
    half = Pattern(2e-3, 4e-3, 3e-3, gap=22e-3)
    assert published_bias(half, GRAVEL, 2.0, LINES)[0] == pytest.approx(0.96 / 0.44, rel=1e-9)
    for particles, scale in ((scaled(0.9), 2.0), (GRAVEL, 8.1)):
        assert np.isnan(published_bias(R5, particles, scale, LINES)).all()


def test_the_studys_own_line_is_not_the_published_one():
    """0.25 + 0.0561 s, the standard study's: 1.55 times at scale 4, where Eq 4.15 has 5.33, outside its interval."""
    scale = np.array([2.0, 3.0, 4.0, 6.0, 8.0])
    own = own_line(scale, 0.25 + 0.0561 * scale + 0.005 * np.array([1.0, -1.0, -1.0, 1.0, 0.0]))
    ratio, low, high = line_ratio(own, 4.0, 1.0)
    assert ratio == pytest.approx(1.55, abs=0.02) and low < ratio < high
    assert high < published_bias(R5, GRAVEL, 4.0, LINES)[1]
    assert own.scales == (2.0, 8.0) and own_line(scale[:2], scale[:2]) is None


def test_no_line_is_told_that_the_packings_reject():
    """Packings that agree within a per cent about a curve; about a line they do not."""
    scale = np.repeat([2.0, 4.0, 6.0, 8.0], 3)
    scatter = 0.005 * np.tile([-1.0, 0.0, 1.0], 4)
    assert own_line(scale, 0.25 + 0.06 * scale + scatter) is not None
    assert own_line(scale, 0.25 + 0.3 * np.sqrt(scale - 2.0) + scatter) is None


def test_the_published_scatter_is_that_of_its_r_squared():
    """A line with residuals that make R2 = 0.98 over scales 1 to 8 has the covariance that `own_line` finds of it."""
    residuals = np.random.default_rng(4).normal(size=8)
    matrix = np.column_stack([np.ones(8), PUBLISHED_SCALES])
    residuals -= matrix @ np.linalg.lstsq(matrix, residuals, rcond=None)[0]
    fitted = -0.08 + 0.26 * PUBLISHED_SCALES
    left = (1.0 / 0.98 - 1.0) * ((fitted - fitted.mean()) ** 2).sum()
    found = own_line(PUBLISHED_SCALES, fitted + residuals * np.sqrt(left / (residuals**2).sum()))
    told = published_line(LINES)
    np.testing.assert_allclose(found.covariance, told.covariance, rtol=1e-9)
    np.testing.assert_allclose(found.coefficients, told.coefficients, rtol=1e-9)


def test_intervals_of_ratios_hold_95_percent():
    """Of lines through eight noisy values, 95 % of intervals hold the true ratio at scale 4 over 1."""
    generator, held = np.random.default_rng(7), 0
    for _ in range(RUNS):
        wear = 0.25 + 0.0561 * PUBLISHED_SCALES + 0.02 * generator.normal(size=8)
        _, low, high = line_ratio(own_line(PUBLISHED_SCALES, wear), 4.0, 1.0)
        held += low < 0.4744 / 0.3061 < high
    assert held / RUNS == pytest.approx(0.95, abs=FOUR_ERRORS)


def test_what_cannot_be_told_from_zero_has_no_interval():
    """Below zero at the reference there is no ratio; near zero there is one without ends."""
    steep = own_line(np.array([1.0, 2.0, 3.0]), np.array([-1.0, 0.1, 1.0]))
    assert np.isnan(line_ratio(steep, 3.0, 1.0)).all()
    unsure = own_line(np.array([1.0, 2.0, 3.0]), np.array([0.1, 0.5, 0.7]))
    ratio, *ends = line_ratio(unsure, 3.0, 1.0)
    assert ratio > 0.0 and np.isnan(ends).all()


def test_the_table_has_a_row_for_each_pattern():
    """Scale beside its limit, row by row; the own line is the study's, whatever the row's pattern."""
    wear = pd.DataFrame({"particle_scale": [2.0, 3.0, 4.0], "relative_wear": [0.37, 0.42, 0.48]})
    patterns = {"R5": R5, "small": Pattern(2e-3, 2e-3, 1.5e-3, gap=36e-3)}
    table = guidance_table(patterns, GRAVEL, {"R5": 2.0, "small": 2.0}, LINES, wear)
    assert list(table["row"]) == ["R5", "small"]
    assert list(table["within_largest_scale"]) == [True, False]
    assert table["published_bias"].notna().all() and (table["own_line_from_scale"] == 2.0).all()
    assert (table["own_bias"] == 1.0).all()
    larger = guidance_table(patterns, GRAVEL, {"R5": 4.0, "small": 4.0}, LINES, wear)
    assert (larger["own_bias"] - 0.48 / 0.37).abs().max() < 0.01
    assert (larger["own_bias_low"] < larger["own_bias"]).all() and (larger["own_bias"] < larger["own_bias_high"]).all()
    assert guidance_table(patterns, GRAVEL, {"R5": 2.0, "small": 2.0}, LINES, wear[:2])["own_bias"].isna().all()
