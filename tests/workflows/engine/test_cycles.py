"""The driver on the real solver: what a cycle leaves, what is checked, and what a killed run keeps."""

import json
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.mesh import areas, read_surface, stl_corners
from bulkwear.postproc.readers.load_ledger import LoadLedgerError
from bulkwear.postproc.tables.law_volumes import WornBy, law_measures, maps_of_cycles
from bulkwear.postproc.tables.summary import run_summary
from bulkwear.postproc.wear.balance import BALANCE_TOLERANCE
from bulkwear.workflows.engine import cycles, state, wear_step
from bulkwear.workflows.engine.accounting import HISTORY, LEDGER, account, account_and_wear
from bulkwear.workflows.engine.case import FORCES
from bulkwear.workflows.engine.chain import Chain, write_cycle, write_shared_files
from bulkwear.workflows.engine.derived import law_volume
from bulkwear.workflows.engine.inputs import inputs_digest, run_digest
from bulkwear.workflows.engine.job import Progress
from bulkwear.workflows.engine.ledgers import PRODUCERS
from bulkwear.workflows.engine.machine import interpreter, machine_facts
from bulkwear.workflows.engine.pieces import PIECES
from bulkwear.workflows.engine.provenance import PROVENANCE, PROVENANCE_FILE, simulating_code
from bulkwear.workflows.engine.schedule import first_span
from bulkwear.workflows.engine.solver import SEARCHES, SolverError
from tests import REPOSITORY
from tests.support.patience import LONGEST_S
from tests.support.stl import stl_facets
from tests.support.tiny import tiny_chain, tiny_study

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
# Relative, of totals: what chaos makes of them (seen 0.013). Finnie's wear hangs on few impacts (seen 0.05); half of it
# would be lost, were it not in the restart file.
PIECES_TOLERANCES = {"sliding_work_J": 2e-2, "normal_impulse_N_s": 2e-2, "contact_time_s": 2e-2, "finnie_wear": 0.2}
SHORT_STEPS = {"rayleigh_fraction": 0.2}  # where forces that are evaluated once more are compared
LOOKS = {"wear_interval_mm": 2, "picture_interval_mm": 1}
FASTEST, SLOWEST = 1e-8, 1e-3  # s of a processor per particle step; seen 1e-6, of few particles more
DRIVER = """
import pickle, sys
from bulkwear.workflows.engine.cycles import run_chain
run_chain(pickle.load(open(sys.argv[1], "rb")))
"""


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """An undisturbed run of the convex sample."""
    chain = tiny_chain(tiny_study(), tmp_path_factory.mktemp("undisturbed"))
    cycles.run_chain(chain)
    return chain


@pytest.fixture(scope="module")
def looked_into(finished):
    """The same run with a look at its wear every 2 mm and at its bed every mm."""
    study = tiny_study(solver=LOOKS)
    folder = finished.folder.parent / "looked_into"
    chain = replace(twin(finished, folder), parameters=study.run(finished.name).parameters)
    cycles.run_chain(chain)
    return chain


def twin(chain, folder: Path):
    """The same run elsewhere, nothing of it done yet."""
    copy = folder / chain.name
    copy.mkdir(parents=True)
    shutil.copy(chain.surface, copy / "surface.vtu")
    return replace(chain, folder=copy, surface=copy / "surface.vtu")


def wear_cycles(chain) -> int:
    return chain.parameters["sliding"]["cycles"]


def wear_table(chain) -> pd.DataFrame:
    return pd.read_csv(chain.folder / "wear.csv")


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


def first_ledger(chain, finished) -> pd.DataFrame:
    """Ledger of a chain's first wear cycle, from the restart file of the undisturbed run."""
    shutil.copytree(state.cycle_folder(finished.folder, 0), state.cycle_folder(chain.folder, 0))
    folder = state.cycle_folder(chain.folder, 1)
    folder.mkdir()
    surface = read_surface(chain.surface)
    write_shared_files(chain)
    span = first_span(chain.parameters)
    write_cycle(chain, span, folder, surface)
    cycles.simulate(chain, span, folder, {f"sample_{span.cycle}": len(surface.triangles)}, Progress(chain.name, 1))
    return account(chain, span, folder, chain.case.pieces(chain.parameters, span, surface))


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


# ---------------------------------------------------------------- killed and started again


def start_driver(chain, folder: Path) -> subprocess.Popen:
    task = folder / "chain.pickle"
    task.write_bytes(pickle.dumps(chain))
    return subprocess.Popen([sys.executable, "-c", DRIVER, str(task)], cwd=REPOSITORY)


