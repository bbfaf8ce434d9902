"""Ledgers that the solver has summed: read as written, and refused with a reason where they are not whole."""

import json
import re

import numpy as np
import pytest

from bulkwear.postproc.readers.load_ledger import (
    RADIUS,
    SUMS,
    VECTORS,
    WEIGHTS,
    WORKS,
    LoadLedgerError,
    announcement,
    read_load_ledger,
)

TRIANGLES, STEPS = 5, 400
COLUMNS = (*SUMS, *WORKS, RADIUS, *WEIGHTS, *VECTORS, "finnie_work_J")


def numbers():
    """Sums and means of five triangles, the last of which was never loaded."""
    table = np.random.default_rng(11).uniform(1.0, 2.0, (len(COLUMNS), TRIANGLES))
    table[:, -1] = [np.nan if name == RADIUS or name in WEIGHTS else 0.0 for name in COLUMNS]
    return table


def written(path, table=None, header=None, **changes):
    """Write a ledger as the solver does; `changes` go into its header, None takes a key out."""
    fields = {
        "load_ledger": 2,
        "mesh": "sample_1",
        "triangles": TRIANGLES,
        "steps": STEPS,
        "time_s": 0.008,
        "step": STEPS,
        "contacts": 1234,
        "ranks": 1,
        "solver": "Version LIGGGHTS-PUBLIC 3.8.0",
        "columns": list(COLUMNS),
        **changes,
    }
    fields = {key: value for key, value in fields.items() if value is not None}
    line = json.dumps(fields).encode() + b"\n" if header is None else header
    path.write_bytes(line + (numbers() if table is None else table).astype("<f8").tobytes())
    return path


def fault_of(path, **asked):
    with pytest.raises(LoadLedgerError) as fault:
        read_load_ledger(path, **asked)
    message = str(fault.value)
    assert message.startswith(f"{path}: ") and message.endswith(".")
    return message.removeprefix(f"{path}: ")


def test_every_number_is_read_back(tmp_path):
    """Columns come back bit for bit under their names, with what the header says."""
    path = written(tmp_path / "load_ledger.bin")
    loads = read_load_ledger(path, mesh="sample_1", n_triangles=TRIANGLES, steps=STEPS)
    assert (loads.mesh, loads.triangles, loads.steps, loads.time_s) == ("sample_1", TRIANGLES, STEPS, 0.008)
    assert loads.header["contacts"] == 1234
    assert list(loads.columns) == list(COLUMNS)
    np.testing.assert_array_equal(np.array(list(loads.columns.values())), numbers())


def test_a_triangle_that_was_never_loaded_has_no_mean(tmp_path):
    """NaN is the mean of nothing, and no fault."""
    columns = read_load_ledger(written(tmp_path / "load_ledger.bin")).columns
    assert np.isnan([columns[name][-1] for name in (RADIUS, *WEIGHTS)]).all()


def test_an_empty_mesh_is_a_ledger_too(tmp_path):
    """No triangle, no numbers."""
    path = written(tmp_path / "load_ledger.bin", table=np.empty((len(COLUMNS), 0)), triangles=0)
    assert read_load_ledger(path).triangles == 0


@pytest.mark.parametrize(
    ("asked", "sentence"),
    [
        ({"mesh": "sample_2"}, "mesh is sample_1, allowed is sample_2."),
        ({"n_triangles": 6}, "triangles is 5, allowed is 6."),
        ({"steps": 500}, "steps is 400, allowed is 500."),
    ],
)
def test_a_ledger_of_something_else_is_refused(tmp_path, asked, sentence):
    """Another mesh, another number of triangles, another number of steps: both values are named."""
    assert fault_of(written(tmp_path / "load_ledger.bin"), **asked) == sentence


@pytest.mark.parametrize("lost", [1, 8, 8 * TRIANGLES, 8 * TRIANGLES * len(COLUMNS)])
def test_a_truncated_file_is_refused(tmp_path, lost):
    """Every byte is counted."""
    path = written(tmp_path / "load_ledger.bin")
    path.write_bytes(path.read_bytes()[:-lost])
    whole = 8 * TRIANGLES * len(COLUMNS)
    assert fault_of(path).startswith(
        f"found {whole - lost} bytes of numbers, allowed are {whole}, {len(COLUMNS)} columns of 5"
    )


