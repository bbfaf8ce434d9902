"""Volumes of the circular wear tester: known laws come back, and the source's own numbers fit together as stated."""

import numpy as np
import pytest

from bulkwear.postproc.tables.summary import published_value
from bulkwear.workflows.cases.circular_tester.volume import (
    TERMS,
    change_of_terms,
    element_increments,
    mean_increments,
    mean_volumes,
    published_terms,
    rates,
    volume_of_terms,
    volumes_at,
)
from tests.support import tester_study as study

EXACT = 1e-9  # relative, of what noiseless laws give
PRINTED = 0.5  # mm3: printed volumes of Eq 6.2 and 6.3 at 184 h, computed from rounded coefficients
ROUNDED = 0.06  # mm3, of numbers printed with one decimal


@pytest.mark.parametrize("case", study.LAWS)
def test_rates_and_their_changes_come_back(case):
    """Of a quadratic law: the mean rate over the run, and its rise from start to end over that."""
    table = rates(study.volumes(packings=2)).set_index(["surface", "particle_scale"])
    row, (a, b) = table.loc[(case[0], float(case[1]))], study.LAWS[case]
    assert row["rate_mm3_per_revolution"] == pytest.approx(a + b * study.REVOLUTIONS, rel=EXACT)
    assert row["change_percent"] == pytest.approx(change_of_terms(np.array([a, b]), study.REVOLUTIONS), abs=1e-6)
    assert (row["packings"], row["revolutions"]) == (2, study.REVOLUTIONS)


def test_of_one_packing_there_is_no_interval():
    """However many revolutions it has; of packings that scatter the law lies inside, of a straight one no change."""
    one, several = (rates(study.volumes(packings=n, scatter=0.02, noise=0.03)) for n in (1, 4))
    ends = ["rate_mm3_per_revolution_low", "rate_mm3_per_revolution_high", "change_percent_low", "change_percent_high"]
    assert one[ends].isna().all(axis=None) and one["rate_mm3_per_revolution"].notna().all()
    plain = several.set_index("surface").loc["plain"]
    assert plain["rate_mm3_per_revolution_low"] < 75.0 < plain["rate_mm3_per_revolution_high"]
    assert plain["change_percent_low"] < 0.0 < plain["change_percent_high"]


def test_packings_of_other_lengths_are_compared_where_all_are():
    """A packing that goes on longer adds nothing to rates and means."""
    lost = study.volumes(packings=3, scatter=0.02)
    short = lost[(lost["packing"] == 1) | (lost["revolution"] <= 6.0)]
    assert rates(short)["revolutions"].unique().tolist() == [6.0]
    means = mean_volumes(short)
    assert means["revolution"].max() == 6.0 and (means["packings"] == 3).all()
    row = means[(means["surface"] == "plain") & (means["revolution"] == 6.0)].iloc[0]
    at_six = lost[(lost["surface"] == "plain") & (lost["revolution"] == 6.0)]["volume_m3"]
    assert row["volume_mm3"] == pytest.approx(1e9 * at_six.mean(), rel=EXACT)
    assert row["interval_low"] < row["volume_mm3"] < row["interval_high"]


def test_volumes_between_and_beyond():
    """Interpolated inside the run, continued as the increments grow beyond, and not made beyond twice the run."""
    lost = study.volumes(packings=2)
    curved = lost[(lost["surface"] == "convex") & (lost["particle_scale"] == 3.0)]
    inside = 0.5 * (45.0 + 0.75 * (2.0 * 4.0 + 1.0)) + 45.0 * 4.0 + 0.75 * 16.0
    assert volumes_at(curved, 4.5).to_numpy() == pytest.approx([inside] * 2, rel=EXACT)
    assert volumes_at(curved, 30.0).to_numpy() == pytest.approx([45.0 * 30.0 + 0.75 * 900.0] * 2, rel=1e-6)
    assert volumes_at(curved, 2.0 * study.REVOLUTIONS + 1.0).isna().all()


def test_the_source_at_184_hours():
    """Eq 6.2 and 6.3 at 6.57 revolutions are the numbers that the text calls the experiment: it swaps both."""
    revolutions = 184.0 / 56.0 * 2.0
    for surface, printed in (("plain", 483.9), ("convex", 212.9)):
        terms = published_terms(study.PUBLISHED_FITS, surface, 1.0)
        assert volume_of_terms(terms, revolutions) == pytest.approx(printed, abs=PRINTED + ROUNDED)
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


def test_what_the_sources_own_equations_say():
    """After two revolutions particles of scale 4 wear less than those of scale 3. Convex of scale 4 wears faster than
    Eq 6.2 from revolution 10 on, not 15: its increments are means over elements, of which a convex sample has more.
    Its rates rise by 30 % (scale 1) to 78 % (scale 4) of their mean over seventeen revolutions.
    """
    terms = {scale: published_terms(study.PUBLISHED_FITS, "convex", scale) for scale in (1.0, 2.0, 3.0, 4.0)}
    after = {scale: float(volume_of_terms(each, 2.0)) for scale, each in terms.items()}
    assert after[4.0] < after[3.0] and sorted(after.values()) != list(after.values())
    plain = published_terms(study.PUBLISHED_FITS, "plain", 1.0)
    assert (plain[0] - terms[4.0][0]) / (2.0 * terms[4.0][1]) == pytest.approx(10.2, abs=0.05)
    assert 100.0 * (1.0 - after[1.0] / volume_of_terms(plain, 2.0)) == pytest.approx(58.0, abs=0.1)
    assert [change_of_terms(terms[scale], 17.0) for scale in (1.0, 4.0)] == pytest.approx([29.6, 78.1], abs=0.05)


def test_increments():
    """Eq 6.7: of a quadratic law a + b (2 j + 1), over the elements."""
    lost = study.volumes()
    table = element_increments(lost).set_index(["surface", "particle_scale", "revolution"])
    row = table.loc[("convex", 3.0, 4.0)]
    assert row["increment_mm3"] == pytest.approx(45.0 + 0.75 * 9.0)
    assert row["element_increment_mm3"] == pytest.approx((45.0 + 0.75 * 9.0) / 40_000)
    assert table.xs("plain")["increment_mm3"].to_numpy() == pytest.approx(np.full(study.REVOLUTIONS, 75.0))
    means = mean_increments(study.volumes(packings=2)).set_index(["surface", "particle_scale", "revolution"])
    assert means.loc[("convex", 3.0, 5.0), "increment_mm3"] == pytest.approx(row["increment_mm3"])
    assert (means["packings"] == 2).all()
    assert means.index.get_level_values("revolution").min() == 1.0  # as the source counts them


def test_published_tables_are_whole():
    """Every value has a source; quantities come once."""
    for table in (study.PUBLISHED, study.PUBLISHED_FITS):
        assert table["source"].str.startswith("Yan 2022").all()
    assert not study.PUBLISHED.duplicated(["quantity", "of"]).any()
    assert list(study.PUBLISHED_FITS[TERMS].dtypes) == [np.dtype(float)] * 2
