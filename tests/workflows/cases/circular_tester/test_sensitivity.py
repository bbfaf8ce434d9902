"""What the source does not tell of its tester: settings, numbers reached, effects of changes, figure, sentences."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from bulkwear.postproc.statistics.verdicts import AGREES, CONTRADICTS, UNSAID
from bulkwear.workflows.cases.circular_tester.page import published_numbers
from bulkwear.workflows.cases.circular_tester.plots.sensitivity import reached_by_setting
from bulkwear.workflows.cases.circular_tester.sensitivity import FACTORS as VARIABLE
from bulkwear.workflows.cases.circular_tester.sensitivity import (
    REFERENCE,
    changes_of,
    effects_table,
    numbers_table,
    sensitivity_table,
    sentences,
    settings_of_pairs,
    words_of,
)
from bulkwear.workflows.cases.circular_tester.sensitivity_figures import CLAIMS_PART, NUMBERS
from bulkwear.workflows.config.claims import claims_of
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.schema import load_schema
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.report.published import published_numbers as collected
from bulkwear.workflows.report.sections import Section

CLAIMS = claims_of(CLAIMS_PART)
MIDDLE = {key: 0.5 * sum(claim.magnitude) if claim.magnitude else claim.reference for key, claim in CLAIMS.items()}
FACTORS = {
    "friction": 1.3,
    "rolling": 1.1,
    "bed": 0.8,
    "thin": 1.02,
    "rvd": 1.05,
    "incline": 0.9,
}  # what each change does to every number
EXACT = 1e-9


@pytest.fixture(scope="module")
def settings():
    return settings_of_pairs(load_study("tester_sensitivity", overrides={"fidelity": "quick"}))


@pytest.fixture(scope="module")
def table(settings):
    """Numbers that are the reference's times the factors of the changes, of three packings and of one."""
    numbers = {}
    for pair in settings:
        times = math.prod(factor for name, factor in FACTORS.items() if name in pair.split("-"))
        scatter = (0.99, 1.0, 1.0 / 0.99) if pair == REFERENCE else (1.0,)
        numbers[pair] = [{key: each * times * value for key, value in MIDDLE.items()} for each in scatter]
    return sensitivity_table(numbers, CLAIMS)


def test_each_thing_is_changed_alone_and_with_two_others(settings):
    """Four changes of one thing, and of the others three at a time: no two of the four go together more often. A second
    rolling model and the other incline stand beside them, alone.
    """
    changes = dict(changes_of(settings))
    assert changes.pop("rvd") == {"rolling model": "rvd"}
    assert changes.pop("incline") == {"incline of the sample, degrees": "-2"}
    assert sorted(map(len, changes.values())) == [0, 1, 1, 1, 1, 3, 3, 3, 3] and not changes[REFERENCE]
    names = sorted({name for each in changes.values() for name in each})
    signs = np.array([[1 if name in each else -1 for name in names] for pair, each in changes.items() if each])
    assert (signs.T @ signs == 8 * np.eye(4)).all()


NOT_VARIED = {"surface", "seed", "packings", "consolidator_level_mm"}  # the level is that of the bed
ELSEWHERE = {  # settings whose value stands elsewhere among the parameters
    "sample.material": ("sample_material",),
    "particle_scale": ("particle", "scale"),
    "wear.wear_coefficient_per_pa": ("wear", "accelerated_wear_coefficient_per_pa"),
}


def test_every_column_that_a_row_may_vary_has_a_name():
    """None passes as the reference: each setting that a column of the design replaces is among what is told."""
    columns = load_schema("cases/circular_tester/design")["properties"]
    named = [(name, column["x-setting"]) for name, column in columns.items() if "x-setting" in column]
    told = [path for path, _ in VARIABLE.values()]
    for _, setting in (each for each in named if each[0] not in NOT_VARIED):
        section, _, key = setting.rpartition(".")
        path = ELSEWHERE.get(setting) or (section, next(iter(to_si({key: 0.0}))))
        assert any(each[: len(path)] == path for each in told), setting


def test_a_pair_in_another_machine_is_no_reference():
    """A ring, contacts that wear over single elements, another coefficient: each is told beside the bed."""
    study = load_study("tester_sensitivity", overrides={"fidelity": "quick", "packings": 1})
    bed = next(run for run in study.runs if run.row == "bed-plain")
    ring = {**bed.parameters, "tester": {**bed.parameters["tester"], "shape": "ring"}}
    wear = {key: value for key, value in bed.parameters["wear"].items() if key != "patch_radius_m"}
    ring["wear"] = {**wear, "accelerated_wear_coefficient_per_pa": 1e-8}
    runs = [SimpleNamespace(row=run.row, parameters=ring if run is bed else run.parameters) for run in study.runs]
    changes = changes_of(settings_of_pairs(SimpleNamespace(design_rows=study.design_rows, runs=runs)))
    said = "height of the bed 190 mm, shape of the machine ring, wear coefficient 1e-08 1/Pa, patch radius none"
    assert words_of(changes["bed"]) == said and words_of(changes[REFERENCE]) == REFERENCE


