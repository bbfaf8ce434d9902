"""Packings: a row becomes several that differ in the seed of their bed alone."""

from __future__ import annotations

import itertools
import json

import pytest

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.config.packings import named_by_rows
from bulkwear.workflows.engine.case import Run
from bulkwear.workflows.engine.decks import primes
from bulkwear.workflows.forecast.forecast import forecast_table, work_of
from bulkwear.workflows.forecast.rates import DEFAULT, read_rates

ROUNDING = 1e-12  # relative; sums of a few floating-point numbers
SEEDS_OF_A_BED = 6  # more than any filling takes: one for the distribution, one per size, one for the insertion


def small(config, packings=3, **overrides):
    return load_study("small", config.project, {"packings": packings, **overrides})


def rewrite(config, rows, more=",seed"):
    """Give the small design other rows, with a column more."""
    header = config.path("designs/small.csv").read_text(encoding="utf-8").splitlines()[0]
    config.write("designs/small.csv", f"{header}{more}\n{rows}")


def seed_of(study, row):
    return study.run(f"{row}_convex").parameters["bed"]["seed"]


def test_a_row_becomes_its_packings(config):
    """R9 with three packings is R9, R9-2 and R9-3, one setting, in the order of the design, also in its table."""
    study = small(config)
    rows = ["R9", "R9-2", "R9-3", "R5", "R5-2", "R5-3"]
    assert [row["row"] for row in study.design_rows] == rows
    assert [run.name for run in study.runs] == [f"{row}_{surface}" for row in rows for surface in ("convex", "plain")]
    assert study.setting_of == {row: row.split("-")[0] for row in rows}
    assert list(study.packing_of.values()) == [1, 2, 3, 1, 2, 3]
    assert study.chosen_settings == ["R9", "R5"]
    told = [(line["row"], line["setting"], line["packing"], line["seed"]) for line in study.design_table()[::2]]
    assert told == [(row, study.setting_of[row], study.packing_of[row], seed_of(study, row)) for row in rows]


def test_packings_differ_in_the_seed_of_their_bed_alone(config):
    """The surfaces of a packing share its bed, and no two packings share a seed that the solver takes."""
    study = small(config, 4)
    for row in ("R9", "R5"):
        packings = [name for name, setting in study.setting_of.items() if setting == row]
        runs = [study.run(f"{name}_convex").parameters for name in packings]
        apart = [{key for key in first if first[key] != run[key]} for first, run in itertools.pairwise(runs)]
        assert apart == [{"bed"}] * 3
        assert len({json.dumps({**run["bed"], "seed": 0}) for run in runs}) == 1
        taken = [prime for run in runs for prime in primes(run["bed"]["seed"], SEEDS_OF_A_BED)]
        assert len(set(taken)) == len(taken) == 4 * SEEDS_OF_A_BED
        assert all(study.bed_of(f"{name}_convex") == study.bed_of(f"{name}_plain") for name in packings)
    assert len(study.beds) == 8


@pytest.mark.parametrize("rows", [None, ["R5", "R9-2"]])
def test_what_was_simulated_stays_the_same_with_more_packings(config, rows):
    """Runs, their beds and the names of these are those of fewer packings, so that files made with them hold."""
    chosen = {} if rows is None else {"rows": rows}
    fewer, more = small(config, 2, **chosen), small(config, 4, **chosen)
    for run in fewer.runs:
        assert more.run(run.name) == run
        assert more.bed_of(run.name) == fewer.bed_of(run.name)
        assert more.beds[more.bed_of(run.name)] == fewer.beds[fewer.bed_of(run.name)]
    assert [run.name for run in more.runs if run.row == "R5"] == ["R5_convex", "R5_plain"]


def test_a_bed_keeps_its_name_when_a_design_gets_another_row(config):
    """It is that of the row that first starts from it, so that a bed of another thickness renames none."""
    before = small(config, 2)
    header, *rows = config.path("designs/small.csv").read_text(encoding="utf-8").splitlines()
    thinner = {"row": "R6", "bed_thickness_mm": "20"}
    cells = zip(header.split(","), rows[-1].split(","), strict=True)
    rewrite(config, "\n".join([",".join(thinner.get(name, cell) for name, cell in cells), *rows]), more="")
    after = small(config, 2)
    assert after.bed_of("R6-2_plain") == "bed_R6-2" and len(after.beds) == len(before.beds) + 2
    for run in before.runs:
        assert after.bed_of(run.name) == before.bed_of(run.name) == f"bed_{run.row}"


def test_surfaces_with_beds_of_their_own_name_them():
    """Two beds of one row, as a project's case may have: the second is named by its run."""
    runs = [Run(f"R5_{surface}", "R5", surface, {}) for surface in ("convex", "plain")]
    beds, bed_of = named_by_rows(runs, {"a": {"seed": 1}, "b": {"seed": 2}}, {"R5_convex": "b", "R5_plain": "a"})
    assert beds == {"bed_R5": {"seed": 2}, "bed_R5_plain": {"seed": 1}}
    assert bed_of == {"R5_convex": "bed_R5", "R5_plain": "bed_R5_plain"}


