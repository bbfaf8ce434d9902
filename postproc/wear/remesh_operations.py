"""Split, collapse, flip and shift: the local operations of remeshing, many independent ones at a time.

Every round picks operations that share no face (each is the most urgent one near it), tries all of them at once and
takes back those that make the patch worse: a smaller angle, a turned face, a place outside the old surface, or one more
face without a node that may move. A split leaves the shape as it is. A shift keeps the volume exactly: a node alone
sweeps w . G, where G, the gradient of the volume, depends on the ring round the node only, so w is chosen square to G.
A collapse of two free nodes puts the new one where the volume stays (P. Lindstrom and G. Turk, IEEE Visualization 1998,
279). What flips and collapses on to a curve change in volume is left to `postproc.wear.remesh`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bulkwear.postproc.wear.edge_kernels import common_neighbours
from bulkwear.postproc.wear.face_kernels import acute_faces, angles
from bulkwear.postproc.wear.old_surface import OldSurface
from bulkwear.postproc.wear.remesh_kernels import (
    centroid_probes,
    operations_of,
    opposite_areas,
    probes,
    relative_lengths,
    sound,
    star_sums,
)
from bulkwear.postproc.wear.remesh_patch import (
    CURVE,
    FIXED,
    INNER,
    Edges,
    Patch,
    edges_of,
    freedom,
    lowest_beside,
)

LARGEST_OUTWARD = 0.01  # -, over the target edge: how far the new surface may stand outside the old one
OUTWARD_BY_OPERATIONS = 0.005  # -, the part of it for the operations; the rest is for restoring the volume
SPLIT_ABOVE = 2.0  # -, edge over target
SPLIT_ACUTE = 1.6  # -, the same at an acute face; halves are then longer than COLLAPSE_BELOW
COLLAPSE_BELOW = 0.45  # -, edge over target
COLLAPSE_ACUTE = 0.9  # -, the same for the shortest edge of an acute face
PINCH_BELOW = 0.35  # -, the same across a strip of one label that has become so narrow: its sides are joined
FEWEST_FACES = 4  # of one label in a patch, which are not collapsed
GOOD_ANGLE = 25.0  # degrees; an operation may not bring an angle below it, or below what there was
LEAST_GAIN = 1.0  # degrees, of the smallest angle, that makes a flip worthwhile
LEAST_COSINE = 0.5  # -, between a new face and the mean normal of the old ones: 60 degrees
COSINE_SLACK = 0.05  # -, by which a knife edge may become sharper in one operation
SINK = 0.4  # -, of the edge, by which a merged node may go into the body
SHIFT = 0.7  # -, of the way to the middle of the ring
SHIFTS = ((1.0, 0.0), (1.0, 0.01), (1.0, 0.03), (0.3, 0.0))  # -, tried: part of the shift, depth over the target
SETS = 4  # independent sets of nodes in a sweep of shifts
SWEEPS = 4  # of all operations
ROUNDS = 4  # of collapses or flips in a sweep


@dataclass(frozen=True)
class Limits:
    """How far operations may leave the old surface, over the target edge, -; acute_deg: what counts as acute;
    collapse_below: edges over their target that are merged."""

    outside: float
    inside: float
    acute_deg: float
    collapse_below: float = COLLAPSE_BELOW


@dataclass(frozen=True, eq=False)
class Stars:
    """The faces that operations change which have none in common.

    before, after (k, 3): their nodes; group (k,): the operation of each; alive (k,): whether there is a face after it
    """

    before: np.ndarray
    after: np.ndarray
    group: np.ndarray
    alive: np.ndarray

    @classmethod
    def of(cls, patch: Patch, triangles: np.ndarray, of_face: np.ndarray, alive: np.ndarray) -> Stars:
        """Return those of a patch whose faces become `triangles` (m, 3); of_face (m,): operation, or -1; alive (m,)."""
        rows = np.flatnonzero(of_face >= 0)
        return cls(patch.triangles[rows], triangles[rows], of_face[rows], alive[rows])


def improve(patch: Patch, old: OldSurface, limits: Limits, erode: bool = False) -> Patch:
    """Sweeps of splits, collapses, flips and shifts (M. Botsch and L. Kobbelt, Symp. Geom. Proc. 2004, 185)."""
    for sweep in range(SWEEPS):
        patch, _ = split(patch, limits)
        patch, _ = collapse(patch, old, limits)
        patch, _ = flip(patch, old, limits)
        patch = shift(patch, old, limits, sweep, erode)
    return patch


def split(patch: Patch, limits: Limits) -> tuple[Patch, int]:
    """Halve the long edges, the longest of each face first. Border edges stay."""
    edges = edges_of(patch)
    relative = relative_lengths(patch.points, edges.ends, patch.size)
    acute = acute_faces(patch.points, patch.triangles, limits.acute_deg)
    limit = np.where(acute[edges.faces[:, 0]] | acute[edges.faces[:, 1]], SPLIT_ACUTE, SPLIT_ABOVE)
    wanted = (relative > limit) & (edges.faces[:, 1] >= 0)
    chosen = _first_of_faces(edges, wanted, -relative, len(patch.triangles))
    ends, count = edges.ends[chosen], len(chosen)
    if not count:
        return patch, 0
    middle = len(patch.points) + np.arange(count)
    triangles, extra, faces = patch.triangles.copy(), [], edges.faces[chosen]
    for side in range(2):
        old = patch.triangles[faces[:, side]]
        triangles[faces[:, side]] = np.where(old == ends[:, 1, None], middle[:, None], old)
        extra.append(np.where(old == ends[:, 0, None], middle[:, None], old))
    return patch.changed(
        points=np.concatenate([patch.points, patch.points[ends].mean(axis=1)]),
        triangles=np.concatenate([triangles, *extra]),
        label=np.concatenate([patch.label, *(patch.label[faces[:, side]] for side in range(2))]),
        size=np.concatenate([patch.size, patch.size[ends].mean(axis=1)]),
        fixed=np.concatenate([patch.fixed, np.zeros(count, dtype=bool)]),
        origin=np.concatenate([patch.origin, np.full(count, -1)]),
    ), count


def collapse(patch: Patch, old: OldSurface, limits: Limits) -> tuple[Patch, int]:
    """Merge the ends of short edges."""
    refused, total = np.empty((0, 2), dtype=np.int64), 0
    for _ in range(ROUNDS):
        patch, tried, done, refused = _collapse_round(patch, old, limits, refused)
        total += done
        if not tried:
            break
    return _without_loose_nodes(patch), total


def _collapse_round(patch, old, limits, refused):
    """One set of independent collapses: the new patch, the tried, the done, the refused pairs of nodes."""
    edges = edges_of(patch)
    kind = freedom(patch, edges)
    wanted, relative = _collapsible(patch, edges, kind, limits)
    wanted &= ~_is_among(edges.ends, refused, len(patch.points))
    chosen = _alone_in_ring(edges, wanted, relative, len(patch.points))
    if not len(chosen):
        return patch, 0, 0, refused
    ends = edges.ends[chosen]
    kept = np.where(kind[ends[:, 1]] > kind[ends[:, 0]], ends[:, 1], ends[:, 0])
    gone = ends.sum(axis=1) - kept
    operation = np.full(len(patch.points), -1)
    operation[ends] = np.arange(len(ends))[:, None]
    of_face, taking_part = operations_of(patch.triangles, operation)
    vanish = taking_part == 2
    renamed = np.arange(len(patch.points))
    renamed[gone] = kept
    triangles, points = renamed[patch.triangles], patch.points.copy()
    stars = Stars.of(patch, triangles, of_face, ~vanish)
    good = np.zeros(len(ends), dtype=bool)
    for places in _merged_points(patch, ends, kept, kind, stars):
        points[kept[~good]] = places[~good]
        good |= _acceptable(patch, points, stars, ~good, old, limits)
        if good.all():
            break
    triangles = np.where(((of_face >= 0) & good[of_face])[:, None], triangles, patch.triangles)
    points[kept[~good]] = patch.points[kept[~good]]
    stay = ~(vanish & good[of_face])
    result = patch.changed(points=points, triangles=triangles[stay], label=patch.label[stay])
    return result, len(ends), int(good.sum()), np.concatenate([refused, ends[~good]])


def _collapsible(patch: Patch, edges: Edges, kind, limits: Limits) -> tuple[np.ndarray, np.ndarray]:
    """Mask (e,) of edges that are short and may be collapsed, and all lengths over their target."""
    relative = relative_lengths(patch.points, edges.ends, patch.size)
    acute = acute_faces(patch.points, patch.triangles, limits.acute_deg)
    limit = np.where(acute[edges.faces[:, 0]] | acute[edges.faces[:, 1]], COLLAPSE_ACUTE, limits.collapse_below)
    freest = np.minimum(kind[edges.ends[:, 0]], kind[edges.ends[:, 1]])
    wanted = (relative < limit) & (edges.faces[:, 1] >= 0) & (freest != FIXED)
    wanted &= (freest == INNER) | edges.curve | (relative < PINCH_BELOW)
    few = np.bincount(patch.label)[patch.label] <= FEWEST_FACES  # no label may vanish
    wanted &= ~(few[edges.faces[:, 0]] | few[edges.faces[:, 1]])
    found = np.flatnonzero(wanted)
    wanted[found] = common_neighbours(edges.ends, found, len(patch.points)) == 2  # else two sheets would be joined
    return wanted, relative


def _merged_points(patch, ends, kept, kind, stars: Stars) -> list[np.ndarray]:
    """Places (k, 3) m of the merged nodes to try: where the volume stays, halfway, at
    one end or the other, and a little deeper.

    A node less free than the other stays in its place.
    """
    middle = patch.points[ends].mean(axis=1)
    alike = kind[ends[:, 0]] == kind[ends[:, 1]]
    inner = alike & (kind[ends[:, 0]] == INNER)
    first, place = stars.before[:, 0].copy(), middle[stars.group]
    across = opposite_areas(patch.points, stars.before, first, place)
    before = np.bincount(stars.group, np.einsum("ij,ij->i", patch.points[first] - place, across), len(ends))
    group, gradient = stars.group[stars.alive], np.zeros((len(ends), 3))
    np.add.at(gradient, group, opposite_areas(patch.points, stars.after[stars.alive], kept[group], middle[group]))
    square = (gradient**2).sum(axis=1)
    factor = np.divide(before, square, out=np.zeros_like(before), where=inner & (square > 0.0))
    sunk = middle - SINK * np.linalg.norm(np.diff(patch.points[ends], axis=1)[:, 0], axis=1, keepdims=True) * np.divide(
        gradient, np.sqrt(square)[:, None], out=np.zeros_like(gradient), where=square[:, None] > 0.0
    )
    places = [middle + factor[:, None] * gradient, middle, *patch.points[ends.T], sunk]
    return [np.where(alike[:, None], place, patch.points[kept]) for place in places]


def flip(patch: Patch, old: OldSurface, limits: Limits) -> tuple[Patch, int]:
    """Turn the common edge of two faces of one label, one of them acute, where that raises their smallest angle."""
    refused, total = np.empty((0, 2), dtype=np.int64), 0
    for _ in range(ROUNDS):
        edges = edges_of(patch)
        quads, gain = _flippable(patch, edges, limits.acute_deg)
        gain[_is_among(edges.ends, refused, len(patch.points))] = 0.0
        chosen = _first_of_faces(edges, gain > LEAST_GAIN, -gain, len(patch.triangles))
        _, unique = np.unique(_pair_keys(edges.opposite[chosen], len(patch.points)), return_index=True)
        chosen = chosen[np.sort(unique)]  # two flips to the same edge would join two sheets
        if not len(chosen):
            break
        faces, triangles = edges.faces[chosen], patch.triangles.copy()
        triangles[faces] = quads[chosen]
        of_face = np.full(len(triangles), -1)
        of_face[faces] = np.arange(len(chosen))[:, None]
        stars = Stars.of(patch, triangles, of_face, of_face >= 0)
        good = _acceptable(patch, patch.points, stars, np.ones(len(chosen), dtype=bool), old, limits)
        triangles[faces[~good]] = patch.triangles[faces[~good]]
        patch, total = patch.changed(triangles=triangles), total + int(good.sum())
        refused = np.concatenate([refused, edges.ends[chosen[~good]]])
    return patch, total


def flipped_faces(patch: Patch, edges: Edges, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The two new faces (k, 2, 3) of each chosen edge (k,) if it were flipped, and which (k,) may be."""
    (a, b), (c, d) = edges.ends[chosen].T, edges.opposite[chosen].T
    quads = np.stack([np.stack([a, d, c], axis=1), np.stack([d, b, c], axis=1)], axis=1)
    allowed = (edges.faces[chosen, 1] >= 0) & ~edges.curve[chosen] & (c != d)
    return quads, allowed & ~_is_among(edges.opposite[chosen], edges.ends, len(patch.points))


