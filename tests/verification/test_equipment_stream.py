"""A stream of known weight wears a liner of equipment as alpha times its weight and speed say."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from bulkwear.postproc.mesh import read_surface
from bulkwear.postproc.statistics.block_means import mean_of_blocks
from bulkwear.postproc.statistics.intervals import CONFIDENCE, difference
from bulkwear.workflows.cases.equipment import blocks, flow
from bulkwear.workflows.cases.equipment.life import part_life
from bulkwear.workflows.cases.equipment.phases import PRISTINE
from bulkwear.workflows.cases.equipment.tables import read_runs, values_of_runs
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.cycles import run_chain
from bulkwear.workflows.engine.schedule import Span
from tests.support.own_machine_project import machine_chain, machine_study
from tests.verification.equipment_stream import (
    RATE,
    SHORT,
    SPEED,
    THICKNESS,
    WIDTH,
    expected_recession,
    stream,
)

pytestmark = [pytest.mark.solver, pytest.mark.verify]

BLOCKS = 8
# Relative; what the solver's set-up takes at the start of a block: it damps sliding contacts by more than friction can,
# which leaves them a spin for some 10 ms.
SET_UP = 0.01
OFF = 0.03  # relative; of a mean over eight blocks, each of some 150 particles that pass; seen 0.005
SPEED_TAKEN = 0.2  # relative; so much slower at most, as each of the three blocks on the way begins with that
REPEATS, REPEATED_BLOCKS = 20, 5
LEAST_LIKELY = 1e-3  # of so few intervals that hold the truth, if they hold it as often as they say
WORN_SHARE = 0.5  # of the liner's mass, at which it is changed
PATCHES = (
    0.3  # relative; means of patches about that of all: paths of particles are not even across the plate, seen 0.1
)
ROUND_OFF = 1e-12
ALPHA, BY_MASS = "wear_coefficient_per_pa", "change_out_worn_mass_fraction"


def sampled(chain) -> SimpleNamespace:
    """What the sampled blocks of a run tell: recession of the liner's upper side (m/h), velocity and pressure there."""
    last = len(list(chain.folder.glob("cycle_*"))) - 1
    tables = [table[table["normal_z"] > 0.5] for table in blocks.patch_tables(chain.folder, last, (PRISTINE,))]
    whole = flow.whole_flow(chain.folder, chain.parameters, last).groupby("cycle").last()
    fed = whole["inserted_mass_kg"].diff().iloc[-len(tables) :]

    def over_area(name):
        return np.array([np.average(table[name], weights=table["area_m2"]) for table in tables])

    return SimpleNamespace(
        tables=tables,
        recession=over_area("recession_m_per_h"),
        pressure=over_area("pressure_Pa"),
        velocity=over_area("sliding_velocity_m_per_s"),
        fed_kg_per_s=fed.mean() / tables[0]["duration_s"].iloc[0],
    )


@pytest.fixture(scope="module")
def once(tmp_path_factory):
    """The stream at the stated rate."""
    folder = tmp_path_factory.mktemp("stream")
    with machine_study(folder, machine=stream(BLOCKS)) as study:
        chain = machine_chain(study, folder / "results/machine")
        run_chain(chain)
        yield SimpleNamespace(run=chain.parameters, chain=chain, **vars(sampled(chain)))


def test_what_is_fed_slides_over_the_liner(once):
    """As much as the study says, at about the speed it was fed with, in one layer."""
    assert once.fed_kg_per_s == pytest.approx(RATE / 3.6, rel=SET_UP)
    assert (1.0 - SPEED_TAKEN) * SPEED < once.velocity.mean() < SPEED


def test_liner_wears_as_the_weight_that_slides_on_it(once):
    """alpha m'' g cos(slope) v lies in the interval of the blocks; so does the weight over the area."""
    found = mean_of_blocks(once.recession)
    low, high = found.interval()
    truth = expected_recession(once.run["wear"][ALPHA], once.fed_kg_per_s)
    assert low - SET_UP * truth < truth < high + SET_UP * truth
    assert found.value == pytest.approx(truth, rel=OFF)  # tighter than the interval of so few blocks
    weight = truth / 3600.0 / once.run["wear"][ALPHA] / once.velocity
    assert once.pressure.mean() == pytest.approx(weight.mean(), rel=3.0 * SET_UP)


