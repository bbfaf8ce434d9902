"""Wear coefficients by the hardness of a wall, by part and by pair of materials: values, which one counts, faults."""

from dataclasses import replace

import pytest
import yaml

from bulkwear.workflows.cases.equipment.machine_tables import parts_table
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.engine.inputs import run_digest
from bulkwear.workflows.report.page_parameters import page_parameters
from bulkwear.workflows.report.text import hardness_words
from tests.support.own_machine_project import ORE, TINY, machine_study

K, H, ALPHA = 1e-3, 2e9, 5e-13  # -, Pa, 1/Pa: k / H, to a rounding
OF_PAIR = 0.4  # -, error of a pair's coefficient, as no default has it
DEFAULT_ALPHA = 6.3e-13  # 1/Pa, of config/default.yaml
ROUNDING = 1e-15  # relative; one quotient or product
VICKERS, DIGITS = 9.807e6, 5e-4  # Pa, of 1 HV; -, of a number with four digits
STEEL, PERSPEX = "walls:\n  steel:\n", "  perspex:\n"
STUDY = "studies/small.yaml"


def hard(config, wall="steel", hardness=H, **pairs):
    """Give a wall a hardness, none for None, and coefficients of pairs."""
    added = {"hardness_pa": hardness} if hardness else {}
    lines = yaml.safe_dump(added | ({"wear": pairs} if pairs else {})).splitlines()
    before = STEEL if wall == "steel" else PERSPEX
    config.edit("materials.yaml", before, before + "".join(f"    {line}\n" for line in lines))


def wear_of(config, **wear):
    """The section `wear` of the first run, with what a command line says of it."""
    return load_study("small", config.project, {"wear": wear} if wear else None).runs[0].parameters["wear"]


def message_of(config, **wear):
    with pytest.raises(ConfigError) as caught:
        wear_of(config, **wear)
    return str(caught.value)


def test_a_coefficient_is_k_over_the_hardness_of_the_wall(config):
    """alpha = k / H; all three are in the run, in the table of its design and in the settings of its page."""
    hard(config)
    study = load_study("small", config.project, {"wear": {"wear_coefficient_k": K, "acceleration": 3.0}})
    wear = study.runs[0].parameters["wear"]
    assert wear["wear_coefficient_per_pa"] == pytest.approx(ALPHA, rel=ROUNDING)
    assert wear["accelerated_wear_coefficient_per_pa"] == pytest.approx(3.0 * ALPHA, rel=ROUNDING)
    row, told = study.design_table()[0], page_parameters(study)["settings"]["wear"]
    for found in (wear, row, told):
        assert (found["wear_coefficient_k"], found["wall_hardness_pa"]) == (K, H)
        assert found["wear_coefficient_per_pa"] == pytest.approx(ALPHA, rel=ROUNDING)
    assert hardness_words([wear]).endswith("k 0.001, hardness 2e+09 Pa.")


def test_a_known_hardness_tells_k_of_a_coefficient_in_1_per_pa(config):
    """k = alpha H is told, and nothing is simulated again for it."""
    study = load_study("small", config.project)
    hard(config)
    scaled = load_study("small", config.project)
    assert scaled.runs[0].parameters["wear"]["wear_coefficient_k"] == pytest.approx(DEFAULT_ALPHA * H, rel=ROUNDING)
    bed = study.beds[study.bed_of(study.runs[0].name)]
    assert len({run_digest(each.case, each.runs[0].parameters, bed) for each in (study, scaled)}) == 1
    assert "wear_coefficient_k" not in study.design_table()[0] and not hardness_words([])


def test_the_hardness_of_the_source_s_disc_is_known():
    """143 HV (Table 5.1), to the digits of the file; so each run of the pin tells its k."""
    for run in load_study("pin_on_disc").runs:
        wear = run.parameters["wear"]
        assert wear["wall_hardness_pa"] == pytest.approx(143.0 * VICKERS, rel=DIGITS)
        assert wear["wear_coefficient_k"] == pytest.approx(wear["wear_coefficient_per_pa"] * wear["wall_hardness_pa"])