def _flippable(patch: Patch, edges: Edges, acute_deg: float) -> tuple[np.ndarray, np.ndarray]:
    """The new faces (e, 2, 3) of each edge at an acute face that may be flipped, and the gain (e,) of the smallest
    angle, degrees; 0 for all other edges.
    """
    quads, gain = np.zeros((len(edges.ends), 2, 3), dtype=np.int64), np.zeros(len(edges.ends))
    angle = angles(patch.points, patch.triangles)
    now = np.minimum(angle[edges.faces[:, 0]], angle[edges.faces[:, 1]])
    rows = np.flatnonzero(now < acute_deg)
    flipped, allowed = flipped_faces(patch, edges, rows)
    rows = rows[allowed]
    quads[rows] = flipped[allowed]
    then = angles(patch.points, quads[rows].reshape(-1, 3)).reshape(-1, 2)
    gain[rows] = np.minimum(then[:, 0], then[:, 1]) - now[rows]
    return quads, gain


def shift(patch: Patch, old: OldSurface, limits: Limits, seed: int, erode: bool = False) -> Patch:
    """Move nodes of acute faces towards the middle of their ring, curve nodes along the curve, and keep the volume.

    Where that would stand out (in a hollow) the node also goes into the body a little.
    erode: nodes off the curves may also sink to that middle, into the body and never out of it (to untangle).
    """
    edges = edges_of(patch)
    kind = freedom(patch, edges)
    waiting = np.zeros(len(kind), dtype=bool)
    waiting[patch.triangles[erode | acute_faces(patch.points, patch.triangles, limits.acute_deg)]] = True
    waiting &= kind != FIXED
    order = np.random.default_rng(seed).permutation(len(kind)).astype(np.float64)
    for _ in range(SETS):
        rank = np.where(waiting, order, np.inf)
        chosen = np.flatnonzero(rank < lowest_beside(rank, edges))
        if not len(chosen):
            break
        waiting[chosen] = False
        operation = np.full(len(kind), -1)
        operation[chosen] = np.arange(len(chosen))
        of_face, _ = operations_of(patch.triangles, operation)
        motion, inward = _motion(patch, edges, kind, chosen, of_face, erode)
        stars = Stars.of(patch, patch.triangles, of_face, of_face >= 0)
        points, good = patch.points.copy(), np.zeros(len(chosen), dtype=bool)
        for factor, depth in SHIFTS:
            left = chosen[~good]
            shifted = factor * motion[~good] + depth * patch.size[left, None] * inward[~good]
            points[left] = patch.points[left] + shifted
            good |= _acceptable(patch, points, stars, ~good, old, limits)
            if good.all():
                break
        points[chosen[~good]] = patch.points[chosen[~good]]
        patch = patch.changed(points=points)
    return patch


