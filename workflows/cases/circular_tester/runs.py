"""Tables of the runs of a circular wear tester from what their wear cycles left; see tester_volume and tester_flow.

A revolution of wear is counted from where wear begins to be; a revolution of the bed from where it began to turn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from postproc.flow.bed import read_snapshot, snapshots
from postproc.mesh import SurfaceMesh, read_surface
from postproc.readers.cycle_folders import LAYER_TABLE, cycle_files, cycle_folders
from postproc.readers.solver_log import thermo_table
from postproc.wear.pattern_left import bump_volume
from postproc.wear.update import worn_faces
from workflows.cases.circular_tester.distribution import COLUMNS, force_by_column
from workflows.cases.circular_tester.layer import LayerOverSample

LOG, SURFACE, WORN_SURFACE, LEDGER = "log.liggghts", "surface.vtu", "worn_surface.vtu", "ledger.parquet"
CHOSEN_SURFACES = 4  # revolutions of which contours are drawn, evenly spaced up to the last one
VOLUME, SIZE, MESH, WORN_OUT, RING = "volume", "size", "mesh", "worn_out", "ring"  # series of the design


@dataclass(frozen=True, eq=False)
class TesterRun:
    """A run and how its bed has turned before wear was counted.

    shape: channel or ring; element_size_mm: mm; folder: of the run; bed_folder: of the bed that it started from
    bed_revolution_steps, revolution_steps: time steps of a revolution of bed and run; revolution_s: s
    bed_revolutions, run_in_revolutions: of the bed alone, and with the sample before wear is counted
    width, length, layer_height: m, of the sample and of the lowest layer over it; rotation: (3, 3) of the sample
    coefficient: 1/Pa; patch: over what a contact wears, in words
    distance_per_revolution: m of the bed past the sample's middle
    """

    name: str
    surface: str
    series: str
    shape: str
    particle_scale: float
    element_size_mm: float
    coefficient: float
    patch: str
    folder: Path
    bed_folder: Path
    bed_revolution_steps: int
    revolution_steps: int
    revolution_s: float
    bed_revolutions: float
    run_in_revolutions: float
    width: float
    length: float
    layer_height: float
    rotation: np.ndarray
    distance_per_revolution: float

    @property
    def case(self) -> dict[str, object]:
        """Columns that tell a run from others in all tables."""
        return {"run": self.name, "surface": self.surface, "particle_scale": self.particle_scale} | {
            name: getattr(self, name) for name in ("series", "shape", "element_size_mm", "coefficient")
        }

    @property
    def before(self) -> float:
        """Revolutions of the bed before wear is counted."""
        return self.bed_revolutions + self.run_in_revolutions

    @property
    def layer(self) -> LayerOverSample:
        return LayerOverSample(self.width, self.length, self.layer_height, self.rotation)


def top_of(mesh: SurfaceMesh) -> SurfaceMesh:
    """The faces of a sample that wear, with all its nodes; the holder's bottom would be in the way of sections."""
    kept = worn_faces(mesh)
    return SurfaceMesh(
        mesh.points, mesh.triangles[kept], {name: data[kept] for name, data in mesh.cell_data.items()}, mesh.point_data
    )


def volumes(runs: Sequence[TesterRun]) -> pd.DataFrame:
    """What every run has lost after each wear cycle, from revolution 0 on, as `tester_volume` wants it.

    Columns: those of `TesterRun.case`, cycle, revolution, volume_m3 (lost), law_volume_m3 (what the law takes, carried
    included), bump_volume_m3 (of it from bumps), pattern_volume_m3 (what is left of the bumps), elements.
    """
    parts = []
    for run in runs:
        wear = pd.read_csv(run.folder / "wear.csv")
        pristine = read_surface(run.folder / SURFACE)
        table = pd.DataFrame(
            {
                "cycle": wear["cycle"],
                "revolution": wear["revolution"],
                "volume_m3": wear["total_applied_volume_m3"],
                "law_volume_m3": wear["total_archard_volume_m3"],
                "bump_volume_m3": wear["bump_archard_volume_m3"].cumsum(),
                "pattern_volume_m3": wear["pattern_volume_m3"],
            }
        )
        start = {name: [0.0] for name in table} | {"cycle": [0], "pattern_volume_m3": [bump_volume(pristine)]}
        table = pd.concat([pd.DataFrame(start), table], ignore_index=True)
        parts.append(
            table.assign(**run.case, elements=int(worn_faces(pristine).sum()))[[*run.case, *table, "elements"]]
        )
    return pd.concat(parts, ignore_index=True)