def kill_when(process: subprocess.Popen, moment) -> None:
    """SIGKILL the driver at a moment, and wait until its solver is gone too."""
    deadline = time.monotonic() + LONGEST_S
    while not moment():
        assert process.poll() is None, "the driver ended before the moment to kill it"
        assert time.monotonic() < deadline, "the moment to kill the driver never came"
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()


def solver_processes(folder: Path) -> list[int]:
    """Process ids of solvers that work below a folder."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and str(folder) in os.readlink(entry / "cwd"):
                found.append(int(entry.name))
        except OSError:
            continue
    return found


def wait_until_no_solver(folder: Path) -> None:
    deadline = time.monotonic() + LONGEST_S
    while solver_processes(folder):
        assert time.monotonic() < deadline, "a solver outlived its driver"
        time.sleep(0.05)


MOMENTS = {
    "while the bed is lowered": lambda run: (run / "cycle_000.part" / "screen.txt").exists(),
    "while cycle 1 is simulated": lambda run: (run / "cycle_001.part" / "bed_0.dump").exists(),
    "while cycle 1 is accounted": lambda run: (run / "cycle_001.part" / "run.restart").exists(),
    "while cycle 2 is simulated": lambda run: (run / "cycle_002.part" / "screen.txt").exists(),
}


# Moments of the same kind as another one that is tried.
SELDOM = {
    "while the bed is lowered",
    "while cycle 1 is simulated",
    "while cycle 1 is accounted",
    "after the first piece of the run-in",
}


def without_seldom(moments):
    """Parameters: those of SELDOM for `make verify` alone."""
    return [pytest.param(each, marks=pytest.mark.verify) if each in SELDOM else each for each in moments]


@pytest.mark.parametrize("moment", without_seldom(MOMENTS))
def test_killed_and_started_again_gives_the_same_tables(finished, tmp_path, moment):
    """kill -9 at any moment, start again: the same wear.csv and summary, finished cycles untouched, no orphan."""
    chain = twin(finished, tmp_path)
    kill_when(start_driver(chain, tmp_path), lambda: MOMENTS[moment](chain.folder))
    wait_until_no_solver(tmp_path)
    done = {path: path.stat().st_mtime_ns for path in chain.folder.glob("cycle_???/*")}
    cycles.run_chain(chain)
    assert (chain.folder / "wear.csv").read_bytes() == (finished.folder / "wear.csv").read_bytes()
    assert run_summary(wear_table(chain)) == run_summary(wear_table(finished))
    assert {path: path.stat().st_mtime_ns for path in done} == done


@pytest.fixture(scope="module")
def in_pieces(tmp_path_factory):
    """An undisturbed run of one wear cycle whose simulation is started anew every few hundred steps."""
    changes = {"solver": {**LOOKS, "checkpoint_interval_steps": 125}, "sliding": {"cycles": 1}}
    chain = tiny_chain(tiny_study(**changes), tmp_path_factory.mktemp("pieces"))
    cycles.run_chain(chain)
    return chain


def pieces_done(folder: Path) -> list[dict[str, float]]:
    """The finished pieces of a cycle that is being worked on."""
    return json.loads((folder / PIECES).read_text())["pieces"] if (folder / PIECES).exists() else []


MOMENTS_IN_PIECES = {
    "after the first piece of the run-in": ("cycle_000.part", 1, "lowering and run-in"),
    "after the third piece of cycle 1": ("cycle_001.part", 3, "cycle 1 of 1"),
}


@pytest.mark.verify
@pytest.mark.parametrize("moment", without_seldom(MOMENTS_IN_PIECES))
def test_killed_within_a_cycle_it_goes_on_from_its_newest_piece(in_pieces, tmp_path, capfd, moment):
    """kill -9 within a cycle and a second start: no finished piece is simulated again, and ledger, forces, history and
    tables are bit for bit those of the undisturbed run."""
    folder, count, title = MOMENTS_IN_PIECES[moment]
    chain = twin(in_pieces, tmp_path)
    kill_when(start_driver(chain, tmp_path), lambda: len(pieces_done(chain.folder / folder)) >= count)
    wait_until_no_solver(tmp_path)
    begun = pieces_done(chain.folder / folder)[-1]["end"]
    capfd.readouterr()
    cycles.run_chain(chain)
    assert f"{chain.name}: {title} goes on after step {begun}" in capfd.readouterr().err
    for name in ("wear.csv", *(f"cycle_001/{each}" for each in (LEDGER, FORCES, HISTORY, "run.restart"))):
        assert (chain.folder / name).read_bytes() == (in_pieces.folder / name).read_bytes(), name
    left = {path.name for path in state.cycle_folder(chain.folder, 1).iterdir()}
    assert left == {path.name for path in state.cycle_folder(in_pieces.folder, 1).iterdir()}
    assert not [name for name in left if name.startswith(("piece", "checkpoint"))]


@pytest.mark.verify
def test_a_fault_while_a_cycle_is_accounted_costs_no_simulation(in_pieces, tmp_path, monkeypatch):
    """What ends the driver between the last piece and the state of a cycle: the next start accounts the cycle again,
    without the solver, and leaves what the undisturbed run left."""
    chain = twin(in_pieces, tmp_path)

    def ended(*given):
        account_and_wear(*given)
        raise KeyboardInterrupt

    with monkeypatch.context() as first, pytest.raises(KeyboardInterrupt):
        first.setattr(cycles, "account_and_wear", ended)
        cycles.run_chain(chain)
    monkeypatch.setattr(cycles, "run_deck", lambda *given, **named: pytest.fail("the solver was started"))
    cycles.run_chain(chain)
    for name in ("wear.csv", *(f"cycle_001/{each}" for each in (LEDGER, FORCES, HISTORY, "run.restart"))):
        assert (chain.folder / name).read_bytes() == (in_pieces.folder / name).read_bytes(), name
    flows = [pd.read_parquet(run.folder / "cycle_001" / "flow.parquet") for run in (chain, in_pieces)]
    pd.testing.assert_frame_equal(*flows, check_exact=True)
    left, expected = ({path.name for path in (run.folder / "cycle_001").iterdir()} for run in (chain, in_pieces))
    assert left == expected


@pytest.mark.verify
def test_a_simulation_in_pieces_is_the_simulation(tmp_path):
    """From the same restart, a cycle in pieces has the ledger of the whole one, Finnie's wear and history included.

    The solver evaluates forces once more at each start, and chaos lets that grow over some hundred steps.
    """
    whole = tiny_chain(tiny_study(solver=LOOKS | SHORT_STEPS), tmp_path / "whole")
    cycles.run_chain(whole)
    chain = twin(whole, tmp_path)
    solver = {**chain.parameters["solver"], "checkpoint_interval_steps": 250}
    found = first_ledger(replace(chain, parameters={**chain.parameters, "solver": solver}), whole)
    expected = pd.read_parquet(state.cycle_folder(whole.folder, 1) / LEDGER)
    for field, tolerance in PIECES_TOLERANCES.items():
        assert found[field].sum() == pytest.approx(expected[field].sum(), rel=tolerance), field
    looks = pd.read_csv(state.cycle_folder(whole.folder, 1) / HISTORY)
    assert len(list(state.cycle_folder(chain.folder, 1).glob("load_ledger.bin.*"))) == len(looks) - 1


def test_a_finished_run_is_not_done_again(finished):
    """Started once more, a finished run only writes its tables."""
    before = {path: path.stat().st_mtime_ns for path in finished.folder.glob("cycle_???/*")}
    cycles.run_chain(finished)
    assert {path: path.stat().st_mtime_ns for path in finished.folder.glob("cycle_???/*")} == before


def test_the_same_simulation_is_run_once(finished, tmp_path, monkeypatch):
    """A run with the inputs of a finished one gets its tables and its surface without the solver, at no cost."""
    monkeypatch.setattr(cycles, "run_deck", lambda *given, **named: pytest.fail("the solver was called"))
    chain = replace(twin(finished, tmp_path), name="R1_convex", same_as=finished.folder)
    cycles.run_chain(chain)
    for name in ("wear.csv", "worn_surface.vtu"):
        assert (chain.folder / name).read_bytes() == (finished.folder / name).read_bytes()
    cost, paid = (pd.read_csv(folder / "cost.csv") for folder in (chain.folder, finished.folder))
    assert not cost[["solver_s", "other_s", cycles.OWN_TIME]].any(axis=None)
    assert paid["solver_s"].all() and cost["particles"].equals(paid["particles"])


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


def test_changed_inputs_are_not_reused_and_nothing_is_lost(finished, tmp_path):
    """Another wear coefficient: cycles are done again, the old ones are kept and come back with the old inputs."""
    chain = twin(finished, tmp_path)
    copy_cycles(finished, chain)
    doubled = replace(
        chain,
        parameters={**chain.parameters, "wear": {**chain.parameters["wear"], "gap_closing_fraction": 0.1}},
    )
    cycles.run_chain(doubled)
    assert (chain.folder / "wear.csv").read_bytes() != (finished.folder / "wear.csv").read_bytes()
    assert len(list(chain.folder.glob("superseded/*/cycle_???"))) == wear_cycles(chain) + 1
    old = (state.cycle_folder(finished.folder, 1) / "log.liggghts").read_bytes()
    cycles.run_chain(chain)
    assert (chain.folder / "wear.csv").read_bytes() == (finished.folder / "wear.csv").read_bytes()
    assert (state.cycle_folder(chain.folder, 1) / "log.liggghts").read_bytes() == old


def copy_cycles(source, target) -> None:
    for cycle in range(wear_cycles(source) + 1):
        shutil.copytree(state.cycle_folder(source.folder, cycle), state.cycle_folder(target.folder, cycle))


def test_a_damaged_cycle_is_done_again(finished, tmp_path):
    """A restart file that changed after its state was written does not count: its cycle is simulated again."""
    chain = twin(finished, tmp_path)
    copy_cycles(finished, chain)
    inputs = inputs_digest(chain)
    assert state.finished_cycles(chain.folder, inputs) == wear_cycles(chain) + 1
    with open(state.cycle_folder(chain.folder, 1) / "run.restart", "ab") as restart:
        restart.write(b"damage")
    assert state.finished_cycles(chain.folder, inputs) == 1
    cycles.run_chain(chain)
    assert state.finished_cycles(chain.folder, inputs) == wear_cycles(chain) + 1
    assert (chain.folder / "wear.csv").read_bytes() == (finished.folder / "wear.csv").read_bytes()


def test_a_cycle_with_a_cut_restart_file_is_done_again(finished, tmp_path, capfd):
    """A restart file that was cut by a full disk, under a state that says it is as it was: the run falls back by
    itself, and says so."""
    chain = twin(finished, tmp_path)
    copy_cycles(finished, chain)
    folder = state.cycle_folder(chain.folder, wear_cycles(chain))
    record = state.read_state(chain.folder, wear_cycles(chain))
    os.truncate(folder / "run.restart", 4096)
    state.write_state(folder, record.pop("inputs"), tuple(record.pop("files")), record)
    cycles.run_chain(chain)
    said = capfd.readouterr().err
    assert f"{folder / 'run.restart'}: the restart file of 4096 bytes is not whole" in said
    assert f"{folder.name} is made again" in said
    assert (chain.folder / "wear.csv").read_bytes() == (finished.folder / "wear.csv").read_bytes()


@pytest.mark.parametrize(
    ("kept", "finished_cycles", "there"),
    [("few", 4, {0, 2, 3}), ("few", 24, {0, 10, 20, 22, 23}), ("few", 2, {0, 1}), ("all", 24, set(range(24)))],
)
def test_restart_files_that_no_resume_needs_go(tmp_path, kept, finished_cycles, there):
    """Those of cycle 0, of every tenth cycle and of the last two stay, or all; states of the others do without."""
    study = tiny_study(solver={"kept_restarts": kept})
    chain = Chain("R9_convex", tmp_path, study.case, study.run("R9_convex").parameters, tmp_path / "surface.vtu")
    for cycle in range(finished_cycles):
        folder = state.cycle_folder(tmp_path, cycle)
        folder.mkdir()
        for name in ("run.restart", "surface.vtu"):
            (folder / name).write_text(name)
        state.write_state(folder, "same", ("run.restart", "surface.vtu"), {})
    for count in range(1, finished_cycles + 1):
        cycles.drop_restarts(chain, count)
    folders = {cycle: state.cycle_folder(tmp_path, cycle) for cycle in range(finished_cycles)}
    assert {cycle for cycle, folder in folders.items() if (folder / "run.restart").exists()} == there
    assert state.finished_cycles(tmp_path, "same", ("run.restart", "surface.vtu")) == finished_cycles
    (folders[finished_cycles - 1] / "run.restart").write_text("damage")
    assert state.finished_cycles(tmp_path, "same", ("run.restart", "surface.vtu")) == finished_cycles - 1


@pytest.mark.parametrize(("setting", "values"), [("kept_restarts", ("few", "all")), ("search", SEARCHES)])
def test_what_changes_no_number_changes_no_input(setting, values):
    """Neither which restart files are kept nor who searches is a reason to simulate again."""
    assert len({inputs_of(tiny_study(solver={setting: value})) for value in values}) == 1


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


def inputs_of(study):
    return run_digest(study.case, study.run("R9_convex").parameters, study.beds[study.bed_of("R9_convex")])


@pytest.mark.verify
def test_a_cycle_whose_ledger_cannot_be_read_is_simulated_again(in_pieces, tmp_path, monkeypatch):
    """What the solver left half is not accounted for ever: the next start simulates the cycle, to the same end."""
    chain = twin(in_pieces, tmp_path)

    def cut(chain, span, folder, surface):
        os.truncate(folder / "load_ledger.bin", 100)
        return account_and_wear(chain, span, folder, surface)

    with monkeypatch.context() as first, pytest.raises(LoadLedgerError, match=r"simulates cycle 1 of 1 again"):
        first.setattr(cycles, "account_and_wear", cut)
        cycles.run_chain(chain)
    assert not pieces_done(chain.folder / "cycle_001.part")
    cycles.run_chain(chain)
    assert (chain.folder / "wear.csv").read_bytes() == (in_pieces.folder / "wear.csv").read_bytes()


def test_a_kill_while_cycles_are_moved_loses_nothing(finished, tmp_path, monkeypatch):
    """Interrupted between two moves, the next start moves the rest: old cycles are whole in superseded/."""
    chain = twin(finished, tmp_path)
    copy_cycles(finished, chain)
    moves = []

    def move_once(source, target):
        if moves:
            raise KeyboardInterrupt
        moves.append(source)
        Path(source).rename(target)

    with monkeypatch.context() as patch:
        patch.setattr(state.os, "replace", move_once)
        with pytest.raises(KeyboardInterrupt):
            state.set_aside_others(chain.folder, "f" * 64)
    state.set_aside_others(chain.folder, "f" * 64)
    kept = sorted(path.name for path in chain.folder.glob("superseded/*/cycle_*"))
    assert kept == [f"cycle_{cycle:03d}" for cycle in range(wear_cycles(chain) + 1)]


def test_a_failed_solver_shows_its_last_words_and_the_run_resumes(finished, tmp_path, monkeypatch):
    """The message has the cause and the solver's own lines; finished cycles stay, and without the fault they go on."""
    chain = twin(finished, tmp_path)
    with monkeypatch.context() as broken:
        broken.setattr("bulkwear.workflows.engine.chain.RESTART", "no_such.restart")
        with pytest.raises(
            SolverError, match=r"cycle_001\.part/deck\.in: LIGGGHTS stopped: .*open restart file"
        ) as fault:
            cycles.run_chain(chain)
    assert "Its last lines" in str(fault.value) and "ERROR" in str(fault.value)
    done = (state.cycle_folder(chain.folder, 0) / "state.json").stat().st_mtime_ns
    cycles.run_chain(chain)
    assert (state.cycle_folder(chain.folder, 0) / "state.json").stat().st_mtime_ns == done
    assert (chain.folder / "wear.csv").read_bytes() == (finished.folder / "wear.csv").read_bytes()


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


