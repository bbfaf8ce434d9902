"""A calibration study: what it asks for, what is refused, and that other studies can use what it found."""

import json
import re
import shutil
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest
import yaml
from workflows.cases.calibration.html_page import page_context
from workflows.cases.calibration.results import checked_text, write_results
from workflows.cases.calibration.tables import calibrated_materials, draw_all, read_calibrated
from workflows.report.figures import OF_CALIBRATIONS, page_templates

from postproc.flow.bulk_test import RESPONSES
from postproc.inference.loop import packing_seed, posterior
from workflows.cases.calibration import driver as calibration
from workflows.cases.calibration.case import PUBLISHED
from workflows.cases.calibration.checked_pairs import check_pair
from workflows.cases.calibration.driver import (
    compared_pairs,
    pair_of,
    problem_of,
    read_posterior,
    repeat_seeds,
    run_box_sizes,
    run_calibration,
)
from workflows.cases.calibration.page import page_parameters
from workflows.cases.calibration.responses import RECOMMENDED
from workflows.config.design import REPOSITORY, ConfigError, load_study
from workflows.engine.bulk_simulations import Measurement
from workflows.engine.decks import primes

MEASURED, PAIRS = PUBLISHED / "gravel_tests.csv", PUBLISHED / "gravel_pairs.csv"
TABLES = ("simulations", "looks", "repeats")
SLIDING, ROLLING = "particle.contact.sliding_friction", "particle.contact.rolling_friction"


def study(**overrides):
    """The calibration study with few simulations."""
    few = {"initial": {"shear_box": 5}, "most": {"shear_box": 7}, **overrides.pop("calibration", {})}
    return load_study("calibration", overrides={"fidelity": "quick", "calibration": few, **overrides})


def answers(tests, root, parallel, say):
    """Measurements of a formula in the solver's place: an angle that grows with both frictions."""
    found = []
    for test in tests:
        contact = test["particle"]["contact"]
        angle = 24.0 + 30.0 * contact["sliding_friction"] + 12.0 * contact["rolling_friction"]
        names = RESPONSES[test["kind"]]
        found.append(Measurement(dict.fromkeys(names, angle), dict.fromkeys(names, 0.2), {name: [] for name in names}))
    return found


@pytest.fixture(scope="module")
def formula():
    """Lets a formula stand in for LIGGGHTS."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(calibration, "simulate_all", answers)
        yield


@pytest.fixture(scope="module")
def done(formula, tmp_path_factory):
    """A study's calibration by the formula, as read back from the tables that it wrote."""
    folder, run = tmp_path_factory.mktemp("calibration"), study().runs[0].parameters
    for name, table in zip(TABLES, run_calibration(run, MEASURED, PAIRS, folder, 1), strict=True):
        table.to_csv(folder / f"{name}.csv", index=False)
    return read_calibrated(run, MEASURED, PAIRS, folder)


@pytest.mark.parametrize("fidelity", ["quick", "standard", "paper"])
def test_every_fidelity_loads(fidelity):
    """Each fidelity is a valid study; quick takes the shear box alone, the others both tests."""
    found = load_study("calibration", overrides={"fidelity": fidelity})
    tests = found.runs[0].parameters["calibration"]["tests"]
    assert tests == (["shear_box"] if fidelity == "quick" else ["shear_box", "draw_down"])
    lengths = {run.parameters["shear_box"]["length_m"] for run in found.runs}
    assert len(lengths) == 3  # three sizes of box


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"draw_down": {"length_mm": 20}}, r"draw_down\.length_mm is 20.*allowed is at least 106"),
        ({"draw_down": {"opening_mm": 300}}, r"draw_down\.opening_mm is 300.*allowed is from"),
        (
            {"calibration": {"compared_pair": "nobody"}},
            r"calibration\.compared_pair is 'nobody'.*allowed is one of size-test",
        ),
        ({"calibration": {"most": {"shear_box": 3}}}, r"calibration\.most is .*allowed is for shear_box at least"),
        ({"calibration": {"measured": "none.txt"}}, r"the name of a \.csv file in config/published"),
    ],
)
def test_what_cannot_be_calibrated_is_refused(overrides, words):
    """A fault is one sentence that names the key, the value and what is allowed, before anything is simulated."""
    with pytest.raises(ConfigError, match=words):
        load_study("calibration", overrides={"fidelity": "standard", **overrides})


def test_ranges_must_be_ranges():
    """A low above its high, or a parameter named twice, is refused."""
    for second in ({"name": ROLLING, "low": 0.7, "high": 0.1}, {"name": SLIDING, "low": 0.1, "high": 0.7}):
        parameters = [{"name": SLIDING, "low": 0.1, "high": 0.7}, second]
        with pytest.raises(ConfigError, match=r"calibration\.parameters"):
            study(calibration={"parameters": parameters})


