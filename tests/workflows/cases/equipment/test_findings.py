"""Sentences on what a study of equipment found: they say what the numbers say, and what they do not."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.postproc.tables.summary import read_named
from bulkwear.workflows.cases.equipment import (
    comparison,
    findings,
    flow_tables,
    life,
    life_findings,
    life_tables,
    published,
    tables,
)
from bulkwear.workflows.cases.equipment.figures import runs_with_laws
from tests.support.own_machine_project import machine_study
from tests.workflows.cases.equipment.synthetic import SyntheticPart, SyntheticRun, write_study

LINER = SyntheticPart("back_liner", (1e-6, 5e-6), error=0.2)
WHEEL = SyntheticPart("wheel", (4e-6,), power=100.0)
RUN = SyntheticRun("plain", (LINER,), pristine=4)


def packings(setting, factors, **given):
    """A run of each factor, of one setting."""
    runs = enumerate(factors, start=1)
    return [
        replace(RUN, name=f"{setting}-{k}", setting=setting, packing=k, factor=factor, **given) for k, factor in runs
    ]


BY_IMPACTS = {"plate": {"law": "impact_threshold", "wear_coefficient_per_pa": 1e-11}}
TABLES = {
    "life": life_tables.life_table,
    "steel": life_tables.steel_table,
    "designs": comparison.designs_table,
    "loads": lambda read, lives: tables.loads_table(read),
    "flow": lambda read, lives: flow_tables.flow_table(read),
    "mass_balance": lambda read, lives: flow_tables.mass_balance(read),
}


@pytest.fixture
def found(tmp_path):
    """What makes one of the tables of a synthetic study that sentences are made of."""

    def made(name, runs):
        read = tables.read_runs(write_study(tmp_path, runs), tmp_path)
        return TABLES[name](read, life.part_lives(read, {}))

    return made


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (5234.0, "5,200"),
        (0.8765, "0.88"),
        (12.3, "12"),
        (104567.0, "100,000"),
        (99.6, "100"),
        (0.0, "0"),
        (-3.14, "-3.1"),
    ],
)
def test_numbers_of_answers(value, said):
    """Two digits, thousands apart."""
    assert life_findings.rounded(value) == said


# ---------------------------------------------------------------- life


def test_answer_on_life(found):
    """Hours with the interval, Mt, years, the place and its rates, and how far the shape was worn."""
    (said,) = life_findings.answers_on_life(found("life", packings("plain", (0.98, 1.0, 1.02))))
    assert said.startswith("The back liner has to be changed after 6,000 h (")
    assert " h, 95 %), 1.1 Mt, 1.0 years; its worst place is at (150, 50, 0) mm of its drawing and loses 5.0 mm" in said
    assert "The shape was worn for 300 h; from there on the last rate goes on." in said
    assert said.endswith("Whether it lasts the 8,000 h that are asked for cannot be said.") is False
    assert said.endswith("It does not last the 8,000 h that are asked for.")


def test_what_happens_in_one_packing_alone_is_said(found):
    """With its place and its hours, at the end; of alike packings nothing is said."""
    jam = replace(LINER, recession=(2e-5, 5e-6))
    first, *others = packings("plain", (0.98, 1.0, 1.02))
    (said,) = life_findings.answers_on_life(found("life", [replace(first, parts=(jam,)), *others]))
    place = "In packing 1 alone the place at (50, 50, 0) mm would be changed after 1,500 h"
    assert place in said and said.startswith("The back liner has to be changed after 6,000 h (")
    (said,) = life_findings.answers_on_life(found("life", [first, *others]))
    assert "alone" not in said


@pytest.mark.parametrize(
    ("part", "said"),
    [
        (SyntheticPart("lip", (9e-6,), thickness=None), ", unless the lip is: how long it lasts is open."),
        (SyntheticPart("lip", (0.0,)), ")."),
        (SyntheticPart("lip", (1e-7,)), ")."),
    ],
)
def test_the_first_change_leaves_parts_of_unknown_life_open(found, part, said):
    """A part of unknown thickness may go first; one that nothing wears does not."""
    runs = packings("plain", (0.98, 1.0, 1.02), parts=(LINER, replace(WHEEL, thickness=0.1), part))
    (first,) = life_findings.answers_on_first_change(found("life", runs), found("steel", runs))
    assert first.startswith("The back liner is changed first, after 6,000 h (") and first.endswith(said)


def test_one_packing_is_unknown(found):
    """Its scatter is, whatever its own blocks and the coefficient give."""
    few = replace(RUN, pristine=1, updates=1, worn=1)
    (said,) = life_findings.answers_on_life(found("life", [few]))
    assert f"after 6,000 h ({UNKNOWN}; the coefficient alone gives 5,000 to 7,500 h)" in said
    (said,) = life_findings.answers_on_life(found("life", [replace(RUN, scatter=0.05)]))
    assert f"({UNKNOWN}; its own blocks and the coefficient give " in said
    (said,) = life_findings.answers_on_life(found("life", [replace(few, parts=(replace(LINER, error=0.0),))]))
    assert f"after 6,000 h ({UNKNOWN})" in said


@pytest.mark.parametrize(
    ("part", "reason"),
    [(replace(LINER, thickness=None), life.NO_THICKNESS), (replace(LINER, recession=(0.0, 0.0)), life.NO_WEAR)],
)
def test_unknown_life_says_why(found, part, reason):
    """There is a sentence and no number."""
    table = found("life", [replace(RUN, parts=(part,))])
    assert life_findings.answers_on_life(table) == [
        f"The back liner: how long it lasts cannot be said, because {reason}."
    ]
    assert life_findings.cards(table) == []


def test_interval_round_what_is_asked_for_says_nothing(found):
    """Where the interval of the life holds the hours that are asked for, neither is said."""
    (said,) = life_findings.answers_on_life(found("life", packings("plain", (0.6, 0.75, 0.9))))
    assert said.endswith("Whether it lasts the 8,000 h that are asked for cannot be said.")


def test_one_packing_says_nothing_where_its_blocks_or_the_coefficient_leave_it_open(found):
    """What is known of one packing is held against the hours that are asked for as an interval of several is."""
    few = replace(RUN, pristine=1, updates=1, worn=1)
    for error, said in ((0.5, "cannot be said."), (0.0, "By this one packing it does not last")):
        (answer,) = life_findings.answers_on_life(found("life", [replace(few, parts=(replace(LINER, error=error),))]))
        assert said in answer.split("goes on.")[1]


@pytest.mark.parametrize(
    ("motion", "said"),
    [
        ({"kind": "belt", "velocity_m_per_s": [1.0, 0.0, 0.0]}, True),
        ({"kind": "turning_surface", "point_m": [0, 0, 0], "axis": [0, 1, 0], "speed_rad_per_s": 2.0}, True),
        ({"kind": "rotation", "point_m": [0, 0, 0], "axis": [0, 1, 0], "speed_rad_per_s": 2.0}, False),
        (None, False),
    ],
)
def test_a_running_surface_that_wears_is_worn_where_it_stands(found, motion, said):
    """It is said once for all designs, however the life comes out; not of parts that move, and of those at rest."""
    short = {"parts": (replace(LINER, motion=motion),), "pristine": 1, "updates": 1, "worn": 1}
    runs = [*packings("plain", (1.0,), **short), *packings("R9", (1.0,), **short)]
    answers = life_findings.answers_on_life(found("life", runs))
    sentence = f"The surface of the back liner runs, and is worn where it stands: {life_findings.RUNNING}."
    assert answers[2:] == ([sentence] if said else [])


# ---------------------------------------------------------------- designs


def test_clear_difference_is_said(found):
    """Half the rate is twice the life: better, and the interval says so; the first design stands for itself."""
    runs = [*packings("plain", (0.98, 1.0, 1.02)), *packings("R9", (0.49, 0.5, 0.51))]
    designs = found("designs", runs)
    lives = found("life", runs)
    said = findings.answers_on_designs(designs, lives)
    assert said[0].startswith("The back liner of R9 lasts 2.00 times as long as that of plain (")
    assert all(each.endswith("that is better, and the interval says so.") for each in said) and len(said) == 2
    table = designs.set_index(["quantity", "setting"])
    assert table.loc[("life", "plain"), "verdict"] == comparison.FIRST
    assert table.loc[("steel_lost", "R9"), "ratio"] == pytest.approx(0.5)
    assert table.loc[("worst_recession", "plain"), "value"] == pytest.approx(5.0, rel=1e-3)


@pytest.mark.parametrize(("factor", "told"), [(1.6, True), (1.05, False), (0.5, True)])
def test_a_rate_that_wear_was_changing_is_told_where_it_goes_on(found, factor, told):
    """By how much, at the life and beside its ratio to the first design; not of one that hardly changes."""
    changing = {"parts": (replace(LINER, worn=factor),)}
    runs = [*packings("plain", (0.98, 1.0, 1.02)), *packings("R9", (0.49, 0.5, 0.51), **changing)]
    lives = found("life", runs)
    first, second = life_findings.answers_on_life(lives)
    ratio = findings.answers_on_designs(found("designs", runs), lives)[0]
    changed = lives.set_index("setting").loc["R9"]
    by = changed["worn_mm_per_1000h"] / changed["pristine_mm_per_1000h"]
    words = f"the last rate goes on, {by:.2g} times that as built: a further change is in no interval."
    assert (words in second) == told and "the last rate goes on." in first
    assert ("That is if the last rate of R9 goes on, which wear was changing." in ratio) == told


def test_designs_of_other_feeds_are_compared_per_mt_too(found):
    """Fed twice as much a liner that wears twice as fast lasts half as long, and as many Mt; power needs none."""
    twice = packings("fast", (1.96, 2.0, 2.04), rate=2.0 * RUN.rate)
    runs = [*packings("slow", (0.98, 1.0, 1.02)), *twice]
    lasts, loses = findings.answers_on_designs(found("designs", runs), found("life", runs))
    assert lasts.startswith("The back liner of fast lasts 0.500 times as long") and "that is worse" in lasts
    assert "It is fed 2.00 times as much; its life in Mt is 1.00 times that (" in lasts
    assert "; per Mt it loses 1.00 times as much (" in loses
    assert all(each.endswith("which is better cannot be said.") for each in (lasts, loses))
    alike = [*packings("slow", (0.98, 1.0, 1.02)), *packings("fast", (1.96, 2.0, 2.04))]
    assert "Mt" not in "".join(findings.answers_on_designs(found("designs", alike), found("life", alike)))


def test_overlap_and_one_packing_say_nothing(found):
    """Scatter larger than the difference, or unknown, does not tell which is better."""
    runs = [*packings("A", (0.7, 1.0, 1.4)), *packings("B", (0.8, 1.1, 1.5))]
    wide = findings.answers_on_designs(found("designs", runs), found("life", runs))
    assert all(each.endswith("which is better cannot be said.") for each in wide) and wide
    runs = [*packings("A", (1.0,)), *packings("B", (2.0,))]
    one = findings.answers_on_designs(found("designs", runs), found("life", runs))
    assert all(UNKNOWN in each and each.endswith("which is better cannot be said.") for each in one) and one


def test_errors_of_two_coefficients_are_in_the_ratio(found):
    """A liner of another steel: its life is told within both errors, as squares in the logarithm; power is not."""
    steel, harder = (replace(LINER, coefficient=each, error=0.3, power=9.0) for each in (6e-13, 4.8e-13))
    runs = [
        *packings("mild", (0.98, 1.0, 1.02), parts=(steel,)),
        *packings("hard", (0.784, 0.8, 0.816), parts=(harder,)),
    ]
    table = found("designs", runs).set_index(["quantity", "setting"])
    lasts, power = (table.loc[(name, "hard")] for name in ("life", "power"))
    errors, scatter = math.sqrt(2.0) * math.log(1.0 / 0.7), 0.1  # of two per cent between packings
    assert lasts["ratio"] == pytest.approx(1.25, rel=1e-3) and lasts["verdict"] == comparison.UNSAID
    assert math.exp(-math.hypot(errors, scatter)) < lasts["ratio_low"] / 1.25 < math.exp(-errors)
    assert power["verdict"] != comparison.UNSAID and power["ratio_high"] < 0.85


def test_parameters_of_a_law_make_another_coefficient_of_it(found, tmp_path):
    """A threshold of its own in the second design: the errors of both coefficients are in the ratio."""
    runs = [*packings("A", (0.98, 1.0, 1.02)), *packings("B", (0.98, 1.0, 1.02))]
    values, ends = write_study(tmp_path, runs), {}
    for threshold in (0.1, 0.5):
        for run in values:
            own = threshold if run["setting"] == "B" else 0.1
            run["parts"]["back_liner"]["law_parameters"] = {"threshold_velocity_m_per_s": own}
        read = tables.read_runs(values, tmp_path)
        table = comparison.designs_table(read, life.part_lives(read, {})).set_index(["quantity", "setting"])
        ends[threshold] = table.loc[("life", "B"), "ratio_low"]
    assert ends[0.5] < 1.0 - LINER.error < ends[0.1]


def test_tables_are_told_the_parameters_of_the_laws_of_parts(tmp_path):
    """A row's own threshold of one part stands with that part of its run alone."""
    name = "threshold_velocity_m_per_s"
    with machine_study(tmp_path, f"row,parts.plate.parameters.{name}\nA,0.1\nB,0.5\n", parts=BY_IMPACTS) as study:
        told = runs_with_laws(study)
    assert [run["parts"]["plate"]["law_parameters"][name] for run in told] == [0.1, 0.5]
    assert all(run["parts"]["liner"]["law_parameters"] == {} for run in told)


