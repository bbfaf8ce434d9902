"""Snapshots of the bed: reading the solver's particle dumps and choosing the particles a cut shows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.readers.cycle_folders import cycle_folders, step_files

SHOWN_LENGTHS = 1.0  # piece of bed shown to either side of the middle of the sample, in lengths of the sample
MOST_PARTICLES = 8_000  # drawn per picture: thicker beds become a slab behind the cut
HEADER_LINES = 9  # of a dump custom with one frame
NEEDED = ("id", "x", "y", "z", "vx", "vy", "vz", "omegax", "omegay", "omegaz", "radius")


def snapshots(cycle_folder: str | Path) -> list[Path]:
    """Return the bed dumps of a wear cycle in the order of their time steps."""
    return step_files(cycle_folder, "bed_", ".dump")


def last_snapshot(run_folder: str | Path) -> Path:
    """Return the newest bed dump of a run's last cycle that has one. Raises FileNotFoundError when there is
    none.
    """
    for folder in reversed(cycle_folders(run_folder)):
        if dumps := snapshots(folder):
            return dumps[-1]
    raise FileNotFoundError(
        f"{run_folder}: no cycle_*/bed_<step>.dump found, at least one wear cycle must have been run."
    )


def read_snapshot(path: str | Path) -> pd.DataFrame:
    """Return one frame of particles in SI: id, x_m, y_m, z_m, radius_m, speed_m_per_s, velocity_x_m_per_s and
    velocity_y_m_per_s (relative to the sample), angular_velocity_x_rad_per_s and so on, angular_speed_rad_per_s (their
    magnitude), and contacts (of each with other particles) where the solver counted them.

    Raises ValueError when the file is no dump of one frame or is cut short.
    """
    with open(path, encoding="ascii") as stream:
        header = [stream.readline() for _ in range(HEADER_LINES)]
    columns = header[-1].split()[2:]
    if not header[-1].startswith("ITEM: ATOMS") or not set(NEEDED) <= set(columns):
        raise ValueError(
            f"{path}: line {HEADER_LINES} must be ITEM: ATOMS with {' '.join(NEEDED)}, found {header[-1].strip()!r}"
        )
    table = pd.read_csv(path, sep=r"\s+", skiprows=HEADER_LINES, names=columns, index_col=False)
    expected = int(header[3])
    if len(table) != expected or table.isna().to_numpy().any():
        raise ValueError(f"{path}: {expected} particles announced, found {len(table)} whole or broken rows")
    counted = {"contacts": table["c_contacts"]} if "c_contacts" in table else {}
    return pd.DataFrame(
        {
            "id": table["id"],
            **{f"{axis}_m": table[axis] for axis in "xyz"},
            "radius_m": table["radius"],
            "speed_m_per_s": np.linalg.norm(table[["vx", "vy", "vz"]], axis=1),
            "velocity_x_m_per_s": table["vx"],
            "velocity_y_m_per_s": table["vy"],
            **{f"angular_velocity_{axis}_rad_per_s": table[f"omega{axis}"] for axis in "xyz"},
            "angular_speed_rad_per_s": np.linalg.norm(table[["omegax", "omegay", "omegaz"]], axis=1),
            **counted,
        }
    )


def lag(particles: pd.DataFrame, start: float, end: float, velocity: float) -> float:
    """Return how far the bed between two places along the travel (m) lags behind its floor, over the floor's velocity.

    particles: as from `read_snapshot`; velocity: m/s. NaN where there are no particles.
    """
    there = particles["y_m"].between(start, end)
    return float(1.0 - particles.loc[there, "velocity_y_m_per_s"].mean() / velocity)


def behind_cut(particles: pd.DataFrame, stretch: float, most: int) -> pd.DataFrame:
    """Return the particles that a cut along the travel at x = 0 leaves to see from +x.

    stretch: m, half the length of the piece of bed round the sample. most: particles kept; those nearest to
    the cut stay, so a thick bed becomes a slab.
    """
    near = particles[(particles["x_m"] <= 0.0) & (particles["y_m"].abs() <= stretch)]
    return near.sort_values("x_m", ascending=False, kind="stable").head(most).reset_index(drop=True)


def shown_particles(run_folder: str | Path, mesh: SurfaceMesh) -> pd.DataFrame:
    """Return the particles of a run's last snapshot that its figure shows, behind a cut along the travel
    (SI).
    """
    stretch = SHOWN_LENGTHS * float(np.ptp(mesh.points[:, 1]))
    return behind_cut(read_snapshot(last_snapshot(run_folder)), stretch, MOST_PARTICLES)
