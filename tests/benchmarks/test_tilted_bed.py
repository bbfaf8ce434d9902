"""The slope at which a bed flows: what is simulated, what is read of a trace, intervals, page and figure."""

import math
import re
import sys
from dataclasses import asdict

import numpy as np
import pandas as pd
import pytest

from benchmarks import tilted_bed, tilted_layer
from benchmarks.command_line import command
from benchmarks.rolling_case import MODELS
from benchmarks.runs import side_by_side
from benchmarks.tilted_bed import (
    FRICTIONS,
    PACKINGS,
    REFERENCE,
    SETTING,
    creep_table,
    layers,
    publish,
    said_of,
    summary,
)
from benchmarks.tilted_layer import Tilt, TiltError, measured, tilt_deck, tilted
from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.workflows.engine.project import PACKAGE
from bulkwear.workflows.engine.solver import SolverError, SolverStoppedError

STUDENT_95_4, STUDENT_95_8 = 2.7764, 2.3060  # two-sided 95 % points of Student's t by degrees of freedom; tables
FLOWS_AT = {"cdt": 35.0, "epsd2": 36.0, "own_spin": 38.0, "rvd": 38.1}  # degrees, made up
CREEPS = {"cdt": 0.6, "epsd2": 0.003, "own_spin": 0.002, "rvd": 1.2}  # mm/s, made up
SPREAD = (-0.4, -0.2, 0.0, 0.2, 0.4)  # degrees, of five packings
TILT = Tilt()
PLAIN = {"sliding_friction": 0.21, "rolling_friction": 0.4} | asdict(
    TILT
)  # columns of a table that does not ask for another layer


def made_up(packings=PACKINGS):
    return pd.DataFrame(
        {
            "model": model,
            "packing": number + 1,
            "flow_angle_deg": angle + SPREAD[number],
            "creep_mm_per_s": CREEPS[model] * (1.0 + SPREAD[number]),
            "level_mm": 60.0 + SPREAD[number],
            "level_asked_mm": 61.0,
            **PLAIN,
        }
        for model, angle in FLOWS_AT.items()
        for number in range(packings)
    )


GRAIN = {
    "density_kg_per_m3": 2000.0,
    "bulk_solid_fraction": 0.6,
    "median_diameter_m": 0.01,
    "diameters_m": [0.01],
    "mass_fractions": [1.0],
}
MASS = 340 * 2000.0 * math.pi / 6.0 * 0.01**3  # kg, of as many grains as a layer has
LEVEL = MASS / (2000.0 * 0.6 * 8.0 * 6.0 * 0.01**2)  # m, over 8 by 6 diameters


def written_trace(path, angles, speeds, mass=MASS, level=LEVEL):
    rows = "\n".join(f"{angle} {speed} {mass} {level}" for angle, speed in zip(angles, speeds, strict=True))
    path.write_text(f"angle_deg speed_m_per_s mass_kg level_m\n{rows}\n")
    return path


def test_the_angle_is_that_of_the_first_look_that_finds_flow(tmp_path):
    """A slip that stops again before is none."""
    trace = written_trace(tmp_path / "tilt.txt", [20.1, 30.2, 30.3, 30.4], [0.001, 0.09, 0.0002, 0.11])
    assert measured(trace, GRAIN, TILT)["flow_angle_deg"] == 30.4
    slow = written_trace(tmp_path / "slow.txt", [20.1, 60.0], [0.0, 0.09])
    with pytest.raises(TiltError, match=r"slow.txt: the bed does not flow at 60.0 degrees"):
        measured(slow, GRAIN, TILT)
    fast = written_trace(tmp_path / "fast.txt", [20.1, 24.9], [0.0, 0.3])
    with pytest.raises(TiltError, match=r"fast.txt: the bed flows at 24.9 degrees, before .* 20 to 25"):
        measured(fast, GRAIN, TILT)
    assert measured(fast, GRAIN, Tilt(start_deg=10.0))["flow_angle_deg"] == 24.9


