"""Which faces of a surface cut one another, which lie on one another in one plane, and what the solver refuses.

Candidates are pairs of faces whose boxes overlap, from a tree of boxes: slivers and faces of unlike size cost little.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numba import njit

from bulkwear.postproc.mesh_cuts import cutting

LEAST_SOLVER_ANGLE = 0.3  # degrees; LIGGGHTS refuses a mesh with a smaller one than 0.256
LARGEST_PAIR_BLOCK = 500_000  # pairs of faces handled at once: bounds the memory at some 300 MB
MORTON_BITS = 20  # per axis, of a place along the curve that orders boxes: three of them fit an int64
LEAF = 4  # boxes in a leaf of the tree
DEEPEST = 64  # levels of the tree: more than any int64 count needs


def intersecting_faces(
    points: np.ndarray, triangles: np.ndarray, among: np.ndarray | None = None, clearance_m: float = 0.0
) -> np.ndarray:
    """Pairs of faces that cut one another, (p, 2), lower index first.

    among: (m,) bool, only pairs with at least one of these; None: all. clearance_m: m, faces cut where each stands out
    of the other's plane by more, on both sides, along a line that is longer. Neighbours at an edge never count.
    Coplanar overlap is not found (`overlapping_faces`).
    """
    return _searched(points, triangles, among, clearance_m, cutting)


def overlapping_faces(points: np.ndarray, triangles: np.ndarray, clearance_m: float) -> np.ndarray:
    """Pairs of faces in one plane that cover one another, (p, 2), lower index first; folds at an edge count.

    clearance_m: m, > 0: how far the planes may be apart, and how wide an overlap has to be to count.
    """
    return _searched(points, triangles, None, clearance_m, _covering)


def _searched(points, triangles, among, clearance, narrow) -> np.ndarray:
    """Sorted pairs of faces with overlapping boxes for which `narrow` says yes, (p, 2)."""
    low, high = _boxes(points, triangles, clearance)
    near = np.arange(len(triangles)) if among is None else _beside(low, high, among)
    asked = None if among is None else among[near]
    found = [np.empty((0, 2), dtype=np.int64)]
    for pairs in overlapping_boxes(low[near], high[near], asked):
        pairs = near[pairs]
        found.append(pairs[narrow(points, triangles, pairs, clearance)])
    return np.unique(np.sort(np.concatenate(found), axis=1), axis=0)


def _beside(low: np.ndarray, high: np.ndarray, among: np.ndarray) -> np.ndarray:
    """Boxes (k,) of all (m, 3) m that overlap the one box round those `among` (m,): no others can overlap these."""
    if not among.any():
        return np.empty(0, dtype=np.int64)
    apart = (low > high[among].max(axis=0)) | (high < low[among].min(axis=0))
    return np.flatnonzero(~(apart[:, 0] | apart[:, 1] | apart[:, 2]))


@njit(cache=True)
def _boxes(points, triangles, clearance) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corners (m, 3) m of the boxes round faces, wider by a clearance on all sides."""
    low, high = np.empty((len(triangles), 3)), np.empty((len(triangles), 3))
    for row in range(len(triangles)):
        a, b, c = triangles[row, 0], triangles[row, 1], triangles[row, 2]
        for axis in range(3):
            low[row, axis] = min(points[a, axis], points[b, axis], points[c, axis]) - clearance
            high[row, axis] = max(points[a, axis], points[b, axis], points[c, axis]) + clearance
    return low, high


def _covering(points: np.ndarray, triangles: np.ndarray, pairs: np.ndarray, clearance: float) -> np.ndarray:
    """Mask (p,) of the pairs in one plane that no edge of either separates (separating axes)."""
    first, second = points[triangles[pairs[:, 0]]], points[triangles[pairs[:, 1]]]
    rows, normals = np.arange(len(pairs)), []
    for ours, theirs in ((first, second), (second, first)):
        normal = np.cross(ours[rows, 1] - ours[rows, 0], ours[rows, 2] - ours[rows, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), np.finfo(float).tiny)
        heights = np.einsum("kcj,kj->kc", theirs[rows] - ours[rows, :1], normal)
        near = (np.abs(heights) <= clearance).all(axis=1)
        rows, normals = rows[near], [each[near] for each in (*normals, normal)]
    first, second = first[rows], second[rows]
    edges = [np.roll(each, -1, axis=1) - each for each in (first, second)]
    axes = np.concatenate([np.cross(e, n[:, None]) for e, n in zip(edges, normals, strict=True)], axis=1)
    axes /= np.maximum(np.linalg.norm(axes, axis=2, keepdims=True), np.finfo(float).tiny)
    ours, theirs = (np.einsum("kcj,kaj->kac", each - first[:, :1], axes) for each in (first, second))
    overlap = np.minimum(ours.max(axis=2), theirs.max(axis=2)) - np.maximum(ours.min(axis=2), theirs.min(axis=2))
    result = np.zeros(len(pairs), dtype=bool)
    result[rows[overlap.min(axis=1) > clearance]] = True
    return result


