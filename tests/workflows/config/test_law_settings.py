"""Parameters of a wear law from the configuration to the wear: checked, converted, told. Shown with a made-up law."""

import sys

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.wear.kernels import KERNELS
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.config.readme import wear_laws
from bulkwear.workflows.engine.derived import law_volume
from bulkwear.workflows.engine.solver import LEDGER_EXECUTABLE, cycle_fault, missing_kernels
from bulkwear.workflows.report.page_parameters import figure_remarks, page_parameters
from bulkwear.workflows.report.text import law_words, setting_rows
from tests.support.law_cases import LONG_SLIP, long_slip_registered
from tests.support.tiny import tiny_study

STUDY = "studies/small.yaml"
BLOCK = "wear: {{law: long_slip, parameters: {}}}\n"


@pytest.fixture(autouse=True)
def registered():
    """A law `long_slip` with an exponent, which must be given, and a length of 2 mm unless another one is."""
    with long_slip_registered():
        yield


def law_in_study(config, parameters: str) -> None:
    """Write a block `wear` into line 5 of the study."""
    config.edit(STUDY, "fidelities:", BLOCK.format(parameters) + "fidelities:")


@pytest.mark.parametrize(
    ("parameters", "fault"),
    [
        (
            "{exponnt: 2}",
            "wear.parameters.exponnt (2) is no known parameter of the law long_slip, the nearest is"
            " wear.parameters.exponent",
        ),
        (
            "{exponent: 2, length_um: 3}",
            "unit um is not allowed for wear.parameters.length, write wear.parameters.length_mm (found length_um: 3)",
        ),
        (
            "{length_mm: 3}",
            "wear.parameters.exponent is missing for the law long_slip, allowed is a number from 0.5 to 3",
        ),
        ("{exponent: 4}", "wear.parameters.exponent is 4, allowed is a number from 0.5 to 3"),
        ("{exponent: 2, length_mm: 0}", "wear.parameters.length_mm is 0, allowed is a number from 0.1 to 50 mm"),
        ("{exponent: two}", "wear.parameters.exponent is 'two', allowed is a number from 0.5 to 3"),
        ("{exponent: 2, length_mm: 3 mm}", "wear.parameters.length_mm is '3 mm', write the number alone: length_mm: 3"),
        ("2", "wear.parameters is 2, allowed is a block with the parameters of the law"),
    ],
)
def test_a_wrong_parameter_is_named_with_its_place_and_what_is_allowed(config, parameters, fault):
    """Unknown, in another unit, missing, out of range, no number: one sentence each."""
    law_in_study(config, parameters)
    with pytest.raises(ConfigError) as caught:
        load_study("small", config.project)
    assert str(caught.value) == f"config/studies/small.yaml, line 6: {fault}."


def test_the_neutral_law_takes_no_parameter(config):
    """A parameter beside a law without any is refused with that law's name."""
    with pytest.raises(ConfigError) as caught:
        load_study("small", config.project, {"wear": {"parameters": {"exponent": 2}}})
    assert str(caught.value) == (
        "command line: wear.parameters.exponent (2) is no known parameter of the law archard, which has none."
    )


def test_parameters_reach_the_runs_in_si(config):
    """What is not given has its default; whole numbers and lengths in mm arrive as SI floats; archard gets no key."""
    assert "parameters" not in load_study("small", config.project).settings["wear"]
    law_in_study(config, "{exponent: 2}")
    study = load_study("small", config.project)
    assert study.settings["wear"]["parameters"] == {"exponent": 2.0, "length_mm": 2.0}
    for run in study.runs:
        assert run.parameters["wear"]["parameters"] == {"exponent": 2.0, "length_m": 0.002}
        assert isinstance(run.parameters["wear"]["parameters"]["exponent"], float)


def test_stronger_layers_override_single_parameters(config):
    """A value of the command line wins over the study's, the rest of the block stays."""
    law_in_study(config, "{exponent: 2, length_mm: 3}")
    study = load_study("small", config.project, {"wear": {"parameters": {"exponent": 1.5}}})
    assert study.settings["wear"]["parameters"] == {"exponent": 1.5, "length_mm": 3.0}


