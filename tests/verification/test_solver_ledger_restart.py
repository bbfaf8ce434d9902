"""The solver's load ledger over kills, restarts and several runs: nothing lost, nothing counted twice."""

import signal
import subprocess
import time

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.readers.load_ledger import announcement, read_load_ledger
from bulkwear.workflows.engine.solver import solver_environment
from tests.verification.ledger_cases import (
    LEDGER_LINE,
    LOAD,
    MESH_LINE,
    PIN_MOTION,
    RADIUS,
    command,
    hertz_overlap,
    pin,
    resume,
    run,
    total,
    write_case,
)

pytestmark = pytest.mark.solver

RESUME_TOLERANCE = 1e-12  # relative; the same trajectory, its sums read from a file in between
LAW_TOLERANCE = 1e-6  # relative, as without a restart
STEPS, TIME_STEP, SPEED = 16000, 1e-6, 0.5  # -, s, m/s
INTERVAL = 2000  # steps between two restart files
PATIENCE = 60.0  # s, for the second restart file of a run of a few seconds
KEEPING = [f"restart {INTERVAL} a.restart b.restart"]
# On the plate from the start, at the equilibrium of the load, or dropped on it: an impact, then an oscillation.
HEIGHTS = {"steady": RADIUS - hertz_overlap(), "dropped": RADIUS + 1e-5}  # m


def write_drag(folder, case, outputs=(), **variables):
    """A pin dragged over a plate that is carried against it, 8 mm in all."""
    particles = [
        *pin(1.31234567e-4, -0.0040007123456, HEIGHTS[case]),
        f"velocity all set 0.0 {SPEED / 2} 0.0 units box",
    ]
    carried = f"fix carry all move/mesh mesh sample linear 0.0 {-SPEED / 2} 0.0"
    settings = {"time_step": TIME_STEP, "steps": STEPS, **variables}
    mesh = flat_plate(0.004, 0.012, 0.5e-3)
    write_case(folder, mesh, particles, PIN_MOTION, mesh_lines=[carried], outputs=outputs, **settings)


def test_sums_so_far_are_those_of_a_shorter_run(tmp_path):
    """A history is the ledger as it was: of a pin dragged steadily every file holds F v t, and the last ones stay the
    same to the last bit; its steps and time are told, and every file is whole."""
    ledgers = {}
    for name, line in (
        ("whole", LEDGER_LINE),
        ("looked_into", LEDGER_LINE.replace(" kernels", " history 3000 kernels")),
    ):
        write_drag(tmp_path / name, "steady")
        (tmp_path / name / "ledger.in").write_text(line + "\n")
        run(tmp_path / name)
        ledgers[name] = read_load_ledger(tmp_path / name / "load_ledger.bin", "sample", steps=STEPS)
    for column, values in ledgers["whole"].columns.items():
        np.testing.assert_array_equal(values, ledgers["looked_into"].columns[column], err_msg=column)
    looks = sorted(tmp_path.glob("looked_into/load_ledger.bin.*"), key=lambda path: int(path.suffix[1:]))
    assert [int(path.suffix[1:]) for path in looks] == list(range(3000, STEPS, 3000))
    for path in looks:
        look = read_load_ledger(path, "sample", steps=int(path.suffix[1:]))
        assert look.time_s == pytest.approx(look.steps * TIME_STEP, rel=LAW_TOLERANCE)
        assert total(look, "sliding_work_J") == pytest.approx(LOAD * SPEED * look.time_s, rel=LAW_TOLERANCE)
    assert not list(tmp_path.glob("whole/load_ledger.bin.*"))


def kill_in_the_middle(folder, by=signal.SIGKILL):
    """Run until a second restart file is there and send a signal; return the name of the newest whole restart file.

    SIGKILL may cut a file off while it is written; that is why there are two.
    """
    running = subprocess.Popen(command(), cwd=folder, env=solver_environment(), stdout=subprocess.DEVNULL)
    deadline = time.monotonic() + PATIENCE
    while not (folder / "b.restart").exists() and running.poll() is None and time.monotonic() < deadline:
        time.sleep(0.005)
    running.send_signal(by)
    assert running.wait() == (-by if by == signal.SIGKILL else 0)
    assert not (folder / "load_ledger.bin").exists(), "the run ended before it could be killed"
    if forced := list(folder.glob("restart_forced_*")):
        return forced[0].name
    kept = list(folder.glob("?.restart"))
    whole = max(path.stat().st_size for path in kept)
    return max((path for path in kept if path.stat().st_size == whole), key=lambda path: path.stat().st_mtime_ns).name


