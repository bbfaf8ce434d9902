"""Triangulated surfaces: geometry as pure functions on arrays, and reading and writing of surfaces.

Arrays throughout: `points` (n, 3) float64 in m, `triangles` (m, 3) int64 node indices, anticlockwise seen
from outside. The order of the triangles is the order of the facets in an STL, hence the solver's triangle id.
"""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

HOLDER_PART = -1  # label `part` of the faces that do not wear
PLAIN = "plain"  # name of a sample's surface without a pattern; one with a pattern has the pattern's name
RIGHT_ANGLE = 1e-9  # -, cosine of an angle that counts as right
STL_FACETS_PER_BLOCK = 20_000  # facets formatted at once: bounds the memory of a write
_FACET = "  facet normal %.9g %.9g %.9g\n    outer loop\n" + "      vertex %s\n" * 3 + "    endloop\n  endfacet\n"


@dataclass(frozen=True, eq=False)
class SurfaceMesh:
    """A triangulated surface with data on its triangles and nodes.

    points: (n, 3) m; triangles: (m, 3) node indices; cell_data: name -> (m,) or (m, 3); point_data: name ->
    (n,) or (n, 3). Raises ValueError when shapes or indices do not fit together.
    """

    points: np.ndarray
    triangles: np.ndarray
    cell_data: dict[str, np.ndarray] = field(default_factory=dict)
    point_data: dict[str, np.ndarray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", np.ascontiguousarray(self.points, dtype=np.float64))
        object.__setattr__(self, "triangles", np.ascontiguousarray(self.triangles, dtype=np.int64))
        for name, array in (("points", self.points), ("triangles", self.triangles)):
            if array.ndim != 2 or array.shape[1] != 3:
                raise ValueError(f"{name} of a surface must have the shape (count, 3), found {array.shape}")
        if self.triangles.size and not 0 <= self.triangles.min() <= self.triangles.max() < len(self.points):
            raise ValueError(
                f"triangles name nodes {self.triangles.min()} to {self.triangles.max()}, "
                f"allowed are 0 to {len(self.points) - 1}"
            )
        for data, count in ((self.cell_data, len(self.triangles)), (self.point_data, len(self.points))):
            for name, array in data.items():
                if len(array) != count:
                    raise ValueError(f"data '{name}' must have {count} entries, found {len(array)}")


def worn_faces(mesh: SurfaceMesh) -> np.ndarray:
    """Mask (m,) of the faces that wear: `part` >= 0; all faces where the mesh has no `part`."""
    part = mesh.cell_data.get("part", np.zeros(len(mesh.triangles), dtype=np.int64))
    return np.asarray(part) > HOLDER_PART


def _corners(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Coordinates (3, 3, m) m by axis, corner and triangle: arithmetic on whole columns is the fastest."""
    return np.take(np.asarray(points).T, triangles.T, axis=1)


def _cross(first: np.ndarray, second: np.ndarray) -> list[np.ndarray]:
    """Cross products of vectors (3, m), three columns (m,)."""
    return [first[i] * second[j] - first[j] * second[i] for i, j in ((1, 2), (2, 0), (0, 1))]


def _length(columns) -> np.ndarray:
    """Lengths (m,) of vectors given as three columns (m,)."""
    x, y, z = columns
    return np.sqrt(x * x + y * y + z * z)


def area_vectors(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Outward normal times area of each triangle, (m, 3) m2."""
    corners = _corners(points, triangles)
    return 0.5 * np.stack(_cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)


def areas(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Area of each triangle, (m,) m2."""
    return _length(area_vectors(points, triangles).T)


def unit_normals(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Outward unit normal of each triangle, (m, 3); NaN where a triangle has no area."""
    vectors = area_vectors(points, triangles)
    lengths = _length(vectors.T)[:, None]
    return np.divide(vectors, lengths, out=np.full_like(vectors, np.nan), where=lengths > 0)


def centroids(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Centroid of each triangle, (m, 3) m."""
    first, second, third = (points[triangles[:, k]] for k in range(3))
    return (first + second + third) / 3.0


def edge_lengths_per_triangle(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Lengths of the edges 0-1, 1-2 and 2-0 of each triangle, (m, 3) m."""
    corners = _corners(points, triangles)
    return np.stack([_length(corners[:, (k + 1) % 3] - corners[:, k]) for k in range(3)], axis=1)


def smallest_angles(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Smallest interior angle of each triangle, (m,) degrees; 0 where a triangle has no area."""
    corners, least = _corners(points, triangles), np.full(len(triangles), np.inf)
    for k in range(3):
        forward, backward = (corners[:, (k + step) % 3] - corners[:, k] for step in (1, 2))
        sine = _length(_cross(forward, backward))  # atan2 stays exact for slivers, arccos does not
        product = forward * backward
        np.minimum(least, np.degrees(np.arctan2(sine, product[0] + product[1] + product[2])), out=least)
    return least


def shortest_edge_at_nodes(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Length of the shortest edge that meets each node, (n,) m; infinite at a node of no triangle."""
    lengths = edge_lengths_per_triangle(points, triangles)
    shortest = np.full(len(points), np.inf)
    np.minimum.at(shortest, triangles, lengths)
    np.minimum.at(shortest, np.roll(triangles, -1, axis=1), lengths)
    return shortest


def directed_edges(triangles: np.ndarray) -> np.ndarray:
    """Edges 0-1, 1-2 and 2-0 of each triangle as its nodes run round it, (3 m, 2), triangle by triangle."""
    return np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)


def _edge_keys(edges: np.ndarray) -> np.ndarray:
    """One int64 per directed edge, unique for its ordered pair of nodes."""
    return edges[:, 0] * (edges.max(initial=0) + 1) + edges[:, 1]


def boundary_edges(triangles: np.ndarray) -> np.ndarray:
    """Edges with a triangle on one side only, (k, 2) node indices, directed as in that triangle."""
    edges = directed_edges(triangles)
    start, end = np.ascontiguousarray(edges.T)
    base = edges.max(initial=0) + 1
    keys = 2 * (np.minimum(start, end) * base + np.maximum(start, end)) + (start < end)
    single = _one_way(np.sort(keys))  # as numbers, for they sort several times faster than places
    mask = np.zeros(base, dtype=bool)
    mask[single // base] = mask[single % base] = True
    near = np.flatnonzero(mask[start] & mask[end] & (start != end))  # few are left to be looked up
    return edges[near[np.isin(keys[near] // 2, single)]]


def _one_way(keys: np.ndarray) -> np.ndarray:
    """Halves (k,) of sorted integers (m,) that occur as 2 q or as 2 q + 1, but not as both."""
    half = keys[np.diff(keys, prepend=-1) > 0] // 2
    same = half[1:] == half[:-1]
    paired = np.zeros(len(half), dtype=bool)
    paired[1:][same] = paired[:-1][same] = True
    return half[~paired]


def boundary_nodes(triangles: np.ndarray) -> np.ndarray:
    """Sorted indices of the nodes on the boundary, (k,)."""
    return np.unique(boundary_edges(triangles))


def nonmanifold_edges(triangles: np.ndarray) -> np.ndarray:
    """Edges that two triangles run through in the same sense, (k, 2) node indices, lower index first.

    On an oriented manifold every directed edge occurs once. An edge of three or more triangles must repeat a
    direction, and so does an edge between two triangles of opposite orientation: both are found.
    """
    edges = directed_edges(triangles)
    _, inverse, counts = np.unique(_edge_keys(edges), return_inverse=True, return_counts=True)
    return np.unique(np.sort(edges[counts[inverse] > 1], axis=1), axis=0)


def sum_over_nodes(triangles: np.ndarray, per_triangle: np.ndarray, n_points: int) -> np.ndarray:
    """Sum at each node of a scalar (m,) or vector (m, 3) of the triangles round it: (n,) or (n, 3)."""
    nodes = triangles.T.ravel()
    width = math.prod(np.shape(per_triangle)[1:])  # -1 would not do where there are no triangles
    columns = np.reshape(per_triangle, (len(triangles), width)).T
    sums = [np.bincount(nodes, weights=np.tile(column, 3), minlength=n_points) for column in columns]
    whole = np.stack(sums, axis=-1).astype(np.float64, copy=False)  # of nothing numpy counts in whole numbers
    return whole.reshape((n_points, *np.shape(per_triangle)[1:]))


def node_areas(mesh: SurfaceMesh) -> np.ndarray:
    """Area of each node, (n,) m2: a third of its triangles'."""
    return sum_over_nodes(mesh.triangles, areas(mesh.points, mesh.triangles), len(mesh.points)) / 3.0


def node_area_vectors(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """A third of the area vectors of the triangles round each node, summed, (n, 3) m2: gradient of volume."""
    return sum_over_nodes(triangles, area_vectors(points, triangles) / 3.0, len(points))


def enclosed_volume(points: np.ndarray, triangles: np.ndarray) -> float:
    """Volume inside a closed surface, m3, by the divergence theorem. Raises ValueError when it is open."""
    open_edges = len(boundary_edges(triangles))
    if open_edges:
        raise ValueError(f"the volume needs a closed surface, found {open_edges} boundary edges, allowed are 0")
    corners = points[triangles] - points.mean(axis=0)  # an origin within the body keeps the terms small
    return float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0)


def volume_above_plane(points: np.ndarray, triangles: np.ndarray, z: float = 0.0) -> float:
    """Signed volume between a surface and the horizontal plane at height `z` (m) below it, m3."""
    heights = points[triangles][:, :, 2].mean(axis=1) - z
    return float(heights @ area_vectors(points, triangles)[:, 2])


def _write_atomically(path: str | os.PathLike, write: Callable[[Path], None]) -> None:
    """Let `write` fill a temporary file beside `path`, then rename it: `path` is never half written."""
    path = Path(path)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}.", suffix=path.suffix)
    os.close(handle)
    try:
        write(Path(name))
        os.chmod(name, 0o644)  # mkstemp makes private files
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def write_surface(path: str | os.PathLike, mesh: SurfaceMesh) -> None:
    """Write points, triangles and all data to a `.vtu`, binary float64 and int64: nothing is rounded."""
    import meshio  # slow to import, needed at the edge only

    if Path(path).suffix != ".vtu":
        raise ValueError(f"{path}: a surface is written as .vtu, found '{Path(path).suffix}'")
    cell_data = {name: [np.ascontiguousarray(array)] for name, array in mesh.cell_data.items()}
    content = meshio.Mesh(mesh.points, [("triangle", mesh.triangles)], dict(mesh.point_data), cell_data)
    _write_atomically(path, lambda name: content.write(name, file_format="vtu"))


def read_surface(path: str | os.PathLike) -> SurfaceMesh:
    """Read a `.vtu` of triangles. Raises FileNotFoundError, or ValueError when broken or of other cells."""
    import meshio

    if not Path(path).is_file():
        raise FileNotFoundError(f"{path}: no such surface file")
    try:
        content = meshio.read(path, file_format="vtu")
    except (SystemExit, Exception) as error:  # meshio leaves by sys.exit on some broken files
        raise ValueError(f"{path}: not a readable .vtu surface ({error})") from error
    others = sorted({block.type for block in content.cells} - {"triangle"})
    if others or not content.cells:
        raise ValueError(f"{path}: cells must be triangles, found {', '.join(others) or 'none'}")
    triangles = np.concatenate([block.data for block in content.cells])
    cell_data = {name: np.concatenate(blocks) for name, blocks in content.cell_data.items()}
    return SurfaceMesh(content.points, triangles, cell_data, dict(content.point_data))


def obtuse_last(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Triangles (m, 3) turned so that an obtuse corner is their last one; normals and order stay.

    LIGGGHTS (3.8, surface_mesh_I.h, calcObtuseAngleIndex) forgets an obtuse first or second corner. A sphere beside it
    then has no contact with the edges that meet there: at a sharp edge it sinks in and is shot out a little further on.
    """
    corners = points[triangles]
    edge = np.roll(corners, -1, axis=1) - corners
    edge /= np.linalg.norm(edge, axis=-1, keepdims=True)
    cosine = -np.einsum("mij,mij->mi", edge, np.roll(edge, 1, axis=1))
    first = np.where(cosine.min(axis=1) < -RIGHT_ANGLE, np.argmin(cosine, axis=1) + 1, 0)
    return np.take_along_axis(np.asarray(triangles), (np.arange(3) + first[:, None]) % 3, axis=1)


def stl_corners(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Corners (m, 3, 3) m of the facets that `write_stl` writes, in the solver's order."""
    return np.asarray(points)[obtuse_last(points, triangles)]


def _vertex_lines(points: np.ndarray) -> np.ndarray:
    """Coordinates (n, 3) m as words, (n,): every node is a corner of some six facets, and written once here."""
    lines = []
    for start in range(0, len(points), STL_FACETS_PER_BLOCK):
        block = np.asarray(points)[start : start + STL_FACETS_PER_BLOCK]
        lines += (("%.9g %.9g %.9g\n" * len(block)) % tuple(block.ravel().tolist())).splitlines()
    return np.array(lines, dtype=object)


def write_stl(path: str | os.PathLike, points: np.ndarray, triangles: np.ndarray) -> None:
    """Write an ASCII STL with nine significant digits, facets in the order of the triangles, obtuse corners last.

    Raises ValueError when a facet has no area: the solver would drop it, and every later id would shift.
    """
    normals = unit_normals(points, triangles)
    faulty = np.flatnonzero(~np.isfinite(normals).all(axis=1))
    if faulty.size:
        raise ValueError(f"{path}: facet {faulty[0]} has no area; {faulty.size} such facets found, allowed are 0")
    corners, nodes = obtuse_last(points, triangles), _vertex_lines(points)

    def write(name: Path) -> None:
        with open(name, "w", encoding="ascii") as file:
            file.write("solid surface\n")
            for start in range(0, len(corners), STL_FACETS_PER_BLOCK):
                block = slice(start, start + STL_FACETS_PER_BLOCK)
                words = np.empty((len(corners[block]), 6), dtype=object)
                words[:, :3], words[:, 3:] = normals[block], nodes[corners[block]]
                file.write((_FACET * len(words)) % tuple(words.ravel().tolist()))
            file.write("endsolid surface\n")

    _write_atomically(path, write)
