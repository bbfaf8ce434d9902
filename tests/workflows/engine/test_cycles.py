"""The driver on the real solver: what a cycle leaves, and what is checked."""

import json
import os
import re
import shutil
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.mesh import areas, read_surface, stl_corners
from bulkwear.postproc.tables.law_volumes import WornBy, law_measures, maps_of_cycles
from bulkwear.postproc.wear.balance import BALANCE_TOLERANCE
from bulkwear.workflows.engine import cycles, state, wear_step
from bulkwear.workflows.engine.chain import Chain, write_cycle, write_shared_files
from bulkwear.workflows.engine.derived import law_volume
from bulkwear.workflows.engine.inputs import inputs_digest
from bulkwear.workflows.engine.job import Progress
from bulkwear.workflows.engine.ledgers import PRODUCERS
from bulkwear.workflows.engine.machine import interpreter, machine_facts
from bulkwear.workflows.engine.provenance import PROVENANCE, PROVENANCE_FILE, simulating_code
from bulkwear.workflows.engine.schedule import first_span
from bulkwear.workflows.engine.solver import SEARCHES, SolverError
from tests.support.stl import stl_facets
from tests.support.tiny import tiny_chain, tiny_study
from tests.support.tiny_runs import LOOKS, SHORT_STEPS, first_ledger, twin, wear_cycles, wear_table

pytestmark = pytest.mark.solver

STL_ROUNDING = 1e-9  # m; %.9g of coordinates below 0.1 m is good to 5e-11
FORCE_TOLERANCE = 0.1  # relative; ledger and log sample the same fluctuating force at different steps
RANKS_TOLERANCE = 1e-2  # relative; rounding differs between ranks and chaos lets it grow over 290 steps
ALL_SLIDE = 0.01  # relative; what the few contacts that stick, or pull, make. Measured: 0.002
ROUND_OFF = 1e-9  # relative; sums of 290 equal time steps
LEAST_EXCESS = 0.01  # -, of the wear due: the per-triangle rule takes more, seen 0.06 to 0.15; others by rounding
STRETCH_TOLERANCE = 0.05  # relative; a stretch is a whole number of some 29 time steps, the last one what is left
VELOCITY = 1.0  # m/s, of the demo's row
# Relative, of totals: a dump evaluates forces once more, with the velocities of the end of the step, and damping is
# part of the normal force (seen 0.0035, 0.0011 and 0.015).
DUMP_TOLERANCES = {"normal_impulse_N_s": 0.02, "sliding_work_J": 0.02, "rolling_work_J": 0.05}
FINNIE_TOLERANCE = 1e-6  # of the largest triangle; the solver's file has six digits
FASTEST, SLOWEST = 1e-8, 1e-3  # s of a processor per particle step; seen 1e-6, of few particles more


@pytest.fixture(scope="module")
def looked_into(finished):
    """The same run with a look at its wear every 2 mm and at its bed every mm."""
    study = tiny_study(solver=LOOKS)
    folder = finished.folder.parent / "looked_into"
    chain = replace(twin(finished, folder), parameters=study.run(finished.name).parameters)
    cycles.run_chain(chain)
    return chain


def test_every_cycle_leaves_its_contract(finished):
    """Deck, log, restart and state in every cycle; ledger, worn surface and forces in every wear cycle; nothing that
    the ledger was made from."""
    for cycle in range(wear_cycles(finished) + 1):
        folder = state.cycle_folder(finished.folder, cycle)
        names = {path.name for path in folder.iterdir()}
        assert {"deck.in", "log.liggghts", "run.restart", "surface.stl", "state.json"} <= names
        of_wear = {"ledger.parquet", "surface.vtu", "forces.csv", "wear_history.csv", "flow.parquet"}
        assert of_wear & names == (of_wear if cycle else set())
        assert not names & {"contacts.dump", "spins.dump", "touching.npy"}
        assert not [name for name in names if name.startswith("load_ledger.bin")]
        said = state.read_state(finished.folder, cycle)["solver_ledger"]
        assert (said is not None) == (cycle > 0), said