def test_the_stronger_way_to_give_a_coefficient_counts(config):
    """k of a command line stands for the study's alpha, and the other way round."""
    hard(config)
    config.edit(STUDY, "fidelities:", f"wear: {{wear_coefficient_k: {2.0 * K}}}\nfidelities:")
    assert wear_of(config)["wear_coefficient_per_pa"] == pytest.approx(2.0 * ALPHA, rel=ROUNDING)
    assert wear_of(config, wear_coefficient_per_pa=1e-12)["wear_coefficient_per_pa"] == 1e-12
    assert wear_of(config, wear_coefficient_k=K)["wear_coefficient_k"] == K


def test_two_coefficients_in_one_place_are_refused(config):
    """The study's file is named, its line and both keys."""
    block = f"wear: {{wear_coefficient_k: {K}, wear_coefficient_per_pa: 1e-12}}\nfidelities:"
    config.edit(STUDY, "fidelities:", block)
    assert message_of(config) == (
        "config/studies/small.yaml, line 6: wear.wear_coefficient_per_pa and wear.wear_coefficient_k are both given,"
        " allowed is one of them."
    )


def test_k_without_a_hardness_is_refused(config):
    """The sentence names what is missing, and the wall."""
    assert message_of(config, wear_coefficient_k=K) == (
        "command line: wear.wear_coefficient_k is 0.001, allowed is wear_coefficient_per_pa, or a hardness_pa of the"
        " wall steel in the file of materials, over which k is taken."
    )


@pytest.mark.parametrize("key", ["wear_coefficient_k", "wear_coefficient_per_pa"])
def test_a_pair_of_materials_gives_what_a_study_does_not_name(config, key):
    """It stands above config/default.yaml and below the study's own coefficient."""
    hard(config, river_gravel={key: {"wear_coefficient_k": K, "wear_coefficient_per_pa": ALPHA}[key]})
    study = load_study("small", config.project)
    assert study.runs[0].parameters["wear"]["wear_coefficient_per_pa"] == pytest.approx(ALPHA, rel=ROUNDING)
    assert study.settings["wear"]["wear_coefficient_k"] == pytest.approx(K, rel=ROUNDING)
    assert wear_of(config, wear_coefficient_per_pa=1e-12)["wear_coefficient_per_pa"] == 1e-12


def test_the_error_of_a_pair_goes_with_its_coefficient(config):
    """Not with a study's own coefficient, nor with that of another law; an error that the study gives counts first."""
    hard(config, river_gravel={"wear_coefficient_k": K, "wear_coefficient_error": OF_PAIR})
    study, error = load_study("small", config.project), "wear_coefficient_error"
    assert study.settings["wear"][error] == study.runs[0].parameters["wear"][error] == OF_PAIR
    for other in ({"wear_coefficient_per_pa": 1e-12}, {"law": "tangential_work"}):
        assert wear_of(config, **other).get(error) != OF_PAIR
    assert wear_of(config, wear_coefficient_error=0.5)[error] == 0.5


def test_the_coefficient_of_a_pair_belongs_to_a_law(config):
    """A study of another law does not take it."""
    hard(config, hardness=None, river_gravel={"wear_coefficient_per_pa": 1e-12, "law": "tangential_work"})
    assert wear_of(config)["wear_coefficient_per_pa"] == DEFAULT_ALPHA
    assert wear_of(config, law="tangential_work")["wear_coefficient_per_pa"] == 1e-12


@pytest.mark.parametrize(
    ("pairs", "said"),
    [
        (
            {"river_gravel": {"law": "archard"}},
            "walls.steel.wear.river_gravel.wear_coefficient_per_pa and"
            " walls.steel.wear.river_gravel.wear_coefficient_k are both missing, allowed is one of them.",
        ),
        (
            {"river_gravel": {"wear_coefficient_k": K}},
            "walls.steel.wear.river_gravel.wear_coefficient_k is 0.001, allowed is wear_coefficient_per_pa, or a"
            " hardness_pa of the wall steel, over which k is taken.",
        ),
        ({"river_gravl": {"wear_coefficient_per_pa": 1e-12}}, "walls.steel.wear is 'river_gravl', allowed is one of"),
        ({"river_gravel": {"wear_coefficient_k": 2.0}}, "wear_coefficient_k is 2, allowed is a number from 1e-09 to 1"),
    ],
)
def test_a_wrong_pair_is_named(config, pairs, said):
    """Neither coefficient, k without a hardness, an unknown particle, a value beyond its range: one sentence each."""
    hard(config, hardness=None, **pairs)
    assert said in message_of(config)


