"""Sentences on the figures of pins on discs say what their tables say."""

import pandas as pd
import pytest

from bulkwear.postproc.tables.summary import NAMES
from bulkwear.workflows.cases.pin_on_disc import figure_findings as findings
from bulkwear.workflows.cases.pin_on_disc.volume import law_volume
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.worn_pair import LAW_FIGURES
from bulkwear.workflows.report.products import products_of

SCHEMES = ["conserving", "per_triangle"]
RUNS = {"run": ["a", "b"], "scheme": SCHEMES, "wear_coefficient_per_pa": 1e-11}


def test_runs_stand_beside_laboratory_and_thesis():
    """Ours alone, in times of each; a table of the sources alone shows nothing of ours."""
    shares = {f"{name}_to_laboratory_percent": [0.0, -50.0] for name in ("depth", "width", "volume")}
    shares |= {f"{name}_to_thesis_percent": [5.0, 20.0] for name in ("depth", "width", "volume")}
    table = pd.DataFrame(
        {"case": ["laboratory", "conserving, 12 rev."], "run": [None, "a"], "volume_mm3": 0.25} | shares
    )
    assert findings.compared(table) == (
        "Conserving, 12 rev., removes 0.25 mm³, 0.5 times the laboratory's and 1.2 times the thesis' volume; the groove"
        " is 0.5 and 1.2 times as deep and 0.5 and 1.2 times as wide as theirs."
    )
    assert findings.compared(table.head(1)) == ""


def test_what_the_rules_make_of_the_published_excess():
    """After the last revolution of each scheme and coefficient."""
    table = pd.DataFrame(RUNS | {"revolution": 12, "product": [1.0, 4.0], "published": 6.0})
    first = table.assign(revolution=1, product=3.0)
    assert findings.excess(pd.concat([first, table], ignore_index=True)) == (
        "Of the published multiples of alpha F L the rules make 1 of 6 (conserving, 1e-11 1/Pa) and 4 of 6 (per"
        " triangle, 1e-11 1/Pa)."
    )


def test_volumes_over_the_law_are_those_of_the_end():
    """A disc that has lost what the law says, and one with six times it."""
    fixed = {"load_n": 5.0, "track_radius_m": 0.022, "revolution": 2}
    removed = [each * law_volume(1e-11, 5.0, 0.022, 2) for each in (1.0, 6.0)]
    table = pd.DataFrame(RUNS | fixed | {"removed_volume_m3": removed})
    said = "In the end discs have lost 1 (conserving) and 6 (per triangle) times alpha F L."
    assert findings.over_law(pd.concat([table.assign(revolution=1), table], ignore_index=True)) == said


def test_forces_and_contacts_of_the_end():
    """By scheme over the runs; means of the last revolution by run."""
    table = pd.DataFrame(RUNS | {"revolution": 3, "force_rise": [1.0, 1.02], "contacts": [7.0, 25.0]})
    assert findings.force_over_load(table) == (
        "The summed normal force is in the end 1 (conserving) and 1 (per triangle) times the load, with 7 (conserving)"
        " and 25 (per triangle) contacts at once."
    )
    forces = {"run": "a", "revolution": [1, 2, 2], "force": ["normal_force", "vertical_force", "normal_force"]}
    said = findings.forces(pd.DataFrame(forces | {"mean_N": [9.0, 5.0, 5.1]}))
    assert said == "Means of the last revolution: 5 N of vertical and 5.1 N of summed normal force (a)."


def test_coefficients_say_what_is_extrapolated():
    """Of the most revolutions alone."""
    table = pd.DataFrame({"scheme": SCHEMES, "revolutions": 12, "wear_coefficient_per_pa": [6.81e-11, 1e-11]})
    table = table.assign(interpolated=[False, True])
    assert findings.coefficients(pd.concat([table.assign(revolutions=8), table], ignore_index=True)) == (
        "12 revolutions remove the laboratory's volume with 6.81e-11 1/Pa (conserving, extrapolated) and 1e-11 1/Pa"
        " (per triangle)."
    )


