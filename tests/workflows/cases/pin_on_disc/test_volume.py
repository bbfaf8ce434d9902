"""Volumes of a pin on a disc: how they grow, factors that multiply to the whole, published fits as printed."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.pin_on_disc.volume import (
    CANDIDATES,
    FASTER,
    LINEAR,
    SLOWER,
    UNSAID,
    VOLUMES,
    beside_laws,
    excess_factors,
    groove_remark,
    groove_volume,
    law_volume,
    published_groove,
    published_volume,
    shown_factors,
    size_cases,
    size_invariance,
    volume_trends,
    volumes_of_run,
)
from tests import PUBLISHED
from tests.support import pin_study

VALUES = pd.read_csv(PUBLISHED / "pin_on_disc.csv")
FITS = pd.read_csv(PUBLISHED / "pin_on_disc_volume.csv")
LOAD, TRACK = 5.0, 22e-3  # N, m
ROUNDING = 1e-9  # -, of a least-squares fit of a dozen points


def test_law_volume_of_one_revolution():
    """alpha F L at 1e-11 1/Pa: 1e-11 * 5 N * 2 pi 22 mm = 0.00691 mm3 per revolution."""
    np.testing.assert_allclose(law_volume(1e-11, LOAD, TRACK, [1, 2]), [6.9115e-12, 13.823e-12], rtol=1e-4)


def run_of(increments, scheme="per_triangle"):
    """Volumes of a run of which each revolution removes so much (mm3); the other volumes grow by 1 mm3."""
    revolution = np.arange(1, len(increments) + 1)
    volumes = dict.fromkeys(VOLUMES.values(), 1e-9 * revolution)
    return pd.DataFrame(
        {"run": "a", "scheme": scheme, "wear_coefficient_per_pa": 1e-11, "revolution": revolution, **volumes}
        | {VOLUMES["removed"]: 1e-9 * np.cumsum(increments)}
    )


def removed(increments):
    """The row of what such a run removes."""
    table = volume_trends(run_of(increments)).set_index("volume")
    return table.loc["removed"]


def test_terms_of_a_parabola_are_its_own():
    """V = 0.03 x + 0.001 x2 over 12 revolutions: both terms come back; the increments rise by 24/42 of their mean."""
    x = np.arange(13.0)
    row = removed(np.diff(0.03 * x + 0.001 * x**2))
    assert row["linear_mm3_per_revolution"] == pytest.approx(0.03, rel=ROUNDING)
    assert row["quadratic_mm3_per_revolution2"] == pytest.approx(0.001, rel=ROUNDING)
    assert row["change_percent"] == pytest.approx(100.0 * 24.0 / 42.0, rel=ROUNDING)
    assert row["growth"] == FASTER


@pytest.mark.parametrize(
    ("scatter", "change", "growth"),
    [(0.01, 0.0, LINEAR), (0.01, 0.5, FASTER), (0.01, -0.5, SLOWER), (0.3, 0.5, UNSAID)],
)
def test_growth_is_told_where_it_is_sure(scatter, change, growth):
    """Increments that change by half are told from linear growth at a scatter of 1 %, and at 30 % nothing is said."""
    noise = scatter * np.random.default_rng(4).standard_normal(12)
    row = removed(1.0 + change * ((np.arange(12) + 0.5) / 12.0 - 0.5) + noise)
    assert row["growth"] == growth
    assert row["least_change_percent"] < 100.0 * change < row["largest_change_percent"]


def test_a_rate_that_grows_by_half_is_not_linear_for_its_r_squared():
    """A straight line through volumes whose increments grow by half has R2 above 0.99, and they are called curved."""
    increments = 1.0 + 0.5 * ((np.arange(12) + 0.5) / 12.0 - 0.5)
    x, volume = np.arange(13.0), np.append(0.0, np.cumsum(increments))
    assert np.corrcoef(x, volume)[0, 1] ** 2 > 0.99
    assert removed(increments)["growth"] == FASTER


def test_few_revolutions_say_nothing():
    """Of three revolutions that scatter there is a change, and no interval."""
    row = removed([1.0, 1.1, 0.9])
    assert np.isfinite(row["change_percent"])
    assert np.isnan(row[["least_change_percent", "largest_change_percent"]].astype(float)).all()
    assert row["growth"] == UNSAID


@pytest.mark.parametrize(
    ("coefficient", "at_first", "at_twelfth"),
    [(1e-11, 0.0138, 0.2602), (1.7e-11, 0.037, 0.51), (5e-11, 0.189, 2.84)],
)
def test_published_fits_as_printed(coefficient, at_first, at_twelfth):
    """Eq 5.11, 5.13 and 5.15 at 1 and 12 revolutions (mm3), added up by hand; no fit, no value."""
    np.testing.assert_allclose(1e9 * published_volume(FITS, coefficient, [1, 12]), [at_first, at_twelfth])
    assert np.isnan(published_volume(FITS, 3e-11, [1, 12])).all()


def test_published_volumes_exceed_the_law():
    """2.0, 3.1 and 5.5 times alpha F L in the first revolution, 3.6 times over twelve at 1.7e-11."""
    for coefficient, revolutions, factor in ((1e-11, 1, 2.0), (1.7e-11, 1, 3.1), (5e-11, 1, 5.5), (1.7e-11, 12, 3.6)):
        ratio = published_volume(FITS, coefficient, revolutions) / law_volume(coefficient, LOAD, TRACK, revolutions)
        assert ratio == pytest.approx(factor, abs=0.05)


def run_folder(folder):
    """A run of four half revolutions: Eq 5.9 counts twice the law's volume, the force rises by 1 N each."""
    cycle = np.arange(1, 5)
    pd.DataFrame(
        {
            "cycle": cycle,
            "time_s": 1.0 * cycle,
            "revolution": 0.5 * cycle,
            "total_worn_volume_m3": 0.5e-12 * cycle,
            "total_applied_volume_m3": 0.9e-12 * cycle,
            "carried_volume_m3": 0.0,
            "step_demand": 0.1,
            "centroid_path_volume_m3": 1e-12,
            "touched_centroid_path_volume_m3": 0.4e-12,
            "mean_normal_force_N": LOAD + cycle,
            "mean_vertical_force_N": -LOAD,
            "contacts_per_step": 2.0,
        }
    ).to_csv(folder / "wear.csv", index=False)


