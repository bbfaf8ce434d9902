"""Laws beside that of a study: which are allowed, what of them reaches runs, decks, parts, what is simulated again."""

import re

import pytest
import yaml

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.engine.inputs import run_digest, simulated_from
from bulkwear.workflows.report.laws import what_wears
from tests import REPOSITORY
from tests.support.law_cases import OKA
from tests.support.own_machine_project import machine_study
from tests.support.tiny import tiny_study

THRESHOLD = {"threshold_velocity_m_per_s": 0.5}
COMBINED = {"rolling_ratio": 0.1, **THRESHOLD}
BESIDE = {"finnie": {}, "impact_threshold": THRESHOLD, "combined": COMBINED}


def of_run(beside):
    """Study and parameters of a run with these laws beside Archard's."""
    study = tiny_study(wear={"beside": beside} if beside else {})
    return study, study.run("R9_plain").parameters


def digest(beside, ledger="solver"):
    study = tiny_study(wear={"beside": beside} if beside else {}, ledger=ledger, solver={"rolling_friction": "cdt"})
    return run_digest(study.case, study.run("R9_plain").parameters, study.beds[study.bed_of("R9_plain")])


@pytest.mark.parametrize(
    ("beside", "fault"),
    [
        ("{finie: {}}", "wear.beside.finie (a block of keys) is no known key, the nearest is wear.beside.finnie"),
        (
            "{impact_threshold: {threshold_velocity: 2}}",
            "wear.beside.impact_threshold.threshold_velocity has no unit, write"
            " wear.beside.impact_threshold.threshold_velocity_m_per_s (found threshold_velocity: 2)",
        ),
        (
            "{combined: {rolling_ratio: -1}}",
            "wear.beside.combined.rolling_ratio is -1, allowed is a number from 0 to 1000000",
        ),
        (
            "{impact_threshold: {}}",
            "wear.beside.impact_threshold.threshold_velocity_m_per_s is missing, allowed is a number from 0 to 100 m/s",
        ),
        ("{archard: {}}", "wear.beside has archard, which is wear.law, allowed are other laws"),
        ("2", "wear.beside is 2, allowed is a block of wear laws by name, each a block of its parameters, {} of one"),
    ],
)
def test_a_wrong_law_beside_is_named_with_its_place(config, beside, fault):
    """Unknown, without a unit, beyond its range, without a parameter, the study's own, no block: one sentence each."""
    config.edit("studies/small.yaml", "fidelities:", f"wear: {{beside: {beside}}}\nfidelities:")
    with pytest.raises(ConfigError) as caught:
        load_study("small", config.project)
    assert str(caught.value).startswith(f"config/studies/small.yaml, line 6: {fault}")


def test_a_kernel_is_summed_once_for_each_set_of_parameters():
    """Two thresholds are two sums, of which the deck asks in order; the study's own law has the first."""
    both = {"law": "impact_threshold", "parameters": THRESHOLD, "beside": {"combined": {}, "finnie": {}}}
    study = tiny_study(wear=both)
    run = study.run("R9_plain").parameters
    zero = {"threshold_velocity_m_per_s": 0.0}
    sums = {"impact_above_threshold": THRESHOLD, "impact_above_threshold.2": zero, "finnie_work": {}}
    assert study.case.kernels(run) == sums and what_wears(study)["R9_plain"][0][-1] == sums
    deck = simulated_from(study.case, run, study.beds[study.bed_of("R9_plain")])["decks"][1]
    asked = "impact_above_threshold threshold_velocity_m_per_s"
    assert f" kernels {asked} 0.5 {asked} 0.0 finnie_work" in deck


def test_the_block_in_docs_is_taken():
    """Three laws beside Archard's, with one threshold."""
    page = (REPOSITORY / "docs" / "wear.md").read_text(encoding="utf-8")
    blocks = [yaml.safe_load(text) for text in re.findall("```yaml\n(.*?)```", page, re.DOTALL)]
    (block,) = [each for each in blocks if "beside" in each.get("wear", {})]
    assert tiny_study(**block).settings["wear"]["beside"].keys() == block["wear"]["beside"].keys()


def test_they_reach_kernels_and_figures_in_si_with_their_defaults():
    """Kernels of all laws, each once; figures get every law that ledgers serve with the run's coefficient."""
    study, run = of_run(BESIDE)
    assert study.settings["wear"]["beside"]["combined"] == {**COMBINED, "impact_ratio": 0.0}
    assert study.case.kernels(run) == {"finnie_work": {}, "impact_above_threshold": THRESHOLD}
    ((law, given, *_, others, _),) = what_wears(study)["R9_plain"]
    assert (law, set(others)) == ("archard", {"archard", *BESIDE})
    assert others["impact_threshold"] == {**given, **THRESHOLD}
    assert given["wear_coefficient_per_pa"] == run["wear"]["accelerated_wear_coefficient_per_pa"]


