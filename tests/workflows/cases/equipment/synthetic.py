"""Folders of runs of the case equipment as the engine leaves them, with known rates, for tests without a solver.

A part is a row of square patches along x, each of two triangles; rigid parts have one. Every cycle's rates are those of
its part times a factor of its block, whose mean over the blocks of a phase is 1 and whose scatter is given.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import SurfaceMesh, write_surface

SIDE = 0.1  # m, of a patch
APART = 0.3  # m, between parts, along y
DENSITY = 7900.0  # kg/m3, of walls
PARTICLE = 0.01  # kg
OPERATION = {"change_out_remaining_m": 0.0, "hours_per_year_s": 6000.0 * 3600.0, "duration_s": 8000.0 * 3600.0}
ROWS = 10  # of flow.csv in a cycle
PHASES = ("start_up", "pristine", "wearing", "worn")


@dataclass(frozen=True)
class SyntheticPart:
    """A part of every run of a setting.

    recession: m/h of each patch on the pristine shape; nothing where it does not wear; worn: its factor on the worn one
    thickness: m, None where it is not known; error: -, half width of the coefficient's interval over it
    force: N, along x; power: W, of its motion; both on the pristine shape
    """

    name: str
    recession: tuple[float, ...] = ()
    worn: float = 1.0
    thickness: float | None = 0.03
    behind: float = 0.0  # recession of the back over that of the front
    coefficient: float = 6e-13
    error: float = 0.0
    force: float = 100.0
    power: float = 0.0
    motion: Mapping[str, Any] | None = None
    rule: Mapping[str, float] = field(default_factory=dict)  # of change-out, its own

    @property
    def wears(self) -> bool:
        return bool(self.recession)

    @property
    def patches(self) -> int:
        return max(len(self.recession), 1)


@dataclass(frozen=True)
class SyntheticRun:
    """A run: so many blocks of each phase, each wearing block for `stands_for` hours.

    scatter: -, standard deviation of the blocks' factors, 0 for none; factor: of all its rates, as of its packing
    rate: kg/s through the inlet, None without one: then `held` kg are there from the start
    """

    name: str
    parts: tuple[SyntheticPart, ...]
    setting: str = ""
    packing: int = 1
    pristine: int = 4
    updates: int = 3
    worn: int = 2
    stands_for: float = 100.0
    duration: float = 1.0
    start_up: float = 2.0
    scatter: float = 0.0
    factor: float = 1.0
    rate: float | None = 50.0
    held: float = 20.0
    operation: Mapping[str, Any] = field(default_factory=lambda: dict(OPERATION))

    @property
    def phases(self) -> list[str]:
        """Return the phase of every cycle."""
        counts = (1, self.pristine, self.updates, self.worn)
        return [phase for phase, count in zip(PHASES, counts, strict=True) for _ in range(count)]

    def factors(self) -> np.ndarray:
        """Return the factor of every cycle; over the blocks of a phase their mean is the run's own."""
        rng, found = np.random.default_rng([self.packing, *self.name.encode()]), []
        for phase in dict.fromkeys(self.phases):
            noise = self.scatter * rng.standard_normal(self.phases.count(phase))
            found.extend(self.factor * (1.0 + noise - noise.mean()))
        return np.array(found)


def write_study(folder: Path, runs: Sequence[SyntheticRun]) -> list[dict[str, Any]]:
    """Write design.csv and the folders of all runs; return what the jobs of tables are told of them."""
    folder.mkdir(parents=True, exist_ok=True)
    rows = [
        {"run": run.name, "row": run.name, "setting": run.setting or run.name, "packing": run.packing} for run in runs
    ]
    pd.DataFrame(rows).to_csv(folder / "design.csv", index=False)
    for run in runs:
        write_run(folder / run.name, run)
    return [values_of(run) for run in runs]


def values_of(run: SyntheticRun) -> dict[str, Any]:
    """Return what a job of tables is told of a run."""
    return {
        **{"run": run.name, "row": run.name, "setting": run.setting or run.name, "packing": run.packing},
        "rate_kg_per_s": run.rate,
        "block_s": run.duration,
        "periodic": None,
        "operation": dict(run.operation),
        "parts": {
            part.name: {
                **{"wears": part.wears, "file": f"{part.name}.step", "material": "steel"},
                "density_kg_per_m3": DENSITY,
                "thickness_m": part.thickness,
                "law": "archard",
                "wear_coefficient_per_pa": part.coefficient,
                "wear_coefficient_error": part.error,
                "motion": part.motion,
                **part.rule,
            }
            for part in run.parts
        },
    }