def test_neither_more_nor_less_power_is_better(found):
    """Of power it is told which is larger."""
    parts = {"parts": (WHEEL,)}
    runs = [*packings("A", (0.99, 1.0, 1.01), **parts), *packings("B", (1.98, 2.0, 2.02), **parts)]
    table = found("designs", runs)
    power = table[(table["quantity"] == "power") & (table["setting"] == "B")].iloc[0]
    assert power["verdict"] == "larger" and power["ratio"] == pytest.approx(2.0)


def test_part_that_the_first_design_has_not_is_not_compared(found):
    """It stands in the table with its value."""
    runs = [*packings("A", (1.0, 1.1)), *packings("B", (1.0, 1.1), parts=(LINER, WHEEL))]
    table = found("designs", runs)
    alone = table[(table["part"] == "wheel") & (table["quantity"] == "life")].iloc[0]
    assert alone["setting"] == "B" and np.isnan(alone["ratio"]) and alone["verdict"] == ""
    assert all("wheel" not in each for each in findings.answers_on_designs(table, found("life", runs)))


def test_nothing_is_compared_where_nothing_wears(found, tmp_path):
    """The table has its columns and no rows, also when it is read again; there is no answer."""
    still = replace(RUN, parts=(SyntheticPart("back_liner", (0.0, 0.0)),))
    designs = found("designs", [still])
    designs.to_csv(tmp_path / "designs.csv", index=False)
    read = read_named(tmp_path / "designs.csv")
    assert read.empty and list(read) == comparison.DESIGNS
    assert findings.answers_on_designs(read, found("life", [still])) == []
    assert published._less_steel(read) == []


