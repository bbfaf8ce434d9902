"""Tables of a study of equipment from the folders of its runs: rates by patch, loads of parts, summary.

A run's values are what a job is told of it, see `values_of_runs`. Blocks are averaged first, then packings
(`postproc.statistics.intervals`). Rates are of an hour of operation at the true coefficient.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from bulkwear.postproc.readers.cycle_folders import cycle_files
from bulkwear.postproc.statistics.intervals import Estimate, estimate
from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.postproc.tables.summary import NAMES, THROUGH
from bulkwear.workflows.cases.equipment.change_out import RULES
from bulkwear.workflows.cases.equipment.motions import frame_turns
from bulkwear.workflows.cases.equipment.phases import PRISTINE, START_UP, WEARING, WORN
from bulkwear.workflows.engine.chain import WORN_THROUGH
from bulkwear.workflows.engine.records import read_record
from bulkwear.workflows.engine.state import STATE

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Study

KEPT = (PRISTINE, WORN)  # in which the shape is kept, so that blocks are alike
SECONDS_PER_HOUR, KG_PER_TONNE, KG_PER_MT = 3600.0, 1e3, 1e9
HOURS = 1000.0  # of operation, for which rates are told
NAMED = ("setting", "part")
PLACE = ("x", "y", "z")
AT_A_PATCH = ("pressure_Pa", "sliding_velocity_m_per_s", "sliding_power_W_per_m2", "impact_power_W_per_m2")
COEFFICIENT = ("wear_coefficient_per_pa", "wear_coefficient_error")
LOADS = {"sliding_power_W": "W", "impact_power_W": "W", "worn_mass_kg_per_h": "kg/h", "power_W": "W"}
FORCE = "force"
VECTORS = {FORCE: "N", "torque": "N m"}
OF_PARTS = ("wears", "file", "material", "thickness_m", "law", *COEFFICIENT, "motion", *RULES)
FIRST_WALL = 2  # type of the first wall; that of the particles is 1
AT_THE_END = ("time_s", "carried_volume_m3", "largest_depth_m", "smallest_angle_deg")
SUMMED = ("worn_volume_m3", "applied_volume_m3", "sliding_work_J")


@dataclass(frozen=True, eq=False)
class Runs:
    """What the runs of a study left.

    values: of each run, see the module; patches, parts, flow: the rows of all cycles, with `run`, `setting`, `packing`;
    patches and parts have `phase`; flow has `cycle` and `phase`
    """

    values: tuple[Mapping[str, Any], ...]
    patches: pd.DataFrame
    parts: pd.DataFrame
    flow: pd.DataFrame

    @property
    def settings(self) -> list[str]:
        """Return the names of the settings in the order of the design."""
        return list(dict.fromkeys(run["setting"] for run in self.values))

    def first(self, setting: str) -> Mapping[str, Any]:
        """Return the values of the first run of a setting."""
        return next(run for run in self.values if run["setting"] == setting)

    @property
    def wearing_parts(self) -> list[tuple[str, str]]:
        """Return every (setting, part) that wears."""
        parts = ((setting, self.first(setting)["parts"]) for setting in self.settings)
        return [(setting, name) for setting, found in parts for name, part in found.items() if part["wears"]]


def values_of_runs(study: Study) -> list[dict[str, Any]]:
    """Return what jobs are told of every run of a study, JSON-able, SI: run, row, setting, packing, rate_kg_per_s (None
    without an inlet), block_s, periodic, operation, and parts {name: what is told of it}.
    """
    found = []
    for run in study.runs:
        parameters, inlet = run.parameters, run.parameters["inlet"]
        densities = [wall["density_kg_per_m3"] for wall in parameters["walls"]]
        found.append(
            {
                **{"run": run.name, "row": run.row, "setting": study.setting_of[run.row]},
                "packing": study.packing_of[run.row],
                "rate_kg_per_s": inlet["rate_kg_per_s"] if inlet else None,
                "block_s": parameters["sampling"]["block_s"],
                "periodic": parameters["periodic"],
                "operation": dict(parameters["operation"]) | {"duration_s": parameters["derived"]["operation_s"]},
                "parts": {
                    part["name"]: {name: part.get(name) for name in OF_PARTS}
                    | {"density_kg_per_m3": densities[part["type"] - FIRST_WALL]}
                    for part in parameters["parts"]
                },
            }
        )
    return found


def read_runs(values: Sequence[Mapping[str, Any]], folder: Path) -> Runs:
    """Return what runs left in results/<study>. Raises FileNotFoundError for a run without wear cycles."""
    tables = {name: [] for name in ("patches", "parts", "flow")}
    for run in values:
        there = {name: cycle_files(folder / run["run"], f"{name}.csv") for name in tables}
        if missing := [name for name, files in there.items() if not files]:
            raise FileNotFoundError(
                f"{folder / run['run']}: no cycle_*/{missing[0]}.csv found, allowed is a run with wear cycles."
            )
        labels = {name: run[name] for name in ("run", "setting", "packing")}
        own = {name: [pd.read_csv(file).assign(**labels) for file in there[name]] for name in ("patches", "parts")}
        phases = {int(table["cycle"].iloc[0]): table["phase"].iloc[0] for table in own["parts"]}
        for name, read in own.items():
            tables[name] += read
        for file in there["flow"]:
            cycle = int(file.parent.name.removeprefix("cycle_"))
            tables["flow"].append(pd.read_csv(file).assign(**labels, cycle=cycle, phase=phases.get(cycle, START_UP)))
    return Runs(tuple(values), **{name: pd.concat(found, ignore_index=True) for name, found in tables.items()})


def tonnes_per_hour(run: Mapping[str, Any]) -> float:
    """Return the t/h of a run's inlet, NaN without one."""
    rate = run["rate_kg_per_s"]
    return np.nan if rate is None else rate * SECONDS_PER_HOUR / KG_PER_TONNE


