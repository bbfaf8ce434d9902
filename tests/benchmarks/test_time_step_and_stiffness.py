"""The study of time step and stiffness: its variants, their order, and the page that answers from a table."""

import numpy as np
import pandas as pd
import pytest

from benchmarks.deviation import BEYOND, FAILED, WITHIN
from benchmarks.time_step_and_stiffness import (
    CASE,
    FRACTION,
    FRACTIONS,
    MODULI,
    MODULUS,
    RUN,
    STUDY,
    answers,
    page,
    source_fraction,
    variants,
    with_derived,
)
from workflows.config.design import load_study

SEEDS = (1, 1001, 2001)


@pytest.fixture
def table():
    """Three packings: wear follows neither choice up to 0.8, is 5 % less at 1, and the solver fails beyond."""
    random = np.random.default_rng(20220317)
    rows = []
    for seed in SEEDS:
        for each in variants(seed):
            work = {1.0: 0.95, 1.25: np.nan}.get(each.fraction, 1.0) * (1.1 if each.modulus < 1e7 else 1.0)
            work *= (1.0 + 0.1 * SEEDS.index(seed)) * np.exp(random.normal(0.0, 1e-3))
            row = {"seed": seed, "rayleigh_fraction": each.fraction, "shear_modulus_pa": each.modulus}
            rows.append({**row, "time_step_s": 1e-5, "particles": 2000, "travel_m": 1.0, "sliding_work_J": work})
    return pd.DataFrame(rows).assign(processor_s=10.0)


def test_each_choice_is_varied_alone():
    """Every time step at the studies' modulus, every modulus at its own time step, once; dear ones last."""
    found = variants(1)
    assert sorted(each.fraction for each in found if each.modulus == MODULUS) == sorted(FRACTIONS)
    assert {each.modulus: each.fraction for each in found if each.modulus != MODULUS} == {
        modulus: fraction for modulus, fraction in MODULI.items() if modulus != MODULUS
    }
    cost = [each.modulus**0.5 / each.fraction for each in found]
    assert cost == sorted(cost) and len(found) == len(set(found))


def test_time_step_and_modulus_reach_the_run():
    """Half the fraction halves the time step, a hundredth of the modulus makes it ten times as long."""
    run = load_study(STUDY, overrides=CASE).run(RUN)
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
    assert list(moduli.index) == sorted(MODULI, reverse=True)
    assert moduli.to_dict() == {modulus: BEYOND if modulus < 1e7 else WITHIN for modulus in MODULI}
    text = " ".join(page(table).split())
    assert "up to 0.8; surely beyond that it is first at 1 (beyond)" in text
    assert "down to 2e+07 Pa; surely beyond that it is first at 7e+06 (beyond)" in text
    assert text.count("| 1.25 |") == 1 and text.count("| within |") == len(FRACTIONS) - 2 + len(MODULI) - 2
