"""Rendered pictures: worn surfaces and beds as arrays of pixels. Off-screen, no X needed."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import SurfaceMesh, area_vectors, boundary_edges, worn_faces
from bulkwear.postproc.plots.style import MAP, SKIRT_COLOUR
from bulkwear.postproc.tables.depths import face_depth, held_back_faces
from bulkwear.postproc.tables.display import MICROMETRES, MILLIMETRES

Direction = tuple[float, float, float]

OBLIQUE = (0.55, -1.0, 0.75)  # from upstream, above: the bed comes towards the back
OTHER_OBLIQUE = tuple((x, y, z) for z in (0.75, -0.75) for x in (0.55, -0.55) for y in (-1.0, 1.0))[1:]
SEEN_BETTER = 1.2  # -, over what is seen of the wear from OBLIQUE, before another direction is taken
FROM_THE_CUT = (1.0, -0.25, 0.32)  # from the side on which the bed is cut away
MARGIN = 1.03  # -, room round what is shown
SPHERE_SIDES = 10  # of a particle's sphere: round enough at a few pixels
HATCH_LINES = 40  # across a surface's box
HATCH_NORMAL = np.array([1.0, 1.0, 1.0]) / np.sqrt(3.0)  # of the planes that cut hatching: along no edge of a sample
WHITE = 255  # of a pixel's background
STEEL = "#9aa0a6"


def load_pyvista():
    """Return pyvista, told to render in software where nobody asked for anything else."""
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkOSOpenGLRenderWindow")
    import pyvista  # slow to import, and only after the line above

    return pyvista


def new_plotter(size: tuple[int, int]):
    plotter = load_pyvista().Plotter(off_screen=True, window_size=size, lighting="light kit")
    plotter.set_background("white")
    plotter.enable_parallel_projection()
    return plotter


def _poly(points: np.ndarray, triangles: np.ndarray):
    """Return a surface in mm; nodes without a triangle are kept."""
    return load_pyvista().PolyData.from_regular_faces(points * MILLIMETRES, triangles)


def _outline(mesh: SurfaceMesh):
    """Return the edge of the sample, where the skirt begins, as lines in mm."""
    edges = boundary_edges(mesh.triangles[worn_faces(mesh)])
    lines = np.column_stack([np.full(len(edges), 2), edges])
    return load_pyvista().PolyData(mesh.points * MILLIMETRES, lines=lines.ravel())


def _hatching(mesh: SurfaceMesh, faces: np.ndarray):
    """Return lines (mm) across some faces (m,), where parallel planes cut them; nothing where none does."""
    surface, along = _poly(mesh.points, mesh.triangles[faces]), mesh.points * MILLIMETRES @ HATCH_NORMAL
    levels = np.linspace(along.min(), along.max(), HATCH_LINES + 2)[1:-1]
    return surface.contour(levels, scalars=along)


def add_sample(plotter, mesh: SurfaceMesh, depth: np.ndarray, limits: tuple[float, float], deformed: bool) -> None:
    """Add a worn surface: faces that wear by depth (m; colours in um), skirt grey, edge of the sample black.

    deformed: hatch where caps on a step hold wear back, see `tables.depths.held_back_faces`.
    """
    worn = worn_faces(mesh)
    surface = _poly(mesh.points, mesh.triangles[worn])
    surface.cell_data["depth"] = depth[worn] * MICROMETRES
    plotter.add_mesh(surface, scalars="depth", cmap=MAP, clim=limits, show_scalar_bar=False, **_matt())
    if not worn.all():
        plotter.add_mesh(_poly(mesh.points, mesh.triangles[~worn]), color=SKIRT_COLOUR, **_matt())
    plotter.add_mesh(_outline(mesh), color="black", line_width=1.5)
    held = held_back_faces(mesh) if deformed else np.zeros(len(mesh.triangles), dtype=bool)
    if held.any() and (lines := _hatching(mesh, held)).n_points:
        plotter.add_mesh(lines, color="black", line_width=2.0, render_lines_as_tubes=True, lighting=False)


def _matt() -> dict[str, float]:
    """Little shading, so that colours can be read off."""
    return {"ambient": 0.45, "diffuse": 0.55, "specular": 0.0}


def _look(plotter, direction: Direction, bounds: np.ndarray) -> None:
    """Look from a direction, z up, at a box with these bounds (3, 2) in mm, as large as the window takes."""
    centre = bounds.mean(axis=1)
    corners = np.stack(np.meshgrid(*bounds), axis=-1).reshape(-1, 3) - centre
    up = np.array([0.0, 0.0, 1.0])
    towards = np.array(direction) / np.linalg.norm(direction)
    right = np.cross(up, towards)
    right /= np.linalg.norm(right)
    half_height = np.abs(corners @ np.cross(towards, right)).max()
    half_width = np.abs(corners @ right).max()
    width, height = plotter.window_size
    far = 10.0 * np.linalg.norm(corners, axis=1).max()
    plotter.camera_position = [centre + far * towards, centre, up]
    plotter.camera.parallel_scale = MARGIN * max(half_height, half_width * height / width)
    plotter.renderer.ResetCameraClippingRange()


def pixels_of(plotter) -> np.ndarray:
    """Return the pixels (h, w, 3) of what a plotter shows, and close it."""
    pixels = np.array(plotter.screenshot(return_img=True))
    plotter.close()
    return pixels[..., :3]


def common_bounds(meshes: Iterable[SurfaceMesh]) -> np.ndarray:
    """Return the bounds (3, 2) in mm of several surfaces together: pictures of equal scale need them."""
    points = [mesh.points for mesh in meshes]
    low, high = (
        np.min([each.min(axis=0) for each in points], axis=0),
        np.max([each.max(axis=0) for each in points], axis=0),
    )
    return np.stack([low, high], axis=1) * MILLIMETRES


def surface_oblique(
    mesh: SurfaceMesh,
    deformed: bool,
    limits: tuple[float, float],
    bounds: np.ndarray,
    size: tuple[int, int] = (1300, 720),
    direction: Direction = OBLIQUE,
) -> np.ndarray:
    """Return pixels (h, w, 3) of a worn surface seen obliquely.

    limits: um, see `tables.depths.face_depth`; bounds: (3, 2) mm, what the picture takes in; direction: to the eye
    """
    return depth_oblique(mesh, face_depth(mesh, deformed), limits, bounds, size, direction, deformed)


def worn_side(meshes: Iterable[SurfaceMesh], deformed: bool) -> Direction:
    """Return the oblique direction from which most of the wear is seen: OBLIQUE, unless another one shows far more.

    What hides behind other faces counts as seen.
    """
    return _best_side([(mesh, np.nan_to_num(face_depth(mesh, deformed))) for mesh in meshes])


def facing_side(mesh: SurfaceMesh, depth: np.ndarray) -> Direction:
    """Return the direction of `worn_side` for any depth (m,) of the triangles of a surface."""
    return _best_side([(mesh, depth)])


def _best_side(worn: Iterable[tuple[SurfaceMesh, np.ndarray]]) -> Direction:
    seen = dict.fromkeys((OBLIQUE, *OTHER_OBLIQUE), 0.0)
    for mesh, depth in worn:
        lost = depth[:, None] * area_vectors(mesh.points, mesh.triangles)
        for direction in seen:
            seen[direction] += float(np.maximum(lost @ np.array(direction), 0.0).sum())
    best = max(seen, key=seen.__getitem__)
    return best if seen[best] > SEEN_BETTER * seen[OBLIQUE] else OBLIQUE


def depth_oblique(
    mesh: SurfaceMesh,
    depth: np.ndarray,
    limits: tuple[float, float],
    bounds: np.ndarray,
    size: tuple[int, int] = (1300, 720),
    direction: Direction = OBLIQUE,
    deformed: bool = False,
) -> np.ndarray:
    """Return pixels (h, w, 3) of a surface seen obliquely, coloured by any depth (m,) m of its triangles.

    limits: um; bounds: (3, 2) mm, what the picture takes in. Triangles without a depth (NaN) are grey.
    deformed: the surface carries wear that is not in its shape, which is hatched.
    """
    plotter = new_plotter(size)
    add_sample(plotter, mesh, depth, limits, deformed)
    _look(plotter, direction, bounds)
    return pixels_of(plotter)


def surface_plan(
    mesh: SurfaceMesh, deformed: bool, limits: tuple[float, float], longest: int = 900, skirt: bool = True
) -> tuple[np.ndarray, tuple[float, float, float, float]]:
    """Return pixels (h, w, 3) of a worn surface from above, and what they cover: x and y from, to (mm).

    longest: pixels; skirt: False cuts the picture at the edge of the sample.
    """
    shown = mesh.points if skirt else mesh.points[np.unique(mesh.triangles[worn_faces(mesh)])]
    low, high = shown[:, :2].min(axis=0) * MILLIMETRES, shown[:, :2].max(axis=0) * MILLIMETRES
    width, height = np.maximum(np.round((high - low) * longest / (high - low).max()), 1).astype(int)
    plotter = new_plotter((int(width), int(height)))
    add_sample(plotter, mesh, face_depth(mesh, deformed), limits, deformed)
    middle, top = (low + high) / 2.0, float(mesh.points[:, 2].max()) * MILLIMETRES
    far = float((high - low).max())
    plotter.camera_position = [(*middle, top + far), (*middle, top), (0.0, 1.0, 0.0)]
    plotter.camera.parallel_scale = (high - low)[1] / 2.0
    plotter.renderer.ResetCameraClippingRange()
    return pixels_of(plotter), (low[0], high[0], low[1], high[1])


def bed_bounds(cuts: Iterable[pd.DataFrame], meshes: Iterable[SurfaceMesh]) -> np.ndarray:
    """Return the bounds (3, 2) in mm of several beds and their samples together."""
    places = [cut[["x_m", "y_m", "z_m"]].to_numpy() * MILLIMETRES for cut in cuts]
    corners = np.concatenate([common_bounds(meshes).T, *places])
    return np.stack([corners.min(axis=0), corners.max(axis=0)], axis=1)


def bed_picture(
    particles: pd.DataFrame,
    mesh: SurfaceMesh,
    limits: tuple[float, float],
    bounds: np.ndarray,
    size: tuple[int, int] = (1600, 600),
) -> np.ndarray:
    """Return pixels (h, w, 3) of particles (colour: speed within limits, m/s) with the sample that they slide over.

    particles: as from `flow.bed`, already cut; bounds: (3, 2) mm, what the picture takes in.
    """
    cloud = load_pyvista().PolyData(particles[["x_m", "y_m", "z_m"]].to_numpy() * MILLIMETRES)
    cloud["diameter"] = particles["radius_m"].to_numpy() * 2.0 * MILLIMETRES
    cloud["speed"] = particles["speed_m_per_s"].to_numpy()
    ball = load_pyvista().Sphere(radius=0.5, theta_resolution=SPHERE_SIDES, phi_resolution=SPHERE_SIDES)
    spheres = cloud.glyph(scale="diameter", orient=False, geom=ball)
    plotter = new_plotter(size)
    plotter.add_mesh(
        spheres, scalars="speed", cmap=MAP, clim=limits, show_scalar_bar=False, smooth_shading=True, **_matt()
    )
    plotter.add_mesh(_poly(mesh.points, mesh.triangles), color=STEEL, ambient=0.35, diffuse=0.65)
    plotter.add_mesh(_outline(mesh), color="black", line_width=1.5)
    _look(plotter, FROM_THE_CUT, bounds)
    return pixels_of(plotter)


def trimmed(pictures: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Return pictures (h, w, 3) of equal size without the white margins that all of them have."""
    drawn = np.any([(pixels < WHITE).any(axis=2) for pixels in pictures], axis=0)
    if not drawn.any():
        return list(pictures)
    lines, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    inside = slice(lines[0], lines[-1] + 1), slice(columns[0], columns[-1] + 1)
    return [pixels[inside] for pixels in pictures]
