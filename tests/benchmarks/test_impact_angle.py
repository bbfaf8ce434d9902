"""The table of laws by angle of impact in docs is what its benchmark makes, and says which laws a test tells apart."""

import itertools
import re

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


NAMES = {"tangential work": "Shear work", "archard": "Archard", "finnie": "Finnie", "oka": "Oka"}
ROUNDED = 0.006  # -, two decimals here, three digits of the inverse there


def test_ratios_of_the_stream_are_those_of_its_page():
    """90 over 30 degrees by each law, beside the closed forms, is what the page of which_law says first."""
    said = " ".join((REPOSITORY / "docs" / "which_law_results_quick.md").read_text(encoding="utf-8").split())
    sentence = re.search(r"over that of A90 it wears (.*?)\. ", said)[1]
    found = {law: float(ratio) for ratio, law in re.findall(r"([\d.]+) \([^)]*\) by ([a-z]+(?: work)?)", sentence)}
    assert set(found) == set(NAMES)
    page = (REPOSITORY / "docs" / "wear.md").read_text(encoding="utf-8").partition("The study `which_law`")[2]
    for law, ratio in found.items():
        told = re.search(rf"^\| {NAMES[law]}[^|]*\| ([\d.]+) \|", page, re.MULTILINE)[1]
        assert float(told) == pytest.approx(1.0 / ratio, abs=ROUNDED), law