def test_low_seeds_are_told_apart(config):
    """Seeds below the solver's smallest give the same primes: packings of such a seed begin above it."""
    study = small(config, bed={"seed": 7})
    taken = [prime for row in ("R9", "R9-2", "R9-3") for prime in primes(seed_of(study, row), SEEDS_OF_A_BED)]
    assert len(set(taken)) == len(taken)


@pytest.mark.parametrize(
    ("rows", "found"),
    [
        ("R9-1,8,2,20,6,1,40,20000\nR9-2,8,2,20,6,1,40,21000\n", {"R9-1": 20000, "R9-2": 21000, "R9-3": 22000}),
        ("R9-1,8,2,20,6,1,40,20000\nR9-3,8,2,20,6,1,40,50000\n", {"R9-1": 20000, "R9-3": 50000, "R9-4": 21000}),
        ("a,8,2,20,6,1,40,20000\nb,8,2,20,6,1,40,\n", {"a": 20000, "b": 20220317, "a-3": 21000}),
    ],
)
def test_rows_that_a_design_repeats_count_as_packings(config, rows, found):
    """What a design repeats with seeds of its own is one setting; packings add only what it lacks."""
    rewrite(config, rows)
    study = small(config)
    assert {row: seed_of(study, row) for row in study.setting_of} == found
    assert len(set(study.setting_of.values())) == 1
    assert sorted(study.packing_of.values()) == [1, 2, 3]
    assert len(small(config, 1).design_rows) == 2


def test_a_row_may_have_a_number_of_its_own(config):
    """A column of the design stands for the setting where it is filled."""
    rewrite(config, "R9,8,2,20,6.0,1.0,40,1\nR5,4,8,60,6.0,2.0,30,\n", ",packings")
    assert [row["row"] for row in small(config, 2).design_rows] == ["R9", "R5", "R5-2"]


def test_rows_are_chosen_by_setting_or_by_packing(config):
    """R9 is that row with all its packings, R9-2 its second one alone, which still knows its setting."""
    assert [row["row"] for row in small(config, rows=["R9"]).design_rows] == ["R9", "R9-2", "R9-3"]
    one = small(config, rows=["R9-2"])
    assert [run.name for run in one.runs] == ["R9-2_convex", "R9-2_plain"]
    assert (one.setting_of["R9-2"], one.packing_of["R9-2"], len(one.beds)) == ("R9", 2, 1)


@pytest.mark.parametrize(
    ("rows", "sentence"),
    [
        (
            "R9,8,2,20,6,1,40,\nR9-2,4,8,60,6,2,30,\n",
            r"small.csv, line 3, row R9-2: row is 'R9-2', which is what a packing of row R9 is called, allowed is"
            r" another name, or packings: 1\.",
        ),
        (
            "R9,8,2,20,6,1,40,7\nR8,8,2,20,6,1,40,9\n",
            r"small.csv, line 3, row R8: seed is 9, which makes row R9 again, whose other values are the same, allowed"
            r" are seeds of 10000 or more, below which all are one, that are 1000 apart, or one row\.",
        ),
        (
            "R9,8,2,20,6,1,40,20000\nR8,8,2,20,6,1,40,20000\n",
            r"seed is 20000, which makes row R9 again, whose other values are the same, allowed are seeds that are 1000"
            r" apart, or one row\.",
        ),
    ],
)
def test_rows_that_would_be_taken_for_one_another_are_refused(config, rows, sentence):
    """One sentence names the row, before anything is simulated."""
    rewrite(config, rows)
    with pytest.raises(ConfigError, match=sentence):
        small(config)


@pytest.mark.parametrize(
    ("study", "reason"), [("pin_on_disc", "runs start from no bed"), ("calibration", "calibration.repeats says")]
)
def test_without_a_bed_there_are_no_packings(study, reason):
    """More than one packing is one sentence where no bed is packed, or its repeats have a key of their own."""
    with pytest.raises(ConfigError, match=f"command line: packings is 2, allowed is 1 in .* {study}: {reason}"):
        load_study(study, overrides={"packings": 2})
    loaded = load_study(study)
    assert loaded.setting_of == {name: name for name in loaded.setting_of}


def test_packings_cost_as_much_as_they_are(repository):
    """The forecast of three packings is three times that of one: a bed and both samples of each."""
    rates = read_rates(repository / DEFAULT).rates
    hours = [
        forecast_table(work_of(load_study("demo", overrides={"packings": n})), rates)["core_h"].sum() for n in (1, 3)
    ]
    assert hours[1] == pytest.approx(3.0 * hours[0], rel=ROUNDING)


def test_a_regression_counts_settings(config):
    """Packings of two settings make no regression, however many rows they are."""
    config.edit("studies/small.yaml", "surfaces:", "factors: {a: major_radius_mm, t: bed_thickness_mm}\nsurfaces:")
    with pytest.raises(ConfigError, match="found a design of 2 settings, allowed are 5 or more"):
        small(config)
