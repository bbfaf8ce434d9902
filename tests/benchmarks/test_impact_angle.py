"""The table of laws by angle of impact in docs is what its benchmark makes, and says which laws a test tells apart."""

import itertools

import pandas as pd
import pytest

from benchmarks.impact_angle import DIGITS, table
from tests import REPOSITORY

TOLD_APART = 0.3  # -, error of a ratio of weighings that docs allow


def test_the_table_in_docs_is_up_to_date():
    """Row by row; the page has its numbers."""
    found = table().round(DIGITS)
    pd.testing.assert_frame_equal(found, pd.read_csv(REPOSITORY / "docs" / "impact_angle.csv"))
    page = (REPOSITORY / "docs" / "wear.md").read_text(encoding="utf-8")
    for row in found.itertuples():
        cells = f"| {row.largest_wear_deg:.3g}° | {row.at_90_over_30:.3g} | {row.at_60_over_30:.3g} | "
        assert cells + f"{row.at_15_over_30:.3g} |" in page.replace("1.20 |", "1.2 |"), row.law


def test_square_over_oblique_impacts_tell_kinds_of_laws_apart():
    """Ratios of laws that cut, of Oka's and of energy differ by more than the error that is allowed."""
    ratios = sorted(set(table()["at_90_over_30"].round(DIGITS)))
    assert len(ratios) == 3
    assert all(high * (1.0 - TOLD_APART) > low * (1.0 + TOLD_APART) for low, high in itertools.pairwise(ratios))
    shallow = table().set_index("law")["at_15_over_30"]
    assert shallow["Finnie"] / shallow["Archard, shear work"] == pytest.approx(1.2, abs=0.05)
