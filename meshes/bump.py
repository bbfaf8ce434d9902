"""The shell of one bump: the upper half of an ellipsoid, which stands upright at its foot."""

from __future__ import annotations

import math

import numpy as np

from bulkwear.meshes.gmsh_model import gmsh_model
from bulkwear.meshes.relax import relax
from bulkwear.meshes.shell import SWEEPS, Shell, foot_nodes
from bulkwear.postproc.mesh import volume_above_plane


def bump_shell(half_width: float, half_length: float, height: float, element_size: float) -> Shell:
    """Mesh the semi-ellipsoid x2/half_width2 + y2/half_length2 + z2/height2 = 1, z >= 0; all arguments in m.

    Returns points (p, 3) m on the ellipsoid, triangles (t, 3) with outward normals, and the number f of foot
    nodes: the first f points are `foot_nodes` at z = 0.
    """
    foot = foot_nodes(half_width, half_length, element_size)
    semi_axes = np.array([half_width, half_length, height])
    points, triangles = _gmsh_shell(semi_axes, len(foot), element_size)
    points, triangles = _foot_first(points, triangles, semi_axes, foot)
    fixed = np.arange(len(points)) < len(foot)
    points, triangles = relax(points, triangles, fixed, lambda at: _on_ellipsoid(at, semi_axes), SWEEPS)
    return points, triangles, len(foot)


def _on_ellipsoid(points: np.ndarray, semi_axes: np.ndarray) -> np.ndarray:
    """Points near the ellipsoid moved on to it: two Newton steps along its gradient, the rest by scaling."""
    for _ in range(2):
        gradient = points / semi_axes**2
        value = (points * gradient).sum(axis=1, keepdims=True) - 1.0
        points = points - value * gradient / (2.0 * (gradient**2).sum(axis=1, keepdims=True))
    return points / np.linalg.norm(points / semi_axes, axis=1, keepdims=True)


def _gmsh_shell(semi_axes: np.ndarray, feet: int, element_size: float) -> tuple[np.ndarray, np.ndarray]:
    """A first triangulation from gmsh, `feet` edges round the foot: points (p, 3) m, triangles (t, 3)."""
    with gmsh_model() as gmsh:
        occ, scale = gmsh.model.occ, float(semi_axes.max())
        half_ball = occ.addSphere(0, 0, 0, 1, angle1=0, angle2=math.pi / 2)
        occ.dilate([(3, half_ball)], 0, 0, 0, *(semi_axes / scale).tolist())
        occ.synchronize()
        faces = gmsh.model.getEntities(2)
        flat = [face for face in faces if gmsh.model.getBoundingBox(*face)[5] < semi_axes[2] / scale / 2]
        curves = [abs(tag) for _, tag in gmsh.model.getBoundary(flat)]
        occ.remove([(3, half_ball)])
        occ.remove(flat)
        occ.synchronize()
        for curve in curves:
            gmsh.model.mesh.setTransfiniteCurve(curve, feet // len(curves) + 1)
        gmsh.option.setNumber("Mesh.MeshSizeMax", element_size / scale)
        gmsh.model.mesh.generate(2)
        tags, points, _ = gmsh.model.mesh.getNodes()
        _, cells = gmsh.model.mesh.getElementsByType(2)
    index = np.empty(int(tags.max()) + 1, dtype=np.int64)
    index[tags] = np.arange(len(tags))
    used, triangles = np.unique(index[cells], return_inverse=True)
    return points.reshape(-1, 3)[used] * scale, triangles.reshape(-1, 3)


def _foot_first(
    points: np.ndarray, triangles: np.ndarray, semi_axes: np.ndarray, foot: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Renumber so that the foot comes first, at the given nodes; turn the triangles outward."""
    on_foot = points[:, 2] < 1e-6 * semi_axes[2]
    if on_foot.sum() != len(foot):
        raise RuntimeError(f"the foot of a bump must have {len(foot)} nodes, found {on_foot.sum()}")
    angle = np.arctan2(points[:, 1] / semi_axes[1], points[:, 0] / semi_axes[0])
    turn = np.mod(angle + 1e-6, 2 * math.pi)  # the node on +x comes first, whatever its last digit
    order = np.concatenate([np.flatnonzero(on_foot)[np.argsort(turn[on_foot])], np.flatnonzero(~on_foot)])
    index = np.empty(len(points), dtype=np.int64)
    index[order] = np.arange(len(points))
    points, triangles = points[order], index[triangles]
    points = points / np.linalg.norm(points / semi_axes, axis=1, keepdims=True)
    points[: len(foot)] = np.column_stack([foot, np.zeros(len(foot))])
    if volume_above_plane(points, triangles) < 0:
        triangles = triangles[:, ::-1].copy()
    return points, triangles