def mt_per_hour(run: Mapping[str, Any]) -> float:
    """Return the Mt that a run's inlet gives in an hour, NaN without one."""
    return tonnes_per_hour(run) * KG_PER_TONNE / KG_PER_MT


# ---------------------------------------------------------------- rates by patch


def rates_table(runs: Runs) -> pd.DataFrame:
    """Return a row per setting, part and patch: recession on the pristine and the worn shape, per 1,000 h and per Mt.

    Intervals are over packings at 95 %, NaN of one packing. pressure, velocity and powers: of the pristine shape.
    """
    rows = []
    for (setting, part, patch), table in runs.patches.groupby([*NAMED, "patch"], sort=False):
        first, per_mt = table.iloc[0], mt_per_hour(runs.first(setting))
        row = {"setting": setting, "part": part, "patch": patch}
        row |= {f"{axis}_mm": first[f"{axis}_m"] * MILLIMETRES for axis in PLACE}
        row |= {"area_mm2": first["area_m2"] * MILLIMETRES**2, "thickness_mm": first["thickness_m"] * MILLIMETRES}
        row |= {"packings": table["packing"].nunique()}
        for phase in KEPT:
            blocks = table[table["phase"] == phase]
            found = over_packings(blocks, "recession_m_per_h")
            low, high = found.interval()
            row[f"{phase}_blocks"] = len(blocks)
            for name, value in (("", found.value), ("low_", low), ("high_", high)):
                row[f"{phase}_{name}mm_per_1000h"] = value * MILLIMETRES * HOURS
            row[f"{phase}_mm_per_Mt"] = found.value * MILLIMETRES / per_mt
        pristine = table[table["phase"] == PRISTINE]
        rows.append(row | {name: over_packings(pristine, name).value for name in AT_A_PATCH} | _sliding(pristine))
    order = {pair: number for number, pair in enumerate(runs.wearing_parts)}
    rows.sort(key=lambda row: (order.get((row["setting"], row["part"]), len(order)), row["patch"]))
    return pd.DataFrame(rows)


def _sliding(blocks: pd.DataFrame) -> dict[str, float]:
    """Return the sliding velocity of a patch, power over pressure of each packing: weighted by the normal force, and
    not by blocks, of which some may not touch it; over packings that do.
    """
    of_packing = blocks.groupby("packing")[["sliding_power_W_per_m2", "pressure_Pa"]].mean()
    pressed = of_packing[of_packing["pressure_Pa"] > 0.0]
    found = (pressed["sliding_power_W_per_m2"] / pressed["pressure_Pa"]).mean()
    return {"sliding_velocity_m_per_s": found if len(pressed) else 0.0}


def over_packings(blocks: pd.DataFrame, column: str, log: bool = False) -> Estimate:
    """Return the mean of a column over the blocks of each packing, then over packings."""
    return estimate(blocks[column].to_numpy(float), blocks["packing"].to_numpy(), log)


# ---------------------------------------------------------------- loads of parts