def test_another_law_leaves_the_parameters_of_the_first_behind(config):
    """Whoever chooses archard over a study's law does not have to take its parameters away."""
    law_in_study(config, "{exponent: 2}")
    study = load_study("small", config.project, {"wear": {"law": "archard"}})
    assert study.settings["wear"] == {**study.settings["wear"], "law": "archard"}
    assert "parameters" not in study.settings["wear"]


def test_the_wear_step_takes_coefficient_and_parameters():
    """V = accelerated coefficient times the kernel's sum, whose column ends in the kernel's unit."""
    wear = {"law": "long_slip", "parameters": {"exponent": 2.0}, "acceleration": 10.0}
    parameters = tiny_study(wear=wear).run("R9_plain").parameters
    coefficient = parameters["wear"]["wear_coefficient_per_pa"]
    volume = law_volume(parameters, pd.DataFrame({"long_slip_m": [0.0, 3.0]}))
    np.testing.assert_allclose(volume, [0.0, 3.0 * 10.0 * coefficient], rtol=1e-15)


def test_figures_and_pages_tell_the_parameters():
    """Words with values in the study's units, a remark on every figure, and a row each in the table of settings."""
    study = tiny_study(wear={"law": "long_slip", "parameters": {"exponent": 1.5}})
    assert law_words(study.settings["wear"], "6.3e-13").startswith(
        "Long slip: coefficient 6.3e-13 1/Pa, exponent 1.5, length 2 mm."
    )
    own = "another quantity than Archard's"  # a law's that is not one of work along the surface
    assert own in law_words(study.settings["wear"], "6.3e-13")
    assert own not in law_words({"law": "tangential_work"}, "1e-12")
    remark = "worn by the law long_slip (exponent 1.5, length 2 mm)"
    assert remark in figure_remarks(study)
    page = page_parameters(study)
    rows = {row["name"]: row for row in setting_rows(page["settings"], page["paper_settings"])["wear"]}
    assert (rows["exponent"]["value"], rows["length"]["value"], rows["length"]["unit"]) == (1.5, 2.0, "mm")


def test_the_page_of_keys_lists_laws_and_parameters():
    """Each law with its words and source, each parameter with unit, range, default and meaning."""
    text = wear_laws()
    assert "* `long_slip`: coefficient `wear.wear_coefficient_per_pa` 1/Pa, exponent `wear.parameters.exponent`" in text
    assert "| `wear.parameters.exponent` | long_slip | - | a number from 0.5 to 3 | required | of the length |" in text
    assert "| `wear.parameters.length_mm` | long_slip | mm | a number from 0.1 to 50 | 2 | a length |" in text
    assert LONG_SLIP.source in text


@pytest.mark.solver
def test_a_program_without_the_kernel_is_refused_before_anything_runs():
    """The program that is built has every kernel of the repository and not the test's; sampled contacts need none."""
    assert missing_kernels(LEDGER_EXECUTABLE, [name for name in KERNELS if name != "long_slip"]) is None
    wear = {"law": "long_slip", "parameters": {"exponent": 2.0}}
    study = tiny_study(wear=wear)
    parameters = study.run("R9_plain").parameters
    assert cycle_fault(LEDGER_EXECUTABLE, study.case, parameters).startswith(
        f"{LEDGER_EXECUTABLE}: it has no contact kernel long_slip as postproc/wear/kernels.py has it, found: "
        "finnie_work finnie_work_J"
    )
    assert cycle_fault(LEDGER_EXECUTABLE, study.case, {**parameters, "ledger": "dumps"}) is None


def test_a_program_that_cannot_tell_its_kernels_has_none():
    """One built before the question existed ends with a fault, and is to be built again."""
    assert "found: none; `make -C solver` builds" in missing_kernels(sys.executable, ["finnie_work"])
    assert missing_kernels("no_such_program", []) is None
