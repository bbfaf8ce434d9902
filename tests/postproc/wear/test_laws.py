"""Wear laws: worn volume from the ledger."""

import re
from string import Formatter

import numpy as np
import pytest

from bulkwear.postproc.wear.kernel_sums import columns_of_law, kernel_sums, law_kernels
from bulkwear.postproc.wear.kernels import KERNELS, kernel_column
from bulkwear.postproc.wear.laws import (
    LAWS,
    NEUTRAL_LAW,
    Law,
    Parameter,
    archard,
    finnie,
    register_law,
    worn_volume,
)
from bulkwear.postproc.wear.ledger import SUMMED_FIELDS
from bulkwear.workflows.config.law_settings import parameters_schema
from bulkwear.workflows.config.units import to_si
from tests.support.law_cases import ALPHA, parameters_of

SIGNED = ("tangential_work_J", "drive_work_J")  # sums of a ledger that can be negative


def test_archard_is_coefficient_times_sliding_work():
    """V = alpha_s F L: 5 N over 180 m at 6.3e-13 1/Pa wears 0.567 mm3 (Yan 2022, chapter 5: 0.565 mm3)."""
    volume = worn_volume(
        "archard", {"sliding_work_J": np.array([5.0 * 180.0, 0.0])}, {"wear_coefficient_per_pa": ALPHA}
    )
    assert volume[0] * 1e9 == pytest.approx(0.567, rel=1e-12)  # one product: rounding only
    assert volume[1] == 0.0


def columns_for(law, m=4, seed=3):
    """Sums of a ledger and of the kernels that a law needs, as float32."""
    random = np.random.default_rng(seed)
    names = (*SUMMED_FIELDS, *map(kernel_column, LAWS[law].kernels))
    return {name: random.uniform(0.0, 5.0, m).astype(np.float32) for name in names}


def test_finnie_is_coefficient_times_finnie_work():
    """V = k sum(2 E v F dt); the work of sliding has no part in it."""
    volume = worn_volume("finnie", {"finnie_work_J": np.array([3.0, 0.0])}, {"wear_coefficient_per_pa": ALPHA})
    assert volume.tolist() == [3.0 * ALPHA, 0.0]


def test_shear_work_is_coefficient_times_tangential_work():
    """V = k W; with k = alpha / mu a contact that slides, W = mu F L, wears as by Archard; below 0 is nothing."""
    friction, work = 0.5, np.array([900.0, 0.0])  # -, J
    columns = {"sliding_work_J": work, "tangential_work_J": friction * work + [0.0, -1.0]}
    volume = worn_volume("tangential_work", columns, {"wear_coefficient_per_pa": ALPHA / friction})
    np.testing.assert_array_equal(volume, worn_volume("archard", columns, {"wear_coefficient_per_pa": ALPHA}))


def combined_of(columns, rolling, impact):
    """Volume by the combined law with these ratios."""
    given = {"wear_coefficient_per_pa": ALPHA, "rolling_ratio": rolling, "impact_ratio": impact}
    return worn_volume("combined", columns, given)


def test_combined_adds_rolling_and_impact_by_their_ratios():
    """V = k (W_sliding + r W_rolling + q E), Archard's with both 0; a ratio adds k times it times its sum."""
    columns = {name: values.astype(float) for name, values in columns_for("combined").items()}
    archard_alone = worn_volume("archard", columns, parameters_of("archard"))
    np.testing.assert_array_equal(combined_of(columns, 0.0, 0.0), archard_alone)
    for ratios, name in (((0.25, 0.0), "rolling_work_J"), ((0.0, 0.25), "impact_above_threshold_J")):
        added = combined_of(columns, *ratios) - archard_alone
        np.testing.assert_allclose(added, 0.25 * ALPHA * columns[name], rtol=1e-12)  # a difference of like numbers


