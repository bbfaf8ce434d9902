"""Contact patch: worn volume spread round its mean contact position as two Hertz pressures, one upon the other.

The pressure under a sphere goes with sqrt(1 - r^2/a^2), a the contact radius (Hertz 1882). Points of a quadrature of
the patch walk from the contact position straight over the surface, unfolding one face after the other: distances
are measured along the surface, so a patch never reaches through a thin body. What arrives goes to the three
corners of the face by the linear (hat) functions there, which keeps volume and mean position exactly, whether
the patch lies within one face or covers hundreds.

The pressure itself would make ridges. It leaves 3 (sin q - q cos q) / q^3 of a wave of length 2 pi a / q (its
Fourier transform, that of a ball: Rayleigh 1911), which is negative about lengths of 1.1 a: there the wear of a ridge
falls beside it, and in a groove, where the sphere feels what it wore, ridges grow. The volume is therefore spread
twice, with a / sqrt(2) each: the same mean of r^2, and a transform that is a square, negative nowhere. A groove under
a patch of constant radius is 0.8 sqrt(2) = 1.13 times as deep as under the pressure itself.

The mesh itself widens what it carries: the hat deposit on the nodes and the linear surface between them each
add sum(l^2)/24 to the variance along either axis (l: the three edges of a face). The variance of the Hertz
pressure is a^2/5. The walk therefore uses a smaller radius, sqrt(a^2 - 5/16 sum(l^2)): the deposit made good in
full, the linear surface by half, which keeps depth and width of grooves of five elements within 5 % (measured in the
tests). A patch that the mesh cannot resolve is a point whose volume goes to the corners of the touched face: exact
for a straight track within the face, however long, because hat functions are linear along it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from bulkwear.postproc.mesh import area_vectors, directed_edges, edge_lengths_per_triangle, unit_normals

MESH_VARIANCE = 5.0 / 16.0  # -, of the sum of squared edges: what a mesh adds to the square of the Hertz radius
RINGS_PER_EDGE = 2.0  # -, quadrature points per mean edge along the radius: a patch of five edges is good to some 5 %
MOST_RINGS = 40  # -, 11400 points; a patch of 20 edges covers some 3000 faces
LEAST_FACING_COSINE = 0.5  # -, faces more than 60 degrees off the touched one do not share its contact
MOST_CROSSINGS = 400  # -, edges on one walk; a patch of 20 edges needs about 60, slivers more
OFF_TRIANGLE = 2.0  # -, heights of the triangle: points of edge contacts lie up to half an overlap beside it, no more


@dataclass(frozen=True, eq=False)
class ContactPatch:
    """Where and how wide the contacts of each triangle were.

    position : (m, 3) m, mean contact point, in the frame of the mesh; NaN where a triangle was not loaded
    radius : (m,) m, contact radius; NaN where a triangle was not loaded
    """

    position: np.ndarray
    radius: np.ndarray


def physical_radius(
    simulated_radius: np.ndarray, simulated_modulus: float, true_modulus: float, particle_scale: float = 1.0
) -> np.ndarray:
    """Contact radius (m) of the true particle behind a simulated one, a_sim (E_sim / E)^(1/3) / s.

    Parameters
    ----------
    simulated_radius : m, any shape, of the simulated contact
    simulated_modulus, true_modulus : effective moduli E* of the pair, Pa, > 0
    particle_scale : s, simulated over true diameter, -, > 0

    Hertz (1882): a = (3 F R / (4 E*))^(1/3). A particle scaled by s stands, at equal pressure, for s^2 true ones
    on the same area: F = F_sim / s^2, R = R_sim / s, hence a falls with s, and with the cube root of E*.

    Raises ValueError for a number that is not above 0.
    """
    for name, value in (
        ("simulated_modulus", simulated_modulus),
        ("true_modulus", true_modulus),
        ("particle_scale", particle_scale),
    ):
        if not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"{name} is {value}, allowed is a finite number above 0")
    return np.asarray(simulated_radius) * np.cbrt(simulated_modulus / true_modulus) / particle_scale


def chosen_radius(choice: str | float, simulated_radius: np.ndarray, physical_factor: float = 1.0) -> np.ndarray:
    """Contact radius (m) to spread with, NaN where there was no contact.

    Parameters
    ----------
    choice : "simulated" (as in the ledger), "physical" (times the factor), or a length in m, >= 0, for all contacts
    simulated_radius : (m,) m, ledger column `contact_radius_m`
    physical_factor : -, `physical_radius(1.0, ...)`

    Raises ValueError for another choice.
    """
    radius = np.asarray(simulated_radius, dtype=np.float64)
    if isinstance(choice, str):
        if choice not in ("simulated", "physical"):
            raise ValueError(f"patch is '{choice}', allowed are simulated, physical or a length in m")
        return radius * (physical_factor if choice == "physical" else 1.0)
    if not (np.isfinite(choice) and choice >= 0.0):
        raise ValueError(f"patch is {choice} m, allowed is a finite length >= 0 m")
    return np.where(np.isnan(radius), np.nan, float(choice))


def hertz_disc(rings: int) -> tuple[np.ndarray, np.ndarray]:
    """Quadrature of the patch on a contact of radius 1: points (q, 2) within sqrt(2), weights (q,) of sum 1.

    A lattice of equilateral triangles, `rings` spacings along the contact radius, about 7.3 rings^2 points; one ring
    means six points. The mean is exactly the centre, the mean of r^2 exactly that of the Hertz pressure, 2/5.
    """
    if rings == 1:
        angle = np.arange(6) * np.pi / 3.0
        return np.sqrt(0.4) * np.column_stack((np.cos(angle), np.sin(angle))), np.full(6, 1.0 / 6.0)
    steps = np.arange(-3 * rings, 3 * rings + 1)
    i, j = (index.ravel() for index in np.meshgrid(steps, steps))
    inside = i * i + i * j + j * j < 2 * rings * rings
    points = np.column_stack((i + 0.5 * j, np.sqrt(0.75) * j))[inside] / rings
    weights = _twice_spread(np.sqrt(2.0 * (points**2).sum(axis=1)))
    weights /= weights.sum()
    return points * np.sqrt(0.4 / (weights @ (points**2).sum(axis=1))), weights


def _twice_spread(distance: np.ndarray) -> np.ndarray:
    """Convolution of sqrt(1 - r^2) with itself, up to a factor; distance (q,) -, 0 to 2.

    sqrt(1 - r^2) is the shadow of a unit ball, so this is the shadow of what two of them have in common, the part
    1 - 3/4 s + s^3/16 at a distance s of their centres (Guinier and Fournet 1955), integrated over the height z with
    s^2 = r^2 + z^2.
    """
    top = np.sqrt(np.maximum(4.0 - distance**2, 0.0))
    slope = np.arcsinh(np.divide(top, distance, out=np.zeros_like(top), where=distance > 0.0))
    first = top + 0.5 * distance**2 * slope  # integral of s
    third = 2.0 * top + 0.75 * distance**2 * top + 0.375 * distance**4 * slope  # of s^3
    return np.maximum(top - 0.75 * first + third / 16.0, 0.0)


def barycentric_weights(points: np.ndarray, triangles: np.ndarray, position: np.ndarray) -> np.ndarray:
    """Weights (k, 3) of the corners that give each position (k, 3) m, projected on its triangle; sum 1.

    Parameters: points (n, 3) m, triangles (k, 3). Outside the triangle some are negative.
    """
    gradients = _hat_gradients(points, triangles)
    weights = np.einsum("kcx,kx->kc", gradients, position - points[triangles].mean(axis=1)) + 1.0 / 3.0
    return weights


def spread(
    points: np.ndarray,
    triangles: np.ndarray,
    worn_volume: np.ndarray,
    patch: ContactPatch,
    worn: np.ndarray | None = None,
) -> np.ndarray:
    """Worn volume at every corner of every triangle after spreading over the contact patches.

    Parameters
    ----------
    points : (n, 3) m
    triangles : (m, 3)
    worn_volume : (m,) m3, >= 0; ignored on faces that do not wear
    patch : position and radius per triangle; read where the volume is above 0
    worn : (m,) bool, faces that wear; None: all

    Returns
    -------
    (m, 3) m3, >= 0, for `postproc.wear.displacement.displace`. The sum is that of the volumes of the worn
    faces, to rounding. Row sums are the volume per face.

    What would fall beyond the rim, on faces that do not wear or on faces turned away by more than 60 degrees
    stays with the rest of its patch.

    Raises
    ------
    ValueError : a loaded triangle without a radius >= 0 or without a position on it or close to it.
    """
    worn = np.ones(len(triangles), dtype=bool) if worn is None else np.asarray(worn, dtype=bool)
    loaded = np.flatnonzero(worn & (np.asarray(worn_volume) > 0.0))
    weights = _positions_on(points, triangles, loaded, patch)
    volume = np.asarray(worn_volume, dtype=np.float64)[loaded]
    squares = (edge_lengths_per_triangle(points, triangles[loaded]) ** 2).sum(axis=1)
    radius = np.sqrt(np.maximum(np.asarray(patch.radius)[loaded] ** 2 - MESH_VARIANCE * squares, 0.0))
    rings = np.ceil(RINGS_PER_EDGE * radius / np.sqrt(squares / 3.0)).astype(np.int64).clip(0, MOST_RINGS)
    corner_volume = np.zeros(3 * len(triangles))
    sheet = _Sheet(points, triangles, worn) if rings.any() else None
    for count in np.unique(rings[rings > 0]):
        some = np.flatnonzero(rings == count)
        slopes = _disc_slopes(points, triangles[loaded[some]], radius[some])
        _spread_sources(
            *sheet.arrays, loaded[some], weights[some], slopes, volume[some], *hertz_disc(count), corner_volume
        )
    point = rings == 0
    corner_volume = corner_volume.reshape(-1, 3)
    corner_volume[loaded[point]] += volume[point, None] * weights[point]
    return corner_volume


def _disc_slopes(points, triangles, radius) -> np.ndarray:
    """Change (k, 3, 2) of the barycentric coordinates per `radius` (k,) m along two axes in each triangle.

    The first axis is the longest edge: a direction that no numbering of faces or corners changes.
    """
    corners = points[triangles]
    edges = np.roll(corners, -1, axis=1) - corners
    lengths = np.sqrt((edges**2).sum(axis=2))
    longest, rows = lengths.argmax(axis=1), np.arange(len(triangles))
    axis = edges[rows, longest] / lengths[rows, longest, None]
    axes = np.stack((axis, np.cross(unit_normals(points, triangles), axis)), axis=2)
    return _hat_gradients(points, triangles) @ (radius[:, None, None] * axes)


def _positions_on(points, triangles, loaded, patch: ContactPatch) -> np.ndarray:
    """Barycentric weights (k, 3) >= 0 of the contact positions of the loaded triangles; ValueError if missing.

    A position beside its triangle, as those of contacts at edges may be, is moved on to it.
    """
    radius = patch.radius[loaded]
    faulty = np.flatnonzero(~(np.isfinite(radius) & (radius >= 0.0)))
    if faulty.size:
        raise ValueError(
            f"triangle {loaded[faulty[0]]} is worn but its contact radius is {radius[faulty[0]]} m, allowed is >= 0 m"
        )
    weights = barycentric_weights(points, triangles[loaded], patch.position[loaded])
    faulty = np.flatnonzero(~(weights.min(axis=1) >= -OFF_TRIANGLE))
    if faulty.size:
        raise ValueError(
            f"triangle {loaded[faulty[0]]} is worn but its mean contact position "
            f"{patch.position[loaded[faulty[0]]]} m does not lie on it (another mesh, or another frame?)"
        )
    weights = np.maximum(weights, 0.0)
    return weights / weights.sum(axis=1, keepdims=True)


def _hat_gradients(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Gradients (k, 3, 3) in 1/m of the three barycentric coordinates within each triangle."""
    corners = points[triangles]
    opposite = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)  # from corner k + 1 to k + 2
    area = area_vectors(points, triangles)
    scale = 0.5 / np.maximum((area**2).sum(axis=1), np.finfo(float).tiny)
    return np.cross((scale[:, None] * area)[:, None], opposite)


