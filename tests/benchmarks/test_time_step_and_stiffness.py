"""The study of time step and stiffness: its variants, their order, and the page that answers from a table."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from benchmarks.changes import BEYOND, FAILED, UNDECIDED, WITHIN, changes, verdict
from benchmarks.time_step_and_stiffness import (
    CASE,
    CONVEX,
    FRACTION,
    FRACTIONS,
    MODULI,
    MODULUS,
    ROW,
    STUDY,
    answers,
    page,
    source_fraction,
    variants,
    with_derived,
)
from bulkwear.postproc.mesh import PLAIN
from bulkwear.workflows.config.design import load_study

SEEDS = (1, 1001, 2001)
ROUNDING = 1e-9
LIMIT = 0.02
TRIALS = 400
SURE = 4.0  # standard deviations of a count of trials


@pytest.fixture
def table():
    """Three packings: no time step matters up to 0.8, over the convex sample up to 0.3; the solver fails at 1.25."""
    random = np.random.default_rng(20220317)
    rows = []
    for seed in SEEDS:
        for each in variants(seed):
            work = {1.0: 0.95, 1.25: np.nan}.get(each.fraction, 1.0) * (1.1 if each.modulus < 1e7 else 1.0)
            work *= 0.9 if each.surface == CONVEX and 0.3 < each.fraction < 1.0 else 1.0
            work *= (1.0 + 0.1 * SEEDS.index(seed)) * np.exp(random.normal(0.0, 1e-3))
            row = {
                "seed": seed,
                "surface": each.surface,
                "rayleigh_fraction": each.fraction,
                "shear_modulus_pa": each.modulus,
            }
            rows.append({**row, "time_step_s": 1e-5, "particles": 2000, "travel_m": 1.0, "sliding_work_J": work})
    return pd.DataFrame(rows).assign(processor_s=10.0)


def test_each_choice_is_varied_alone():
    """Every time step at the studies' modulus, every modulus at its own time step, once; dear ones last."""
    found = variants(1)
    for surface in (PLAIN, CONVEX):
        of = [each.fraction for each in found if each.modulus == MODULUS and each.surface == surface]
        assert sorted(of) == sorted(FRACTIONS)
    assert {each.modulus: each.fraction for each in found if each.modulus != MODULUS} == {
        modulus: fraction for modulus, fraction in MODULI.items() if modulus != MODULUS
    }
    cost = [each.modulus**0.5 / each.fraction for each in found]
    assert cost == sorted(cost) and len(found) == len(set(found))


def test_time_step_and_modulus_reach_the_run():
    """Half the fraction halves the time step, a hundredth of the modulus makes it ten times as long."""
    run = load_study(STUDY, overrides=CASE).run(f"{ROW}_plain")
    largest = [
        with_derived(run, fraction, modulus, 1).parameters["derived"]["largest_time_step_s"]
        for fraction, modulus in ((FRACTION, MODULUS), (0.5 * FRACTION, MODULUS), (FRACTION, 0.01 * MODULUS))
    ]
    assert largest[1] / largest[0] == pytest.approx(0.5, rel=1e-12)
    assert largest[2] / largest[0] == pytest.approx(10.0, rel=1e-12)
    assert 0.2 < source_fraction() < 0.25  # 5e-6 s, config/studies/screening.yaml


def test_the_page_answers_what_the_table_holds(table):
    """How far wear stays, and where it no longer does, for both choices; the rows of both tables."""
    found = answers(table)
    steps, moduli = (found[name].set_index("value")["verdict"] for name in ("rayleigh_fraction", "shear_modulus_pa"))
    assert steps.to_dict() == {**dict.fromkeys(FRACTIONS, WITHIN), 1.0: BEYOND, 1.25: FAILED}
    convex = found[CONVEX].set_index("value")["verdict"]
    assert {convex[each] for each in (0.4, 0.6, 0.8, 1.0)} == {BEYOND} and convex[0.3] == WITHIN
    assert list(moduli.index) == sorted(MODULI, reverse=True)
    assert moduli.to_dict() == {modulus: BEYOND if modulus < 1e7 else WITHIN for modulus in MODULI}
    text = " ".join(page(table).split())
    assert "up to 0.8; surely beyond that it is first at 1 (beyond)" in text
    assert "down to 2e+07 Pa; surely beyond that it is first at 7e+06 (beyond)" in text
    assert "convex sample: within 2 % up to 0.3; surely beyond that it is first at 0.4 (beyond)" in text
    told = sum((table["verdict"] == WITHIN).sum() for table in found.values())
    assert text.count("| 1.25 |") == 2 and text.count("| within |") == told


