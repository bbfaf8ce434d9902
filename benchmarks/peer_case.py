"""What `benchmarks.peers` gives to every code: one bed of spheres at rest in a box whose floor is pulled away under it,
and one sphere dragged over that floor; and what is computed of each code's answer by the same lines.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.spatial import cKDTree

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.mesh import SurfaceMesh, write_stl
from bulkwear.workflows.engine.derived import rayleigh_time, youngs_modulus

RUN, PARTICLES, STATES, FORCES, WEAR = "run.json", "particles.csv", "states.dump", "forces.txt", "wear.json"
STATE_COLUMNS = ("id", "x", "y", "z", "vx", "vy", "vz", "omegax", "omegay", "omegaz")
SHEAR_MODULUS, POISSONS_RATIO, DENSITY = 7.0e7, 0.24, 2500.0  # Pa, -, kg/m3; particles and walls alike
RADII = (1.8e-3, 2.0e-3, 2.2e-3)  # m, as many of each: equal ones would stand in rows
RAYLEIGH_FRACTION = 0.2  # -, of the smallest one
ELEMENT_SIZE, MARGIN = 5e-3, 20e-3  # m, of the floor's triangles; how far it reaches beyond the box
LOADED_OVERLAP = 2e-6  # m, of the one sphere
ARCHARD = 1e-11  # 1/Pa, volume over normal force and sliding distance


@dataclass(frozen=True)
class PeerRun:
    """What a code is to simulate, SI. Walls stand at +-half_width in x and y, the floor lies at 0 and moves along +x.

    dragged: the floor rests and the particles go along +x at its speed, at their height and without turning, so that
        load and sliding are known in closed form
    """

    steps: int
    samples: int
    half_width: float = 30e-3
    height: float = 120e-3
    speed: float = 0.2
    dragged: bool = False
    youngs_modulus: float = youngs_modulus(SHEAR_MODULUS, POISSONS_RATIO)
    poissons_ratio: float = POISSONS_RATIO
    density: float = DENSITY
    friction: float = 0.5
    restitution: float = 0.6
    gravity: float = 9.81
    archard: float = ARCHARD
    time_step: float = field(
        default=RAYLEIGH_FRACTION * rayleigh_time(RADII[0], DENSITY, SHEAR_MODULUS, POISSONS_RATIO)
    )

    @property
    def interval(self) -> int:
        """Steps between samples."""
        return self.steps // self.samples

    @property
    def travel(self) -> float:
        """Way of floor or particles, m."""
        return self.speed * self.steps * self.time_step

    @property
    def domain_side(self) -> float:
        """Half the side (m) of a domain that the floor does not leave."""
        return self.half_width + MARGIN + abs(self.travel) + ELEMENT_SIZE

    @property
    def effective_modulus(self) -> float:
        """E* of two bodies of the material, Pa."""
        return self.youngs_modulus / (2.0 * (1.0 - self.poissons_ratio**2))

    @property
    def tangential_damping(self) -> float:
        """Tangential over normal damping of two bodies of the material, sqrt(4 G*/E*) (-), as LIGGGHTS has it."""
        return math.sqrt(2.0 * (1.0 - self.poissons_ratio) / (2.0 - self.poissons_ratio))


def hertz_force(run: PeerRun, radius: float, overlap: float) -> float:
    """Return F = 4/3 E* sqrt(R) delta^1.5 (N) of a sphere on a flat, from radius and overlap in m (Hertz 1882)."""
    return 4.0 / 3.0 * run.effective_modulus * math.sqrt(radius) * overlap**1.5


def floor_mesh(run: PeerRun) -> SurfaceMesh:
    """Return the floor, with room for its travel."""
    side = 2.0 * (run.half_width + MARGIN)
    return flat_plate(side, side, ELEMENT_SIZE)


def write_case(folder: Path, run: PeerRun, particles: np.ndarray) -> None:
    """Write what programs read: numbers, particles (n, 4: centre and radius, m), the floor as STL and as a table."""
    folder.mkdir(parents=True, exist_ok=True)
    mesh = floor_mesh(run)
    write_stl(folder / "floor.stl", mesh.points, mesh.triangles)
    told = asdict(run) | {
        "interval": run.interval,
        "points": mesh.points.tolist(),
        "triangles": mesh.triangles.tolist(),
    }
    (folder / RUN).write_text(json.dumps(told))
    np.savetxt(folder / PARTICLES, particles, fmt="%.17g", delimiter=",", header="x,y,z,radius", comments="")


def one_sphere() -> np.ndarray:
    """Return the sphere (1, 4) that is dragged at `LOADED_OVERLAP` in the floor."""
    radius = RADII[1]
    return np.array([[1.1e-3, 1.7e-3, radius - LOADED_OVERLAP, radius]])


def read_states(folder: Path) -> dict[int, np.ndarray]:
    """Return {step: (n, 10)} of `STATE_COLUMNS`, in the order of the ids. Raises ValueError for another table."""
    found, lines = {}, (folder / STATES).read_text().splitlines()
    starts = [number for number, line in enumerate(lines) if line == "ITEM: TIMESTEP"]
    for start, end in zip(starts, [*starts[1:], len(lines)], strict=True):
        head = lines[start + 8].split()[2:]
        if tuple(head) != STATE_COLUMNS:
            raise ValueError(f"{folder / STATES}: columns {head}, allowed are {STATE_COLUMNS}")
        rows = np.loadtxt(lines[start + 9 : end], ndmin=2)
        found[int(lines[start + 1])] = rows[np.argsort(rows[:, 0])]
    return found


def kinetic_energy(state: np.ndarray, radii: np.ndarray, density: float = DENSITY) -> float:
    """Return the kinetic energy (J), turning included, of spheres; state: (n, 10) of `STATE_COLUMNS`."""
    mass = density * 4.0 / 3.0 * math.pi * radii**3
    moving, turning = ((state[:, columns] ** 2).sum(axis=1) for columns in (slice(4, 7), slice(7, 10)))
    return float((0.5 * mass * moving + 0.2 * mass * radii**2 * turning).sum())


def contact_number(state: np.ndarray, radii: np.ndarray) -> int:
    """Return how many pairs of spheres overlap."""
    centres = state[:, 1:4]
    pairs = cKDTree(centres).query_pairs(2.0 * radii.max(), output_type="ndarray")
    apart = np.linalg.norm(centres[pairs[:, 0]] - centres[pairs[:, 1]], axis=1)
    return int((apart < radii[pairs].sum(axis=1)).sum())


def answer(folder: Path, run: PeerRun, particles: np.ndarray) -> pd.DataFrame:
    """Return step, kinetic_energy_J, contacts and the force of the particles on the floor (force_x_N, force_z_N), a row
    per sample.
    """
    radii = particles[:, 3]
    states = read_states(folder)
    forces = {int(row[0]): row[1:] for row in np.loadtxt(folder / FORCES, ndmin=2)}
    return pd.DataFrame(
        {
            "step": step,
            "kinetic_energy_J": kinetic_energy(states[step], radii, run.density),
            "contacts": contact_number(states[step], radii),
            "force_x_N": forces[step][0],
            "force_z_N": forces[step][2],
        }
        for step in sample_steps(run)
    )


def sample_steps(run: PeerRun) -> Sequence[int]:
    """Return the steps whose samples count."""
    return range(run.interval, run.steps + 1, run.interval)
