"""Volumes of the circular wear tester: known laws come back, and the source's own numbers fit together as stated."""

import numpy as np
import pytest

from bulkwear.postproc.tables.summary import published_value
from bulkwear.workflows.cases.circular_tester.volume import (
    TERMS,
    chosen_fit,
    crossing,
    element_increments,
    fit_at,
    fit_up_to,
    origin_fit,
    predictions,
    published_terms,
    rate_crossing,
    time_scale,
    volume_at,
    volume_fits,
)
from tests.support import tester_study as study

EXACT = 1e-9  # relative, of fits to noiseless laws
COEFFICIENT = 5e-9  # 1/Pa, of the synthetic runs
SECTOR = 2.142 / 2  # m per revolution (Yan 2022, section 6.4.1: 2.142 m in two)
AREA = 0.01  # m2
PRINTED = 0.5  # mm3: printed volumes of Eq 6.2 and 6.3 at 184 h, computed from rounded coefficients
ROUNDED = 0.06  # mm3, of numbers printed with one decimal


@pytest.fixture(scope="module")
def fits():
    return volume_fits(study.volumes())


@pytest.fixture(scope="module")
def scale(fits):
    return time_scale(chosen_fit(fits, "plain_3"), COEFFICIENT, study.PUBLISHED, SECTOR, AREA)


@pytest.mark.parametrize("case", study.LAWS)
def test_laws_come_back(fits, case):
    """Terms of every run; curvature is told where there is some, and only there."""
    assert chosen_fit(fits, f"{case[0]}_{case[1]}") == pytest.approx(study.LAWS[case], rel=EXACT, abs=1e-9)
    quadratic = fits[(fits["run"] == f"{case[0]}_{case[1]}") & (fits["fit"] == "quadratic")].iloc[0]
    assert quadratic["r_squared"] == pytest.approx(1.0)


def test_noise_is_no_curvature():
    """A straight line with noise of 2 mm3 stays a line; a curve of the thesis' size is told from it."""
    fits = volume_fits(study.volumes(noise=2.0)).set_index(["run", "fit"])
    assert not fits.loc[("plain_3", "quadratic"), "curved"]
    assert fits.loc[("convex_3", "quadratic"), "curved"]


def test_errors_of_a_fit_are_the_scatter_of_repeated_fits():
    generator = np.random.default_rng(5)
    x = np.arange(1.0, 18.0)
    found, errors = zip(
        *(origin_fit(x, 70.0 * x + generator.normal(0.0, 3.0, len(x)), 2)[:2] for _ in range(400)), strict=True
    )
    assert np.std(found, axis=0) == pytest.approx(np.mean(errors, axis=0), rel=0.1)  # 0.035 of 400 trials


def test_too_few_points_give_no_fit():
    assert np.isnan(origin_fit(np.array([0.0, 1.0]), np.array([0.0, 1.0]), 2)[0]).all()


def test_the_source_at_184_hours():
    """Eq 6.2 and 6.3 at 6.57 revolutions are the numbers that the text calls the experiment: it swaps both."""
    revolutions = 184.0 / 56.0 * 2.0
    for surface, printed in (("plain", 483.9), ("convex", 212.9)):
        terms = published_terms(study.PUBLISHED_FITS, surface, 1.0)
        assert volume_at(terms, revolutions) == pytest.approx(printed, abs=PRINTED + ROUNDED)
        assert published_value(study.PUBLISHED, f"{surface}_volume_184_h", "simulation") == printed
    assert np.isnan(published_terms(study.PUBLISHED_FITS, "plain", 2.0)).all()


def test_reductions_of_the_experiment():
    """-43 % at 56 h, -49 % at 184 h."""
    for hours, reduction in ((56, 43.0), (184, 49.4)):
        plain, convex = (
            published_value(study.PUBLISHED, f"{surface}_volume_{hours}_h", "laboratory")
            for surface in ("plain", "convex")
        )
        assert 100.0 * (1.0 - convex / plain) == pytest.approx(reduction, abs=0.1)


def test_increments():
    """Eq 6.7: of a quadratic law a + b (2 j + 1), over the elements."""
    table = element_increments(study.volumes()).set_index(["run", "revolution"])
    assert table.loc[("convex_3", 4.0), "increment_mm3"] == pytest.approx(45.0 + 0.75 * 9.0)
    assert table.loc[("convex_3", 4.0), "element_increment_mm3"] == pytest.approx((45.0 + 0.75 * 9.0) / 40_000)
    assert table.loc["plain_3", "increment_mm3"].to_numpy() == pytest.approx(np.full(study.REVOLUTIONS, 75.0))


