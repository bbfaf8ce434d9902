"""Tables behind the figures of the pin-on-disc study, from files of a small study with closed forms."""

import numpy as np
import pandas as pd
import pytest
from workflows.cases.pin_on_disc.series import comparison, mesh_series, size_invariance

from tests import PUBLISHED
from tests.support import pin_study
from workflows.cases.pin_on_disc import figure_tables as pin_figures
from workflows.cases.pin_on_disc.runs import (
    CALIBRATED,
    REFERENCE,
    coefficient_remark,
    force_boxes,
    pin_runs,
    reference_remark,
    reference_runs,
    same_coefficient,
    size_histogram,
    window_forces,
)
from workflows.cases.pin_on_disc.volume import CANDIDATES, excess_factors

VALUES = pd.read_csv(PUBLISHED / "pin_on_disc.csv")
FITS = pd.read_csv(PUBLISHED / "pin_on_disc_volume.csv")
NORMALITY = pd.read_csv(PUBLISHED / "pin_on_disc_normality.csv")
ROUNDING = 1e-9  # -, of sums over a few cycles


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """Folder, runs, contours and volumes of the small study."""
    folder = pin_study.write_study(tmp_path_factory.mktemp("pins"))
    return folder, *pin_study.tables(folder)


def test_design_without_its_columns_is_refused(tmp_path):
    pd.DataFrame({"run": ["a"], "scheme": ["conserving"]}).to_csv(tmp_path / "design.csv", index=False)
    with pytest.raises(ValueError, match="column series, wear_coefficient_per_pa"):
        pin_runs(tmp_path / "design.csv")


def test_reference_runs_have_the_thesis_coefficient(study):
    """5e-11 for the reference simulations, 1.7e-11 for Table 5.4, of the series of coefficients, one run per scheme."""
    _, runs, *_ = study
    assert reference_runs(runs, VALUES, REFERENCE) == {"conserving": "c", "per_triangle": "d"}
    assert reference_runs(runs, VALUES, CALIBRATED) == {"conserving": "a", "per_triangle": "b"}
    assert same_coefficient(runs, 1.7e-11)["run"].tolist() == ["a", "b"]


def test_other_coefficient_than_the_thesis_is_said(study):
    """Without the wanted coefficient the nearest one stands for it, scheme by scheme, and the remark says so."""
    _, runs, *_ = study
    assert reference_remark(runs, VALUES, REFERENCE) == "wear coefficient 5e-11 1/Pa"
    others = runs[runs["wear_coefficient_per_pa"] != 1.7e-11]
    assert reference_runs(others, VALUES, CALIBRATED) == {"conserving": "c", "per_triangle": "d"}
    said = "wear coefficient 5e-11 1/Pa instead of the published 1.7e-11 (Yan 2022, section 5.4.3)"
    assert reference_remark(others, VALUES, CALIBRATED) == said
    one = runs[runs["run"] != "d"]
    assert reference_runs(one, VALUES, REFERENCE) == {"conserving": "c", "per_triangle": "b"}
    assert reference_remark(one, VALUES, REFERENCE) == (
        "wear coefficient, conserving: 5e-11 1/Pa, "
        "per triangle: 1.7e-11 1/Pa instead of the published 5e-11 (Yan 2022, Table 5.2)"
    )


def test_mesh_series_takes_its_finest_from_the_coefficients(study):
    """The mesh that only the series of coefficients has is that of the same coefficient."""
    _, runs, contours, _ = study
    series = mesh_series(runs, pin_figures.statistics_of(runs, contours).drop(columns="scheme"))
    finest = series[series["element_size_mm"] == 0.5]
    assert set(finest["run"]) == {"c", "d"}
    shown = runs[runs["run"].isin(series["run"])]
    assert coefficient_remark(shown, VALUES, REFERENCE) == "wear coefficient 5e-11 1/Pa"


