"""Coverage of samples by both readings of c, and what Figures 6.1 and 6.14 of the source say of them."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from benchmarks.pattern_coverage import (
    FINEST,
    coverage_table,
    covered_fraction,
    narrowest_gap,
    outlines,
    widest_free_circle,
)
from bulkwear.meshes.lattice import pattern_centres
from bulkwear.meshes.pattern import ConvexPattern
from tests import PUBLISHED, REPOSITORY

MM = 1e-3
SIZE = 0.2
R12 = ConvexPattern(8 * MM, 8 * MM, 1.5 * MM, 20 * MM, 20 * MM)
CHORDS = 2e-6  # m, by which polygons of 360 corners stand for the outlines of bumps of 8 mm
PRINTED = 5e-3  # relative; the table has three digits
BY_BUMPS = {"rows_in_phase": [5, 4, 5, 4, 5], "neighbouring_rows": [5, 4, 5]}  # of run R9 on 100 mm


@pytest.fixture(scope="module")
def written():
    """The table in docs."""
    return pd.read_csv(REPOSITORY / "docs" / "pattern_coverage.csv")


def test_the_table_in_docs_is_what_the_code_gives(written):
    """All columns, three digits."""
    made = coverage_table()
    pd.testing.assert_frame_equal(written, made, check_dtype=False, rtol=PRINTED)


def test_coverage_is_the_union_of_the_feet():
    """The share of random places that lie in a foot; feet do not overlap, so their areas add up."""
    centres, _ = pattern_centres(R12, SIZE, SIZE)
    places = np.random.default_rng(1).uniform(-SIZE / 2, SIZE / 2, (30_000, 1, 2))
    inside = (np.hypot(*np.moveaxis(places - centres, -1, 0)) < R12.half_width).sum(axis=1)
    assert inside.max() == 1
    four_errors = 4.0 * math.sqrt(0.25 / len(places))
    assert covered_fraction(R12, SIZE, SIZE) == pytest.approx(inside.mean(), abs=four_errors)


def test_room_between_round_bumps_in_closed_form():
    """Gap: the nearest centres less a diameter. Free circle: circumscribed to three centres, less a diameter."""
    for rows in (20 * MM, 40 * MM):
        pattern = replace(R12, row_spacing=rows)
        nearest = min(20 * MM, math.hypot(10 * MM, rows))
        circle = (math.hypot(10 * MM, rows) ** 2) / rows
        assert narrowest_gap(pattern) == pytest.approx(nearest - 16 * MM, abs=CHORDS)
        assert widest_free_circle(pattern) == pytest.approx(circle - 16 * MM, abs=CHORDS + 2 * FINEST)
    turned = outlines(replace(R12, minor_radius=4 * MM), np.zeros((1, 2)))[0]
    assert np.abs(turned).max(axis=0) == pytest.approx([4 * MM, 8 * MM])


@pytest.mark.parametrize(("reading", "rows"), BY_BUMPS.items())
def test_rows_of_the_tester(written, reading, rows):
    """Figure 6.1 has five columns of bumps, C11 to C15 in the first, fewer in the second and the fourth."""
    line = written[(written["study"] == "circular_tester") & (written["row_spacing_between"] == reading)]
    assert line["bumps_per_row"].item() == " ".join(map(str, rows))


def test_fourteen_bumps_cannot_lose_what_the_source_says():
    """Bumps lose 56 % of the sample's volume at revolution 17, each at most what Figure 6.14 shows.

    5 + 4 + 5 such bumps lose less than that at particle scales 2, 3 and 4; 5 + 4 + 5 + 4 + 5 can lose it at 1, 2 and 3.
    """
    value = pd.read_csv(PUBLISHED / "circular_tester.csv").set_index("quantity")["value"]
    lines = pd.read_csv(PUBLISHED / "circular_tester_volume.csv").query("surface == 'convex'")
    turns = value["last_revolution"]
    volume = lines["linear_mm3_per_revolution"] * turns + lines["quadratic_mm3_per_revolution2"] * turns**2
    of_bumps = (value["share_of_bumps"] / 100.0 * volume).tolist()
    most = {
        reading: sum(each * value[f"largest_bump_volume_{'even' if k % 2 else 'odd'}"] for k, each in enumerate(rows))
        for reading, rows in BY_BUMPS.items()
    }
    assert [each <= most["neighbouring_rows"] for each in of_bumps] == [True, False, False, False]
    assert [each <= most["rows_in_phase"] for each in of_bumps] == [True, True, True, False]


def test_the_decision_quotes_the_table(written):
    """Lines of the small table in docs/decisions.md are made of the large one."""
    page = (REPOSITORY / "docs" / "decisions.md").read_text(encoding="utf-8")
    chosen = written[written["row"].isin(["R7", "R12", "convex"])]
    lines = [
        f"| {'R9, tester' if line.row == 'convex' else line.row} | {line.row_spacing_between} | {line.bumps_per_row} |"
        f" {line.covered_percent:.0f} | {line.narrowest_gap_mm:.0f} | {line.widest_free_circle_mm:.0f} |"
        for line in chosen.itertuples()
    ]
    assert len(lines) == 6 and [line for line in lines if line not in page] == []