def test_every_simulation_says_what_made_it(finished):
    """Code, solver's programs, machine, speed and date stand in the state of each cycle and beside the bed; the digest
    of the run's inputs knows none of them."""
    code, inputs = simulating_code(finished.case), inputs_digest(finished)
    cycles_found = [state.read_state(finished.folder, cycle) for cycle in range(wear_cycles(finished) + 1)]
    bed = json.loads((finished.bed_restart.parent / PROVENANCE_FILE).read_text())
    for found in (*(each[PROVENANCE] for each in cycles_found), bed):
        assert {key: found[key] for key in code} == code
        assert found["machine"] == machine_facts() | interpreter()
        assert FASTEST < found["solver_s_per_particle_step"] < SLOWEST
        assert any(name.startswith("libliggghts") for name in found["programs"])
    assert {"liggghts-ledger" in each[PROVENANCE]["programs"] for each in cycles_found[1:]} == {True}
    assert {each["inputs"] for each in cycles_found} == {inputs}


def test_applied_plus_carried_is_alpha_times_work_at_every_cycle(finished):
    """Nothing is lost: applied so far + carried now = alpha x sliding work so far."""
    table, wear = wear_table(finished), finished.parameters["wear"]
    alpha = wear["wear_coefficient_per_pa"] * wear["acceleration"]
    balance = table["total_applied_volume_m3"] + table["carried_volume_m3"]
    work = table["sliding_work_J"].cumsum()
    assert (work > 0).all()
    np.testing.assert_allclose(balance, alpha * work, rtol=BALANCE_TOLERANCE)


def history_of(chain, cycle: int) -> pd.DataFrame:
    return pd.read_csv(state.cycle_folder(chain.folder, cycle) / "wear_history.csv")


def test_wear_within_a_cycle_adds_up_to_it(looked_into):
    """Stretches of equal travel, none without wear; work, volumes and impulse add up to the cycle's row of wear.csv."""
    table, step = wear_table(looked_into), looked_into.parameters["derived"]["time_step_s"]
    travelled = 0.0
    for _, row in table.iterrows():
        stretches = history_of(looked_into, int(row["cycle"]))
        lengths = np.diff(stretches["travel_m"], prepend=travelled)
        np.testing.assert_allclose(lengths, 0.002, rtol=STRETCH_TOLERANCE)
        travelled = row["travel_m"]
        assert stretches["travel_m"].iloc[-1] == pytest.approx(travelled, rel=ROUND_OFF)
        assert (stretches["worn_volume_m3"] > 0).all()
        for name in ("sliding_work_J", "worn_volume_m3", "base_worn_volume_m3", "pattern_worn_volume_m3"):
            assert stretches[name].sum() == pytest.approx(row[name], rel=ROUND_OFF)
        duration = np.diff(stretches["time_s"], prepend=stretches["time_s"].iloc[0] - lengths[0] / VELOCITY)
        mean = np.average(stretches["mean_normal_force_N"], weights=duration)
        assert mean == pytest.approx(row["mean_normal_force_N"], rel=10 * step / duration.sum())


def test_looking_into_a_cycle_does_not_change_it(looked_into, finished):
    """The motion goes on undisturbed between looks: the same ledger to the last bit as with a look at the end only."""
    one, other = (
        pd.read_parquet(state.cycle_folder(chain.folder, 1) / "ledger.parquet") for chain in (looked_into, finished)
    )
    pd.testing.assert_frame_equal(one, other, check_exact=True)


def test_snapshots_do_not_fill_the_disk(looked_into):
    """Of the snapshots of a cycle one is left, whatever their number; all of them are in the bins of its flow."""
    for cycle in range(1, wear_cycles(looked_into) + 1):
        folder = state.cycle_folder(looked_into.folder, cycle)
        assert len(list(folder.glob("bed_*.dump"))) == 1
        flow = pd.read_parquet(folder / "flow.parquet")
        assert flow.groupby("travel_start_m")["frames"].first().sum() == 10  # every mm of 10 mm
        central = flow[flow["zone"] == "central"]
        assert central["velocity_y_m_per_s"].dropna().between(0.0, 1.5 * VELOCITY).all()


def test_a_cycle_whose_flow_is_lost_is_done_again(looked_into, tmp_path):
    """Without its bins, and with its snapshots gone, a cycle is not whole: it and what follows are simulated again."""
    chain = twin(looked_into, tmp_path)
    for cycle in range(3):
        shutil.copytree(state.cycle_folder(looked_into.folder, cycle), state.cycle_folder(chain.folder, cycle))
    inputs = inputs_digest(chain)
    assert state.finished_cycles(chain.folder, inputs) == 3
    (state.cycle_folder(chain.folder, 2) / "flow.parquet").unlink()
    assert state.finished_cycles(chain.folder, inputs) == 2


