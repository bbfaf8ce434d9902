"""Studies that extend another one: what holds, and where a fault of either file is told."""

import pytest

from bulkwear.workflows.config.design import ConfigError, load_study

WIDER = """\
title: A wider sample
question: Is it wider?
extends: small
"""


def message(config, name="wider", **overrides) -> str:
    with pytest.raises(ConfigError) as caught:
        load_study(name, config.project, overrides)
    return str(caught.value)


def extending(config, more="", name="wider", text=WIDER):
    config.write(f"studies/{name}.yaml", text + more)
    return name


def test_it_runs_as_the_other_but_for_its_own_keys(config):
    """Runs, design and fidelities are those of the other; of a block and of a fidelity only what is given changes."""
    more = "bed: {behind_mm: 400}\nfidelities: {quick: {sample: {width_mm: 90}}, paper: {particle_scale: 1.0}}\n"
    wider, small = load_study(extending(config, more), config.project), load_study("small", config.project)
    assert (wider.title, wider.question) == ("A wider sample", "Is it wider?")
    assert [run.name for run in wider.runs] == [run.name for run in small.runs]
    expected = small.settings | {
        "bed": small.settings["bed"] | {"behind_mm": 400},
        "sample": small.settings["sample"] | {"width_mm": 90},
    }
    assert wider.settings == expected
    assert load_study("wider", config.project, {"fidelity": "paper"}).settings["particle_scale"] == 1.0


def test_what_it_gives_for_all_fidelities_stands_above_those_of_the_other(config):
    """A key of the file itself, as if it were written in each fidelity; one of its own fidelity stands above both."""
    more = "particle_scale: 3.0\nbed: {width_mm: 130}\ndesign: other.csv\n"
    config.write("designs/other.csv", config.path("designs/small.csv").read_text().replace("R5", "R6"))
    config.edit("studies/small.yaml", "  quick:\n", "  quick:\n    design: small.csv\n")
    wider = load_study(extending(config, more), config.project)
    assert (wider.settings["particle_scale"], wider.settings["bed"]["width_mm"]) == (3.0, 130)
    assert {run.row for run in wider.runs} == {"R9", "R6"}
    wider = load_study(extending(config, f"{more}fidelities: {{quick: {{particle_scale: 2.5}}}}\n"), config.project)
    assert (wider.settings["particle_scale"], wider.settings["bed"]["width_mm"]) == (2.5, 130)


def test_one_extends_another_that_extends_a_third(config):
    """The nearest file wins, whatever stands between."""
    extending(config, "bed: {behind_mm: 400, ahead_mm: 180}\n")
    extending(config, "bed: {behind_mm: 450}\n", "widest", WIDER.replace("extends: small", "extends: wider"))
    bed = load_study("widest", config.project).settings["bed"]
    assert (bed["behind_mm"], bed["ahead_mm"], bed["width_mm"]) == (450, 180, 120)


def test_an_alternative_stands_for_the_one_below(config):
    """A wear coefficient per pascal in place of the other's k, in the file and in a fidelity of either."""
    given = "wear: {wear_coefficient_k: 1.0e-4}\n"
    config.edit(
        "materials.yaml", "    shear_modulus_pa: 78.0e9\n", "    shear_modulus_pa: 78.0e9\n    hardness_pa: 1.2e9\n"
    )
    config.edit("studies/small.yaml", "bed: {ahead_mm: 150}\n", "bed: {ahead_mm: 150}\n" + given)
    wear = load_study(extending(config, "wear: {wear_coefficient_per_pa: 2.0e-13}\n"), config.project).settings["wear"]
    assert wear["wear_coefficient_per_pa"] == 2.0e-13
    config.edit("studies/small.yaml", given, "")
    config.edit("studies/small.yaml", "    bed:\n", f"    {given}    bed:\n")
    wear = load_study("wider", config.project).settings["wear"]
    assert wear["wear_coefficient_per_pa"] == 2.0e-13
    extending(config, "fidelities: {quick: {wear: {wear_coefficient_per_pa: 3.0e-13}}}\n")
    wear = load_study("wider", config.project).settings["wear"]
    assert wear["wear_coefficient_per_pa"] == 3.0e-13


def test_a_fault_is_told_in_the_file_where_it_stands(config):
    """Also one that only the settings of both files together have."""
    extending(config, "bed:\n  behind_mm: 400 mm\n")
    assert message(config).startswith("config/studies/wider.yaml, line 5: bed.behind_mm is '400 mm'")
    extending(config, "bed:\n  behind_mm: 400\n")
    config.edit("studies/small.yaml", "particle_scale: 2.0", "particle_scale: -2.0")
    assert message(config).startswith("config/studies/small.yaml, line 8, fidelity quick: particle_scale is -2,")
    config.edit("studies/small.yaml", "particle_scale: -2.0", "particle_scale: 60.0")
    assert "config/studies/small.yaml, line 8" in message(config)


def test_keys_that_it_needs_itself(config):
    """A page of the other's title would be taken for the other's."""
    extending(config, text="extends: small\nquestion: Is it wider?\n")
    assert message(config) == (
        "config/studies/wider.yaml: title is missing, allowed is one of its own: not that of small, which it extends."
    )


@pytest.mark.parametrize(
    ("named", "said"),
    [
        ("smal", "extends is 'smal', allowed is one of small, wider (the nearest is small)."),
        ("wider", "extends is wider, which leads back to it, allowed is another study."),
        ("3", "extends is 3, allowed is text."),
        ("[small]", "extends is ['small'], allowed is text."),
    ],
)
def test_what_it_cannot_extend(config, named, said):
    """One sentence with the line of the key."""
    extending(config, text=WIDER.replace("extends: small", f"extends: {named}"))
    assert message(config) == f"config/studies/wider.yaml, line 3: {said}"


def test_two_that_extend_one_another(config):
    """Told where the circle closes."""
    extending(config, text=WIDER.replace("small", "widest"))
    extending(config, name="widest", text=WIDER.replace("small", "wider"))
    assert "extends is wider, which leads back to it" in message(config)


def test_a_case_that_the_other_is_not_of(config):
    """Its keys would be told as unknown in the other's file, where nothing is wrong."""
    extending(config, "case: pin_on_disc\n")
    assert message(config) == (
        "config/studies/wider.yaml, line 4: case is pin_on_disc, allowed is sliding_sample, that of"
        " config/studies/small.yaml, or a case that extends it."
    )
