"""Both producers of a load ledger: the same table from what the solver left, and each what it says it leaves."""

import json
from dataclasses import replace

import numpy as np
import pytest

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.readers.load_ledger import RADIUS, SUMS, VECTORS, WEIGHTS, WORKS, LoadLedgerError
from bulkwear.postproc.wear.kernels import kernel_column
from bulkwear.postproc.wear.laws import LAWS
from bulkwear.postproc.wear.ledger import LEDGER_FIELDS, POSITION_FIELDS, vector_columns
from bulkwear.workflows.engine import cycles
from bulkwear.workflows.engine.case import LOAD_LEDGER, Piece
from bulkwear.workflows.engine.chain import Chain
from bulkwear.workflows.engine.ledgers import CONTACTS, PRODUCERS, SPINS, TOUCHING, SamplesError, producer
from bulkwear.workflows.engine.schedule import known_spans
from bulkwear.workflows.engine.solver import (
    EXECUTABLE,
    SolverError,
    missing_program,
    run_deck,
)
from tests.support.law_cases import wear_settings
from tests.support.tiny import tiny_study

ROUND_OFF = 1e-9  # relative; the dump has nine digits and what is compared is one contact
SURFACE = SurfaceMesh(
    np.array([[0.0, 0.0, 0.0], [0.02, 0.0, 0.0], [0.02, 0.02, 0.0], [0.0, 0.02, 0.0]]),
    np.array([[0, 1, 2], [0, 2, 3]]),
)
MESH = Piece(SURFACE, np.arange(len(SURFACE.triangles)))
# Of the one contact, on triangle 0, whose first edge is the x axis: m, N, N against the sliding, m/s
POINT, FORCE, FRICTION, SPEED = (0.01, 0.005, 0.0), 2.0, 0.5, 0.3
DUMPED_FRICTION = 1.7  # N; evaluated for the dump


def chain_of(folder, ledger, **changes):
    """A chain of one producer, of which only the accounting is asked for."""
    study = tiny_study(ledger=ledger, **changes)
    run = study.run("R9_plain")
    return Chain(
        run.name, folder, study.case, run.parameters, folder / "x", study.beds[study.bed_of(run.name)], folder / "y"
    )


def time_of(chain):
    return chain.parameters["derived"]["first_cycle_steps"] * chain.parameters["derived"]["time_step_s"]


def cycle(chain, number):
    """Span of a wear cycle."""
    return known_spans(chain.parameters)[number - 1]


def weights():
    """Barycentric coordinates of the point in triangle 0."""
    corners = SURFACE.points[SURFACE.triangles[0]]
    return np.linalg.solve(np.vstack([corners[:, :2].T, np.ones(3)]), [*POINT[:2], 1.0])


def write_load_ledger(chain, folder, **changes):
    """What the solver would sum of one contact that slides on triangle 0 during a whole cycle."""
    kernels = map(kernel_column, LAWS[chain.parameters["wear"]["law"]].kernels)
    sums = {name: [0.0, 0.0] for name in (*SUMS, *WORKS, *VECTORS, *kernels)}
    sums["sliding_work_J"] = [FORCE * SPEED * time_of(chain), 0.0]
    sums["normal_impulse_N_s"] = [FORCE * time_of(chain), 0.0]
    sums["contact_time_s"] = [time_of(chain), 0.0]
    sums["tangential_work_J"] = [FRICTION * SPEED * time_of(chain), 0.0]
    impulse = np.array([FRICTION, 0.0, -FORCE]) * time_of(chain)
    moment = np.cross(POINT - SURFACE.points[SURFACE.triangles[0]].mean(axis=0), impulse)
    for name, vector in (("impulse", impulse), ("moment", moment)):
        for field, part in zip(vector_columns(name, ("along", "across", "normal")), vector, strict=True):
            sums[field] = [part, 0.0]
    columns = {**sums, RADIUS: [1e-4, np.nan]}
    columns |= {name: [weight, np.nan] for name, weight in zip(WEIGHTS, weights(), strict=True)}
    steps = chain.parameters["derived"]["first_cycle_steps"]
    header = {"load_ledger": 2, "mesh": "sample_1", "triangles": 2, "steps": steps, "time_s": time_of(chain)}
    header |= {"columns": list(columns), **changes}
    numbers = np.array(list(columns.values()), "<f8").tobytes()
    (folder / LOAD_LEDGER).write_bytes(json.dumps(header).encode() + b"\n" + numbers)


