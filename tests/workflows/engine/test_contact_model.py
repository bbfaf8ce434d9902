"""The contact model is one block of the templates: its words in the solver's order, every model on the real solver."""

import itertools
import math
import re

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.sliding_sample.decks import bed_contacts
from bulkwear.workflows.cases.sliding_sample.particle_size.collision import (
    SPEEDS,
    read_collisions,
    simulate,
    spheres_of,
)
from bulkwear.workflows.config.design import ConfigError, load_study
from bulkwear.workflows.config.schema import SCHEMA_FOLDER, load_schema
from bulkwear.workflows.config.sources import read_sources
from bulkwear.workflows.config.study_files import list_studies
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.engine import cycles
from bulkwear.workflows.engine.bulk_tests import time_step
from bulkwear.workflows.engine.cases import case_names
from bulkwear.workflows.engine.chain import bed_deck_text
from bulkwear.workflows.engine.project import current_project
from bulkwear.workflows.engine.solver import run_deck
from bulkwear.workflows.engine.templates import render, solver_settings, template_variables
from tests import REPOSITORY
from tests.support.tiny import OF_ANY_MODEL, tiny_chain, tiny_study

BLOCK, MATERIALS = "_shared/contact_model", "_shared/materials"
HOOKE, LIQUID = ("contact_model", "hooke"), "washino/capillary/viscous"
CHOICES = {
    key: load_schema("settings")["properties"]["solver"]["properties"][key]["enum"]
    for key in ("contact_model", "cohesion", "rolling_friction")
}
ONE_BY_ONE = [{key: model} for key, models in CHOICES.items() for model in models]
SURFACE_TENSION, ANGLE, RADIUS = 0.07, 60.0, 5e-3  # N/m, degrees, m
PROPERTIES = {  # what the models need beside their names
    "characteristic_velocity_m_per_s": 1.0,
    "cohesion_energy_density_j_per_m3": 2e4,
    "wall_cohesion_energy_density_j_per_m3": 4e3,
    "rolling_viscous_damping": 0.3,
    "rolling_stiffness": 3.0,
    "liquid_volume_fraction": 0.05,
    "surface_tension_n_per_m": SURFACE_TENSION,
    "fluid_viscosity_pa_s": 1e-3,
    "contact_angle_deg": ANGLE,
    "least_separation_ratio": 1.01,
    "most_separation_ratio": 1.1,
}
NEEDED = {
    HOOKE: ["characteristic_velocity_m_per_s"],
    ("cohesion", "sjkr"): ["cohesion_energy_density_j_per_m3", "wall_cohesion_energy_density_j_per_m3"],
    ("cohesion", "sjkr2"): ["cohesion_energy_density_j_per_m3", "wall_cohesion_energy_density_j_per_m3"],
    ("cohesion", LIQUID): [
        *("liquid_volume_fraction", "surface_tension_n_per_m", "fluid_viscosity_pa_s", "contact_angle_deg"),
        *("least_separation_ratio", "most_separation_ratio"),
    ],
    ("rolling_friction", "epsd"): ["rolling_viscous_damping"],
    ("rolling_friction", "epsd3"): ["rolling_viscous_damping", "rolling_stiffness"],
}
VARIED = "tester_sensitivity"  # whose rows have a rolling model each
EXACT = 1e-9  # relative: the same arithmetic, printed with 12 digits
TOUCHING = 1e-4  # relative, of a capillary force; the elastic one of an overlap of 1e-12 m is below


def block(**solver):
    """The block of a deck as it is rendered with these settings."""
    study = tiny_study(solver=solver)
    text = bed_deck_text(study.case, study.beds["bed_R5"])
    return text[text.index("# --- contact model") : text.index("# --- geometry")]


def named(text):
    """The words of the contact model in a deck."""
    return re.findall(r'^variable +contact_model string "(.*)"$', text, re.MULTILINE)


# ---------------------------------------------------------------- the block


def test_only_the_block_names_a_contact_model():
    """No other template spells a model: all walls and the pair style take the block's variable."""
    for path in sorted((REPOSITORY / "templates").rglob("*.in.j2")):
        text = path.read_text()
        uses = re.findall(r"(?:wall/gran|pair_style +gran) model (\S+)", text)
        assert set(uses) <= {"${contact_model}"}, path
        assert not re.search(r"hertz|hooke|tangential history", text) or path.name == "contact_model.in.j2", path