# ---------------------------------------------------------------- worn shape, flow, balance


def test_change_of_the_worn_shape(found):
    """What every packing has is said with its interval; of one packing it is unknown; none is called none."""
    worn = {"parts": (replace(WHEEL, worn=1.2),)}
    said = findings.answers_on_worn_shape(found("loads", packings("plain", (0.9, 1.0, 1.1), **worn)))
    assert said[0].startswith("The wheel as worn loses 20 % more steel per hour than as built (change 20 to 20 %")
    assert said[1].startswith("The wheel as worn takes 20 % more power than as built")
    one = findings.answers_on_worn_shape(found("loads", packings("plain", (1.0,), **worn)))
    assert all(each.endswith(f"({UNKNOWN}).") for each in one)
    same = findings.answers_on_worn_shape(found("loads", packings("plain", (1.0,), parts=(WHEEL,))))
    assert same[0] == "The wheel as worn loses as much steel per hour as built, within 0.1 %."


def test_change_that_is_not_shown_is_no_answer(found):
    """It stands in the table of loads alone."""
    runs = packings("plain", (0.9, 1.0, 1.1), parts=(WHEEL,), scatter=0.2)
    loads = found("loads", runs)
    loads["change_percent"], loads["change_percent_low"], loads["change_percent_high"] = 5.0, -3.0, 13.0
    assert findings.answers_on_worn_shape(loads) == []


