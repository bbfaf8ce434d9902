"""The free surface of a heap, found from its particles, and the angle of a slope on it, by a robust fit.

The surface is what a scanner above the heap would see: over every point of a fine raster the highest point of any
particle there. Its median over square cells of one particle diameter gives one point per cell; cells are wider than
the roughness is correlated, so their points count as independent.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

RASTER_DIAMETERS = 0.1  # -, step of the raster in median diameters; spheres are then resolved to 1 % of a diameter
CELL_DIAMETERS = 1.0  # -, edge of the cells whose medians are fitted
END_DIAMETERS = 1.0  # -, next to a wall or an edge the order of particles is the wall's; left out
LOWEST_SHARE, HIGHEST_SHARE = 0.10, 0.95  # -, of the slope's height: below is the toe, above the crest
LEAST_COLUMNS = 4  # of cells along the slope; with fewer there is no slope to speak of
ONE_SIGMA = 0.683  # -, confidence of an interval of plus and minus one standard deviation


class FreeSurfaceError(ValueError):
    """A heap on which no slope can be measured; the message says what was found and what is needed."""


@dataclass(frozen=True)
class Slope:
    """A straight slope fitted to a stretch of a free surface.

    angle_rad: against the horizontal, positive; uncertainty_rad: its standard uncertainty from the scatter of the cells
    start_m, end_m: the stretch used, along y; height_at_start_m: of the fitted line, gradient its tangent with its sign
    curvature_rad: angle of the upper half of the stretch minus that of the lower half, 0 on a straight slope
    cells: number of surface points fitted
    """

    angle_rad: float
    uncertainty_rad: float
    start_m: float
    end_m: float
    height_at_start_m: float
    gradient: float
    curvature_rad: float
    cells: int


def scanned_heights(particles: pd.DataFrame, width: float, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Return (y of the raster's columns (m), (n_x, n_y) heights in m, NaN where there is no particle).

    particles: x_m, y_m, z_m, radius_m; width: of the periodic slice, x from -width/2 to width/2; step: of the raster,
    rounded so that whole ones fit the width.
    """
    x, y, z, radius = particles[["x_m", "y_m", "z_m", "radius_m"]].to_numpy().T
    columns_across = max(round(width / step), 1)
    step_x, reach = width / columns_across, math.ceil(radius.max() / step) + 1
    first = math.floor((y - radius).min() / step)
    count = math.ceil((y + radius).max() / step) - first + 1
    offsets = np.stack(np.meshgrid(*2 * [np.arange(-reach, reach + 1)], indexing="ij"), axis=-1).reshape(-1, 2)
    cell_x = np.floor((x + width / 2.0) / step_x).astype(int)[:, None] + offsets[:, 0]
    cell_y = np.floor(y / step).astype(int)[:, None] + offsets[:, 1]
    squared = ((cell_x + 0.5) * step_x - width / 2.0 - x[:, None]) ** 2 + ((cell_y + 0.5) * step - y[:, None]) ** 2
    covered = squared < radius[:, None] ** 2
    top = z[:, None] + np.sqrt(np.where(covered, radius[:, None] ** 2 - squared, 0.0))
    heights = np.full((columns_across, count), -np.inf)
    np.maximum.at(heights, (cell_x[covered] % columns_across, cell_y[covered] - first), top[covered])
    return (first + np.arange(count) + 0.5) * step, np.where(np.isfinite(heights), heights, np.nan)