def assert_same_ledger(found, expected, tolerance=RESUME_TOLERANCE):
    """All columns agree triangle by triangle, against the largest value of the column."""
    for name in ("steps", "step", "contacts"):
        assert found.header[name] == expected.header[name]
    assert found.time_s == pytest.approx(expected.time_s, rel=tolerance)
    for name, values in expected.columns.items():
        largest = np.nanmax(np.abs(values))
        assert found.columns[name] == pytest.approx(values, rel=0, abs=tolerance * largest, nan_ok=True), name


def ledger_in(folder):
    """Ledger of a finished run."""
    return read_load_ledger(folder / "load_ledger.bin", "sample")


@pytest.mark.parametrize("by", [signal.SIGKILL, signal.SIGTERM])
def test_killed_and_resumed_is_the_undisturbed_run(tmp_path, by):
    """A run is killed, or asked to end, and goes on from the newest restart file: the undisturbed ledger, and F L.

    Asked to end, the solver writes one more restart file, at whatever step it has come to.
    """
    killed, undisturbed = tmp_path / "killed", tmp_path / "undisturbed"
    write_drag(killed, "steady", KEEPING)
    newest = kill_in_the_middle(killed, by)
    assert newest.startswith("restart_forced_") == (by == signal.SIGTERM)
    said = resume(killed, newest)
    assert "goes on after" in said
    write_drag(undisturbed, "steady")
    run(undisturbed)
    found = ledger_in(killed)
    assert_same_ledger(found, ledger_in(undisturbed))
    assert found.steps == STEPS
    assert total(found, "sliding_work_J") == pytest.approx(LOAD * SPEED * STEPS * TIME_STEP, rel=LAW_TOLERANCE)
    assert total(found, "impact_energy_J") == 0.0


def test_resumed_oscillation_is_that_of_two_runs(tmp_path):
    """The same amid an oscillation after an impact, which stays one impact.

    The solver evaluates forces once more whenever a run starts, with velocities of the step's end, so the reference is
    a run that starts anew at the same step without leaving memory.
    """
    killed, reference = tmp_path / "killed", tmp_path / "reference"
    write_drag(killed, "dropped", KEEPING)
    said = resume(killed, kill_in_the_middle(killed))
    begun = int(said.partition("goes on after ")[2].split()[0])
    assert 0 < begun < STEPS
    assert begun % INTERVAL == 0
    write_drag(reference, "dropped", [f"run {begun} upto"])
    run(reference)
    assert_same_ledger(ledger_in(killed), ledger_in(reference))
    columns = ledger_in(killed).columns
    assert np.count_nonzero(columns["impact_energy_J"]) == 1


def test_runs_of_one_deck_add_up(tmp_path):
    """Three runs in a row: one ledger of all their steps; the evaluation at the start of each counts for nothing."""
    write_drag(tmp_path, "steady", ["run 1000", "run 0", "run 500"])
    run(tmp_path)
    found = ledger_in(tmp_path)
    assert found.steps == found.header["contacts"] == STEPS
    assert found.time_s == pytest.approx(STEPS * TIME_STEP, rel=RESUME_TOLERANCE)
    assert total(found, "sliding_work_J") == pytest.approx(LOAD * SPEED * STEPS * TIME_STEP, rel=LAW_TOLERANCE)


def test_two_processes_resume_what_one_left(tmp_path):
    """A restart file written by one process and read by two holds the whole ledger once."""
    folder, undisturbed = tmp_path / "resumed", tmp_path / "undisturbed"
    for each in (folder, undisturbed):
        write_drag(each, "steady", ["restart 1000 a.restart b.restart"] if each == folder else (), steps=3000)
    run(folder, steps=2500)
    resume(folder, "b.restart", 2)
    run(undisturbed)
    found, expected = ledger_in(folder), ledger_in(undisturbed)
    assert found.header["ranks"] == 2
    assert_same_ledger(found, expected)


