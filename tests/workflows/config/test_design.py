"""Studies become runs: layers of settings, rows of the design."""

from __future__ import annotations

import json
import re
from dataclasses import asdict

import pytest

from bulkwear.workflows.cases.sliding_sample.page import BEYOND_BUMPS
from bulkwear.workflows.cases.sliding_sample.study import finds_regimes
from bulkwear.workflows.config.design import list_studies, load_study
from bulkwear.workflows.config.layers import ConfigError, command_line_layer
from bulkwear.workflows.report.page_parameters import figure_remarks
from tests import REPOSITORY
from tests.support.small_study import parameters_of
from tests.support.tiny import tiny_study

FIDELITIES = ("quick", "standard", "paper")


@pytest.mark.parametrize("fidelity", FIDELITIES)
@pytest.mark.parametrize("name", list_studies())
def test_shipped_studies_load_at_every_fidelity(name, fidelity):
    """Every shipped study is valid at every fidelity, and its parameters survive JSON unchanged."""
    study = load_study(name, overrides={"fidelity": fidelity})
    assert study.fidelity == study.settings["fidelity"] == fidelity
    for run in study.runs:
        assert json.loads(json.dumps(run.parameters, allow_nan=False)) == run.parameters


def test_screening_is_table_3_8():
    """Thirteen rows, each with a plain twin; every factor is balanced (Yan 2022, Table 3.8)."""
    study = load_study("screening", overrides={"packings": 1})
    assert [run.name for run in study.runs][:2] == ["R1_convex", "R1_plain"]
    assert len(study.runs) == 26
    levels = {
        "major_radius_mm": (2, 4, 8),
        "minor_radius_mm": (2, 4, 8),
        "column_spacing_mm": (20, 40, 60),
        "height_mm": (1.5, 3, 6),
        "velocity_m_per_s": (0.5, 1, 2),
        "bed_thickness_mm": (10, 20, 40),
    }
    for factor, (low, middle, high) in levels.items():
        column = [row[factor] for row in study.design_rows]
        assert [column.count(level) for level in (low, middle, high)] == [5, 3, 5], factor


def test_a_thin_bed_limits_the_particle_scale():
    """A bed of 10 mm holds 3.8 layers of d50 = 2.65 mm: scale 1 passes, scale 2 does not."""
    paper = load_study("screening", overrides={"fidelity": "paper"})
    assert paper.run("R2_plain").parameters["derived"]["layers"] == pytest.approx(10 / 2.65)
    with pytest.raises(ConfigError, match=r"row R2: bed_thickness_mm is 10, allowed is at least 15.9 mm"):
        load_study("screening", overrides={"fidelity": "paper", "particle_scale": 2})


def test_least_layers_lowers_the_scale_of_thin_beds_only():
    """At scale 2 a bed of 10 mm gets the scale that leaves it its least layers; one of 40 mm keeps 2; never below 1."""
    study = load_study("screening", overrides={"particle_scale": 2, "bed": {"least_layers": 3.5}})
    thin, thick = (study.run(name).parameters for name in ("R2_plain", "R9_plain"))
    assert thin["derived"]["layers"] == pytest.approx(3.5)
    assert thin["particle"]["scale"] == pytest.approx(10 / (3.5 * 2.65))
    assert thick["particle"]["scale"] == 2
    crowded = load_study("screening", overrides={"bed": {"least_layers": 3.9}})
    assert crowded.run("R2_plain").parameters["particle"]["scale"] == 1


def test_plain_twins_under_the_same_conditions_are_one_simulation():
    """A plain sample knows no pattern: rows of equal velocity and thickness share it. Convex samples share nothing."""
    study = load_study("screening", overrides={"packings": 2})
    shared = {run.name: study.same_as(run.name) for run in study.runs if study.same_as(run.name)}
    assert shared == {
        f"{row}{packing}_plain": f"{first}{packing}_plain"
        for row, first in (("R7", "R4"), ("R8", "R1"), ("R11", "R3"), ("R13", "R5"))
        for packing in ("", "-2")
    }


@pytest.mark.parametrize("fidelity", ["quick", "paper"])
def test_one_regression_has_one_particle_scale(fidelity):
    """Rows that one regression compares differ in their factors alone: one scale, at least three layers everywhere."""
    study = load_study("screening", overrides={"fidelity": fidelity})
    assert len({run.parameters["particle"]["scale"] for run in study.runs}) == 1
    assert min(run.parameters["derived"]["layers"] for run in study.runs) >= 3.0
    assert not any("scale" in remark and "row to row" in remark for remark in figure_remarks(study))


