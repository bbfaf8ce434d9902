"""Views of parts: from where most of their wear is seen, and pictures of them from there, true to scale.

A part is looked at alone, in its own frame, by parallel light: lengths across the view are true. Which face hides which
is found by drawing each face in a colour of its own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.colors import Colormap

from bulkwear.postproc.mesh import SurfaceMesh, area_vectors, areas, sum_over_nodes
from bulkwear.postproc.plots.scene import load_pyvista, new_plotter, pixels_of
from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.workflows.cases.equipment.plane_cuts import long_directions

UP = np.array([0.0, 0.0, 1.0])
UPRIGHT = 0.97  # -, cosine to the vertical: a view as steep has y up instead
SEARCH_SIZE = (240, 240)  # pixels of the pictures that views are compared by
THIN, NEARLY = 0.35, 0.8  # -, thickness over width of a plate; cosine of its normal to the mean normal of its wear
ALONG_NORMAL = 0.7  # -, of the wear, or of what the best view shows of it, that the worn side must show to be chosen
SEEN = 0.3  # -, of its area that a face must show in a view to count as seen there
SECOND_VIEW = 0.45  # -, of the wear not seen in the first view for which there is a second one
LONGEST = 1000  # pixels of a picture
FULL_SIZE = 4.0  # pictures on a page up to which each has as many
MARGIN = 1.04  # -, room round what is shown
AMBIENT = 0.775  # -, of the light: with what falls square on a face colours are those of the scale
FEATURE_DEG = 30.0  # between two faces whose edge is drawn
NO_VALUE = "#d9d9d9"  # faces without a value
RIGID, RIGID_OPACITY = "#8a8f96", 0.16
OBLIQUE_SINE = (0.2, 0.75)  # -, sine of the elevation of a view of the whole machine, least and most


@dataclass(frozen=True, eq=False)
class View:
    """A view by parallel light.

    towards: (3,) unit vector to the eye; up: (3,) unit vector across it; centre: (3,) m
    width, height: m across; depth: m of what is seen; share: -, of a page that its picture has
    """

    towards: np.ndarray
    up: np.ndarray
    centre: np.ndarray
    width: float
    height: float
    depth: float
    share: float = 1.0

    @property
    def right(self) -> np.ndarray:
        """Return the unit vector to the right, (3,)."""
        return np.cross(self.up, self.towards)

    @property
    def size(self) -> tuple[int, int]:
        """Return the pixels of its picture, across and upwards."""
        longest = LONGEST * min(math.sqrt(FULL_SIZE * self.share), 1.0) / max(self.width, self.height)
        return max(round(longest * self.width), 2), max(round(longest * self.height), 2)

    @property
    def extent_mm(self) -> tuple[float, float, float, float]:
        """Return what its picture covers, from left, to right, from below, to above, about its centre."""
        half = 0.5 * MILLIMETRES * np.array([self.width, self.height])
        return -half[0], half[0], -half[1], half[1]

    def places_mm(self, points: np.ndarray) -> np.ndarray:
        """Return where points (n, 3) m are seen, (n, 2) mm to the right of and above the centre."""
        from_centre = np.reshape(points, (-1, 3)) - self.centre
        return MILLIMETRES * np.column_stack([from_centre @ self.right, from_centre @ self.up])


def view_of(points: np.ndarray, towards: np.ndarray, up: np.ndarray | None = None) -> View:
    """Return the view from a direction (3,) that takes in points (n, 3) m.

    up: (3,) of the picture, by default against gravity, or y where that is towards the eye
    """
    towards = np.asarray(towards, dtype=float) / np.linalg.norm(towards)
    if up is None:
        up = UP if abs(towards @ UP) < UPRIGHT else np.array([0.0, 1.0, 0.0])
    up = up - (up @ towards) * towards
    up /= np.linalg.norm(up)
    across = np.column_stack([points @ np.cross(up, towards), points @ up, points @ towards])
    low, high = across.min(axis=0), across.max(axis=0)
    middle = 0.5 * (low + high)
    centre = middle[0] * np.cross(up, towards) + middle[1] * up + middle[2] * towards
    width, height = MARGIN * np.maximum(high - low, 1e-3 * np.max(high - low))[:2]
    return View(towards, up, centre, float(width), float(height), float(high[2] - low[2]))


def widened(view: View, aspect: float) -> View:
    """Return a view with more room at two sides, so that it is `aspect` times as wide as high."""
    if view.width < aspect * view.height:
        return replace(view, width=aspect * view.height)
    return replace(view, height=view.width / aspect)


def directions(oblique: bool = False) -> np.ndarray:
    """Return directions (k, 3) evenly over the sphere; oblique: those that look down on a machine from the side."""
    count, golden = 60, np.pi * (3.0 - np.sqrt(5.0))
    z = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    across, turn = np.sqrt(1.0 - z * z), golden * np.arange(count)
    found = np.column_stack([across * np.cos(turn), across * np.sin(turn), z])
    if oblique:
        return found[(z > OBLIQUE_SINE[0]) & (z < OBLIQUE_SINE[1])]
    return np.concatenate([np.eye(3), -np.eye(3), found])


def mean_normal(mesh: SurfaceMesh, weight: np.ndarray) -> np.ndarray | None:
    """Return the mean outward normal (3,) of what wears, by weight (m,) times area; None where it cancels out."""
    total = np.nan_to_num(weight) @ area_vectors(mesh.points, mesh.triangles)
    length = np.linalg.norm(total)
    most = np.nan_to_num(weight) @ areas(mesh.points, mesh.triangles)
    return total / length if most > 0.0 and length > 0.2 * most else None


def worn_side(mesh: SurfaceMesh, weight: np.ndarray) -> np.ndarray | None:
    """Return the mean normal (3,) of what wears, or that of a plate which looks nearly so, as its map is true then."""
    normal = mean_normal(mesh, weight)
    if normal is None:
        return None
    across = long_directions(mesh)
    extents = np.ptp(mesh.points @ across.T, axis=0)
    flat = across[2] * np.sign(across[2] @ normal)
    return flat if extents[2] < THIN * extents[1] and flat @ normal > NEARLY else normal


def best_views(mesh: SurfaceMesh, weight: np.ndarray, most: int = 2) -> list[np.ndarray]:
    """Return the directions (3,), one or `most`, from which the wear of a part is seen best.

    weight: (m,) of each face, such as its recession. The first direction is that of the worn side where nearly as much
    is seen along it as from anywhere, a further one looks at what is hidden in those before.
    """
    weight = np.nan_to_num(np.asarray(weight, dtype=float))
    if not weight.any():
        weight = np.ones(len(mesh.triangles))
    normal, area = worn_side(mesh, weight), areas(mesh.points, mesh.triangles)
    tried = directions() if normal is None else normal[None]
    seen, total = seen_areas(mesh, tried), weight @ area
    if normal is not None and seen[0] @ weight > ALONG_NORMAL * total:
        return [normal]  # no view shows much more
    if normal is not None:
        tried = np.concatenate([tried, directions()])
        seen = np.concatenate([seen, seen_areas(mesh, directions())])
    chosen, left = [], weight.copy()
    while len(chosen) < most and (not chosen or left @ area > SECOND_VIEW * total):
        score = seen @ left
        best = int(score.argmax())
        if not chosen and normal is not None and score[0] > ALONG_NORMAL * score[best]:
            best = 0
        chosen.append(tried[best])
        left = np.where(seen[best] > SEEN * area, 0.0, left)
    return chosen


def best_oblique(mesh: SurfaceMesh, weight: np.ndarray) -> np.ndarray:
    """Return the direction (3,), from the side and above, from which most of the wear of a machine is seen."""
    tried = directions(oblique=True)
    weight = np.nan_to_num(np.asarray(weight, dtype=float))
    return tried[int((seen_areas(mesh, tried) @ (weight if weight.any() else np.ones_like(weight))).argmax())]


def seen_areas(mesh: SurfaceMesh, towards: np.ndarray) -> np.ndarray:
    """Return the area (k, m) m2 that each face shows in views from directions (k, 3), behind no other face."""
    pyvista = load_pyvista()
    surface = pyvista.PolyData.from_regular_faces(mesh.points, mesh.triangles)
    number = np.arange(1, len(mesh.triangles) + 1)
    surface.cell_data["own"] = np.column_stack([number >> 16, number >> 8 & 255, number & 255]).astype(np.uint8)
    plotter = new_plotter(SEARCH_SIZE)
    plotter.set_background("black")
    plotter.add_mesh(surface, scalars="own", rgb=True, lighting=False, show_scalar_bar=False)
    found = np.zeros((len(towards), len(mesh.triangles)))
    front = area_vectors(mesh.points, mesh.triangles)
    for k, direction in enumerate(towards):
        view = widened(view_of(mesh.points, direction), 1.0)
        _look(plotter, view)
        pixels = np.asarray(plotter.screenshot(return_img=True))[..., :3].astype(np.int64)
        faces = (pixels[..., 0] << 16) + (pixels[..., 1] << 8) + pixels[..., 2]
        counts = np.bincount(faces.ravel(), minlength=len(number) + 1)[1 : len(number) + 1]
        found[k] = counts * view.width * view.height / np.prod(SEARCH_SIZE) * (front @ view.towards > 0.0)
    plotter.close()
    return found


def part_picture(
    mesh: SurfaceMesh,
    values: np.ndarray,
    limits: tuple[float, float],
    colours: str | Colormap,
    view: View,
    behind: Sequence[SurfaceMesh] = (),
) -> np.ndarray:
    """Return pixels (h, w, 3) of a part coloured by values (m,) of its faces between limits; NaN: grey.

    Colours run from face to face, but not over sharp edges.

    behind: rigid surfaces, drawn transparent
    """
    plotter = new_plotter(view.size)
    look = {"ambient": AMBIENT, "diffuse": 0.3, "specular": 0.0}
    known = np.isfinite(values)
    if known.any():
        smooth, at_nodes = _at_nodes(mesh, values, known)
        scale = {"cmap": colours, "clim": limits, "interpolate_before_map": True}
        plotter.add_mesh(smooth, scalars=at_nodes, show_scalar_bar=False, **scale, **look)
    if not known.all():
        grey = load_pyvista().PolyData.from_regular_faces(mesh.points, mesh.triangles[~known])
        plotter.add_mesh(grey, color=NO_VALUE, **look)
    _edges(plotter, mesh, "black", 1.5)
    for rigid in behind:
        shape = load_pyvista().PolyData.from_regular_faces(rigid.points, rigid.triangles)
        plotter.add_mesh(shape, color=RIGID, opacity=RIGID_OPACITY, **look)
        _edges(plotter, rigid, RIGID, 1.0)
    _look(plotter, view)
    return pixels_of(plotter)


def _at_nodes(mesh: SurfaceMesh, values: np.ndarray, known: np.ndarray):
    """Return the faces that have a value, apart from each other at sharp edges, and the mean of the values at nodes."""
    surface = load_pyvista().PolyData.from_regular_faces(mesh.points, mesh.triangles[known])
    split = surface.compute_normals(
        cell_normals=False, split_vertices=True, feature_angle=FEATURE_DEG, consistent_normals=False
    )
    faces = split.regular_faces
    area = areas(np.asarray(split.points, dtype=float), faces)
    total = sum_over_nodes(faces, area * values[known], split.n_points)
    return split, total / np.maximum(sum_over_nodes(faces, area, split.n_points), np.finfo(float).tiny)


def _edges(plotter, mesh: SurfaceMesh, colour: str, width: float) -> None:
    """Draw the sharp edges and the rim of a surface."""
    surface = load_pyvista().PolyData.from_regular_faces(mesh.points, mesh.triangles)
    edges = surface.extract_feature_edges(FEATURE_DEG, manifold_edges=False, non_manifold_edges=False)
    if edges.n_cells:
        plotter.add_mesh(edges, color=colour, line_width=width, lighting=False)


def _look(plotter, view: View) -> None:
    far = 4.0 * max(view.width, view.height, view.depth)
    plotter.camera_position = [view.centre + far * view.towards, view.centre, view.up]
    plotter.camera.parallel_scale = 0.5 * view.height
    plotter.renderer.ResetCameraClippingRange()
    plotter.render()