def test_published_data_are_those_of_the_source():
    """The example is that of Yan 2022: four measured responses, six pairs of the draw-down test, the chosen one."""
    measured, pairs = pd.read_csv(MEASURED), pd.read_csv(PAIRS)
    assert dict(zip(measured["response"], measured["value"], strict=True))["shear_angle_deg"] == 36.0
    assert measured["source"].str.contains("Table 3.1").all()
    assert pairs["discharge_time_s"].notna().sum() == 6
    names = [SLIDING, ROLLING]
    assert pair_of(pairs, "calibrated", names, study().runs[0].parameters) == {SLIDING: 0.21, ROLLING: 0.4}


def test_a_parameter_that_a_pair_does_not_have_keeps_the_materials_value():
    """Pairs published for two frictions are compared also where a third parameter is looked for."""
    name = "particle.contact.restitution"
    found = pair_of(pd.read_csv(PAIRS), "calibrated", [SLIDING, name], study().runs[0].parameters)
    assert found[name] == study().materials["particles"]["river_gravel"]["contact"]["restitution"]


def test_the_recommended_pair_gives_what_was_measured(done):
    """By the formula the recommended pair's angle is the measured one, and it is repeated beside the published pair."""
    angle = done.repeat_means.set_index("pair")["mean"]
    assert angle[RECOMMENDED] == pytest.approx(36.0, abs=0.5)  # within the deviation measured and the surrogate's
    assert set(done.repeats["pair"]) == {RECOMMENDED, "calibrated"}
    assert len(done.simulations) <= 7


def test_a_finished_calibration_reads_back_the_same(done):
    """The posterior of the table on disk is that of the run: pairs repeated are those recommended after reading."""
    files = (done.folder / "simulations.csv", done.folder / "repeats.csv")
    problem, table, known = read_posterior(study().runs[0].parameters, MEASURED, *files)
    again = compared_pairs(problem, known, study().runs[0].parameters, pd.read_csv(PAIRS))
    assert again[RECOMMENDED] == pytest.approx(
        dict(done.repeats[done.repeats["pair"] == RECOMMENDED][[SLIDING, ROLLING]].iloc[0])
    )
    alone = posterior(problem, table)
    assert known.recommended == alone.recommended
    name, index = "shear_angle_deg", known.recommended
    assert known.predicted[name][1][index] < alone.predicted[name][1][index]  # its repeats make it surer


def test_box_sizes_are_all_simulated(formula, tmp_path):
    """Every design row is a box with a mean and a scatter over the seeds."""
    runs = {run.name: run.parameters for run in study().runs}
    table = run_box_sizes(runs, PAIRS, tmp_path, 1)
    assert list(table["row"]) == list(runs) and (table["seeds"] == 2).all()
    assert (table["width_in_diameters"] >= 4.0 - 1e-9).all()


def test_statements_and_materials_of_a_calibration(done):
    """The materials file holds the recommended values and their provenance, and is a valid one for another study."""
    text = calibrated_materials(done, study().materials, "calibration")
    found = yaml.safe_load(text)["particles"]["river_gravel"]
    assert found["contact"]["sliding_friction"] == pytest.approx(done.pairs[RECOMMENDED][SLIDING], abs=1e-4)
    assert found["calibrated"]["rolling_radius"] == "full"
    statements = done.statements
    assert set(statements["inside"]) <= {"inside", "within its uncertainty", "outside"}
    at_published = statements.set_index("pair").loc["calibrated"]
    assert at_published["simulated"] == pytest.approx(24.0 + 30.0 * 0.21 + 12.0 * 0.4)


def test_another_study_uses_the_calibrated_materials(done, tmp_path):
    """With its rolling model set alike another study takes the calibrated values; otherwise it is refused."""
    path = tmp_path / "materials.yaml"
    path.write_text(calibrated_materials(done, study().materials, "calibration"))
    with pytest.raises(ConfigError, match=r"solver\.rolling_friction is 'cdt', allowed is epsd2, in which"):
        load_study("demo", REPOSITORY, {"materials": str(path)})
    demo = load_study("demo", REPOSITORY, {"materials": str(path), "solver": {"rolling_friction": "epsd2"}})
    contact = yaml.safe_load(path.read_text())["particles"]["river_gravel"]["contact"]
    assert demo.runs[0].parameters["particle"]["contact"] == contact
    assert "calibrated" not in demo.runs[0].parameters["particle"]


@pytest.fixture(scope="module")
def drawn(done):
    """The same with its figures, sizes of boxes, materials and the state of one simulation beside its tables."""
    folder = done.folder
    (folder / "figures").mkdir()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            "workflows.cases.calibration.tables.heap_pictures", lambda done: ([], pd.DataFrame({"response": []}))
        )
        patch.setattr("workflows.cases.calibration.tables.heaps", lambda pictures, remarks: _empty_figure())
        sizes = run_box_sizes({run.name: run.parameters for run in study().runs}, PAIRS, folder, 1)
        sizes.to_csv(folder / "box_sizes.csv", index=False)
        looks = pd.read_csv(folder / "looks.csv")
        draw_all(done, looks, sizes, pd.read_csv(PUBLISHED / "shear_box_sizes.csv"), ["a remark"])
    (folder / "materials.yaml").write_text("particles: {}\n")
    pd.DataFrame({"solver_s": [3.0, 4.0], "by": "rates of a test"}).to_csv(folder / "forecast.csv", index=False)
    cost = {"steps": 1000, "solver_s": 2.0, "particles": 30}
    made = {"test": {"kind": "shear_box"}, "cost": cost, "solver": "Version LIGGGHTS-PUBLIC 3.8.0, compiled once"}
    state_file = folder / calibration.SIMULATIONS / "shear_box_0" / "cycle_000" / "state.json"
    state_file.parent.mkdir(parents=True)
    state_file.write_text(json.dumps(made))
    return done


