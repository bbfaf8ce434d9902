"""Experiment, thesis and runs of the circular wear tester side by side: every number stands in its place."""

import pandas as pd
import pytest

from bulkwear.workflows.cases.circular_tester.tables import (
    LABORATORY,
    OURS,
    THESIS,
    THESIS_ALIKE,
    comparison_table,
    loss_rows,
)
from bulkwear.workflows.cases.circular_tester.volume import chosen_fit, predictions, time_scale, volume_fits
from tests.support import tester_study as study


def test_comparison_table():
    """Three columns beside each other; the thesis' model from its equations at its own two revolutions per 56 h."""
    fits = volume_fits(study.volumes())
    scale = time_scale(chosen_fit(fits, "plain_3"), 5e-9, study.PUBLISHED, 1.071, 0.01)
    predicted = predictions(fits, scale, [56.0, 184.0])
    table = comparison_table(predicted, study.PUBLISHED, study.PUBLISHED_FITS, 3.0).set_index(["hours", "quantity"])
    columns = [LABORATORY, THESIS, THESIS_ALIKE, OURS]
    assert table.loc[(56.0, "plain volume"), columns].to_list() == pytest.approx([145.2, 147.28, 154.06, 145.2])
    assert table.loc[(56.0, "convex volume"), THESIS_ALIKE] == pytest.approx(2 * 47.12 + 4 * 0.78)
    assert table.loc[(184.0, "reduction"), THESIS] == pytest.approx(56.0, abs=0.2)
    assert table.loc[(184.0, "reduction"), LABORATORY] == pytest.approx(49.4, abs=0.1)
    assert table.loc[(56.0, "reduction"), OURS] == pytest.approx(100.0 * (1.0 - (45.0 + 0.75 * 145.2 / 75.0) / 75.0))
    assert "swaps" in table.loc[(184.0, "convex volume"), "note"]
    assert table.loc[(56.0, "convex volume"), "note"] == ""
    assert table.loc[(56.0, "reduction"), "note"] == "the thesis' text has 68.9 % for its model"


def test_losses_stand_beside_the_scanned_ones():
    """Largest loss of each bump in mm after 184 h; a run that ends earlier says where."""
    losses = pd.Series({"C11": 0.5, "C15": 0.6})
    table = loss_rows(losses, study.PUBLISHED, 6.5, 6.57).set_index("quantity")
    assert table[LABORATORY].to_dict() == {"largest loss of C11": 0.34, "largest loss of C15": 0.35}
    assert table[OURS].to_list() == [0.5, 0.6] and (table["note"] == "").all()
    assert (table["hours"] == 184.0).all() and table[THESIS].isna().all()
    short = loss_rows(losses, study.PUBLISHED, 4.0, 6.57)
    assert short["note"].iloc[0] == "ours after 4 revolutions, 184 h are 6.57"
