"""What the tester's page says of its runs: tables of its own rows alone, sentences of the runs' parameters."""

import pytest

from bulkwear.workflows.cases.circular_tester import key_numbers, page
from bulkwear.workflows.cases.circular_tester.source import material_coefficient
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report.page_parameters import page_parameters

QUICK = {"fidelity": "quick", "packings": 1}


def words(study):
    return dict(page.simplifications(page_parameters(study)))


def test_tables_of_an_earlier_choice_of_rows_are_not_shown(tmp_path, monkeypatch):
    """What rows of other series have left stays in the folder, and has no place on the page."""
    for name in ("beside_the_experiment", "findings", "rates", "ratios", "every_run", "steadiness", "by_column"):
        monkeypatch.setattr(key_numbers, name, lambda *_: [])
    for name in ("published_numbers", "beds"):
        monkeypatch.setattr(page, name, lambda *_: [])
    for name in ("figures/tester_worn_out.csv", "figures/tester_mesh.csv", page.SENSITIVITY):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("of,an,earlier\nchoice,of,rows\n")
    study = load_study("circular_tester", overrides=QUICK | {"rows": ["plain", "convex"]})
    sections = {section.title: section.blocks for section in page.sections(page_parameters(study), tmp_path)}
    assert "What the source does not tell" not in sections
    assert len(sections["Until the pattern is gone"]) == len(sections["Elements"]) == 1  # pictures


def test_what_runs_differ_in_is_listed():
    """Rolling models, heights of the bed, thicknesses, and the contact of each material that is not that of steel."""
    said = words(load_study("tester_sensitivity", overrides=QUICK))
    assert "rolling friction (cdt or own_spin or rvd) alone" in said["Coarse-grained particles"]
    assert "(150 or 190 mm)" in said["Not published"] and "(2 or 10 mm)" in said["Not published"]
    assert said["Not published"].endswith(
        "The sample's contact with particles is that of steel, as in the model that chapter 6 refers to, or that of"
        " polyethylene_smooth (sliding friction 0.2, rolling friction 0.3)."
    )


def test_what_runs_have_in_common_is_said_once():
    said = words(load_study("circular_tester", overrides=QUICK))
    assert "rolling friction (own_spin) alone" in said["Coarse-grained particles"]
    assert "over the floor (150 mm), thickness of sample and holder (10 mm)" in said["Not published"]
    assert said["Not published"].endswith("is that of steel, as in the model that chapter 6 refers to.")


@pytest.mark.parametrize(("times", "far"), [(1.0, False), (100.0, True)])
def test_only_a_coefficient_far_above_the_materials_is_called_so(times, far):
    coefficient = times * material_coefficient()
    study = load_study("circular_tester", overrides=QUICK | {"wear": {"wear_coefficient_per_pa": coefficient}})
    (said,) = [each for each in page.remarks(study) if each.startswith("wear coefficient")]
    assert f"{coefficient:g} 1/Pa" in said and ("far above" in said) == far