def write_dumps(chain, folder, samples=None):
    """The same contact as sampled: the set-up's sample, then one per interval."""
    radius = 0.004
    row = [*POINT, *POINT[:2], radius, 0, 0, 0, SPEED, 0, 0, 0, 0, 7, -DUMPED_FRICTION, 0, FORCE]
    every, total = (
        chain.parameters["solver"]["sampling_interval_steps"],
        chain.parameters["derived"]["first_cycle_steps"],
    )
    head = "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF {}\n1\nITEM: BOX BOUNDS pp ff fm\n0 1\n0 1\n0 1\nITEM: {} {}\n{}\n"
    names = " ".join(f"c_wall_contact[{k}]" for k in range(1, 19))
    contacts, spins = [], []
    for step in range(0, total + 1, every)[:samples]:
        contacts.append(head.format(step, "ENTRIES", "ENTRIES", names, " ".join(map(str, row))))
        columns = "id radius omegax omegay omegaz f_force_walls[1] f_force_walls[2] f_force_walls[3]"
        spins.append(head.format(step, "ATOMS", "ATOMS", columns, f"7 {radius} 0 0 0 -{FRICTION} 0 {FORCE}"))
    (folder / CONTACTS).write_text("".join(contacts))
    (folder / SPINS).write_text("".join(spins))


WRITERS = {"solver": write_load_ledger, "dumps": write_dumps}


def columns_of(ledger, folder, **changes):
    folder.mkdir(parents=True, exist_ok=True)
    chain = chain_of(folder.parent, ledger, **changes)
    WRITERS[ledger](chain, folder)
    return producer(chain.parameters).columns(chain, cycle(chain, 1), folder, MESH)


@pytest.mark.parametrize("law", LAWS)
def test_both_producers_write_the_same_columns(tmp_path, law):
    """Names, order, dtypes and lengths do not depend on who has summed, whatever the law adds."""
    found = {name: columns_of(name, tmp_path / name / "cycle_001", wear=wear_settings(law)) for name in PRODUCERS}
    kinds = {
        name: [(column, values.dtype, values.shape) for column, values in columns.items()]
        for name, columns in found.items()
    }
    assert kinds["solver"] == kinds["dumps"]
    assert [column for column, *_ in kinds["solver"]] == [
        *LEDGER_FIELDS,
        *map(kernel_column, LAWS[law].kernels),
    ]


def test_both_producers_agree_on_one_contact(tmp_path):
    """Work F v t, impulse F t, time, place and friction of a contact that slides through the whole cycle."""
    one, other = (columns_of(name, tmp_path / name / "cycle_001") for name in ("solver", "dumps"))
    vectors = [field for name in ("impulse", "back_impulse", "moment") for field in vector_columns(name)]
    works = ("sliding_work_J", "normal_impulse_N_s", "contact_time_s", "tangential_work_J", "drive_work_J")
    for name in (*works, *POSITION_FIELDS, *vectors):
        np.testing.assert_allclose(one[name], other[name], rtol=ROUND_OFF, err_msg=name)
    position = [one[name][0] for name in POSITION_FIELDS]
    np.testing.assert_allclose(position, POINT, rtol=ROUND_OFF, atol=ROUND_OFF)


@pytest.mark.parametrize("name", PRODUCERS)
def test_a_producer_tells_its_files_and_its_bytes(tmp_path, name):
    """What the solver wrote for the ledger is what is counted and removed; what is kept is there afterwards."""
    folder = tmp_path / "cycle_001"
    columns_of(name, folder)
    source = PRODUCERS[name]
    written = {path.name for path in source.written(folder)}
    assert {path.name for path in folder.iterdir()} == written | set(source.kept)
    assert source.written_bytes(folder) == sum((folder / name).stat().st_size for name in written) > 0


def test_looks_inside_a_cycle_come_in_order(tmp_path):
    """The solver's files of sums so far are read by their steps, not their names, and removed with the ledger."""
    chain, looks = chain_of(tmp_path, "solver"), (1000, 90, 400)
    for steps in looks:
        write_load_ledger(chain, tmp_path, steps=steps)
        (tmp_path / LOAD_LEDGER).rename(tmp_path / f"{LOAD_LEDGER}.{steps}")
    write_load_ledger(chain, tmp_path)
    source = producer(chain.parameters)
    found = [steps for steps, _ in source.history(chain, cycle(chain, 1), tmp_path, MESH)]
    assert found == sorted(looks)
    assert len(source.written(tmp_path)) == len(looks) + 1


