"""What a calibration answers: what its pair reproduces, which response decides, what is rejected."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.inference.problem import Measured
from bulkwear.workflows.cases.calibration import answers
from bulkwear.workflows.cases.calibration import figure_findings as findings
from bulkwear.workflows.cases.calibration.boxes import with_values
from bulkwear.workflows.cases.calibration.responses import RECOMMENDED
from bulkwear.workflows.report.sections import CARE, SOUND, WEAK
from tests.support.calibration_study import ROLLING, SLIDING

NAN = float("nan")
PAIR = "(sliding friction 0.30, rolling friction 0.40)"


def statements(**changes):
    """Two responses of a recommended pair, one off by 2.5 deviations, and a compared pair."""
    table = pd.DataFrame(
        {
            "pair": ["recommended", "recommended", "calibrated"],
            SLIDING: 0.3,
            ROLLING: 0.4,
            "response": ["shear_angle_deg", "discharge_time_s", "shear_angle_deg"],
            "measured": [36.0, 5.4, 36.0],
            "seeds": 2,
            "inside": ["within its uncertainty", "outside", "outside"],
            "deviations": [1.2, -2.5, -9.0],
            "denser_share": [0.4, 0.4, 0.999],
        }
    )
    return table.assign(**changes)


def test_what_the_pair_reproduces():
    """What is off is named with its deviations, what was not simulated, too; one packing tells no scatter."""
    said, kept = answers.on_pairs(statements())
    assert said == (
        f"The recommended pair {PAIR} reproduces 1 of 2 responses that were measured and simulated, within their"
        " uncertainty (means of 2 packings or more); off are discharge time (-2.5 standard deviations)."
    )
    assert kept == f"The calibrated pair {PAIR} is rejected: 99.9 % of the posterior fits better (allowed: 95 %)."
    part = findings.first_reproduced(statements(seeds=[1, 0, 0]))
    assert "1 of 2" in part and "whose scatter is unknown" in part and part.endswith("not simulated: discharge time.")
    assert "is a prediction" in findings.first_reproduced(statements(seeds=0))
    assert answers.on_pairs(statements(measured=NAN, denser_share=0.5))[0].startswith("The calibrated pair")
    assert "is in the family" in answers.on_pairs(statements(denser_share=0.5))[1]


def test_the_response_that_leaves_least_decides():
    """A response that rises along a parameter leaves a strip of it, one that is the same everywhere leaves all."""
    line = (np.arange(100) + 0.5) / 100.0
    predicted = {"shear_angle_deg": (line, np.zeros(100)), "discharge_time_s": (np.ones(100), np.zeros(100))}
    aims = {"shear_angle_deg": Measured(0.5, 0.05, 0.0), "discharge_time_s": Measured(1.0, 0.1, 0.0)}
    left = answers.shares_left(SimpleNamespace(measured=aims), SimpleNamespace(predicted=predicted))
    assert list(left) == ["", "shear_angle_deg", "discharge_time_s"]
    assert left[""] == left["shear_angle_deg"] == pytest.approx(0.2, abs=0.02) and left["discharge_time_s"] > 0.9
    (said,) = answers.deciding({"": 0.1, "shear_angle_deg": 0.2, "discharge_time_s": 0.9})
    assert said == (
        "The shear angle of the shear box decides most: alone it leaves 20 % of the range of the parameters, discharge"
        " time 90 %; all together leave 10 %."
    )
    assert "the only response" in answers.deciding({"": 0.2, "shear_angle_deg": 0.2})[0]


@pytest.mark.parametrize(("high", "hardly"), [(0.3, False), (0.68, True)])
def test_an_interval_as_wide_as_the_range_hardly_tells(high, hardly):
    """Value and interval; where most of the range is left, that is said."""
    row = {
        "parameter": ROLLING,
        "searched_from": 0.1,
        "searched_to": 0.7,
        "recommended": 0.2,
        "low": 0.12,
        "high": high,
    }
    said = answers.interval_words(pd.Series(row))
    assert said.startswith(f"rolling friction is 0.20, 95 % of what fits between 0.12 and {high:.2f}")
    assert ("98 % of the range is left: hardly told alone" in said) == hardly


def test_published_pairs_are_rejected_or_kept(done):
    """Those in the range are looked at; pairs of other parameters are not."""
    (said,) = answers.rejected(done)
    assert said.startswith("Of 7 pairs that others simulated ") and "rejected" in said
    other = SimpleNamespace(problem=done.problem, known=done.known, published=done.published[["row"]])
    assert answers.rejected(other) == []
    far = SimpleNamespace(problem=done.problem, known=done.known, published=done.published.assign(**{SLIDING: 9.0}))
    assert answers.rejected(far) == []


def test_what_materials_have_already_is_in_the_family_or_not(done):
    """A pair that is recommended is kept; one at a corner of the range is rejected, and one beyond was not searched."""

    def said(**values):
        changed = with_values(done.parameters, done.pairs[RECOMMENDED] | values)
        return answers.of_material(replace(done, parameters=changed))

    assert said().startswith("The pair of the materials file (sliding friction ") and "is in the family: " in said()
    assert "is rejected: " in said(**{SLIDING: 0.7, ROLLING: 0.7})
    assert said(**{SLIDING: 0.9}).endswith("lies outside of the range that was searched.")


def test_lights_of_a_calibration():
    """Weak where a response is missed, with care where the limit stopped a test, by the packings of the pair."""
    looks = pd.DataFrame({"test": ["shear_box"] * 2, "simulations": [5, 7], "surrogate_share": [0.8, 0.4]})
    found = answers.lights(statements(), looks, 0.5)
    assert [each.state for each in found] == [WEAK, SOUND, CARE] and "1 of 2" in found[0].said
    met = statements(inside="inside", seeds=3)
    assert [each.state for each in answers.lights(met, looks, 0.3)] == [SOUND, CARE, SOUND]
    alone = answers.lights(statements(inside="inside", seeds=[1, 0, 0]), looks, 0.5)
    assert [each.state for each in alone] == [CARE, SOUND, WEAK] and "unknown" in alone[2].said


def test_findings_of_the_figures():
    """Slopes, ranges, the family, boxes, and what to measure next."""
    slopes = pd.DataFrame({"response": ["repose_angle_deg"] * 2, "angle_deg": [33.0, 34.0], "uncertainty_deg": 0.5})
    assert findings.heap_angles(slopes) == "Slopes of these heaps: angle of repose 33.0 ± 0.5° and 34.0 ± 0.5°."
    grid = pd.DataFrame({SLIDING: [0.1, 0.7], "discharge_time_s": [5.0, 6.25], "discharge_time_s_doubt": 0.1})
    assert findings.ranges(grid).endswith("least to most: discharge time 5 to 6.25 s.")
    table = pd.DataFrame({"first": SLIDING, "second": ROLLING, "first_value": [0.1, 0.2, 0.3], "second_value": 0.5})
    said = "Pairs that hold 95 % of what fits have sliding friction 0.20 to 0.30 and rolling friction 0.50 to 0.50"
    assert findings.family(table.assign(denser_share=[0.99, 0.0, 0.9])).startswith(said)
    sizes = pd.DataFrame({"length_mm": [100, 200], "width_mm": 50, "mean": [33.0, 34.0], "deviation": [NAN, 0.5]})
    said = "In boxes 100 to 200 mm long and 50 mm wide the shear angle is 33 to 34°"
    assert findings.box_effect(sizes) == f"{said}; packings scatter by 0.5°."
    assert findings.box_effect(sizes.head(1)).endswith("is 33°.")
    looks = pd.DataFrame({"test": ["shear_box"] * 2, "simulations": [5, 7], "surrogate_share": [0.8, 0.4]})
    known = pd.DataFrame({"response": ["shear_angle_deg", "discharge_time_s"], "information_bits": [0.2, 0.6]})
    said = "Of the variance the surrogate's share is 40 % after 7 simulations (shear box)"
    assert findings.progress(pd.concat([looks, known])) == (
        f"{said}; measuring the discharge time once more tells most, 0.6 bit."
    )
    assert findings.progress(pd.concat([looks, known.head(0)])) == f"{said}."