def test_wear_stays_on_the_top_surface_and_goes_inward(finished):
    """The skirt's outer nodes stay, nothing rises, and the largest loss is the one the table tells."""
    before, after = read_surface(finished.surface), read_surface(finished.folder / "worn_surface.vtu")
    holder_only = np.setdiff1d(
        before.triangles[before.cell_data["part"] < 0], before.triangles[before.cell_data["part"] >= 0]
    )
    np.testing.assert_array_equal(before.points[holder_only], after.points[holder_only])
    assert (after.points[:, 2] <= before.points[:, 2]).all()
    assert after.point_data["removed_thickness_m"].max() == wear_table(finished)["largest_depth_m"].iloc[-1] > 0


def test_worn_surface_goes_back_into_the_solver(finished):
    """The solver's mesh in cycle 2 is the surface that cycle 1 left."""
    facets = stl_facets(state.cycle_folder(finished.folder, 2) / "surface.stl")
    surface = read_surface(state.cycle_folder(finished.folder, 1) / "surface.vtu")
    np.testing.assert_allclose(facets, stl_corners(surface.points, surface.triangles), atol=STL_ROUNDING)
    assert not np.array_equal(surface.points, read_surface(finished.surface).points)


def test_ledger_impulse_agrees_with_the_solver_own_force(finished):
    """The vertical force that the solver prints is what the ledger sums on a plain plate: all normals point up."""
    plain = tiny_chain(tiny_study(sliding={"cycles": 1}), finished.folder.parent, "R9_plain")
    cycles.run_chain(plain)
    forces = pd.read_csv(state.cycle_folder(plain.folder, 1) / "forces.csv")
    ledger = pd.read_parquet(state.cycle_folder(plain.folder, 1) / "ledger.parquet")
    derived = plain.parameters["derived"]
    summed = ledger["normal_impulse_N_s"].sum() / (derived["travel_steps"] * derived["time_step_s"])
    assert -forces["force_z_N"].mean() == pytest.approx(summed, rel=FORCE_TOLERANCE)


def test_a_rigid_sample_carries_all_its_wear(finished, tmp_path):
    """deform: false keeps every node where it is; the volume is carried, not lost."""
    chain = tiny_chain(tiny_study(wear={"deform": False}, sliding={"cycles": 1}), tmp_path)
    cycles.run_chain(chain)
    table = wear_table(chain)
    assert table["applied_volume_m3"].abs().max() <= BALANCE_TOLERANCE * table["worn_volume_m3"].sum()
    np.testing.assert_array_equal(
        read_surface(chain.surface).points, read_surface(chain.folder / "worn_surface.vtu").points
    )


def test_adaptive_cycles_end_with_the_travel(finished, tmp_path):
    """Cycles of unequal length add up to the travel; each is planned from the one before, and the balance closes."""
    changes = {"sliding": {"cycles": "adaptive", "first_cycle_mm": 4}, "wear": {"largest_step_edge_fraction": 3e-5}}
    chain = tiny_chain(tiny_study(**changes), tmp_path)
    cycles.run_chain(chain)
    table, derived = wear_table(chain), chain.parameters["derived"]
    spans = [state.read_state(chain.folder, cycle)["span"] for cycle in table["cycle"]]
    assert len({span["steps"] for span in spans}) > 1
    assert sum(span["steps"] for span in spans) == derived["travel_steps"]
    assert table["travel_m"].iloc[-1] == pytest.approx(chain.parameters["sliding"]["travel_m"])
    assert (table["step_demand"] > 0).all() and (table["balance_error"] < 1e-6).all()


@pytest.mark.parametrize("wear", [{"patch": "none"}, {"patch": "physical"}, {"scheme": "per_triangle"}])
def test_other_ways_to_wear_run_too(finished, tmp_path, wear):
    """Without a patch, with that of the true contact, and by the per-triangle rule: a worn sample and its balance."""
    chain = twin(finished, tmp_path)
    shutil.copytree(state.cycle_folder(finished.folder, 1), state.cycle_folder(chain.folder, 1))
    chain = replace(chain, parameters=tiny_study(wear=wear).run(chain.name).parameters)
    ledger = pd.read_parquet(state.cycle_folder(finished.folder, 1) / "ledger.parquet")
    row = wear_step.wear(chain, first_span(chain.parameters), tmp_path, read_surface(chain.surface), ledger)
    assert row["applied_volume_m3"] > 0
    excess = row["total_excess_volume_m3"] / row["worn_volume_m3"]
    assert (excess > LEAST_EXCESS) == (wear.get("scheme") == "per_triangle")


