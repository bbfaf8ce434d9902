"""Steady flow: tables whose rates, held mass and power are known, and particles that come, stay a while and go."""

import math

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.flow.steady_flow import (
    BALANCE,
    FEWEST_BLOCKS,
    MASS,
    POWER,
    steady_flow,
    steady_rest,
)
from bulkwear.postproc.statistics.steady import DRIFTING, ERROR_RATE, STEADY, UNSAID

EXACT = 1e-9  # -, of sums and differences of counted masses
BORDERS = 0.01  # -, of a mean over a block whose borders lie between two rows
SURE = 4.0  # standard deviations of a counted share
STAY = 0.5  # s, that a particle stays in the synthetic chute
RATE, GRAIN = 100.0, 0.02  # kg/s into it, kg each particle


def table_of(rate_in, rate_out, held=50.0, seconds=4.0, step=0.05, **powers):
    """A table of constant rates (kg/s)."""
    time = np.arange(round(seconds / step) + 1) * step
    masses = {"inserted_mass_kg": rate_in * time, "out_mass_kg": rate_out * time}
    held = held + (rate_in - rate_out) * time
    named = {f"power_{name}_W": np.broadcast_to(power, time.shape) for name, power in powers.items()}
    return pd.DataFrame({"time_s": time, "held_mass_kg": held, **masses, **named})


def chute(seed, seconds):
    """A table of particles that come at random times into an empty chute and stay for about STAY."""
    random = np.random.default_rng(seed)
    count = int(RATE / GRAIN * seconds)
    into = np.sort(random.uniform(0.0, seconds, count))
    out = np.sort(into + random.gamma(8.0, STAY / 8.0, count))
    time = np.arange(0.0, seconds, 0.02)
    put, gone = (GRAIN * np.searchsorted(times, time) for times in (into, out))
    columns = {"held_mass_kg": put - gone, "inserted_mass_kg": put, "out_mass_kg": gone}
    return pd.DataFrame({"time_s": time, **columns})


def test_constant_rates_are_steady_and_exact():
    """As much out as in: rates, held mass and power come back, and all three are steady."""
    found = steady_flow(table_of(20.0, 20.0, drum=300.0, belt=-100.0), 0.2)
    assert (found.start_s, found.end_s, found.blocks) == (pytest.approx(0.0, abs=EXACT), pytest.approx(4.0), 20)
    assert found.rate_in_kg_per_s.value == pytest.approx(20.0, rel=EXACT)
    assert found.rate_out_kg_per_s.value == pytest.approx(20.0, rel=EXACT)
    assert (found.held_kg, found.power_w) == (pytest.approx(50.0), pytest.approx(200.0))
    assert found.imbalance.value == pytest.approx(0.0, abs=EXACT)
    assert list(found.answers) == [BALANCE, POWER, MASS]
    assert set(found.answers.values()) == {STEADY}
    assert set(found.power_changes) == {"drum", "belt"}
    assert found.steady


def test_a_machine_that_fills_is_not_steady():
    """A tenth less goes out than comes in: the imbalance is that tenth, and so do the held masses of the halves."""
    found = steady_flow(table_of(20.0, 18.0), 0.2)
    assert found.imbalance.value == pytest.approx(0.1, rel=EXACT)
    assert found.held_change.value == pytest.approx(2.0 * 2.0 / 54.0, rel=EXACT)  # 2 kg/s over half of 4 s
    assert found.answer == found.answers[BALANCE] == DRIFTING
    assert steady_flow(table_of(20.0, 18.0), 0.2, tolerance=0.11).steady


def test_an_emptying_machine_is_not_steady():
    """What only goes out is out of balance by all of it."""
    found = steady_flow(table_of(0.0, 5.0), 0.2)
    assert found.imbalance.value == pytest.approx(-1.0, rel=EXACT)
    assert found.answer == DRIFTING


def test_held_mass_that_drifts_forbids_what_the_balance_allows():
    """Of a slow, full machine the held mass shows what is small beside the rates."""
    found = steady_flow(table_of(20.0, 19.5, held=2.0), 0.2)
    assert found.answers == {BALANCE: STEADY, MASS: DRIFTING}
    assert found.answer == DRIFTING


@pytest.mark.parametrize(("rise", "answer"), [(0.0, STEADY), (0.4, DRIFTING)])
def test_a_filled_machine_is_judged_by_its_power(rise, answer):
    """Nothing comes or goes: the power decides."""
    noise = 0.01 * np.random.default_rng(1).standard_normal(81)
    found = steady_flow(table_of(0.0, 0.0, drum=300.0 * (1.0 + noise + rise * np.linspace(-0.5, 0.5, 81))), 0.2)
    assert next(iter(found.answers)) == POWER
    assert found.answers[MASS] == STEADY
    assert found.answer == answer
    assert found.power_change.value == pytest.approx(0.5 * rise, abs=0.01)  # a ramp's halves, and the noise


def test_nothing_flows_and_nothing_moves():
    """Without rates and power nothing is said; a part that turns idle does not count."""
    random = np.random.default_rng(2)
    assert steady_flow(table_of(0.0, 0.0), 0.2).answer == UNSAID
    assert "nothing flows and nothing moves" in steady_flow(table_of(0.0, 0.0), 0.2).said()
    assert steady_flow(table_of(0.0, 0.0, drum=random.standard_normal(81)), 0.2).answer == UNSAID
    assert POWER not in steady_flow(table_of(20.0, 20.0, drum=random.standard_normal(81)), 0.2).answers


