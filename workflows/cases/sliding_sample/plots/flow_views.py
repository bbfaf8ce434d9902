"""Views of the bed that show its regime: from the side and across through the sample's middle, and from below."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from bulkwear.postproc.mesh import SurfaceMesh, boundary_edges, worn_faces
from bulkwear.postproc.plots.style import LARGEST_HEIGHT, MAP, SMALLEST_FONT, draw_circles, new_figure
from bulkwear.postproc.tables.display import MILLIMETRES, in_display_units
from bulkwear.postproc.tables.film import section

SIDE, BOTTOM, ACROSS = "side view", "bottom view", "cross-section"
AXES = {SIDE: ("y", "z", "x"), BOTTOM: ("y", "x", "z"), ACROSS: ("x", "z", "y")}  # horizontal, vertical, looked along
SHOWN_LENGTHS = 1.5  # shown to either side of the middle along the travel, in lengths of the sample
SLAB = 1.0  # -, thickness of what is shown, in largest diameters: one layer, which hides nothing
TOP_SHARE = 0.98  # of the particles lie inside the colours
LABELS = {
    SIDE: ("", "z (mm)"),  # shares the axis of the view below it
    BOTTOM: ("y (mm)", "x (mm)"),
    ACROSS: ("x (mm)", "z (mm)"),
}
ROW_GAP = 0.09  # inches above and below every panel: titles clear the labels of the row above
LEAST_SHARE = 0.25  # -, of the highest panel: what a flat one gets of the height of the figure


def seen_particles(particles: pd.DataFrame, mesh: SurfaceMesh) -> pd.DataFrame:
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
    """Return the sample's lines (k, 2, 2) of ends in m in every view: its cuts, and from below its edge and pattern."""
    turned = SurfaceMesh(mesh.points[:, [1, 0, 2]], mesh.triangles[:, ::-1], mesh.cell_data, mesh.point_data)
    worn = mesh.triangles[worn_faces(mesh)]
    pattern = mesh.triangles[mesh.cell_data["part"] > 0] if "part" in mesh.cell_data else worn[:0]
    edges = np.concatenate([boundary_edges(worn), boundary_edges(pattern)])
    return {SIDE: section(mesh, 0.0), BOTTOM: mesh.points[edges][:, :, [1, 0]], ACROSS: section(turned, 0.0)}


def flow_views(
    views: Mapping[str, pd.DataFrame], lines: Mapping[str, Mapping[str, np.ndarray]], remarks: Sequence[str]
) -> Figure:
    """Draw the three views of each run, a column per run; colour: angular speed (degrees per second).

    views: by run, as from `seen_particles`; lines: by run, as from `sample_lines`. The bed moves to the
    right past the sample, so the sample goes to the left through it.
    """
    figure = new_figure(remarks, LARGEST_HEIGHT, compressed=True)
    tables = {run: in_display_units(table) for run, table in views.items()}
    top = max(float(table["angular_speed_deg_per_s"].quantile(TOP_SHARE)) for table in tables.values())
    norm = Normalize(0.0, top if top > 0.0 else 1.0)
    limits = {view: _limits([table[table["view"] == view] for table in tables.values()]) for view in AXES}
    heights = [np.ptp(vertical) / np.ptp(horizontal) for horizontal, vertical in limits.values()]
    ratios = np.maximum(heights, LEAST_SHARE * max(heights))
    figure.get_layout_engine().set(h_pad=ROW_GAP)
    grid = figure.subplots(len(AXES), len(tables), squeeze=False, sharex="row", sharey="row", height_ratios=ratios)
    for column, (run, table) in enumerate(tables.items()):
        for axes, view in zip(grid[:, column], AXES, strict=True):
            _draw(axes, table[table["view"] == view], lines[run][view] * MILLIMETRES, norm)
            axes.set(xlim=limits[view][0], ylim=limits[view][1], xlabel=LABELS[view][0])
            title = f"{run.replace('_', ' ')}, bed →\n{view}" if view == SIDE else view
            axes.set_title(title, loc="left", fontsize=SMALLEST_FONT, pad=2)
    for axes, view in zip(grid[:, 0], AXES, strict=True):
        axes.set_ylabel(LABELS[view][1])
    bar = figure.colorbar(ScalarMappable(norm, MAP), ax=grid, extend="max", shrink=0.85, pad=0.02, aspect=30)
    bar.set_label("Angular speed of particles (°/s)")
    return figure


def _limits(tables: Sequence[pd.DataFrame]) -> np.ndarray:
    """Return from, to (mm) of the horizontal and of the vertical axis, (2, 2), that show all particles of a view."""
    shown = pd.concat(tables)
    places, reach = shown[["horizontal_mm", "vertical_mm"]].to_numpy(), shown["radius_mm"].max()
    return np.stack([places.min(axis=0) - reach, places.max(axis=0) + reach], axis=1)


def _draw(axes: Axes, table: pd.DataFrame, lines: np.ndarray, norm: Normalize) -> None:
    places = table[["horizontal_mm", "vertical_mm"]].to_numpy()
    draw_circles(axes, places, table["radius_mm"].to_numpy(), table["angular_speed_deg_per_s"].to_numpy(), norm, MAP)
    axes.add_collection(LineCollection(lines, colors="black", linewidths=1.0))
    axes.set_aspect("equal")
    axes.grid(False)


def flow_views_table(views: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Return the particles of the figure in display units: run, view, id, places and radius in mm, speed in deg/s."""
    return in_display_units(pd.concat([table.assign(run=run) for run, table in views.items()], ignore_index=True))
