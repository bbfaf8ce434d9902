"""A worn sample of known wear, and what a scanner would see of it: noise, a hole, outliers, axes of its own."""

import math
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bulkwear.meshes.pattern import ConvexPattern
from bulkwear.meshes.sample import sliding_sample
from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.scans import registration
from bulkwear.postproc.scans.start import RigidMotion, points_on

SIDE, ELEMENT, HEIGHT = 0.06, 1.5e-3, 3e-3  # m
PATTERN = ConvexPattern(8e-3, 2e-3, 6e-3, 20e-3, 20e-3)
NOISE = 20e-6  # m, accuracy of the scanner of Yan 2022
BASE_LOSS, CREST_LOSS = 50e-6, 250e-6  # m, vertically
OUTLIERS = 0.05  # -, of the points
HOLE, HOLE_RADIUS = (0.012, 0.015), 6e-3  # m
RIM = 1e-4  # m, beside the rim nothing wears, so that no slit opens


def pristine_sample(pattern=PATTERN):
    """Sample of 60 x 60 mm in a holder with ramps of 30 degrees."""
    return sliding_sample(SIDE, SIDE, ELEMENT, pattern, HEIGHT, math.radians(30.0))


def vertical_loss(places):
    """Loss (k,) m at places (k, 3) m: even on the base, growing to the crests, most where the bed arrives."""
    inside = np.abs(places[:, :2]).max(axis=1) < SIDE / 2 - RIM
    share = np.maximum(places[:, 2] - HEIGHT, 0.0) / PATTERN.height * (0.5 - places[:, 1] / SIDE)
    return np.where(inside, BASE_LOSS + CREST_LOSS * share, 0.0)


def worn_sample(pristine, factor=1.0):
    """The sample after `factor` times the known loss."""
    loss = factor * vertical_loss(pristine.points)
    return SurfaceMesh(pristine.points - loss[:, None] * (0.0, 0.0, 1.0), pristine.triangles, pristine.cell_data)


def any_motion(seed):
    """A rotation of any kind and a shift of up to a metre."""
    shift = np.random.default_rng(seed).uniform(-1.0, 1.0, 3)
    return RigidMotion(Rotation.random(random_state=seed).as_matrix(), shift)


def scan_of(mesh, motion, count=60_000, noise=NOISE, outliers=OUTLIERS, hole=True, seed=0):
    """Points (k, 3) m of a surface with noise, a hole and outliers, moved and shuffled."""
    generator = np.random.default_rng(seed)
    points = points_on(mesh, count, generator)[0]
    points += generator.normal(0.0, noise, points.shape)
    if hole:
        points = points[np.linalg.norm(points[:, :2] - HOLE, axis=1) > HOLE_RADIUS]
    loose = generator.uniform(-SIDE, SIDE, (int(outliers * count), 3))
    return motion(generator.permutation(np.concatenate([points, loose])))


def leading_edge(motion):
    """A scanned place near the middle of the edge that meets the bed, not exactly there."""
    return motion(np.array([[2e-3, -SIDE / 2 + 1e-3, HEIGHT]]))[0]


@contextmanager
def rough_positions_once() -> Iterator[None]:
    """Look for rough positions, most of the work of a registration, once per scan and surface."""
    look, found = registration.rough_positions, {}

    def remembered(scan, mesh):
        key = scan.tobytes(), mesh.points.tobytes()
        if key not in found:
            found[key] = look(scan, mesh)
        return found[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(registration, "rough_positions", remembered)
        yield
