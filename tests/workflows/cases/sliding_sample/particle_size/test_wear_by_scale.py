"""Wear against particle scale, on made-up studies whose lines and crossing are known."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.reference.size_ratios import PUBLISHED_DIAMETER, PUBLISHED_PATTERN, size_ratios
from bulkwear.workflows.cases.sliding_sample.particle_size import figures
from bulkwear.workflows.cases.sliding_sample.particle_size.wear_by_scale import (
    PARTS,
    RATIOS,
    bed_sentences,
    beside_published,
    critical_scale,
    critical_scale_text,
    lines_beside,
    points_of,
    published_by_size_ratio,
    ratio_by_scale,
    wear_by_scale,
    wear_by_size_ratio,
    wear_lines,
)
from tests import PUBLISHED
from tests.support.charts import drawn_chart, values

LINES = pd.read_csv(PUBLISHED / "particle_size_lines.csv")
SCALES = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0])
TRUTH = 1.09 / 0.262  # where Eq 4.14 and 4.15 cross
ROUNDING = 1e-9  # relative


def summary(scales=SCALES, noise=0.0, volume=4e-9, packings=1):
    """A study's summary that follows the published lines; volume: m3, of the plain sample at wear 1; noise: -, of each
    packing's convex wear over its plain sample's; rows S4, S4-2, ...
    """
    random, rows = np.random.default_rng(7), []
    line = {row["curve"]: row["intercept"] + row["slope"] * np.asarray(scales) for _, row in LINES.iterrows()}
    for k, scale in enumerate(scales):
        for packing in range(1, packings + 1):
            name = f"S{scale:g}" + (f"-{packing}" if packing > 1 else "")
            for surface in ("convex", "plain"):
                whole = volume * line[surface][k] * np.exp(noise * random.normal())
                base = volume * line["base"][k] if surface == "convex" else whole
                volumes = {"worn": whole, "base_worn": base, "pattern_worn": whole - base}
                told = {f"{part}_volume_m3": value for part, value in volumes.items()}
                rows.append({"row": name, "surface": surface, "particle_scale": scale, **told})
    return pd.DataFrame(rows)


def test_wear_is_relative_to_the_plain_sample_with_the_smallest_particles():
    """The plain sample at scale 1 is 1 itself, whatever the volumes; base and bumps of the convex one add up."""
    wear = wear_by_scale(summary())
    assert set(wear["curve"]) == {"plain", "convex", *PARTS} and set(wear["reference_scale"]) == {1.0}
    table = wear.pivot(index="particle_scale", columns="curve", values="relative_wear")
    assert table.loc[1.0, "plain"] == pytest.approx(1.0, rel=ROUNDING)
    assert np.allclose(table["base"] + table["bumps"], table["convex"], rtol=ROUNDING)
    assert np.allclose(table["convex"], (-0.08 + 0.26 * SCALES) / 1.008, rtol=ROUNDING)
    assert np.allclose(wear_by_scale(summary(volume=1.0))["relative_wear"], wear["relative_wear"], rtol=ROUNDING)


def test_a_study_without_scale_one_says_what_it_is_relative_to():
    """Quick scales: the plain sample at scale 4 is the reference, and stands in the table."""
    assert set(wear_by_scale(summary([4.0, 6.0, 8.0]))["reference_scale"]) == {4.0}


def test_published_lines_come_back():
    """Each curve has its published intercept and slope, but for the reference's 1.008, beside the published ones."""
    lines = beside_published(wear_lines(wear_by_scale(summary())), LINES)
    assert np.allclose(lines["slope"] * 1.008, lines["published_slope"], atol=1e-9)
    assert np.allclose(lines["intercept"] * 1.008, lines["published_intercept"], atol=1e-9)
    assert (lines["points"] == len(SCALES)).all() and lines["source"].str.startswith("Yan 2022, Eq 4.1").all()


def test_two_scales_make_no_line():
    """Two points are not fitted; the critical scale is left open, and why."""
    wear = wear_by_scale(summary([4.0, 8.0], packings=3))
    assert wear_lines(wear)["slope"].isna().all()
    found, forms = critical_scale(wear)
    assert forms.empty and not found.bounded and "2 places" in critical_scale_text(found)


def test_the_critical_scale_is_where_both_wear_alike():
    """Packings that scatter by 3 % hold it in their interval and tell the scales beside it by themselves."""
    found, forms = critical_scale(wear_by_scale(summary(noise=0.03, packings=3)))
    assert found.low < TRUTH < found.high and found.bounded and found.packings == 3
    assert found.below <= 4.0 and found.above == 5.0
    line = forms.set_index("form").loc["ratio, line"]
    assert not line["rejected"] and line["freedom_of_error"] == 2 * len(SCALES)
    assert critical_scale_text(found).startswith(f"critical scale {found.value:.3g}, 95 % interval over")