def test_answer_on_the_flow(found):
    """Whether it is steady, in how many packings, and its means; of a filled machine what it holds."""
    said = findings.answers_on_flow(found("flow", packings("plain", (1.0, 1.1), pristine=8)))
    assert said == [
        "The flow is steady in 2 of 2 packings: 180 t/h come in, 180 t/h go out, 20.0 kg are held, each for 0.40 s."
    ]
    (said,) = findings.answers_on_flow(found("flow", packings("mill", (1.0,), rate=None, parts=(WHEEL,), pristine=8)))
    assert said == "The flow is steady: 20.0 kg are held."
    (said,) = findings.answers_on_flow(found("flow", packings("short", (1.0,), pristine=1)))
    assert said.startswith("The flow is not known to be steady: ")


def test_missing_particles_are_named(found):
    """Each with its cycle and run."""
    balance = found("mass_balance", [RUN])
    assert findings.answer_on_balance(balance).startswith("No particle is missing in any of 10 cycles of the run")
    balance.loc[3, "missing"] = 2
    assert findings.answer_on_balance(balance) == "Particles are missing: 2 in cycle 3 of plain."


def test_holes_are_told_with_their_hours():
    """Runs that are worn through somewhere, and no others."""
    told = {"through_nodes": [0, 4], "through_h": [np.nan, 1234.0], "through_said": ["", "worn through at 4 nodes"]}
    summary = pd.DataFrame({"run": ["A", "B"], **told})
    (said,) = findings.answers_on_holes(summary)
    assert said.startswith("In run B a first place has no thickness left by 1,200 h: worn through at 4 nodes.")
    assert findings.answers_on_holes(summary[["run"]]) == []