def _motion(patch: Patch, edges: Edges, kind, chosen, of_face, erode: bool) -> tuple[np.ndarray, np.ndarray]:
    """Shifts (k, 3) m of the chosen nodes, square to the gradient of the volume, or falling along it to `erode`.

    of_face (m,): place in `chosen` of a face's node. Returns them and the unit directions (k, 3) into the body.
    """
    weight, moment, gradient = star_sums(patch.points, patch.triangles, patch.size, of_face, chosen)
    weight = weight[:, None]
    target = np.divide(moment, weight, out=patch.points[chosen], where=weight > 0.0)
    motion = SHIFT * (target - patch.points[chosen])
    on_curve = kind[chosen] == CURVE
    motion[on_curve] = _along_curve(patch, edges, chosen[on_curve])
    square = (gradient**2).sum(axis=1, keepdims=True)
    across = (motion * gradient).sum(axis=1, keepdims=True)
    across[(across[:, 0] < 0.0) & erode & ~on_curve] = 0.0
    motion -= np.divide(across, square, out=np.zeros_like(square), where=square > 0.0) * gradient
    return motion, -np.divide(gradient, np.sqrt(square), out=np.zeros_like(gradient), where=square > 0.0)


def _along_curve(patch: Patch, edges: Edges, nodes: np.ndarray) -> np.ndarray:
    """Shifts (k, 3) m of curve nodes along the chord between their two neighbours, towards its middle."""
    ends = edges.ends[edges.curve]
    both = np.concatenate([ends, ends[:, ::-1]])
    both = both[np.argsort(both[:, 0], kind="stable")]
    first = np.searchsorted(both[:, 0], nodes)
    before, after = patch.points[both[first, 1]], patch.points[both[first + 1, 1]]
    chord = after - before
    square = (chord**2).sum(axis=1, keepdims=True)
    along = ((0.5 * (before + after) - patch.points[nodes]) * chord).sum(axis=1, keepdims=True)
    return SHIFT * np.divide(along, square, out=np.zeros_like(square), where=square > 0.0) * chord


