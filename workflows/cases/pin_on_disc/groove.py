"""Section of a worn groove: its profile, its depth, and the width that holds a share of its area."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from postproc.mesh import SurfaceMesh

AREA_SHARE = 0.95  # -, of the section's area: the width that holds it does not hang on where the rim fades out
PROFILE_POINTS = 2001  # of the profile between the ends of the section


def section_profile(mesh: SurfaceMesh, y: float, x: np.ndarray) -> np.ndarray:
    """Depth (k,) m of a surface under z = 0 in the plane across the track at `y` (m), at the places `x` (k,) m.

    For surfaces that lie over the plane z = 0 without overhang; depth >= 0 is below it, beyond the surface it is 0.
    Raises ValueError when the plane misses the surface.
    """
    corners = mesh.points[mesh.triangles]
    side = corners[:, :, 1] - y
    cut = (side < 0.0) != (np.roll(side, -1, axis=1) < 0.0)  # edges that the plane cuts: none or two of each triangle
    if not cut.any():
        raise ValueError(f"the plane at y = {y} m misses the surface, allowed is a plane that cuts it")
    start, end = corners[cut], np.roll(corners, -1, axis=1)[cut]
    share = ((y - start[:, 1]) / (end[:, 1] - start[:, 1]))[:, None]
    crossing = (1.0 - share) * start + share * end
    order = np.argsort(crossing[:, 0], kind="stable")
    return np.interp(x, crossing[order, 0], -crossing[order, 2], left=0.0, right=0.0)


def width_of_area(x: np.ndarray, depth: np.ndarray, share: float = AREA_SHARE) -> float:
    """Width (m) that holds a share of the area of a section, the rest lying half on either side.

    x : (k,) m, increasing; depth : (k,) m, >= 0, linear between the places.
    Raises ValueError for a share that is not between 0 and 1, and for a section without area.
    """
    if not 0.0 < share < 1.0:
        raise ValueError(f"share of the area is {share}, allowed is above 0 and below 1")
    pieces = 0.5 * (depth[1:] + depth[:-1]) * np.diff(x)
    area = np.concatenate([[0.0], np.cumsum(pieces)])
    if not area[-1] > 0.0:
        raise ValueError("the section has no area, allowed is one that is worn")
    left, right = np.interp((0.5 * (1.0 - share), 0.5 * (1.0 + share)), area / area[-1], x)
    return float(right - left)


def mean_section(mesh: SurfaceMesh, places: np.ndarray) -> dict[str, float]:
    """Mean over sections at `places` (k,) m along the track: `depth_m` (deepest point), `width_m`, `area_m2`.

    Raises ValueError as `section_profile` and `width_of_area`.
    """
    x = np.linspace(mesh.points[:, 0].min(), mesh.points[:, 0].max(), PROFILE_POINTS)
    depths = [section_profile(mesh, y, x) for y in places]
    return {
        "depth_m": float(np.mean([depth.max() for depth in depths])),
        "width_m": float(np.mean([width_of_area(x, depth) for depth in depths])),
        "area_m2": float(np.mean([np.trapezoid(depth, x) for depth in depths])),
    }


def stroke_table(strokes: pd.DataFrame, shown: Sequence[tuple[str, int]]) -> pd.DataFrame:
    """Return one row per scheme, chosen stroke and mesh: depth, width and volumes after that many strokes.

    strokes: one row per `scheme`, `edges_per_width` and `stroke`; of this stroke `depth_m`, `width_m`, `work_J` and
        `load_times_distance_J`; since the start `removed_volume_m3`, `carried_volume_m3` and `law_volume_m3`
    shown: pairs of scheme and number of strokes, in the order of the rows, the coarsest mesh first
    """
    parts = [strokes[(strokes["scheme"] == scheme) & (strokes["stroke"] == number)] for scheme, number in shown]
    chosen = pd.concat([part.sort_values("edges_per_width") for part in parts], ignore_index=True)
    law = chosen["law_volume_m3"]
    return pd.DataFrame(
        {
            "scheme": chosen["scheme"],
            "strokes": chosen["stroke"],
            "edges_per_width": chosen["edges_per_width"],
            "depth_um": 1e6 * chosen["depth_m"],
            "width_mm": 1e3 * chosen["width_m"],
            "removed_over_archard": chosen["removed_volume_m3"] / law,
            "accounted_over_archard": (chosen["removed_volume_m3"] + chosen["carried_volume_m3"]) / law,
            "work_over_load_times_distance": chosen["work_J"] / chosen["load_times_distance_J"],
        }
    )


def largest_differences(table: pd.DataFrame) -> pd.DataFrame:
    """Return, per scheme and number of strokes, how far depth and width differ between meshes, largest over least - 1.

    table: as from `stroke_table`; columns `depth_difference` and `width_difference`, -
    """
    grouped = table.groupby(["scheme", "strokes"])[["depth_um", "width_mm"]]
    ratio = grouped.max() / grouped.min() - 1.0
    return ratio.set_axis(["depth_difference", "width_difference"], axis=1).reset_index()