def test_changes_of_known_runs():
    """Two packings with every value: means over them, the interval by hand from what packing and value leave over."""
    noise = 0.01 * np.array([1.0, -1.0, -1.0, 1.0])
    responses = np.array([5.0, 5.0 * 1.2, 5.5, 5.5 * 1.2]) * np.exp(noise)
    table = changes([1.0, 1.0, 2.0, 2.0], responses, ["a", "b"] * 2, 1.0, LIMIT).set_index("value")
    assert table["mean"].tolist() == pytest.approx([5.0 * 1.2**0.5, 5.5 * 1.2**0.5], rel=ROUNDING)
    scatter = np.sqrt(4 * 0.01**2 / 1)
    assert table["scatter"].tolist() == pytest.approx([scatter] * 2, rel=ROUNDING)
    reach = stats.t.ppf(0.975, 1) * scatter * np.sqrt(0.5 + 0.5)
    found = table.loc[2.0, ["change", "change_low", "change_high"]].tolist()
    assert found == pytest.approx([0.1, 1.1 * np.exp(-reach) - 1.0, 1.1 * np.exp(reach) - 1.0], rel=1e-8)
    assert table.loc[1.0, ["change", "change_low", "change_high"]].tolist() == [0.0, 0.0, 0.0]


def test_a_packing_that_wears_more_changes_nothing():
    """Missing values are compared within their packing: without chance the change is exact however they are missing."""
    values, packings = [1.0, 2.0, 3.0, 1.0, 2.0, 1.0, 3.0], ["a", "a", "a", "b", "b", "c", "c"]
    effect, worn = {1.0: 1.0, 2.0: 1.01, 3.0: 0.9}, {"a": 1.0, "b": 3.0, "c": 0.2}
    responses = [effect[value] * worn[packing] for value, packing in zip(values, packings, strict=True)]
    table = changes(values, responses, packings, 1.0, LIMIT)
    assert table["change"].tolist() == pytest.approx([0.0, 0.01, -0.1], abs=ROUNDING)
    assert table["verdict"].tolist() == [WITHIN, WITHIN, BEYOND]


def test_failed_runs_are_told():
    """A value whose run failed once has no verdict but that; one that failed always has no change either."""
    table = changes([1.0, 1.0, 2.0, 2.0, 3.0], [1.0, 1.0, 1.0, np.nan, np.nan], list("ababa"), 1.0, LIMIT)
    assert table["failed"].tolist() == [0, 1, 1] and table["runs"].tolist() == [2, 1, 0]
    assert table["verdict"].tolist() == [WITHIN, FAILED, FAILED]
    assert np.isnan(table["change"].iloc[2])


@pytest.mark.verify
def test_the_interval_covers_the_true_change_as_often_as_it_says():
    """95 of 100 intervals of normal logarithms with a true change of 3 % hold it, whatever the packings do."""
    random = np.random.default_rng(20220317)
    held = 0
    for _ in range(TRIALS):
        packing = random.normal(0.0, 0.1, 4)
        logs = random.normal(0.0, 0.01, (3, 4)) + packing + np.log([[1.0], [1.03], [0.98]])
        table = changes(np.repeat([1.0, 2.0, 3.0], 4), np.exp(logs).ravel(), np.tile(range(4), 3), 1.0, LIMIT)
        held += table["change_low"][1] <= 0.03 <= table["change_high"][1]
    assert abs(held - 0.95 * TRIALS) < SURE * np.sqrt(0.95 * 0.05 * TRIALS)


@pytest.mark.parametrize(
    ("low", "high", "said"),
    [(-0.01, 0.019, WITHIN), (0.021, 0.04, BEYOND), (-0.05, -0.021, BEYOND), (0.01, 0.03, UNDECIDED)],
)
def test_verdicts(low, high, said):
    """An interval inside the limits, outside one of them, or across one."""
    assert verdict(low, high, LIMIT) == said


def test_a_single_packing_leaves_everything_undecided():
    """Nothing tells of chance."""
    table = changes([1.0, 2.0], [1.0, 1.0], ["a", "a"], 1.0, LIMIT)
    assert np.isnan(table["change_low"][1]) and table["verdict"][1] == UNDECIDED


def test_a_reference_that_was_not_run_is_refused():
    """The message tells the value and which there are."""
    with pytest.raises(ValueError, match=r"no run at the reference 0\.5, allowed are 1, 2"):
        changes([1.0, 2.0], [1.0, 1.0], ["a", "a"], 0.5, LIMIT)