@pytest.mark.parametrize("seed", range(5))
def test_the_start_is_cut_off(seed):
    """A chute that starts empty is steady after a little more than the stay; its start is not."""
    table = chute(seed, 6.0)
    found = steady_rest(table, 0.1)
    assert found.steady
    assert 0.8 * STAY < found.start_s < 3.0
    low, high = found.rate_out_kg_per_s.interval(0.9999)
    assert low < RATE < high
    assert found.held_kg == pytest.approx(RATE * STAY, rel=0.05)
    assert not steady_flow(table[table["time_s"] < 1.2], 0.1).steady
    assert not steady_rest(table[table["time_s"] < 0.8], 0.05).steady


@pytest.mark.parametrize("blocks", range(FEWEST_BLOCKS, 2 * FEWEST_BLOCKS))
def test_enough_blocks_stay_to_judge(blocks):
    """However few there are and whatever the start looks like: here the first half is a transient."""
    table = table_of(20.0, 20.0, seconds=0.2 * blocks)
    early = table["time_s"] < 0.1 * blocks
    found = steady_rest(table.assign(held_mass_kg=table["held_mass_kg"].where(~early, 20.0)), 0.2)
    assert found.blocks >= FEWEST_BLOCKS


def test_no_time_is_steady_while_a_machine_fills():
    """Before the first particles go out, and where in and out never meet."""
    assert not steady_rest(chute(1, 0.4), 0.02).steady
    assert not steady_rest(table_of(20.0, 18.0), 0.2).steady


@pytest.mark.verify
def test_errors_are_rare():
    """Of flows out of balance by the tolerance at most ERROR_RATE are called steady, of those in balance drifting."""
    random, trials = np.random.default_rng(3), 300
    wrong = {0.0: 0, 0.05: 0}
    for gap in wrong:
        for _ in range(trials):
            table = table_of(20.0, 20.0 * (1.0 - gap), held=1e4)
            table["out_mass_kg"] += np.cumsum(0.1 * random.standard_normal(len(table)))
            answer = steady_flow(table, 0.2).answers[BALANCE]
            wrong[gap] += answer == (STEADY if gap else DRIFTING)
    most = ERROR_RATE + SURE * math.sqrt(ERROR_RATE * (1.0 - ERROR_RATE) / trials)
    assert 0 < wrong[0.05] < most * trials  # at the edge it does happen
    assert wrong[0.0] < most * trials


def test_uneven_rows_and_another_clock_do_not_matter():
    """Rows that are left out, and times from another start, give the same rates."""
    table = table_of(20.0, 18.0, drum=300.0)
    kept = table[np.random.default_rng(4).random(len(table)) < 0.6].copy()
    kept = pd.concat([table.iloc[:1], kept, table.iloc[-1:]]).drop_duplicates("time_s")
    first, other = steady_flow(table, 0.4), steady_flow(kept.assign(time_s=kept["time_s"] + 7.0), 0.4)
    assert other.start_s == pytest.approx(first.start_s + 7.0)
    for name in ("rate_in_kg_per_s", "imbalance"):
        assert getattr(other, name).value == pytest.approx(getattr(first, name).value, rel=EXACT), name
    assert other.held_change.value == pytest.approx(first.held_change.value, rel=BORDERS)


def test_blocks_end_with_the_table():
    """What does not fill a block is left out at the start: the last rows count."""
    table = table_of(20.0, 20.0, seconds=4.1)
    assert steady_flow(table, 0.4).start_s == pytest.approx(0.1)
    assert steady_flow(table, 0.4).blocks == 10


def test_few_blocks_tell_nothing():
    """A short table is no error, and says how many blocks are needed."""
    for seconds in (0.0, 0.2 * (FEWEST_BLOCKS - 1)):
        found = steady_rest(table_of(20.0, 20.0, seconds=seconds), 0.2)
        assert found.answer == UNSAID
        assert f"{FEWEST_BLOCKS} blocks or more are needed" in found.said()
    assert not steady_rest(table_of(20.0, 20.0, seconds=1.0), 0.2).steady


def test_the_sentence_states_the_numbers():
    """Answer, window, and each measure with its interval and answer."""
    noise = 0.02 * np.random.default_rng(5).standard_normal(81)
    said = steady_flow(table_of(20.0, 20.0, drum=300.0 * (1.0 + noise)), 0.2).said()
    assert said.startswith("The flow is steady within 5 % from ")
    for part in (
        "to 4 s (20 blocks of 0.2 s)",
        "20 kg/s (95 % interval 20 to 20) come in and 20 kg/s (95 % interval 20 to 20) go out, a difference of",
        "W are taken and change by",
        "50 kg are held and change by",
    ):
        assert part in said
    assert said.count(": steady") == 3
    assert "is not steady within 5 %" in steady_flow(table_of(20.0, 18.0), 0.2).said()


@pytest.mark.parametrize(
    ("change", "block", "sentence"),
    [
        (lambda table: table.drop(columns="out_mass_kg"), 0.2, "the flow table has no column out_mass_kg, allowed"),
        (lambda table: table.iloc[[0, 2, 1, 3]], 0.2, "the flow table goes back at time_s 0.05, allowed are times"),
        (lambda table: table, 0.01, r"rows 0.05 s apart and blocks of 0.01 s, allowed are blocks that are as long"),
        (lambda table: table.iloc[:1], 0.0, "blocks of 0 s, allowed are blocks"),
    ],
)
def test_other_tables_are_refused(change, block, sentence):
    """One sentence that names what was found and what is allowed."""
    with pytest.raises(ValueError, match=sentence):
        steady_flow(change(table_of(20.0, 20.0)), block)
