"""Whether a machine runs steadily, from tables of its flow."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.equipment.steadiness import LOOKED_AT, is_steady

RATE = 10.0  # kg/s fed
ROWS = 4  # of the table in a block


def flow_of(held, out=None, power=None, **others):
    """The table of blocks of a second, from their held masses (kg), the mass that leaves in each, and the power: of a
    block or of its rows; others: further powers by column.
    """
    out = np.full(len(held), RATE) if out is None else np.asarray(out, float)
    tables = []
    for block, mass in enumerate(held):
        part = np.arange(1, ROWS + 1) / ROWS
        table = {
            "cycle": block,
            "held_mass_kg": mass,
            "inserted_mass_kg": RATE * (block + part),
            "out_mass_kg": out[:block].sum() + out[block] * part,
        }
        if power is not None:
            table["power_paddle_W"] = power[block]
        tables.append(pd.DataFrame(table | {name: series[block] for name, series in others.items()}))
    return pd.concat(tables, ignore_index=True)


def run_of(most=0.05, inlet=True):
    return {"start_up": {"steady_change": most}, "inlet": {"rate_kg_per_s": RATE} if inlet else None}


def test_a_flow_that_holds_still_is_steady():
    """Held mass, and as much out as in, over the blocks that are looked at."""
    assert is_steady(run_of(), flow_of([1.0, 5.0, 5.1, 5.0]))


def test_too_few_blocks_are_not_steady():
    """However still they are."""
    assert not is_steady(run_of(), flow_of([5.0] * (LOOKED_AT - 1)))
    assert is_steady(run_of(), flow_of([5.0] * LOOKED_AT))


@pytest.mark.parametrize("held", [[4.0, 4.5, 5.0], [5.0, 5.0, 5.3], [5.3, 5.0, 5.0], [5.0, 4.7, 5.0]])
def test_held_mass_that_changes_is_not_steady(held):
    """From any block to the next by more than the share that is allowed."""
    assert not is_steady(run_of(), flow_of([5.0, *held]))
    assert is_steady(run_of(most=0.2), flow_of([5.0, *held]))


@pytest.mark.parametrize(("out", "steady"), [(9.6, True), (9.4, False), (10.4, True), (10.6, False), (0.0, False)])
def test_mass_out_is_mass_in(out, steady):
    """Within the share, of the blocks behind the first that is looked at."""
    assert is_steady(run_of(), flow_of([5.0] * 4, [0.0, 0.0, out, out])) == steady


def test_what_a_machine_holds_at_first_does_not_count():
    """Only the latest blocks are looked at."""
    assert is_steady(run_of(), flow_of([0.1, 1.0, 9.0, 5.0, 5.0, 5.0], [0, 0, 3, 10, 10, 10]))


def test_power_holds_still_too():
    """Of a part that moves; a block that tells no power, as the first one, leaves it open."""
    assert is_steady(run_of(), flow_of([5.0] * 4, power=[1.0, 2.0, 2.05, 2.0]))
    assert not is_steady(run_of(), flow_of([5.0] * 4, power=[1.0, 2.0, 2.2, 2.0]))
    assert not is_steady(run_of(), flow_of([5.0] * 3, power=[np.nan, 2.0, 2.0]))
    assert is_steady(run_of(), flow_of([5.0] * 4, power=[np.nan, 2.0, 2.0, 2.0]))
    assert is_steady(run_of(), flow_of([5.0] * 4, power=[0.0] * 4))
    assert not is_steady(run_of(), flow_of([5.0] * 4, power=[-2.0, -2.0, 2.0, 2.0]))


def test_a_filled_machine_has_no_mass_in():
    """Its power and what it holds decide."""
    empty = flow_of([5.0] * 4, np.zeros(4), power=[1.0] * 4).assign(inserted_mass_kg=0.0)
    assert is_steady(run_of(inlet=False), empty)
    assert not is_steady(run_of(), empty)  # fed: nothing came in, so nothing is known


STRUCK = [[0.0, 3.0, 0.0, 0.0], [0.0] * ROWS, [0.0, 0.0, 0.5, 0.0]]  # W, by a particle now and then
SWINGING = [[-9.0, 9.0, -9.0, 9.4], [9.0, -9.0, 9.2, -9.0], [-9.0, 9.0, -9.0, 9.1]]
REACHED = [[0.0] * ROWS, [0.0] * ROWS, [0.9, 1.0, 1.1, 1.0]]  # by material
STILL, RISING = [[1.9, 2.0, 2.1, 2.0]] * 3, [[1.9, 2.0, 2.1, 2.0]] * 2 + [[2.1, 2.2, 2.3, 2.2]]


@pytest.mark.parametrize("power", [STRUCK, SWINGING, [[0.0] * ROWS] * 3], ids=["struck", "swinging", "untouched"])
def test_an_idle_part_is_not_asked(power):
    """Its power is less than what it fluctuates by; the flow decides, and other parts."""
    assert is_steady(run_of(), flow_of([5.0] * 3, power=power))
    assert not is_steady(run_of(), flow_of([5.0] * 3, [9.4] * 3, power=power))
    assert not is_steady(run_of(), flow_of([5.0, 5.0, 5.3], power=power))
    assert is_steady(run_of(), flow_of([5.0] * 3, power=power, power_screw_W=STILL))
    assert not is_steady(run_of(), flow_of([5.0] * 3, power=power, power_screw_W=RISING))


@pytest.mark.parametrize("power", [REACHED, REACHED[::-1], RISING])
def test_a_part_that_takes_power_in_any_block_is_asked(power):
    """Material begins to reach it, or no longer does."""
    assert not is_steady(run_of(), flow_of([5.0] * 3, power=power))


@pytest.mark.parametrize("power", [STRUCK, SWINGING, [[0.0] * ROWS] * 3], ids=["struck", "swinging", "untouched"])
def test_a_filled_machine_is_steady_by_a_part_that_takes_power(power):
    """What it holds is always still: without such a part nothing is known."""
    filled = {"inserted_mass_kg": 0.0, "out_mass_kg": 0.0}
    assert not is_steady(run_of(inlet=False), flow_of([5.0] * 3, power=power).assign(**filled))
    both = flow_of([5.0] * 3, power=power, power_drum_W=STILL).assign(**filled)
    assert is_steady(run_of(inlet=False), both)
    rising = flow_of([5.0] * 3, power=power, power_drum_W=RISING).assign(**filled)
    assert not is_steady(run_of(inlet=False), rising)
