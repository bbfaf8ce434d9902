"""Make triangles as small as asked, on the very facets: edges are halved, and turned within flat regions.

Longest edges are halved first (`bisection`), across the borders of parts and of regions too, so no crack opens. In flat
regions Delaunay's criterion keeps angles large; slivers of CAD files vanish there. On curved facets nodes stay where
they are, and a facet between two creases keeps the angle that it has.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from bulkwear.meshes.own.bisection import refine_all, turn_all
from bulkwear.meshes.own.repairs import Repairs
from bulkwear.meshes.own.solids import MOST_TRIANGLES, Solids
from bulkwear.postproc.mesh import centroids, directed_edges, edge_lengths_per_triangle

LONGEST_OVER_TARGET = 1.5  # -, edges above it are halved: what is left has 0.75 to 1.5 targets
SHORTEST_OVER_TARGET = 0.25  # -, no edge is halved below it for an angle's sake
WANTED_ANGLE = 15.0  # degrees, as the smallest that remeshing allows a worn surface
EQUILATERAL = 0.25 * 3.0**0.5  # -, area over the square of the edge
MOST_ROUNDS = 30  # of asking for the targets of smaller and smaller triangles


@dataclass(frozen=True)
class Ball:
    """Where a surface shall be finer: within a distance `radius_m` of `centre_m` (x, y, z). edge_m: m, target there."""

    centre_m: tuple[float, float, float]
    radius_m: float
    edge_m: float

    def targets(self, places: np.ndarray, reach: np.ndarray) -> np.ndarray:
        """Target edge (m,) m of triangles at places (m, 3) m that reach so far (m,) m; infinite out of the ball."""
        outside = np.linalg.norm(places - self.centre_m, axis=1) > self.radius_m + reach
        return np.where(outside, np.inf, self.edge_m)


@dataclass(frozen=True)
class Box:
    """Where a surface shall be finer: between two corners (x, y, z) m. edge_m: m, target there."""

    low_m: tuple[float, float, float]
    high_m: tuple[float, float, float]
    edge_m: float

    def targets(self, places: np.ndarray, reach: np.ndarray) -> np.ndarray:
        """Target edge (m,) m of triangles at places (m, 3) m that reach so far (m,) m; infinite out of the box."""
        beside = np.maximum(np.maximum(np.subtract(self.low_m, places), np.subtract(places, self.high_m)), 0.0)
        return np.where(np.linalg.norm(beside, axis=1) > reach, np.inf, self.edge_m)


class NearPlaces:
    """Where a surface shall be finer: within `radius_m` of places, such as centroids of triangles that were worn."""

    def __init__(self, places_m: np.ndarray, radius_m: float, edge_m: float) -> None:
        self.tree, self.radius_m, self.edge_m = cKDTree(places_m), radius_m, edge_m

    def targets(self, places: np.ndarray, reach: np.ndarray) -> np.ndarray:
        """Target edge (m,) m of triangles at places (m, 3) m that reach so far (m,) m; infinite far from all places."""
        return np.where(self.tree.query(places)[0] > self.radius_m + reach, np.inf, self.edge_m)


Region = Ball | Box | NearPlaces | Callable[[np.ndarray], np.ndarray]  # the last: centroids (m, 3) m -> target (m,) m


def refined(
    solids: Solids, targets: np.ndarray, fine: Sequence[Region], flat: float, angle_deg: float, repairs: Repairs
) -> Solids:
    """Solids of parts with target edges, no edge longer than `LONGEST_OVER_TARGET` of its target.

    targets: (parts,) m, infinite: a part stays as it is, but for edges that it shares; fine: regions with smaller
    targets; a function of centroids sees triangles of the size that it asked for before; flat: m, how far the surface
    may move where edges are turned in flat regions; angle_deg: degrees, wanted smallest angle. The windings must be
    consistent. Raises ValueError where it takes more than `MOST_TRIANGLES`.
    """
    told = np.zeros((len(solids.names), 5))
    for number in range(MOST_ROUNDS):
        limit = LONGEST_OVER_TARGET * wanted_targets(solids, targets, fine if number else ())
        long = edge_lengths_per_triangle(solids.points, solids.triangles).max(axis=1) > limit
        if number > 1 and not long.any():
            break
        if np.isfinite(limit).any():
            solids = _one_round(solids, limit, flat, angle_deg, told)
        if not fine:
            break
    _tell_turns(told, repairs)
    return solids


def triangle_counts(area: np.ndarray, targets: np.ndarray) -> np.ndarray:
    """Return how many equilateral triangles with target edges (parts,) m make areas (parts,) m2."""
    return area / (EQUILATERAL * targets**2)


def check_count(source: str, names: Sequence[str], area: np.ndarray, targets: np.ndarray) -> None:
    """Raise ValueError where areas (parts,) m2 in equilateral triangles with target edges (parts,) m are too many."""
    counts = triangle_counts(area, targets)
    if counts.sum() > MOST_TRIANGLES:
        most = int(np.argmax(counts))
        least = np.sqrt(area[np.isfinite(targets)].sum() / (EQUILATERAL * MOST_TRIANGLES))
        raise ValueError(
            f"{source}: the target edges give about {counts.sum():.2g} triangles, most of them in part '{names[most]}' "
            f"with {targets[most]:g} m, allowed are {MOST_TRIANGLES}, which an edge of {least:.3g} m gives"
        )


def turned(solids: Solids, parts: np.ndarray, flat: float, repairs: Repairs) -> Solids:
    """Solids with the edges within flat regions of some parts turned until angles are as large as their nodes allow.

    parts: (parts,) bool; flat: m, as in `refined`
    """
    told = np.zeros((len(solids.names), 5))
    tri, part = solids.triangles.copy(), solids.part.astype(np.int64)
    limit = np.where(parts[part], np.finfo(float).max, np.inf)
    turn_all(solids.points, tri, across_edges(tri), part, limit, len(tri), flat, told)
    _tell_turns(told, repairs)
    return replace(solids, triangles=tri)


def _tell_turns(told: np.ndarray, repairs: Repairs) -> None:
    """Put the edges that were turned, counted in `told` (parts, 5), into the table."""
    for part in np.flatnonzero(told[:, 0]):
        count = int(told[part, 0])
        place = np.broadcast_to(told[part, 2:], (count, 3))
        repairs.add("edges turned in flat regions", np.full(count, part), place, told[part, 1])


def wanted_targets(solids: Solids, targets: np.ndarray, fine: Sequence[Region]) -> np.ndarray:
    """Target edge (m,) m of each triangle: its part's, or a region's where that is smaller."""
    result = targets[solids.part]
    places = centroids(solids.points, solids.triangles)
    reach = np.linalg.norm(solids.points[solids.triangles] - places[:, None], axis=2).max(axis=1)
    for region in fine:
        wanted = np.asarray(region(places) if callable(region) else region.targets(places, reach), dtype=np.float64)
        if wanted.shape != result.shape or not (wanted > 0.0).all():
            raise ValueError(
                f"a region gives target edges of shape {wanted.shape}, the smallest {wanted.min(initial=np.inf):g} m; "
                f"allowed are {len(result)} lengths above 0"
            )
        result = np.minimum(result, wanted)
    return result


def across_edges(triangles: np.ndarray) -> np.ndarray:
    """Triangle across each edge 0-1, 1-2, 2-0, (m, 3), -1 at open edges, of a surface with consistent windings."""
    edges = directed_edges(triangles)
    count = edges.max(initial=0) + 1
    ours, theirs = edges[:, 0] * count + edges[:, 1], edges[:, 1] * count + edges[:, 0]
    order = np.argsort(ours)
    found = np.minimum(np.searchsorted(ours[order], theirs), len(order) - 1)
    return np.where(ours[order][found] == theirs, order[found] // 3, -1).reshape(-1, 3)


def _one_round(solids: Solids, limit: np.ndarray, flat: float, angle_deg: float, told: np.ndarray) -> Solids:
    """Solids with no edge above the limits (m,) m of its triangles; counts edges turned in `told`."""
    count, n_points = len(solids.triangles), len(solids.points)
    points, tri, part, limit = solids.points.copy(), solids.triangles.copy(), solids.part.astype(np.int64), limit.copy()
    adj, sine, done = across_edges(tri), float(np.sin(np.radians(angle_deg))), False
    turn_all(points, tri, adj, part, limit, count, flat, told)
    while not done:
        if count > MOST_TRIANGLES:
            raise ValueError(
                f"{solids.source}: the target edges give more than {MOST_TRIANGLES} triangles, allowed are fewer"
            )
        points, tri, adj, part, limit = (
            _with_room(array, used)
            for array, used in ((points, n_points), (tri, count), (adj, count), (part, count), (limit, count))
        )
        n_points, count, done = refine_all(
            points, tri, adj, part, limit, n_points, count, sine, SHORTEST_OVER_TARGET / LONGEST_OVER_TARGET, flat, told
        )
    return replace(solids, points=points[:n_points], triangles=tri[:count], part=part[:count])


def _with_room(array: np.ndarray, used: int) -> np.ndarray:
    """The used rows of an array, with room for as many again and some more."""
    result = np.empty((2 * used + 1024, *array.shape[1:]), dtype=array.dtype)
    result[:used] = array[:used]
    return result
