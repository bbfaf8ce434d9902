"""The doctor names what is missing, in a machine that lacks it."""

import os
import sys

import pytest

from bulkwear.workflows.environment import doctor

MORE_THAN_ANY_DISK_GB = 1e9
LOCK = "ruff==0.1.2 \\\n    --hash=sha256:00\nnest-asyncio2==1.7\n"
CRASH = "#!/bin/sh\nkill -SEGV $$\n"


@pytest.fixture
def program(tmp_path, monkeypatch):
    """Return a function that puts a small shell program in front of everything else on PATH."""
    folder = tmp_path / "bin"
    folder.mkdir()
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")

    def put(name, text):
        path = folder / name
        path.write_text(text)
        path.chmod(0o755)
        return str(path)

    return put


def says(text, code=0):
    """Text of a shell program that prints one line."""
    return f"#!/bin/sh\necho '{text}'\nexit {code}\n"


def test_an_older_python_is_wrong():
    """Python 3.10 is refused and 3.11 accepted."""
    assert doctor.check_python((3, 10, 9)).failed
    assert not doctor.check_python((3, 11, 0)).failed


def test_lock_is_read_by_name_and_version():
    """Names and versions come out of a hashed lock, hashes do not."""
    assert doctor.locked_versions(LOCK) == {"ruff": "0.1.2", "nest-asyncio2": "1.7"}


def test_absent_and_differing_packages_are_told_apart():
    """A package that is absent is missing; one of another version is wrong, with both versions named."""
    locked = doctor.locked_versions(LOCK)
    absent = doctor.check_packages(locked, {"ruff": "0.1.2"})
    assert (absent.state, absent.found) == ("missing", "nest-asyncio2")
    other = doctor.check_packages(locked, {"ruff": "0.1.3", "nest-asyncio2": "1.7"})
    assert (other.state, other.found) == ("wrong", "ruff 0.1.3 (lock: 0.1.2)")
    assert doctor.check_packages(locked, dict(locked)).state == "OK"


def test_names_are_compared_in_the_spelling_of_the_lock():
    """Nest_Asyncio2 and nest-asyncio2 are one distribution (PEP 503)."""
    assert doctor.canonical("Nest_Asyncio2") == "nest-asyncio2"
    assert all(name == doctor.canonical(name) for name in doctor.installed_versions())


def test_solver_is_missing_without_liggghts(monkeypatch, tmp_path):
    """No liggghts on PATH: missing, and the advice says how to get it."""
    monkeypatch.setenv("PATH", str(tmp_path))
    found = doctor.check_solver()
    assert found.state == "missing"
    assert doctor.SET_UP in found.advice


@pytest.mark.parametrize(("version", "state"), [("3.8.0", "OK"), ("3.7.1", "wrong"), ("of unknown make", "wrong")])
def test_solver_of_another_version_is_wrong(program, version, state):
    """The version liggghts prints decides, although it exits with 1."""
    program("liggghts", says(f"LIGGGHTS (Version LIGGGHTS-PUBLIC {version}, compiled today)", code=1))
    assert doctor.check_solver().state == state


@pytest.mark.parametrize(
    ("output", "code", "state"),
    [
        ("2 by 1 by 1 MPI processor grid", 0, "OK"),
        ("1 by 1 by 1 MPI processor grid", 0, "wrong"),
        ("2 by 1 by 1 MPI processor grid", 1, "wrong"),
        ("There are not enough slots", 1, "wrong"),
    ],
)
def test_mpi_must_join_two_processes_in_one_box(program, output, code, state):
    """Two unconnected runs (an mpirun of another MPI) and a failing mpirun are both wrong."""
    program("mpirun", says(output, code))
    assert doctor.check_mpi().state == state


@pytest.mark.parametrize(
    ("output", "code", "state"),
    [
        ("Load ledger ledger: mesh plate, every contact is reported to it.", 0, "OK"),
        ("Load ledger ledger: mesh plate, no contact yet.", 0, "wrong"),
        ("ERROR: fix load/ledger was built for another LIGGGHTS", 1, "wrong"),
    ],
)
def test_ledger_must_be_told_of_a_contact(program, monkeypatch, output, code, state):
    """The solver with the ledger is trusted only when it ran and found itself called."""
    monkeypatch.setattr(doctor, "LEDGER_PROGRAM", program("liggghts-ledger", says(output, code)))
    assert doctor.check_ledger().state == state