@pytest.mark.parametrize("ratios", [(-0.1, 0.0), (0.0, np.nan)])
def test_an_impossible_ratio_is_refused(ratios):
    """It would let the surface grow or vanish."""
    with pytest.raises(ValueError, match=r"(rolling|impact)_ratio is .*, allowed is a finite number >= 0 \(-\)"):
        combined_of(columns_for("combined"), *ratios)


@pytest.mark.parametrize("law", LAWS)
def test_no_law_lets_a_surface_grow(law):
    """Sums that can be negative, those of work that a contact gives back, take no volume then."""
    columns = {name: -values if name in SIGNED else values for name, values in columns_for(law).items()}
    assert (worn_volume(law, columns, parameters_of(law)) >= 0.0).all()


@pytest.mark.parametrize("law", LAWS)
def test_every_law_returns_one_volume_per_triangle(law):
    """(m,) float64, also from float32 columns."""
    volume = worn_volume(law, columns_for(law), parameters_of(law))
    assert volume.shape == (4,) and volume.dtype == np.float64


@pytest.mark.parametrize("law", LAWS)
def test_zero_load_wears_nothing(law):
    """V = 0, exactly."""
    nothing = {name: np.zeros(4) for name in columns_for(law)}
    assert not worn_volume(law, nothing, parameters_of(law)).any()


@pytest.mark.parametrize("law", LAWS)
def test_every_law_is_linear_in_the_ledger_and_the_coefficient(law):
    """Two cycles wear the sum of each; twice the coefficient wears twice. Powers of two keep it exact."""
    parameters = parameters_of(law)
    once = worn_volume(law, columns_for(law), parameters)
    twice = worn_volume(law, {name: 2 * v for name, v in columns_for(law).items()}, parameters)
    np.testing.assert_array_equal(twice, 2.0 * once)
    faster = {**parameters, "wear_coefficient_per_pa": 2 * ALPHA}
    np.testing.assert_array_equal(worn_volume(law, columns_for(law), faster), twice)


@pytest.mark.parametrize("law", LAWS)
def test_laws_follow_the_order_of_the_triangles(law):
    """Face-order invariance."""
    order = np.array([2, 0, 3, 1])
    shuffled = {name: values[order] for name, values in columns_for(law).items()}
    parameters = parameters_of(law)
    np.testing.assert_array_equal(
        worn_volume(law, shuffled, parameters), worn_volume(law, columns_for(law), parameters)[order]
    )


@pytest.mark.parametrize("law", LAWS)
def test_laws_need_kernels_that_exist_and_nothing_more(law):
    """The kernels that a law names suffice for it, and both producers of a ledger know them."""
    assert set(law_kernels(law, parameters_of(law))) == set(LAWS[law].kernels) <= set(KERNELS)
    for missing in LAWS[law].kernels:
        columns = {name: v for name, v in columns_for(law).items() if name != kernel_column(missing)}
        with pytest.raises(KeyError, match=kernel_column(missing)):
            worn_volume(law, columns, parameters_of(law))


@pytest.mark.parametrize("law", LAWS)
def test_a_law_takes_every_parameter_that_it_declares(law):
    """Each is wanted by its function or its kernels; names are given once, a default lies in its range."""
    declared = LAWS[law].parameters
    assert len({parameter.name for parameter in declared}) == len(declared)
    assert all(p.lowest <= p.default <= p.highest for p in declared if p.default is not None)
    for missing in to_si(dict.fromkeys(parameters_schema(law)["properties"], 1.0)):
        parameters = {name: value for name, value in parameters_of(law).items() if name != missing}
        with pytest.raises(KeyError, match=missing):
            law_kernels(law, parameters)
            worn_volume(law, columns_for(law), parameters)


@pytest.mark.parametrize("law", LAWS)
def test_the_words_of_a_law_leave_its_numbers_open(law):
    """The coefficient and nothing but parameters that the law declares."""
    names = {name for _, name, _, _ in Formatter().parse(LAWS[law].words) if name is not None}
    assert "wear_coefficient_per_pa" in names <= {"wear_coefficient_per_pa", *parameters_schema(law)["properties"]}
    assert LAWS[law].words.endswith(".") and not LAWS[law].source.endswith(".")