@pytest.mark.parametrize(
    ("mass", "level", "said"),
    [(0.9 * MASS, 0.9 * LEVEL, "mass 0.3204 kg (asked 0.356 within"), (MASS, 1.3 * LEVEL, "level 0.08036 m (asked")],
)
def test_a_layer_that_lacks_grains_or_hangs_loose_is_refused(tmp_path, mass, level, said):
    """Each of the two is told, asked and found."""
    trace = written_trace(tmp_path / "tilt.txt", [21.0, 30.0], [0.0, 0.2], mass, level)
    with pytest.raises(TiltError, match=rf"tilt.txt: the bed is not as asked: .*{re.escape(said)}"):
        measured(trace, GRAIN, TILT)
    found = measured(written_trace(trace, [21.0, 30.0], [0.0, 0.2]), GRAIN, TILT)
    assert found["level_mm"] == pytest.approx(found["level_asked_mm"]) == pytest.approx(1e3 * LEVEL)


def test_finished_layers_alone_need_one(tmp_path, monkeypatch, capsys):
    """Without any, a sentence that names the folder; nothing is written."""
    monkeypatch.setattr(sys, "argv", ["tilted_bed", "--finished", "--folder", str(tmp_path), "--output", str(tmp_path)])
    with pytest.raises(SystemExit):
        tilted_bed.main()
    assert f"{tmp_path}: no layer asked for is finished" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["--packings", "0"], "argument --packings: found '0', allowed is a whole number from 1 on"),
        (["--packings", "2.5"], "argument --packings: found '2.5', allowed is"),
        (["--cores", "-1"], "argument --cores: found '-1', allowed is a whole number from 1 on"),
        (["--sliding-friction", "-0.1"], "argument --sliding-friction: found '-0.1', allowed is a number from 0 to 2"),
        (["--grains", "12.5"], "argument --grains: found '12.5', allowed is a whole number from 100 to 5000"),
        (["--rate-deg-per-s", "nan"], "argument --rate-deg-per-s: found 'nan', allowed is a number from 0.1 to 10"),
        (["--start-deg", "58"], "--end-deg 60: allowed is 5 degrees more than --start-deg (58) and above"),
        (["--redraw"], "tilted_bed.csv is missing, allowed is --redraw where an earlier run has written it"),
    ],
)
def test_what_cannot_be_asked_is_refused(given, said, tmp_path, monkeypatch, capsys):
    """In a sentence, before anything is simulated."""
    monkeypatch.setattr(sys, "argv", ["tilted_bed", *given, "--output", str(tmp_path), "--folder", str(tmp_path)])
    monkeypatch.setattr(tilted_bed, "all_tilted", None)
    with pytest.raises(SystemExit):
        command(tilted_bed.main)
    assert said in capsys.readouterr().err


def test_layers_of_which_none_flows_make_no_page(tmp_path, monkeypatch, capsys):
    """Their reasons are told and stay in the table, in a folder that is made before anything is simulated."""
    output = tmp_path / "new"

    def none_flows(*_, **__):
        assert output.is_dir()
        refused = {"refused": "the bed does not flow at 60.0 degrees."}
        return pd.DataFrame([{"model": "cdt", "packing": 1} | refused | PLAIN])

    monkeypatch.setattr(sys, "argv", ["tilted_bed", "--output", str(output)])
    monkeypatch.setattr(tilted_bed, "all_tilted", none_flows)
    with pytest.raises(SystemExit):
        tilted_bed.main()
    said = "no layer tells at which slope it flows: `cdt`, packing 1: the bed does not flow at 60.0 degrees."
    assert said in capsys.readouterr().err
    assert [file.name for file in output.iterdir()] == ["tilted_bed.csv"]


FAULTS = {
    "loose": TiltError("a/tilt.txt: the bed is not as asked."),
    "lost": SolverError("a/log: LIGGGHTS lost 3 atoms."),
    "ended": SolverStoppedError("a/log: a signal ended it."),
}


def test_a_layer_that_tells_nothing_ends_no_other(tmp_path, monkeypatch):
    """It has its reason in the table and on the page; where the solver failed too, but not where it was ended."""

    def tilted(asked, tilt, root):
        if asked in FAULTS:
            raise FAULTS[asked]
        return {"flow_angle_deg": 35.0, "creep_mm_per_s": 1.0, "level_mm": 60.0, "level_asked_mm": 61.0}

    monkeypatch.setattr(tilted_bed, "tilted", tilted)
    monkeypatch.setattr(tilted_bed, "tilt_deck", lambda asked, tilt: str(asked))
    monkeypatch.setattr(tilted_bed, "is_finished", lambda row, tilt, root: True)
    monkeypatch.setattr(tilted_bed, "_told", lambda row, tilt: {key: row[key] for key in ("model", "packing")} | PLAIN)
    asked = {"cdt": "loose", "epsd2": "lost", "rvd": "sound"}
    rows = [{"model": model, "packing": 1, "asked": each} for model, each in asked.items()]
    table = tilted_bed.all_tilted(rows, TILT, tmp_path, 1)
    assert table["flow_angle_deg"].isna().tolist() == [True, True, False]
    page = publish(tmp_path, table)
    assert "`cdt`, packing 1: the bed is not as asked." in page and "`rvd`: 35.0 degrees" in page
    assert "`epsd2`, packing 1: LIGGGHTS lost 3 atoms." in page
    with pytest.raises(SolverStoppedError):
        tilted_bed.all_tilted([{**rows[0], "asked": "ended"}], TILT, tmp_path, 1)


