"""Wear laws: worn volume from the ledger."""

import numpy as np
import pytest

from postproc.wear.laws import LAWS, archard, worn_volume

ALPHA = 6.3e-13  # 1/Pa, steel on a pin-on-disc rig (Yan 2022, chapter 5)


def test_archard_is_coefficient_times_sliding_work():
    """V = alpha_s F L: 5 N over 180 m at 6.3e-13 1/Pa wears 0.567 mm3 (Yan 2022, chapter 5: 0.565 mm3)."""
    volume = worn_volume(
        "archard", {"sliding_work_J": np.array([5.0 * 180.0, 0.0])}, {"wear_coefficient_per_pa": ALPHA}
    )
    assert volume[0] * 1e9 == pytest.approx(0.567, rel=1e-12)  # one product: rounding only
    assert volume[1] == 0.0


def test_every_law_scales_with_the_ledger_length():
    """A law returns one float64 volume per triangle."""
    columns = {"sliding_work_J": np.arange(4, dtype=np.float32)}
    for law in LAWS:
        volume = worn_volume(law, columns, {"wear_coefficient_per_pa": ALPHA})
        assert volume.shape == (4,) and volume.dtype == np.float64


def test_unknown_law_names_the_allowed_ones():
    """An unknown law is refused with one sentence naming it and the allowed ones."""
    with pytest.raises(ValueError, match=r"wear law 'oka' is unknown, allowed are: archard"):
        worn_volume("oka", {}, {})


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
