"""Collisions of single particles in units of their size, which coarse graining must not change.

Units (Yan 2022, Eq 4.6 and 4.7): lengths in the radius R, velocities in sqrt(E*/rho), so times in R sqrt(rho/E*),
forces in E* R^2, torques in E* R^3.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from postproc.readers.dump_text import read_frames
from postproc.reference.collision import Collision, collision, reduced
from postproc.reference.sphere_contact import effective_modulus

DUMP = "collision.dump"
COLUMNS = (
    *("id", "x", "y", "z", "vx", "vy", "vz", "omegax", "omegay", "omegaz"),
    *("fx", "fy", "fz", "tqx", "tqy", "tqz", "radius"),
)
# Collision -> its first sphere and the other one, None for the wall, as numbered in templates/collision.in.j2.
COLLISIONS = {"pair": (1, 2), "oblique pair": (3, 4), "wall": (5, None), "oblique wall": (6, None)}
DOWN = np.array([0.0, 0.0, -1.0])  # where the wall is


@dataclass(frozen=True)
class Spheres:
    """Two spheres and a wall, SI: radii, density, Young's moduli and Poisson's ratios; restitution of pair and wall."""

    radius: float
    smaller_radius: float
    density: float
    modulus: float
    poissons_ratio: float
    wall_modulus: float
    wall_poissons_ratio: float
    restitution: float
    wall_restitution: float

    def effective_modulus(self, kind: str) -> float:
        """Return E* (Pa) of a collision named in COLLISIONS."""
        wall = COLLISIONS[kind][1] is None
        other = (self.wall_modulus, self.wall_poissons_ratio) if wall else (self.modulus, self.poissons_ratio)
        return effective_modulus(self.modulus, self.poissons_ratio, *other)

    def units(self, kind: str) -> dict[str, float]:
        """Return the units (SI) of length, velocity, time, force, torque and spin of a collision."""
        modulus = self.effective_modulus(kind)
        velocity = math.sqrt(modulus / self.density)
        return {
            "length": self.radius,
            "velocity": velocity,
            "time": self.radius / velocity,
            "force": modulus * self.radius**2,
            "torque": modulus * self.radius**3,
            "spin": velocity / self.radius,
        }

    def closed_form(self, kind: str, speed: float) -> Collision:
        """Return the collision at a normal velocity (m/s) from its equation of motion; oblique ones as head-on ones."""
        wall = COLLISIONS[kind][1] is None
        other = math.inf if wall else self.smaller_radius
        mass, other_mass = (4.0 / 3.0 * math.pi * self.density * radius**3 for radius in (self.radius, other))
        restitution = self.wall_restitution if wall else self.restitution
        bodies = reduced(self.radius, other), reduced(mass, other_mass)
        return collision(speed, *bodies, self.effective_modulus(kind), restitution)

    def closed_forms(self, speed: float) -> dict[str, Collision]:
        """Return the closed form of every collision, without the oblique ones."""
        return {kind: self.closed_form(kind, speed) for kind in ("pair", "wall")}


def read_collisions(path: str | Path, spheres: Spheres, time_step: float) -> pd.DataFrame:
    """Return the history of every collision of a dump, from the step before contact to the one after it.

    time_step: s. Columns collision, then without unit (units as above): time (0 at the first step in contact), overlap,
    approach (velocity along the contact's normal), normal_force (repelling), tangential_force (magnitude), torque
    (magnitude, about the first sphere's centre), spin (magnitude, of the first sphere).
    Raises ContactDumpError for a damaged dump.
    """
    batches = list(read_frames(path, "ATOMS", ("id",)))
    steps = np.concatenate([batch.steps for batch in batches])
    frames = np.concatenate([batch.table for batch in batches]).reshape(len(steps), -1, len(COLUMNS))
    tables = [
        _history(kind, frames, steps * time_step, spheres.units(kind)).assign(collision=kind) for kind in COLLISIONS
    ]
    return pd.concat(tables, ignore_index=True)


def _history(kind: str, frames: np.ndarray, time: np.ndarray, units: Mapping[str, float]) -> pd.DataFrame:
    first, other = COLLISIONS[kind]
    place, velocity, spin, force, torque = (_vectors(frames, first, start) for start in (1, 4, 7, 10, 13))
    reach = frames[:, first - 1, -1]
    if other is None:
        normal, distance, relative = DOWN, place[:, 2], velocity
    else:
        between = _vectors(frames, other, 1) - place
        distance = np.linalg.norm(between, axis=1)
        normal, relative = between / distance[:, None], velocity - _vectors(frames, other, 4)
        reach = reach + frames[:, other - 1, -1]
    normal_force = -(force * normal).sum(axis=1)
    table = pd.DataFrame(
        {
            "time": time / units["time"],
            "overlap": (reach - distance) / units["length"],
            "approach": (relative * normal).sum(axis=1) / units["velocity"],
            "normal_force": normal_force / units["force"],
            "tangential_force": np.linalg.norm(force + normal_force[:, None] * normal, axis=1) / units["force"],
            "torque": np.linalg.norm(torque, axis=1) / units["torque"],
            "spin": np.linalg.norm(spin, axis=1) / units["spin"],
        }
    )
    touching = np.flatnonzero(table["overlap"] > 0.0)
    table = table.iloc[max(touching[0] - 1, 0) : touching[-1] + 2]
    return table.assign(time=table["time"] - table["time"].iloc[1]).reset_index(drop=True)


def _vectors(frames: np.ndarray, sphere: int, start: int) -> np.ndarray:
    return frames[:, sphere - 1, start : start + 3]


def collision_measures(histories: pd.DataFrame) -> pd.DataFrame:
    """Return one row per collision with what coarse graining must keep; units as in `read_collisions`.

    Columns collision, restitution (-), largest_overlap, largest_force, largest_tangential_force, largest_torque,
    spin_after, duration.
    """
    rows = []
    for kind, table in histories.groupby("collision", sort=False):
        rows.append(
            {
                "collision": kind,
                "restitution": -table["approach"].iloc[-1] / table["approach"].iloc[0],
                "largest_overlap": table["overlap"].max(),
                "largest_force": table["normal_force"].max(),
                "largest_tangential_force": table["tangential_force"].max(),
                "largest_torque": table["torque"].max(),
                "spin_after": table["spin"].iloc[-1],
                "duration": table["time"].iloc[-2] - table["time"].iloc[1],
            }
        )
    return pd.DataFrame(rows)


def dimensionless(closed: Collision, units: Mapping[str, float]) -> pd.DataFrame:
    """Return a closed form in the columns time, overlap, approach and normal_force of `read_collisions`."""
    return pd.DataFrame(
        {
            "time": closed.time / units["time"],
            "overlap": closed.overlap / units["length"],
            "approach": closed.approach / units["velocity"],
            "normal_force": closed.force / units["force"],
        }
    )


def spread_over_scales(measures: pd.DataFrame) -> pd.DataFrame:
    """Return how far collisions differ between particle scales: rolling_friction, collision, measure, spread (-).

    measures: as from `collision_measures`, with particle_scale and rolling_friction. Spread: largest minus smallest
    over the largest magnitude; measures that are zero throughout are left out.
    """
    keys = ["rolling_friction", "collision"]
    long = measures.melt(id_vars=[*keys, "particle_scale"], var_name="measure").groupby([*keys, "measure"], sort=False)
    range_, most = long["value"].max() - long["value"].min(), long["value"].agg(lambda values: values.abs().max())
    return (range_[most > 0.0] / most[most > 0.0]).rename("spread").reset_index()
