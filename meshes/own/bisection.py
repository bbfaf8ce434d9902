"""Loops of the refinement: edges halved along longest-edge paths, edges turned within planes. Compiled by numba.

Arrays have room at their end: points (n, 3) m; tri (m, 3) nodes; adj (m, 3) the triangle across edge k, which runs from
node k to node k + 1, -1 at an open edge; part (m,); limit (m,) m, longest edge that a triangle may have. Windings must
be consistent. flat: m, how far turning an edge may move the surface.

Sources: M.-C. Rivara, Int. J. Numer. Meth. Eng. 40 (1997) 3313 (longest-edge paths with Delaunay's criterion);
C. L. Lawson, in: Mathematical Software III (1977) 161 (turning edges).
"""

from __future__ import annotations

import numpy as np
from numba import njit

SAME_LENGTH = 1.0 + 1e-9  # -, of edges: a path ends at an edge that no other of its two triangles is longer than
ALIKE = 0.7  # -, over the longest edge: a crease that long is halved instead
DELAUNAY = 1e-9  # -, sine of the sum of two opposite angles over pi at which an edge is turned
MOST_PASSES = 100  # over all edges, turning them; some ten are needed
MOST_STEPS = 10_000  # along a path or round a node: more than any has
MOST_TOUCHED = 1000  # edges turned after one was halved; a few are needed


@njit(cache=True)
def _between(points, a, b, out) -> float:
    """Leave the vector from node a to node b in `out`; its length."""
    square = 0.0
    for c in range(3):
        out[c] = points[b, c] - points[a, c]
        square += out[c] * out[c]
    return np.sqrt(square)


@njit(cache=True)
def _cross(a, b, out) -> float:
    """Leave the vector product in `out`; its length."""
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]
    return np.sqrt(out[0] ** 2 + out[1] ** 2 + out[2] ** 2)


@njit(cache=True)
def _dot(a, b) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True)
def _place_of(tri, t, node) -> int:
    """Place of a node in a triangle, -1 where it is none of its."""
    for k in range(3):
        if tri[t, k] == node:
            return k
    return -1


@njit(cache=True)
def _relink(tri, adj, t, start, old, new) -> None:
    """Let triangle t know that across its edge that begins at node `start` there is `new` now, not `old`."""
    if t >= 0:
        k = _place_of(tri, t, start)
        if adj[t, k] == old:
            adj[t, k] = new


@njit(cache=True)
def _lengths(points, tri, t, room, out) -> int:
    """Leave the lengths of the edges of a triangle in `out`; the number of the longest."""
    for k in range(3):
        out[k] = _between(points, tri[t, k], tri[t, (k + 1) % 3], room[0])
    return int(np.argmax(out))


@njit(cache=True)
def _gap(points, tri, adj, part, t, k, room) -> float:
    """How far (m) turning an edge would move the surface; infinite where it may not be turned at all."""
    n = adj[t, k]
    if n < 0 or part[n] != part[t]:
        return np.inf
    a, b, c = tri[t, k], tri[t, (k + 1) % 3], tri[t, (k + 2) % 3]
    d = tri[n, (_place_of(tri, n, b) + 2) % 3]
    edge, to_c, to_d, first, second = room[0], room[1], room[2], room[3], room[4]
    _between(points, a, b, edge)
    _between(points, a, c, to_c)
    _between(points, a, d, to_d)
    _cross(edge, to_c, first)
    _cross(to_d, edge, second)
    if _dot(first, second) <= 0.0:
        return np.inf
    six_volumes = abs(_dot(to_d, first))
    _between(points, c, d, to_c)
    across = _cross(edge, to_c, second)
    return six_volumes / across if across > 0.0 else np.inf


@njit(cache=True)
def _wants_turning(points, tri, adj, t, k, room) -> bool:
    """Whether the angles opposite to an edge add up to more than pi, and turning it leaves two proper triangles."""
    n = adj[t, k]
    a, b, c = tri[t, k], tri[t, (k + 1) % 3], tri[t, (k + 2) % 3]
    d = tri[n, (_place_of(tri, n, b) + 2) % 3]
    one, two, normal, other = room[0], room[1], room[2], room[3]
    _between(points, c, a, one)
    _between(points, c, b, two)
    sine_c, cosine_c = _cross(one, two, normal), _dot(one, two)
    _between(points, d, b, one)
    _between(points, d, a, two)
    sine_d, cosine_d = _cross(one, two, other), _dot(one, two)
    size = np.sqrt((sine_c**2 + cosine_c**2) * (sine_d**2 + cosine_d**2))
    if sine_c * cosine_d + cosine_c * sine_d >= -DELAUNAY * size:
        return False
    for c_ in range(3):
        normal[c_] += other[c_]
    _between(points, a, d, one)
    _between(points, a, c, two)
    _cross(one, two, other)
    if _dot(other, normal) <= 0.0:
        return False
    _between(points, d, b, one)
    _between(points, d, c, two)
    _cross(one, two, other)
    return _dot(other, normal) > 0.0