def test_the_solver_ledger_does_not_grow_with_the_steps(tmp_path):
    """One number per triangle and column, however long the cycle; dumps grow with the samples."""
    sizes = {}
    for name in PRODUCERS:
        for travel in (20, 80):
            folder = tmp_path / f"{name}_{travel}" / "cycle_001"
            columns_of(name, folder, sliding={"travel_mm": travel, "cycles": 1}, bed={"ahead_mm": 80})
            sizes[name, travel] = PRODUCERS[name].written_bytes(folder)
    digits = 20  # the header tells steps and time
    assert abs(sizes["solver", 80] - sizes["solver", 20]) < digits
    assert sizes["dumps", 80] > 3 * sizes["dumps", 20]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"steps": 7}, r"load_ledger\.bin: steps is 7, allowed is \d+\."),
        ({"mesh": "sample_2"}, r"load_ledger\.bin: mesh is sample_2, allowed is sample_1\."),
        ({"triangles": 3}, r"load_ledger\.bin: triangles is 3, allowed is 2\."),
    ],
)
def test_the_ledger_of_another_cycle_is_refused(tmp_path, changes, words):
    """Fewer steps than the cycle has, another mesh, another number of triangles."""
    chain = chain_of(tmp_path, "solver")
    write_load_ledger(chain, tmp_path, **changes)
    with pytest.raises(LoadLedgerError, match=words):
        producer(chain.parameters).columns(chain, cycle(chain, 1), tmp_path, MESH)


def test_missing_samples_are_refused(tmp_path):
    """A dump that ends before the cycle does."""
    chain = chain_of(tmp_path, "dumps")
    write_dumps(chain, tmp_path, samples=5)
    with pytest.raises(SamplesError, match=r"contacts\.dump: found 4 samples of the contacts, allowed is \d+\."):
        producer(chain.parameters).columns(chain, cycle(chain, 1), tmp_path, MESH)


def test_only_sampled_contacts_seed_the_next_cycle(tmp_path):
    """A particle that touched at the end of a cycle is no impact in the next one; the solver knows that by itself."""
    folder = tmp_path / "cycle_001"
    columns_of("dumps", folder)
    assert np.load(folder / TOUCHING).tolist() == [7]
    chain = chain_of(tmp_path, "dumps")
    (tmp_path / "cycle_002").mkdir()
    write_dumps(chain, tmp_path / "cycle_002")
    assert (
        not producer(chain.parameters)
        .columns(chain, cycle(chain, 2), tmp_path / "cycle_002", MESH)["impact_energy_J"]
        .any()
    )
    assert PRODUCERS["solver"].kept == ()


def test_a_missing_program_is_one_sentence(tmp_path, monkeypatch):
    """It says how to build or install it; nothing is run."""
    there = str(tmp_path / "solver" / "build" / "liggghts-ledger")
    monkeypatch.setattr("bulkwear.workflows.engine.solver.LEDGER_EXECUTABLE", there)
    assert missing_program(there) == (
        f"{there}: there is no such program, nor one of its name on the PATH; `make setup` (or `make -C solver`) "
        "builds it, and a study with `ledger: dumps` and a rolling friction of LIGGGHTS does without."
    )
    with pytest.raises(SolverError, match="make -C solver"):
        run_deck(tmp_path, executable=there)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert missing_program(EXECUTABLE).startswith("liggghts is not on the PATH; `make setup` installs it")
    assert list(tmp_path.iterdir()) == []


def test_a_run_without_its_program_fails_before_its_first_cycle(tmp_path, monkeypatch):
    """Nothing is simulated where the wear cycles cannot be."""
    monkeypatch.setattr("bulkwear.workflows.engine.solver.LEDGER_EXECUTABLE", str(tmp_path / "liggghts-ledger"))
    chain = replace(chain_of(tmp_path, "solver"), folder=tmp_path / "run")
    for path in (chain.surface, chain.bed_restart):
        path.touch()
    with pytest.raises(SolverError, match="liggghts-ledger"):
        cycles.run_chain(chain)
    assert not list(chain.folder.glob("cycle_*"))
