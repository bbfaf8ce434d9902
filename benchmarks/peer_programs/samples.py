"""What a program of a peer writes: states as LIGGGHTS and LAMMPS dump them, and the force on the floor."""

from __future__ import annotations

from pathlib import Path

STATES, FORCES = Path("states.dump"), Path("forces.txt")
NO_BOX = "ITEM: BOX BOUNDS ff ff ff\n0 0\n0 0\n0 0\n"
COLUMNS = "id x y z vx vy vz omegax omegay omegaz"


def write_sample(step, rows, force):
    """Append a sample to the files of this folder.

    rows: one per particle, the values of `COLUMNS`; force: x, y, z in N, of the particles on the floor
    """
    with STATES.open("a") as file:
        file.write(f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{len(rows)}\n{NO_BOX}")
        file.write(f"ITEM: ATOMS {COLUMNS}\n")
        file.writelines(" ".join(map(repr, row)) + "\n" for row in rows)
    with FORCES.open("a") as file:
        file.write(" ".join(map(repr, (step, *force))) + "\n")


def start():
    """Remove what an earlier run left in this folder."""
    for path in (STATES, FORCES):
        path.unlink(missing_ok=True)