def test_a_study_whose_scale_follows_thickness_says_so():
    """At standard fidelity a bed of 10 mm has smaller particles than one of 40 mm: every figure tells."""
    study = load_study("screening", overrides={"fidelity": "standard"})
    scale = {run.parameters["bed"]["thickness_m"]: run.parameters["particle"]["scale"] for run in study.runs}
    assert scale[0.01] < scale[0.02] == scale[0.04]
    assert any("different from row to row" in remark for remark in figure_remarks(study))


def test_an_unknown_study_is_named_with_the_nearest(config):
    """A misspelt study gives the studies there are."""
    with pytest.raises(ConfigError) as caught:
        load_study("smal", config.project)
    assert str(caught.value) == ("config/studies: study is 'smal', allowed is one of small (the nearest is small).")


def test_the_strongest_layer_wins_key_by_key(config):
    """default < study < fidelity block < command line; keys that a layer does not name come from below."""
    settings = load_study("small", config.project, {"sample": {"length_mm": 70}, "bed": {"behind_mm": 123}}).settings
    assert settings["sample"]["material"] == "steel"  # default
    assert settings["bed"]["ahead_mm"] == 150  # study
    assert (settings["sample"]["width_mm"], settings["bed"]["width_mm"]) == (80, 120)  # fidelity block
    assert (settings["sample"]["length_mm"], settings["bed"]["behind_mm"]) == (70, 123)  # command line


def test_the_fidelity_comes_from_the_strongest_layer(config):
    """Command line before study before default; other blocks do not apply, an empty block is fine."""
    assert load_study("small", config.project).fidelity == "quick"
    config.edit("studies/small.yaml", "title:", "fidelity: standard\ntitle:")
    standard = load_study("small", config.project)
    assert (standard.fidelity, standard.settings["particle_scale"]) == ("standard", 1.0)
    quick = load_study("small", config.project, {"fidelity": "quick"})
    assert (quick.fidelity, quick.settings["particle_scale"]) == ("quick", 2.0)


def test_a_fidelity_may_have_a_design_of_its_own(config):
    """The block's table replaces the study's at that fidelity, and only there; a missing one is named with its line."""
    config.edit("studies/small.yaml", "    particle_scale: 2.0", "    design: few.csv\n    particle_scale: 2.0")
    with pytest.raises(ConfigError, match=r"line 8, fidelity quick: design is 'few.csv', allowed is one of small.csv"):
        load_study("small", config.project)
    table = config.path("designs/small.csv").read_text(encoding="utf-8")
    config.write("designs/few.csv", "\n".join(table.splitlines()[:2]))
    assert [run.row for run in load_study("small", config.project).runs] == ["R9", "R9"]
    assert len(load_study("small", config.project, {"fidelity": "standard"}).design_rows) == 2


def test_whole_and_decimal_numbers_give_the_same_parameters(config):
    """2 and 2.0 are the same setting, and the same JSON (states are compared by its hash)."""
    written = [json.dumps(parameters_of(config, overrides={"particle_scale": s})) for s in (2, 2.0, "2")]
    assert len(set(written)) == 1


def test_loading_twice_gives_the_same_study_and_shares_nothing(config):
    """Parameters of one study can be changed without changing another (no shared mutable state)."""
    first, untouched = (load_study("small", config.project) for _ in range(2))
    first.runs[0].parameters["particle"]["diameters_m"].append(1.0)
    first.runs[0].parameters["solver"]["ranks"] = 99
    assert load_study("small", config.project) == untouched
    assert first.runs[1] == untouched.runs[1]


def test_the_design_table_has_one_row_per_run_with_units_in_the_names(config):
    """run, row, setting, packing and surface, then the factors as written."""
    table = load_study("small", config.project).design_table()
    assert [row["run"] for row in table] == ["R9_convex", "R9_plain", "R5_convex", "R5_plain"]
    assert table[3] == {
        "run": "R5_plain",
        "row": "R5",
        "setting": "R5",
        "packing": 1,
        "surface": "plain",
        "major_radius_mm": 4,
        "minor_radius_mm": 8,
        "column_spacing_mm": 60,
        "height_mm": 6,
        "velocity_m_per_s": 2,
        "bed_thickness_mm": 30,
        "particle_scale": 2.0,
        "layers": pytest.approx(30 / 5.3),
        "equivalent_size_ratio": None,
    }


