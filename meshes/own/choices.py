"""Refuse choices that make no sense, before any work is done: lengths, angles, regions, weld tolerance and edges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bulkwear.meshes.own.refine import LONGEST_OVER_TARGET, Ball, Box, NearPlaces, Region, check_count
from bulkwear.meshes.own.solids import OTHERS, Solids
from bulkwear.meshes.own.weld import weld_tolerance
from bulkwear.postproc.mesh import areas, edge_lengths_per_triangle

COARSEST_WELD = 0.1  # -, of the smallest target edge: a larger weld tolerance would eat what is wanted
COARSEST_WELD_OF_SIZE = 0.01  # -, of the largest extent: a larger weld tolerance would eat the body
LARGEST_ANGLE = 45.0  # degrees, wanted as the smallest: halved triangles are not better than half a square


def check_choices(
    edges: Mapping[str, float] | float | None, fine: Sequence[Region], weld_m: float | None, smallest_angle_deg: float
) -> None:
    """Raise ValueError for a choice of `own_mesh` that is no length, no angle or no region."""
    given = edges if isinstance(edges, Mapping) else {} if edges is None else {OTHERS: edges}
    for name, edge in given.items():
        _check_length(f"the target edge of {'all parts' if name == OTHERS else repr(name)}", edge)
    if weld_m is not None:
        _check_length("the weld tolerance", weld_m)
    if not 0.0 <= smallest_angle_deg <= LARGEST_ANGLE:
        raise ValueError(
            f"the wanted smallest angle is {smallest_angle_deg:g} degrees, allowed are 0 to {LARGEST_ANGLE:g}"
        )
    for words, region in _regions(fine).items():
        _check_region(words, region)


def _check_length(words: str, length: float) -> None:
    """Raise ValueError for what is no length (m)."""
    if not 0.0 < length < np.inf:
        raise ValueError(f"{words} is {length:g} m, allowed is a finite length above 0")


def _regions(fine: Sequence[Region]) -> dict[str, Ball | Box | NearPlaces]:
    """Regions with a target edge of their own, by kind and number."""
    return {
        f"{type(region).__name__.lower()} {number}": region
        for number, region in enumerate(fine, start=1)
        if isinstance(region, (Ball, Box, NearPlaces))
    }


def _check_region(words: str, region: Ball | Box | NearPlaces) -> None:
    """Raise ValueError for a region that is nowhere or has no target edge."""
    _check_length(f"the target edge of {words}", region.edge_m)
    if not isinstance(region, Box):
        _check_length(f"the radius of {words}", region.radius_m)
    if isinstance(region, Ball) and not np.isfinite(region.centre_m).all():
        raise ValueError(f"the centre of {words} is {region.centre_m} m, allowed are finite numbers")
    if isinstance(region, Box) and not (np.isfinite(region.low_m) & np.less_equal(region.low_m, region.high_m)).all():
        raise ValueError(
            f"the corners of {words} are {region.low_m} and {region.high_m} m, allowed are finite numbers, the lower "
            "corner first"
        )


def checked_tolerance(solids: Solids, targets: np.ndarray, fine: Sequence[Region], weld_m: float | None) -> float:
    """Weld tolerance (m), the one that is given or the surface's own.

    solids: in m; targets: (parts,) m, target edges, infinite: none. Raises ValueError where tolerance and target edges
    do not go together.
    """
    wanted = {f"part '{name}'": float(edge) for name, edge in zip(solids.names, targets, strict=True)}
    wanted |= {words: region.edge_m for words, region in _regions(fine).items()}
    finest = min(wanted, key=wanted.__getitem__)
    of_edge = COARSEST_WELD * wanted[finest]
    if weld_m is None:
        tolerance = weld_tolerance(solids.points)
        if not tolerance <= of_edge:
            raise ValueError(
                f"{solids.source}: the target edge of {finest} is {wanted[finest]:g} m, allowed are "
                f"{tolerance / COARSEST_WELD:g} m or more, {1.0 / COARSEST_WELD:g} weld tolerances"
            )
    else:
        tolerance = weld_m
        of_size = COARSEST_WELD_OF_SIZE * float(np.linalg.norm(np.ptp(solids.points, axis=0)))
        most, reason = min(
            (of_size, f"{100.0 * COARSEST_WELD_OF_SIZE:g} % of the largest extent"),
            (of_edge, f"{100.0 * COARSEST_WELD:g} % of the target edge of {finest}"),
        )
        if tolerance > most:
            raise ValueError(
                f"{solids.source}: the weld tolerance is {tolerance:g} m, allowed is above 0 and up to {most:g} m, "
                f"{reason}"
            )
    return tolerance


def check_long_faces(solids: Solids, targets: np.ndarray) -> None:
    """Raise ValueError where triangles, in m, will be too many once they have the target edges (parts,) m."""
    target = targets[solids.part]
    long = edge_lengths_per_triangle(solids.points, solids.triangles).max(axis=1) > LONGEST_OVER_TARGET * target
    area = np.bincount(solids.part[long], areas(solids.points, solids.triangles[long]), len(targets))
    check_count(solids.source, solids.names, area, targets)
