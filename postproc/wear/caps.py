"""Largest step a node may take in one wear update.

Two limits, the smaller one counts:

* geometry: a fraction of the shortest edge at the node, so that no triangle folds;
* time: particles that rested on the surface fall the gap d in sqrt(2 d / g); that fall may take at most a
  stated fraction of the cycle, hence d <= g (fraction * duration)^2 / 2.
"""

from __future__ import annotations

import numpy as np

from postproc.mesh import shortest_edge_at_nodes

GRAVITY = 9.81  # m/s2
LARGEST_EDGE_FRACTION = 0.5  # -, two neighbours moving half an edge each towards one another meet


def gap_closing_step(gap_closing_time_fraction: float, cycle_duration_s: float, gravity: float) -> float:
    """Gap in m that a particle falls through in that fraction of the cycle, g (f T)^2 / 2.

    Parameters: fraction f (-), cycle duration T (s), gravity g (m/s2).
    """
    return 0.5 * gravity * (gap_closing_time_fraction * cycle_duration_s) ** 2


def step_limit(
    points: np.ndarray,
    triangles: np.ndarray,
    edge_fraction: float,
    gap_closing_time_fraction: float,
    cycle_duration_s: float,
    gravity: float = GRAVITY,
) -> np.ndarray:
    """Largest step of every node in one update.

    Parameters
    ----------
    points : (n, 3) m
    triangles : (m, 3) node indices
    edge_fraction : largest step over the shortest edge at the node, -, above 0 and at most 0.5
    gap_closing_time_fraction : part of the cycle that closing the gap may take, -, above 0
    cycle_duration_s : simulated time of the cycle, s
    gravity : m/s2

    Returns
    -------
    (n,) m. Nodes of no triangle get the time limit alone.

    Raises
    ------
    ValueError : a number outside its range.
    """
    if not 0.0 < edge_fraction <= LARGEST_EDGE_FRACTION:
        raise ValueError(f"edge_fraction is {edge_fraction}, allowed is 0 < value <= {LARGEST_EDGE_FRACTION}")
    for name, value in (
        ("gap_closing_time_fraction", gap_closing_time_fraction),
        ("cycle_duration_s", cycle_duration_s),
        ("gravity", gravity),
    ):
        if not value > 0.0:
            raise ValueError(f"{name} is {value}, allowed is a number above 0")
    by_time = gap_closing_step(gap_closing_time_fraction, cycle_duration_s, gravity)
    by_edge = edge_fraction * shortest_edge_at_nodes(points, triangles)
    return np.fmin(by_edge, by_time)