def test_every_place_of_the_liner_wears_alike(once):
    """Patches of the upper side scatter about the mean; no other side wears, but for its ends' edges."""
    rates = np.mean([table["recession_m_per_h"] for table in once.tables], axis=0)
    assert np.abs(rates / once.recession.mean() - 1.0).max() < PATCHES
    whole = blocks.patch_tables(once.chain.folder, int(once.tables[-1]["cycle"].iloc[0]), (PRISTINE,))
    volume = sum(table["recession_m_per_h"] * table["area_m2"] for table in whole)
    assert volume[whole[0]["normal_z"] < 0.5].sum() < OFF * volume.sum()  # its end under the last balls on it


def test_alpha_and_hours_do_exactly_what_they_must(once):
    """Of one block: twice the coefficient is twice the recession, twice the hours twice the volume, to rounding."""
    run, chain, number = once.run, once.chain, int(once.tables[-1]["cycle"].iloc[0])
    surface, folder = read_surface(chain.surface), state.cycle_folder(chain.folder, number)
    ledger = pd.read_parquet(folder / "ledger.parquet")
    span = Span(**state.read_state(chain.folder, number)["span"])
    harder = [{**part, ALPHA: 2.0 * part[ALPHA]} for part in run["parts"]]
    single, double = (
        blocks.patch_rows(each, span, chain.folder, surface, ledger)["recession_m_per_h"]
        for each in (run, {**run, "parts": harder})
    )
    np.testing.assert_allclose(double, 2.0 * single, rtol=ROUND_OFF)
    few, many = (
        chain.case.law_volume(run, replace(span, stands_for_s=hours * 3600.0), surface, ledger)
        for hours in (100.0, 200.0)
    )
    assert few.sum() > 0.0
    np.testing.assert_allclose(many, 2.0 * few, rtol=ROUND_OFF)


def test_twice_the_tonnes_wear_twice_as_fast(once, tmp_path):
    """Within the interval of the two runs' ratio."""
    with machine_study(tmp_path, machine=stream(BLOCKS), inlet={"rate_t_per_h": 2.0 * RATE}) as study:
        chain = machine_chain(study, tmp_path / "results/machine")
        run_chain(chain)
        found = sampled(chain)
    ratio = difference(*(mean_of_blocks(each.recession, log=True) for each in (found, once)))
    fed = found.fed_kg_per_s / once.fed_kg_per_s
    low, high = ratio.interval()
    assert fed == pytest.approx(2.0, rel=2.0 * SET_UP)
    assert low * (1.0 - SET_UP) < fed < high * (1.0 + SET_UP)
    assert ratio.value == pytest.approx(fed, rel=2.0 * OFF)


# ---------------------------------------------------------------- life


def test_intervals_of_life_hold_the_long_answer_as_often_as_they_say(tmp_path):
    """Twenty packings, each with an interval of its few blocks: of the life by mass, which thickness over rate is, and
    of that of the place which decides, whose long answer all packings give together."""
    machine = stream(REPEATED_BLOCKS, 0.2, SHORT)
    with machine_study(tmp_path, machine=machine, packings=REPEATS, start_up={"most_s": 0.6}) as study:
        for run in study.runs:
            run_chain(machine_chain(study, tmp_path / "results/machine", run.name))
        values = values_of_runs(study)
    fed = RATE / 3.6
    exact = WORN_SHARE * 1e-3 * THICKNESS / expected_recession(study.runs[0].parameters["wear"][ALPHA], fed)
    volume = liner_volume()
    held = {"mass": 0, "exact": 0, "place": 0}
    for rule, operation in (("mass", {BY_MASS: WORN_SHARE}), ("place", {"change_out_remaining_m": 0.0})):
        told = [{**value, "operation": operation} for value in values]
        folder = tmp_path / "results/machine"
        long = part_life(read_runs(told, folder), "A", "liner", volume).pristine_life
        for value in told:
            low, high = part_life(read_runs([value], folder), "A", "liner", volume).ends(coefficient=False)
            held[rule] += low < long.value < high
            held["exact"] += rule == "mass" and low * (1.0 - SET_UP) < exact < high * (1.0 + SET_UP)
        if rule == "mass":
            assert long.value == pytest.approx(exact, rel=SET_UP + 0.5 * long.width())
    least = stats.binom.ppf(LEAST_LIKELY, REPEATS, CONFIDENCE)
    assert all(count >= least for count in held.values()), held


def liner_volume() -> float:
    """The liner of the short plate, m3."""
    begin, end = SHORT["liner"]
    return 1e-9 * (end - begin) * WIDTH * THICKNESS
