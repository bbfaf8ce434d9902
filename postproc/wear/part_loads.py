"""What particles do to the parts of a mesh, from its load ledger: mean force and torque, and the power of the drive."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from bulkwear.postproc.wear.ledger import vector_columns


def part_loads(
    columns: Mapping[str, np.ndarray], corners: np.ndarray, part: np.ndarray, duration_s: float, about=(0.0, 0.0, 0.0)
) -> dict[str, np.ndarray]:
    """Return the loads on every part, means over the duration: a table with one entry per part in each column.

    columns: of a ledger, with impulse, moment and drive_work_J
    corners: (m, 3, 3) m, of the facets in the ledger's frame, that of the mesh's file
    part: (m,) label of each facet; duration_s: that the ledger was summed over
    about: (3,) m, the point that the torques are about, in the same frame
    Returns
    part: (k,) the labels, sorted
    force_x_N, force_y_N, force_z_N: (k,) on the part
    torque_x_N_m, torque_y_N_m, torque_z_N_m: (k,) on the part, the sum of (centroid - about) x impulse + moment of its
        facets; about another point it differs by the distance of the points times the force
    power_W: (k,) that the part's motion gives to the particles: what its drive has to bring

    On a part that turns, force and torque are those in its own turning frame. Raises KeyError when a column is
    missing, ValueError for a duration that is not above 0.
    """
    if not duration_s > 0.0:
        raise ValueError(f"the duration of a ledger is {duration_s} s, allowed is a number above 0")
    labels, of_facet = np.unique(part, return_inverse=True)
    impulse, moment = (np.column_stack([columns[field] for field in vector_columns(n)]) for n in ("impulse", "moment"))
    angular_impulse = np.cross(corners.mean(axis=1) - np.asarray(about), impulse) + moment

    def mean_of(values: np.ndarray) -> np.ndarray:
        return np.bincount(of_facet, values, labels.size) / duration_s

    forces = {f"force_{axis}_N": mean_of(impulse[:, k]) for k, axis in enumerate("xyz")}
    torques = {f"torque_{axis}_N_m": mean_of(angular_impulse[:, k]) for k, axis in enumerate("xyz")}
    return {"part": labels, **forces, **torques, "power_W": mean_of(columns["drive_work_J"])}