@pytest.mark.parametrize("then", ["stop", "cap", "go_on"])
def test_a_part_that_is_worn_through(finished, tmp_path, capsys, then):
    """With half the first cycle's depth as thickness the sample is worn through in that cycle: it stops at its back
    and the run ends or goes on, or it wears on behind it; each says so, and its balance closes."""
    half = 0.5 * wear_table(finished)["largest_depth_m"].iloc[0]
    study = tiny_study(wear={"local_thickness_mm": 1e3 * half, "worn_through": then})
    chain = replace(twin(finished, tmp_path), parameters=study.run(finished.name).parameters)
    cycles.run_chain(chain)
    table = wear_table(chain)
    assert len(table) == (1 if then == "stop" else wear_cycles(chain))
    assert table["through_nodes"].iloc[0] > 0
    assert "worn through at" in capsys.readouterr().err
    assert state.read_state(chain.folder, 1)["worn_through"].startswith("worn through at")
    assert (table["balance_error"] < 1e-6).all()
    surface = read_surface(chain.folder / "worn_surface.vtu")
    deepest = surface.point_data["lost_thickness_m"].max()
    assert (deepest > half * (1.0 + 1e-6)) == (then == "go_on")
    assert (table["beyond_back_volume_m3"].sum() > 0.0) == (then != "go_on")
    assert np.nanmin(surface.point_data["remaining_thickness_m"]) == 0.0  # the holder has none


def test_two_ranks_write_the_same_ledger(finished, tmp_path):
    """Under MPI every contact is counted once: from the same restart, two ranks account the same sums as one."""
    found = first_ledger(replace(twin(finished, tmp_path), ranks=2), finished)
    expected = pd.read_parquet(state.cycle_folder(finished.folder, 1) / "ledger.parquet")
    for field in ("sliding_work_J", "normal_impulse_N_s", "contact_time_s"):
        assert found[field].sum() == pytest.approx(expected[field].sum(), rel=RANKS_TOLERANCE)


@pytest.fixture(scope="module")
def both_ledgers(finished, tmp_path_factory):
    """The first wear cycle by Finnie's law, accounted by the solver and from dumps of every step."""
    ledgers = {}
    for name in PRODUCERS:
        solver = {"sampling_interval_steps": 1, **SHORT_STEPS}
        study = tiny_study(ledger=name, wear={"law": "finnie"}, solver=solver)
        chain = twin(finished, tmp_path_factory.mktemp(name))
        ledgers[name] = first_ledger(replace(chain, parameters=study.run(chain.name).parameters), finished)
    return ledgers


def test_laws_side_by_side_find_the_volume_that_the_run_wore_by(finished):
    """The sum over ledgers and surfaces is that of wear.csv; where all slides, friction works by its coefficient."""
    ((own, given),) = finished.case.laws(finished.parameters)
    measures = law_measures(maps_of_cycles(finished.folder, WornBy(own, given)))
    volumes = {law: each["worn_volume_m3"] for law, each in measures.items()}
    assert volumes[own] == pytest.approx(wear_table(finished)["worn_volume_m3"].sum(), rel=ROUND_OFF)
    friction = finished.parameters["sample_material"]["contact"]["sliding_friction"]
    assert volumes["tangential_work"] == pytest.approx(friction * volumes["archard"], rel=ALL_SLIDE)


def test_both_producers_write_the_same_ledger(both_ledgers):
    """Same columns, same contacts at every step of the same simulation; the dump's forces are evaluated once more."""
    exact, sampled = both_ledgers["solver"], both_ledgers["dumps"]
    assert list(exact.dtypes.items()) == list(sampled.dtypes.items())
    np.testing.assert_array_equal(exact["finnie_wear"], sampled["finnie_wear"])  # the solver's own: one simulation
    np.testing.assert_allclose(exact["contact_time_s"], sampled["contact_time_s"], rtol=ROUND_OFF)
    np.testing.assert_array_equal(exact.isna(), sampled.isna())
    for field, tolerance in DUMP_TOLERANCES.items():
        assert sampled[field].sum() == pytest.approx(exact[field].sum(), rel=tolerance)


