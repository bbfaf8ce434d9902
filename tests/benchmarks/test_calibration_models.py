"""The calibration under each rolling model, by a formula: table, families, what holds under which model, the page."""

from dataclasses import replace

import pandas as pd
import pytest

from benchmarks import calibration_models
from benchmarks.calibration_models import FIGURE, FILE, PAGE, calibrated, main
from benchmarks.calibration_models_page import MODEL, SHEAR_ANGLE, pairs_table, results_page, shares_table
from benchmarks.rolling_case import MODELS, SETTINGS, study_of
from benchmarks.rolling_page import NO_REST
from bulkwear.workflows.cases.calibration import driver
from bulkwear.workflows.engine.solver import SolverError
from tests.support.calibration_study import answers

OFF = {"cdt": -4.0, "epsd2": -2.0, "own_spin": 0.0}  # degrees off the formula
RESTLESS = "log: the heap did not come to rest"


def by_model(tests, folder, workers, say):
    """Answers of the formula, off by what the tests' rolling model is."""
    off = OFF[tests[0]["solver"]["rolling_friction"]]
    return [
        replace(each, responses={name: value + off for name, value in each.responses.items()})
        for each in answers(tests, folder, workers, say)
    ]


@pytest.fixture
def formula(monkeypatch):
    monkeypatch.setattr(driver, "simulate_all", by_model)
    monkeypatch.setattr(calibration_models, "simulated_by", lambda folder: "commit a")


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """All simulations of the three models that fit, as the command leaves them."""
    place = tmp_path_factory.mktemp("models")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(driver, "simulate_all", by_model)
        patch.setattr(calibration_models, "simulated_by", lambda folder: "commit a")
        asked = ["--models", "own_spin", "cdt", "epsd2", "--folder", str(place / "runs"), "--output", str(place)]
        main(asked)
    assert all((place / name).stat().st_size > 0 for name in (PAGE, FIGURE))
    return pd.read_csv(place / FILE)


def test_a_model_that_gives_flatter_slopes_asks_for_more_friction(table):
    """Each recommended pair gives the measured angle by the formula, and the steeper a model the less friction."""
    done = calibrated(table)
    assert list(done) == [model for model in MODELS if model in set(table[MODEL])]
    found = pairs_table(done).set_index(MODEL)
    aim = done["own_spin"].problem.measured[SHEAR_ANGLE]
    assert found["angle_at_recommended_deg"].to_numpy() == pytest.approx(aim.value, abs=2.0 * aim.deviation)
    apart = found["angle_at_calibrated_deg"] - found.loc["own_spin", "angle_at_calibrated_deg"]
    assert apart.to_dict() == pytest.approx({model: OFF[model] for model in done})
    assert (found["sliding_low"] < found["sliding"]).all() and (found["sliding"] < found["sliding_high"]).all()


def test_a_pair_is_rejected_under_a_model_that_gives_it_another_angle(table):
    """Four degrees apart no pair of one model is in the family of the other; each is in its own."""
    shares = shares_table(calibrated(table)).set_index("pair")
    for model in ("cdt", "own_spin"):
        assert shares.loc[f"of {model}", f"under_{model}_percent"] < 50.0
    assert shares.loc["of cdt", "under_own_spin_percent"] > 95.0 < shares.loc["of own_spin", "under_cdt_percent"]


def test_the_page_says_what_each_model_asks_for(table):
    page = results_page(calibrated(table), {"rvd": RESTLESS})
    for words in (
        "* `cdt`: sliding friction",
        "* `own_spin`: sliding friction",
        f"* `rvd` has no calibration: {RESTLESS}",
    ):
        assert words in page
    assert "Not calibrated yet" not in page
    assert "* Not calibrated yet: `epsd2` and `rvd`." in results_page(
        {model: each for model, each in calibrated(table).items() if model != "epsd2"}, {}
    )
    own_spin = next(line for line in " ".join(page.split()).split("* ") if line.startswith("`own_spin`:"))
    assert "rejects those of cdt and epsd2." in own_spin


def test_a_model_that_never_rests_does_not_end_the_others(formula, tmp_path, monkeypatch):
    """Its row has the solver's words, and it is not tried again."""
    tried = []

    def restless(*_):
        tried.append(1)
        raise SolverError(RESTLESS)

    monkeypatch.setattr(calibration_models, "run_calibration", restless)
    for _ in range(2):
        found = calibration_models.calibrate("rvd", tmp_path, 1)
        assert found[NO_REST].tolist() == [RESTLESS] and len(tried) == 1


def test_models_that_were_not_asked_for_stay_in_the_table(formula, table, tmp_path):
    earlier = table[table[MODEL] == "cdt"]
    earlier.to_csv(tmp_path / FILE, index=False)
    main(["--models", "own_spin", "--folder", str(tmp_path / "runs"), "--output", str(tmp_path)])
    found = pd.read_csv(tmp_path / FILE)
    assert set(found[MODEL]) == {"cdt", "own_spin"} and (found[MODEL] == "cdt").sum() == len(earlier)


def test_the_models_time_steps_are_those_of_the_comparison():
    """`cdt` creeps the faster the longer its time step: it has a shorter one here, too."""
    fractions = {
        model: study_of(model, calibration_models.FIDELITY).settings["solver"]["rayleigh_fraction"] for model in MODELS
    }
    assert fractions["cdt"] == SETTINGS["cdt"]["rayleigh_fraction"] < min(fractions[name] for name in MODELS[1:])
