"""Gravel has friction that our calibration's page keeps, and the source's pair is there beside it."""

import re

import pandas as pd
import pytest

from bulkwear.workflows.cases.calibration.responses import parameter_name
from bulkwear.workflows.config.design import ConfigError, load_study
from tests import PUBLISHED
from tests.support.calibration_study import ROLLING, SLIDING
from tests.support.tiny import OF_ANY_MODEL
from tests.test_house import text_of

DECIMALS = 2  # of a coefficient of friction: packings do not tell a third
GRAVEL, OF_SOURCE = "river_gravel", OF_ANY_MODEL


def materials():
    """Particles that every study is given."""
    return load_study("demo").materials["particles"]


def told(page, pattern):
    """What the page of a calibration says in place of the pattern's group."""
    return re.search(pattern, re.sub(r"\s+", " ", page))[1]


def test_gravel_has_a_pair_that_the_calibration_keeps():
    """The pair is in the family of the page that the file names, and the coefficient that is told is the recommended
    one, rounded; rolling model, radius and particle scale are those of the page.
    """
    gravel = materials()[GRAVEL]
    found = gravel["calibrated"]
    page = text_of(found["intervals"])
    assert f"results/{found['study']} --fidelity" in page
    assert found["rolling_friction"] == told(page, r"rolling friction (\w+), coefficients for")
    assert found["rolling_radius"] == told(page, r"coefficients for the (\w+) radius")
    assert found["particle_scale"] == float(told(page, r"particles at scale ([\d.]+)"))
    sliding, rolling = (gravel["contact"][key] for key in ("sliding_friction", "rolling_friction"))
    pair = f"sliding friction {sliding:.{DECIMALS}f}, rolling friction {rolling:.{DECIMALS}f}"
    assert f"The pair of the materials file ({pair}) is in the family: " in re.sub(r"\s+", " ", page)
    row = told(page, rf"\| {re.escape(parameter_name(SLIDING))} \| ([-\d.e |]+) \|")
    assert sliding == round(float(row.split(" | ")[2]), DECIMALS)  # after the ends of the range that was searched


def test_the_pair_of_the_source_stands_beside_it():
    """It is the pair that calibrations are compared with, of the same gravel in all else, and was ours in no model."""
    gravel, other = materials()[GRAVEL], materials()[OF_SOURCE]
    pairs = pd.read_csv(PUBLISHED / "gravel_pairs.csv").set_index("row")
    compared = pairs.loc[load_study("calibration").settings["calibration"]["compared_pair"]]
    assert other["contact"] == gravel["contact"] | {
        "sliding_friction": compared[SLIDING],
        "rolling_friction": compared[ROLLING],
    }
    rest = [{k: v for k, v in each.items() if k not in ("contact", "calibrated")} for each in (gravel, other)]
    assert rest[0] == rest[1] and "calibrated" not in other


def test_another_rolling_model_needs_another_pair_unless_it_is_calibrated():
    """A study of another model is refused with the recommended pair and taken with the source's; so is a calibration
    that keeps the rolling friction of its material, and not one that looks for it.
    """
    creeping = {"solver": {"rolling_friction": "cdt"}}
    with pytest.raises(ConfigError, match=r"allowed is own_spin, in which .*, or another bed\.material\."):
        load_study("demo", overrides=creeping)
    demo = load_study("demo", overrides=creeping | {"bed": {"material": OF_SOURCE}})
    assert demo.runs[0].parameters["particle"]["contact"] == materials()[OF_SOURCE]["contact"]
    assert load_study("calibration", overrides=creeping).settings["solver"]["rolling_friction"] == "cdt"
    kept = [{"name": name, "low": 0.1, "high": 0.7} for name in (SLIDING, "particle.contact.restitution")]
    with pytest.raises(ConfigError, match=r"or another bulk\.material\."):
        load_study("calibration", overrides=creeping | {"calibration": {"parameters": kept}})
