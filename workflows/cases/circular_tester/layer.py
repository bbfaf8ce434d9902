"""The particles next to a sample in the circular wear tester: how fast they pass and turn (Yan 2022, Fig 6.17-6.20)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from postproc.flow.bed import read_snapshot, snapshots
from postproc.readers.cycle_folders import LAYER_TABLE

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

    start: revolutions before the cycle. Columns: revolution, particles, velocity_m_per_s (along the travel),
    angular_speed_rad_per_s, means over the particles. Raises FileNotFoundError without a snapshot.
    """
    dumps = [path for path in snapshots(cycle_folder) if path.name != FIRST_SNAPSHOT]
    if not dumps:
        raise FileNotFoundError(f"{cycle_folder}: no bed_*.dump found, at least one is needed to know the flow.")
    rows = []
    for path in dumps:
        found = layer.of(read_snapshot(path))
        rows.append(
            {
                "revolution": start + revolutions_per_step * int(path.stem.removeprefix("bed_")),
                "particles": len(found),
                "velocity_m_per_s": found["velocity_y_m_per_s"].mean(),
                "angular_speed_rad_per_s": found["angular_speed_rad_per_s"].mean(),
            }
        )
    pd.DataFrame(rows).to_csv(Path(cycle_folder) / LAYER_TABLE, index=False)
    return dumps[:-1]