def test_other_kernels_start_an_empty_ledger(tmp_path):
    """A ledger with other kernels does not take up the sums of the restart file, and says so."""
    write_drag(tmp_path, "steady", ["restart 1000 a.restart b.restart"], steps=2000)
    run(tmp_path)
    assert ledger_in(tmp_path).steps == 2000
    (tmp_path / "ledger.in").write_text(LEDGER_LINE.partition(" kernels")[0] + "\n")
    said = resume(tmp_path, "b.restart", steps=2600)
    assert "this one starts empty" in said
    assert_only_the_last(ledger_in(tmp_path), 600)


def test_a_ledger_of_an_older_program_starts_empty(tmp_path):
    """A restart file whose ledger is of another format is told from one of this program, and says which it holds."""
    write_drag(tmp_path, "steady", ["restart 1000 a.restart b.restart"], steps=2000)
    run(tmp_path)
    stored = (tmp_path / "b.restart").read_bytes()
    assert stored.count(b"load_ledger 2 sample") == 1
    (tmp_path / "b.restart").write_bytes(stored.replace(b"load_ledger 2 sample", b"load_ledger 1 sample"))
    said = resume(tmp_path, "b.restart", steps=2600)
    assert "the restart file holds another ledger (load_ledger 1 sample " in said
    assert_only_the_last(ledger_in(tmp_path), 600)


def test_a_new_mesh_starts_an_empty_ledger(tmp_path):
    """A mesh with a new id starts with an empty ledger, and the run says so."""
    write_drag(tmp_path, "steady", ["restart 1000 a.restart b.restart"], steps=2000)
    run(tmp_path)
    for name, line in (("mesh", MESH_LINE), ("ledger", LEDGER_LINE)):
        renamed = line.replace("fix sample", "fix fresh").replace("mesh sample", "mesh fresh")
        assert renamed != line
        (tmp_path / f"{name}.in").write_text(renamed + "\n")
    said = resume(tmp_path, "b.restart", steps=2600, meshes="1 meshes fresh")
    assert "this one starts empty" in said
    found = read_load_ledger(tmp_path / "load_ledger.bin", "fresh")
    assert found.steps == 600
    assert total(found, "impact_energy_J") == 0.0  # the pin stays in touch, now with the new mesh


def test_a_ledger_taken_off_leaves_no_trace(tmp_path):
    """After unfix the restart file holds no ledger: the next cycle starts its own; lasting contacts hit nothing."""
    write_drag(tmp_path, "steady", [f"run {STEPS // 4} upto", "unfix load_ledger", "write_restart next.restart"])
    deck = (tmp_path / "ledger.in").read_text()
    (tmp_path / "ledger.in").write_text(deck + LEDGER_LINE + "\n")
    run(tmp_path, steps=STEPS // 4)
    (tmp_path / "ledger.in").write_text(LEDGER_LINE + "\n")
    said = resume(tmp_path, "next.restart", steps=STEPS // 4 + 500)
    assert "goes on after" not in said
    assert_only_the_last(ledger_in(tmp_path), 500)


def assert_only_the_last(found, steps):
    """A ledger of the last steps of the steady drag, and of nothing before."""
    assert found.steps == found.header["contacts"] == steps
    assert total(found, "sliding_work_J") == pytest.approx(LOAD * SPEED * steps * TIME_STEP, rel=LAW_TOLERANCE)
    assert total(found, "impact_energy_J") == 0.0


def test_the_log_says_that_contacts_are_reported(tmp_path):
    """At its start the run says that the ledger is called, and for which mesh."""
    write_drag(tmp_path, "steady", steps=100)
    (tmp_path / "screen.txt").write_text(run(tmp_path))
    for place in ("screen.txt", "log.liggghts"):
        said = announcement(tmp_path / place)
        assert "every contact is reported to it" in said
        assert "sample" in said