@njit(cache=True)
def _joined(tri, adj, t, node, other) -> bool:
    """Whether an edge joins two nodes already; the triangle t has the first."""
    here = t
    for _ in range(MOST_STEPS):
        k = _place_of(tri, here, node)
        if tri[here, (k + 1) % 3] == other or tri[here, (k + 2) % 3] == other:
            return True
        here = adj[here, k]
        if here == t:
            return False
        if here < 0:
            break
    here = t
    for _ in range(MOST_STEPS):
        here = adj[here, (_place_of(tri, here, node) + 2) % 3]
        if here < 0 or here == t:
            return False
        k = _place_of(tri, here, node)
        if tri[here, (k + 1) % 3] == other or tri[here, (k + 2) % 3] == other:
            return True
    return True


@njit(cache=True)
def _turn(tri, adj, t, k) -> None:
    """Turn edge k of triangle t, from a-b to d-c: t becomes a, d, c and its neighbour d, b, c."""
    n = adj[t, k]
    a, b, c = tri[t, k], tri[t, (k + 1) % 3], tri[t, (k + 2) % 3]
    j = _place_of(tri, n, b)
    d = tri[n, (j + 2) % 3]
    at_bc, at_ca, at_ad, at_db = adj[t, (k + 1) % 3], adj[t, (k + 2) % 3], adj[n, (j + 1) % 3], adj[n, (j + 2) % 3]
    tri[t, 0], tri[t, 1], tri[t, 2] = a, d, c
    tri[n, 0], tri[n, 1], tri[n, 2] = d, b, c
    adj[t, 0], adj[t, 1], adj[t, 2] = at_ad, n, at_ca
    adj[n, 0], adj[n, 1], adj[n, 2] = at_db, at_bc, t
    _relink(tri, adj, at_ad, d, n, t)
    _relink(tri, adj, at_bc, c, t, n)


@njit(cache=True)
def _turned_if_better(points, tri, adj, part, limit, flat, t, k, room, told) -> bool:
    """Turn an edge in a plane where Delaunay's criterion says so; counts it in `told` (parts, 5)."""
    if adj[t, k] < 0 or not np.isfinite(limit[t]) or not np.isfinite(limit[adj[t, k]]):
        return False
    gap = _gap(points, tri, adj, part, t, k, room)
    if gap > flat or not _wants_turning(points, tri, adj, t, k, room):
        return False
    n = adj[t, k]
    d = tri[n, (_place_of(tri, n, tri[t, (k + 1) % 3]) + 2) % 3]
    if _joined(tri, adj, t, tri[t, (k + 2) % 3], d):
        return False
    row = told[part[t]]
    row[0] += 1.0
    if row[0] == 1.0:
        for c in range(3):
            row[2 + c] = points[tri[t, k], c]
    row[1] = max(row[1], gap)
    _turn(tri, adj, t, k)
    return True


@njit(cache=True)
def turn_all(points, tri, adj, part, limit, count, flat, told) -> None:
    """Turn edges within planes until Delaunay's criterion holds. told (parts, 5): turned, largest gap (m), place."""
    room = np.empty((5, 3))
    for _ in range(MOST_PASSES):
        turned = 0
        for t in range(count):
            for k in range(3):
                turned += _turned_if_better(points, tri, adj, part, limit, flat, t, k, room, told)
        if turned == 0:
            return


@njit(cache=True)
def _halve(points, tri, adj, part, limit, t, k, n_points, count) -> int:
    """Halve edge k of triangle t by node `n_points`; the number of triangles then, the two new ones at the end."""
    n = adj[t, k]
    a, b, c, m = tri[t, k], tri[t, (k + 1) % 3], tri[t, (k + 2) % 3], n_points
    for x in range(3):
        points[m, x] = 0.5 * (points[a, x] + points[b, x])
    at_bc, at_ca, u = adj[t, (k + 1) % 3], adj[t, (k + 2) % 3], count
    j = _place_of(tri, n, b) if n >= 0 else 0
    tri[t, 0], tri[t, 1], tri[t, 2] = a, m, c
    tri[u, 0], tri[u, 1], tri[u, 2] = m, b, c
    part[u], limit[u] = part[t], limit[t]
    adj[t, 0], adj[t, 1], adj[t, 2] = -1, u, at_ca
    adj[u, 0], adj[u, 1], adj[u, 2] = n, at_bc, t
    _relink(tri, adj, at_bc, c, t, u)
    if n < 0:
        return count + 1
    d, v = tri[n, (j + 2) % 3], count + 1
    at_ad, at_db = adj[n, (j + 1) % 3], adj[n, (j + 2) % 3]
    tri[n, 0], tri[n, 1], tri[n, 2] = b, m, d
    tri[v, 0], tri[v, 1], tri[v, 2] = m, a, d
    part[v], limit[v] = part[n], limit[n]
    adj[n, 0], adj[n, 1], adj[n, 2] = u, v, at_db
    adj[v, 0], adj[v, 1], adj[v, 2] = t, at_ad, n
    adj[t, 0] = v
    _relink(tri, adj, at_ad, d, n, v)
    return count + 2