def test_volumes_after_whole_revolutions(tmp_path):
    """Totals of the second and fourth cycle, centroid paths added up, forces averaged since the start."""
    run_folder(tmp_path)
    table = volumes_of_run(tmp_path)
    assert table["revolution"].tolist() == [1, 2]
    np.testing.assert_allclose(table["centroid_path_volume_m3"], [2e-12, 4e-12])
    np.testing.assert_allclose(table["removed_volume_m3"], [1.8e-12, 3.6e-12])
    np.testing.assert_allclose(table["mean_normal_force_N"], [6.5, 7.5])


def two_revolutions(tmp_path):
    """Volumes of the run above with what a design says of it."""
    run_folder(tmp_path)
    return volumes_of_run(tmp_path).assign(
        run="a", scheme="per_triangle", wear_coefficient_per_pa=1e-11, load_n=LOAD, track_radius_m=TRACK
    )


def test_factors_multiply_to_the_whole(tmp_path):
    """Rise, slip, share taken up, displacement rule and summing rule multiply to the volume by Eq 5.9 over touched
    triangles over alpha F L, exactly; the published volume over that product is left."""
    volumes = two_revolutions(tmp_path)
    factors = excess_factors(volumes, FITS, VALUES)
    law = law_volume(1e-11, LOAD, TRACK, [1, 2])
    np.testing.assert_allclose(factors["product"], volumes["touched_centroid_path_volume_m3"] / law, rtol=1e-12)
    np.testing.assert_allclose(factors[list(CANDIDATES)].prod(axis=1), factors["product"], rtol=1e-12)
    np.testing.assert_allclose(factors["force_rise"], [1.3, 1.5])
    np.testing.assert_allclose(factors["displacement_rule"], 1.8)
    np.testing.assert_allclose(factors["summing_over_all"], 2.0 / 1.8)
    np.testing.assert_allclose(factors["vertical_force_over_load"], 1.0)
    np.testing.assert_allclose(factors["published"], [0.0138e-9, 0.0282e-9] / law, rtol=1e-9)
    np.testing.assert_allclose(factors["unexplained"] * factors["product"], factors["published"], rtol=1e-12)