@pytest.mark.parametrize("chosen", list(itertools.product(*CHOICES.values())), ids=" ".join)
def test_words_stand_in_the_order_that_the_solver_insists_on(chosen):
    """Normal, tangential, cohesion, rolling model; what is none is not named."""
    normal, cohesion, rolling = chosen
    expected = [normal, "tangential", "history"]
    expected += ["cohesion", cohesion] if cohesion != "none" else []
    expected += ["rolling_friction", rolling] if rolling != "none" else []
    text = block(**dict(zip(CHOICES, chosen, strict=True)), **PROPERTIES)
    assert named(text) == [" ".join(expected)]
    assert text.index("contact_model string") < text.index("pair_style")


def test_defaults_are_the_model_of_old():
    """Neutral defaults add nothing to the block but the variable."""
    lines = [line for line in block().splitlines() if line and not line.startswith("#")]
    assert [line.split()[0] for line in lines] == [
        *("variable", "pair_style", "pair_coeff", "neighbor", "neigh_modify", "timestep")
    ]
    assert named(block()) == ["hertz tangential history rolling_friction own_spin"]


def test_every_setting_that_templates_use_is_in_a_schema():
    """`solver.name` in a template is a key of the settings in SI: a misspelt one is found here."""
    known = set()
    for path in SCHEMA_FOLDER.rglob("settings.schema.yaml"):
        name = path.relative_to(SCHEMA_FOLDER).as_posix().removesuffix(".schema.yaml")
        keys = load_schema(name)["properties"].get("solver", {"properties": {}})["properties"]
        known |= set(to_si(dict.fromkeys(keys, 0.0)))
    for path in (REPOSITORY / "templates").glob("[!_]*/*.in.j2"):
        assert set(solver_settings(path.name.removesuffix(".in.j2"))) <= known


GRAVEL = {key: {"bed": {"material": OF_ANY_MODEL}} for key in ("sliding_sample", "circular_tester")}


@pytest.mark.parametrize(("choice", "missing"), [(c, key) for c, keys in NEEDED.items() for key in keys])
def test_a_property_that_a_model_needs_is_missed_before_the_solver(choice, missing):
    """One sentence names the model, where it stands, and the property with its range."""
    key, model = choice
    given = {name: value for name, value in PROPERTIES.items() if name != missing}
    with pytest.raises(ConfigError) as caught:
        load_study("demo", overrides={"solver": {key: model, **given}, **GRAVEL["sliding_sample"]})
    start = f"command line: solver.{key} is '{model}' for row R5, allowed is one whose properties stand beside it: "
    assert str(caught.value).startswith(f"{start}solver.{missing} (a number ")
    assert str(caught.value).endswith(") is missing.")


@pytest.mark.parametrize(("choice", "needed"), NEEDED.items())
def test_a_model_needs_no_property_of_another(choice, needed):
    """What is listed for a model is all that it needs, in every case."""
    solver = dict([choice]) | {key: PROPERTIES[key] for key in needed}
    names = [name for name in list_studies() if name != VARIED]
    studies = {read_sources(name, current_project(), None).case.name: name for name in names}
    assert set(studies) == set(case_names())
    for case, name in studies.items():
        if choice[0] != "contact_model" or case != "pin_on_disc":
            assert load_study(name, overrides={"solver": solver, **GRAVEL.get(case, {})}).runs


def test_a_pin_is_hertzian():
    """What a pin's overlap determines is Hertz'; another model is refused."""
    with pytest.raises(ConfigError, match=r"solver\.contact_model is 'hooke' for row \S+, allowed is hertz for a pin"):
        load_study("pin_on_disc", overrides={"solver": {"contact_model": "hooke", **PROPERTIES}})


# ---------------------------------------------------------------- beds and runs


def test_a_bed_knows_only_what_its_deck_uses():
    """Settings of pictures, ranks and of models that are not chosen distinguish no beds; those of a chosen model do."""
    bed = tiny_study().beds["bed_R5"]
    assert set(bed["solver"]) == {"rayleigh_fraction", "rolling_radius", *CHOICES}
    for same in ({"ranks": 2}, {"picture_interval_mm": 3}, {"wear_interval_mm": 3}, PROPERTIES):
        assert tiny_study(solver=same).beds["bed_R5"] == bed
    sticky = [tiny_study(solver=PROPERTIES | {"cohesion": "sjkr", **more}) for more in ({}, {"rolling_stiffness": 9.0})]
    assert sticky[0].beds["bed_R5"] == sticky[1].beds["bed_R5"] != bed
    other = tiny_study(solver=PROPERTIES | {"cohesion": "sjkr", "cohesion_energy_density_j_per_m3": 2e5})
    assert other.beds["bed_R5"] != sticky[0].beds["bed_R5"]


# ---------------------------------------------------------------- on the real solver


