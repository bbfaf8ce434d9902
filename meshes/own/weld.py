"""Make one mesh of loose facets: equal points welded, useless facets dropped, edges split where a node lies on them.

Parts are welded each by itself; `stitched` joins them afterwards where open edges of two parts are the same.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from bulkwear.meshes.own.repairs import Repairs
from bulkwear.meshes.own.solids import Solids
from bulkwear.postproc.mesh import areas, centroids, directed_edges, edge_lengths_per_triangle
from bulkwear.postproc.mesh_checks import overlapping_boxes

WELD_OF_SIZE = 1e-6  # -, of the largest extent or coordinate: some ten roundings of a float32, one of six digits
WIDTH_OF_WELD = 0.1  # -, of the weld tolerance: facets thinner than that are none; wider ones keep their nodes apart
MOST_ROUNDS = 8  # of dropping and splitting; each ends what the one before laid bare


def weld_tolerance(points: np.ndarray) -> float:
    """Distance (m) up to which points (n, 3) m count as one: `WELD_OF_SIZE` of the largest extent or coordinate."""
    return WELD_OF_SIZE * float(max(np.linalg.norm(np.ptp(points, axis=0)), np.abs(points).max()))


def welded(solids: Solids, tolerance: float, repairs: Repairs) -> Solids:
    """Solids, in m, whose parts are meshes without degenerate and duplicate facets and without unused nodes.

    tolerance: m, points closer than that are one, and nodes closer than that to an open edge are put into it
    """
    solids = _one_node_per_place(_own_nodes(solids), tolerance, repairs)
    for _ in range(MOST_ROUNDS):
        solids = _without_useless(solids, tolerance, repairs)
        solids, count = _split_at_nodes(solids, tolerance, repairs)
        if not count:
            break
    return compacted(solids)


def compacted(solids: Solids) -> Solids:
    """The solids without nodes of no triangle."""
    used, triangles = np.unique(solids.triangles, return_inverse=True)
    return replace(solids, points=solids.points[used], triangles=triangles.reshape(-1, 3))


def node_parts(solids: Solids) -> np.ndarray:
    """Part of each node, (n,), for nodes that belong to one part."""
    result = np.zeros(len(solids.points), dtype=np.int64)
    result[solids.triangles] = solids.part[:, None]
    return result


def _own_nodes(solids: Solids) -> Solids:
    """The solids with nodes that belong to one part only, one for each place exactly."""
    corner_part = np.repeat(solids.part, 3)
    keys = np.column_stack([corner_part, solids.points[solids.triangles.ravel()] + 0.0])
    order = np.lexsort(keys.T)
    new = np.ones(len(order), dtype=bool)
    new[1:] = (keys[order][1:] != keys[order][:-1]).any(axis=1)
    group = np.empty(len(order), dtype=np.int64)
    group[order] = np.cumsum(new) - 1
    return replace(solids, points=keys[order][new, 1:], triangles=group.reshape(-1, 3))


def _one_node_per_place(solids: Solids, tolerance: float, repairs: Repairs) -> Solids:
    """The solids with nodes of a part that are closer than the tolerance made one, which keeps a place of theirs."""
    part = node_parts(solids)
    pairs = close_points(solids.points, part, tolerance)
    if not len(pairs):
        return solids
    group = groups_of(pairs, len(solids.points))
    first = np.full(group.max() + 1, len(group))
    np.minimum.at(first, group, np.arange(len(group)))
    into = first[group]
    moved = np.flatnonzero(into != np.arange(len(into)))
    distance = np.linalg.norm(solids.points[moved] - solids.points[into[moved]], axis=1)
    repairs.add("points welded", part[moved], solids.points[moved], distance)
    return replace(solids, triangles=into[solids.triangles])


def close_points(points: np.ndarray, part: np.ndarray, tolerance: float) -> np.ndarray:
    """Pairs (p, 2) of points of the same part that are at most the tolerance (m) apart."""
    pairs = cKDTree(points).query_pairs(tolerance, output_type="ndarray")
    return pairs[part[pairs[:, 0]] == part[pairs[:, 1]]]


def groups_of(pairs: np.ndarray, count: int) -> np.ndarray:
    """Number of the group of each of `count` things that pairs (p, 2) hold together."""
    links = coo_array((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return connected_components(links, directed=False)[1]


def _without_useless(solids: Solids, tolerance: float, repairs: Repairs) -> Solids:
    """The solids without facets that collapsed, have no width (`WIDTH_OF_WELD`), or are there twice."""
    points, triangles = solids.points, solids.triangles
    ordered = np.sort(triangles, axis=1)
    collapsed = (ordered[:, :-1] == ordered[:, 1:]).any(axis=1)
    longest = edge_lengths_per_triangle(points, triangles).max(axis=1)
    thin = ~collapsed & (2.0 * areas(points, triangles) <= WIDTH_OF_WELD * tolerance * longest)
    twice = np.ones(len(triangles), dtype=bool)
    twice[np.unique(ordered, axis=0, return_index=True)[1]] = False
    twice &= ~collapsed & ~thin
    for words, mask in (
        ("collapsed facets dropped", collapsed),
        ("facets without width dropped", thin),
        ("duplicate facets dropped", twice),
    ):
        repairs.add(words, solids.part[mask], centroids(points, triangles[mask]), longest[mask])
    keep = ~(collapsed | thin | twice)
    return replace(solids, triangles=triangles[keep], part=solids.part[keep])


def open_corners(triangles: np.ndarray) -> np.ndarray:
    """Numbers 3 t + k of the edges k of triangles t that no other triangle has, in either sense."""
    edges = np.sort(directed_edges(triangles), axis=1)
    keys = edges[:, 0] * (edges.max(initial=0) + 1) + edges[:, 1]
    _, inverse, counts = np.unique(keys, return_inverse=True, return_counts=True)
    return np.flatnonzero(counts[inverse] == 1)


def nodes_at_open_edges(solids: Solids, reach: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Open nodes that lie at open edges of their part which they are no end of, up to `reach` (m) beside them.

    Returns the edges as numbers 3 t + k, the nodes, the place of each along its edge (0 to 1), its distance (m).
    """
    corners = open_corners(solids.triangles)
    ends = directed_edges(solids.triangles)[corners]
    nodes = np.unique(ends)
    a, b = solids.points[ends[:, 0]], solids.points[ends[:, 1]]
    low = np.concatenate([np.minimum(a, b) - reach, solids.points[nodes]])
    high = np.concatenate([np.maximum(a, b) + reach, solids.points[nodes]])
    is_edge = np.arange(len(low)) < len(corners)
    found = [np.empty((0, 2), dtype=np.int64), *overlapping_boxes(low, high, ~is_edge)]
    node, edge = np.concatenate(found).T
    mixed = is_edge[edge] & ~is_edge[node]
    edge, node = edge[mixed], nodes[node[mixed] - len(corners)]
    its = solids.triangles[corners[edge] // 3]
    keep = (its != node[:, None]).all(axis=1) & (solids.part[corners[edge] // 3] == node_parts(solids)[node])
    edge, node = edge[keep], node[keep]
    along = b[edge] - a[edge]
    place = np.einsum("ij,ij->i", solids.points[node] - a[edge], along) / (along**2).sum(axis=1)
    foot = a[edge] + np.clip(place, 0.0, 1.0)[:, None] * along
    distance = np.linalg.norm(solids.points[node] - foot, axis=1)
    near = distance <= reach
    return corners[edge[near]], node[near], place[near], distance[near]


def _split_at_nodes(solids: Solids, tolerance: float, repairs: Repairs) -> tuple[Solids, int]:
    """The solids with triangles cut at the nodes that lie on one of their open edges, and how many nodes those are."""
    corner, node, place, distance = nodes_at_open_edges(solids, tolerance)
    inside = (place > 0.0) & (place < 1.0)
    chosen = inside & (corner == _first_corner(corner[inside], len(solids.triangles))[corner // 3])  # an edge a round
    corner, node, place, distance = (array[chosen] for array in (corner, node, place, distance))
    if not len(corner):
        return solids, 0
    order = np.lexsort([place, corner])
    corner, node = corner[order], node[order]
    face, k = corner // 3, corner % 3
    repairs.add("edges split at nodes on them", solids.part[face], solids.points[node], distance[order])
    first = np.append(True, corner[1:] != corner[:-1])
    last = np.append(first[1:], True)
    start, end = solids.triangles[face, k], solids.triangles[face, (k + 1) % 3]
    apex = solids.triangles[face, (k + 2) % 3]
    before = np.where(first, start, np.roll(node, 1))
    pieces = np.column_stack([before, node, apex])
    rest = np.column_stack([node, end, apex])[last]
    whole = np.ones(len(solids.triangles), dtype=bool)
    whole[face] = False
    triangles = np.concatenate([solids.triangles[whole], pieces, rest])
    part = np.concatenate([solids.part[whole], solids.part[face], solids.part[face[last]]])
    return replace(solids, triangles=triangles, part=part), len(corner)


def _first_corner(corners: np.ndarray, count: int) -> np.ndarray:
    """Lowest of the edges 3 t + k of each triangle t, (count,); -1 where it has none."""
    first = np.full(count, 3 * count)
    np.minimum.at(first, corners // 3, corners)
    return np.where(first == 3 * count, -1, first)


def stitched(solids: Solids, tolerance: float, repairs: Repairs) -> Solids:
    """The solids with the nodes of open edges made one where just two parts have the same edge; those share it then."""
    corners = open_corners(solids.triangles)
    ends = directed_edges(solids.triangles)[corners]
    nodes, index = np.unique(ends, return_inverse=True)
    pairs = cKDTree(solids.points[nodes]).query_pairs(tolerance, output_type="ndarray")
    if not len(pairs):
        return solids
    place = groups_of(pairs, len(nodes))[index.reshape(-1, 2)]
    key = place.min(axis=1) * (place.max() + 1) + place.max(axis=1)
    order = np.argsort(key, kind="stable")
    counts = np.unique(key, return_counts=True)[1]
    firsts = order[(np.cumsum(counts) - counts)[counts == 2]]
    seconds = order[(np.cumsum(counts) - counts)[counts == 2] + 1]
    two = solids.part[corners[firsts] // 3] != solids.part[corners[seconds] // 3]
    firsts, seconds = firsts[two], seconds[two]
    if not len(firsts):
        return solids
    same = place[firsts, 0] == place[seconds, 0]
    other = np.where(same[:, None], ends[seconds], ends[seconds][:, ::-1])
    links = np.concatenate([np.column_stack([ends[firsts, k], other[:, k]]) for k in range(2)])
    group = groups_of(links, len(solids.points))
    first = np.full(group.max() + 1, len(group))
    np.minimum.at(first, group, np.arange(len(group)))
    middle = solids.points[ends[firsts]].mean(axis=1)
    repairs.add("open edges joined with another part", solids.part[corners[firsts] // 3], middle)
    return compacted(replace(solids, triangles=first[group][solids.triangles]))
