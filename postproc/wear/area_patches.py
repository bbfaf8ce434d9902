"""Area patches of a surface: faces together that lie near one another and look alike, about as large as a square.

Wear of single triangles scatters from cycle to cycle; that of a patch is a mean over many contacts. A patch belongs to
one part. Faces are points of six dimensions, centroid over length and weighted normal. Centres cover them, the farthest
face being the next centre (T. F. Gonzalez, Theor. Comput. Sci. 38, 1985), then move to the means of their faces
(S. Lloyd, IEEE Trans. Inf. Theory 28, 1982): that evens the patches out and takes centres off the rims.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial import cKDTree

from bulkwear.postproc.mesh import (
    SurfaceMesh,
    areas,
    centroids,
    edge_lengths_per_triangle,
    unit_normals,
    worn_faces,
)
from bulkwear.postproc.wear.side import turned_as

REACH = math.sqrt(0.5)  # -, of the length, from a centre to its faces: half the diagonal of a square
ALIKE_DEGREES = 45.0  # between two normals of a patch at most; those of a box's sides are 90 apart
NORMAL_WEIGHT = REACH / (2.0 * math.sin(math.radians(ALIKE_DEGREES / 4.0)))  # half of that angle is as far as REACH
EVENING_STEPS = 3  # of Lloyd's: most of what it does to areas comes with the first two
SMALLEST_AREA = 0.25  # -, of length squared: half of half; smaller patches are merged


def area_patches(mesh: SurfaceMesh, length_m: float) -> np.ndarray:
    """Number (m,) of each face's patch, -1 on faces that do not wear (`part` < 0).

    Patches hold faces of one part, within about `length_m` of one another and with normals that differ by about
    ALIKE_DEGREES at most: front and back of a thin plate are two patches. A patch below SMALLEST_AREA goes to the
    nearest one of its part whose mean normal differs by less than that, where the centre of one is within REACH.
    Numbers run from 0, part by part, in the order of each patch's first face.
    Raises ValueError unless the length is above 0.
    """
    if not (math.isfinite(length_m) and length_m > 0.0):
        raise ValueError(f"the length of area patches is {length_m:g} m, allowed is a finite length above 0")
    part, features = _parts(mesh), _features(mesh, length_m)
    area = areas(mesh.points, mesh.triangles) / length_m**2
    numbers, start = np.full(len(part), -1, dtype=np.int64), 0
    for label in np.unique(part[part >= 0]):
        faces = np.flatnonzero(part == label)
        groups = _merged(_covered(features[faces], area[faces]), features[faces], area[faces])
        numbers[faces] = start + _in_order(groups)
        start = int(numbers[faces].max()) + 1
    return numbers


def patches_of(mesh: SurfaceMesh, pristine: SurfaceMesh, patches: np.ndarray) -> np.ndarray:
    """Number (k,) of the patch of each face of a worn or remeshed surface, -1 on faces that do not wear.

    Each face has the patch of the pristine face of its part that is nearest, places over the mean size of that part's
    patches and normals weighted as in `area_patches`, which look the way they do in `mesh`, where pieces may have been
    turned. mesh, pristine: in one body frame; patches: as from `area_patches`, of the pristine faces.
    Raises ValueError for patches of another surface, or for a part that the pristine surface has not.
    """
    _check_patches(pristine, patches)
    pristine = turned_as(pristine, mesh)
    part, known = _parts(mesh), np.where(patches >= 0, _parts(pristine), -1)
    area = areas(pristine.points, pristine.triangles)
    numbers = np.full(len(part), -1, dtype=np.int64)
    for label in np.unique(part[part >= 0]):
        faces, there = np.flatnonzero(part == label), np.flatnonzero(known == label)
        if not len(there):
            raise ValueError(f"part {label} wears and has no face with a patch, allowed are parts of the first surface")
        length = math.sqrt(area[there].sum() / len(np.unique(patches[there])))
        tree = cKDTree(_features(pristine, length)[there])
        numbers[faces] = patches[there[tree.query(_features(mesh, length)[faces])[1]]]
    return numbers


def patch_table(mesh: SurfaceMesh, patches: np.ndarray) -> dict[str, np.ndarray]:
    """Columns (count,) of the patches, in the order of their numbers: ready for a table.

    patch, part; x_m, y_m, z_m: area-weighted centroid; normal_x, normal_y, normal_z: unit mean normal, 0 where normals
    cancel; area_m2; edge_m: mean edge of the faces. Patches without a face are left out.
    Raises ValueError for patches of another surface.
    """
    _check_patches(mesh, patches)
    inside = np.flatnonzero(patches >= 0)
    names, group = np.unique(patches[inside], return_inverse=True)
    area = areas(mesh.points, mesh.triangles)[inside]
    whole = np.bincount(group, area, len(names))
    faces = np.bincount(group, minlength=len(names))
    centre = _group_means(centroids(mesh.points, mesh.triangles)[inside], area, group, len(names))
    normal = _group_means(_finite_normals(mesh)[inside], area, group, len(names))
    normal = _unit(normal)
    edge = edge_lengths_per_triangle(mesh.points, mesh.triangles)[inside].mean(axis=1)
    part = np.zeros(len(names), dtype=np.int64)
    part[group] = _parts(mesh)[inside]
    columns = {"patch": names.astype(np.int64), "part": part}
    columns |= {f"{axis}_m": centre[:, k] for k, axis in enumerate("xyz")}
    columns |= {f"normal_{axis}": normal[:, k] for k, axis in enumerate("xyz")}
    return columns | {"area_m2": whole, "edge_m": np.bincount(group, edge, len(names)) / faces}


def patch_sums(values: np.ndarray, patches: np.ndarray, count: int) -> np.ndarray:
    """Sum (count,) of the values (m,) of each patch's faces; faces without a patch are left out."""
    inside = patches >= 0
    return np.bincount(patches[inside], np.asarray(values, dtype=np.float64)[inside], count)


