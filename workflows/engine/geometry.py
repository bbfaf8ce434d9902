"""Which builder of meshes/ makes a run's surface."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from meshes.pattern import ConvexPattern
from meshes.sample import sliding_sample
from postproc.mesh import SurfaceMesh


def convex_pattern(pattern: Mapping[str, Any] | None) -> ConvexPattern | None:
    """Return the pattern of a run's parameters (SI); None for a plain plate."""
    if pattern is None:
        return None
    return ConvexPattern(
        major_radius=pattern["major_radius_m"],
        minor_radius=pattern["minor_radius_m"],
        height=pattern["height_m"],
        row_spacing=pattern["row_spacing_m"],
        column_spacing=pattern["column_spacing_m"],
        major_axis=pattern["major_axis"],
        row_offset=pattern["row_offset_fraction"],
    )


def sample_surface(sample: Mapping[str, Any], pattern: Mapping[str, Any] | None) -> SurfaceMesh:
    """Return the pristine surface of a sliding sample with its skirt; sections of a run's parameters, SI."""
    return sliding_sample(
        sample["width_m"],
        sample["length_m"],
        sample["element_size_m"],
        convex_pattern(pattern),
        sample["height_above_floor_m"],
        sample["skirt_slope_rad"],
        sample["skirt_radius_m"],
    )