def test_the_page_is_written_from_its_table(tmp_path):
    """Of the repository."""
    assert publish(tmp_path, pd.read_csv(PACKAGE / "docs/tilted_bed.csv")).startswith("# At which slope")


def test_creep_is_how_fast_the_layer_moves_before_without_slips(tmp_path):
    """The median of the first five degrees: one slip and what comes later do not move it."""
    trace = written_trace(tmp_path / "tilt.txt", [21.0, 22.0, 23.0, 26.0, 30.0], [0.001, 0.05, 0.0012, 0.08, 0.2])
    assert measured(trace, GRAIN, TILT)["creep_mm_per_s"] == pytest.approx(1.2)
    told = creep_table(made_up()).set_index("model").loc["cdt"]
    assert (told["creep_mm_per_s"], told["slowest_mm_per_s"], told["fastest_mm_per_s"]) == pytest.approx(
        (0.6, 0.36, 0.84)
    )


def test_intervals_are_over_packings():
    """By Student's t with four degrees of freedom. Packings that scatter alike under two models tell their difference
    better than the two means do: here it has no scatter."""
    table = summary(made_up()).set_index("model")
    error = np.std(SPREAD, ddof=1) / math.sqrt(len(SPREAD))
    assert table.loc["cdt", "flow_angle_deg"] == pytest.approx(35.0)
    assert table.loc["cdt", "high_deg"] - 35.0 == pytest.approx(STUDENT_95_4 * error, rel=1e-4)
    assert table.loc["cdt", "less_reference_deg"] == pytest.approx(-3.0)
    assert [table.loc["cdt", name] for name in ("less_low_deg", "less_high_deg")] == pytest.approx([-3.0, -3.0])
    apart = made_up().assign(packing=lambda runs: runs["packing"] + 10 * (runs["model"] == "cdt"))
    reach = STUDENT_95_8 * math.sqrt(2.0) * error
    found = summary(apart).set_index("model").loc["cdt"]
    assert [found["less_low_deg"], found["less_high_deg"]] == pytest.approx([-3.0 - reach, -3.0 + reach], rel=1e-4)
    assert np.isnan(table.loc[REFERENCE, "less_reference_deg"])


def test_one_packing_has_no_interval():
    one = pd.Series([35.0], [1])
    assert said_of("cdt", one, one) == f"`cdt`: 35.0 degrees ({UNKNOWN})."


def test_page_and_figure(tmp_path):
    """The page tells of each model whether it is told from the reference; the figure is there."""
    page = publish(tmp_path, made_up())
    assert "| rvd | 5 | 1.2 |" in page
    assert "`rvd`: 38.1 degrees (95 %: 37.7 to 38.5), +0.1 (+0.1 to +0.1) of `own_spin`" in page
    assert "`cdt`: 35.0 degrees (95 %: 34.6 to 35.4), -3.0 (-3.0 to -3.0) of `own_spin`" in page
    assert "not told from `own_spin`" in publish(tmp_path, made_up().query("packing < 3 or model != 'rvd'"))
    assert "Layers lie 59.6 to 60.4 mm deep at rest; asked are 61.0 mm." in " ".join(page.split())
    assert (tmp_path / "tilted_bed.png").stat().st_size > 0
    assert "scatter unknown" in publish(tmp_path, made_up(1))


