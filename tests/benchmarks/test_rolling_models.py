"""Rolling models beside what the source simulated: what is simulated, differences, the sentence, page and figure."""

import json
import sys

import numpy as np
import pandas as pd
import pytest

from benchmarks import rolling_models
from benchmarks.rolling_case import CALIBRATED, KINDS, MODELS, PLATE, SETTINGS, pairs_of, wanted
from benchmarks.rolling_models import finished, main, parser_of, publish, simulated
from benchmarks.rolling_page import (
    by_pair,
    differences,
    nearest,
    of_shared_pairs,
    restless,
    results_page,
    summary,
    trend,
    wall_friction,
)
from bulkwear.postproc.flow.bulk_test import Measurement
from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.workflows.cases.calibration.boxes import WALL_SHEAR
from bulkwear.workflows.cases.calibration.case import pairs_file
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.bulk_simulations import simulation_folder
from bulkwear.workflows.engine.bulk_tests import filled_mass
from bulkwear.workflows.engine.solver import SolverError
from bulkwear.workflows.engine.state import only_driver

STUDENT_95_1 = 12.7062  # two-sided 95 % point of Student's t with one degree of freedom; tables
OFF = {"cdt": -6.0, "epsd2": -3.0, "own_spin": 0.5, "rvd": 4.0}  # degrees, that these models are off by


@pytest.fixture(scope="module")
def published():
    return pd.read_csv(pairs_file(load_study("calibration")))


def runs_off_by(published, packings=2, spread=1.0):
    """Simulations whose shear angle in the draw-down test is off by OFF, packings apart by `spread`."""
    known = published.dropna(subset=["draw_down_shear_angle_deg"])
    return pd.DataFrame(
        {"model": model, "test": "draw_down", "pair": row.row, "packing": packing}
        | {"draw_down_shear_angle_deg": row.draw_down_shear_angle_deg + off + spread * (packing - 1.5)}
        for model, off in OFF.items()
        for row in known.itertuples()
        for packing in range(1, packings + 1)
    )


def test_every_published_pair_is_simulated_under_every_model(published):
    """In the tests of which the source prints a response, with its frictions and our four models; a packing of all
    comes before the next one, the calibrated pair of Table 3.6 in all tests before the others."""
    rows = wanted(2)
    assert {row["pair"] for row in rows[: len(KINDS) * len(MODELS)]} == {CALIBRATED}
    assert {row["model"] for row in rows} == set(MODELS) == set(SETTINGS)
    assert [row["packing"] for row in rows] == sorted(row["packing"] for row in rows)
    assert len(rows) == 2 * len(MODELS) * sum(len(pairs_of(published, kind)) for kind in KINDS)
    assert pairs_of(published, WALL_SHEAR) == [CALIBRATED]
    for row in rows:
        asked = row["asked"]
        of = published.set_index("row").loc[row["pair"]]
        contact = asked["particle"]["contact"]
        assert asked["kind"] == row["test"] and asked["solver"]["rolling_friction"] == row["model"]
        assert contact["sliding_friction"] == row["sliding_friction"] == of["particle.contact.sliding_friction"]
        assert contact["rolling_friction"] == row["rolling_friction"] == of["particle.contact.rolling_friction"]
        plate = asked["wall_material"]["contact"]["sliding_friction"] if row["test"] == WALL_SHEAR else None
        assert row.get(PLATE) == plate
    assert len({row["asked"]["seed"] for row in rows}) == 2


def test_pairs_are_chosen_by_name_on_the_command_line(published, capsys):
    assert parser_of(published).parse_args(["--pairs", CALIBRATED, "size-test"]).pairs == [CALIBRATED, "size-test"]
    with pytest.raises(SystemExit):
        parser_of(published).parse_args(["--pairs", "none"])
    assert CALIBRATED in capsys.readouterr().err


def test_pairs_and_tests_are_chosen():
    rows = wanted(3, ["cdt"], ["shear_box"], [CALIBRATED])
    assert [(row["model"], row["test"], row["pair"], row["packing"]) for row in rows] == [
        ("cdt", "shear_box", CALIBRATED, packing) for packing in (1, 2, 3)
    ]


def test_what_is_finished_is_read_beside_who_simulates(tmp_path, monkeypatch):
    """Without waiting for them, which would never end here."""
    monkeypatch.setattr(rolling_models, "answer_of", lambda test, *_: {"repose_angle_deg": 30.0})
    rows = wanted(1, ["own_spin"], ["draw_down"], [CALIBRATED])
    with only_driver(tmp_path, print):
        assert simulated(rows, tmp_path, 1, alone=False)["repose_angle_deg"].tolist() == [30.0]