def test_the_finnie_kernel_is_the_solver_own_wear(both_ledgers, finished):
    """k finnie_work / A is what `wear finnie` counts in the same run, triangle by triangle."""
    surface, ledger = read_surface(finished.surface), both_ledgers["solver"]
    volume = law_volume({"wear": {**finished.parameters["wear"], "law": "finnie"}}, ledger)
    expected = ledger["finnie_wear"].to_numpy() * areas(surface.points, surface.triangles)
    assert expected.max() > 0
    np.testing.assert_allclose(volume, expected, atol=FINNIE_TOLERANCE * expected.max(), rtol=0)


def test_sampled_contacts_wear_a_sample_too(tmp_path):
    """A whole run with any LIGGGHTS: contacts that outlast a cycle are handed on, and no dump is left."""
    chain = tiny_chain(tiny_study(ledger="dumps"), tmp_path)
    cycles.run_chain(chain)
    for cycle in (1, 2):
        names = {path.name for path in state.cycle_folder(chain.folder, cycle).iterdir()}
        assert {"ledger.parquet", "touching.npy"} <= names and not names & {"contacts.dump", "spins.dump"}
        assert state.read_state(chain.folder, cycle)["solver_ledger"] is None
    assert (wear_table(chain)["sliding_work_J"] > 0).all()
    costs = pd.read_csv(chain.folder / "cost.csv")
    assert (costs["ledger_bytes"] > 0).tolist() == [False, True, True]
    assert costs["processor_s"].between(0.0, costs["solver_s"], inclusive="neither").all()  # one rank, one processor


@pytest.mark.verify
@pytest.mark.parametrize("rolling_friction", ["epsd2"])
def test_other_rolling_friction_runs(tmp_path, rolling_friction):
    """The elastic-plastic rolling model is a word in the configuration, and the solver takes it."""
    chain = tiny_chain(tiny_study(solver={"rolling_friction": rolling_friction}, sliding={"cycles": 1}), tmp_path)
    cycles.run_chain(chain)
    assert wear_table(chain)["sliding_work_J"].iloc[0] > 0


def test_what_the_driver_takes_itself_is_told(finished, tmp_path):
    """Its processor time of each cycle, no more than the clock's but for what libraries do side by side; nothing of a
    cycle that an earlier version left.
    """
    chain = replace(finished, folder=shutil.copytree(finished.folder, tmp_path / finished.name))
    told = pd.read_csv(chain.folder / "cost.csv")
    assert (told[cycles.OWN_TIME] > 0.0).all()
    assert (told[cycles.OWN_TIME] < (os.cpu_count() or 1) * told["other_s"] + 0.1).all()
    record = state.read_state(chain.folder, 0)
    del record["cost"][cycles.OWN_TIME]
    state.write_state(state.cycle_folder(chain.folder, 0), record.pop("inputs"), tuple(record.pop("files")), record)
    cycles.write_products(chain, len(told))
    again = pd.read_csv(chain.folder / "cost.csv")
    assert again[cycles.OWN_TIME].isna().tolist() == [True, *[False] * (len(told) - 1)]


@pytest.mark.parametrize("search", SEARCHES)
def test_the_study_says_who_searches(tmp_path, monkeypatch, search):
    """For contacts with meshes in cycles, cycle 0 included."""
    asked = []

    def stopped(folder, *given, **settings):
        asked.append(settings["search"])
        raise SolverError("stopped")

    monkeypatch.setattr(cycles, "run_deck", stopped)
    study = tiny_study(solver={"search": search})
    run, bed = study.run("R9_convex").parameters, study.beds["bed_R5"]
    chain = Chain("R9_convex", tmp_path, study.case, run, tmp_path / "surface.vtu", bed)
    for span in (None, first_span(run)):
        with pytest.raises(SolverError, match="stopped"):
            cycles.simulate(chain, span, tmp_path, {}, Progress("R9_convex", 1))
    assert asked == [search, search]


def test_missing_triangles_stop_the_run(finished, tmp_path):
    """A surface of which the solver drops a triangle ends the run with both counts."""
    chain = twin(finished, tmp_path)
    shutil.copytree(state.cycle_folder(finished.folder, 0), state.cycle_folder(chain.folder, 0))
    folder = chain.folder / "cycle_001.part"
    folder.mkdir()
    surface = read_surface(chain.surface)
    write_shared_files(chain)
    span = first_span(chain.parameters)
    write_cycle(chain, span, folder, surface)
    count = len(surface.triangles)
    with pytest.raises(SolverError, match=re.escape(f"keeps {count} of the {count + 1} triangles of mesh sample_1")):
        cycles.simulate(chain, span, folder, {f"sample_{span.cycle}": count + 1}, Progress("test", 1))