def collided(folder, **solver):
    """Histories of single collisions with these settings."""
    run = tiny_study(solver=PROPERTIES | solver).runs[0].parameters
    test = {"particle": run["particle"], "wall_material": run["sample_material"], "collision": SPEEDS}
    test |= {"solver": run["solver"], "deck": {}}
    return read_collisions(simulate(test, folder), spheres_of(test), time_step(test))


@pytest.mark.solver
@pytest.mark.parametrize("chosen", [*ONE_BY_ONE, {key: models[-1] for key, models in CHOICES.items()}])
def test_the_solver_takes_every_model(tmp_path, chosen):
    """Spheres collide and part under each model, and under all that is not the default together."""
    histories = collided(tmp_path, **chosen)
    assert len(histories) > 10 and histories["collision"].nunique() == 4


@pytest.mark.solver
def test_models_differ_and_epsd_is_epsd3_of_its_stiffness(tmp_path):
    """No model is another one's name; epsd3 with the rolling stiffness 2.25 of Ai et al. 2011 is epsd."""
    models = [("hertz", "none", rolling) for rolling in CHOICES["rolling_friction"]]
    models += [("hooke", "none", "cdt"), *(("hertz", cohesion, "cdt") for cohesion in CHOICES["cohesion"][1:])]
    found = {}
    for number, model in enumerate(models):
        histories = collided(tmp_path / f"{number}", **dict(zip(CHOICES, model, strict=True)))
        found[model] = histories.select_dtypes("number")
    for one, other in itertools.combinations(found.values(), 2):
        assert len(one) != len(other) or not np.allclose(one, other, rtol=EXACT, atol=0.0)
    same = collided(tmp_path / "same", rolling_friction="epsd3", rolling_stiffness=2.25).select_dtypes("number")
    pd.testing.assert_frame_equal(same, found["hertz", "none", "epsd"], rtol=EXACT)


@pytest.mark.solver
@pytest.mark.parametrize("angle", [0.0, ANGLE])
def test_a_contact_angle_is_the_one_meant(tmp_path, angle):
    """The capillary force of two equal spheres that touch is pi R gamma cos(angle): 2 pi gamma cos R/2."""
    solver = PROPERTIES | {"cohesion": LIQUID, "contact_angle_deg": angle, "rolling_friction": "none"}
    words = bed_contacts(tiny_study(solver=solver).runs[0].parameters, "none")
    parts = [render(part, {name: words[name] for name in template_variables(part)}) for part in (MATERIALS, BLOCK)]
    lines = [
        *("units si", "atom_style granular", "atom_modify map array", "boundary f f f", "newton off"),
        *("communicate single vel yes", "hard_particles yes", "variable skin equal 0.002"),
        *("variable time_step equal 1e-7", "region domain block -0.1 0.1 -0.1 0.1 -0.1 0.1 units box"),
        *("create_box 3 domain", *parts),
        *("create_atoms 1 single 0 0 0 units box", f"create_atoms 1 single {2.0 * RADIUS - 1e-12:.15g} 0 0 units box"),
        f"set group all density 2460 diameter {2.0 * RADIUS}",
        *("fix motion all nve/sphere", "variable force equal fx[1]", "thermo_style custom step v_force", "run 0"),
        'print "Force: $(v_force)"',
    ]
    (tmp_path / "deck.in").write_text("\n".join(lines) + "\n")
    run_deck(tmp_path)
    force = float(re.findall(r"^Force: (\S+)$", (tmp_path / "screen.txt").read_text(), re.MULTILINE)[-1])
    assert force == pytest.approx(math.pi * RADIUS * SURFACE_TENSION * math.cos(math.radians(angle)), rel=TOUCHING)


@pytest.fixture(scope="module")
def worn(tmp_path_factory):
    """A function: wear.csv of the tiny sliding sample with these settings of the solver, simulated once."""
    folder, done = tmp_path_factory.mktemp("worn"), {}

    def table(**solver):
        key = repr(solver)
        if key not in done:
            chain = tiny_chain(tiny_study(solver=PROPERTIES | solver), folder / f"{len(done)}")
            cycles.run_chain(chain)
            done[key] = pd.read_csv(chain.folder / "wear.csv")
        return done[key]

    return table


@pytest.mark.verify
@pytest.mark.solver
@pytest.mark.parametrize(("key", "model"), [*(("cohesion", name) for name in CHOICES["cohesion"][1:]), HOOKE])
def test_a_sample_slides_under_another_model(worn, key, model):
    """A bed, its run-in and two cycles, which begin with restart files, run under the model, and wear otherwise."""
    before, after = worn(), worn(**{key: model})
    assert len(before) == len(after) == 2
    assert (after["sliding_work_J"] > 0).all()
    assert (before["sliding_work_J"] != after["sliding_work_J"]).all()
