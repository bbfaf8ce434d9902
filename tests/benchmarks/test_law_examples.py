"""Worked examples of wear laws: what they say by hand is what the code makes of the lines of the study beside them."""

import numpy as np
import pytest
import yaml

from benchmarks.law_examples import Numbers, examples, page
from bulkwear.postproc.wear.laws import LAWS, worn_volume
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.project import Project
from tests import REPOSITORY

EXAMPLES = {example.title: example for example in examples()}
ROUNDED = 1e-5  # relative: 0.33333 and six digits of the numbers in a block of YAML


def lines_of(example):
    """What YAML reads of the lines that the page shows."""
    return yaml.safe_load(yaml.dump(example.settings, Dumper=Numbers))


def law_in(settings, project=None):
    """The law of the demo's first run with its parameters, SI; its hours are not accelerated."""
    wear = {"acceleration": 1.0} | settings.get("wear", {})
    study = load_study("demo", project, overrides={**settings, "wear": wear})
    return study.case.laws(study.runs[0].parameters)[0]


def test_every_law_has_an_example():
    """And the page in docs is that of the program."""
    assert {example.law for example in EXAMPLES.values()} == set(LAWS)
    assert (REPOSITORY / "docs" / "wear_laws.md").read_text(encoding="utf-8") == page()


@pytest.mark.parametrize("title", [title for title, example in EXAMPLES.items() if "wear" in example.settings])
def test_the_lines_of_a_study_give_the_volume_by_hand(title):
    """From settings to the law's parameters, and from the ledger's sums to the volume."""
    example = EXAMPLES[title]
    law, parameters = law_in(lines_of(example))
    assert law == example.law
    assert parameters == pytest.approx({"wear_coefficient_per_pa": example.coefficient, **example.parameters}, abs=0.0)
    columns = {name: np.array([value]) for name, value in example.columns.items()}
    assert worn_volume(law, columns, parameters)[0] == pytest.approx(example.volume, rel=ROUNDED)


def test_the_lines_of_materials_give_the_volume_by_hand(tmp_path):
    """A project whose steel has k and hardness; twice as hard it wears half."""
    example = EXAMPLES["Archard, scaled by hardness"]
    package = yaml.safe_load((REPOSITORY / "config" / "materials.yaml").read_text(encoding="utf-8"))
    volumes = []
    for factor in (1.0, 2.0):
        told = lines_of(example)["walls"]["steel"]
        steel = package["walls"]["steel"] | told | {"hardness_pa": factor * told["hardness_pa"]}
        (tmp_path / "config").mkdir(exist_ok=True)
        (tmp_path / "config" / "materials.yaml").write_text(yaml.safe_dump({"walls": {"steel": steel}}))
        law, parameters = law_in({"particle_scale": 1, "bed": {"material": "iron_ore_10mm"}}, Project(tmp_path))
        columns = {name: np.array([value]) for name, value in example.columns.items()}
        volumes.append(worn_volume(law, columns, parameters)[0])
    assert volumes == pytest.approx([example.volume, 0.5 * example.volume])
