"""Panels of figures of the flow: what was simulated of a setting in a phase, seen from the side, with its parts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.flow.charge_angles import ChargeAngles, charge_angles
from bulkwear.postproc.mesh import SurfaceMesh, read_surface
from bulkwear.postproc.readers.cycle_folders import cycle_folders
from bulkwear.postproc.tables.display import MILLIMETRES, few_digits
from bulkwear.workflows.cases.equipment.flow import pictures_of
from bulkwear.workflows.cases.equipment.flow_views import (
    LEVEL,
    Side,
    filling_field,
    flow_side,
    outlines,
    positions,
    read_particles,
    seen,
    velocity_field,
)
from bulkwear.workflows.cases.equipment.motions import motion_of
from bulkwear.workflows.cases.equipment.phases import PRISTINE, WEARING, WORN
from bulkwear.workflows.cases.equipment.pictures import SURFACE, Run, first_runs, labels_of, part_mesh, turns_about

AS_BUILT, AS_WORN = "as built", "as worn"
SHAPES = {AS_BUILT: PRISTINE, AS_WORN: WORN}  # as figures call them: as tables do
TOE, SHOULDER = "toe", "shoulder"


@dataclass(frozen=True, eq=False)
class FlowPanel:
    """What a panel shows: of a setting in a phase, which several settings reach after hours of their own.

    table: of particles, or of cells; outlines: (k, 2, 2) mm of parts
    angles: {word: degrees from 12 o'clock in the sense of rotation}; centre_mm, radius_mm: of the shell in the view;
    clockwise: how it is seen to turn
    """

    setting: str
    phase: str
    table: pd.DataFrame
    outlines: np.ndarray
    hours: float = 0.0
    angles: Mapping[str, float] = field(default_factory=dict)
    centre_mm: tuple[float, float] = (0.0, 0.0)
    radius_mm: float = 0.0
    clockwise: bool = True

    @property
    def title(self) -> str:
        """Return the phase with its hours of operation."""
        return f"{self.phase}, after {few_digits(self.hours, 4)} h" if self.hours > 0.0 else self.phase


@dataclass(frozen=True, eq=False)
class Scene:
    """A run in a phase that it reaches after hours of operation: its side, the snapshots of the phase, its parts
    where they are at the last of them.
    """

    run: Run
    phase: str
    hours: float
    side: Side
    snapshots: Sequence[pd.DataFrame]
    parts: Sequence[SurfaceMesh]

    def outlines(self) -> np.ndarray:
        """Return the section of the parts through the middle of the particles, (k, 2, 2) mm."""
        last = self.snapshots[-1]
        corners = np.concatenate([part.points for part in self.parts])
        middle = np.median(positions(last), axis=0) if len(last) else 0.5 * (corners.min(axis=0) + corners.max(axis=0))
        return outlines(self.parts, self.side, middle)


def scenes(run: Run, folder: Path) -> list[Scene]:
    """Return a run as built and, where it was worn, as worn; folder: results/<study>."""
    found, side = [], None
    for phase, hours, cycles in shown_cycles(folder / run["run"]):
        snapshots = snapshots_of(cycles)
        side = side or run_side(run, snapshots[-1])
        time = snapshots[-1]["step"].iloc[0] * run["time_step_s"] if len(snapshots[-1]) else 0.0
        surface, labels = read_surface(cycles[-1] / SURFACE), labels_of(run)
        parts = []
        for name, label in labels.items():
            mesh, _ = part_mesh(surface, label)
            placed = motion_of(run["parts"][name]["motion"]).placed(mesh.points, float(time))
            parts.append(SurfaceMesh(placed, mesh.triangles))
        found.append(Scene(run, phase, hours, side, snapshots, parts))
    return found


def shown_cycles(folder: Path) -> list[tuple[str, float, list[Path]]]:
    """Return phase, hours and cycles of a run with the shape as built, and of those with the worn one."""
    wear = pd.read_csv(folder / "wear.csv")
    there = {path.name: path for path in cycle_folders(folder)}
    of_phase = {
        phase: [there[f"cycle_{cycle:03d}"] for cycle in wear.loc[wear["phase"] == phase, "cycle"]]
        for phase in (PRISTINE, WEARING, WORN)
    }
    worn = of_phase[WORN] or of_phase[WEARING][-1:]
    hours = float((wear["operation_h"] + wear["stands_for_h"]).iloc[-1])
    phases = [(AS_BUILT, 0.0, of_phase[PRISTINE]), (AS_WORN, hours, worn)]
    return [(phase, after, cycles) for phase, after, cycles in phases if cycles]


def snapshots_of(cycles: Sequence[Path]) -> list[pd.DataFrame]:
    """Return the snapshots of some cycles, each instant once."""
    files = {int(path.stem.removeprefix("picture_")): path for cycle in cycles for path in pictures_of(cycle)}
    return [read_particles(files[step]) for step in sorted(files)]


def run_side(run: Run, particles: pd.DataFrame) -> Side:
    """Return the side from which a run is looked at."""
    turning = turning_axis(run)
    return flow_side(particles, (run["periodic"] or {}).get("axis"), None if turning is None else turning[1])


def turning_axis(run: Run) -> tuple[np.ndarray, np.ndarray] | None:
    """Return point (3,) m and axis (3,) of the first part of a run that turns about a level axis, None without one."""
    for part in run["parts"].values():
        turning = turns_about(part["motion"])
        if turning is not None and abs(turning[1][2]) < LEVEL:
            return turning
    return None


# ---------------------------------------------------------------- panels


def particle_panels(runs: Sequence[Run], folder: Path) -> list[FlowPanel]:
    """Return the particles of the last instant of the shape as built and as worn, of the first packing of settings."""
    every = [scene for run in first_runs(runs) for scene in scenes(run, folder)]
    return [_panel(scene, seen(scene.snapshots[-1], scene.side)) for scene in every]


def velocity_panels(runs: Sequence[Run], folder: Path) -> list[FlowPanel]:
    """Return mean velocities of all snapshots of the shape as built and as worn, of the first packing of settings."""
    every = [scene for run in first_runs(runs) for scene in scenes(run, folder)]
    return [_panel(scene, velocity_field(scene.snapshots, scene.side)) for scene in every]


def charge_panels(runs: Sequence[Run], folder: Path) -> list[FlowPanel]:
    """Return how full a mill's section is, with toe and shoulder, of the first packing of settings."""
    found = []
    for run in first_runs(runs):
        for scene in scenes(run, folder):
            (point, axis), angles = turning_axis(run), charge_of(scene)
            panel = _panel(scene, filling_field(scene.snapshots, scene.side, slice_length(run)))
            found.append(
                replace(
                    panel,
                    angles={TOE: angles.toe_deg, SHOULDER: angles.shoulder_deg},
                    centre_mm=tuple(scene.side.places_mm(point[None])[0]),
                    radius_mm=MILLIMETRES * angles.shell_m,
                    clockwise=bool(axis @ scene.side.towards < 0.0),
                )
            )
    return found


def _panel(scene: Scene, table: pd.DataFrame) -> FlowPanel:
    return FlowPanel(scene.run["setting"], scene.phase, table, scene.outlines(), scene.hours)


def panel_rows(panels: Sequence[FlowPanel]) -> pd.DataFrame:
    """Return the tables of panels as one, with setting, phase and operation_h."""
    named = ["setting", "phase", "operation_h"]
    values = [(panel.setting, panel.phase, panel.hours) for panel in panels]
    tables = [
        panel.table.assign(**dict(zip(named, own, strict=True))) for panel, own in zip(panels, values, strict=True)
    ]
    found = pd.concat(tables, ignore_index=True)
    return found[[*named, *(name for name in found if name not in named)]]


# ---------------------------------------------------------------- charge of a mill


def charge_of(scene: Scene) -> ChargeAngles:
    """Return toe and shoulder of the charge in a scene."""
    particles = pd.concat(scene.snapshots, ignore_index=True)
    return charge_angles(positions(particles), particles["radius_m"].to_numpy(), *turning_axis(scene.run))


def charge_rows(runs: Sequence[Run], folder: Path) -> pd.DataFrame:
    """Return toe and shoulder of every packing: setting, packing, phase, operation_h, toe_deg, shoulder_deg.

    phase: PRISTINE or WORN. Degrees from 12 o'clock in the sense of rotation, see `postproc.flow.charge_angles`.
    """
    rows = []
    for run in runs:
        for scene in scenes(run, folder):
            found = charge_of(scene)
            row = {"setting": run["setting"], "packing": run["packing"], "phase": SHAPES[scene.phase]}
            row["operation_h"] = scene.hours
            rows.append(row | {"toe_deg": found.toe_deg, "shoulder_deg": found.shoulder_deg})
    return pd.DataFrame(rows)


def slice_length(run: Run) -> float:
    """Return the length (m) along the axis of the slice of a mill that is simulated, or of its filling."""
    if run["periodic"]:
        return run["periodic"]["high_m"] - run["periodic"]["low_m"]
    return run["filling"]["length_m"]