@pytest.mark.parametrize(
    ("plain", "convex", "where"),
    [
        ((75.0, 0.0), (45.0, 0.75), 40.0),
        ((75.0, 0.0), (45.0, 0.0), np.inf),
        ((75.0, 0.0), (45.0, -0.5), np.inf),
        ((75.0, 0.0), (80.0, 0.5), 0.0),
        ((75.0, 0.0), (80.0, -0.5), np.inf),
        ((75.0, 0.5), (45.0, 1.0), 60.0),
    ],
)
def test_where_convex_overtakes_plain(plain, convex, where):
    """In sum at the root of the difference, in rate at half of it; infinite for never."""
    assert crossing(np.array(plain), np.array(convex)) == where
    assert rate_crossing(np.array(plain), np.array(convex)) == 0.5 * where
    if 0.0 < where < np.inf:
        assert volume_at(np.array(plain), where) == pytest.approx(volume_at(np.array(convex), where))


def test_time_scale_rests_on_the_plain_sample(scale):
    """56 h are as many revolutions as wear 145.2 mm3; the coefficient for two revolutions is in proportion."""
    assert scale.revolutions(56.0) == pytest.approx(145.2 / 75.0)
    assert scale.wear_coefficient == pytest.approx(COEFFICIENT * 145.2 / 150.0)
    assert scale.laboratory_coefficient == pytest.approx(145.2e-9 / (1200.0 * AREA * 0.6 * 56.0 * 3600.0))
    assert scale.distance_scale == pytest.approx(0.6 * 56.0 * 3600.0 / (145.2 / 75.0 * SECTOR))


def test_time_scale_of_a_curved_plain_run():
    """The revolution is where the curve meets the volume."""
    scale = time_scale(np.array([60.0, 2.0]), COEFFICIENT, study.PUBLISHED, SECTOR, AREA)
    assert volume_at(np.array([60.0, 2.0]), scale.revolutions(56.0)) == pytest.approx(145.2)
    with pytest.raises(ValueError, match="never reaches"):
        time_scale(np.array([20.0, -1.0]), COEFFICIENT, study.PUBLISHED, SECTOR, AREA)


def test_predictions(fits, scale):
    """The plain sample is met at 56 h by construction; the convex one is predicted; what lies beyond a run is said."""
    table = predictions(fits, scale, [56.0, 184.0, 600.0]).set_index(["run", "hours"])
    assert table.loc[("plain_3", 56.0), "volume_mm3"] == pytest.approx(145.2)
    x = 184.0 / 56.0 * 145.2 / 75.0
    convex = 45.0 * x + 0.75 * x**2
    assert table.loc[("convex_3", 184.0), "volume_mm3"] == pytest.approx(convex)
    assert table.loc[("convex_3", 184.0), "reduction_percent"] == pytest.approx(100.0 * (1.0 - convex / (75.0 * x)))
    assert table.loc[("plain_3", 184.0), "reduction_percent"] == pytest.approx(0.0, abs=1e-9)
    assert np.isnan(table.loc[("convex_1", 56.0), "reduction_percent"])  # no plain run of its scale
    assert table["extrapolated"].to_dict() == {key: key[1] == 600.0 for key in table.index}


def test_a_curve_that_flattens_is_not_followed_beyond_its_run():
    """Inside the run the parabola counts, beyond it the line; the plain sample is met at 56 h all the same."""
    law, last = np.array([8.0, -0.2]), study.REVOLUTIONS
    volumes = study.volumes()
    volumes = volumes[volumes["run"] == "plain_3"]
    volumes = volumes.assign(volume_m3=1e-9 * volume_at(law, volumes["revolution"]))
    fits = volume_fits(volumes)
    line = fits[fits["fit"] == "linear"].iloc[0][TERMS].to_numpy(float)
    assert fit_at(fits, "plain_3", last) == pytest.approx(law)
    assert fit_at(fits, "plain_3", last + 1.0).tolist() == line.tolist()
    assert fit_up_to(fits, "plain_3", 40.0) == pytest.approx(law)
    assert fit_up_to(fits, "plain_3", 145.2).tolist() == line.tolist()
    scale = time_scale(fit_up_to(fits, "plain_3", 145.2), COEFFICIENT, study.PUBLISHED, SECTOR, AREA)
    table = predictions(fits, scale, [56.0, 184.0])
    assert table["volume_mm3"].to_list() == pytest.approx([145.2, 145.2 * 184.0 / 56.0]) and table["extrapolated"].all()


def test_published_tables_are_whole():
    """Every value has a source; quantities come once."""
    for table in (study.PUBLISHED, study.PUBLISHED_FITS):
        assert table["source"].str.startswith("Yan 2022").all()
    assert not study.PUBLISHED.duplicated(["quantity", "of"]).any()
    assert list(study.PUBLISHED_FITS[TERMS].dtypes) == [np.dtype(float)] * 2