def _acceptable(patch: Patch, points, stars: Stars, asked, old: OldSurface, limits: Limits) -> np.ndarray:
    """Mask (count,) of the operations among the mask `asked` that leave the patch sound, its nodes at `points` then."""
    judged = np.where(asked[stars.group], stars.group, -1)
    bounds = GOOD_ANGLE, LEAST_COSINE, COSINE_SLACK
    shapes = patch.points, stars.before, points, stars.after
    good = sound(*shapes, judged, stars.alive, patch.fixed, len(asked), *bounds)
    left = np.flatnonzero((judged >= 0) & stars.alive)
    for held in (centroid_probes, probes):
        left = left[good[judged[left]]]
        if not len(left):
            break
        reach = old.range_over_faces(points, stars.after[left], patch.size, held)
        good[judged[left[(reach[:, 1] > limits.outside) | (reach[:, 0] < -limits.inside)]]] = False
    return good


def all_fixed(patch: Patch, faces: np.ndarray | slice = slice(None)) -> np.ndarray:
    """Mask (k,) of faces none of whose nodes may move: what becomes of such a face nothing can mend."""
    return patch.fixed[patch.triangles[faces]].all(axis=1)


def _ranks(wanted: np.ndarray, urgency: np.ndarray) -> np.ndarray:
    """Rank 0, 1, … of the wanted entries by increasing urgency value, infinite for others."""
    rank = np.full(len(wanted), np.inf)
    rows = np.flatnonzero(wanted)
    rank[rows[np.argsort(urgency[rows], kind="stable")]] = np.arange(len(rows))
    return rank


