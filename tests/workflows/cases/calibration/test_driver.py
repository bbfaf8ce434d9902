"""A calibration from parameters to tables: what is simulated, recommended and repeated."""

import pandas as pd
import pytest

from bulkwear.postproc.inference.loop import packing_seed, posterior
from bulkwear.workflows.cases.calibration.driver import (
    compared_pairs,
    everything_of,
    folders_of,
    pair_of,
    problem_of,
    read_posterior,
    repeat_seeds,
    run_box_sizes,
    run_calibration,
)
from bulkwear.workflows.cases.calibration.responses import FOUND_FIRST, RECOMMENDED, read_measured
from bulkwear.workflows.cases.calibration.simulations import BLOCKED, FOLDERS
from bulkwear.workflows.engine.decks import primes
from tests.support.calibration_study import MEASURED, PAIRS, ROLLING, SLIDING, study


def test_problem_is_what_the_config_says():
    """Parameters, tests, counts and seeds of the calibration are those of the configuration."""
    problem = problem_of(study().runs[0].parameters, MEASURED)
    assert problem.names == [SLIDING, ROLLING] and [test.name for test in problem.tests] == ["shear_box"]
    assert (problem.tests[0].initial, problem.tests[0].most) == (5, 7)
    assert problem.measured["repose_angle_deg"].deviation == 0.9
    assert MEASURED.is_file()


def test_every_packing_is_another_one():
    """Seeds of a calibration and of its repeats lead to other primes in the deck: no packing is simulated twice."""
    run = study().runs[0].parameters
    seeds = [packing_seed(run["calibration"]["seed"], number) for number in range(20)] + repeat_seeds(run)
    drawn = [prime for seed in seeds for prime in primes(seed, 5)]
    assert len(set(drawn)) == len(drawn)


def test_a_parameter_that_a_pair_does_not_have_keeps_the_materials_value():
    """Pairs published for two frictions are compared also where a third parameter is looked for."""
    name = "particle.contact.restitution"
    found = pair_of(pd.read_csv(PAIRS), "calibrated", [SLIDING, name], study().runs[0].parameters)
    assert found[name] == study().materials["particles"]["river_gravel"]["contact"]["restitution"]


def test_a_wall_that_a_pair_does_not_tell_is_that_of_the_tests():
    """Draw-down and wall shear test have steel, the shear box, which is none of them, Perspex; an empty cell of the
    table is no value.
    """
    wall, asked = "wall_material.contact.sliding_friction", {"tests": ["draw_down"]}
    loaded = study(calibration=asked, draw_down={"wall_material": "steel"}, fidelity="standard")
    run, walls = loaded.runs[0].parameters, loaded.materials["walls"]
    pairs = pd.read_csv(PAIRS)
    assert pair_of(pairs, "calibrated", [wall], run)[wall] == walls["steel"]["contact"]["sliding_friction"]
    box = loaded.settings["shear_box"]["wall_material"]
    assert pair_of(pairs, "calibrated", [wall], run, "shear_box")[wall] == walls[box]["contact"]["sliding_friction"]
    empty = pairs.assign(**{SLIDING: float("nan")})
    present = loaded.materials["particles"]["river_gravel"]["contact"]["sliding_friction"]
    assert pair_of(empty, "calibrated", [SLIDING], run)[SLIDING] == present


def test_a_row_names_the_folders_of_its_simulations(done):
    """That of its packing, after those that arches blocked."""
    run, names = done.parameters, done.problem.names
    kept = done.simulations[FOLDERS].str.split()
    assert all(folders[0].startswith("shear_box_") and len(folders) == 1 for folders in kept)
    again = folders_of(done.simulations.assign(**{BLOCKED: 2}), run, names)
    assert [each.split()[0] for each in again] == [folders[0] for folders in kept]
    assert all(len(set(each.split())) == 3 for each in again)