def patch_means(values: np.ndarray, area_m2: np.ndarray, patches: np.ndarray, count: int) -> np.ndarray:
    """Mean (count,) over each patch of the values (m,) of its faces, by their area (m,); faces whose value is NaN are
    left out, and a patch without any other has NaN.
    """
    known = np.isfinite(values)
    whole = patch_sums(np.where(known, area_m2, 0.0), patches, count)
    total = patch_sums(np.where(known, values, 0.0) * area_m2, patches, count)
    return np.divide(total, whole, out=np.full(count, np.nan), where=whole > 0.0)


def _parts(mesh: SurfaceMesh) -> np.ndarray:
    """Label (m,) of each face's part, -1 on faces that do not wear; 0 where the mesh has no parts."""
    part = np.asarray(mesh.cell_data.get("part", np.zeros(len(mesh.triangles))), dtype=np.int64)
    return np.where(worn_faces(mesh), part, -1)


def _finite_normals(mesh: SurfaceMesh) -> np.ndarray:
    """Unit normals (m, 3), 0 of faces without area."""
    return np.nan_to_num(unit_normals(mesh.points, mesh.triangles))


def _features(mesh: SurfaceMesh, length: float) -> np.ndarray:
    """Places over a length and weighted normals (m, 6) of the faces."""
    return np.column_stack([centroids(mesh.points, mesh.triangles) / length, NORMAL_WEIGHT * _finite_normals(mesh)])


def _covered(features: np.ndarray, area: np.ndarray) -> np.ndarray:
    """Group (m,) of each face: the nearest centre, after centres cover all faces within REACH and are evened out."""
    tree = cKDTree(features)
    chosen, distance = [0], np.linalg.norm(features - features[0], axis=1)
    while distance[farthest := int(np.argmax(distance))] > REACH:
        chosen.append(farthest)
        near = np.asarray(tree.query_ball_point(features[farthest], distance[farthest]))  # others stay as they are
        distance[near] = np.minimum(distance[near], np.linalg.norm(features[near] - features[farthest], axis=1))
    centres = features[chosen]
    group = cKDTree(centres).query(features)[1]
    for _ in range(EVENING_STEPS):
        centres = _group_means(features, area, group, len(centres), otherwise=centres)
        group = cKDTree(centres).query(features)[1]
    return group


def _merged(group: np.ndarray, features: np.ndarray, area: np.ndarray) -> np.ndarray:
    """Groups (m,) after those below SMALLEST_AREA, the smallest first, went to the nearest one that looks alike."""
    count = int(group.max()) + 1
    centre = _group_means(features, area, group, count)
    whole = np.bincount(group, area, count)
    there = np.bincount(group, minlength=count) > 0
    target, alone = np.arange(count), ~there
    while ((whole < SMALLEST_AREA) & ~alone).any():
        smallest = int(np.argmin(np.where(alone, np.inf, whole)))
        normals = _unit(centre[:, 3:])
        alike = normals @ normals[smallest] > math.cos(math.radians(ALIKE_DEGREES))
        near = np.linalg.norm(centre[:, :3] - centre[smallest, :3], axis=1) <= REACH
        allowed = there & alike & near
        allowed[smallest] = False
        if not allowed.any():
            alone[smallest] = True
            continue
        distance = np.linalg.norm(centre - centre[smallest], axis=1)
        other = int(np.argmin(np.where(allowed, distance, np.inf)))
        both = whole[[smallest, other]]
        weights = both / both.sum() if both.sum() > 0.0 else np.array([0.5, 0.5])
        centre[other] = weights @ centre[[smallest, other]]
        whole[other] = both.sum()
        target[target == smallest] = other
        there[smallest], alone[smallest] = False, True
    return target[group]


def _group_means(
    values: np.ndarray, weights: np.ndarray, group: np.ndarray, count: int, otherwise: np.ndarray | float = 0.0
) -> np.ndarray:
    """Weighted means (count, p) of the values (m, p) of each group; `otherwise` of groups without weight."""
    whole = np.bincount(group, weights, count)[:, None]
    sums = np.column_stack([np.bincount(group, weights * column, count) for column in values.T])
    return np.where(whole > 0.0, sums / np.where(whole > 0.0, whole, 1.0), otherwise)


def _unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors (k, 3) over their lengths; 0 stays 0."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0.0)


def _in_order(group: np.ndarray) -> np.ndarray:
    """Groups (m,) numbered from 0 in the order of their first faces."""
    _, first, inverse = np.unique(group, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[inverse]


def _check_patches(mesh: SurfaceMesh, patches: np.ndarray) -> None:
    if np.shape(patches) != (len(mesh.triangles),):
        raise ValueError(f"found patches of {np.size(patches)} faces, allowed is one of each of {len(mesh.triangles)}")
