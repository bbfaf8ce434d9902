"""The design of a test that tells wear laws apart: docs, effects in closed form, how often the right law is chosen."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.law_test import BEGIN, FACTORS, design, effects, largest_error, nearest, table, volumes
from bulkwear.postproc.statistics.screening_design import design_rows
from tests import REPOSITORY

TESTS, SEED = 20_000, 3
WRONG = 0.025  # -, of tests that choose the other one of two laws
SURE = 4.0  # standard deviations of a counted share
LINEAR = 1e-12  # -, of logarithms that are linear in the coded factors
DIGITS = 4  # of the table


@pytest.fixture(scope="module")
def found():
    return volumes(design())


def test_the_design_is_that_of_the_command_in_docs():
    """Row by row to the digits that it prints."""
    rows = pd.DataFrame(design_rows(FACTORS)).drop(columns="row").astype(float)
    np.testing.assert_allclose(rows, design(), rtol=1e-9)


def test_docs_are_up_to_date(found):
    """Runs and table."""
    runs, written = design(), pd.read_csv(REPOSITORY / "docs" / "law_test.csv")
    pd.testing.assert_frame_equal(written[list(runs)], runs.round(DIGITS))
    pd.testing.assert_frame_equal(written[list(found)], (found / np.exp(np.log(found).mean())).round(DIGITS))
    page = (REPOSITORY / "docs" / "wear.md").read_text(encoding="utf-8")
    assert f"{BEGIN}\n\n{table(effects(runs, found), nearest(found))}\n" in page


def test_effects_are_those_of_the_laws(found):
    """Powers of energy, of Oka, and what friction makes of Archard's work; no law of impacts knows friction."""
    told = effects(design(), found)
    assert told["speed_m_per_s"][["Finnie", "Impact energy", "Oka"]].tolist() == pytest.approx([2.0, 2.0, 2.33])
    assert told.loc["Shear work", "friction"] - told.loc["Archard", "friction"] == pytest.approx(1.0, abs=LINEAR)
    assert told["friction"][["Finnie", "Oka", "Impact energy"]].abs().max() < LINEAR
    over = (np.sin(np.radians(75.0)) / np.sin(np.radians(15.0))) ** 2
    assert told.loc["Impact energy", "angle_deg"] == pytest.approx(over)


def test_an_error_is_the_one_at_which_the_right_law_is_chosen(found):
    """Weighings of Finnie and of shear work with that error, and with coefficients that nobody knows."""
    one, other = (np.log(found[law].to_numpy()) for law in ("Finnie", "Shear work"))
    error = largest_error(np.exp(one), np.exp(other))
    weighed = one + error * np.random.default_rng(SEED).standard_normal((TESTS, len(one))) + 5.0
    misfit = [(weighed - law).var(axis=1) for law in (one, other)]
    wrong = (misfit[1] < misfit[0]).mean()
    assert wrong == pytest.approx(WRONG, abs=SURE * np.sqrt(WRONG * (1.0 - WRONG) / TESTS))


def test_one_speed_and_friction_cannot_tell_archard_from_shear_work(found):
    """They differ by a factor then, as of another coefficient."""
    same = volumes(design().assign(speed_m_per_s=8.0, friction=0.4))
    assert largest_error(same["Archard"].to_numpy(), same["Shear work"].to_numpy()) < LINEAR
    assert largest_error(found["Archard"].to_numpy(), found["Shear work"].to_numpy()) > 0.3