def test_published_volumes_are_over_the_law_of_their_own_load(tmp_path):
    """Twice the load wears twice as much: all factors stay, the published one too; no fit stands beside it."""
    volumes = two_revolutions(tmp_path)
    doubled = volumes.assign(
        load_n=2.0 * LOAD,
        **{name: 2.0 * volumes[name] for name in (*VOLUMES.values(), "carried_volume_m3")},
        **{name: 2.0 * volumes[name] for name in ("mean_normal_force_N", "mean_vertical_force_N")},
    )
    ours, theirs = (excess_factors(each, FITS, VALUES) for each in (doubled, volumes))
    pd.testing.assert_frame_equal(ours, theirs)
    assert beside_laws(doubled, FITS, VALUES)["published_volume_m3"].isna().all()
    assert beside_laws(volumes, FITS, VALUES)["published_volume_m3"].notna().all()


def test_carried_wear_is_a_factor_of_its_own(tmp_path):
    """A fifth of the law's wear carried: the share 0.8 is taken up, which the rule turns into 1.8 / 0.8 of it; the
    product stays."""
    volumes = two_revolutions(tmp_path)
    carried = volumes.assign(carried_volume_m3=0.2 * volumes["worn_volume_m3"])
    factors, without = (excess_factors(each, FITS, VALUES) for each in (carried, volumes))
    np.testing.assert_allclose(factors["taken_up"], 0.8)
    np.testing.assert_allclose(without["taken_up"], 1.0)
    np.testing.assert_allclose(factors["displacement_rule"], 1.8 / 0.8)
    np.testing.assert_allclose(factors["product"], without["product"], rtol=1e-12)


def test_every_volume_has_a_trend(tmp_path):
    """One row per volume; the increment of two equal ones is the linear term."""
    trends = volume_trends(two_revolutions(tmp_path)).set_index("volume")
    assert list(trends.index) == list(VOLUMES)
    assert trends.loc["removed", "linear_mm3_per_revolution"] == pytest.approx(1.8e-3)


def test_volume_of_a_published_groove():
    """The published 19 um and 1.07 mm hold 1.87 mm3, 3.5 times the published 0.532 mm3."""
    assert groove_volume(19e-6, 1.07e-3, TRACK) == pytest.approx(1.873e-9, rel=1e-3)


def test_excess_is_the_displacement_rule(pins):
    """Of six times the law's volume six are the displacement rule's, 1.02 the rise; conserving runs have 1."""
    *_, volumes = pins
    factors = excess_factors(volumes[volumes["series"] == "coefficient"], FITS, VALUES)
    shown = shown_factors(factors, VALUES)
    assert list(zip(shown["run"], shown["revolution"], strict=True)) == [
        ("c", 3),
        ("b", 1),
        ("b", 3),
        ("d", 1),
        ("d", 3),
    ]
    np.testing.assert_allclose(shown["displacement_rule"], [1, 6, 6, 6, 6], rtol=ROUNDING)
    np.testing.assert_allclose(shown["force_rise"], pin_study.RISE, rtol=ROUNDING)
    np.testing.assert_allclose(shown["slip"], 1.0, rtol=ROUNDING)
    np.testing.assert_allclose(shown["summing_rule"], [1, 0.5, 0.5, 0.5, 0.5], rtol=ROUNDING)  # conserving: over all
    assert set(CANDIDATES) < set(shown)


def test_scales_have_the_law_beside_them(pins):
    """The series of scales: alpha W over alpha F L is the rise of the force."""
    *_, volumes = pins
    table = size_invariance(size_cases(volumes))
    assert table["particle_scale"].tolist() == [8.0]
    np.testing.assert_allclose(table["difference_percent"], 2.0, rtol=1e-6)


def test_size_invariance_by_hand():
    """Ratios of simulated to theoretical volume, by scale."""
    sizes = pd.DataFrame(
        {
            "run": ["big", "small"],
            "particle_scale": [8.0, 1.0],
            "worn_volume_m3": [1.01e-9, 0.998e-9],
            "alpha_F_L_volume_m3": 1e-9,
        }
    )
    table = size_invariance(sizes)
    assert table["run"].tolist() == ["small", "big"]
    np.testing.assert_allclose(table["difference_percent"], [-0.2, 1.0])
    np.testing.assert_allclose(table["theoretical_volume_mm3"], 1.0)


def test_published_groove_holds_more_than_the_published_volume():
    """19 um and 1.07 mm hold 1.87 mm3: 3.5 times the published volume, 13 times alpha F L."""
    groove = published_groove(VALUES)
    assert groove["groove_over_published"] == pytest.approx(3.52, abs=0.01)
    assert groove["groove_over_alpha_F_L"] == pytest.approx(13.3, abs=0.1)
    assert "1.87 mm³, 3.5 times" in groove_remark(VALUES)