def test_ledger_that_was_not_built_is_missing(monkeypatch, tmp_path):
    """Without the program: missing, and the advice says how to build it and how to go on without."""
    monkeypatch.setattr(doctor, "LEDGER_PROGRAM", tmp_path / "liggghts-ledger")
    found = doctor.check_ledger()
    assert found.state == "missing"
    assert "make -C solver" in found.advice and "ledger: dumps" in found.advice


def test_root_flags_are_set_for_root_only(monkeypatch):
    """Open MPI's permission to run as root is given when and only when this is root."""
    monkeypatch.delenv("OMPI_ALLOW_RUN_AS_ROOT", raising=False)
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    assert "OMPI_ALLOW_RUN_AS_ROOT" not in doctor.mpi_environment()
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    assert doctor.mpi_environment()["OMPI_ALLOW_RUN_AS_ROOT"] == "1"


def test_a_crash_while_rendering_is_reported(program):
    """A segmentation fault in the probe becomes a finding, not the end of the doctor."""
    found = doctor.check_rendering(program("crashing-python", CRASH))
    assert found.state == "wrong"
    assert "signal 11" in found.found


def test_missing_library_is_named_with_its_package(program):
    """A loader error becomes the library and the Debian package that has it."""
    error = "OSError: libGLU.so.1: cannot open shared object file: No such file or directory"
    found = doctor.check_gmsh(program("bare-python", says(error, code=1)))
    assert (found.state, found.found) == ("missing", "libGLU.so.1")
    assert "libglu1-mesa" in found.advice


def test_every_named_package_but_the_alternative_is_installed_by_setup():
    """The packages the doctor advises are those set-up installs; EGL is the alternative to OSMesa."""
    lines = (doctor.REPOSITORY / "apt-packages.txt").read_text().splitlines()
    wanted = {line.partition("#")[0].strip() for line in lines} - {""}
    assert set(doctor.PACKAGE_OF_LIBRARY.values()) - wanted == {"libegl1"}


def test_disk_is_measured_where_results_will_be(tmp_path, monkeypatch):
    """A folder yet to come is judged by the disk it will be on; little room is low, hardly any is wrong."""
    later = tmp_path / "not" / "there"
    monkeypatch.setattr(doctor, "ADVISABLE_FREE_DISK_GB", MORE_THAN_ANY_DISK_GB)
    monkeypatch.setattr(doctor, "LEAST_FREE_DISK_GB", 0.0)
    assert doctor.check_disk(later).state == "low"
    monkeypatch.setattr(doctor, "LEAST_FREE_DISK_GB", MORE_THAN_ANY_DISK_GB)
    assert doctor.check_disk(later).state == "wrong"


def test_exit_code_counts_failures_only(monkeypatch, capsys):
    """Low memory is no failure, a missing solver is; every finding is printed."""
    low = doctor.Finding("memory", "low", "2 GB", "4 GB are advisable")
    missing = doctor.Finding("LIGGGHTS", "missing", "liggghts: not found", doctor.SET_UP)
    monkeypatch.setattr(doctor, "findings", lambda: [low])
    assert doctor.main([]) == 0
    monkeypatch.setattr(doctor, "findings", lambda: [low, missing])
    assert doctor.main([]) == 1
    assert "liggghts: not found  ->  run `make setup`" in capsys.readouterr().out


@pytest.mark.solver
def test_this_machine_is_complete():
    """Every check passes where the tests run."""
    assert [finding for finding in doctor.findings() if finding.failed] == []


def test_a_hanging_program_is_given_up(program, monkeypatch):
    """A probe that never answers ends with a sentence."""
    monkeypatch.setattr(doctor, "PROBE_TIMEOUT_S", 0.2)
    probe = doctor.run([program("sleeper", "#!/bin/sh\nexec sleep 30\n")])
    assert probe.code is None
    assert "no answer" in probe.output


def test_a_crashing_interpreter_is_a_negative_code():
    """A signal is handed over as a negative code."""
    command = [sys.executable, "-c", "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"]
    assert doctor.run(command).code < 0
