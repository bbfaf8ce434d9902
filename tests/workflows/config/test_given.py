"""Keys that a study has to give, for which there are no defaults: what is said where nobody gives them."""

from __future__ import annotations

import pytest

from bulkwear.workflows.config.layers import ConfigError, Layer
from bulkwear.workflows.config.validation import check_given
from tests.support.own_machine_project import machine_study

FILE = "config/studies/machine.yaml"


def message_of(folder, overrides=None, **changes) -> str:
    with pytest.raises(ConfigError) as caught, machine_study(folder, **changes):
        pass
    return str(caught.value)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"parts": None}, "parts is missing, allowed is a block of one key or more."),
        ({"bulk": None}, "bulk.material is missing, allowed is a particle in materials.yaml."),
        ({"parts": {"liner": {"unit": None}}}, "parts.liner.unit is missing, allowed is one of m, mm, cm, um, in, ft."),
        (
            {"inlet": {"normal": None}},
            "inlet.normal is missing, allowed is a list of three numbers that are not all 0.",
        ),
        (
            {"outlets": {"below": {"size_mm": None}}},
            "outlets.below.size_mm is missing, allowed is a list of two numbers",
        ),
        ({"periodic": {"axis": "y"}}, "periodic.low_mm is missing, allowed is a number from -100000 to 100000 mm."),
        ({"domain": {"low_mm": [0, 0, 0]}}, "domain.high_mm is missing, allowed is a list of three numbers from"),
        ({"filling": {"axis": "y"}}, "filling.fraction is missing, allowed is a number from 1e-09 to 0.55."),
        ({"bulk": {"passing": {"sieve_mm": [1, 2]}}}, "bulk.passing.fraction is missing, allowed is a list of numbers"),
        ({"parts": {"paddle": {"motion": {"kind": None}}}}, "parts.paddle.motion.kind is missing, allowed is one of"),
    ],
)
def test_a_key_that_nobody_gives_is_named_with_its_file(tmp_path, changes, said):
    """One sentence: the study's file, the key, what is allowed; at the top, in a block, in a block by name."""
    message = message_of(tmp_path, **changes)
    assert said in message and message.count(". ") == 0, message
    assert message.startswith(FILE) or "bulk.material" in said


def layer(source, values, lines=None, block=""):
    return Layer(source, values, lines or {}, block)


def test_a_missing_key_is_said_to_be_missing_where_its_block_stands():
    """In the strongest layer that has the block; at the top in the last file, not in a block or a command line."""
    schema = {
        "x-needed": ["a"],
        "properties": {"a": {"type": "string"}, "b": {"x-needed": ["c"], "properties": {"c": {}}}},
    }
    layers = (
        layer("case.yaml", {}, {("z",): 9}),
        layer("study.yaml", {"b": {}}, {("b",): 4}),
        layer("study.yaml", {"b": {}}, {("b",): 7}, "fidelity quick"),
        layer("command line", {"z": 1}),
    )
    with pytest.raises(ConfigError, match=r"^study.yaml: a is missing, allowed is text\.$"):
        check_given(layers, {"b": {}}, schema)
    with pytest.raises(ConfigError, match=r"^study.yaml, line 7, fidelity quick: b\.c is missing"):
        check_given(layers, {"a": "x", "b": {}}, schema)
    check_given(layers, {"a": "x", "b": {"c": 1}}, schema)


def test_what_happens_where_a_part_is_worn_through_needs_no_thickness_of_wear(tmp_path):
    """Parts have their thickness, given or measured: how a worn-through run goes on may be chosen."""
    with machine_study(tmp_path, wear={"worn_through": "go_on"}) as study:
        assert study.runs[0].parameters["wear"]["worn_through"] == "go_on"
