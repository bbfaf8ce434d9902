"""Project and package as two folders: what is found where, what is added, what a process that entered one knows."""

import json
import sys

import pytest

from bulkwear.postproc.wear.laws import LAWS
from bulkwear.workflows.config.design import list_studies, load_study
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.config.schema import case_schema, load_schema
from bulkwear.workflows.engine import case as engine_case
from bulkwear.workflows.engine.cases import case_folders, case_module, case_names, find_case
from bulkwear.workflows.engine.inputs import SIMULATED_FROM, run_digest, simulated_from, surface_from, why_again
from bulkwear.workflows.engine.own_code import code_of_case
from bulkwear.workflows.engine.project import (
    PACKAGE,
    Project,
    current_project,
    enter_project,
    leave_project,
)
from bulkwear.workflows.engine.state import cycle_folder
from bulkwear.workflows.engine.template_files import shown_template
from bulkwear.workflows.engine.templates import template_sources, template_variables
from tests.support.own_project import STUDY, TEMPLATE, own_project

LAW, CASE = "hardened", "dimpled"


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """A process that works in a project of its own; the one of the other tests again when it ends."""
    folder = own_project(tmp_path / "my project")
    monkeypatch.chdir(folder)
    forgotten = (load_schema, case_schema)
    for each in forgotten:
        each.cache_clear()
    yield enter_project(folder)
    leave_project()
    LAWS.pop(LAW)
    engine_case.REGISTERED.pop(CASE, None)
    for module in [name for name in sys.modules if name.startswith(f"{engine_case.CASES_PACKAGE}.{CASE}")]:
        del sys.modules[module]
    for each in forgotten:
        each.cache_clear()


def test_the_package_is_its_own_project():
    """Nothing stands before anything, and paths are as rules write them."""
    assert current_project() == Project(PACKAGE) and current_project().is_package
    assert current_project().substitutes() == []
    assert current_project().folders == (PACKAGE,)


def test_a_file_is_the_project_s_then_the_package_s(mine):
    """Relative in the folder that is worked in, whole elsewhere; one that neither has is the project's to write."""
    assert mine.path("config/materials.yaml") == "config/materials.yaml"
    assert mine.path("config/published/packing.csv") == str(PACKAGE / "config/published/packing.csv")
    assert mine.file("config/none.csv") == mine.folder / "config/none.csv"
    assert {"mine.csv", "screening.csv"} <= set(mine.names("config/designs", ".csv"))
    assert {STUDY, "second", "demo"} <= set(list_studies())


def test_every_file_that_stands_before_one_of_the_package_is_said(mine):
    """In the order of folders: added to the package's, or in its place."""
    for name in ("config/default.yaml", "config/designs/demo.csv", "cases/pin_on_disc/case.py", "laws/archard.py"):
        (mine.folder / name).parent.mkdir(exist_ok=True)
        (mine.folder / name).touch()
    assert mine.substitutes() == [
        "config/default.yaml: this project's, over the package's",
        "config/designs/demo.csv: this project's, not the package's",
        "config/materials.yaml: this project's, over the package's",
        f"{TEMPLATE}: this project's, not the package's",
        "cases/pin_on_disc: this project's, not the package's",
        "laws/archard.py: this project's, not the package's",
    ]


def test_a_file_that_nearly_stands_before_one_of_the_package_is_said(mine):
    """Another folder, another ending, a letter too few; templates and settings with names of their own are not."""
    (mine.folder / "templates/equipment").mkdir(parents=True, exist_ok=True)
    for name in ("machine_end.in.j2", "equipement.in.j2", "equipment.in", "equipment.j2", "mine.in.j2", "notes.md"):
        (mine.folder / "templates/equipment" / name).touch()
    for name in ("defaults.yaml", "material.yml", "ore.yaml", "cases/sliding_sample.yml", "studies/third.yml"):
        (mine.folder / "config" / name).touch()
    said = {sentence.partition(":")[0]: sentence for sentence in mine.astray()}
    assert set(said) == {
        *("templates/equipment/machine_end.in.j2", "templates/equipment/equipement.in.j2"),
        *("templates/equipment/equipment.in", "templates/equipment/equipment.j2"),
        *("config/defaults.yaml", "config/material.yml", "config/cases/sliding_sample.yml"),
        "config/studies/third.yml",
    }
    assert said["config/studies/third.yml"].endswith(": no study, whose file ends with .yaml")
    theirs = "not in place of the package's templates/_shared/machine_end.in.j2, whose name it nearly has"
    assert said["templates/equipment/machine_end.in.j2"].endswith(theirs)
    assert Project(PACKAGE).astray() == []


def test_materials_are_added_and_replaced_whole(mine):
    """A material of the project's stands beside the package's, or for the one of its name."""
    study = load_study(STUDY)
    assert study.materials["particles"]["my_ore"]["density_kg_per_m3"] == 3300.0
    assert {"river_gravel", "my_ore"} <= set(study.materials["particles"]) and "steel" in study.materials["walls"]
    file = mine.folder / "config/materials.yaml"
    file.write_text(file.read_text().replace("my_ore:", "river_gravel:"))
    demo = load_study("demo", overrides={"deck": {"remark": "none"}})
    assert demo.materials["particles"]["river_gravel"]["density_kg_per_m3"] == 3300.0
    assert "physical_shear_modulus_pa" not in demo.materials["particles"]["river_gravel"]
    file.write_text(file.read_text().replace("density_kg_per_m3: 3300", "density_kg_per_m3: 3.3"))
    with pytest.raises(ConfigError, match=r"^config/materials.yaml, line 3: .* allowed is a number from 10 to 30000"):
        load_study("demo")