@pytest.mark.verify
def test_a_second_driver_waits_for_the_first(finished, tmp_path):
    """Two drivers of one run do the work once: the second waits, says for whom, and finds everything finished."""
    chain = twin(finished, tmp_path)
    for cycle in (0, 1):  # the last one is left to be simulated
        shutil.copytree(state.cycle_folder(finished.folder, cycle), state.cycle_folder(chain.folder, cycle))
    first = start_driver(chain, tmp_path)
    lock = chain.folder / ".lock"
    while not (lock.exists() and lock.read_text()):
        time.sleep(0.01)
    first.send_signal(signal.SIGSTOP)  # until the second one waits, however slowly it starts
    with open(tmp_path / "second.txt", "w+") as said:
        command = [sys.executable, "-c", DRIVER, str(tmp_path / "chain.pickle")]
        second = subprocess.Popen(command, cwd=REPOSITORY, stderr=said)
        while second.poll() is None and "waiting" not in (tmp_path / "second.txt").read_text():
            time.sleep(0.05)
        first.send_signal(signal.SIGCONT)
        assert (first.wait(), second.wait()) == (0, 0)
    told = (tmp_path / "second.txt").read_text()
    assert f"process {first.pid} works on {chain.folder}; waiting for it to end" in told
    assert "cycle 1" not in told
    assert (chain.folder / "wear.csv").read_bytes() == (finished.folder / "wear.csv").read_bytes()


def test_more_ranks_are_the_same_run(finished):
    """Ranks change the time a run takes, not what it is: its cycles stay valid."""
    assert inputs_digest(replace(finished, ranks=4)) == inputs_digest(finished)
