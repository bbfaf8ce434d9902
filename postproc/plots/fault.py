"""A picture of a fault in a surface: the whole of it with the place marked, and the faces at fault, close by."""

from __future__ import annotations

import os

import numpy as np
from matplotlib.figure import Figure

from bulkwear.postproc.mesh import SurfaceMesh, centroids
from bulkwear.postproc.plots.scene import OBLIQUE, STEEL, load_pyvista, new_plotter, pixels_of
from bulkwear.postproc.plots.style import SMALLEST_FONT, new_figure, picture
from bulkwear.postproc.tables.display import MILLIMETRES

FAULT_COLOUR, LINE_COLOUR = "#d62728", "#555555"
CLOSE_BY = 3.0  # -, width of the close view over the largest size of the first faulty face
SMALLEST_VIEW = 2e-3  # -, of the surface, width of the close view
MARK = 0.02  # -, of the surface, radius of the ball at the place
SIZE = (900, 700)  # pixels of each view


def draw_fault(mesh: SurfaceMesh, faces: np.ndarray, place: np.ndarray, message: str) -> Figure:
    """Draw a surface in grey, its faulty faces in red, from afar and zoomed to the place.

    mesh: m; faces: (k,) those at fault; place: (3,) m, of the first; message: printed below
    """
    figure = new_figure([message], 4.4)
    whole, close = figure.subplots(1, 2)
    size = float(np.linalg.norm(np.ptp(mesh.points, axis=0)))
    near = mesh.points[mesh.triangles[faces[:1]]].reshape(-1, 3)
    width = max(CLOSE_BY * float(np.linalg.norm(near - place, axis=1).max()), SMALLEST_VIEW * size)
    centre = 0.5 * (mesh.points.min(axis=0) + mesh.points.max(axis=0))
    shown = np.linalg.norm(centroids(mesh.points, mesh.triangles) - place, axis=1) <= width
    shown[faces[:1]] = True
    picture(whole, _view(mesh, faces, np.ones(len(shown), dtype=bool), centre, size, place))
    picture(close, _view(mesh, faces, shown, np.asarray(place), min(width, size), None))
    whole.set_title("The whole, the place as a ball", fontsize=SMALLEST_FONT)
    close.set_title(
        f"Close by, {MILLIMETRES * min(width, size):.3g} mm wide, what is in front left out", fontsize=SMALLEST_FONT
    )
    return figure


def save_fault(path: str | os.PathLike, mesh: SurfaceMesh, faces: np.ndarray, place: np.ndarray, message: str) -> None:
    """Write the figure of `draw_fault` as PNG."""
    draw_fault(mesh, faces, place, message).savefig(path, format="png")


def _view(mesh, faces, shown, centre, width, place) -> np.ndarray:
    """Pixels (h, w, 3) of the shown faces (m,) bool in a view that is `width` (m) wide; a ball at the place, if any."""
    pyvista, plotter = load_pyvista(), new_plotter(SIZE)
    faulty = np.zeros(len(mesh.triangles), dtype=bool)
    faulty[faces] = True
    for mask, colour in ((shown & ~faulty, STEEL), (shown & faulty, FAULT_COLOUR)):
        if mask.any():
            poly = pyvista.PolyData.from_regular_faces(mesh.points * MILLIMETRES, mesh.triangles[mask])
            plotter.add_mesh(poly, color=colour, show_edges=True, edge_color=LINE_COLOUR, ambient=0.35, diffuse=0.65)
    if place is not None:
        ball = pyvista.Sphere(radius=MARK * width * MILLIMETRES, center=np.asarray(place) * MILLIMETRES)
        plotter.add_mesh(ball, color=FAULT_COLOUR)
    focus, far = centre * MILLIMETRES, 10.0 * np.linalg.norm(np.ptp(mesh.points, axis=0)) * MILLIMETRES
    direction = np.array(OBLIQUE) / np.linalg.norm(OBLIQUE)
    plotter.camera_position = [focus + far * direction, focus, (0.0, 0.0, 1.0)]
    plotter.camera.parallel_scale = 0.5 * width * MILLIMETRES
    plotter.renderer.ResetCameraClippingRange()
    return pixels_of(plotter)
