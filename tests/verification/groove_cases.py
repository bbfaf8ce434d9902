"""A pin dragged to and fro over a plate until it lies deep in its own groove: LIGGGHTS and wear updates in turn."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from unittest import mock

import numpy as np

from bulkwear.meshes.sample import sample_top
from bulkwear.postproc.mesh import SurfaceMesh, unit_normals
from bulkwear.postproc.readers.load_ledger import RADIUS as CONTACT_RADIUS
from bulkwear.postproc.readers.load_ledger import WEIGHTS, LoadLedger
from bulkwear.postproc.wear.balance import lost_volume
from bulkwear.postproc.wear.caps import step_limit
from bulkwear.postproc.wear.displacement import StepTooLargeError
from bulkwear.postproc.wear.laws import worn_volume
from bulkwear.postproc.wear.patch import ContactPatch, hertz_disc
from bulkwear.postproc.wear.update import CARRIED_VOLUME, wear_update
from bulkwear.workflows.cases.pin_on_disc.contours import AREA_SHARE
from tests.verification.ledger_cases import LOAD, PIN_MOTION, RADIUS, hertz_overlap, pin, run_case

EDGES_PER_WIDTH = (5, 10, 20)
GROOVE_WIDTH = 2.1e-3  # m, width that holds 95 % of the section of a groove of radius RADIUS, DEPTH deep, rounded
DEPTH = 0.3e-3  # m, of that groove
PASSES = 30  # single strokes, to and fro; each deepens a round groove by 10 um
SPEED = 1.0  # m/s
TRACK = 5.0e-3  # m
PLATE = (4.6e-3, 9.2e-3)  # m, across and along the track: the groove ends well inside
OFF_NODES = 0.07e-3  # m, the track's x: no row of nodes follows it
SECTIONS = np.linspace(-0.6e-3, 0.6e-3, 13)  # m, along the track, about its middle
TIME_STEP = 2e-6  # s, 170 to an oscillation on a flat plate, some 60 in the groove on the finest mesh
SETTLING = 1500  # steps at rest before each stroke: nine oscillations, each damped to less than a half
EDGE_FRACTION = 0.25  # -, cap of the step over the shortest edge
OVERLAP_FRACTION = 0.5  # -, cap of the step over the overlap on a flat plate (41 um)
PROFILE_POINTS = 2001  # of a section's profile between its ends
FELT_REACH = 0.4  # -, of the pin's radius: how far round its axis the surface is looked at for the height it starts at


@dataclass(frozen=True, eq=False)
class Groove:
    """Surface after some strokes, and one dict per stroke (volumes m3, lengths m); `stopped`: why no more, or ""."""

    mesh: SurfaceMesh
    pristine: SurfaceMesh
    strokes: list[dict[str, float]] = field(default_factory=list)
    stopped: str = ""


def segment_area(depth: float) -> float:
    """Area (m2) of the section of a groove that is as round as the pin, `depth` (m) deep."""
    half_angle = np.arccos(1.0 - depth / RADIUS)
    return float(RADIUS**2 * (half_angle - 0.5 * np.sin(2.0 * half_angle)))


def wear_coefficients(passes: int = PASSES, depth: float = DEPTH) -> np.ndarray:
    """Archard's coefficient (1/Pa) of each stroke: all deepen a round groove alike, so later ones stand for more."""
    area = [segment_area(depth * k / passes) for k in range(passes + 1)]
    return np.diff(area) / LOAD


def touching_height(mesh: SurfaceMesh, x: float, y: float, radius: float = RADIUS) -> float:
    """Height (m) of a pin's centre over (x, y) where it just touches nodes, centroids or middles of edges."""
    corners = mesh.points[mesh.triangles]
    felt = np.concatenate([mesh.points, corners.mean(axis=1), 0.5 * (corners + np.roll(corners, 1, axis=1))[:, 0]])
    square = (felt[:, 0] - x) ** 2 + (felt[:, 1] - y) ** 2
    near = square < (FELT_REACH * radius) ** 2
    return float((felt[near, 2] + np.sqrt(radius**2 - square[near])).max())


def stroke_ledger(mesh: SurfaceMesh, forward: bool, time_step: float = TIME_STEP, **variables) -> LoadLedger:
    """Load ledger of one stroke along the track by LIGGGHTS; the pin settles at its start first.

    variables : of the frame deck, e.g. friction
    """
    sign = 1.0 if forward else -1.0
    start = (OFF_NODES, -sign * TRACK / 2)
    height = touching_height(mesh, *start) - 0.1 * hertz_overlap()
    fewer = TIME_STEP / time_step
    with tempfile.TemporaryDirectory() as folder:
        return run_case(
            Path(folder) / "stroke",
            mesh,
            pin(*start, height),
            PIN_MOTION,
            outputs=(f"velocity all set 0.0 {sign * SPEED} 0.0 units box",),
            time_step=time_step,
            settling=round(SETTLING * fewer),
            steps=round(TRACK / SPEED / time_step),
            **variables,
        )