def test_stronger_layers_add_laws_and_change_parameters(config):
    """A command line's threshold counts, and the study's other law stays."""
    config.edit("studies/small.yaml", "fidelities:", "wear: {beside: {finnie: {}}}\nfidelities:")
    study = load_study("small", config.project, {"wear": {"beside": {"impact_threshold": THRESHOLD}}})
    assert study.settings["wear"]["beside"] == {"finnie": {}, "impact_threshold": THRESHOLD}


@pytest.mark.parametrize("ledger", ["solver", "dumps"])
def test_what_needs_no_further_sum_is_not_simulated_again(ledger):
    """Shear work is of a sum that every ledger has, and ratios are of sums that are there; kernels, and their
    parameters, are not.
    """
    plain, above = digest({}, ledger), digest({"impact_threshold": THRESHOLD}, ledger)
    assert digest({"tangential_work": {}}, ledger) == plain
    assert digest({"combined": {"impact_ratio": 3.0, **THRESHOLD}}, ledger) == above
    found = [plain, above, digest({"finnie": {}}, ledger)]
    found.append(digest({"impact_threshold": {"threshold_velocity_m_per_s": 0.6}}, ledger))
    assert len(set(found)) == 4


def test_decks_ask_for_the_kernels_of_all_laws():
    """Own law first; each kernel with its parameters."""
    study, run = of_run(BESIDE)
    deck = simulated_from(study.case, run, study.beds[study.bed_of("R9_plain")])["decks"][1]
    assert " kernels finnie_work impact_above_threshold threshold_velocity_m_per_s 0.5" in deck


def test_parts_of_a_machine_wear_by_laws_beside(tmp_path):
    """Each law with its own parameters, which one block wear.parameters could not hold."""
    parts = {"liner": {"law": "oka"}, "plate": {"law": "impact_threshold"}}
    with machine_study(tmp_path, wear={"beside": {"oka": OKA, "impact_threshold": THRESHOLD}}, parts=parts) as study:
        run = study.runs[0].parameters
        laws = dict(study.case.laws(run))
        deck = simulated_from(study.case, run, None)["decks"][1]
        assert set(what_wears(study)[study.runs[0].name][0][-2]) == {"archard", "oka", "impact_threshold"}
    assert {**OKA, "wear_coefficient_per_pa": laws["oka"]["wear_coefficient_per_pa"]} == laws["oka"]
    assert laws["impact_threshold"]["threshold_velocity_m_per_s"] == 0.5
    assert "kernels oka_energy" in deck and "impact_above_threshold threshold_velocity_m_per_s 0.5" in deck


def test_parts_wear_by_one_law_with_parameters_of_their_own(tmp_path):
    """What a part does not give is that of the law beside; two hardnesses are two sums."""
    softer = 5e8
    parts = {"liner": {"law": "oka"}, "plate": {"law": "oka", "parameters": {"hardness_pa": softer}}}
    with machine_study(tmp_path, wear={"beside": {"oka": OKA}}, parts=parts) as study:
        run = study.runs[0].parameters
        found = study.case.kernels(run)
        hardnesses = [given["hardness_pa"] for law, given in study.case.laws(run) if law == "oka"]
        assert hardnesses == [OKA["hardness_pa"], softer]
        assert found == {"oka_energy": OKA, "oka_energy.2": {**OKA, "hardness_pa": softer}}


@pytest.mark.parametrize(
    ("part", "fault"),
    [
        (
            {"law": "oka", "parameters": {"hardness": 3}},
            "parts.plate.parameters.hardness is 3 for row A, allowed is one of ",
        ),
        (
            {"law": "finnie", "parameters": {"hardness_pa": 3}},
            "hardness_pa is 3 for row A, allowed is none: what the law finnie",
        ),
        (
            {"law": "oka", "parameters": {"hardness_pa": 3}},
            "hardness_pa is 3 for row A, allowed is a number from 1000000 to",
        ),
        (
            {"law": "oka", "parameters": {"hardness_pa": 1e9}},
            "parts.plate.law is 'oka' for row A, allowed is wear.law (archard)",
        ),
        ({"role": "rigid", "parameters": {"hardness_pa": 1e9}}, "allowed is none for a part with role: rigid"),
    ],
)
def test_wrong_parameters_of_a_part_are_named(tmp_path, part, fault):
    """Not the law's, beyond its range, too few of them, of a part that keeps its shape."""
    with pytest.raises(ConfigError) as caught, machine_study(tmp_path, parts={"plate": part}):
        pass
    assert fault in str(caught.value)
