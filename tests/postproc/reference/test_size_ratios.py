"""Particle over bump: hemispheres, powers of one length, and the source's own pattern."""

import math

import pytest

from bulkwear.postproc.reference.size_ratios import (
    PUBLISHED_CRITICAL_SCALE,
    PUBLISHED_DIAMETER,
    PUBLISHED_PATTERN,
    equivalent_size_ratio,
    largest_scale,
    published_largest_scale,
    size_ratios,
)

ROUNDING = 1e-12  # relative


def test_a_particle_and_a_hemisphere_of_its_radius():
    """Twice the volume, twice the curved surface, the same projected area; equivalent radius as the cube root."""
    ratios = size_ratios(2.0, 1.0, 1.0, 1.0)
    assert ratios.volume == pytest.approx(2.0, rel=ROUNDING)
    assert ratios.surface_area == pytest.approx(2.0, rel=ROUNDING)
    assert ratios.projected_area == pytest.approx(1.0, rel=ROUNDING)
    assert ratios.equivalent_radius == pytest.approx(2.0 ** (1.0 / 3.0), rel=ROUNDING)


def test_areas_and_volume_of_a_semi_ellipsoid():
    """Ratios of the bodies themselves: pi R^2 over pi a b, 4/3 pi R^3 over 2/3 pi a b h; alpha_ER its cube root."""
    radius, (a, b, h) = 1.3, (2.0, 3.0, 5.0)
    ratios = size_ratios(2.0 * radius, a, b, h)
    assert ratios.projected_area == pytest.approx(math.pi * radius**2 / (math.pi * a * b), rel=ROUNDING)
    assert ratios.volume == pytest.approx(4 / 3 * math.pi * radius**3 / (2 / 3 * math.pi * a * b * h), rel=ROUNDING)
    assert ratios.equivalent_radius**3 == pytest.approx(ratios.volume, rel=ROUNDING)


def test_ratios_know_no_unit():
    """Particle and bump in millimetres or in metres."""
    for one, other in zip(
        vars(size_ratios(2.65, 4.0, 8.0, 6.0)).values(),
        vars(size_ratios(2.65e-3, 4e-3, 8e-3, 6e-3)).values(),
        strict=True,
    ):
        assert one == pytest.approx(other, rel=ROUNDING)


def test_scales_of_the_sources_pattern():
    """R5: alpha_ER reaches 1 at 3.46, the source's critical scale is 4, where it is 1.157."""
    assert largest_scale(PUBLISHED_DIAMETER, *PUBLISHED_PATTERN) == pytest.approx(math.cbrt(96.0) / 1.325, rel=ROUNDING)
    assert published_largest_scale(PUBLISHED_DIAMETER, *PUBLISHED_PATTERN) == PUBLISHED_CRITICAL_SCALE
    at_four = equivalent_size_ratio(4.0 * PUBLISHED_DIAMETER, *PUBLISHED_PATTERN)
    assert at_four == pytest.approx(1.157, abs=5e-4)


@pytest.mark.parametrize("find", [largest_scale, published_largest_scale])
def test_at_the_largest_scale_sizes_are_equal_whatever_the_pattern(find):
    """The ratio of scaled particle to bump is one number there; twice the particle is half the scale."""
    bump = (8e-3, 2e-3, 6e-3)
    one, two = find(1e-3, *bump), find(2e-3, *bump)
    assert one == pytest.approx(2.0 * two, rel=ROUNDING)
    ours = equivalent_size_ratio(one * 1e-3, *bump)
    theirs = equivalent_size_ratio(
        find(PUBLISHED_DIAMETER, *PUBLISHED_PATTERN) * PUBLISHED_DIAMETER, *PUBLISHED_PATTERN
    )
    assert ours == pytest.approx(theirs, rel=ROUNDING)