def test_what_a_change_does_comes_back(table, settings):
    """Of numbers that are products of factors the factors are found, without an error left."""
    effects = effects_table(table, changes_of(settings))
    words = {"friction of": "friction", "rolling model own_spin": "rolling", "rolling model rvd": "rvd"}
    words |= {"height of the bed": "bed", "thickness": "thin", "incline": "incline"}
    assert len(effects) == len(CLAIMS) * len(FACTORS)
    for row in effects.itertuples():
        name = next(name for start, name in words.items() if row.change.startswith(start))
        assert row.factor == pytest.approx(FACTORS[name], rel=EXACT)
        assert row.low == pytest.approx(row.high, rel=1e-6)


def test_effects_need_settings_that_tell_them_apart(table, settings):
    """Of the reference and a setting with three changes nothing can be said of one; of single changes no interval."""
    changes = changes_of(settings)
    three = next(pair for pair, each in changes.items() if len(each) == 3)
    assert effects_table(table[table["pair"].isin([REFERENCE, three])], changes).empty
    single = effects_table(table[table["pair"].isin([REFERENCE, "friction"])], changes)
    assert single["factor"].to_numpy() == pytest.approx(FACTORS["friction"], rel=EXACT)
    assert single[["low", "high"]].isna().all().all()


def test_a_number_is_reached_within_its_margin(table):
    """The reference lies in the middle of every magnitude and is judged; one packing is reached or not, unjudged."""
    usual = table[(table["pair"] == REFERENCE) & table["published_low"].notna()]
    assert usual["reached"].all() and (usual["over"] == 1.0).all() and (usual["verdict"] == AGREES).all()
    more = table[table["pair"] == "friction"].set_index("key")
    assert (more["verdict"] == UNSAID).all()
    _, high = CLAIMS["bump_share"].region
    assert 1.3 * MIDDLE["bump_share"] > high and not more.loc["bump_share", "reached"]
    assert more.loc["bump_share", "over"] == pytest.approx(1.3 * MIDDLE["bump_share"] / high, rel=EXACT)
    assert more.loc["plain_velocity", "reached"] and not more.loc["convex_velocity", "reached"]


def test_a_number_that_no_setting_has_is_left_out():
    """A small sample has no bump C15; its line would be empty."""
    bare = {key: value for key, value in MIDDLE.items() if key != "loss_C15"}
    assert set(sensitivity_table({REFERENCE: [bare]}, CLAIMS)["key"]) == set(bare)


def test_a_number_that_some_settings_lack(table, settings):
    """Runs too short for it: no row, a dash in the figure; effects are those of the settings that have it."""
    changes, lacking = changes_of(settings), [pair for pair in settings if pair not in (REFERENCE, "friction", "bed")]
    some = table[(table["key"] != "loss_C15") | ~table["pair"].isin(lacking)]
    effects = effects_table(some, changes)
    of_it = effects[effects["key"] == "loss_C15"]
    assert of_it["factor"].to_numpy() == pytest.approx([FACTORS["friction"], FACTORS["bed"]], rel=EXACT)
    assert (effects["key"] != "loss_C15").sum() == (len(CLAIMS) - 1) * len(FACTORS)
    figure = reached_by_setting(some, settings, changes, ["tiny"])
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert texts.count("-") == len(lacking)
    reached = some[some["pair"] == "rvd"]["reached"].sum()
    assert f"{reached}/{len(CLAIMS) - 1}" in texts
    assert "Without a value" not in " ".join(sentences(some, changes, CLAIMS))
    without = sentences(table[table["key"] != "loss_C15"], changes, CLAIMS)[-1]
    assert without.startswith("Without a value") and without.endswith(f": {CLAIMS['loss_C15'].finding}.")


