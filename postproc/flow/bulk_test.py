"""What a bulk test is measured by: angles of its slopes, discharge time, wall friction, each with an uncertainty.

Responses carry their units, as table headers do: `shear_angle_deg` of a shear box; `draw_down_shear_angle_deg` (upper
slopes), `repose_angle_deg` (lower heap) and `discharge_time_s` of a draw-down test; `wall_friction_angle_deg` of a wall
shear test.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from bulkwear.postproc.flow.bed import read_snapshot
from bulkwear.postproc.flow.free_surface import Slope, fitted_slope, surface_points
from bulkwear.postproc.flow.outflow import check_count, check_not_blocked, discharge_time, outflow_curve
from bulkwear.postproc.flow.wall_shear import wall_friction_angle

HEAP, LOG = "heap.dump", "log.liggghts"


@dataclass(frozen=True)
class Boxes:
    """What of a test's geometry its measurement needs, m.

    length: between the walls along y; width: across; opening: of a draw-down test, 0 without; diameter: median particle
    spheres: of a particle; clumps of several that flow out of a shear box lie in a pit below it, others are taken out
    """

    length: float
    width: float
    diameter: float
    opening: float = 0.0
    spheres: int = 1


@dataclass(frozen=True)
class Measurement:
    """Responses of a test, their uncertainties in the same units, and by response the slopes behind an angle.

    blocked: packings of this test that an arch blocked before one flowed
    """

    responses: Mapping[str, float]
    uncertainties: Mapping[str, float]
    slopes: Mapping[str, Sequence[Slope]]
    blocked: int = 0


def measured_shear_box(folder: Path, boxes: Boxes, time_step: float) -> Measurement:
    """Return the shear angle of a finished shear box. Raises FreeSurfaceError, OutflowError."""
    check_count(outflow_curve(folder / LOG, time_step, boxes.spheres), boxes.spheres == 1, folder / LOG)
    heap = read_snapshot(folder / HEAP)
    slopes = {"shear_angle_deg": [slope_between(heap[heap["z_m"] > 0.0], boxes, 0.0, boxes.length)]}
    return _of_slopes(slopes, {}, {})


def measured_draw_down(folder: Path, boxes: Boxes, time_step: float) -> Measurement:
    """Return both angles, each of two slopes, and the discharge time of a draw-down test. Raises as the shear box."""
    curve = outflow_curve(folder / LOG, time_step, boxes.spheres)
    check_count(curve, False, folder / LOG)
    check_not_blocked(curve, folder / LOG)
    particles = read_snapshot(folder / HEAP)
    upper, lower = particles[particles["z_m"] > 0.0], particles[particles["z_m"] <= 0.0]
    middle, edge = boxes.length / 2.0, boxes.opening / 2.0
    slopes = {
        "draw_down_shear_angle_deg": [
            slope_between(upper, boxes, 0.0, middle - edge),
            slope_between(upper, boxes, middle + edge, boxes.length),
        ],
        "repose_angle_deg": [
            slope_between(lower, boxes, 0.0, middle),
            slope_between(lower, boxes, middle, boxes.length),
        ],
    }
    seconds, uncertainty = discharge_time(curve)
    return _of_slopes(slopes, {"discharge_time_s": seconds}, {"discharge_time_s": uncertainty})


def measured_wall_shear(folder: Path, boxes: Boxes, time_step: float) -> Measurement:
    """Return the wall friction angle of a finished wall shear test. Raises WallShearError."""
    angle, uncertainty = wall_friction_angle(folder / LOG)
    name = "wall_friction_angle_deg"
    return Measurement({name: math.degrees(angle)}, {name: math.degrees(uncertainty)}, {})


# Kind of test -> its measurement, and the responses it gives.
MEASUREMENTS = {
    "shear_box": measured_shear_box,
    "draw_down": measured_draw_down,
    "wall_shear": measured_wall_shear,
}
RESPONSES = {
    "shear_box": ("shear_angle_deg",),
    "draw_down": ("draw_down_shear_angle_deg", "repose_angle_deg", "discharge_time_s"),
    "wall_shear": ("wall_friction_angle_deg",),
}


def slope_between(particles: pd.DataFrame, boxes: Boxes, start: float, end: float) -> Slope:
    """Return the slope of a heap's free surface between two y (m)."""
    return fitted_slope(surface_points(particles, boxes.width, boxes.diameter), start, end, boxes.diameter)


def _of_slopes(
    slopes: Mapping[str, Sequence[Slope]], responses: Mapping[str, float], uncertainties: Mapping[str, float]
) -> Measurement:
    """Return the measurement with the mean angle of each response's slopes.

    Its uncertainty is that of the mean of the fits, or half the difference of the two sides where that is larger.
    """
    angles = {name: [math.degrees(slope.angle_rad) for slope in found] for name, found in slopes.items()}
    fits = {
        name: math.degrees(math.hypot(*(slope.uncertainty_rad for slope in found))) / len(found)
        for name, found in slopes.items()
    }
    sides = {name: (max(found) - min(found)) / 2.0 for name, found in angles.items()}
    return Measurement(
        {name: sum(found) / len(found) for name, found in angles.items()} | dict(responses),
        {name: max(fits[name], sides[name]) for name in angles} | dict(uncertainties),
        slopes,
    )


def slope_table(measurement: Measurement) -> list[dict[str, Any]]:
    """Return one row per slope: response, angle and uncertainty in degrees, stretch used in mm, curvature, points."""
    return [
        {
            "response": name,
            "angle_deg": math.degrees(slope.angle_rad),
            "uncertainty_deg": math.degrees(slope.uncertainty_rad),
            "start_mm": 1e3 * slope.start_m,
            "end_mm": 1e3 * slope.end_m,
            "height_at_start_mm": 1e3 * slope.height_at_start_m,
            "gradient": slope.gradient,
            "curvature_deg": math.degrees(slope.curvature_rad),
            "surface_points": slope.cells,
        }
        for name, found in measurement.slopes.items()
        for slope in found
    ]