@njit(cache=True)
def _blunt(points, tri, adj, part, t, lengths, sine, flat, room) -> bool:
    """Whether the smallest angle of a triangle is large enough, or lies between two edges that cannot be turned."""
    short = int(np.argmin(lengths))
    one, two = (short + 1) % 3, (short + 2) % 3
    _between(points, tri[t, 0], tri[t, 1], room[0])
    _between(points, tri[t, 0], tri[t, 2], room[1])
    if _cross(room[0], room[1], room[2]) >= sine * lengths[one] * lengths[two]:
        return True
    return _gap(points, tri, adj, part, t, one, room) > flat and _gap(points, tri, adj, part, t, two, room) > flat


@njit(cache=True)
def _end_of_path(points, tri, adj, t, room, lengths) -> tuple[int, int]:
    """Triangle and edge at which the path over ever longer edges ends that starts at the longest edge of t."""
    k = _lengths(points, tri, t, room, lengths)
    for _ in range(MOST_STEPS):
        length, n = lengths[k], adj[t, k]
        if n < 0:
            break
        j = _lengths(points, tri, n, room, lengths)
        if lengths[j] <= SAME_LENGTH * length:
            break
        t, k = n, j
    return t, k


@njit(cache=True)
def _crease_instead(points, tri, adj, part, t, k, flat, room, lengths) -> tuple[int, int]:
    """Triangle and edge to halve where edge k of t is the longest: a crease about as long beside it, if that can be
    turned itself. A node on the diagonal of a strip between two creases would halve the strip's width.
    """
    if _gap(points, tri, adj, part, t, k, room) > flat:
        return t, k
    for triangle in (t, adj[t, k]):
        longest = _lengths(points, tri, triangle, room, lengths)
        for step in range(1, 3):
            edge = (longest + step) % 3
            if lengths[edge] >= ALIKE * lengths[longest] and _gap(points, tri, adj, part, triangle, edge, room) > flat:
                return triangle, edge
    return t, k


@njit(cache=True)
def refine_all(points, tri, adj, part, limit, n_points, count, sine, shortest, flat, told) -> tuple[int, int, bool]:
    """Halve edges until none is above its limit, and smallest angles are above one of that sine where they can be.

    shortest: -, over the limit: an edge that is halved for an angle's sake leaves none below. Returns the numbers of
    nodes and triangles, and whether all is done: False where the arrays are full.
    """
    room, lengths, near = np.empty((5, 3)), np.empty(3), np.empty(2 * MOST_TOUCHED, dtype=np.int64)
    waiting = np.empty(4 * len(tri) + 64, dtype=np.int64)
    top = count
    for t in range(count):
        waiting[t] = count - 1 - t
    while top > 0:
        top -= 1
        t = waiting[top]
        k = _lengths(points, tri, t, room, lengths)
        if not np.isfinite(limit[t]):
            continue
        if lengths[k] <= limit[t] and (
            lengths[k] < 2.0 * shortest * limit[t] or _blunt(points, tri, adj, part, t, lengths, sine, flat, room)
        ):
            continue
        if n_points >= len(points) or count + 2 > len(tri):
            return n_points, count, False
        at, edge = _end_of_path(points, tri, adj, t, room, lengths)
        at, edge = _crease_instead(points, tri, adj, part, at, edge, flat, room, lengths)
        before, m = count, n_points
        across = adj[at, edge]
        count = _halve(points, tri, adj, part, limit, at, edge, m, count)
        n_points += 1
        near[0], near[1], depth = at, before, 2
        if across >= 0:
            near[2], near[3], depth = across, before + 1, 4
        if top + 4 * MOST_TOUCHED > len(waiting):
            longer = np.empty(2 * len(waiting) + 4 * MOST_TOUCHED, dtype=np.int64)
            longer[:top] = waiting[:top]
            waiting = longer
        waiting[top] = t
        top += 1
        touched = 0
        while depth > 0:
            depth -= 1
            s = near[depth]
            side = (_place_of(tri, s, m) + 1) % 3
            n = adj[s, side]
            if touched < MOST_TOUCHED and _turned_if_better(points, tri, adj, part, limit, flat, s, side, room, told):
                near[depth], near[depth + 1] = s, n
                depth += 2
                touched += 1
            else:
                waiting[top] = s
                top += 1
    return n_points, count, True