def test_numbers_are_told_as_claims_with_verdicts():
    """Of packings that lie close together; a number that none has is left out, without any there is an empty table."""
    packings = [{key: each * value for key, value in MIDDLE.items() if key != "loss_C15"} for each in (0.999, 1, 1.001)]
    told = numbers_table(packings, CLAIMS).set_index("finding")
    assert len(told) == len(CLAIMS) - 1
    of_size = [claim.finding for key, claim in CLAIMS.items() if claim.magnitude and key != "loss_C15"]
    assert (told.loc[of_size, "verdict"] == AGREES).all() and told["source"].str.contains("Yan 2022").all()
    assert told.loc["Convex over plain", "found"].startswith(f"{MIDDLE['loss_ratio']:.3g} (95 %")
    twice = numbers_table([{"plain_force": 2.0 * MIDDLE["plain_force"] * each} for each in (0.999, 1, 1.001)], CLAIMS)
    assert twice["verdict"].tolist() == [CONTRADICTS] and "33" in twice["found"].iloc[0]
    assert numbers_table([], CLAIMS).empty and "finding" in numbers_table([], CLAIMS)


def test_numbers_go_to_the_page_of_published_numbers(tmp_path):
    """As a table beside the source; of a pattern that is not the source's there is none."""
    (tmp_path / NUMBERS).parent.mkdir()
    told = numbers_table([MIDDLE], {key: CLAIMS[key] for key in ("plain_force", "convex_spin")})
    told.to_csv(tmp_path / NUMBERS, index=False)
    found = collected([Section("Findings of the source", published_numbers(tmp_path))])
    assert found["finding"].tolist() == told["finding"].tolist() and (found["verdict"] == UNSAID).all()
    numbers_table([], CLAIMS).to_csv(tmp_path / NUMBERS, index=False)
    assert published_numbers(tmp_path) == []


def test_sentences_name_all_settings_that_reach_most_and_what_none_reaches(table, settings):
    """Counts are those of the table; the factor in the plain volume is the published one over ours."""
    nowhere = CLAIMS["plain_force"].key
    said = sentences(table.assign(reached=table["reached"] & (table["key"] != nowhere)), changes_of(settings), CLAIMS)
    counts = table[table["key"] != nowhere].groupby("pair", sort=False)["reached"].sum()
    most = (counts == counts.max()).sum()
    assert f"reaches {counts[REFERENCE]} of {len(CLAIMS)} published numbers; most, {counts.max()}, are" in said[0]
    assert f"by {most} of {len(settings)} settings (" in said[0] and said[0].count("; ") == most
    assert table.loc[table["key"] == nowhere, "quantity"].iloc[0] in said[2]
    published = CLAIMS["plain_volume"].magnitude[0]
    assert f"loses {published / MIDDLE['plain_volume']:.3g} times what ours does in the reference" in said[1]


def test_the_figure_shows_every_value_and_setting(table, settings):
    """A cell per number and setting; below them what is varied, and how many each setting reaches."""
    figure = reached_by_setting(table, settings, changes_of(settings), ["tiny"])
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert sum(text == f"{MIDDLE['plain_force']:.3g}" for text in texts) >= 1
    assert texts.count("own_\nspin") == 4 and texts.count("cdt") == 6 and texts.count("rvd") == 1
    labels = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert labels[len(CLAIMS)] == "reached, of how many"
    assert f"{table[table['pair'] == REFERENCE]['reached'].sum()}/{len(CLAIMS)}" in texts
    assert labels[len(CLAIMS) + 1] == "packings" and texts.count("3") == 1 and "height of the bed, mm" in labels
    assert "Convex over plain: 0.426 to 0.65" in labels


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({}, None),
        ({"pair": "b"}, "series varied has pair a with plain, allowed is a patterned and a plain row"),
        ({"pair": None}, "series varied has pair a with plain, allowed is a patterned and a plain row"),
        ({"surface": "plain"}, "series varied has pair a with plain and plain, allowed is a patterned and a plain row"),
        (
            {"thickness_mm": 3.0},
            "rows of pair a differ in thickness_mm, allowed are row, surface and pattern",
        ),
    ],
)
def test_pairs_are_alike(change, said):
    """A varied row has a twin that differs in its surface alone."""
    main = [{"row": name, "series": "volume", "surface": name} for name in ("plain", "convex")]
    varied = {"series": "varied", "pair": "a", "thickness_mm": 2.0}
    pair = [{**varied, "row": f"a-{name}", "surface": name} for name in ("plain", "convex")]
    assert find_case("circular_tester").design_fault([*main, pair[0], pair[1] | change]) == said


def test_a_row_without_a_pair_is_told():
    """Its name stands in the sentence."""
    main = [{"row": name, "series": "volume", "surface": name} for name in ("plain", "convex")]
    fault = find_case("circular_tester").design_fault([*main, {"row": "x", "series": "varied", "surface": "plain"}])
    assert fault == "series varied has no pair in row x with plain, allowed is a patterned and a plain row"
