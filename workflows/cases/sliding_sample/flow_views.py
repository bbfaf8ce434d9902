"""Views of the bed that show its regime: from the side and across through the sample's middle, and from below."""

from __future__ import annotations

import numpy as np
import pandas as pd

from postproc.mesh import SurfaceMesh, boundary_edges
from postproc.tables.film import section
from postproc.wear.update import worn_faces

SIDE, BOTTOM, ACROSS = "side view", "bottom view", "cross-section"
AXES = {SIDE: ("y", "z", "x"), BOTTOM: ("y", "x", "z"), ACROSS: ("x", "z", "y")}  # horizontal, vertical, looked along
SHOWN_LENGTHS = 1.5  # shown to either side of the middle along the travel, in lengths of the sample
SLAB = 1.0  # -, thickness of what is shown, in largest diameters: one layer, which hides nothing


def flow_views(particles: pd.DataFrame, mesh: SurfaceMesh) -> pd.DataFrame:
    """Return the particles of every view, farthest first: view, id, horizontal_m, vertical_m, radius_m,
    angular_speed_rad_per_s.

    particles: as from `bed.read_snapshot`; mesh: the sample with its middle at x = y = 0.
    Side view: a slab of one largest diameter along the travel at x = 0. Cross-section: one across it at y = 0. Bottom
    view: the particles that reach below half a largest diameter above the floor z = 0. Seen from +x, +y and below.
    """
    half_length = 0.5 * float(np.ptp(mesh.points[worn_nodes(mesh), 1]))
    near = particles[particles["y_m"].abs() <= 2.0 * SHOWN_LENGTHS * half_length]
    thickness = SLAB * 2.0 * float(near["radius_m"].max()) if len(near) else 0.0
    inside = {
        SIDE: near["x_m"].abs() <= 0.5 * thickness,
        BOTTOM: near["z_m"] - near["radius_m"] <= 0.5 * thickness,
        ACROSS: near["y_m"].abs() <= 0.5 * thickness,
    }
    return pd.concat([_view(view, near[inside[view]]) for view in AXES], ignore_index=True)


def _view(view: str, particles: pd.DataFrame) -> pd.DataFrame:
    horizontal, vertical, along = AXES[view]
    ordered = particles.sort_values(f"{along}_m", ascending=view == SIDE, kind="stable")
    return pd.DataFrame(
        {
            "view": view,
            "id": ordered["id"],
            "horizontal_m": ordered[f"{horizontal}_m"],
            "vertical_m": ordered[f"{vertical}_m"],
            "radius_m": ordered["radius_m"],
            "angular_speed_rad_per_s": ordered["angular_speed_rad_per_s"],
        }
    )


def worn_nodes(mesh: SurfaceMesh) -> np.ndarray:
    """Return the nodes (k,) of the faces that wear."""
    return np.unique(mesh.triangles[worn_faces(mesh)])


def sample_lines(mesh: SurfaceMesh) -> dict[str, np.ndarray]:
    """Return the sample's lines (k, 2, 2) of ends in m in every view: its cuts, and from below its edge and bumps."""
    turned = SurfaceMesh(mesh.points[:, [1, 0, 2]], mesh.triangles[:, ::-1], mesh.cell_data, mesh.point_data)
    worn = mesh.triangles[worn_faces(mesh)]
    bumps = mesh.triangles[mesh.cell_data["part"] > 0] if "part" in mesh.cell_data else worn[:0]
    edges = np.concatenate([boundary_edges(worn), boundary_edges(bumps)])
    return {SIDE: section(mesh, 0.0), BOTTOM: mesh.points[edges][:, :, [1, 0]], ACROSS: section(turned, 0.0)}
