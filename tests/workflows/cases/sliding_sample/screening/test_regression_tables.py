"""All tables of a regression from a study's summary."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.sliding_sample.screening.regression_tables import (
    best_designs,
    contour_table,
    regression_tables,
    screen_summary,
    strongest_factor,
)
from tests import REPOSITORY as ROOT
from tests.support.screening_study import FACTORS

WEAR = 1e-9  # m3/m
COLUMN = "worn_volume_per_metre_m3_per_m"


def read(name):
    return pd.read_csv(ROOT / f"config/published/screening_{name}.csv")


@pytest.fixture
def summary():
    """Convex runs of Table 3.8 that wear by t and v alone, with a little noise, and plain ones of any wear."""
    design = pd.read_csv(ROOT / "config/designs/screening.csv")
    noise = np.random.default_rng(2).normal(0.0, 0.05, 13)
    wear = WEAR * (design["bed_thickness_mm"] / 20.0) ** 2 * design["velocity_m_per_s"] * np.exp(noise)
    convex = design.assign(surface="convex", particle_scale=2.0, worn_volume_per_metre_m3_per_m=wear)
    plain = convex.assign(surface="plain", worn_volume_per_metre_m3_per_m=5.0 * WEAR)
    return pd.concat([plain, convex], ignore_index=True)


def test_runs_with_a_pattern_are_regressed(summary):
    """Plain runs do not count; factors have the levels and spacings of their columns."""
    study = screen_summary(summary, FACTORS)
    assert len(study.response) == 13
    assert {factor.name: factor.spacing for factor in study.factors} == dict.fromkeys("abhvt", "log") | {"d": "linear"}
    slopes = dict(zip(study.model.terms, study.model.coefficients[1:], strict=True))
    assert slopes[4,] == pytest.approx(np.log(2.0), abs=0.1)
    assert slopes[5,] == pytest.approx(2.0 * np.log(2.0), abs=0.1)
    assert strongest_factor(study).name == "t"


def test_packings_are_no_further_runs(summary):
    """What the model misses a row by is the same in all its packings: the terms are those of the means, under the names
    of the settings; a packing that failed leaves the others.
    """
    convex = summary[summary["surface"] == "convex"]
    shares = {"": 0.99, "-2": 1.0, "-3": 1.0 / 0.99}
    packings = [
        convex.assign(row=convex["row"] + name, setting=convex["row"], **{COLUMN: share * convex[COLUMN]})
        for name, share in shares.items()
    ]
    alone, three = screen_summary(convex, FACTORS), screen_summary(pd.concat(packings), FACTORS)
    assert three.model.terms == alone.model.terms and three.model.freedom == alone.model.freedom
    np.testing.assert_allclose(three.response, alone.response, atol=1e-12)
    assert three.design_rows.tolist() == convex["row"].tolist()
    failed = pd.concat([packings[1], packings[0].assign(**{COLUMN: np.nan})])
    np.testing.assert_allclose(screen_summary(failed, FACTORS).response, alone.response, atol=1e-12)


def test_best_designs_by_the_strongest_factor(summary):
    """Free, the bed is thin; then at each of its thicknesses; always slow. Wear is relative to the largest."""
    table = best_designs(screen_summary(summary, FACTORS))
    assert table["given"].tolist() == ["", "t = 10", "t = 20", "t = 40"]
    assert table["t"].tolist() == pytest.approx([10.0, 10.0, 20.0, 40.0])
    assert table["v"].tolist() == pytest.approx([0.5] * 4)
    assert (table["predicted_over_largest"] < 1.0).all()


def test_nothing_is_claimed_about_an_aliased_factor(summary):
    """Where the particle scale follows the thickness, the thickness stays at its middle and is never varied."""
    scaled = summary.assign(particle_scale=np.where(summary["bed_thickness_mm"] > 10.0, 2.0, 1.26))
    study = screen_summary(scaled, FACTORS)
    table = best_designs(study)
    assert table["given"].tolist() == ["t = 20"]
    assert table["t"].tolist() == pytest.approx([20.0])


def test_contours_have_the_published_pairs_and_their_values(summary):
    """The four pairs of the source come first, with its regression's wear; other factors have their own pairs alone."""
    study = screen_summary(summary, FACTORS)
    published, pairs = read("coefficients"), read("contours")
    table = contour_table(study, published, pairs)
    drawn = list(dict.fromkeys(zip(table["x_factor"], table["y_factor"], strict=True)))
    assert drawn[:4] == [("a", "t"), ("a", "v"), ("v", "t"), ("b", "d")]
    corner = table[(table["x_factor"] == "v") & (table["x"] == 2.0) & (table["y"] == 40.0)].iloc[0]
    assert corner["published_wear"] == pytest.approx(np.exp(-1.859 + 0.650 + 1.426))
    few = screen_summary(summary, {name: FACTORS[name] for name in "vt"})
    assert contour_table(few, published, pairs)["published_wear"].isna().all()


def test_the_best_model_alone_has_a_chance(summary):
    """The p value by permutation is that of the first model; all terms that two runs could tell of are aliased."""
    published, pairs = read("coefficients"), read("contours")
    tables = regression_tables(screen_summary(summary, FACTORS), published, pairs)
    assert tables["models"]["p_value_permutation"].notna().tolist() == [True] + [False] * (len(tables["models"]) - 1)
    assert tables["aliasing"].shape == (27, 28)
