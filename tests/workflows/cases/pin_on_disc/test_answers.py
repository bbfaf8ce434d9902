"""What a study of pins on discs answers: the volume beside the published one, the coefficient, fine meshes, run-ins."""

import pandas as pd
import pytest

from bulkwear.postproc.statistics.change_point import ENDED, UNSAID
from bulkwear.workflows.cases.pin_on_disc import answers
from bulkwear.workflows.cases.pin_on_disc.coefficient import PUBLISHED_FITS
from bulkwear.workflows.cases.pin_on_disc.run_in import VOLUME_SERIES

STABILITY = {"scheme": ["conserving"] * 2, "largest_element_mm": 0.15}


def test_volume_over_the_law():
    """By scheme, of discs that are worn; a study whose discs keep their shape says nothing of them."""
    runs = {"scheme": ["conserving", "per_triangle", "per_triangle", "conserving"], "alpha_F_L_volume_m3": 2e-10}
    summary = pd.DataFrame(runs | {"removed_volume_m3": [2e-10, 12e-10, 13e-10, 0.0]})
    assert answers.over_law(summary) == [
        "Discs lose 1 (conserving) and 6 to 6.5 (per triangle) times what Archard's law asks for, alpha F L."
    ]
    assert answers.over_law(summary.tail(1)) == []


def test_coefficients_of_the_most_revolutions():
    """With the laboratory's error, and whether they were simulated; the published fits are no answer of ours."""
    ends = {"least_wear_coefficient_per_pa": 5e-11, "largest_wear_coefficient_per_pa": 7e-11, "interpolated": True}
    table = pd.DataFrame({"scheme": ["conserving", "conserving", PUBLISHED_FITS], "revolutions": [11, 12, 12]})
    table = table.assign(scaling_factor=108.5, wear_coefficient_per_pa=6e-11, **ends)
    (said,) = answers.coefficients(table)
    assert said == (
        "Conserving: 12 revolutions stand for the laboratory's test, each for 108 of it, with 6e-11 1/Pa (5e-11 to"
        " 7e-11 by the laboratory's error)."
    )
    assert "; beyond the coefficients" in answers.coefficients(table.assign(interpolated=False))[0]


@pytest.mark.parametrize(
    ("meshes", "off", "said"),
    [
        (2, 3.9, "elements of 0.14 mm are fine enough, sizes of the groove differ by up to 3.9 % among the 2 meshes"),
        (
            2,
            5.4,
            "no mesh is shown to be fine enough, with elements of 0.1 to 0.14 mm sizes of the groove differ by 5.4",
        ),
        (1, float("nan"), "which mesh is fine enough cannot be said, as 1 mesh has elements of up to a 5th"),
        (0, float("nan"), "which mesh is fine enough cannot be said, as no mesh has elements of up to a 5th"),
    ],
)
def test_the_coarsest_of_the_meshes_that_agree_is_fine_enough(meshes, off, said):
    """Those within a fifth of the groove's width are compared, in both sizes."""
    stability = pd.DataFrame(STABILITY | {"meshes": meshes, "difference_percent": off, "stable": off <= 5.0})
    series = pd.DataFrame({"scheme": "conserving", "element_size_mm": [0.1, 0.14, 0.2]})
    (found,) = answers.fine_meshes(stability, series)
    assert found.startswith(f"Conserving: {said}")


def test_run_ins_of_the_volume():
    """With the interval of the run; where it cannot be said, that is said."""
    row = {"run": "c50", "end_revolution": 3.0, "least_end_revolution": 2.0, "last_end_revolution": 5.0}
    points = pd.DataFrame([row | {"series": VOLUME_SERIES, "answer": ENDED}, row | {"series": "x", "answer": ENDED}])
    assert answers.run_ins(points) == [
        "The volume that a revolution removes is level from revolution 3 on in c50 (95 % interval 2 to 5, of this run)."
    ]
    (said,) = answers.run_ins(points.head(1).assign(answer=UNSAID))
    assert said == "The run-in of the volume that a revolution removes, c50: cannot be said."


def test_answers_are_of_the_figures_that_a_study_has(pins, figures, tmp_path):
    """A whole study tells of all; without figures the volume is told alone."""
    for file in (pins[0] / "figures").glob("*.csv"):
        (tmp_path / "figures").mkdir(exist_ok=True)
        (tmp_path / "figures" / file.name).symlink_to(file)
    summary = {"scheme": ["conserving"], "removed_volume_m3": 1e-10, "alpha_F_L_volume_m3": 1e-10}
    pd.DataFrame(summary).to_csv(tmp_path / "summary.csv", index=False)
    said = answers.all_answers(tmp_path, figures)
    assert sum("times the laboratory's and" in each for each in said) == 3
    assert any("which mesh is fine enough cannot be said" in each for each in said)
    assert answers.all_answers(tmp_path, {}) == said[:1]