def test_an_unknown_run_is_refused(config):
    """Asking for the bed of a run that is not there names the nearest run."""
    with pytest.raises(ConfigError, match=r"run is 'R9_convx'.*\(the nearest is R9_convex\)"):
        load_study("small", config.project).bed_of("R9_convx")


def test_rows_that_are_called_by_numbers_may_be_chosen():
    """Snakemake reads rows=[1] as a number; names are text."""
    layer = command_line_layer({"rows": [1, "R5", True], "packings": "2"})
    assert layer.values == {"rows": ["1", "R5", True], "packings": 2}


def test_many_rows_are_counted_and_not_named():
    """Of a screening in coarse particles a figure says how many rows; the table of runs has each."""
    settings = {"particle_scale": 4, "bed": {"allow_thin_bed": True}}
    remarks = figure_remarks(load_study("screening", overrides=settings))
    assert f"{BEYOND_BUMPS}, rows: 12 of 13" in remarks
    assert "fewer than three layers of particles in the bed: 8 of 13" in remarks


def test_a_run_is_the_same_whichever_rows_are_chosen():
    """Chosen rows keep their parameters and their bed, whose height follows the highest sample of the whole design."""
    whole, chosen = (
        load_study("screening", overrides={"packings": 2, **rows}) for rows in ({}, {"rows": ["R9", "R2-2"]})
    )
    assert [run.row for run in chosen.runs[::2]] == ["R2-2", "R9", "R9-2"]
    for run in chosen.runs:
        assert run == whole.run(run.name)
        assert chosen.beds[chosen.bed_of(run.name)] == whole.beds[whole.bed_of(run.name)]
    assert set(chosen.beds) == {chosen.bed_of(run.name) for run in chosen.runs}
    assert len(chosen.design_table()) == len(chosen.runs)


def test_few_rows_have_regimes_but_no_regression():
    """A regression needs four rows and two levels of every factor; regimes need one row."""
    few = load_study("screening", overrides={"rows": ["R5", "R9"]})
    assert finds_regimes(few) and not few.factors
    assert not finds_regimes(load_study("demo"))
    enough = load_study("screening", overrides={"rows": ["R1", "R2", "R3", "R4", "R5"]})
    assert set(enough.factors) == set("abdhvt")


def test_a_row_that_is_not_in_the_design_is_refused():
    with pytest.raises(
        ConfigError, match=r"command line: row is 'R99', allowed is one of R1, R1-2, R1-3, R2.*\(the nearest is R9\)"
    ):
        load_study("screening", overrides={"rows": ["R9", "R99"]})
    with pytest.raises(ConfigError, match="rows is 'R9', allowed is a list of rows of the design"):
        load_study("screening", overrides={"rows": "R9"})


def test_worn_through_needs_a_thickness():
    """What a run does where it is worn through is refused without the thickness, in a sentence; with it it is taken."""
    with pytest.raises(ConfigError, match=r"wear\.worn_through is 'cap' for row R9, allowed is a study that gives"):
        tiny_study(wear={"worn_through": "cap"})
    study = tiny_study(wear={"worn_through": "cap", "local_thickness_mm": 2})
    assert study.run("R9_convex").parameters["wear"]["local_thickness_m"] == pytest.approx(0.002)


@pytest.mark.parametrize(
    "name", ["further_packings", "proposed_rows", "default_studies", "figure_forces", "tables_beds"]
)
def test_a_study_that_is_called_as_a_rule_is_refused(name):
    """Snakemake would have two of that name: rules, checkpoints, and those that are made of figures and tables."""
    with pytest.raises(ConfigError, match=f"a study cannot be called {name}, allowed are small letters"):
        load_study(name)


def test_what_rounds_depend_on_is_of_types_that_snakemake_compares():
    """An object of a class of ours would never count as changed: a wider goal would do nothing."""
    of_class = re.compile(r"=lambda wildcards: study_of\(wildcards\)\.(until|optimise),")
    found = [path.name for path in (REPOSITORY / "workflows").rglob("*.smk") if of_class.search(path.read_text())]
    assert found == []
    asked = load_study("demo", overrides={"until": {"width_fraction": 0.05, "most_packings": 6, "most_core_h": 3}})
    for goal in (asked.until, load_study("optimised_pattern").optimise):
        json.dumps(asdict(goal))