def _first_of_faces(edges: Edges, wanted, urgency, n_faces: int) -> np.ndarray:
    """Edges that are first in both of their faces: no two of them share a face."""
    rank, rows = _ranks(wanted, urgency), np.flatnonzero(wanted)
    first = np.full(n_faces + 1, np.inf)  # the last entry takes the missing faces of border edges
    np.minimum.at(first, edges.faces[rows], rank[rows, None])
    return rows[(rank[rows, None] == first[edges.faces[rows]]).all(axis=1)]


def _alone_in_ring(edges: Edges, wanted, urgency, n_points: int) -> np.ndarray:
    """Edges that are first at their ends and at all neighbours of these: no two stars share a face."""
    rank, rows = _ranks(wanted, urgency), np.flatnonzero(wanted)
    at_node = np.full(n_points, np.inf)
    np.minimum.at(at_node, edges.ends[rows], rank[rows, None])
    first = np.minimum(at_node, lowest_beside(at_node, edges))
    return rows[(rank[rows, None] == first[edges.ends[rows]]).all(axis=1)]


def _is_among(pairs: np.ndarray, others: np.ndarray, n_points: int) -> np.ndarray:
    """Mask of the node pairs that occur in `others`, in either sense."""
    if not len(others):
        return np.zeros(len(pairs), dtype=bool)
    keys, known = _pair_keys(pairs, n_points), np.sort(_pair_keys(others, n_points))
    return known[np.searchsorted(known[:-1], keys)] == keys


def _pair_keys(pairs: np.ndarray, n_points: int) -> np.ndarray:
    """One integer (k,) per pair of nodes (k, 2), in the order of the lower and then the higher one."""
    return np.minimum(*pairs.T) * (n_points + 1) + np.maximum(*pairs.T)


def _without_loose_nodes(patch: Patch) -> Patch:
    """The patch without nodes of no triangle; fixed nodes stay."""
    used = patch.fixed.copy()
    used[patch.triangles] = True
    index = np.cumsum(used) - 1
    return patch.changed(
        points=patch.points[used],
        triangles=index[patch.triangles],
        size=patch.size[used],
        fixed=patch.fixed[used],
        origin=patch.origin[used],
    )