def loads_table(runs: Runs) -> pd.DataFrame:
    """Return a row per setting, part and quantity: on the pristine shape, on the worn one, and the change in per cent.

    Force and torque: length of the mean vector; of parts that turn for good there is no force, for it would be that in
    their own turning frame. The change is taken packing by packing, then over packings. What is 0 on both shapes is
    left out.
    """
    rows = []
    for (setting, part), table in runs.parts.groupby(list(NAMED), sort=False):
        by_phase = {phase: _loads_of(table[table["phase"] == phase]) for phase in KEPT}
        turns = frame_turns(runs.first(setting)["parts"][part]["motion"])
        for name, unit in {**VECTORS, **LOADS}.items():
            if name == FORCE and turns:
                continue
            pristine, worn = (by_phase[phase].get(name, pd.Series(dtype=float)) for phase in KEPT)
            if not (pristine.any() or worn.any()):
                continue
            row = {"setting": setting, "part": part, "quantity": name, "unit": unit}
            row |= {"packings": len(pristine)}
            for phase, values in zip(KEPT, (pristine, worn), strict=True):
                row |= with_ends(phase, estimate(values.to_numpy()))
            both = pd.concat([pristine, worn], axis=1, keys=KEPT).dropna()
            change = 100.0 * (both[WORN] / both[PRISTINE] - 1.0)
            rows.append(row | with_ends("change_percent", estimate(change.to_numpy())))
    return pd.DataFrame(rows)


def with_ends(name: str, found: Estimate) -> dict[str, float]:
    """Return a value and the ends of its interval as columns."""
    low, high = found.interval()
    return {name: found.value, f"{name}_low": low, f"{name}_high": high}


def _loads_of(blocks: pd.DataFrame) -> dict[str, pd.Series]:
    """Return {quantity: mean over its blocks by packing} of a part in a phase."""
    if blocks.empty:
        return {}
    means = blocks.groupby("packing", sort=False).mean(numeric_only=True)
    found = {}
    for name, unit in VECTORS.items():
        columns = [f"{name}_{axis}_{unit.replace(' ', '_')}" for axis in PLACE]
        found[name] = np.sqrt((means[columns] ** 2).sum(axis=1))
    return found | {name: means[name] for name in LOADS}


# ---------------------------------------------------------------- summary


def summary(design: Path, wear: Sequence[Path], pristine: Sequence[Path], worn: Sequence[Path]) -> pd.DataFrame:
    """Return the design with the totals of every run: a row per run, files in the order of the design's rows.

    Volumes are what the engine wore the surfaces by, hours of operation those that it stands for.
    """
    runs = pd.read_csv(design, keep_default_na=False, na_values=[""], dtype=NAMES)
    return pd.concat(
        [runs, pd.DataFrame([run_summary(pd.read_csv(path), path.parent) for path in map(Path, wear)])], axis=1
    )


def run_summary(wear: pd.DataFrame, folder: Path) -> dict[str, Any]:
    """Return totals (m3, J), hours of operation and state at the end of a run from the rows of its wear.csv; folder: of
    the run, whose states tell where it was worn through.
    """
    last = wear.iloc[-1]
    return {
        "cycles": len(wear),
        **{f"{phase}_cycles": int((wear["phase"] == phase).sum()) for phase in (PRISTINE, WEARING, WORN)},
        "operation_h": float(last["operation_h"] + last["stands_for_h"]),
        **{name: float(last[name]) for name in AT_THE_END},
        **{name: float(wear[name].sum()) for name in SUMMED},
        **(_worn_through(wear, folder) if THROUGH in wear else {}),
        "largest_balance_error": float(wear["balance_error"].max()),
    }


def _worn_through(wear: pd.DataFrame, folder: Path) -> dict[str, Any]:
    """Return how many nodes are worn through at the end; of the first ones, by how many hours, NaN, and where, ""."""
    through = wear[wear[THROUGH] > 0]
    found = {THROUGH: int(wear[THROUGH].iloc[-1]), "through_h": math.nan, "through_said": ""}
    if through.empty:
        return found
    first = through.iloc[0]
    state = read_record(folder / f"cycle_{int(first['cycle']):03d}" / STATE)
    said = state.get(WORN_THROUGH, f"at {(nodes := int(first[THROUGH]))} node{'s' * (nodes > 1)}")
    return found | {"through_h": float(first["operation_h"] + first["stands_for_h"]), "through_said": said}