def test_the_recommended_pair_gives_what_was_measured(done):
    """By the formula the recommended pair's angle is the measured one, and it is repeated beside the published pair."""
    angle = done.repeat_means.set_index("pair")["mean"]
    assert angle[RECOMMENDED] == pytest.approx(36.0, abs=0.5)  # within the deviation measured and the surrogate's
    assert set(done.repeats["pair"]) == {FOUND_FIRST, "calibrated", RECOMMENDED}
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
    first = done.repeats[done.repeats["pair"] == FOUND_FIRST].iloc[0]
    assert [first[name] for name in problem.names] == pytest.approx(problem.from_unit(alone.points)[alone.recommended])
    before = done.repeats[done.repeats["pair"] != RECOMMENDED]
    assert known.recommended == posterior(problem, everything_of(problem, table, before)).recommended
    name, index = "shear_angle_deg", known.recommended
    assert known.predicted[name][1][index] < alone.predicted[name][1][index]  # repeats make it surer


def test_a_simulation_counts_once_in_whichever_table_it_stands(done):
    """Where the first pair found is the recommended one, its repeats stand there twice."""
    problem, twice = done.problem, pd.concat([done.repeats, done.repeats.assign(pair=RECOMMENDED)])
    assert len(everything_of(problem, done.simulations, twice)) == len(done.everything)
    assert len(done.everything) == len(done.simulations) + len(done.repeats)


def test_box_sizes_are_all_simulated(formula, tmp_path):
    """Every design row is a box with a mean and a scatter over the seeds."""
    runs = {run.name: run.parameters for run in study().runs}
    table = run_box_sizes(runs, PAIRS, tmp_path, 1)
    assert list(table["row"]) == list(runs) and (table["seeds"] == 2).all()
    assert (table["width_in_diameters"] >= 4.0 - 1e-9).all()


def test_discrepancies_of_the_model_are_given_per_response_or_for_all(tmp_path):
    """A row's own discrepancy, in its unit, comes before the factor that all measurements' deviations have."""
    table = tmp_path / "measured.csv"
    table.write_text(
        "response,value,deviation,model_discrepancy\nshear_angle_deg,36,0.4,\nrepose_angle_deg,33,0.9,1.2\n"
    )
    found = read_measured(table, 3.0)
    assert found["shear_angle_deg"].variance == pytest.approx(0.4**2 + 1.2**2)
    assert found["repose_angle_deg"].variance == pytest.approx(0.9**2 + 1.2**2)
    assert problem_of(study().runs[0].parameters, MEASURED).measured["shear_angle_deg"].discrepancy == 0.8


@pytest.mark.parametrize("measured", [True, False])
def test_what_no_response_tells_is_said(formula, tmp_path, capsys, measured):
    """Wall friction looked for on a shear box alone is not told, and on a wall shear test that was measured it is."""
    wall, kinds = "wall_material.contact.sliding_friction", ["shear_box", "wall_shear"]
    names = [{"name": name, "low": 0.1, "high": 0.7} for name in (SLIDING, wall)]
    counts = {"initial": {"shear_box": 5, "wall_shear": 8}, "most": {"shear_box": 7, "wall_shear": 8}, "repeats": 1}
    run = study(calibration={"parameters": names, **counts}, shear_box={"wall_material": "steel"}).runs[0].parameters
    run = {**run, "calibration": {**run["calibration"], "tests": kinds if measured else kinds[:1]}}
    table = pd.read_csv(MEASURED)[["response", "value", "deviation"]]
    table.loc[len(table)] = ["wall_friction_angle_deg", 20.0, 0.3]
    table.to_csv(tmp_path / "measured.csv", index=False)
    run_calibration(run, tmp_path / "measured.csv", PAIRS, tmp_path, 1)
    said = "".join(capsys.readouterr())
    assert ("wall is not told by any response that was measured" in said) != measured
    assert ("Sliding wear rests on" in said) != measured
