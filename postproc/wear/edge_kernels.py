"""Compiled loops over the edges of triangles, sorted by their nodes."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def sorted_edges(triangles, count, by_sense):
    """Edges 3 row + k, from corner k of a face to the next, in the order of their lower and then higher node, (3 m,).

    And whether each has other nodes than the one before it, (3 m + 1,), the end counted. triangles (m, 3); count: of
    nodes; by_sense: of those between the same nodes the ones that run upwards first, else in the order of the faces.
    """
    start = np.zeros(count + 1, dtype=np.int64)
    for row in range(len(triangles)):
        for k in range(3):
            start[min(triangles[row, k], triangles[row, (k + 1) % 3]) + 1] += 1
    for node in range(count):
        start[node + 1] += start[node]
    place = start[:-1].copy()
    held, keys = np.empty(3 * len(triangles), dtype=np.int64), np.empty(3 * len(triangles), dtype=np.int64)
    for row in range(len(triangles)):
        for k in range(3):
            a, b = triangles[row, k], triangles[row, (k + 1) % 3]
            low, key = min(a, b), 2 * max(a, b) + (by_sense and a > b)
            at = place[low]
            place[low] += 1
            while at > start[low] and keys[at - 1] > key:
                keys[at], held[at] = keys[at - 1], held[at - 1]
                at -= 1
            keys[at], held[at] = key, 3 * row + k
    new = np.zeros(len(held) + 1, dtype=np.bool_)
    for node in range(count + 1):
        new[start[node]] = True
    for at in range(1, len(held)):
        new[at] = new[at] or keys[at] // 2 != keys[at - 1] // 2
    return held, new


@njit(cache=True)
def edge_table(triangles, held, new):
    """Undirected edges in the order of their nodes, see `postproc.wear.remesh_patch.Edges`: ends, faces, third nodes.

    triangles (m, 3); held, new: `sorted_edges` of them. Where more than two faces meet the first two count.
    """
    first = np.flatnonzero(new[:-1])
    ends = np.empty((len(first), 2), dtype=np.int64)
    faces, opposite = np.full((len(first), 2), -1), np.full((len(first), 2), -1)
    for edge in range(len(first)):
        row, k = held[first[edge]] // 3, held[first[edge]] % 3
        ends[edge, 0], ends[edge, 1] = triangles[row, k], triangles[row, (k + 1) % 3]
        for side in range(1 if new[first[edge] + 1] else 2):
            row, k = held[first[edge] + side] // 3, held[first[edge] + side] % 3
            faces[edge, side], opposite[edge, side] = row, triangles[row, (k + 2) % 3]
    return ends, faces, opposite


@njit(cache=True)
def on_border(triangles, held, new, count) -> np.ndarray:
    """Mask (count,) of the nodes on edges of a single face. triangles (m, 3); held, new: `sorted_edges` of them."""
    result = np.zeros(count, dtype=np.bool_)
    for at in range(len(held)):
        if new[at] and new[at + 1]:
            row, k = held[at] // 3, held[at] % 3
            result[triangles[row, k]] = result[triangles[row, (k + 1) % 3]] = True
    return result


@njit(cache=True)
def common_neighbours(ends, chosen, count) -> np.ndarray:
    """How many nodes are neighbours of both ends of each chosen edge, (k,).

    ends (e, 2) nodes of all edges; chosen (k,) edges; count: of nodes
    """
    start = np.zeros(count + 1, dtype=np.int64)
    for row in range(len(ends)):
        start[ends[row, 0] + 1] += 1
        start[ends[row, 1] + 1] += 1
    for node in range(count):
        start[node + 1] += start[node]
    beside, place = np.empty(2 * len(ends), dtype=np.int64), start[:-1].copy()
    for row in range(len(ends)):
        a, b = ends[row, 0], ends[row, 1]
        beside[place[a]] = b
        beside[place[b]] = a
        place[a] += 1
        place[b] += 1
    marked, result = np.full(count, -1), np.zeros(len(chosen), dtype=np.int64)
    for row in range(len(chosen)):
        a, b = ends[chosen[row], 0], ends[chosen[row], 1]
        for at in range(start[a], start[a + 1]):
            marked[beside[at]] = row
        for at in range(start[b], start[b + 1]):
            result[row] += marked[beside[at]] == row
    return result