def test_sizes_of_pins():
    """The largest difference, whatever its sign."""
    table = pd.DataFrame({"particle_scale": [1.0, 8.0], "difference_percent": [0.1, -0.5]})
    assert findings.sizes(table) == "Volumes of pins of scale 1 to 8 differ from alpha F L by up to 0.5 %."


def test_depths_by_mesh():
    """Of the finest and of the coarsest elements; one mesh is told once."""
    table = pd.DataFrame({"scheme": "conserving", "element_size_mm": [0.1, 0.1, 1.0], "depth_um": [1.0, 5.0, 3.0]})
    said = "After one revolution the contour is as deep as 5 µm on 0.1 mm and 3 µm on 1 mm (conserving)."
    assert findings.depth_by_mesh(table) == said
    assert "as deep as 3 µm on 1 mm (conserving)." in findings.depth_by_mesh(table.tail(1))


@pytest.mark.parametrize(
    ("p_values", "said"),
    [
        ((0.3, 0.01), "depth (conserving, p 0.3) pass; depth (per triangle, p 0.01) fail"),
        ((0.3, 0.4), "depth (conserving, p 0.3) and depth (per triangle, p 0.4) pass"),
    ],
)
def test_which_sizes_are_normal(p_values, said):
    """Above the source's significance."""
    table = pd.DataFrame({"scheme": SCHEMES, "size": "depth", "p_value": p_values})
    assert findings.normality(table) == f"Of the tests of normality {said}."


def test_run_ins_that_have_ended():
    """By the source's rule on both sizes; none has where the last revolution fails."""
    rows = [(run, end, size) for run in "ab" for end in (1, 2) for size in ("depth", "opening width")]
    table = pd.DataFrame(rows, columns=["run", "revolution", "size"]).assign(p_value=[0.0, 0.5, 0.5, 0.5, *[0.0] * 4])
    said = "By the source's rule the run-in of 1 of 2 discs has ended in the revolutions simulated"
    assert findings.ended(table) == f"{said}, with revolution 2."
    assert "0 of 1 discs has ended in the revolutions simulated." in findings.ended(table[table["run"] == "b"])


def test_what_is_drawn_of_a_disc():
    """Pin, track and load; the deepest place of a section, or that there is none."""
    run = pd.DataFrame([{"pin_radius_mm": 3.0, "track_radius_mm": 22.0, "load_n": 20.0}])
    assert findings.setup(run) == "A pin with a radius of 3 mm goes round a track of 22 mm under 20 N."
    section = pd.DataFrame({"angle_deg": [5, 5], "across_mm": [0.0, 0.504], "depth_um": [3.0, 9.0]})
    said = "The groove is 9 µm deep at 5 degrees, 0.5 mm from the middle of the track."
    assert findings.groove(section) == said
    assert findings.groove(section.assign(depth_um=0.0)) == "The disc has no groove at 5 degrees."


def test_contours_and_tracks():
    """Means of the deepest places of contours of the last revolution; of a track where it is deepest."""
    table = pd.DataFrame(
        {"scheme": "conserving", "angle_deg": [0, 0, 90], "depth_um": [1.0, 4.0, 2.0], "revolution": 2}
    )
    said = "The contours are on average 3 µm (conserving) deep."
    assert findings.deepest_contours(pd.concat([table, table.assign(revolution=1, depth_um=99.0)])) == said
    assert findings.contours_by_case(table.rename(columns={"scheme": "case"})) == said
    track = pd.DataFrame({"radius_mm": [22.0, 22.1], "0": [1.0, 2.0], "1": [6.0, 0.0], "scheme": "per_triangle"})
    assert findings.deepest_places(track) == (
        "Round the disc the track is on average as deep as 4 µm (per triangle; deepest 6 µm, at 1 degrees)."
    )


def test_every_finding_reads_the_table_of_its_figure(pins, figures):
    """Each ends as a sentence."""
    every = products_of(find_case("pin_on_disc")).items()
    products = {name: each for name, each in every if each.is_figure and name not in LAW_FIGURES}  # one law is worn by
    told = {
        name: product.finding(pd.read_csv(pins[0] / "figures" / f"{name}.csv", dtype=NAMES))
        for name, product in products.items()
        if product.finding
    }
    assert set(products) == set(told)
    assert all(said.endswith(".") and "nan" not in said for said in told.values())
