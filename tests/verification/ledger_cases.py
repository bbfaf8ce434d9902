"""What the tests of the solver's load ledger share: materials, meshes, and a run of the frame deck."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.mesh import SurfaceMesh, stl_corners, write_stl
from bulkwear.postproc.readers.contacts import read_contact_batches
from bulkwear.postproc.readers.load_ledger import LoadLedger, read_load_ledger
from bulkwear.postproc.wear.ledger import LedgerBuilder, columns_of_solver
from bulkwear.workflows.engine.solver import solver_environment
from tests import REPOSITORY
from tests.support.patience import LONGEST_S

BUILT = REPOSITORY / "solver" / "build" / "liggghts-ledger"  # by `make -C solver`
SOLVER = Path(os.environ.get("LIGGGHTS_LEDGER", BUILT))
FRAME = REPOSITORY / "tests" / "data" / "ledger_case.in"

RADIUS = 0.003  # m, of the pin
DENSITY = 4850.0  # kg/m3
MASS = 4.0 / 3.0 * np.pi * RADIUS**3 * DENSITY  # kg
LOAD = 5.0  # N
PARTICLE_MODULUS = 2.48e8  # Pa
GRAVITY = 9.81  # m/s2

LEDGER_LINE = "fix load_ledger all load/ledger mesh sample file load_ledger.bin kernels finnie_work"
MESH_LINE = "fix sample all mesh/surface/stress file sample.stl type 2 wear finnie"
PIN_MOTION = (
    f"fix load all addforce 0.0 0.0 -{LOAD}",
    "fix guide all setforce 0.0 0.0 NULL",
    "fix integrate all nve",
)
WALL_FORCE = [f"f_force_wall[{k}]" for k in (1, 2, 3)]
DUMP_LINES = (
    "variable wall_force_squared atom f_force_wall[1]^2+f_force_wall[2]^2+f_force_wall[3]^2",
    "dump spins all custom 1 spins.dump id radius omegax omegay omegaz " + " ".join(WALL_FORCE),
    'dump_modify spins thresh v_wall_force_squared > 0.0 format "%d' + 7 * " %.12g" + '"',
    "dump contacts all local 1 contacts.dump " + " ".join(f"c_wall_contact[{k}]" for k in range(1, 19)),
    "dump_modify contacts format '" + " ".join(["%.12g"] * 18) + "'",
)


def effective_modulus(particle_modulus: float = PARTICLE_MODULUS) -> float:
    """E* of particle and wall as the frame deck sets them, Pa."""
    return 1.0 / ((1 - 0.24**2) / particle_modulus + (1 - 0.3**2) / 2.028e11)


def hertz_force(overlap: float) -> float:
    """Force (N) of the pin on a flat at an overlap (m), F = 4/3 E* sqrt(R) delta^1.5 (Hertz 1882)."""
    return 4.0 / 3.0 * effective_modulus() * np.sqrt(RADIUS) * overlap**1.5


def hertz_overlap(load: float = LOAD, radius: float = RADIUS, particle_modulus: float = PARTICLE_MODULUS) -> float:
    """Overlap (m) at which a sphere on a flat carries the load, from F = 4/3 E* sqrt(R) delta^1.5 (Hertz 1882)."""
    return (0.75 * load / (effective_modulus(particle_modulus) * np.sqrt(radius))) ** (2.0 / 3.0)


def pin(x: float, y: float, height: float | None = None) -> list[str]:
    """Deck lines of one sphere; without a height (m) it starts where the load is carried, so nothing has to settle."""
    z = RADIUS - hertz_overlap() if height is None else height
    return [
        f"create_atoms 1 single {x:.17g} {y:.17g} {z:.17g} units box",
        f"set group all density {DENSITY} diameter {2 * RADIUS}",
    ]


def ring(inner: float, outer: float, element_size: float) -> SurfaceMesh:
    """A flat annulus at z = 0 about the z axis, normals up: a polar grid of quads, each cut in two.

    inner, outer: m; element_size: m, no edge of a quad is longer.
    """
    rings = int(np.ceil((outer - inner) / element_size - 1e-9))
    around = int(np.ceil(2 * np.pi * outer / element_size))
    radius, angle = np.meshgrid(
        np.linspace(inner, outer, rings + 1), np.arange(around) * 2 * np.pi / around, indexing="ij"
    )
    radius, angle = radius.ravel(), angle.ravel()
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(radius.size)])
    k, j = (index.ravel() for index in np.meshgrid(np.arange(rings), np.arange(around), indexing="ij"))
    here, there = j, (j + 1) % around
    a, b, c, d = k * around + here, (k + 1) * around + here, (k + 1) * around + there, k * around + there
    return SurfaceMesh(points, np.stack([a, b, c, a, c, d], axis=1).reshape(-1, 3))


def write_case(folder: Path, mesh: SurfaceMesh, particles, motion, mesh_lines=(), outputs=(), **variables) -> None:
    """Write the frame deck and all that it includes into a folder; `deck.in` sets the variables and runs the frame."""
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(FRAME, folder)
    write_stl(folder / "sample.stl", mesh.points, mesh.triangles)
    parts = {
        "particles": particles,
        "mesh": (MESH_LINE, *mesh_lines),
        "motion": motion,
        "ledger": (LEDGER_LINE, *outputs),
        "nothing": ("# particles come from the restart file",),
        "deck": (*(f'variable {name} index "{value}"' for name, value in variables.items()), f"include {FRAME.name}"),
    }
    for name, lines in parts.items():
        (folder / f"{name}.in").write_text("\n".join(lines) + "\n")


def command(ranks: int = 1, solver: Path | str = SOLVER, **variables) -> list[str]:
    """Command that runs a deck in the present folder, variables of the deck overriding what it sets."""
    # a process that waits yields its core: there may be fewer cores than processes
    waiting = ["--oversubscribe", "--bind-to", "none", "--mca", "mpi_yield_when_idle", "1"]
    launcher = ["mpirun", *waiting, "-n", str(ranks)] if ranks > 1 else []
    overriding = [word for name, value in variables.items() for word in ("-var", name, str(value))]
    return [*launcher, str(solver), "-in", "deck.in", "-log", "log.liggghts", *overriding]


def run(folder: Path, ranks: int = 1, solver: Path | str = SOLVER, **variables) -> str:
    """Run the deck in a folder and return what it said; a failed run raises with the end of that."""
    words = command(ranks, solver, **variables)
    done = subprocess.run(words, cwd=folder, env=solver_environment(ranks), capture_output=True)
    said = (done.stdout + done.stderr).decode("utf-8", "replace")  # the solver's messages can hold stray bytes
    if done.returncode:
        raise RuntimeError(f"{folder}/deck.in ended with {done.returncode}:\n{said[-2000:]}")
    return said


def resume(folder: Path, restart_file: str, ranks: int = 1, **variables) -> str:
    """Run the deck in a folder from a restart file on and return what it said."""
    return run(folder, ranks, resumed=1, restart_file=restart_file, particles="nothing", **variables)


def run_case(folder: Path, mesh: SurfaceMesh, particles, motion, ranks: int = 1, **rest) -> LoadLedger:
    """Write a case, run it, and return its ledger."""
    write_case(folder, mesh, particles, motion, **rest)
    run(folder, ranks)
    return read_load_ledger(folder / "load_ledger.bin", "sample", len(mesh.triangles))


def table_of_solver(ledger: LoadLedger, mesh: SurfaceMesh) -> dict[str, np.ndarray]:
    """The solver's ledger as a table, places and vectors in the frame of the mesh's file."""
    return columns_of_solver(ledger.columns, stl_corners(mesh.points, mesh.triangles))


def total(ledger: LoadLedger, column: str) -> float:
    """Sum of a column over all triangles."""
    return float(ledger.columns[column].sum())


def ledger_of_dumps(
    folder: Path,
    mesh: SurfaceMesh,
    time_step: float,
    after_step: int,
    modulus: float = PARTICLE_MODULUS,
    density: float = DENSITY,
    **rest,
) -> dict[str, np.ndarray]:
    """Ledger of the contacts that DUMP_LINES wrote at every step after `after_step`; modulus: Pa, of the particles."""
    corners = stl_corners(mesh.points, mesh.triangles)
    builder = LedgerBuilder(len(mesh.triangles), 0, effective_modulus(modulus), density, corners=corners, **rest)
    for batch in read_contact_batches(folder / "contacts.dump", folder / "spins.dump", after_step=after_step):
        builder.add_batch(batch, time_step)
    return builder.table()


def said_when_refused(folder, solver=None, ledger=LEDGER_LINE, without=()):
    """Run a small case that must fail; return all that it said. without: beginnings of lines left out of the frame."""
    write_case(folder, flat_plate(0.004, 0.004, 1e-3), pin(1.3e-4, 0.7e-4), PIN_MOTION, steps=50)
    (folder / "ledger.in").write_text(ledger + "\n")
    lines = FRAME.read_text().splitlines(keepends=True)
    kept = [line for line in lines if not line.startswith(tuple(without))]
    assert len(kept) == len(lines) - len(without)
    (folder / FRAME.name).write_text("".join(kept))
    words = command() if solver is None else command(solver=solver)
    done = subprocess.run(words, cwd=folder, env=solver_environment(), capture_output=True, timeout=LONGEST_S)
    said = (done.stdout + done.stderr).decode("utf-8", "replace")
    assert done.returncode != 0, said
    assert not (folder / "load_ledger.bin").exists()
    return said


def build(folder, edit=None, **settings):
    """Build the solver from a copy of its sources; edit: (file, old, new). Returns the executable.

    What the edit does not concern is taken as it is built, unless there are other settings than flags.
    """
    sources = folder / "solver"
    ignored = () if settings.keys() <= {"CXXFLAGS"} else ("build",)
    shutil.copytree(REPOSITORY / "solver", sources, ignore=shutil.ignore_patterns(*ignored))
    if edit is not None:
        name, old, new = edit
        text = (sources / name).read_text()
        assert old in text, f"{name} no longer holds what this test takes out"
        (sources / name).write_text(text.replace(old, new))
    words = ["make", "-C", str(sources), "BUILD=build", *(f"{name}={value}" for name, value in settings.items())]
    subprocess.run(words, check=True, capture_output=True)
    return sources / "build" / "liggghts-ledger"