def surface_points(particles: pd.DataFrame, width: float, diameter: float) -> pd.DataFrame:
    """Return one point of the free surface per square cell: column (along y), y_m, z_m.

    The median over a cell's raster: a particle lying loose on the surface or a hole in it hardly shifts it. Cells that
    are not covered by half are left out. Arguments as for `scanned_heights`; diameter: median, m.
    """
    y, heights = scanned_heights(particles, width, RASTER_DIAMETERS * diameter)
    per_cell = round(CELL_DIAMETERS / RASTER_DIAMETERS)
    across = max(heights.shape[0] // per_cell, 1)
    along = len(y) // per_cell
    rows = np.array_split(heights[:, : along * per_cell], across, axis=0)
    cells = [row.reshape(len(row), along, per_cell).swapaxes(0, 1).reshape(along, -1) for row in rows]
    covered = np.array([np.isfinite(cell).mean(axis=1) >= 0.5 for cell in cells])
    medians = np.array([_median_of_covered(cell) for cell in cells])
    middle = y[: along * per_cell].reshape(along, per_cell).mean(axis=1)
    columns = np.broadcast_to(np.arange(along), covered.shape)
    return pd.DataFrame(
        {
            "column": columns[covered],
            "y_m": np.broadcast_to(middle, covered.shape)[covered],
            "z_m": medians[covered],
        }
    )


def _median_of_covered(cell: np.ndarray) -> np.ndarray:
    filled = np.where(np.isfinite(cell).any(axis=1, keepdims=True), cell, 0.0)
    return np.nanmedian(filled, axis=1)


def straight_stretch(points: pd.DataFrame, start: float, end: float, diameter: float) -> pd.DataFrame:
    """Return the points of the stretch of a slope that is fitted.

    Between `start` and `end` (m along y: walls, edges, or the middle of a heap), less END_DIAMETERS at both, the
    slope's height is that between its lowest and its highest column; the stretch is where the columns stand between 10
    and 95 % of it. So neither the toe, which runs out, nor the crest, nor what stands at a wall counts.
    """
    inside = points[points["y_m"].between(start + END_DIAMETERS * diameter, end - END_DIAMETERS * diameter)]
    columns = inside.groupby("column")["z_m"].median()
    if len(columns) < LEAST_COLUMNS:
        raise FreeSurfaceError(
            f"the free surface between y = {start:.4g} and {end:.4g} m has {len(columns)} columns of one particle"
            f" diameter, needed are {LEAST_COLUMNS}: smaller particles, or a larger box."
        )
    low, high = columns.min(), columns.max()
    share = (columns - low) / max(high - low, np.finfo(float).tiny)
    used = share.index[(share >= LOWEST_SHARE) & (share <= HIGHEST_SHARE)]
    if len(used) < LEAST_COLUMNS:
        raise FreeSurfaceError(
            f"the slope between y = {start:.4g} and {end:.4g} m has {len(used)} columns of one particle diameter"
            f" between {LOWEST_SHARE:.0%} and {HIGHEST_SHARE:.0%} of its height, needed are {LEAST_COLUMNS}."
        )
    return inside[inside["column"].isin(used)]


def fitted_slope(points: pd.DataFrame, start: float, end: float, diameter: float) -> Slope:
    """Return the slope on a free surface between `start` and `end` (m along y).

    points: as from `surface_points`. The gradient is the median of the gradients between all pairs of points, its
    uncertainty half the interval that holds it with 68 % (P. K. Sen, Journal of the American Statistical Association 63
    (1968) 1379-1389). Up to 29 % of outliers do not move it. Raises FreeSurfaceError.
    """
    from scipy.stats import theilslopes  # slow to import, and every start of Snakemake reads this module

    used = straight_stretch(points, start, end, diameter)
    y, z = used["y_m"].to_numpy(), used["z_m"].to_numpy()
    gradient, height, low, high = theilslopes(z, y, alpha=ONE_SIGMA)
    middle = np.median(y)
    halves = [theilslopes(z[half], y[half])[0] for half in (y <= middle, y >= middle)]
    lower, upper = halves if gradient > 0.0 else halves[::-1]
    return Slope(
        angle_rad=math.atan(abs(gradient)),
        uncertainty_rad=(math.atan(high) - math.atan(low)) / 2.0,
        start_m=float(y.min() - CELL_DIAMETERS * diameter / 2.0),
        end_m=float(y.max() + CELL_DIAMETERS * diameter / 2.0),
        height_at_start_m=float(height + gradient * (y.min() - CELL_DIAMETERS * diameter / 2.0)),
        gradient=float(gradient),
        curvature_rad=math.atan(abs(upper)) - math.atan(abs(lower)),
        cells=len(used),
    )
