"""The page of a study of equipment, from folders as the engine leaves them: its sections, and any rows of it."""

import html
import json
import shutil
from contextlib import contextmanager
from dataclasses import replace

import pandas as pd
import pytest

from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.workflows.cases.equipment import heads, page, page_blocks
from bulkwear.workflows.cases.equipment.machine_tables import change_out_words, laws_of_parts, parts_table
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.report.markdown_text import written
from bulkwear.workflows.report.page import write_page
from bulkwear.workflows.report.page_parameters import page_parameters
from bulkwear.workflows.report.products import (
    job_of,
    outputs_of,
    paths_of,
    products_of_study,
    told_to,
    write_product,
)
from bulkwear.workflows.report.sections import Pictures, Points, Text
from bulkwear.workflows.report.text import simplifications
from bulkwear.workflows.report.verdict import verdict, with_verdict
from tests.support.own_machine_project import FASTER, ORE, TINY, machine_study
from tests.workflows.cases.equipment.synthetic import SyntheticPart, SyntheticRun, write_study

ROWS = "row,inlet.rate_t_per_h\nslow,1.5\nfast,3\n"
PARTS = (
    SyntheticPart("liner", (1e-6, 3e-6), worn=1.2, thickness=0.01, error=0.2),
    SyntheticPart("plate", (1e-6,), error=0.3),
    SyntheticPart("paddle", (2e-6, 1e-6), power=100.0, error=0.3),
    SyntheticPart("hood", force=10.0),
)
SECTIONS = [
    *("When what has to be changed", "The machine", "Flow", "Where it wears", "Impact and sliding"),
    *("The worn shape", "Designs side by side", "Steel lost", "Balance of particles"),
]
ANCHORS = """\
study,quantity,value,low,high,unit,source,note,reason
machine,life_liner,3000,,,h,a handbook,of another ore,worn by finer grains
mill,power_W_shell_pristine,1,,,W,a mill,,
"""
MILL = {  # changes of the study: a filled machine that nothing is fed to
    "inlet": None,
    "outlets": None,
    "filling": {"fraction": 0.3, "axis": "y", "centre_mm": [0, 0, 100], "radius_mm": 80, "length_mm": 80},
}


def run_of(study, run, **given):
    """The synthetic run that stands for a run of a study; twice the feed wears twice as fast."""
    inlet = run.parameters["inlet"]
    rate = inlet["rate_kg_per_s"] if inlet else None
    packing = study.packing_of[run.row]
    factor = (rate or 1.0) * (1.0 + 0.02 * packing)
    worn = {part["name"] for part in run.parameters["parts"] if part["wears"]}
    parts = [part if part.name in worn else SyntheticPart(part.name, force=10.0) for part in PARTS]
    held = {"rate": rate, "held": 0.2, "pristine": 4, **given}
    return SyntheticRun(run.name, parts, study.setting_of[run.row], packing, factor=factor, duration=0.15, **held)


def make(study, folder, name):
    """Make a product of a study and write its tables."""
    product = products_of_study(study)[name]
    outputs = {key: folder.parents[1] / path for key, path in outputs_of(product, study.name).items()}
    for path in outputs.values():
        path.parent.mkdir(parents=True, exist_ok=True)
    files = {key: paths_of(source, study) for key, source in product.inputs.items()}
    write_product(product, job_of(files, told_to(product, study), []), outputs)