def lifters_of(setting, packings, angles, heights):
    """Rows of the table of lifters, with intervals of 1 degree or mm to both sides of more than one packing."""
    rows = []
    for hour, angle, height in zip((0.0, 1180.0), angles, heights, strict=False):
        row = {"setting": setting, "part": "liner", "operation_h": hour, "packings": packings}
        for name, value in (("leading_face_angle_deg", angle), ("height_mm", height)):
            half = 1.0 if packings > 1 else np.nan
            row |= {name: value, f"{name}_low": value - half, f"{name}_high": value + half}
        rows.append(row)
    return pd.DataFrame(rows)


def test_answer_on_lifters():
    """As built and after the last update, with intervals; of one packing without, and nothing of a kept shape."""
    (said,) = findings.answers_on_lifters(lifters_of("n77", 2, (14.15, 31.9), (65.0, 68.4)))
    leans = "lean back by 14 degrees as built and 32 degrees after 1,200 h (30.9 to 32.9, 95 %)"
    stand = "the crests stand out of the plates, which wear too, by 65 mm as built and 68 mm then (67.4 to 69.4, 95 %)"
    assert said == f"The leading faces of the liner's lifters {leans}; {stand}."
    both = [lifters_of("slow", 1, (14.15, 20.0), (65.0, 60.0)), lifters_of("kept", 1, (14.15,), (65.0,))]
    (said,) = findings.answers_on_lifters(pd.concat(both))
    assert said.startswith("Design slow: the leading faces") and said.count(UNKNOWN) == 2