@pytest.mark.solver
def test_a_small_layer_flows_and_is_not_simulated_again(tmp_path, monkeypatch):
    """Tilted fast from a steep slope, on the real solver; the second time nothing runs."""
    for name, value in {"LENGTH": 5.0, "WIDTH": 4.0, "GRAINS": 90, "CREEPING": 3.0}.items():
        monkeypatch.setattr(tilted_layer, name, value)
    tilt = Tilt(grains=90, start_deg=22.0, rate_deg_per_s=20.0)
    row = layers(1, ("epsd2",), {})[0]
    assert not tilted_bed.is_finished(row, tilt, tmp_path)
    layer = tilted(row["asked"], tilt, tmp_path)
    assert tilted_bed.is_finished(row, tilt, tmp_path)
    assert 25.0 < layer["flow_angle_deg"] < 60.0
    monkeypatch.setattr(tilted_layer, "run_deck", None)
    assert tilted(row["asked"], tilt, tmp_path) == layer


def test_progress_counts_what_is_missing(capsys):
    """Answers stand in the order in which they were asked for; what was there before is not counted."""
    doubled = side_by_side("layers", [1, 2, 3], lambda number: number < 3, lambda number: 2 * number, 2)
    assert doubled == [2, 4, 6]
    assert capsys.readouterr().err == "layers: 1 of 1 simulated, 100 % of the run, about 0 s left\n"


def test_every_model_has_its_layers():
    """No two of one deck."""
    rows = layers(PACKINGS, MODELS, {})
    decks = {tilt_deck(row["asked"], TILT) for row in rows}
    assert len(decks) == len(rows) == PACKINGS * len(MODELS)


@pytest.mark.parametrize(
    ("frictions", "tilt", "line"),
    [
        ({"sliding_friction": 0.5}, TILT, "coefficientFriction peratomtypepair 1 0.5\n"),
        ({"rolling_friction": 0.1}, TILT, "coefficientRollingFriction peratomtypepair 1 0.1\n"),
        ({}, Tilt(start_deg=5.0), "variable angle equal 5.0+1.0*dt*(step-"),
        ({}, Tilt(rate_deg_per_s=2.0), "variable angle equal 20.0+2.0*dt*(step-"),
        ({}, Tilt(end_deg=30.0), "variable look loop 100\n"),
        ({}, Tilt(grains=170), "particles_in_region 170 region fill"),
    ],
)
def test_another_layer_is_another_deck(frictions, tilt, line):
    """Each setting has its line; none of them stands in the deck of the layers that the page tells of."""
    usual = tilt_deck(layers(1, (REFERENCE,), {})[0]["asked"], TILT)
    deck = tilt_deck(layers(1, (REFERENCE,), frictions)[0]["asked"], tilt)
    assert line in deck and line not in usual


def test_a_table_holds_layers_of_one_setting(tmp_path, monkeypatch, capsys):
    """Others are refused before anything is simulated, and the page tells of its own."""
    made_up().to_csv(tmp_path / "tilted_bed.csv", index=False)
    given = ["--sliding-friction", "0.5", "--grains", "680", "--output", str(tmp_path)]
    monkeypatch.setattr(sys, "argv", ["tilted_bed", *given])
    monkeypatch.setattr(tilted_bed, "all_tilted", None)
    with pytest.raises(SystemExit):
        tilted_bed.main()
    said = (
        "tilted_bed.csv holds layers of sliding_friction 0.21, not 0.5, grains 340, not 680: allowed is another folder"
    )
    assert said in capsys.readouterr().err
    page = " ".join(publish(tmp_path, made_up().assign(sliding_friction=0.5, rate_deg_per_s=2.0)).split())
    assert "with sliding friction 0.5 and rolling friction 0.4." in page
    assert "by 2 degree/s until" in page and "looked at every 0.2 degrees" in page


def test_the_table_of_the_repository_holds_the_usual_layers():
    """So a further packing of them goes into it."""
    usual = layers(1, (REFERENCE,), {})[0]["asked"]["particle"]["contact"]
    asked = {name: usual[name] for name in FRICTIONS} | asdict(TILT)
    assert list(asked) == SETTING
    assert tilted_bed.other_setting(PACKAGE / "docs/tilted_bed.csv", asked) is None


def test_a_setting_of_many_digits_is_found_again(tmp_path):
    """The table rounds it."""
    asked = PLAIN | {"sliding_friction": 1.0 / 3.0}
    made_up().assign(**asked).to_csv(tmp_path / "layers.csv", index=False, float_format=f"%{tilted_bed.DIGITS}")
    assert tilted_bed.other_setting(tmp_path / "layers.csv", asked) is None
