"""The worst of many places: known by hand, and on made-up places whose truth is known."""

import math

import numpy as np
import pytest

from bulkwear.postproc.statistics.block_means import mean_of_blocks
from bulkwear.postproc.statistics.worst_place import worst_place

EXACT = 1e-12  # -, of means of a few numbers
SURE = 4.0  # standard errors of a mean over repeats, and standard deviations of a counted share
REPEATS = 400
ALWAYS = 0.998  # -, of intervals so wide that they say nothing
PLACES, NOISE = 200, 0.1  # alike places, -, scatter of a block


def repeats(seed, blocks=8, packings=1, truth=None, **arguments):
    """Results of many made-up runs, the blocks of packing after packing."""
    random, truth = np.random.default_rng(seed), np.ones(PLACES) if truth is None else truth
    for _ in range(REPEATS):
        labels = np.repeat(np.arange(packings), blocks)
        values = truth * (1.0 + NOISE * random.standard_normal((len(labels), len(truth))))
        values += 0.5 * NOISE * random.standard_normal((packings, len(truth)))[labels] * (packings > 1)
        yield worst_place(values, packings=labels if packings > 1 else None, **arguments)


def test_three_blocks_by_hand():
    """The last of three blocks names the place of the first two, and they name its."""
    found = worst_place([[5.0, 1.0], [1.0, 4.0], [3.0, 4.0]])
    assert found.named.tolist() == [1, 1, 0]  # the last names the second; means of the first two: 3 and 2.5
    assert found.values.tolist() == [1.0, 4.0, 3.0]
    assert (found.place, found.load) == (0, pytest.approx(3.0))
    assert found.agreement == pytest.approx(1.0 / 3.0)


def test_the_allowed_value_counts():
    """A place with half of the rate and a quarter of the thickness is worse; values keep their unit."""
    values = [[2.0, 1.0], [2.2, 1.1], [1.8, 0.9]]
    found = worst_place(values, allowed=[0.04, 0.01])
    assert found.place == 1
    assert found.values.tolist() == [1.0, 1.1, 0.9]
    assert found.loads == pytest.approx([100.0, 110.0, 90.0], rel=EXACT)
    assert worst_place(values).place == 0
    for unlimited in (math.nan, math.inf):
        assert worst_place(values, allowed=[0.04, unlimited]).place == 0


def test_whole_packings_are_left_out():
    """A packing's blocks have no voice in its own place, and packings count alike, geometrically, however many blocks
    they have.
    """
    values = [[9.0, 1.0], [9.0, 1.0], [9.0, 1.0], [1.0, 2.0], [1.0, 2.5]]
    found = worst_place(values, packings=["a", "a", "a", "b", "b"])
    assert found.named.tolist() == [1, 1, 1, 0, 0]
    assert found.values.tolist() == [1.0, 1.0, 1.0, 1.0, 1.0]
    assert (found.place, found.load) == (0, pytest.approx(3.0))
    assert (found.value().packings, worst_place(values, packings=["a"] * 5).value().packings) == (2, 1)


def test_a_place_that_one_packing_loads_alone_does_not_decide():
    """A grain that jams once in one packing: no packing is judged by that place, of which the others know nothing."""
    jammed = np.array([[1.0, 10.0], [1.1, 0.01], [0.9, 0.02]])
    found = worst_place(jammed, packings=["a", "b", "c"])
    assert (found.place, found.agreement) == (0, 1.0)
    assert found.values.tolist() == [1.0, 1.1, 0.9]
    assert found.load == pytest.approx(np.prod(found.values) ** (1.0 / 3.0), rel=EXACT)
    assert jammed.mean(axis=0).argmax() == 1  # the arithmetic mean would let it decide


def test_where_no_place_has_a_load_in_every_packing_the_arithmetic_mean_decides():
    """A geometric mean is 0 everywhere and names none."""
    found = worst_place([[0.0, 3.0], [1.0, 0.0]], packings=["a", "b"])
    assert (found.place, found.load) == (1, 0.0)


def test_one_block_has_no_others():
    """It names a place, and nothing tells of it."""
    found = worst_place([[1.0, 2.0, 1.5]])
    assert (found.place, found.load, found.named.tolist()) == (1, 2.0, [-1])
    assert math.isnan(found.values[0]) and math.isnan(found.loads[0]) and math.isnan(found.agreement)
    assert not found.value().known


def test_missing_values_are_left_out():
    """A value that is missing does not count; a place without any in a packing is never the worst."""
    nothing = math.nan
    found = worst_place([[nothing, 1.0, nothing], [5.0, 1.0, nothing], [5.0, 1.0, nothing]])
    assert (found.place, found.load) == (0, 5.0)
    assert found.named.tolist() == [0, 0, 0]
    assert np.isnan(found.values[0]) and found.values[1:].tolist() == [5.0, 5.0]
    values = [[nothing, 1.0], [9.0, 2.0], [9.0, 2.0]]
    assert worst_place(values, packings=["a", "b", "b"]).place == 1