def test_defaults_of_the_project_lie_over_the_package_s(mine):
    """Key by key; the study is stronger. A fault is told where it stands."""
    (mine.folder / "config/default.yaml").write_text("particle_scale: 3\nwear: {acceleration: 7}\n")
    (mine.folder / "config/cases/sliding_sample.yaml").write_text("sample: {skirt_slope_deg: 5}\n")
    study = load_study("second")
    assert study.settings["wear"]["acceleration"] == 7.0 and study.settings["wear"]["law"] == "archard"
    assert study.settings["particle_scale"] == 4.0 and study.settings["sample"]["skirt_slope_deg"] == 5.0
    (mine.folder / "config/default.yaml").write_text("wear: {acceleration: 0}\n")
    with pytest.raises(ConfigError, match=r"^config/default.yaml, line 1: wear.acceleration is 0, allowed is a number"):
        load_study("second")


def test_a_case_that_extends_another_has_what_that_one_has(mine):
    """Its own schema and defaults besides; page and figures are the other one's."""
    case = find_case(CASE)
    assert CASE in case_names() and "sliding_sample" in case_names()
    assert case_folders(case) == [mine.folder / "cases/dimpled", PACKAGE / "workflows/cases/sliding_sample"]
    assert case_module(case, "page").__name__ == "bulkwear.workflows.cases.sliding_sample.page"
    assert {"dimples", "sample", "bed"} <= set(load_schema("cases/dimpled/settings")["properties"])
    study = load_study(STUDY)
    (run,) = study.runs
    assert run.parameters["dimples"] == {"radius_m": 0.008, "depth_m": 5e-5}
    plain, dimpled = (each.surface_mesh(run.parameters) for each in (find_case("sliding_sample"), case))
    depth = (plain.points - dimpled.points)[:, 2]
    assert 0.9 * 5e-5 < depth.max() <= 5e-5 and depth.min() == 0.0  # a node lies near the middle


def test_a_law_of_the_project_is_one_of_all(mine):
    """Registered under its file's name, with its parameters and their units."""
    assert dict(mine.own_laws) == {LAW: mine.folder / "laws/hardened.py"}
    assert LAW in load_schema("settings")["properties"]["wear"]["properties"]["law"]["enum"]
    with pytest.raises(ConfigError, match=r"wear.parameters.hardening is 11, allowed is a number from 1 to 10"):
        load_study(STUDY, overrides={"wear": {"parameters": {"hardening": 11}}})


def test_runs_hang_on_the_project_s_python(mine):
    """Another line in a law or in a case gives another hash; figures and page do not."""
    study = load_study(STUDY)
    case, (run,) = study.case, study.runs
    bed = study.beds["bed_A"]
    first = run_digest(case, run.parameters, bed)
    assert code_of_case(find_case("sliding_sample")) == {} and set(code_of_case(case)) == {"cases/dimpled/case.py"}
    for name in ("page.py", "figures.py", "plots/map.py"):
        (mine.folder / "cases/dimpled" / name).parent.mkdir(exist_ok=True)
        (mine.folder / "cases/dimpled" / name).write_text("")
    assert run_digest(case, run.parameters, bed) == first
    surface = repr(surface_from(case, run.parameters))
    for name in ("laws/hardened.py", "laws/_helper.py", "cases/dimpled/case.py", "cases/shared.py", "meshes/chute.stl"):
        (mine.folder / name).parent.mkdir(exist_ok=True)
        with open(mine.folder / name, "a") as stream:
            stream.write("# changed\n")
        assert run_digest(case, run.parameters, bed) != first
        first = run_digest(case, run.parameters, bed)
    assert repr(surface_from(case, run.parameters)) != surface


def test_what_a_run_is_simulated_from_now_is_told(mine, tmp_path):
    """The first line of a deck, else the first setting that differs; nothing where nothing was kept."""
    study = load_study(STUDY)
    (run,) = study.runs
    found = simulated_from(study.case, run.parameters, study.beds["bed_A"])
    assert why_again(tmp_path, found) is None
    cycle_folder(tmp_path, 0).mkdir()
    kept = cycle_folder(tmp_path, 0) / SIMULATED_FROM
    kept.write_text("{")
    assert why_again(tmp_path, found) is None
    kept.write_text(json.dumps(found))
    assert why_again(tmp_path, found) is None
    deck = {**found, "decks": [found["decks"][0], found["decks"][1].replace("what the dimples do", "else")]}
    assert why_again(tmp_path, deck) == (
        "its deck of a wear cycle changed, line 119: 'print \"else\"', it was 'print \"what the dimples do\"'"
    )
    longer = {**found, "decks": [found["decks"][0] + "run 1\n", found["decks"][1]]}
    assert why_again(tmp_path, longer).startswith("its deck of cycle 0 changed, line ")
    wear = {**found["settings"]["wear"], "scheme": "per_triangle"}
    other = {**found, "settings": {**found["settings"], "wear": wear}}
    assert why_again(tmp_path, other) == "wear.scheme is per_triangle, it was conserving"


def test_the_project_s_template_wins(mine):
    """By its name, whatever folder it lies in; messages show it from the project's folder, the package's whole."""
    assert "remark" in template_variables("sliding_sample")
    assert shown_template("sliding_sample") == TEMPLATE
    assert shown_template("settled_bed") == str(PACKAGE / "templates/sliding_sample/settled_bed.in.j2")
    (mine.folder / "templates/_shared").mkdir()
    (mine.folder / "templates/_shared/domain.in.j2").write_text("# my domain\n")
    assert template_sources("settled_bed")["_shared/domain.in.j2"] == "# my domain\n"
