"""What figures of the flow show: particles of a snapshot seen from a side, mean velocities there, outlines of parts."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.readers.dump_text import read_frames
from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.workflows.cases.equipment.plane_cuts import SectionPlane, cut

AXES = "xyz"
CELL_DIAMETERS = 1.25  # -, side of a cell of the mean velocity over the mean diameter
FEWEST_IN_CELL = 3  # particles of all snapshots, of which a mean is told
LEVEL = 0.2  # -, sine of an axis with the horizontal up to which it counts as level


@dataclass(frozen=True, eq=False)
class Side:
    """The side from which a machine is looked at: unit vectors (3,) to the right, up, and to the eye."""

    right: np.ndarray
    up: np.ndarray

    @property
    def towards(self) -> np.ndarray:
        """Return the unit vector to the eye, (3,)."""
        return np.cross(self.right, self.up)

    def places_mm(self, points: np.ndarray) -> np.ndarray:
        """Return points (n, 3) m as seen, (n, 2) mm to the right and up."""
        return MILLIMETRES * np.column_stack([points @ self.right, points @ self.up])


def read_particles(path: str | Path) -> pd.DataFrame:
    """Return the particles of the last instant of a snapshot: step, x_m .. z_m, vx_m_per_s .. vz_m_per_s, radius_m."""
    found = None
    for batch in read_frames(path, "ATOMS", whole_columns=("id",)):
        last = slice(batch.starts[-2], batch.starts[-1])
        found = pd.DataFrame(batch.table[last], columns=batch.columns).assign(step=int(batch.steps[-1]))
    if found is None:
        raise ValueError(f"{path}: found no instant, allowed is a snapshot of one or more")
    names = {axis: f"{axis}_m" for axis in AXES} | {f"v{axis}": f"v{axis}_m_per_s" for axis in AXES}
    return found.rename(columns=names | {"radius": "radius_m"})[["step", *names.values(), "radius_m"]]


def positions(particles: pd.DataFrame) -> np.ndarray:
    """Return the places of particles, (n, 3) m."""
    return particles[[f"{axis}_m" for axis in AXES]].to_numpy(float)


def velocities(particles: pd.DataFrame) -> np.ndarray:
    """Return the velocities of particles, (n, 3) m/s."""
    return particles[[f"v{axis}_m_per_s" for axis in AXES]].to_numpy(float)


def side_along(axis: np.ndarray) -> Side:
    """Return the side from which one looks along an axis (3,): z up, and to the right the positive x or y; along z from
    above.
    """
    towards = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    if abs(towards[2]) > 1.0 - LEVEL:
        return Side(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))
    towards = towards * [1.0, 1.0, 0.0]
    right = np.cross([0.0, 0.0, 1.0], towards / np.linalg.norm(towards))
    return Side(right * (np.sign(right[np.abs(right).argmax()]) or 1.0), np.array([0.0, 0.0, 1.0]))


def flow_side(particles: pd.DataFrame, periodic: str | None, turning: np.ndarray | None) -> Side:
    """Return the side from which a flow is seen best.

    It is along the axis in which the machine is periodic, else along a level axis (3,) that parts turn about, else
    along the level axis with the least kinetic energy, so that most of the motion is across the view.
    """
    if periodic is not None:
        return side_along(np.eye(3)[AXES.index(periodic)])
    if turning is not None:
        return side_along(turning)
    mass = particles["radius_m"].to_numpy() ** 3
    energy = mass @ velocities(particles)[:, :2] ** 2 if len(particles) else np.ones(2)
    return side_along(np.eye(3)[int(np.argmin(energy))])


def seen(particles: pd.DataFrame, side: Side) -> pd.DataFrame:
    """Return particles as they are seen: right_mm, up_mm, depth_mm, radius_mm, speed_m_per_s; the farthest first."""
    places, speeds = positions(particles), velocities(particles)
    shown = side.places_mm(places)
    table = pd.DataFrame(
        {
            "right_mm": shown[:, 0],
            "up_mm": shown[:, 1],
            "depth_mm": MILLIMETRES * places @ side.towards,
            "radius_mm": MILLIMETRES * particles["radius_m"].to_numpy(),
            "speed_m_per_s": np.linalg.norm(speeds, axis=1),
        }
    )
    return table.sort_values("depth_mm", kind="stable", ignore_index=True)


def outlines(parts: Iterable[SurfaceMesh], side: Side, place: np.ndarray) -> np.ndarray:
    """Return sections of parts by the plane of a view through a place (3,) m: lines (k, 2, 2) mm, right and up."""
    plane = SectionPlane(np.asarray(place, dtype=float), side.right, side.up)
    lines = [cut(mesh, plane)[0] for mesh in parts]
    origin = np.array([place @ side.right, place @ side.up])
    return MILLIMETRES * (np.concatenate([np.zeros((0, 2, 2)), *lines]) + origin)


def velocity_field(snapshots: Iterable[pd.DataFrame], side: Side) -> pd.DataFrame:
    """Return mean velocities by cells of a view, weighted by mass, of particles of many instants.

    right_mm, up_mm: middles of cells; side_mm: of a cell; particles: so many; velocity_right_m_per_s,
    velocity_up_m_per_s, speed_m_per_s: length of the mean velocity across the view
    """
    particles = pd.concat(list(snapshots), ignore_index=True)
    length = CELL_DIAMETERS * 2.0 * MILLIMETRES * float(particles["radius_m"].mean())
    mass, across = particles["radius_m"].to_numpy() ** 3, velocities(particles) @ np.array([side.right, side.up]).T
    cells = np.floor(side.places_mm(positions(particles)) / length).astype(np.int64)
    found, own, counts = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
    total = np.bincount(own.ravel(), mass)
    right, up = (np.bincount(own.ravel(), mass * values) / total for values in across.T)
    table = pd.DataFrame(
        {
            "right_mm": (found[:, 0] + 0.5) * length,
            "up_mm": (found[:, 1] + 0.5) * length,
            "side_mm": length,
            "particles": counts,
            "velocity_right_m_per_s": right,
            "velocity_up_m_per_s": up,
            "speed_m_per_s": np.hypot(right, up),
        }
    )
    return table[table["particles"] >= FEWEST_IN_CELL].reset_index(drop=True)


def filling_field(snapshots: Iterable[pd.DataFrame], side: Side, length: float) -> pd.DataFrame:
    """Return how full a slice is by cells of a view, a mean over instants.

    length: m of the slice along the view
    right_mm, up_mm, side_mm as in `velocity_field`; solid_fraction: volume of the particles whose centres are in a cell
    over its volume, -
    """
    snapshots = list(snapshots)
    particles = pd.concat(snapshots, ignore_index=True)
    cell = MILLIMETRES * 2.0 * float(particles["radius_m"].mean())
    volume = 4.0 / 3.0 * np.pi * particles["radius_m"].to_numpy() ** 3 / len(snapshots)
    found, own = np.unique(
        np.floor(side.places_mm(positions(particles)) / cell).astype(np.int64), axis=0, return_inverse=True
    )
    filled = np.bincount(own.ravel(), volume) / (length * (cell / MILLIMETRES) ** 2)
    middles = (found + 0.5) * cell
    return pd.DataFrame({"right_mm": middles[:, 0], "up_mm": middles[:, 1], "side_mm": cell, "solid_fraction": filled})