def write_charge(study, folder):
    """Write the table beside the figure of a mill's charge, as if it was drawn."""
    (folder / "figures").mkdir()
    rows = [{"setting": study.setting_of[run.row], "packing": study.packing_of[run.row]} for run in study.runs]
    charge = pd.DataFrame(rows).assign(phase="pristine", toe_deg=130.0, shoulder_deg=300.0)
    charge.to_csv(folder / "figures" / "charge_shape.csv", index=False)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Folders of results by what they are of, each made once; tests get copies."""
    return {}, tmp_path_factory.mktemp("results")


@pytest.fixture
def finished(tmp_path, monkeypatch, results):
    """A study with all tables, made of synthetic runs; given: of those runs; chosen: rows, all without."""

    @contextmanager
    def made(rows=ROWS, given=None, chosen=(), **changes):
        root = tmp_path / "".join(chosen)
        with machine_study(root, rows, **changes) as whole:
            study = load_study(whole.name, overrides={"rows": list(chosen)}) if chosen else whole
            monkeypatch.chdir(root)
            (root / "config/published").mkdir(exist_ok=True)
            (root / "config/published/equipment_anchors.csv").write_text(ANCHORS)
            kept, folder = results
            name = kept.setdefault(repr((rows, given, chosen, changes)), str(len(kept)))
            if not (folder / name).exists():
                write_tables(study, root / "results" / study.name, given or {})
                shutil.copytree(root / "results", folder / name)
            shutil.copytree(folder / name, root / "results", dirs_exist_ok=True)
            yield study, root / "results" / study.name

    return made


def write_tables(study, folder, given):
    """Write the folders of all runs and the tables of a study."""
    write_study(folder, [run_of(study, run, **given) for run in study.runs])
    pd.DataFrame(study.design_table()).to_csv(folder / "design.csv", index=False)
    wear = [folder / run.name / "wear.csv" for run in study.runs]
    study.case.summary(folder / "design.csv", wear, [], []).to_csv(folder / "summary.csv", index=False)
    make(study, folder, "equipment_tables")
    if "charge_shape" in products_of_study(study):
        write_charge(study, folder)
        make(study, folder, "lifters")
    make(study, folder, "beside_published")


def sections_of(study, folder):
    """The sections of its page by title, each as the text of the page in docs."""
    found = with_verdict(page_parameters(study), folder)
    return {each.title: "\n".join(written(block, study.name) for block in each.blocks) for each in found}


def test_sections_and_answers(finished):
    """The verdict says when each part of each design is changed; the answers of the command line are the same."""
    with finished(packings=2) as (study, folder):
        found = page.sections(page_parameters(study), folder)
        assert [each.title for each in found] == [*SECTIONS, "Beside published values"]
        points = next(block for block in verdict(page_parameters(study), folder).blocks if isinstance(block, Points))
        for setting in ("slow", "fast"):
            for part in ("liner", "plate", "paddle"):
                words = f"Design {setting}: the {part} has to be changed after"
                assert any(words in item for item in (*points.items, *points.folded))
        answers = page.answers(folder)
        assert answers == [*points.items, *points.folded][: len(answers)]


def test_every_figure_has_a_section(tmp_path):
    """None is left over for the section of further figures, and none stands twice; mills have all."""
    with machine_study(tmp_path, **MILL) as study:
        figures = {name for name, product in products_of_study(study).items() if product.is_figure}
    assert "lifter_profiles" in figures
    named = [
        *(*page.LIFE_FIGURES, *page.FLOW_FIGURES, *page.WEAR_FIGURES, *page.LOAD_FIGURES, *page.WORN_FIGURES),
        *page.LIFTER_FIGURES,
    ]
    assert len(named) == len(set(named)) and figures <= set(named)


def test_one_design_and_one_packing(finished):
    """Nothing is compared, no design is named, and the scatter is unknown."""
    with finished(rows="row\nA\n") as (study, folder):
        found = sections_of(study, folder)
    assert "Designs side by side" not in found
    first = found["Verdict"]
    assert "The liner has to be changed after" in first and UNKNOWN in first and "Design A" not in first


def test_choice_of_rows(finished):
    """A choice of rows has its page as the whole design has."""
    with finished(packings=2, chosen=["fast"]) as (study, folder):
        assert {run.row for run in study.runs} == {"fast", "fast-2"}
        found = sections_of(study, folder)
    assert set(found) == {"Verdict", *SECTIONS, "Beside published values"} - {"Designs side by side"}


def test_machine_without_feed(finished):
    """A filled one has no t/h and no Mt; its flow is what it holds."""
    with finished(rows="row\nA\n", **MILL) as (study, folder):
        found = sections_of(study, folder)
        told = page.run_columns(next(iter(page_parameters(study)["parameters"].values())))
        numbers = pd.read_csv(folder / "equipment/key_numbers.csv").set_index("quantity")["value"]
    assert " Mt" not in found["Verdict"] and "t/h come in" not in " ".join(found.values())
    assert told["feed_t_per_h"] is None and numbers["toe_pristine"] == 130.0
    assert numbers["load_angle_pristine"] == 35.0


def test_lifters_of_a_mill(finished):
    """Their table stands after the worn shape; parts that turn without lifters have no rows, and the page no table."""
    with finished(rows="row\nA\n", **MILL) as (study, folder):
        none = pd.read_csv(folder / "equipment/lifters.csv")
        assert none.empty and "leading face" not in sections_of(study, folder).get("Lifters", "")
        rows = {"setting": "A", "part": "paddle", "operation_h": [0.0, 300.0], "packings": 1, "lifters": 8}
        values = {name: 40.0 for name in none.columns.difference(list(rows))}
        pd.DataFrame(rows | values | {"height_mm": [65.25, 51.5]}).to_csv(folder / "equipment/lifters.csv", index=False)
        make(study, folder, "beside_published")
        numbers = pd.read_csv(folder / "equipment/key_numbers.csv").set_index("quantity")["value"]
        found = sections_of(study, folder)
    titles = list(found)
    assert titles[titles.index("Lifters") - 1] == "The worn shape"
    assert "65.2" in found["Lifters"] and "leading face" in found["Lifters"]
    assert numbers["lifter_height_paddle_pristine"] == 65.25 and numbers["lifter_height_paddle_worn"] == 51.5


def test_shape_as_built_alone(finished):
    """Without updates nothing is told of a worn shape, and lives are by the rate as built."""
    given = {"updates": 0, "worn": 0}
    with finished("row\nA\n", given, updates={"most": 0, "worn_blocks": 0}, parts=FASTER) as (study, folder):
        found = sections_of(study, folder)
    assert "The shape was kept as built" in found["The worn shape"]
    assert "That is by the rate as built" in found["Verdict"]


def test_beside_published_values(finished, tmp_path):
    """Rows of the study alone, with the difference; a study without any has no such section."""
    with finished(rows="row\nA\n") as (study, folder):
        said = sections_of(study, folder)["Beside published values"]
        assert "of another ore" in said and "worn by finer grains" in said
        table = pd.read_csv(folder / "equipment/anchors.csv")
        life = pd.read_csv(folder / "equipment/life.csv").set_index("part").loc["liner", "life_h"]
        assert table["quantity"].tolist() == ["life_liner"]
        assert table["difference_percent"].iloc[0] == pytest.approx(100.0 * (life / 3000.0 - 1.0), rel=1e-6)
        (tmp_path / "config/published/equipment_anchors.csv").write_text(ANCHORS.splitlines()[0] + "\n")
        make(study, folder, "beside_published")
        assert "Beside published values" not in sections_of(study, folder)


def test_what_is_simplified_has_the_numbers_of_the_study(finished):
    """Sizes, scale, errors and patches; the words on wear have the coefficients of the parts."""
    with finished(rows="row\nA\n") as (study, folder):
        said = dict(simplifications(page_parameters(study), pd.read_csv(folder / "summary.csv"), page))
    assert said["Coarse-grained particles"].startswith("Spheres of 9.6 to 14.4 mm, 4 times the real ones")
    assert "20 to 30 %" in said["Wear coefficient"] and "60 mm" in said["Patches"]
    assert "coefficient 6.3e-13 1/Pa" in said["Wear law"] and "coefficient 1e-12 1/Pa" in said["Wear law"]
    assert "It is the law of the plate." in said["Wear law"] and "LIGGGHTS' Finnie differs" not in said


def test_laws_have_the_coefficients_of_their_parts():
    """Not the one of the section `wear`, which no part may have; parts of a law that differ have their range."""
    of_part = {"wears": True, "law": "archard", "law_parameters": {}}
    parts = [of_part | {"name": name, "wear_coefficient_per_pa": 1e-12 * k} for name, k in (("liner", 2), ("lip", 3))]
    parts.append(of_part | {"name": "hood", "wears": False, "wear_coefficient_per_pa": 6.3e-13})
    run = {"parts": parts, "wear": {"wear_coefficient_per_pa": 6.3e-13}}
    ((law, said),) = laws_of_parts([run]).items()
    assert law == "archard" and "coefficient 2e-12 to 3e-12 1/Pa" in said and said.endswith("in the table of parts.")
    threshold = {"rolling_ratio": 0.0, "impact_ratio": 0.5, "threshold_velocity_m_per_s": 0.2}
    known = {"wall_hardness_pa": 2e9, "wear_coefficient_k": 4e-3}
    parts[1] |= {"law": "combined", "law_parameters": threshold, **known}
    said = laws_of_parts([run])
    assert list(said) == ["archard", "combined"] and "6.3e-13" not in "".join(said.values())
    assert "0.5 m (v - 0.2 m/s)" in said["combined"] and "hardness 2e+09 Pa" in said["combined"]
    assert said["archard"].endswith("the law of the liner.") and said["combined"].endswith("the law of the lip.")


def test_nothing_is_said_of_caps_where_no_shape_was_worn(tmp_path):
    """There is no share of a volume that nothing was worn by."""
    kept = pd.DataFrame({"carried_volume_m3": [0.0], "worn_volume_m3": [0.0]})
    with machine_study(tmp_path, updates={"most": 0}, parts=FASTER) as study:
        said = dict(simplifications(page_parameters(study), kept, page))
        assert "Capped steps" not in said and "The shape is kept as built." in said["Hours from seconds"]
        both = pd.concat([kept, kept.assign(carried_volume_m3=1.0, worn_volume_m3=4.0)])
        assert "25 %" in dict(simplifications(page_parameters(study), both, page))["Capped steps"]
        rounded = kept.assign(carried_volume_m3=-1e-18, worn_volume_m3=4.0)
        assert dict(simplifications(page_parameters(study), rounded, page))["Capped steps"].endswith("nothing is left.")


def test_parts_that_are_changed_by_rules_of_their_own_are_named(tmp_path):
    """Parts of one rule together; of one rule for all a single sentence."""
    with machine_study(tmp_path) as study:
        run = study.runs[0].parameters
    assert change_out_words(run) == ["A part is changed at its worst place: 2 mm left."]
    own = {"plate": {"change_out_remaining_m": 0.005}, "paddle": {"change_out_worn_mass_fraction": 0.3}}
    parts = [part | own.get(part["name"], {}) for part in run["parts"]]
    assert change_out_words({**run, "parts": parts}) == [
        "The liner is changed at its worst place: 2 mm left.",
        "The plate is changed at its worst place: 5 mm left.",
        "The paddle is changed by its mass: 30 % of the mass worn.",
    ]
    alike = [part | own["plate"] if part["name"] in ("plate", "liner") else part for part in run["parts"]]
    assert change_out_words({**run, "parts": alike}) == [
        "Each of liner and plate is changed at its worst place: 5 mm left.",
        "The paddle is changed at its worst place: 2 mm left.",
    ]


@pytest.mark.parametrize(
    ("most", "said"), [(0, "The shape is kept as built."), (1, "In up to 1 update a "), (6, "In up to 6 updates a ")]
)
def test_updates_are_counted_in_words(most, said):
    """One, several, and none."""
    assert page.update_words(most).startswith(said)


def test_designs_of_different_settings_are_told_apart(tmp_path):
    """Bulk material, hours, updates and patches that are columns of the design are those of its rows."""
    rows = "row,bulk.material,operation.duration_h,updates.most,sampling.patch_mm\nA,,,,\nB,sand,800,0,70\n"
    machine = replace(TINY, materials={"particles": {"ore": ORE, "sand": ORE}})
    with machine_study(tmp_path, rows, machine, parts=FASTER) as study:
        machines = {run.name: run.parameters for run in study.runs}
        said = dict(page.simplifications(page_parameters(study)))
    assert page_blocks.materials_words(machines) == "Ore in A and sand in B"
    first, second = page_blocks.operations(machines)
    assert first.startswith("Design A: ") and "400 h of operation are asked for" in first
    assert second.startswith("Design B: ") and "800 h of operation are asked for" in second
    assert "In some designs the shape is kept as built. In up to 2 updates" in said["Hours from seconds"]
    assert "about 60 to 70 mm" in said["Patches"]
    alike = {"A": machines["A"], "C": machines["A"]}
    assert page_blocks.materials_words(alike) == "Ore" and len(page_blocks.operations(alike)) == 1


def test_what_updates_stood_for():
    """One update or several; large shares without an exponent."""
    summary = pd.DataFrame(
        {"wearing_cycles": [1], "operation_h": [12345.0], "carried_volume_m3": [9.96], "worn_volume_m3": [10.0]}
    )
    said = page_blocks.acceleration_words(summary, [0.5])
    assert said.startswith("The shape was worn in 1 update per run, for 12,300 h of operation. A block of 0.5 s")
    assert " up to 100 % of the volume" in said
    several = pd.concat([summary, summary.assign(wearing_cycles=3)])
    assert "in 1 to 3 updates per run" in page_blocks.acceleration_words(several, [0.5])


SIEVES = {"sieve_mm": [1, 2, 4, 8], "fraction": [0, 0.3, 0.7, 1]}


def test_sentences_end_once(tmp_path):
    """Sizes by sieves are told in sentences of their own."""
    with machine_study(tmp_path, bulk={"passing": SIEVES}) as study:
        run = study.runs[0].parameters
    texts = [block.text for block in page_blocks.machine({"A": run}) if isinstance(block, Text)]
    assert len(texts) == 1 and texts[0].endswith(" mm.") and ".." not in texts[0]


def test_whole_page(finished):
    """The page is written with every section and what is told of the runs."""
    with finished(packings=2) as (study, folder):
        told = page_parameters(study) | {"figures": {}}
        (folder / "logs").mkdir()
        for job in told["jobs"]:
            (folder / "logs" / f"{job}.benchmark.tsv").write_text("s\th:m:s\n2.0\t0:00:01\n")
        jobs = {"job": [f"worn_run_{run.name}" for run in study.runs], "solver_s": 1.0, "by": "rates of a test"}
        pd.DataFrame(jobs).to_csv(folder / "forecast.csv", index=False)
        for run in study.runs:
            (folder / run.name / "cycle_001" / "log.liggghts").write_text("LIGGGHTS (Version LIGGGHTS-PUBLIC 3.8.0)\n")
            cost = {"cycle": [0], "solver_s": 1.0, "other_s": 1.0, "steps": 1000, "particles": 500}
            pd.DataFrame(cost).to_csv(folder / run.name / "cost.csv", index=False)
        write_page(folder / "report.html", json.loads(json.dumps(told)))
        text = html.unescape((folder / "report.html").read_text(encoding="utf-8"))
    for title in SECTIONS:
        assert f">{title}</h2>" in text
    assert "has to be changed after" in text and "turns at 60 rpm about (0, 1, 0)" in text


def test_numbers_for_people():
    """Large ones are whole, zeros of lengths are 0, and small ones of other units stay as they are."""
    table = pd.DataFrame({"life_h": [68523.4, 12.345], "x_mm": [4e-16, 3.0], "value": [6.3e-13, 1.0]})
    found = heads.readable(table)
    assert found["life_h"].tolist() == [68500.0, 12.345]
    assert found["x_mm"].tolist() == [0.0, 3.0] and found["value"].tolist() == [6.3e-13, 1.0]


def test_nothing_is_said_twice(finished):
    """A sentence of the answers stands in no other section."""
    with finished(packings=2) as (study, folder):
        found = page.sections(page_parameters(study), folder)
    texts = [item for each in found for block in each.blocks for item in getattr(block, "items", ())]
    assert len(texts) == len(set(texts))


def test_equal_parts_of_designs_stand_once(tmp_path):
    """Also those whose thickness is not given; where all parts are equal no design is named."""
    with machine_study(tmp_path, "row,parts.plate.role\nA,\nB,rigid\n") as study:
        table = parts_table({run.name: run.parameters for run in study.runs})
    assert table.groupby("part")["setting"].apply(list).to_dict() == {
        **{name: ["A, B"] for name in ("liner", "paddle", "hood")},
        "plate": ["A", "B"],
    }
    with machine_study(tmp_path, ROWS) as study:
        assert "setting" not in parts_table({run.name: run.parameters for run in study.runs})


def test_choices_of_designs_with_other_parts_that_wear(finished):
    """A part that wears in the second design alone: any choice of rows has its page, and only what both have is
    compared.
    """
    rows = "row,parts.plate.role\nA,rigid\nB,\n"
    for chosen in (["A"], ["B"], ["A", "B"]):
        with finished(rows=rows, chosen=chosen) as (study, folder):
            found = sections_of(study, folder)
            said = found["When what has to be changed"]
            assert ("the plate is changed" in said) == ("B" in chosen) and "the liner is changed" in said
            assert ("Designs side by side" in found) == (len(chosen) == 2)


def test_pictures_stand_in_their_sections(finished):
    """The map of wear stands with the worst places, sections through them with the worn shape."""
    with finished(rows="row\nA\n") as (study, folder):
        found = page.sections(page_parameters(study), folder)
    names = {each.title: block.names for each in found for block in each.blocks if isinstance(block, Pictures)}
    assert "wear_map" in names["Where it wears"] and "profile_sections" in names["The worn shape"]