def whole_revolutions(table: pd.DataFrame) -> pd.DataFrame:
    """The rows of a table of volumes at whole revolutions, and at the last one of each run."""
    whole = np.isclose(table["revolution"], table["revolution"].round(), atol=1e-6)
    last = table["revolution"] == table.groupby("run")["revolution"].transform("max")
    return table[whole | last]


def series(run: TesterRun) -> pd.DataFrame:
    """What a run does from instant to instant, as `tester_flow` wants it; the bed before it with a block in its place.

    Columns: run, surface, revolution (of the bed), worn_revolution (of wear, below 0 before), and measures, each in
    rows of its own: velocity_m_per_s and bed_height_m of the particles over the sample, wear_rate_m3_per_s,
    normal_force_N, bottom_velocity_m_per_s, bottom_angular_speed_rad_per_s.
    """
    parts = [_logged(run.bed_folder / LOG, run.bed_revolution_steps)]
    folders = cycle_folders(run.folder)
    parts.append(_after(_logged(folders[0] / LOG, run.revolution_steps), run.bed_revolutions))
    forces = _rows(run.folder, "forces.csv")
    over = {"velocity_over_m_per_s": "velocity_m_per_s", "height_over_m": "bed_height_m"}
    parts.append(_after(forces.rename(columns=over)[["revolution", *over.values()]], run.before))
    history = _rows(run.folder, "wear_history.csv")
    duration = np.diff(history["time_s"], prepend=0.0)
    middle = history["time_s"] - 0.5 * duration  # a stretch up to the end of a revolution belongs to it
    wear = pd.DataFrame({"revolution": middle / run.revolution_s})
    wear["wear_rate_m3_per_s"] = history["archard_volume_m3"] / duration
    wear["normal_force_N"] = history["mean_normal_force_N"]
    parts.append(_after(wear, run.before))
    layer = _rows(run.folder, LAYER_TABLE)
    bottom = {name: f"bottom_{name}" for name in ("velocity_m_per_s", "angular_speed_rad_per_s")}
    parts.append(_after(layer.rename(columns=bottom)[["revolution", *bottom.values()]], run.before))
    table = pd.concat(parts, ignore_index=True)
    table.insert(0, "run", run.name)
    table.insert(1, "surface", run.surface)
    return table.assign(worn_revolution=table["revolution"] - run.before)


def _after(table: pd.DataFrame, revolutions: float) -> pd.DataFrame:
    return table.assign(revolution=table["revolution"] + revolutions)


def _logged(path: Path, revolution_steps: int) -> pd.DataFrame:
    """Velocity and height of the bed over the sample from the last run of a log, by revolution since its start."""
    thermo = thermo_table(path)
    last = thermo["run"] == thermo["run"].max()
    step = thermo["Step"][last]
    table = {
        "revolution": (step - step[0]) / revolution_steps,
        "velocity_m_per_s": thermo["sample_v"][last],
        "bed_height_m": thermo["sample_h"][last],
    }
    return pd.DataFrame(table).iloc[1:]  # the first row is of no motion yet


def _rows(folder: Path, name: str) -> pd.DataFrame:
    """The rows of a table that every wear cycle has left."""
    return pd.concat([pd.read_csv(path) for path in cycle_files(folder, name)], ignore_index=True)