def test_the_neutral_law_takes_nothing_but_its_coefficient():
    """So that a study that says nothing has no kernel in its decks and no parameter in its settings."""
    assert LAWS[NEUTRAL_LAW].kernels == LAWS[NEUTRAL_LAW].parameters == ()


def test_unknown_law_names_the_allowed_ones():
    """An unknown law is refused with one sentence naming it and the allowed ones."""
    with pytest.raises(ValueError, match=rf"wear law 'archad' is unknown, allowed are: {', '.join(sorted(LAWS))}"):
        worn_volume("archad", {}, {})


@pytest.mark.parametrize(
    ("columns", "parameters", "missing"),
    [
        (
            {"rolling_work_J": np.ones(1)},
            {"wear_coefficient_per_pa": ALPHA},
            "ledger column 'sliding_work_J'",
        ),
        ({"sliding_work_J": np.ones(1)}, {"alpha": ALPHA}, "wear parameter 'wear_coefficient_per_pa'"),
    ],
)
def test_missing_inputs_are_named(columns, parameters, missing):
    """A missing column or parameter is named together with what was found."""
    with pytest.raises(KeyError, match=missing):
        archard(columns, parameters)


@pytest.mark.parametrize("coefficient", [-1e-13, np.nan, np.inf])
def test_impossible_coefficient_is_refused(coefficient):
    """A negative or non-finite wear coefficient would let the surface grow or vanish."""
    with pytest.raises(ValueError, match="wear_coefficient_per_pa is"):
        archard({"sliding_work_J": np.ones(1)}, {"wear_coefficient_per_pa": coefficient})
    with pytest.raises(ValueError, match="wear_coefficient_per_pa is"):
        finnie({"finnie_work_J": np.ones(1)}, {"wear_coefficient_per_pa": coefficient})


@pytest.mark.parametrize(
    ("declared", "fault"),
    [
        (archard, "law odd is function, allowed is a Law(...)"),
        (
            Law(archard, "by {force_n}.", "nobody"),
            "words of the law odd have {force_n}, allowed in braces are: wear_coef",
        ),
        (Law(archard, "so.", "nobody", kernels=("odd",)), "contact kernel 'odd' is unknown"),
        (
            Law(archard, "so.", "nobody", parameters=(Parameter("n", "of it", 1.0, 2.0),)),
            "parameter n of the law odd has",
        ),
    ],
)
def test_a_law_that_is_none_is_not_registered(declared, fault):
    """What is wrong is said, and nothing is registered."""
    with pytest.raises(ValueError, match=re.escape(fault)):
        register_law("odd", declared)
    assert "odd" not in LAWS


@pytest.mark.parametrize("law", sorted(LAWS))
def test_the_laws_that_are_there_could_be_registered(law, monkeypatch):
    """They keep the rules that laws of a project must keep."""
    declared = LAWS[law]
    monkeypatch.delitem(LAWS, law)
    register_law(law, declared)
    assert LAWS[law] is declared


def test_each_set_of_parameters_has_a_sum_of_its_own():
    """Laws that share a kernel and its parameters share the sum; a law finds its own under the kernel's name, and none
    where the ledger lacks it.
    """
    hit, given = "impact_above_threshold", [{"threshold_velocity_m_per_s": speed} for speed in (0.5, 2.0, 0.1)]
    sums = kernel_sums([("impact_threshold", given[0]), ("finnie", {}), ("combined", given[1]), ("combined", given[0])])
    assert sums == {hit: given[0], "finnie_work": {}, f"{hit}.2": given[1]}
    columns = {f"{hit}_J": np.ones(1), f"{hit}.2_J": np.full(1, 7.0), "finnie_work_J": np.zeros(1)}
    found = [columns_of_law(columns, sums, "combined", each).get(f"{hit}_J") for each in given]
    assert found == [[1.0], [7.0], None]