def test_what_boxes_were_filled_with_is_told(tmp_path, monkeypatch, published):
    """By model and test, of simulations that recorded it; a table without is a page without."""
    monkeypatch.setattr(rolling_models, "answer_of", lambda test, *_: {"repose_angle_deg": 30.0})
    rows = wanted(2, ["own_spin"], ["draw_down"], [CALIBRATED])
    for row, higher in zip(rows, (1.1, 1.2), strict=True):
        folder = state.cycle_folder(simulation_folder(row["asked"], tmp_path), 0)
        folder.mkdir(parents=True)
        filling = {"mass": filled_mass(row["asked"]), "level": higher * row["asked"]["box"]["fill_height_m"]}
        (folder / state.STATE).write_text(json.dumps({"test": row["asked"], "filling": filling}))
    table = simulated(rows, tmp_path, 1)
    assert (table["level_found_mm"] / table["level_asked_mm"]).tolist() == pytest.approx([1.1, 1.2])
    page = results_page(table, published)
    assert "## Fillings" in page and "| own spin | draw down | " in page
    assert "## Fillings" not in results_page(table.drop(columns="mass_found_kg"), published)


def test_what_was_not_asked_for_stays_in_the_table(tmp_path, monkeypatch):
    """A table outlives the folder of its simulations."""
    monkeypatch.setattr(rolling_models, "answer_of", lambda test, *_: {"shear_angle_deg": 33.0})
    earlier = pd.DataFrame({"model": ["cdt"], "test": "draw_down", "pair": CALIBRATED, "packing": 1})
    file = tmp_path / rolling_models.FILE
    earlier.assign(repose_angle_deg=31.0, simulated_by="commit a").to_csv(file, index=False)
    given = ["--tests", "shear_box", "--models", "cdt", "--pairs", CALIBRATED, "--packings", "2"]
    monkeypatch.setattr(sys, "argv", ["models", *given, "--folder", str(tmp_path / "runs"), "--output", str(tmp_path)])
    main()
    table = pd.read_csv(file)
    assert table["test"].tolist() == ["draw_down", "shear_box", "shear_box"]
    assert table["repose_angle_deg"].tolist()[0] == 31.0 and table["simulated_by"].tolist()[0] == "commit a"


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (["--finished"], "none asked for is finished"),
        (["--tests", WALL_SHEAR, "--pairs", "size-test"], "none are both"),
    ],
)
def test_nothing_to_tell_leaves_the_table(tmp_path, monkeypatch, capsys, given, words):
    monkeypatch.setattr(sys, "argv", ["models", *given, "--folder", str(tmp_path), "--output", str(tmp_path)])
    with pytest.raises(SystemExit):
        main()
    assert words in capsys.readouterr().err and not list(tmp_path.iterdir())


def test_a_test_that_never_rests_does_not_end_the_others(tmp_path, monkeypatch):
    """It is told, kept and not tried again; another fault of the solver ends the benchmark."""
    rows, tried = wanted(1, ["cdt", "own_spin"], ["draw_down"], [CALIBRATED]), []

    def simulate(test, *_):
        tried.append(test["solver"]["rolling_friction"])
        if tried[-1] == "cdt":
            raise SolverError("log.liggghts: the heap did not come to rest in 20 s (rest.longest_s); rest is ...")
        return Measurement({"repose_angle_deg": 30.0}, {}, 0), tmp_path

    monkeypatch.setattr(rolling_models, "flowing", simulate)
    for _ in range(2):
        table = simulated(rows, tmp_path, 1).set_index("model")
        assert table.loc["own_spin", "repose_angle_deg"] == 30.0 and np.isnan(table.loc["cdt", "repose_angle_deg"])
    assert tried == ["cdt", "own_spin", "own_spin"]
    assert [row["model"] for row in finished(rows, tmp_path)] == ["cdt"]
    assert restless(table.reset_index()) == [
        "`cdt`, draw down, pair calibrated, packings: 1; the heap did not come to rest in 20 s, so it has no angle."
    ]
    monkeypatch.setattr(rolling_models, "RESTLESS", "never")
    (tmp_path / "other").mkdir()
    with pytest.raises(SolverError):
        simulated(rows, tmp_path / "other", 1)


def test_nothing_is_taken_for_finished_that_was_not_simulated(tmp_path):
    assert finished(wanted(1), tmp_path) == []


def test_differences_and_their_interval(published):
    """A packing counts by the mean of its pairs; Student's t over packings, in closed form for two."""
    table = summary(differences(runs_off_by(published), published)).set_index("model")
    for model, off in OFF.items():
        row = table.loc[model]
        assert row["mean_difference"] == pytest.approx(off) and row["pairs"] == 6 and row["packings"] == 2
        assert row["root_mean_square"] == pytest.approx(abs(off))
        half = STUDENT_95_1 * np.sqrt(0.5) / np.sqrt(2)  # standard deviation of -0.5 and 0.5
        assert [row["low"], row["high"]] == pytest.approx([off - half, off + half], rel=1e-4)


def test_a_packing_without_all_pairs_does_not_count(published):
    """Else the mean would be of other pairs."""
    runs = runs_off_by(published)
    short = runs.drop(runs[(runs["packing"] == 2) & (runs["pair"] == "first_1")].index)
    table = summary(differences(short, published))
    assert (table["packings"] == 1).all() and table["low"].isna().all()