def test_a_longer_file_is_refused(tmp_path):
    """More numbers than the header tells are no ledger either."""
    path = written(tmp_path / "load_ledger.bin")
    path.write_bytes(path.read_bytes() + b"\0" * 8)
    assert "bytes of numbers" in fault_of(path)


@pytest.mark.parametrize(
    "header", [b"", b"ITEM: TIMESTEP\n", b"{\n", b"[1]\n", b"\xff\xfe\n", b'{"mesh": "a"}\n', b"1\n"]
)
def test_what_is_no_ledger_is_refused(tmp_path, header):
    """Dumps, empty files, binary files and other JSON have no header of a ledger."""
    assert fault_of(written(tmp_path / "load_ledger.bin", header=header)).startswith("found no header of a load ledger")


def test_a_missing_file_is_one_sentence(tmp_path):
    """Its name and why."""
    assert fault_of(tmp_path / "load_ledger.bin").startswith("cannot be read (No such file")


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        (
            {"load_ledger": 1, "columns": [*SUMS, RADIUS, *WEIGHTS]},
            "load_ledger is 1, allowed is format 2, of a program built from the present solver/ (make -C solver).",
        ),
        ({"triangles": None}, "triangles in its header is None, allowed is a whole number."),
        ({"triangles": 5.0}, "triangles in its header is 5.0, allowed is a whole number."),
        ({"steps": True}, "steps in its header is True, allowed is a whole number."),
        ({"columns": "all"}, "columns in its header is 'all', allowed is a list of names."),
        ({"columns": list(COLUMNS[1:])}, "column sliding_work_J stands there 0 times, allowed is once."),
        ({"columns": list(COLUMNS[:-2])}, "column moment_normal_N_m_s stands there 0 times, allowed is once."),
        ({"columns": [*COLUMNS[:-1], RADIUS]}, "column contact_radius_m stands there 2 times, allowed is once."),
    ],
)
def test_a_wrong_header_is_refused(tmp_path, changes, sentence):
    """The key at fault, what was found, what is allowed."""
    assert fault_of(written(tmp_path / "load_ledger.bin", **changes)) == sentence


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("sliding_work_J", np.nan, "is nan, allowed is a finite number, at least 0."),
        ("impact_energy_J", -1e-3, "is -0.001, allowed is a finite number, at least 0."),
        ("contact_radius_m", np.nan, "is nan, allowed is a finite number where the triangle is loaded."),
        ("contact_weight_2", np.inf, "is inf, allowed is a finite number where the triangle is loaded."),
        ("finnie_work_J", np.inf, "is inf, allowed is a finite number."),
        ("tangential_work_J", np.nan, "is nan, allowed is a finite number."),
    ],
)
def test_impossible_numbers_are_refused(tmp_path, name, value, words):
    """A sum is finite and not negative, a mean is finite where there was a load."""
    table = numbers()
    table[COLUMNS.index(name), 3] = value
    assert fault_of(written(tmp_path / "load_ledger.bin", table=table)) == f"{name} of triangle 3 {words}"


@pytest.mark.parametrize("name", [*WORKS, *VECTORS])
def test_works_and_vectors_have_a_sign(tmp_path, name):
    """Friction that pushes along, a drive that is driven, and any component of a vector may be below 0."""
    table = numbers()
    table[COLUMNS.index(name), 3] = -1.5
    assert read_load_ledger(written(tmp_path / "load_ledger.bin", table=table)).columns[name][3] == -1.5


def test_the_solver_announces_its_ledger(tmp_path):
    """The line that proves at the start of a run that the ledger is summed; nothing where there is none."""
    screen = tmp_path / "screen.txt"
    line = "Load ledger load_ledger: mesh sample_1, 400 triangles"
    screen.write_text(f"Reading restart file\n{line}\nSetting up run\n")
    assert announcement(screen) == line
    screen.write_text("Setting up run\n")
    assert announcement(screen) is None


def test_messages_are_one_sentence(tmp_path):
    """No line break in any message."""
    path = written(tmp_path / "load_ledger.bin", load_ledger="x\ny")
    assert not re.search(r"\n", fault_of(path))
