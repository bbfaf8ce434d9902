"""The study of stiffness: its variants, their order, the page that answers from a table; changes and verdicts."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from benchmarks.changes import BEYOND, FAILED, UNDECIDED, WITHIN, changes, verdict
from benchmarks.stiffness import (
    CASE,
    CONVEX,
    FRACTION,
    MODULI,
    MODULUS,
    ROW,
    STUDY,
    SURFACES,
    answers,
    page,
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


def rows_of(seeds):
    """Packings: below 1e7 Pa particles wear a plain sample 1.1 times as much, a convex one at 2e7 Pa as well."""
    random = np.random.default_rng(20220317)
    rows = []
    for seed in seeds:
        for each in variants(seed):
            work = 1.1 if each.modulus < (1e7 if each.surface == PLAIN else 5e7) else 1.0
            work *= (1.0 + 0.1 * seeds.index(seed)) * np.exp(random.normal(0.0, 1e-3))
            row = {"seed": seed, "surface": each.surface, "shear_modulus_pa": each.modulus}
            rows.append({**row, "time_step_s": 1e-5, "particles": 2000, "travel_m": 1.0, "sliding_work_J": work})
    return pd.DataFrame(rows).assign(processor_s=10.0)


def test_every_modulus_runs_over_both_samples():
    """Once; stiff particles, whose time steps are short, last."""
    found = variants(1)
    assert sorted((each.surface, each.modulus) for each in found) == sorted((s, m) for s in SURFACES for m in MODULI)
    stiffness = [each.modulus for each in found]
    assert stiffness == sorted(stiffness)


def test_the_modulus_reaches_the_run():
    """A hundredth of it makes the time step ten times as long, at the same share of the Rayleigh time."""
    run = load_study(STUDY, overrides=CASE).run(f"{ROW}_plain")
    derived = [with_derived(run, modulus, 1).parameters["derived"] for modulus in (MODULUS, 0.01 * MODULUS)]
    assert derived[1]["largest_time_step_s"] / derived[0]["largest_time_step_s"] == pytest.approx(10.0, rel=1e-12)
    assert derived[0]["time_step_s"] == pytest.approx(FRACTION * derived[0]["rayleigh_time_s"], rel=0.05)


def test_the_page_answers_what_the_table_holds():
    """How soft particles can be, and where wear is no longer the same, for both samples; the rows of both tables."""
    table = rows_of(SEEDS)
    verdicts = {surface: found.set_index("value")["verdict"].to_dict() for surface, found in answers(table).items()}
    assert verdicts[PLAIN] == {modulus: BEYOND if modulus < 1e7 else WITHIN for modulus in MODULI}
    assert verdicts[CONVEX] == {modulus: BEYOND if modulus < 5e7 else WITHIN for modulus in MODULI}
    text = " ".join(page(table).split())
    assert (
        "Plain sample, against 2.8e+08 Pa: within 2 % down to 2e+07 Pa; surely beyond that it is first at 7e+06" in text
    )
    assert (
        "Convex sample, against 2.8e+08 Pa: within 2 % down to 7e+07 Pa; surely beyond that it is first at 2e+07"
        in text
    )
    assert text.count("| within |") == 5 and text.count("| beyond |") == 3


def test_a_single_packing_says_that_chance_is_unknown():
    """No interval, and nothing that is no number."""
    text = page(rows_of(SEEDS[:1]))
    assert "unknown, of one packing" in text and "not shown of any" in text and "nan" not in text


def test_a_page_of_few_moduli_says_nothing_of_the_studies_own():
    """As where `--minutes` were spent before it."""
    table = rows_of(SEEDS)
    text = page(table[table["shear_modulus_pa"] < MODULUS])
    assert "against 2e+07 Pa" in text and "Studies and source" not in text


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