def test_published_ranges_are_in_metres():
    """42 to 70 um and 0.8 to 1.6 mm (Yan 2022, Fig 5.10 and 5.11)."""
    ranges = pin_figures.published_ranges(VALUES).set_index("size")
    np.testing.assert_allclose(ranges.loc["depth", ["least_m", "largest_m"]].astype(float), [42e-6, 70e-6])
    np.testing.assert_allclose(ranges.loc["opening width", ["least_m", "largest_m"]].astype(float), [0.8e-3, 1.6e-3])
    assert ranges["source"].tolist() == ["Yan 2022, Fig 5.10", "Yan 2022, Fig 5.11"]


def test_forces_fall_into_their_revolution(study):
    """360 windows per revolution, the one that ends at 360 degrees in the first; the mean is the load."""
    folder, *_ = study
    forces = window_forces(folder / "a")
    assert forces["revolution"].value_counts().to_dict() == {1: 360, 2: 360, 3: 360}
    boxes = force_boxes(forces.assign(run="a"))
    vertical, normal = (boxes[boxes["force"] == name] for name in ("vertical_force", "normal_force"))
    np.testing.assert_allclose(vertical["mean_N"], pin_study.LOAD)
    np.testing.assert_allclose(normal["mean_N"], pin_study.RISE * pin_study.LOAD)
    np.testing.assert_allclose(vertical[["least_N", "largest_N"]], [[4.5, 5.5]] * 3)
    with pytest.raises(FileNotFoundError, match=r"no cycle_\*/forces.csv"):
        window_forces(folder / "none")


def test_histogram_counts_every_contour():
    """Counts add up to the sample, and so does the normal curve but for its tails."""
    values = np.random.default_rng(3).normal(1.0, 0.1, 360)
    bars = size_histogram(values, 20)
    assert bars["count"].sum() == 360
    assert 350 < bars["normal_count"].sum() < 360


def test_sections_of_the_last_revolutions(study):
    """Eight angles, three revolutions, nowhere less deep than the one before, and deeper on the whole."""
    folder, runs, contours, _ = study
    chosen = runs[runs["run"].isin(["a", "b"])]
    sections = pin_figures.example_sections(folder, chosen, contours)
    assert set(sections["revolution"]) == {1, 2, 3}
    deepest = sections.groupby(["scheme", "angle_deg", "revolution"])["depth_um"].max().unstack()
    assert len(deepest) == 2 * len(pin_figures.EXAMPLE_ANGLES)
    assert (np.diff(deepest, axis=1) >= 0.0).all()
    assert (np.diff(deepest.mean()) > 0.0).all()


def test_sections_of_the_meshes(study):
    """One section per mesh and scheme after one revolution, the conserving scheme first."""
    folder, runs, contours, _ = study
    series = mesh_series(runs, pin_figures.statistics_of(runs, contours).drop(columns="scheme"))
    sections = pin_figures.mesh_sections(folder, runs, series)
    assert list(dict.fromkeys(sections["run"])) == ["c", "e", "d", "f"]
    assert set(sections["revolution"]) == {1}


def test_words_of_the_run_in(study):
    """A smooth wave round the disc is not normal: never for ours, 8 for the published depth."""
    _, runs, contours, _ = study
    statistics = pin_figures.only_reference(pin_figures.statistics_of(runs, contours), runs, VALUES, REFERENCE)
    words = pin_figures.run_in_words(statistics, NORMALITY)
    assert words["depth"] == "normal from: conserving never, per triangle never, Yan 8"


def test_excess_is_the_displacement_rule(study):
    """Of six times the law's volume six are the displacement rule's, 1.02 the rise; conserving runs have 1."""
    *_, volumes = study
    factors = excess_factors(volumes[volumes["series"] == "coefficient"], FITS)
    shown = pin_figures.shown_factors(factors, VALUES)
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


def test_scales_have_the_law_beside_them(study):
    """The series of scales: alpha W over alpha F L is the rise of the force."""
    *_, volumes = study
    table = size_invariance(pin_figures.size_cases(volumes))
    assert table["particle_scale"].tolist() == [8.0]
    np.testing.assert_allclose(table["difference_percent"], 2.0, rtol=1e-6)


