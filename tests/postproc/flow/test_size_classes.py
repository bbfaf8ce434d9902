"""Size classes of curves whose quantiles are closed forms."""

import numpy as np
import pytest

from bulkwear.postproc.flow.size_classes import size_classes

SIEVES, PASSING = [0.001, 0.1], [0.0, 1.0]  # m, -: a straight line in the logarithm of the size
CURVE = [0.002, 0.005, 0.01, 0.02, 0.04], [0.05, 0.2, 0.5, 0.9, 1.0]
ROUNDING = 1e-12  # -, of sums and logarithms of a few numbers


def quantile(mass):
    """Size (m) below which a part of the mass of the straight line lies."""
    return 0.001 * 100.0**mass


@pytest.mark.parametrize(("finest", "classes"), [(0.0, 1), (0.0, 4), (0.1, 3), (0.5, 2)])
def test_a_straight_line(finest, classes):
    """Middles of equal masses above the cut; the smallest class has the fines besides its own mass."""
    found = size_classes(SIEVES, PASSING, finest, classes)
    middles = [finest + (1.0 - finest) * (2 * k + 1) / (2 * classes) for k in range(classes)]
    assert found.diameters_m == pytest.approx([quantile(middle) for middle in middles], rel=ROUNDING)
    own = (1.0 - finest) / classes
    assert found.mass_fractions == pytest.approx([own + finest, *[own] * (classes - 1)], rel=ROUNDING)
    assert found.median_m == pytest.approx(0.01, rel=ROUNDING)


def test_a_middle_on_a_sieve_is_the_sieve():
    """One class without a cut has the median, which is a sieve of the curve."""
    found = size_classes(*CURVE, 0.0, 1)
    assert found.diameters_m == pytest.approx([0.01], rel=ROUNDING)
    assert found.median_m == pytest.approx(0.01, rel=ROUNDING)


def test_half_of_each_class_is_finer():
    """At each diameter the curve passes the mass of the finer classes and half of the class's own above the cut."""
    found = size_classes(*CURVE, 0.1, 5)
    passed = np.interp(np.log(found.diameters_m), np.log(CURVE[0]), CURVE[1])
    own = 0.9 / 5.0
    assert passed == pytest.approx(0.1 + own * (np.arange(5) + 0.5), rel=ROUNDING)
    assert found.mass_fractions.sum() == pytest.approx(1.0, rel=ROUNDING)


def test_sizes_go_with_the_sieves():
    """Twice the sieves, twice the diameters, the same masses."""
    first, other = size_classes(*CURVE, 0.1, 4), size_classes(2.0 * np.array(CURVE[0]), CURVE[1], 0.1, 4)
    assert other.diameters_m == pytest.approx(2.0 * first.diameters_m, rel=ROUNDING)
    assert other.median_m == pytest.approx(2.0 * first.median_m, rel=ROUNDING)
    assert np.array_equal(other.mass_fractions, first.mass_fractions)


def test_the_order_of_the_sieves_does_not_matter():
    """Coarsest first, as laboratories list them."""
    first, other = size_classes(*CURVE, 0.1, 4), size_classes(CURVE[0][::-1], CURVE[1][::-1], 0.1, 4)
    assert np.array_equal(first.diameters_m, other.diameters_m)
    assert first.told == other.told


def test_sieves_that_tell_nothing_change_nothing():
    """Further sieves that all or nothing passes, and one on the line between two others."""
    between = np.sqrt(0.01 * 0.02)
    sieves = [0.0001, 0.001, 0.01, between, 0.02, 0.04, 0.08]
    found = size_classes(sieves, [0.0, 0.0, 0.5, 0.7, 0.9, 1.0, 1.0], 0.0, 7)
    least = size_classes([0.001, 0.01, 0.02, 0.04], [0.0, 0.5, 0.9, 1.0], 0.0, 7)
    assert found.diameters_m == pytest.approx(least.diameters_m, rel=ROUNDING)


def test_a_larger_cut_never_makes_a_finer_material():
    """Diameters rise with the fraction that is cut off."""
    sizes = np.array([size_classes(*CURVE, cut, 4).diameters_m for cut in (0.0, 0.05, 0.1, 0.2, 0.4)])
    assert (np.diff(sizes, axis=0) > 0.0).all()


