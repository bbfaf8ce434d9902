"""Compiled loops of remeshing over the faces of a patch: what operations leave, sums, distances to the old surface.

Remeshing tries some hundred sets of operations on patches of a few hundred faces, for which calls of numpy cost more
than the arithmetic. Sums run in the order of the faces, so that results depend on nothing else.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from bulkwear.postproc.triangle import area_vector, between, between_places, cross, dot, smallest_angle


@njit(cache=True)
def cosine(a, b) -> float:
    """Cosine of the angle between two triples; -1 where one of them is zero."""
    length = math.sqrt(dot(a, a)) * math.sqrt(dot(b, b))
    return dot(a, b) / length if length > 0.0 else -1.0


@njit(cache=True)
def all_of(mask, face) -> bool:
    """Whether a mask (n,) holds at all nodes of a face."""
    return mask[face[0]] and mask[face[1]] and mask[face[2]]


@njit(cache=True)
def sound(points, triangles, new_points, new_triangles, of_face, alive, fixed, count, good_angle, least_cosine, slack):
    """Mask (count,) of the operations that spoil no face: no smaller angle, no turned face, no more faces held fast.

    points (n, 3) m, triangles (m, 3) : before; new_points, new_triangles: after, the same rows
    of_face (m,) : operation of each face, or -1; alive (m,): faces that are left after it
    fixed (n,) : nodes that may not move
    good_angle : degrees, least_cosine, slack : -, see `postproc.wear.remesh_operations`
    """
    angle, least, mean = np.full(count, np.inf), np.full(count, np.inf), np.zeros((count, 3))
    held, good = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.bool_)
    rows = np.flatnonzero(of_face >= 0)
    for row in rows:
        group, face = of_face[row], triangles[row]
        good[group] = True
        angle[group] = min(angle[group], smallest_angle(points, face))
        held[group] += all_of(fixed, face)
        vector = area_vector(points, face)
        for axis in range(3):
            mean[group, axis] += vector[axis]
    for row in rows:
        group = of_face[row]
        least[group] = min(least[group], cosine(area_vector(points, triangles[row]), mean[group]))
        if alive[row]:
            held[group] -= all_of(fixed, new_triangles[row])
    for row in rows:
        group, face = of_face[row], new_triangles[row]
        if not (alive[row] and good[group]):
            continue
        flat = cosine(area_vector(new_points, face), mean[group]) >= min(least[group], least_cosine) - slack
        acute = smallest_angle(new_points, face) < min(angle[group], good_angle)
        good[group] = flat and not acute and held[group] >= 0
    return good


@njit(cache=True)
def node_normals_by_angle(points, triangles, normals) -> np.ndarray:
    """Sum at each node of the unit normals (m, 3) of its faces, weighted by their angle there, (n, 3) rad."""
    result = np.zeros_like(points)
    for row in range(len(triangles)):
        face = triangles[row]
        for k in range(3):
            forward = between(points, face[k], face[(k + 1) % 3])
            backward = between(points, face[k], face[(k + 2) % 3])
            normal = cross(forward, backward)
            angle = math.atan2(math.sqrt(dot(normal, normal)), dot(forward, backward))
            for axis in range(3):
                result[face[k], axis] += angle * normals[row, axis]
    return result


@njit(cache=True)
def edge_normals(normals, held, new) -> np.ndarray:
    """Sum (m, 3, 3) of the normals (m, 3) of the two faces at each edge, by its opposite corner; their own at a border.

    held, new : see `postproc.wear.edge_kernels.sorted_edges`
    """
    result = np.empty((len(normals), 3, 3))
    for row in range(len(normals)):
        for k in range(3):
            for axis in range(3):
                result[row, k, axis] = normals[row, axis]
    for at in range(1, len(held)):
        if new[at]:
            continue
        for edge in (held[at - 1], held[at]):
            for axis in range(3):
                both = normals[held[at - 1] // 3, axis] + normals[held[at] // 3, axis]
                result[edge // 3, (edge % 3 + 2) % 3, axis] = both
    return result


@njit(cache=True)
def heights(places, nearest, closest, points, triangles, of_face, of_edge, of_node, on_edge) -> np.ndarray:
    """Height (k,) m of places over the closest points `nearest` (k, 3) m, along the normal there: its sign is told.

    closest (k,) : face of each closest point; points (n, 3) m, triangles (m, 3)
    of_face (m, 3), of_edge (m, 3, 3), of_node (n, 3) : normals; those of edges by the opposite corner
    on_edge : -, barycentric weight below which a point lies on an edge
    """
    result, weight, spokes = np.empty(len(places)), np.empty(3), np.empty((3, 3))
    for row in range(len(places)):
        face = triangles[closest[row]]
        for k in range(3):
            for axis in range(3):
                spokes[k, axis] = points[face[k], axis] - nearest[row, axis]
        normal = cross(between(points, face[0], face[1]), between(points, face[0], face[2]))
        for k in range(3):
            weight[k] = max(dot(cross(spokes[(k + 1) % 3], spokes[(k + 2) % 3]), normal), 0.0)
        total = weight[0] + weight[1] + weight[2]
        count, edge, largest = 0, 0, 0
        for k in range(3):
            weight[k] = weight[k] / total if total > 0.0 else 1.0 / 3.0
            if weight[k] < on_edge:
                edge = k if count == 0 else edge
                count += 1
            if weight[k] > weight[largest]:
                largest = k
        side = of_face[closest[row]]
        if count == 1:
            side = of_edge[closest[row], edge]
        elif count == 2:
            side = of_node[face[largest]]
        offset = between_places(nearest[row], places[row])
        result[row] = dot(offset, side)
    return result


@njit(cache=True)
def probes(points, triangles):
    """Where faces are held against another surface, (q, 3) m, and the seven of them of each face, (m, 7).

    Centroids, corners and middles of the edges, common ones once. points (n, 3) m; triangles (m, 3)
    """
    number, count = np.full(len(points), -1), len(triangles)
    size = 2
    while size < 6 * len(triangles):
        size *= 2
    table = np.full((size, 2), -1)
    place, at = np.empty((7 * len(triangles), 3)), np.empty((len(triangles), 7), dtype=np.int64)
    for row in range(len(triangles)):
        face, at[row, 6] = triangles[row], row
        for axis in range(3):
            place[row, axis] = (points[face[0], axis] + points[face[1], axis] + points[face[2], axis]) / 3.0
        for k in range(3):
            if number[face[k]] < 0:
                number[face[k]] = count
                for axis in range(3):
                    place[count, axis] = points[face[k], axis]
                count += 1
            at[row, k] = number[face[k]]
        for k in range(3):
            start, end = face[k], face[(k + 1) % 3]
            slot = _edge_slot(table, min(start, end) * len(points) + max(start, end))
            if table[slot, 1] < 0:
                table[slot, 1] = count
                for axis in range(3):
                    place[count, axis] = 0.5 * (points[start, axis] + points[end, axis])
                count += 1
            at[row, 3 + k] = table[slot, 1]
    return place[:count].copy(), at


@njit(cache=True)
def _edge_slot(table, key) -> int:
    """Row of a table (size a power of 2, 2) of keys and values where a key stands, or is put with the value -1."""
    slot = (key ^ (key >> 7)) & (len(table) - 1)
    while table[slot, 0] >= 0 and table[slot, 0] != key:
        slot = (slot + 1) & (len(table) - 1)
    table[slot, 0] = key
    return slot


@njit(cache=True)
def centroid_probes(points, triangles):
    """The same of the centroids alone, (m, 3) m and (m, 1): a first look at faces most of which are refused."""
    place, at = np.empty((len(triangles), 3)), np.empty((len(triangles), 1), dtype=np.int64)
    for row in range(len(triangles)):
        face, at[row, 0] = triangles[row], row
        for axis in range(3):
            place[row, axis] = (points[face[0], axis] + points[face[1], axis] + points[face[2], axis]) / 3.0
    return place, at


@njit(cache=True)
def ranges(distance, at, triangles, size) -> np.ndarray:
    """Smallest and largest distance at the probes of each face over its mean target edge, (m, 2).

    distance (q,) m and at (m, k): see `probes`; triangles (m, 3); size (n,) m
    """
    result = np.empty((len(triangles), 2))
    for row in range(len(triangles)):
        face, low, high = triangles[row], np.inf, -np.inf
        for k in range(at.shape[1]):
            low, high = min(low, distance[at[row, k]]), max(high, distance[at[row, k]])
        mean = (size[face[0]] + size[face[1]] + size[face[2]]) / 3.0
        result[row, 0], result[row, 1] = low / mean, high / mean
    return result


@njit(cache=True)
def star_sums(points, triangles, size, of_face, nodes):
    """Sums over the faces round nodes no two of which share a face.

    points (n, 3) m; triangles (m, 3); size (n,) m: target edges; of_face (m,): place in `nodes` of the one among its
    corners, or -1; nodes (k,)

    Returns weights (k,), areas over the square of the target edge; moments (k, 3) m, the sums of the centroids with
    those weights; gradients (k, 3) m2, area vectors. They are summed corner by corner, as `sum_over_nodes` does.
    """
    weight, moment, gradient = np.zeros(len(nodes)), np.zeros((len(nodes), 3)), np.zeros((len(nodes), 3))
    rows = np.flatnonzero(of_face >= 0)
    for k in range(3):
        for row in rows:
            group, face = of_face[row], triangles[row]
            if face[k] != nodes[group]:
                continue
            vector = area_vector(points, face)
            mean = (size[face[0]] + size[face[1]] + size[face[2]]) / 3.0
            density = math.sqrt(dot(vector, vector)) / (mean * mean)
            weight[group] += density
            for axis in range(3):
                middle = (points[face[0], axis] + points[face[1], axis] + points[face[2], axis]) / 3.0
                moment[group, axis] += density * middle
                gradient[group, axis] += vector[axis]
    return weight, moment, gradient


@njit(cache=True)
def opposite_areas(points, triangles, nodes, places):
    """Twice the area vectors (m, 3) m2 of triangles from a place each to the edge opposite to a node, from it.

    points (n, 3) m; triangles (m, 3); nodes (m,), one corner of each; places (m, 3) m
    """
    result = np.empty((len(triangles), 3))
    for row in range(len(triangles)):
        face, k = triangles[row], 0
        while k < 2 and face[k] != nodes[row]:
            k += 1
        first = between_places(places[row], points[face[(k + 1) % 3]])
        second = between_places(places[row], points[face[(k + 2) % 3]])
        result[row, 0], result[row, 1], result[row, 2] = cross(first, second)
    return result


@njit(cache=True)
def operations_of(triangles, operation):
    """The operation (m,) of each face, -1 for none, and how many of its corners take part, (m,).

    triangles (m, 3); operation (n,) of each node, -1 for none; those of a face are the same
    """
    of_face, taking_part = np.empty(len(triangles), dtype=np.int64), np.zeros(len(triangles), dtype=np.int64)
    for row in range(len(triangles)):
        first, second, third = (
            operation[triangles[row, 0]],
            operation[triangles[row, 1]],
            operation[triangles[row, 2]],
        )
        of_face[row] = max(first, second, third)
        taking_part[row] = (first >= 0) + (second >= 0) + (third >= 0)
    return of_face, taking_part


@njit(cache=True)
def relative_lengths(points, ends, size) -> np.ndarray:
    """Length of each edge (e, 2) over the mean target edge of its ends, (e,). size (n,) m"""
    result = np.empty(len(ends))
    for row in range(len(ends)):
        first, second = ends[row, 0], ends[row, 1]
        edge = between(points, first, second)
        result[row] = math.sqrt(dot(edge, edge)) / ((size[first] + size[second]) / 2.0)
    return result