def overlapping_boxes(low: np.ndarray, high: np.ndarray, among: np.ndarray | None = None) -> Iterator[np.ndarray]:
    """Yield pairs (p, 2) of boxes that overlap or touch, in blocks of at most `LARGEST_PAIR_BLOCK`.

    low, high: (m, 3) m. among: (m,) bool, only pairs with at least one of these, those of two of them twice; None: all,
    once.
    """
    if not len(low):
        return
    order = _along_a_curve(0.5 * (low + high))
    low, high = low[order], high[order]
    asked = np.arange(len(low)) if among is None else np.flatnonzero(among[order])
    tree, position = _tree(low, high), 0
    found = np.empty((LARGEST_PAIR_BLOCK, 2), dtype=np.int64)
    while position < len(asked):
        count, position_after = _pairs(*tree, low, high, asked, position, among is None, found)
        if position_after == position:  # one box overlaps more boxes than a block takes
            found = np.empty((2 * len(found), 2), dtype=np.int64)
        elif count:
            yield order[found[:count]]
        position = position_after


def _along_a_curve(places: np.ndarray) -> np.ndarray:
    """Order (m,) of places (m, 3) along Morton's curve, so that neighbours in the order lie close together."""
    low, size = places.min(axis=0), np.maximum(np.ptp(places, axis=0).max(), np.finfo(float).tiny)
    cell = ((places - low) / size * (2**MORTON_BITS - 1)).astype(np.int64)
    return np.argsort(_interleaved(cell), kind="stable")


@njit(cache=True)
def _interleaved(cell) -> np.ndarray:
    """Bits of three integers (m, 3) one by one in turn, (m,)."""
    key = np.zeros(len(cell), dtype=np.int64)
    for row in range(len(cell)):
        for bit in range(MORTON_BITS):
            for axis in range(3):
                key[row] |= ((cell[row, axis] >> bit) & 1) << (3 * bit + axis)
    return key


def _tree(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Boxes (2 q, 3) of the nodes of a binary tree over boxes in order: node 1 is the root, 2 k and 2 k + 1 below k."""
    leaves = 1
    while leaves * LEAF < len(low):
        leaves *= 2
    lower, upper = np.full((2 * leaves, 3), np.inf), np.full((2 * leaves, 3), -np.inf)
    starts = np.arange(0, len(low), LEAF)
    lower[leaves : leaves + len(starts)] = np.minimum.reduceat(low, starts)
    upper[leaves : leaves + len(starts)] = np.maximum.reduceat(high, starts)
    while leaves > 1:
        leaves //= 2
        here, below = slice(leaves, 2 * leaves), slice(2 * leaves, 4 * leaves)
        lower[here] = lower[below].reshape(-1, 2, 3).min(axis=1)
        upper[here] = upper[below].reshape(-1, 2, 3).max(axis=1)
    return lower, upper


@njit(cache=True)
def _overlap(low, high, i, others_low, others_high, j) -> bool:
    apart = False
    for axis in range(3):
        apart |= low[i, axis] > others_high[j, axis] or others_low[j, axis] > high[i, axis]
    return not apart


@njit(cache=True)
def _starts(i, leaves, once, stack) -> int:
    """Put the nodes on a stack below which a walk looks for pairs of box i, and say how many: the root, or those that
    together hold its own leaf and all later ones.
    """
    if not once:
        stack[0] = 1
        return 1
    node, depth = leaves + i // LEAF, 1
    stack[0] = node
    while node > 1:
        if node % 2 == 0:
            stack[depth] = node + 1
            depth += 1
        node //= 2
    return depth


@njit(cache=True)
def _pairs(lower, upper, low, high, asked, position, once, found) -> tuple[int, int]:
    """Fill `found` with overlapping pairs of the asked boxes from `position` on: how many, and where to go on.

    A box whose pairs do not fit any more is left for the next call. Numba, because every walk down the tree differs.
    """
    leaves, count = len(lower) // 2, 0
    stack = np.empty(DEEPEST, dtype=np.int64)
    while position < len(asked):
        i, before = asked[position], count
        depth = _starts(i, leaves, once, stack)
        while depth > 0:
            depth -= 1
            node = stack[depth]
            if not _overlap(low, high, i, lower, upper, node):
                continue
            if node < leaves:
                stack[depth], stack[depth + 1] = 2 * node, 2 * node + 1
                depth += 2
                continue
            start = (node - leaves) * LEAF
            for j in range(start, min(start + LEAF, len(low))):
                if (j > i if once else j != i) and _overlap(low, high, i, low, high, j):
                    if count == len(found):
                        return before, position
                    found[count, 0], found[count, 1] = i, j
                    count += 1
        position += 1
    return count, position
