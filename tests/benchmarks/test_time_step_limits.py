"""Time steps by rolling model: which runs there are, how far a step may go by their table, and what is not told."""

import math
import sys

import numpy as np
import pandas as pd
import pytest

from benchmarks.changes import BEYOND, UNDECIDED, WITHIN
from benchmarks.rolling_case import MODELS
from benchmarks.runs import failure_file
from benchmarks.stiffness import CONVEX, FRACTION
from benchmarks.time_step_limits import (
    FRACTIONS,
    SURFACES,
    Case,
    cases,
    chain_of,
    forecast,
    main,
    publish,
    run_of,
    simulate,
    table_of,
)
from benchmarks.time_step_page import ENOUGH, RESPONSES, answers, costs, limits, longest, results_page
from bulkwear.postproc.mesh import PLAIN

NOISE = 1e-3  # -, scatter of made-up runs
UP_TO = {"cdt": 0.3, "epsd2": 0.5}  # of the convex sample's sliding work; beyond it is a tenth off


def made_up(packings=ENOUGH):
    """Runs under two models: packings differ by a tenth, time steps matter beyond UP_TO over the convex sample."""
    random, rows = np.random.default_rng(20220317), []
    for case in cases(list(UP_TO), packings):
        off = 0.9 if case.surface == CONVEX and case.fraction > UP_TO[case.model] else 1.0
        of_packing = 1.0 + 1e-4 * (case.seed % 7000)
        chance = np.exp(random.normal(0.0, NOISE, 2))
        row = {"model": case.model, "seed": case.seed, "surface": case.surface, "rayleigh_fraction": case.fraction}
        work = dict(zip(RESPONSES, of_packing * chance * np.array([off, 1.0]), strict=True))
        rows.append({**row, "time_step_s": 1e-5, "particles": 2000, "travel_m": 0.4, **work, "processor_s": 10.0})
    return pd.DataFrame(rows)


def test_every_time_step_of_every_model_is_asked_for_once():
    """A packing is done before the next one, a model before the next; within them the cheap ones come first."""
    found = cases(MODELS, 2)
    assert len(set(found)) == len(found) == len(MODELS) * 2 * len(SURFACES) * len(FRACTIONS)
    assert [case.model for case in found] == sorted((case.model for case in found), key=MODELS.index)
    of_first = [case.seed for case in found if case.model == MODELS[0]]
    assert of_first == sorted(of_first)
    assert [case.fraction for case in found[: len(FRACTIONS)]] == sorted(FRACTIONS, reverse=True)


@pytest.mark.parametrize("model", MODELS)
def test_model_time_step_and_packing_reach_the_run(model, tmp_path):
    """Also beyond the largest fraction that a configuration may have; the bed has the studies' time step."""
    case = Case(model, 7, CONVEX, 0.6)
    parameters = run_of(case, case.fraction).parameters
    assert parameters["solver"]["rolling_friction"] == model and parameters["bed"]["seed"] == 7
    step = run_of(case, 0.3).parameters["derived"]["largest_time_step_s"]
    assert parameters["derived"]["largest_time_step_s"] == pytest.approx(2.0 * step)
    bed = chain_of(case, tmp_path).bed
    assert bed["solver"]["rayleigh_fraction"] == FRACTION
    assert bed["temporary_floor_m"] >= parameters["derived"]["highest_point_m"]  # no particle begins in a bump
    assert bed == chain_of(Case(model, 7, PLAIN, 0.1), tmp_path).bed


def test_limits_are_the_last_step_within_for_all():
    """Each response and surface has its own, the shortest counts; changes are those made up."""
    found = answers(made_up())
    for model, up_to in UP_TO.items():
        told = found[model, CONVEX, "sliding_work_J_per_m"].set_index("value")
        assert (told["verdict"] == WITHIN).to_dict() == {each: each <= up_to for each in FRACTIONS}
        assert told.loc[max(FRACTIONS), "change"] == pytest.approx(-0.1, abs=5.0 * NOISE)
    table = limits(found).set_index("model")
    assert table["all of them"].to_dict() == UP_TO
    assert table.loc["cdt", f"{PLAIN}, sliding work"] == max(FRACTIONS)


def test_nothing_is_told_of_too_few_packings():
    """Neither of too few, nor where a single time step lacks one."""
    few, whole = made_up(ENOUGH - 1), made_up()
    assert limits(answers(few))["all of them"].isna().all()
    lacking = whole.drop(whole[(whole["model"] == "cdt") & (whole["rayleigh_fraction"] == 0.1)].index[-1])
    found = limits(answers(lacking)).set_index("model")["all of them"]
    assert math.isnan(found["cdt"]) and found["epsd2"] == UP_TO["epsd2"]
    assert "`cdt`: not known" in results_page(lacking)


