"""The lowest layer over a sample in the circular wear tester: how fast its particles pass and turn (Yan 2022, Fig 6.17
to 6.20)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.flow.bed import read_snapshot, snapshots
from bulkwear.postproc.flow.moving_bins import (
    AVERAGED_ANGULAR_VELOCITY,
    MEAN_ANGULAR_SPEED,
    averaged_angular_velocity,
)
from bulkwear.postproc.mesh import PLAIN, SurfaceMesh
from bulkwear.postproc.readers.cycle_folders import LAYER_TABLE
from bulkwear.workflows.cases.circular_tester.runs import TesterRun

FIRST_SNAPSHOT = "bed_0.dump"  # of a cycle, the last one of the cycle before
AXES = ["x_m", "y_m", "z_m"]


@dataclass(frozen=True, eq=False)
class LayerOverSample:
    """The lowest layer over a sample: centres over its top, less than `height` away from its plane.

    width, length, height: m; rotation: (3, 3), from the sample's own frame to that of the snapshots
    """

    width: float
    length: float
    height: float
    rotation: np.ndarray

    def inside(self, places: np.ndarray) -> np.ndarray:
        """Whether centres (k, 3) m of the snapshots' frame are in the layer, (k,)."""
        x, y, z = (places @ self.rotation).T
        return (np.abs(x) < 0.5 * self.width) & (np.abs(y) < 0.5 * self.length) & (z > 0.0) & (z < self.height)

    def of(self, snapshot: pd.DataFrame) -> pd.DataFrame:
        """The particles of a snapshot, as from `read_snapshot`, that are in the layer."""
        return snapshot[self.inside(snapshot[AXES].to_numpy())]


def reduce_layer(
    cycle_folder: str | Path, layer: LayerOverSample, start: float, revolutions_per_step: float
) -> list[Path]:
    """Write what the layer does in each snapshot of a wear cycle; return those of no use then, all but the last.

    start: revolutions before the cycle. Columns: revolution, particles, and over these velocity_m_per_s (mean, along
    the travel), averaged_angular_velocity_rad_per_s (components averaged, then the magnitude, as Yan 2022 has it in
    section 3.5.3.3; Fig 6.17 is taken to have the same) and mean_angular_speed_rad_per_s (magnitudes averaged).
    Raises FileNotFoundError without a snapshot.
    """
    dumps = [path for path in snapshots(cycle_folder) if path.name != FIRST_SNAPSHOT]
    if not dumps:
        raise FileNotFoundError(f"{cycle_folder}: no bed_<step>.dump found, at least one is needed to know the flow.")
    rows = []
    for path in dumps:
        found = layer.of(read_snapshot(path))
        rows.append(
            {
                "revolution": start + revolutions_per_step * int(path.stem.removeprefix("bed_")),
                "particles": len(found),
                "velocity_m_per_s": found["velocity_y_m_per_s"].mean(),
                AVERAGED_ANGULAR_VELOCITY: averaged_angular_velocity(found.mean().to_frame().T).item(),
                MEAN_ANGULAR_SPEED: found["angular_speed_rad_per_s"].mean(),
            }
        )
    pd.DataFrame(rows).to_csv(Path(cycle_folder) / LAYER_TABLE, index=False)
    return dumps[:-1]


def layer_of(run: TesterRun) -> LayerOverSample:
    """The lowest layer over the sample of a run."""
    return LayerOverSample(run.width, run.length, run.layer_height, run.rotation)


def layer_particles(run: TesterRun, revolution: float) -> pd.DataFrame:
    """Particles of the lowest layer at the end of the wear cycle nearest to a revolution, as `relative_motion` wants
    them: surface, x_m, y_m, radius_m, vx_m_per_s, vy_m_per_s, angular_speed_rad_per_s.
    """
    wear = pd.read_csv(run.folder / "wear.csv", usecols=["cycle", "revolution"])
    cycle = int(wear.loc[(wear["revolution"] - revolution).abs().idxmin(), "cycle"])
    found = layer_of(run).of(read_snapshot(snapshots(run.folder / f"cycle_{cycle:03d}")[-1]))
    names = {"velocity_x_m_per_s": "vx_m_per_s", "velocity_y_m_per_s": "vy_m_per_s"}
    kept = found.rename(columns=names)[["x_m", "y_m", "radius_m", *names.values(), "angular_speed_rad_per_s"]]
    return kept.assign(surface=run.surface)


def relative_motion(particles: pd.DataFrame) -> pd.DataFrame:
    """Speeds of the particles of a layer over the mean of the plain sample's (Fig 6.19 and 6.20).

    particles: surface, x_m, y_m, radius_m, vx_m_per_s, vy_m_per_s, angular_speed_rad_per_s. Added: relative_speed and
    relative_angular_speed, -, both of each particle's own magnitude over the mean of these over the plain sample: the
    source says "based on the average value for the plain sample". Raises ValueError without such particles.
    """
    speed = np.hypot(particles["vx_m_per_s"], particles["vy_m_per_s"])
    plain = particles["surface"] == PLAIN
    if not plain.any():
        raise ValueError("relative speeds need the particles over a plain sample, found none")
    return particles.assign(
        relative_speed=speed / speed[plain].mean(),
        relative_angular_speed=particles["angular_speed_rad_per_s"]
        / particles.loc[plain, "angular_speed_rad_per_s"].mean(),
    )


def outlines(mesh: SurfaceMesh) -> np.ndarray:
    """Ends (k, 2, 2) m of the edges round the parts of a pristine top, from above: its rim and the pattern's feet."""
    part = mesh.cell_data["part"]
    edges = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    owner = np.repeat(part, 3)
    order = np.lexsort((owner, edges[:, 1], edges[:, 0]))
    edges, owner = edges[order], owner[order]
    same = (edges[1:] == edges[:-1]).all(axis=1)
    first = np.flatnonzero(same & (owner[1:] != owner[:-1]))
    inner = edges[first]
    alone = np.ones(len(edges), bool)
    alone[1:] &= ~same
    alone[:-1] &= ~same
    return mesh.points[np.concatenate([inner, edges[alone]])][:, :, :2]