def test_one_packing_has_a_crossing_without_interval():
    """Its scatter is unknown, and the phrase says so; the value is that of the line it follows."""
    found, _ = critical_scale(wear_by_scale(summary()))
    assert found.value == pytest.approx(TRUTH, rel=0.01) and not found.bounded
    assert "one packing, scatter unknown" in critical_scale_text(found)


def test_no_crossing_is_extended_beyond_the_scales():
    """Convex wear stays below plain: nothing is said of where it would reach it."""
    found, forms = critical_scale(wear_by_scale(summary([1.0, 2.0, 3.0], noise=0.02, packings=3)))
    assert np.isnan(found.value) and found.reason == "none between the smallest and the largest"
    assert forms["crossing"].isna().all()


def beds(forces, layers, thicknesses=(46.0,)):
    """Plain runs of two packings per scale, {scale: mean normal force, N}, whose forces are 1 N off their mean."""
    return pd.DataFrame(
        {"particle_scale": scale, "mean_normal_force_N": force + off, "layers": layers / scale, "bed_thickness_mm": mm}
        for scale, force in forces.items()
        for off in (-1.0, 1.0)
        for mm in thicknesses
    )


def test_lighter_beds_are_told():
    """By the plain sample's mean force over that at the smallest scale, whatever the order of the rows; beds of fewer
    than two layers by name, two layers are enough.
    """
    said = " ".join(bed_sentences(beds({12.0: 10.0, 6.0: 25.0, 8.0: 23.5}, layers=16.0)))
    assert "a level one of 46 mm" in said
    assert "over that at scale 6, is 94 % at scale 8, 40 % at scale 12;" in said
    assert "Beds of scale 12 have fewer than 2 layers" in said


def test_of_beds_that_cannot_be_compared_nothing_is_told():
    """One scale has no other to be set over; thicknesses that differ are another change; thick beds are beds."""
    assert bed_sentences(beds({6.0: 25.0}, layers=16.0)) == ["All beds have the mass of a level one of 46 mm."]
    assert bed_sentences(beds({6.0: 25.0, 8.0: 23.5}, layers=16.0, thicknesses=(46.0, 20.0))) == []
    assert "fewer" not in " ".join(bed_sentences(beds({6.0: 25.0, 8.0: 23.5}, layers=16.0)))


def test_ratios_have_an_interval_per_scale():
    """Over packings of the same scale, of both samples in the same bed."""
    table = ratio_by_scale(wear_by_scale(summary([2.0, 6.0], noise=0.02, packings=3)))
    assert table["packings"].tolist() == [3, 3]
    assert table["interval_high"][0] < 1.0 < table["interval_low"][1]


def test_ratios_stand_beside_convex_over_plain_wear():
    """Scale by scale the ratios of the scaled particles; on the published lines points lie on the published curve."""
    ratios = {scale: size_ratios(scale * PUBLISHED_DIAMETER, *PUBLISHED_PATTERN) for scale in SCALES}
    ours = wear_by_size_ratio(wear_by_scale(summary()), ratios)
    theirs = published_by_size_ratio(LINES, SCALES)
    assert list(ours["particle_scale"]) == list(SCALES)
    for column in (*RATIOS, "wear_over_plain"):
        assert np.allclose(ours[column], theirs[column], rtol=ROUNDING), column


def test_another_pattern_is_not_set_beside_the_sources():
    """Curves have the surface's own name; of the source's lines only that of the plain sample is set beside them."""
    lines, wear = pd.DataFrame({"curve": ["plain", "convex", "base", "bumps"]}), wear_by_scale(summary())
    other = wear_by_scale(summary().replace({"surface": {"convex": "dimpled"}}))
    assert set(other["curve"]) == {"plain", "dimpled", *PARTS}
    assert critical_scale(other)[0].value == critical_scale(wear)[0].value
    assert lines_beside(lines, same_pattern=True)["curve"].tolist() == lines["curve"].tolist()
    assert lines_beside(lines, same_pattern=False)["curve"].tolist() == ["plain"]


def test_the_chart_has_the_published_lines_from_end_to_end():
    """Ours lie on them: the summary follows them; each line goes from the least to the largest scale simulated."""
    wear = wear_by_scale(summary())
    ends = points_of(LINES, wear)
    found = drawn_chart(figures.wear_against_scale.product, wear, published_lines=ends)
    bumps = ends[ends["curve"] == "bumps"]
    assert values(found, "pattern, Yan 2022") == [pytest.approx(bumps["relative_wear"], rel=1e-5)]
    assert values(found, "pattern, Yan 2022", along="x") == [[1.0, 8.0]]
    ours = np.ravel(values(found, "pattern"))
    expected = ends.loc[ends["curve"] == "bumps", "relative_wear"] / ends["relative_wear"].iloc[0]
    assert (ours[0], ours[-1]) == pytest.approx(tuple(expected), rel=1e-5)