# ---------------------------------------------------------------- parts

WALL = {"density_kg_per_m3": 8000, "poissons_ratio": 0.3, "shear_modulus_pa": 8.0e10, "contact": dict(ORE["contact"])}
ERROR = {"wear_coefficient_error": OF_PAIR}
WALLS = {
    "soft": {**WALL, "hardness_pa": 1.0e9, "wear": {"ore": {"wear_coefficient_k": 0.002, **ERROR}}},
    "hard": {**WALL, "hardness_pa": 4.0e9, "wear": {"ore": {"wear_coefficient_per_pa": 1.0e-13, **ERROR}}},
}
MACHINE = replace(TINY, materials={**TINY.materials, "walls": WALLS})
PARTS = {"liner": {"material": "soft"}, "plate": {"material": "hard", "wear_coefficient_per_pa": None, "law": None}}


def parts_of(folder, **changes):
    """{part: its parameters} of the tiny machine with walls of two hardnesses, and the table of its parts."""
    with machine_study(folder, machine=MACHINE, **changes) as study:
        run = study.runs[0].parameters
        return {part["name"]: part for part in run["parts"]}, parts_table({"A": run}).set_index("part")


def test_parts_of_several_materials_have_each_their_own_coefficient(tmp_path):
    """The section's k over the hardness of each part's wall; a part's own k, or alpha, stands above it."""
    changes = {"wear": {"wear_coefficient_k": K}, "parts": PARTS | {"paddle": {"wear_coefficient_per_pa": 3e-13}}}
    parts, table = parts_of(tmp_path, **changes)
    found = {name: part["wear_coefficient_per_pa"] for name, part in parts.items() if part["wears"]}
    assert found == pytest.approx({"liner": K / 1e9, "plate": K / 4e9, "paddle": 3e-13}, rel=ROUNDING)
    assert table.loc["plate", "wear_coefficient_k"] == K and table.loc["plate", "wall_hardness_pa"] == 4e9
    own = {**PARTS, "liner": {"material": "soft", "wear_coefficient_k": 0.5}}
    parts, _ = parts_of(tmp_path, parts=own)
    assert parts["liner"]["wear_coefficient_per_pa"] == pytest.approx(0.5 / 1e9, rel=ROUNDING)


def test_parts_take_the_coefficients_of_their_pairs(tmp_path):
    """Each wall under the ore has its own; a wall without a pair has the default, and tells no k. The liner's own error
    counts before its pair's.
    """
    parts, table = parts_of(tmp_path, parts=PARTS)
    found = {name: part["wear_coefficient_per_pa"] for name, part in parts.items() if part["wears"]}
    assert found == pytest.approx({"liner": 0.002 / 1e9, "plate": 1e-13, "paddle": DEFAULT_ALPHA}, rel=ROUNDING)
    assert [parts[name]["wear_coefficient_error"] for name in ("liner", "plate")] == [0.2, OF_PAIR]
    assert table.loc["plate", "wear_coefficient_k"] == pytest.approx(1e-13 * 4e9, rel=ROUNDING)
    assert table.loc[["paddle"], "wear_coefficient_k"].isna().all()


def test_the_coefficient_of_a_part_is_refused_as_that_of_the_section(tmp_path):
    """Both in one part, and k of a wall without hardness."""
    for given, said in (
        ({"wear_coefficient_k": K, "wear_coefficient_per_pa": 1e-12}, "liner.wear_coefficient_k are both given"),
        ({"wear_coefficient_k": K}, "parts.liner.wear_coefficient_k is 0.001, allowed is wear_coefficient_per_pa, or"),
    ):
        with pytest.raises(ConfigError, match=said):
            parts_of(tmp_path, parts={"liner": given})


@pytest.mark.parametrize("parts", [{}, {"parts": {"impact_plate": {"material": "mild_steel"}}}])
def test_a_shared_k_needs_the_hardness_of_every_part(parts):
    """Of parts without a coefficient of their own, also where another part's hardness is known."""
    said = r"wear.wear_coefficient_k is 0.001, allowed is .* hardness_pa of the wall steel"
    with pytest.raises(ConfigError, match=said):
        load_study("chute", overrides={"wear": {"wear_coefficient_k": K}, **parts})