def rise_and_vertical(mesh: SurfaceMesh, ledger: LoadLedger) -> tuple[float, float]:
    """Mean over a stroke of the summed normal forces and of their vertical part, both over the load, -.

    Normals are those of the faces, also for contacts at edges.
    """
    impulse = ledger.columns["normal_impulse_N_s"] / (LOAD * ledger.time_s)
    return float(impulse.sum()), float(impulse @ unit_normals(mesh.points, mesh.triangles)[:, 2])


def contact_patch(mesh: SurfaceMesh, columns) -> ContactPatch:
    """Contact patch of a solver's ledger, radius as simulated."""
    weights = np.column_stack([columns[name] for name in WEIGHTS])
    return ContactPatch(np.einsum("mc,mcx->mx", weights, mesh.points[mesh.triangles]), columns[CONTACT_RADIUS])


def pressure_disc(rings: int) -> tuple[np.ndarray, np.ndarray]:
    """Quadrature as `hertz_disc`, of the Hertz pressure sqrt(1 - r^2) itself: points (q, 2), weights (q,) of sum 1."""
    points, weights = hertz_disc(rings)
    if rings > 1:
        points = points[(points**2).sum(axis=1) < 1.0]
        square = (points**2).sum(axis=1)
        weights = np.sqrt(1.0 - square) / np.sqrt(1.0 - square).sum()
        points = points * np.sqrt(0.4 / (weights @ square))
    return points, weights


def spread_once() -> AbstractContextManager:
    """Within this context the product spreads over the Hertz pressure itself, to show why it does not."""
    return mock.patch("bulkwear.postproc.wear.patch.hertz_disc", pressure_disc)


def worn_groove(
    edge: float,
    scheme: str = "conserving",
    passes: int = PASSES,
    time_step: float = TIME_STEP,
    tell: Callable[[str], None] = lambda line: None,
) -> Groove:
    """Drag the pin over a plate of that edge (m) and wear it after every stroke.

    scheme `conserving`: with contact patch and caps; `spread_once`: the same over the Hertz pressure itself;
        `per_triangle`: with neither, as in Yan 2022, until faces turn over
    tell : takes a line about each stroke
    """
    groove = Groove(plate := sample_top(*PLATE, edge, None), plate)
    for number, coefficient in enumerate(wear_coefficients()[:passes], start=1):
        ledger = stroke_ledger(groove.mesh, bool(number % 2), time_step)
        try:
            groove = worn_once(groove, ledger.columns, coefficient, scheme)
        except StepTooLargeError as fault:
            return Groove(groove.mesh, groove.pristine, groove.strokes, str(fault))
        row = groove.strokes[-1]
        tell(
            f"{scheme}, edge {1e6 * edge:.0f} um, stroke {number}: depth {1e6 * row['depth_m']:.1f} um, width "
            f"{1e3 * row['width_m']:.3f} mm, work/FL {row['work_J'] / row['load_times_distance_J']:.4f}, "
            f"loaded {row['loaded_triangles']:.0f}, carried {row['carried_volume_m3'] / row['law_volume_m3']:.1e}"
        )
    return groove


def worn_once(groove: Groove, columns, coefficient: float, scheme: str) -> Groove:
    """Wear the groove by the ledger of one stroke, and measure it."""
    mesh, before = groove.mesh, (groove.strokes or [{}])[-1]
    volume = worn_volume("archard", columns, {"wear_coefficient_per_pa": coefficient})
    patch = limit = None
    if scheme != "per_triangle":
        patch = contact_patch(mesh, columns)
        limit = step_limit(mesh.points, mesh.triangles, EDGE_FRACTION, 1.0, 1.0)
        limit = np.minimum(limit, OVERLAP_FRACTION * hertz_overlap())
    fields = {CARRIED_VOLUME: mesh.point_data.get(CARRIED_VOLUME, np.zeros(len(mesh.points)))}
    present = SurfaceMesh(mesh.points, mesh.triangles, mesh.cell_data, fields)
    displacement = "per_triangle" if scheme == "per_triangle" else "conserving"
    with spread_once() if scheme == "spread_once" else nullcontext():
        worn, record = wear_update(present, volume, limit, (0.0, 0.0, -1.0), patch, displacement)
    section = mean_section(worn, SECTIONS)
    row = {
        "coefficient_per_pa": coefficient,
        "work_J": float(columns["sliding_work_J"].sum()),
        "load_times_distance_J": LOAD * TRACK,
        "law_volume_m3": before.get("law_volume_m3", 0.0) + float(volume.sum()),
        "nominal_volume_m3": before.get("nominal_volume_m3", 0.0) + coefficient * LOAD * TRACK,
        "removed_volume_m3": lost_volume(groove.pristine, worn)[0],
        "carried_volume_m3": record["carried_volume_m3"],
        "loaded_triangles": float(np.count_nonzero(volume)),
        "smallest_angle_deg": record["smallest_angle_deg"],
        "largest_step_m": record["largest_step_m"],
        **section,
    }
    return Groove(worn, groove.pristine, [*groove.strokes, row])


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
