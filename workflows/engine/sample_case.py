"""What cases have in common whose worn surface is a sample in plan: a base with or without bumps, past which bulk
material travels."""

from __future__ import annotations

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.workflows.engine.case import Case, Parameters


class SampleCase(Case):
    """A case whose surface has the base as part 0 and its bumps as parts 1, 2, ..., and whose rim slides down a holder.

    Its tables count wear over the travel.
    """

    worn_pair = (("sample", "material"), ("bed", "material"))
    rim_direction = (0.0, 0.0, -1.0)

    def travel_columns(self, parameters: Parameters, time_s: np.ndarray | float) -> dict[str, np.ndarray | float]:
        """Return the travel of the bulk material over the sample (m)."""
        return {"travel_m": time_s * parameters["sliding"]["velocity_m_per_s"]}

    def label_columns(self, surface: SurfaceMesh, volume: np.ndarray) -> dict[str, float]:
        """Return the worn volume (m3) of the base and of its bumps."""
        part = surface.cell_data["part"]
        return {
            "base_worn_volume_m3": float(volume[part == 0].sum()),
            "pattern_worn_volume_m3": float(volume[part > 0].sum()),
        }