def test_the_rule_is_told():
    """With the cut, the classes and the median."""
    assert size_classes(SIEVES, PASSING, 0.1, 2).told == (
        "The finest 10 % by mass are counted to the smallest class; the rest is divided into 2 classes of equal mass,"
        " each with the diameter at its middle mass: 4.47 mm (55 %), 35.5 mm (45 %). Half of all mass is finer than"
        " 10 mm."
    )
    assert size_classes(SIEVES, PASSING, 0.0, 1).told.startswith("The material is divided into 1 class of equal mass")


@pytest.mark.parametrize(
    ("sieves", "passing", "finest", "classes", "sentence"),
    [
        ([0.01], [1.0], 0.1, 4, "found 1 sieves, allowed are 2 or more"),
        ([0.01, 0.02], [1.0], 0.1, 4, "found 2 sieves and 1 values of passing, allowed is one per sieve"),
        ([0.0, 0.02], [0.0, 1.0], 0.1, 4, "found the sieve 0 mm, allowed are sizes above 0"),
        ([0.02, np.nan], [0.0, 1.0], 0.1, 4, "found the sieve nan mm, allowed are sizes above 0"),
        ([0.01, 0.01, 0.02], [0.0, 0.5, 1.0], 0.1, 4, "found the sieve 10 mm twice, allowed is each sieve once"),
        ([0.01, 0.02], [0.0, 100.0], 0.1, 4, "100 passes the largest sieve, allowed is 1; passing is a fraction"),
        ([0.01, 0.02], [0.0, 0.98], 0.1, 4, "0.98 passes the largest sieve, allowed is 1"),
        ([0.01, 0.02, 0.03], [0.4, 0.3, 1.0], 0.1, 4, "0.3 passes the sieve of 20 mm, allowed is 0.4 or more"),
        ([0.01, 0.02, 0.03], [0.4, np.nan, 1.0], 0.1, 4, "nan passes the sieve of 20 mm, allowed is 0.4 or more"),
        ([0.01, 0.02], [-0.1, 1.0], 0.1, 4, "-0.1 passes the sieve of 10 mm, allowed is 0 or more"),
        ([0.01, 0.02], [0.0, 1.0], 1.0, 4, "the finest fraction is 1, allowed is 0 to less than 1"),
        ([0.01, 0.02], [0.0, 1.0], -0.1, 4, "the finest fraction is -0.1, allowed is 0 to less than 1"),
        ([0.01, 0.02], [0.0, 1.0], 0.1, 0, "found 0 size classes, allowed are whole numbers from 1 on"),
        ([0.01, 0.02], [0.0, 1.0], 0.1, 2.5, "found 2.5 size classes, allowed are whole numbers from 1 on"),
        ([0.01, 0.02], [0.3, 1.0], 0.1, 4, "0.3 passes the smallest sieve of 10 mm, allowed is 0.2125 or less"),
        ([0.01, 0.02], [1.0, 1.0], 0.1, 4, "1 passes the smallest sieve of 10 mm, allowed is 0.2125 or less"),
        ([0.01, 0.02], [0.6, 1.0], 0.9, 1, "0.6 passes the smallest sieve of 10 mm, allowed is 0.5 or less"),
    ],
)
def test_what_is_no_curve_is_refused(sieves, passing, finest, classes, sentence):
    """One sentence that names what was found and what is allowed."""
    with pytest.raises(ValueError, match=sentence):
        size_classes(sieves, passing, finest, classes)


def test_a_cut_that_reaches_the_smallest_sieve_is_enough():
    """What is finer than the smallest sieve may be unknown where the middle of the smallest class is coarser."""
    assert size_classes([0.01, 0.02], [0.3, 1.0], 0.3, 4).diameters_m[0] > 0.01


def test_equal_middles_of_one_class_within_a_factor_of_two():
    """Of a class within a factor of 2 the diameters that keep the surface, and the mean, are within 3 % of it."""
    low, high, middle = 1.0, 2.0, size_classes([1.0, 2.0], [0.0, 1.0], 0.0, 1).diameters_m[0]
    surface = np.log(high / low) / (1.0 / low - 1.0 / high)
    mean = (high - low) / np.log(high / low)
    assert 0.97 < surface / middle < 1.0 < mean / middle < 1.03