def test_page_tells_every_response(drawn):
    """Figures and page are made of the tables alone; what was measured but not simulated is said to be so."""
    figures = drawn.folder / "figures"
    assert all((figures / f"{name}.{kind}").is_file() for name in OF_CALIBRATIONS for kind in ("png", "csv"))
    assert all(Path(template).is_file() for template in page_templates(study()))
    shown = page_context(drawn, page_parameters(study(), ["a remark"]))
    assert shown["forecast"] == {"solver_s": 7.0, "by": "rates of a test"}
    assert any("Angle of repose" in sentence and "not simulated" in sentence for sentence in shown["said"])
    assert len(shown["figures"]) == len(OF_CALIBRATIONS) and len(shown["statements"]) == 2


def test_findings_are_written_from_the_tables(drawn, tmp_path):
    """The page in docs names date, version and scale, and holds pictures and simulations beside it."""
    write_results(drawn.folder, tmp_path, study())
    page = (tmp_path / "calibration_results.md").read_text()
    assert "LIGGGHTS-PUBLIC 3.8.0, page" in page and "particles at scale 5" in page
    assert all(
        (tmp_path / found).is_file() for found in re.findall(r"\]\((calibration_(?!results)\w+\.(?:png|csv))\)", page)
    )
    assert len(pd.read_csv(tmp_path / "calibration_simulations.csv")) == len(drawn.simulations)


def test_a_found_pair_is_checked_in_another_test(done, formula, tmp_path):
    """A pair is simulated in a test that the calibration left out; asked again, no row stands twice."""
    run = study(calibration={"tests": ["draw_down"], "repeats": 2}, fidelity="standard").runs[0].parameters
    shutil.copy(done.folder / "repeats.csv", tmp_path)
    check_pair(run, RECOMMENDED, tmp_path, 1)
    table = check_pair(run, RECOMMENDED, tmp_path, 1)
    assert len(table) == 2 and (table["particle_scale"] == 4.0).all()
    assert table[SLIDING].iloc[0] == pytest.approx(done.pairs[RECOMMENDED][SLIDING])
    with pytest.raises(ValueError, match="no pair 'nobody', there are recommended, calibrated"):
        check_pair(run, "nobody", tmp_path, 1)


def test_only_packings_of_one_pair_and_test_are_averaged(done, tmp_path):
    """Rows of another value of the pair, or of another width, have means of their own: 35, 37 and 39."""
    marks = {"pair": RECOMMENDED, "test": "draw_down", "particle_scale": 4.0}
    rows = [(1, 43.0, 0.38, 35.0), (1, 60.0, 0.38, 37.0), (1, 60.0, 0.42, 39.0), (2, 60.0, 0.42, 39.0)]
    table = pd.DataFrame(rows, columns=["seed", "width_mm", SLIDING, "shear_angle_deg"]).assign(**marks)
    table.assign(**{ROLLING: 0.2, "shear_angle_deg_uncertainty": 1.0}).to_csv(
        tmp_path / "checked_pairs.csv", index=False
    )
    lines = checked_text(SimpleNamespace(folder=tmp_path, problem=done.problem)).splitlines()
    means = [line.split("|") for line in lines if line.startswith(f"| {RECOMMENDED} | shear angle deg")]
    assert [[cell.strip() for cell in cells[3:5]] for cells in means] == [["1", "35"], ["1", "37"], ["2", "39"]]


def _empty_figure():
    from matplotlib.figure import Figure

    return Figure()


def test_problem_is_what_the_config_says():
    """Parameters, tests, counts and seeds of the calibration are those of the configuration."""
    problem = problem_of(study().runs[0].parameters, MEASURED)
    assert problem.names == [SLIDING, ROLLING] and [test.name for test in problem.tests] == ["shear_box"]
    assert (problem.tests[0].initial, problem.tests[0].most) == (5, 7)
    assert problem.measured["repose_angle_deg"].deviation == 0.9
    assert Path(MEASURED).is_file()


def test_every_packing_is_another_one():
    """Seeds of a calibration and of its repeats lead to other primes in the deck: no packing is simulated twice."""
    run = study().runs[0].parameters
    seeds = [packing_seed(run["calibration"]["seed"], number) for number in range(20)] + repeat_seeds(run)
    drawn = [prime for seed in seeds for prime in primes(seed, 5)]
    assert len(set(drawn)) == len(drawn)