class _Sheet:
    """Worn faces as half-edges: 3 f + k runs from corner k of face f to the next, its apex is the third corner.

    arrays : twin (3 m,), half-edge on the other side, -1 where a walk must end; across (3 m, 3), the apex unfolded
        into the twin's face, in barycentric coordinates of the twin's start, end and apex; normal (m, 3), unit normals
    """

    def __init__(self, points: np.ndarray, triangles: np.ndarray, worn: np.ndarray):
        tiny = np.finfo(float).tiny
        area = area_vectors(points, triangles)
        double_area = 2.0 * np.sqrt((area**2).sum(axis=1))
        twin = _twins(triangles, worn & (double_area > 0.0))
        double_area = np.maximum(double_area, tiny)
        edge = points[np.roll(triangles, -1, axis=1)] - points[triangles]
        to_apex = -np.roll(edge, 1, axis=1)  # from the start of each half-edge
        length = np.maximum(np.sqrt((edge**2).sum(axis=2)), tiny)
        along = ((edge * to_apex).sum(axis=2) / length).ravel()
        height, length = (double_area[:, None] / length).ravel(), length.ravel()
        apex = -height / height[twin]
        start = (along - apex * (length - along[twin])) / length
        across = np.column_stack((start, 1.0 - start - apex, apex))
        self.arrays = twin, across, 2.0 * area / double_area[:, None]


