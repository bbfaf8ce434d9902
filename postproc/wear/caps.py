"""Largest step a node may take in one wear update.

Two limits, the smaller one counts:

* geometry: a fraction of the shortest edge at the node, so that no triangle folds;
* time: particles that rested on the surface fall the gap d in sqrt(2 d / g); that fall may take at most a
  stated fraction of the cycle, hence d <= g (fraction * duration)^2 / 2.

Where the worn surface would be beyond repair, steps become smaller (`Caps`).
"""

from __future__ import annotations

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, shortest_edge_at_nodes

GRAVITY = 9.81  # m/s2
AIMED_DEMAND = 0.8  # -, of the cap, that the next cycle is planned for: rates change from cycle to cycle
LEAST_CYCLE_FACTOR, LARGEST_CYCLE_FACTOR = 0.2, 2.0  # -, of the length of the cycle before
CAP_SHARES = (1.0, 0.5, 0.25, 0.1)  # of the cap on a step, one after the other while the worn surface is beyond repair
HELD_BACK = 3.0  # -, target edges round a face that is at fault, within which nodes get the next smaller cap, or stay
MOST_TRIES = 12  # with smaller caps here and there, before they become smaller everywhere
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
    return np.fmin(edge_limit(points, triangles, edge_fraction), by_time)


def edge_limit(points: np.ndarray, triangles: np.ndarray, edge_fraction: float) -> np.ndarray:
    """Cap (n,) m of every node from the mesh alone: a fraction of the shortest edge there (NaN without one)."""
    return edge_fraction * shortest_edge_at_nodes(points, triangles)


def wanted_step(
    step: np.ndarray, carried_before: np.ndarray, carried_after: np.ndarray, area: np.ndarray
) -> np.ndarray:
    """Step (n,) m that the wear of one cycle asked of each node, caps and what was carried before left aside.

    Parameters
    ----------
    step : (n,) m, taken
    carried_before, carried_after : (n,) m3
    area : (n,) m2, that recedes with each node; 0 at nodes that do not wear
    """
    held_back = np.divide(carried_after - carried_before, area, out=np.zeros_like(area), where=area > 0.0)
    return np.where(area > 0.0, np.maximum(step + held_back, 0.0), 0.0)


def next_cycle_factor(wanted: np.ndarray, limit: np.ndarray, gap: float = np.inf) -> float:
    """Length of the next cycle over that of the last one, -, for wear that goes on as fast.

    Parameters
    ----------
    wanted : (n,) m, as from `wanted_step`
    limit : (n,) m, cap that holds for a cycle of any length, as from `edge_limit`
    gap : m, cap of the last cycle from the closing gap, see `gap_closing_step`

    The step grows with the length T, the lasting cap stays, the cap from the closing gap grows with T^2. So
    a cycle is as long as the lasting cap allows. Where the gap would still hold that back, no length applies all the
    wear, and the one at which both caps meet applies most. `AIMED_DEMAND` leaves room for change; changes are bounded.
    """
    demand = np.divide(wanted, limit, out=np.zeros_like(wanted), where=limit > 0.0)
    most = int(np.argmax(demand)) if demand.size else 0
    if not demand.size or not demand[most] > 0.0:
        return LARGEST_CYCLE_FACTOR
    factor = AIMED_DEMAND / demand[most]
    aimed = factor * wanted[most]
    if aimed > gap * factor**2:
        factor = np.sqrt(aimed / gap)
    return float(np.clip(factor, LEAST_CYCLE_FACTOR, LARGEST_CYCLE_FACTOR))


class Caps:
    """Caps on a step, which become smaller where a worn surface was beyond repair: what is not lost now is carried.

    limit: (n,) m, of each node; surface: before the step
    """

    def __init__(self, limit: np.ndarray, surface: SurfaceMesh):
        # slow to import, and every start of Snakemake and every job reads this module
        from bulkwear.postproc.wear.mesh_faults import TARGET_EDGE, with_target_edges

        self._limit, self._points = limit, surface.points
        sized = surface if TARGET_EDGE in surface.point_data else with_target_edges(surface)
        self._reach = HELD_BACK * np.asarray(sized.point_data[TARGET_EDGE])
        self._level, self._tries = np.zeros(len(limit), dtype=int), 0

    @property
    def cap(self) -> np.ndarray:
        """The caps (n,) m as they are now."""
        return np.array([*CAP_SHARES, 0.0])[self._level] * self._limit

    def shrunk(self, places: np.ndarray | None) -> bool:
        """Make the caps near places (k, 3) m smaller, down to nothing; everywhere, down to the last share, where that
        does not help, none is told, or it went on for too long. Return whether any became smaller.
        """
        from scipy.spatial import cKDTree

        self._tries += 1
        near = np.zeros(len(self._level), dtype=bool)
        if places is not None and self._tries <= MOST_TRIES:
            near = cKDTree(places).query(self._points)[0] <= self._reach
        lowered = near & (self._level < len(CAP_SHARES))
        if not lowered.any():
            lowered = self._level < len(CAP_SHARES) - 1
        self._level[lowered] += 1
        return bool(lowered.any())
