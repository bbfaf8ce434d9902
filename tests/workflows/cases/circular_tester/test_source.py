"""Which samples of the circular wear tester are the source's, beside whose runs published numbers stand."""

import pytest

from bulkwear.workflows.cases.circular_tester.page import remarks
from bulkwear.workflows.cases.circular_tester.sensitivity_figures import varies_source
from bulkwear.workflows.cases.circular_tester.source import unlike_source
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report.products import figures_of, products_of, told_to
from tests.support.tiny_tester import ROWS

BOTH = ("plain", "convex")


def study_of(**changes):
    return load_study(
        "circular_tester", overrides={"fidelity": "quick", "particle_scale": 4, "rows": list(ROWS), **changes}
    )


@pytest.mark.parametrize("name", ["circular_tester", "tester_sensitivity"])
@pytest.mark.parametrize("fidelity", ["quick", "standard", "paper"])
def test_shipped_studies_are_the_sources(name, fidelity):
    """At every fidelity, and whatever is varied that the source does not tell."""
    study = load_study(name, overrides={"fidelity": fidelity})
    assert unlike_source(study) == {} and varies_source(study) == (name == "tester_sensitivity")


@pytest.mark.parametrize(
    ("changes", "surfaces", "words"),
    [
        ({}, (), None),
        ({"tester": {"depth_mm": 85}}, (), None),  # as in the laboratory
        ({"tester": {"bed_height_mm": 190, "consolidator_level_mm": 190, "shape": "ring"}}, (), None),
        ({"pattern": {"row_spacing_mm": 20, "row_spacing_between": "neighbouring_rows"}}, (), None),
        ({"tester": {"depth_mm": 60}}, BOTH, "found with tester.depth_mm 60, the source's is 90"),
        ({"tester": {"incline_deg": 10}}, BOTH, "found with tester.incline_deg 10, the source's is 2"),
        ({"sample": {"width_mm": 80}}, BOTH, "found with sample.width_mm 80, the source's is 100"),
        (
            {"pattern": {"major_radius_mm": 4}},
            ("convex",),
            "found of bumps with major radius 4 mm, the source's is 8 mm",
        ),
        (
            {"pattern": {"row_offset_fraction": 0}},
            ("convex",),
            "found of bumps with row offset 0, the source's is 0.5",
        ),
        (
            {"pattern": {"row_spacing_between": "neighbouring_rows"}},
            ("convex",),
            "found of bumps with row spacing 40 mm, the source's is 20 mm",
        ),
    ],
)
def test_pattern_and_machine_are_compared(changes, surfaces, words):
    """The difference is told, of the machine for both samples; it stands on every figure."""
    study = study_of(**changes)
    assert unlike_source(study) == dict.fromkeys(surfaces, words)
    assert (words in remarks(study)) == bool(surfaces)


def test_all_that_differs_is_told():
    """Of machine and pattern in one remark, in which what both samples have stands once."""
    study = study_of(tester={"depth_mm": 60, "incline_deg": 10}, pattern={"major_radius_mm": 4})
    machine = "found with tester.depth_mm 60, the source's is 90; with tester.incline_deg 10, the source's is 2"
    pattern = "of bumps with major radius 4 mm, the source's is 8 mm"
    assert unlike_source(study) == {"plain": machine, "convex": f"{machine}; {pattern}"}
    assert [said for said in remarks(study) if said.startswith("found")] == [f"{machine}; {pattern}"]


def test_what_a_varied_row_changes_does_not_count():
    """Without the source's pattern the settings reach none of its numbers, and there is no figure of them."""
    study = load_study("tester_sensitivity", overrides={"fidelity": "quick"})
    assert any(figure.name == "tester_sensitivity" for figure in figures_of(study))
    other = load_study("tester_sensitivity", overrides={"fidelity": "quick", "pattern": {"height_mm": 5}})
    assert unlike_source(other) and not any(figure.name == "tester_sensitivity" for figure in figures_of(other))


def test_all_that_published_numbers_stand_on_is_told_which_samples_are_not_the_sources():
    """Tables, volumes by revolution, columns, bumps, forces."""
    study = study_of(tester={"depth_mm": 60})
    told = {name: told_to(product, study) for name, product in products_of(study.case).items()}
    names = ("tester_runs", "tester_numbers", "tester_volume", "tester_columns", "tester_bumps", "tester_force_columns")
    assert {name for name in told if "foreign" in told[name]} == set(names)
    assert all(told[name]["foreign"] == unlike_source(study) for name in names)