def test_compared_cases(study):
    """Reference runs, the run whose law has the laboratory's volume, then the pin's shape, at the last revolution.

    The means are those of the contours; the pin's shape has the laboratory's volume.
    """
    _, runs, contours, volumes = study
    compared = pin_figures.compared_runs(runs, VALUES)
    cases = pin_figures.compared_cases(compared, contours, volumes, VALUES)
    assert cases["run"].tolist() == ["a", "b", "h", ""]
    last = contours[(contours["run"] == "b") & (contours["revolution"] == 3)]
    assert cases.loc[1, "depth_mm"] == pytest.approx(1e3 * last["depth_m"].mean())
    assert cases.loc[1, "case"] == "per triangle, 1.7e-11/Pa, 3 rev."
    table = comparison(VALUES, cases)
    assert table["case"].tolist()[:2] == ["laboratory", "Yan 2022"]
    assert table.iloc[-1]["volume_to_laboratory_percent"] == pytest.approx(0.0)


def test_sections_beside_the_laboratory(study):
    """Three angles of every compared run under the name of its case."""
    folder, runs, contours, volumes = study
    compared = pin_figures.compared_runs(runs, VALUES)
    cases = pin_figures.compared_cases(compared, contours, volumes, VALUES)
    sections = pin_figures.laboratory_sections(folder, compared, cases)
    assert list(dict.fromkeys(sections["case"])) == cases["case"].tolist()[:3]
    assert set(sections["angle_deg"]) == set(pin_figures.LABORATORY_ANGLES)
    boxes = pin_figures.laboratory_boxes(VALUES)
    np.testing.assert_allclose(boxes[["depth_mm", "width_mm"]], [[0.010, 0.65], [0.014, 0.8]])


def test_calibration_of_all_schemes(study):
    """Volumes in proportion to the coefficient need the laboratory's coefficient times the scaling over the excess."""
    *_, volumes = study
    table = pin_figures.calibrated(volumes, FITS, VALUES)
    ours = table[table["scheme"] == "per_triangle"].iloc[-1]
    circle = 2.0 * np.pi * pin_study.TRACK
    expected = 0.565e-9 / (pin_study.LOAD * circle * 3 * pin_study.RISE * 6.0)
    assert ours["wear_coefficient_per_pa"] == pytest.approx(expected, rel=1e-6)
    touched = table[table["scheme"] == pin_figures.TOUCHED].iloc[-1]  # Eq 5.9 finds half: twice the coefficient
    assert touched["wear_coefficient_per_pa"] == pytest.approx(2.0 * expected, rel=1e-6)
    assert set(table["scheme"]) == {"conserving", "per_triangle", pin_figures.TOUCHED, pin_figures.PUBLISHED_FITS}


@pytest.mark.parametrize(("revolutions", "theirs"), [(1, False), (2, False), (3, True)])
def test_few_revolutions_are_calibrated_without_the_published_fits(study, revolutions, theirs):
    """After 1 and 2 revolutions the published fits do not grow with the coefficient: ours alone are calibrated."""
    *_, volumes = study
    table = pin_figures.calibrated(volumes[volumes["revolution"] <= revolutions], FITS, VALUES)
    assert set(table["revolutions"]) == {revolutions}
    assert {"conserving", "per_triangle"} < set(table["scheme"])
    assert (pin_figures.PUBLISHED_FITS in set(table["scheme"])) == theirs


def test_map_of_the_track(study):
    """Depth over radius and angle: deepest in the middle of the track, a tenth deeper at 0 than at 180 degrees."""
    folder, runs, *_ = study
    meshes, track = pin_figures.reference_discs(folder, runs, VALUES)
    shown = pin_figures.track_map(meshes["per_triangle"], track)
    assert shown.shape[1] == 360
    assert shown.index[0] == pytest.approx(20.8)
    assert abs(float(shown.mean(axis=1).idxmax()) - 22.0) < 0.25  # mm, half an element


def test_published_groove_holds_more_than_the_published_volume():
    """19 um and 1.07 mm hold 1.87 mm3: 3.5 times the published volume, 13 times alpha F L."""
    groove = pin_figures.published_groove(VALUES)
    assert groove["groove_over_published"] == pytest.approx(3.52, abs=0.01)
    assert groove["groove_over_alpha_F_L"] == pytest.approx(13.3, abs=0.1)
    assert "1.87 mm³, 3.5 times" in pin_figures.groove_remark(VALUES)