@pytest.mark.parametrize("packings", [1, 4])
def test_alike_places_are_not_lifted(packings):
    """Of places that all have the load 1 the mean is 1 within its error over repeats, the chosen mean far above."""
    found = list(repeats(1, packings=packings))
    means = np.array([each.value(log=False).value for each in found])
    error = means.std(ddof=1) / math.sqrt(REPEATS)
    assert abs(means.mean() - 1.0) < SURE * error
    lifted = np.mean([each.load for each in found])
    assert lifted > 1.0 + 2.0 * NOISE / math.sqrt(8 * packings)  # two standard errors of a place
    assert lifted - 1.0 > 10.0 * error  # so that the first line can tell


@pytest.mark.parametrize("packings", [1, 4])
def test_one_clearly_worst_place_is_found(packings):
    """Where all blocks name the same place, values are its own and their mean is the chosen one."""
    truth = np.ones(PLACES)
    truth[17] = 2.0
    for found in repeats(2, packings=packings, truth=truth):
        assert found.place == 17
        assert found.agreement == 1.0
        assert found.clear
        assert found.value().value == pytest.approx(found.load, rel=EXACT)


def test_a_lesser_place_is_never_above_the_worst():
    """Where one place is a little worse, the mean lies between the lesser ones' truth and its own."""
    truth = np.ones(PLACES)
    truth[17] = 1.1
    means = np.array([each.value(log=False).value for each in repeats(3, truth=truth)])
    error = means.std(ddof=1) / math.sqrt(REPEATS)
    assert 1.0 + SURE * error < means.mean() < 1.1 + SURE * error


@pytest.mark.parametrize("packings", [1, 3, 5])
@pytest.mark.parametrize("places", [2, PLACES])
def test_the_interval_holds_the_truth(packings, places):
    """Of alike places at least 95 % within four standard deviations of the count, and not always."""
    found = [each.value() for each in repeats(4, packings=packings, truth=np.ones(places))]
    inside = np.mean([low <= 1.0 <= high for low, high in (each.interval() for each in found)])
    assert 0.95 - SURE * math.sqrt(0.95 * 0.05 / REPEATS) < inside < ALWAYS
    assert {each.packings for each in found} == {packings}


@pytest.mark.parametrize(("packings", "widened"), [(1, math.sqrt(2.0)), (3, math.sqrt(1.6 / 0.7))])
def test_errors_are_widened_unless_the_place_is_clear(packings, widened):
    """By what values share that name places for one another; not of a place that is the worst beyond doubt."""
    for worst, factor in ((1.0, widened), (2.0, 1.0)):
        truth = np.ones(20)
        truth[3] = worst
        found = next(repeats(6, packings=packings, truth=truth))
        plain = mean_of_blocks(found.values, found.packings, log=True)
        assert found.clear == (worst > 1.0)
        assert found.value().error == pytest.approx(factor * plain.error, rel=EXACT)
        assert (found.value().value, found.value().freedom) == (plain.value, plain.freedom)


def test_a_single_place_is_clear():
    """There is nothing to choose."""
    assert worst_place([[1.0], [2.0], [3.0]]).clear
    assert not worst_place([[1.0, 1.0]]).clear


def test_units_and_the_order_of_places_do_not_matter():
    """Other units and places turned round give the same blocks."""
    values = np.random.default_rng(5).normal(1.0, 0.1, (6, 9))
    first, other = worst_place(values), worst_place(8.0 * values[:, ::-1])
    assert np.array_equal(other.values, 8.0 * first.values)
    assert np.array_equal(other.named, 8 - first.named)


@pytest.mark.parametrize(
    ("values", "arguments", "sentence"),
    [
        (np.ones(3), {}, r"found values of the shape \(3,\), allowed are blocks by places"),
        (np.ones((0, 3)), {}, r"found values of the shape \(0, 3\), allowed are blocks by places"),
        (np.ones((2, 3)), {"allowed": [1.0]}, "found 1 allowed values of 3 places, allowed is one of each"),
        (np.ones((2, 2)), {"allowed": [1.0, 0.0]}, "found the allowed value 0, allowed are values above 0"),
        (np.ones((2, 2)), {"packings": ["a"]}, "found 1 packings of 2 blocks, allowed is one label per block"),
        (np.full((2, 2), math.nan), {}, "no place has a load in all packings, allowed is one place or more"),
    ],
)
def test_what_does_not_fit_is_refused(values, arguments, sentence):
    """One sentence that names what was found and what is allowed."""
    with pytest.raises(ValueError, match=sentence):
        worst_place(values, **arguments)