def _twins(triangles: np.ndarray, usable: np.ndarray) -> np.ndarray:
    """Opposite half-edge (3 m,) of each half-edge, -1 at a rim, at a face not usable and where more than two meet."""
    edges = directed_edges(triangles)
    low, high = edges.min(axis=1), edges.max(axis=1)
    key = np.where(np.repeat(usable, 3), low * (high.max(initial=0) + 1) + high, -1)
    order = np.argsort(key, kind="stable")
    ordered = key[order]
    starts = np.flatnonzero(np.diff(ordered, prepend=-2))
    size = np.diff(starts, append=len(ordered))
    first = starts[(size == 2) & (ordered[starts] >= 0)]
    twin = np.full(len(edges), -1)
    twin[order[first]], twin[order[first + 1]] = order[first + 1], order[first]
    return twin


@njit(cache=True)
def _spread_sources(twin, across, normal, face, start, slope, volume, disc, share, corner_volume) -> None:
    """Add to `corner_volume` (3 m,) in m3 what the patches of some sources leave at the corners of the faces.

    twin, across, normal : see `_Sheet`
    face (k,), start (k, 3), slope (k, 3, 2), volume (k,) m3 : touched faces, barycentric contact positions, their
        change per contact radius along two axes, worn volumes
    disc (q, 2), share (q,) : quadrature of the patch

    Barycentric coordinates here are those of start, end and apex of a half-edge. A walk leaves a face through the edge
    that has the longest way still to go behind it. Numba, because every walk crosses edges of its own number.
    """
    corner, weight = np.empty((len(share), 3), np.int64), np.empty((len(share), 3))
    end, travel, beyond = np.empty(3), np.empty(3), np.empty(3)
    for k in range(len(face)):
        count, total = 0, 0.0
        for q in range(len(share)):
            for c in range(3):
                travel[c] = slope[k, c, 0] * disc[q, 0] + slope[k, c, 1] * disc[q, 1]
                end[c] = start[k, c] + travel[c]
            here = _walk(twin, across, normal, face[k], end, travel, beyond)
            if here < 0:
                continue
            sum_end = max(end[0], 0.0) + max(end[1], 0.0) + max(end[2], 0.0)
            for c in range(3):
                corner[count, c] = here - here % 3 + (here + c) % 3
                weight[count, c] = share[q] * max(end[c], 0.0) / sum_end
            total += share[q]
            count += 1
        for c in range(3):
            if count == 0:
                corner_volume[3 * face[k] + c] += volume[k] * start[k, c]
            for q in range(count):
                corner_volume[corner[q, c]] += volume[k] * weight[q, c] / total


@njit(cache=True)
def _walk(twin, across, normal, face, end, travel, beyond) -> int:
    """Half-edge of the face in which a walk ends, -1 where its way is barred; `end` is left in its coordinates."""
    here = 3 * face
    for _ in range(MOST_CROSSINGS):
        for c in range(3):
            beyond[c] = end[c] / travel[c] if end[c] < 0.0 and travel[c] < 0.0 else 0.0
        out = np.argmax(beyond)
        if beyond[out] <= 0.0:
            return here
        crossed = here - here % 3 + (here + out + 1) % 3
        here = twin[crossed]
        if here < 0:
            return -1
        there = here // 3
        facing = normal[face, 0] * normal[there, 0] + normal[face, 1] * normal[there, 1]
        if facing + normal[face, 2] * normal[there, 2] < LEAST_FACING_COSINE:
            return -1
        for line in (end, travel):
            lever, first, second = line[out], line[(out + 2) % 3], line[(out + 1) % 3]
            line[0] = first + across[crossed, 0] * lever
            line[1] = second + across[crossed, 1] * lever
            line[2] = across[crossed, 2] * lever
    return -1