# ---------------------------------------------------------------- a run


def write_run(folder: Path, run: SyntheticRun) -> None:
    """Write the folder of a run: its surfaces, tables of all cycles, wear.csv, pictures of particles."""
    shutil.rmtree(folder, ignore_errors=True)  # cycles of a longer run before
    folder.mkdir(parents=True)
    history, depths, flow = [], _no_depth(run), _Flow(run)
    write_surface(folder / "surface.vtu", surface_of(run, depths))
    for cycle, (phase, factor) in enumerate(zip(run.phases, run.factors(), strict=True)):
        inside = folder / f"cycle_{cycle:03d}"
        inside.mkdir(exist_ok=True)
        hours = run.stands_for if phase == "wearing" else 0.0
        head = {
            **{"cycle": cycle, "phase": phase, "operation_h": sum(row["stands_for_h"] for row in history)},
            **{"stands_for_h": hours, "duration_s": run.duration if cycle else run.start_up},
        }
        flow.cycle(head["duration_s"]).to_csv(inside / "flow.csv", index=False)
        write_picture(inside / "picture.dump")
        if cycle:
            patches, parts = _patches(run, head, factor, depths), _parts(run, head, factor)
            patches.to_csv(inside / "patches.csv", index=False)
            parts.to_csv(inside / "parts.csv", index=False)
            for part in run.parts:
                depths[part.name] = depths[part.name] + hours * _recession(part, phase, factor)
            write_surface(inside / "surface.vtu", surface_of(run, depths))
            history.append(_wear_row(head, parts, depths, flow.time))
        (inside / "state.json").write_text(json.dumps({"cycle": cycle, "span": head, "solver_warnings": {}}))
    pd.DataFrame(history).to_csv(folder / "wear.csv", index=False)
    write_surface(folder / "worn_surface.vtu", surface_of(run, depths))


def _no_depth(run: SyntheticRun) -> dict[str, np.ndarray]:
    return {part.name: np.zeros(part.patches) for part in run.parts}


def _recession(part: SyntheticPart, phase: str, factor: float) -> np.ndarray:
    """Return the m/h of the patches of a part in a block; the shape counts as worn in phase worn alone."""
    worn = part.worn if phase == "worn" else 1.0
    return factor * worn * (np.array(part.recession) if part.wears else np.zeros(1))


def _patches(run: SyntheticRun, head: Mapping[str, Any], factor: float, depths: Mapping[str, np.ndarray]):
    tables, first = [], 0
    for row, part in enumerate(run.parts):
        if part.wears:
            rate, count = _recession(part, head["phase"], factor), part.patches
            columns = {
                **head,
                **{"part": part.name, "patch": first + np.arange(count)},
                **{"x_m": SIDE * (np.arange(count) + 0.5), "y_m": APART * row + 0.5 * SIDE, "z_m": 0.0},
                **{"normal_x": 0.0, "normal_y": 0.0, "normal_z": 1.0},
                **{"area_m2": SIDE**2, "edge_m": SIDE},
                "thickness_m": np.nan if part.thickness is None else part.thickness,
                **{
                    "depth_m": depths[part.name],
                    "recession_m_per_h": rate,
                    "back_recession_m_per_h": part.behind * rate,
                },
                **{"pressure_Pa": 1e9 * rate, "sliding_velocity_m_per_s": 2.0},
                **{"sliding_power_W_per_m2": 2e9 * rate, "impact_power_W_per_m2": 1e8 * rate},
            }
            tables.append(pd.DataFrame(columns, index=range(count)))
            first += count
    return pd.concat(tables, ignore_index=True)