def test_a_limit_at_the_shortest_step_is_told_as_none():
    """What scatters too much to be decided is told with its interval, beside what is shown."""
    table = made_up()
    loud = (table["model"] == "cdt") & (table["surface"] == CONVEX)
    name = next(iter(RESPONSES))
    table.loc[loud, name] *= np.exp(np.random.default_rng(1).normal(0.0, 0.05, loud.sum()))
    page = " ".join(results_page(table).split())
    assert "`cdt`: no step longer than 0.1 of the Rayleigh time, with which all are compared, is shown to keep" in page
    assert f"shown is that of {PLAIN}, sliding work up to {max(FRACTIONS):g}" in page
    assert math.isnan(limits(answers(table)).set_index("model").loc["cdt", "all of them"])
    assert "`epsd2`: at 0.5 of the Rayleigh time all is within 2 %" in page


def test_what_models_cost_is_compared_at_equal_steps():
    """One with long steps only is no cheaper for that."""
    table = made_up()
    table["processor_s"] = 1.0 / table["rayleigh_fraction"]
    table.loc[table["model"] == "epsd2", "processor_s"] *= 1.25
    few = table[(table["model"] == "cdt") | (table["rayleigh_fraction"] > 0.4)]
    assert costs(few).to_dict() == pytest.approx({"cdt": 1.0, "epsd2": 1.25})
    assert "over `cdt`: `cdt` 1.00, `epsd2` 1.25" in " ".join(results_page(few).split())


def test_a_run_that_failed_ends_the_limit():
    table = made_up()
    of = (table["model"] == "epsd2") & (table["surface"] == PLAIN) & (table["rayleigh_fraction"] == 0.4)
    table.loc[table[of].index[0], [*RESPONSES, "processor_s"]] = np.nan
    assert limits(answers(table)).set_index("model").loc["epsd2", "all of them"] == 0.3


def test_a_shorter_step_that_is_undecided_ends_no_limit_but_one_beyond_does():
    """More packings of one time step tell more of that one."""
    told = pd.DataFrame({"value": FRACTIONS[:4], "runs": ENOUGH, "failed": 0})
    assert longest(told.assign(verdict=[WITHIN, UNDECIDED, WITHIN, UNDECIDED])) == FRACTIONS[2]
    assert math.isnan(longest(told.assign(verdict=[WITHIN, BEYOND, WITHIN, WITHIN])))


def test_the_table_has_every_run_of_the_folder(tmp_path, monkeypatch):
    """Whatever was asked for last: further packings of one surface and time step stand beside the others."""
    monkeypatch.setattr("benchmarks.time_step_limits.row_of", lambda case, folder: {"case": case})
    done = [*cases(MODELS[:1], 1), *cases(MODELS[-1:], 4, [CONVEX], [0.1, 0.4])]
    for case in done:
        failure_file(chain_of(case, tmp_path)).write_text("it did")
    assert list(table_of(tmp_path)["case"]) == done


def test_without_a_finished_run_the_table_stays(tmp_path, monkeypatch, capsys):
    """A sentence that names the folder, and nothing is written over."""
    monkeypatch.setattr(sys, "argv", ["limits", "--finished", "--folder", str(tmp_path), "--output", str(tmp_path)])
    with pytest.raises(SystemExit):
        main()
    assert f"{tmp_path}: no run is finished" in capsys.readouterr().err and not list(tmp_path.glob("*.csv"))


def test_a_single_packing_gives_no_verdict(tmp_path):
    """With nothing that tells of chance; page and figure are made all the same."""
    page = publish(tmp_path, made_up(1))
    assert page == (tmp_path / "time_step_limits_results.md").read_text() and "| within |" not in page
    assert (tmp_path / "time_step_limits.png").stat().st_size > 0


def test_only_what_is_missing_is_simulated(tmp_path, monkeypatch):
    """A run that failed is done, with nothing found; a forecast counts the others."""
    wanted, asked = cases(MODELS[:1], 1)[:2], []
    monkeypatch.setattr("benchmarks.time_step_limits.simulated", lambda case, folder: asked.append(case))
    failure_file(chain_of(wanted[0], tmp_path)).write_text("it did")
    assert forecast(wanted, tmp_path).startswith("1 of 2 runs are missing")
    assert list(simulate(wanted, tmp_path, minutes=1.0)) == asked == wanted[1:]
    assert list(simulate(wanted, tmp_path, minutes=-1.0)) == []