def cycle_surfaces(run: TesterRun, revolutions: Sequence[float] | None = None) -> dict[str, SurfaceMesh]:
    """Worn tops after about these revolutions of wear, by their number; evenly spaced ones without."""
    wear = pd.read_csv(run.folder / "wear.csv", usecols=["cycle", "revolution"])
    last = wear["revolution"].iloc[-1]
    wanted = revolutions if revolutions is not None else np.linspace(0.0, last, CHOSEN_SURFACES + 1)[1:]
    rows = [wear.loc[(wear["revolution"] - each).abs().idxmin()] for each in wanted]
    return {
        f"{row['revolution']:.3g}": top_of(read_surface(run.folder / f"cycle_{int(row['cycle']):03d}" / SURFACE))
        for row in rows
    }


def surfaces_alike(runs: Sequence[TesterRun]) -> tuple[float, dict[str, SurfaceMesh]]:
    """The revolution of wear that all runs have reached, and their worn tops after it, by run."""
    last = min(float(pd.read_csv(run.folder / "wear.csv", usecols=["revolution"]).iloc[-1, 0]) for run in runs)
    return last, {run.name: next(iter(cycle_surfaces(run, [last]).values())) for run in runs}


def layer_particles(run: TesterRun, revolution: float) -> pd.DataFrame:
    """Particles of the lowest layer at the end of the wear cycle nearest to a revolution, as `relative_motion` wants
    them: surface, x_m, y_m, radius_m, vx_m_per_s, vy_m_per_s, angular_speed_rad_per_s.
    """
    wear = pd.read_csv(run.folder / "wear.csv", usecols=["cycle", "revolution"])
    cycle = int(wear.loc[(wear["revolution"] - revolution).abs().idxmin(), "cycle"])
    found = run.layer.of(read_snapshot(snapshots(run.folder / f"cycle_{cycle:03d}")[-1]))
    names = {"velocity_x_m_per_s": "vx_m_per_s", "velocity_y_m_per_s": "vy_m_per_s"}
    kept = found.rename(columns=names)[["x_m", "y_m", "radius_m", *names.values(), "angular_speed_rad_per_s"]]
    return kept.assign(surface=run.surface)


def mean_force_by_column(run: TesterRun, columns: int = COLUMNS) -> pd.DataFrame:
    """Normal force by column, mean over the wear cycles: run, column, base_N, bumps_N, deviation_N (of the cycles)."""
    before, parts = run.folder / SURFACE, []
    durations = np.diff(pd.read_csv(run.folder / "wear.csv")["time_s"], prepend=0.0)
    for folder, duration in zip(cycle_folders(run.folder)[1:], durations, strict=True):
        impulse = pd.read_parquet(folder / LEDGER, columns=["normal_impulse_N_s"])["normal_impulse_N_s"]
        parts.append(force_by_column(read_surface(before), impulse, duration, columns))
        before = folder / SURFACE
    table = pd.concat(parts).assign(total=lambda rows: rows["base_N"] + rows["bumps_N"])
    grouped = table.groupby("column")
    mean = grouped[["base_N", "bumps_N"]].mean()
    return mean.assign(deviation_N=grouped["total"].std().fillna(0.0)).reset_index().assign(run=run.name)


def outlines(mesh: SurfaceMesh) -> np.ndarray:
    """Ends (k, 2, 2) m of the edges round the parts of a pristine top, seen from above: its rim and the bumps' feet."""
    part = mesh.cell_data["part"]
    edges = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    owner = np.repeat(part, 3)
    order = np.lexsort((owner, edges[:, 1], edges[:, 0]))
    edges, owner = edges[order], owner[order]
    same = (edges[1:] == edges[:-1]).all(axis=1)
    first = np.flatnonzero(same & (owner[1:] != owner[:-1]))
    inner = edges[first]
    alone = np.ones(len(edges), bool)
    alone[1:] &= ~same
    alone[:-1] &= ~same
    return mesh.points[np.concatenate([inner, edges[alone]])][:, :, :2]