def _parts(run: SyntheticRun, head: Mapping[str, Any], factor: float) -> pd.DataFrame:
    rows = []
    for part in run.parts:
        worn = factor * (part.worn if head["phase"] == "worn" else 1.0)
        volume = SIDE**2 * float(_recession(part, head["phase"], factor).sum())
        rows.append(
            {
                **head,
                **{"part": part.name, "role": "wears" if part.wears else "rigid"},
                **{"force_x_N": worn * part.force, "force_y_N": 0.0, "force_z_N": 0.0},
                **{"torque_x_N_m": 0.0, "torque_y_N_m": 0.1 * worn * part.force, "torque_z_N_m": 0.0},
                **{"power_W": worn * part.power, "worn_volume_m3_per_h": volume},
                "worn_mass_kg_per_h": DENSITY * volume,
                **{"sliding_power_W": 2e9 * volume, "impact_power_W": 1e8 * volume},
            }
        )
    return pd.DataFrame(rows)


def _wear_row(head: Mapping[str, Any], parts: pd.DataFrame, depths: Mapping[str, np.ndarray], time: float):
    hours, volume = head["stands_for_h"], float(parts["worn_volume_m3_per_h"].sum())
    return {
        **head,
        **{"time_s": time, "worn_volume_m3": volume * hours, "applied_volume_m3": volume * hours},
        **{"carried_volume_m3": 0.0, "sliding_work_J": float(parts["sliding_power_W"].sum()) * head["duration_s"]},
        **{"largest_depth_m": max(depth.max() for depth in depths.values()), "smallest_angle_deg": 45.0},
        **{"balance_error": 0.0, "through_nodes": 0, "remeshed": 0},
    }


class _Flow:
    """The particles of a run: what was put in, is held and has gone out, cycle after cycle."""

    def __init__(self, run: SyntheticRun) -> None:
        self.run, self.time = run, 0.0

    def cycle(self, duration: float) -> pd.DataFrame:
        """Return flow.csv of the next cycle, from just after its begin to its end."""
        begins = self.time == 0.0
        first = 0 if begins else 1
        times = self.time + duration * np.arange(first, ROWS + 1) / ROWS
        self.time += duration
        held = np.full(len(times), round(self.run.held / PARTICLE))
        put = held
        if self.run.rate is not None:
            put = np.round(self.run.rate * times / PARTICLE).astype(int)
            held = np.minimum(put, held)
        out = put - held
        moving = {} if begins else {f"power_{part.name}_W": part.power for part in self.run.parts if part.power}
        return pd.DataFrame(
            {
                **{"time_s": times, "particles": held, "held_mass_kg": PARTICLE * held},
                **{"inserted_particles": put, "inserted_mass_kg": PARTICLE * put},
                **{"out_particles": out, "out_mass_kg": PARTICLE * out, "out_below_mass_kg": PARTICLE * out},
                **{"kinetic_energy_J": 0.5 * PARTICLE * held, **moving},
            }
        )


# ---------------------------------------------------------------- surfaces and pictures


def surface_of(run: SyntheticRun, depths: Mapping[str, np.ndarray]) -> SurfaceMesh:
    """Return all parts as one surface: part k has the label k where it wears, -1 - k where it is rigid."""
    points, triangles, labels, removed = [], [], [], []
    for row, part in enumerate(run.parts):
        label = row if part.wears else -1 - row
        for patch in range(part.patches):
            depth, low = depths[part.name][patch], np.array([SIDE * patch, APART * row])
            corners = low + SIDE * np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
            start = sum(map(len, points))
            points.append(np.column_stack([corners, np.full(4, -depth)]))
            triangles += [[start, start + 1, start + 2], [start, start + 2, start + 3]]
            labels += [label, label]
            removed += [depth] * 4
    return SurfaceMesh(
        np.concatenate(points),
        np.array(triangles),
        {"part": np.array(labels)},
        {"removed_thickness_m": np.array(removed)},
    )


def write_picture(path: Path, count: int = 8) -> None:
    """Write a picture of a few particles above the parts."""
    rows = [f"{k + 1} {0.05 * k:g} 0.05 0.05 1.0 0.0 -0.5 0.01" for k in range(count)]
    head = ["ITEM: TIMESTEP", "0", "ITEM: NUMBER OF ATOMS", str(count), "ITEM: BOX BOUNDS ff ff ff", *["-1 1"] * 3]
    path.write_text("\n".join([*head, "ITEM: ATOMS id x y z vx vy vz radius", *rows]) + "\n")