def test_models_are_compared_by_the_same_pairs(published):
    """A pair that one of them lacks is left out for all, else a model would win by easier pairs."""
    found = differences(runs_off_by(published), published)
    lacks = found.drop(found[(found["model"] == "rvd") & (found["pair"] == "first_3")].index)
    shared = of_shared_pairs(lacks)
    assert set(shared["pair"]) == set(found["pair"]) - {"first_3"} and set(shared["model"]) == set(MODELS)
    assert len(of_shared_pairs(found)) == len(found)


def test_the_nearest_model_is_named(published):
    """By the root mean square; with one packing nothing is said of intervals."""
    table = summary(differences(runs_off_by(published, spread=0.01), published))
    said = nearest(table, "draw_down_shear_angle_deg")
    assert "own_spin is nearest (off by 0.5" in said and "cdt farthest (6; mean -6)" in said
    assert said.endswith("no interval of a mean difference holds 0.")
    wide = nearest(summary(differences(runs_off_by(published), published)), "draw_down_shear_angle_deg")
    assert "holds 0 for own_spin" in wide and "rvd" in wide
    one = nearest(summary(differences(runs_off_by(published, packings=1), published)), "draw_down_shear_angle_deg")
    assert one.endswith(f"{UNKNOWN}.")


def test_models_within_the_scatter_are_not_told_apart(published):
    """Welch's interval of two packings that are 1 degree apart reaches 3.0 degrees, with two degrees of freedom: from
    0.5 off 4 off is told, 6 below too, 2 off is not. The sentence names it; of one packing nothing is told."""
    runs = runs_off_by(published)
    near = runs["model"] == "rvd"
    runs.loc[near, "draw_down_shear_angle_deg"] -= OFF["rvd"] - 2.0
    table = summary(differences(runs, published))
    assert dict(zip(table["model"], table["told_from_nearest"], strict=True)) == {
        **{"cdt": "yes", "epsd2": "yes", "own_spin": "nearest", "rvd": "no"}
    }
    assert nearest(table, "draw_down_shear_angle_deg").endswith("not told from it: rvd.")
    one = summary(differences(runs_off_by(published, packings=1), published))
    assert set(one["told_from_nearest"]) == {"nearest", "unknown"}


def test_page_and_figure(tmp_path, published):
    """Each pair beside the source under every model; a response that nobody simulated has no section."""
    runs = runs_off_by(published)
    page = publish(tmp_path, runs, published)
    assert page == (tmp_path / "rolling_models_results.md").read_text() == results_page(runs, published)
    assert page.count("\n## ") == 2 and "nan" not in page
    found = by_pair(differences(runs, published), "draw_down_shear_angle_deg")
    assert list(found) == ["pair", "published", *MODELS]
    assert found["own_spin"].to_numpy() == pytest.approx(found["published"].to_numpy() + OFF["own_spin"])
    assert (tmp_path / "rolling_models.png").stat().st_size > 0


def test_wall_friction_stands_beside_the_coefficient(published, tmp_path):
    """Its mean over packings and the angle of the plate's coefficient; without such a test the page has no section, and
    of such tests alone no other one."""
    runs = runs_off_by(published)
    assert wall_friction(runs).empty and "wall shear" not in results_page(runs, published)
    walls = pd.DataFrame(
        {"model": "rvd", "test": WALL_SHEAR, "pair": CALIBRATED, "packing": number, PLATE: 1.0}
        | {"wall_friction_angle_deg": 40.0 + number}
        for number in (1, 2, 3)
    )
    both = pd.concat([runs, walls])
    (row,) = wall_friction(both).to_dict("records")
    assert row["wall_friction_angle_deg"] == pytest.approx(42.0) and row["packings"] == 3
    assert row["angle_of_the_coefficient_deg"] == pytest.approx(45.0) and row["low"] < 42.0 < row["high"]
    assert "of a wall shear test" in results_page(both, published)
    alone = publish(tmp_path, walls, published)
    assert "by 3 degrees at most" in alone and "Nearest" not in alone
    assert not (tmp_path / "rolling_models.png").exists()


def test_between_two_pairs_the_change_of_each_model_stands_beside_the_sources(published):
    """Of two pairs that all models have; of more there is no sentence."""
    pairs = {"first_1": 35.5, "first_4": 38.8}  # degrees, as published
    rows = [
        {"model": model, "pair": pair, "packing": 1, "draw_down_shear_angle_deg": 30.0 + step * (pair == "first_4")}
        for model, step in (("cdt", 2.0), ("rvd", -1.0))
        for pair in pairs
    ]
    (said,) = trend(differences(pd.DataFrame(rows), published), "draw_down_shear_angle_deg")
    assert "from the pair first_1 to first_4 the source changes by +3.3; cdt +2.0, rvd -1.0." in said
    assert trend(differences(runs_off_by(published), published), "draw_down_shear_angle_deg") == []
