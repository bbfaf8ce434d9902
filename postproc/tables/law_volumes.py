"""Wear by several laws from the ledgers of the same cycles, nothing simulated: how much, and where."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import SurfaceMesh, areas, read_surface, unit_normals, worn_faces
from bulkwear.postproc.readers.cycle_folders import cycle_folders
from bulkwear.postproc.statistics.intervals import Estimate, difference, estimate
from bulkwear.postproc.tables.display import in_display_units
from bulkwear.postproc.tables.history import runs_of
from bulkwear.postproc.tables.packings import over_packings
from bulkwear.postproc.wear.coefficient import PER_PA
from bulkwear.postproc.wear.kernel_sums import columns_of_law
from bulkwear.postproc.wear.laws import LAWS, NEUTRAL_LAW, worn_volume

SURFACE, LEDGER, WEAR = "surface.vtu", "ledger.parquet", "wear.csv"
PHASE, UNCOUNTED = "phase", "start_up"  # column of wear.csv of machines, and the blocks whose wear does not count
EVEN = 1e-12  # -, of depths whose scatter over their mean is rounding
MEASURES = {"over_archard": True, "overlap": False, "correlation": False, "front_share": False}  # scatter by a factor?


@dataclass(frozen=True)
class WornBy:
    """What wears by one law in a run.

    law, parameters: SI, the coefficient included; part: name and label: of its faces, "" and None of all that wear
    others: {law: its parameters} of other parts and beside them, whose kernels the ledgers have summed too
    sums: of contact kernels that the ledgers hold, as from `kernel_sums`; none where there is one of each
    """

    law: str
    parameters: Mapping[str, float]
    part: str = ""
    label: int | None = None
    others: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    sums: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    def beside(self) -> dict[str, Mapping[str, float]]:
        """Return {law: its parameters} that the ledgers of such a run serve, the own law first; all with the own
        coefficient.
        """
        found = dict.fromkeys(laws_beside(self.law, self.others), self.parameters)
        coefficient = {PER_PA: self.parameters[PER_PA]} if PER_PA in self.parameters else {}
        return found | {law: {**given, **coefficient} for law, given in self.others.items() if law != self.law}


def laws_beside(law: str, others: Iterable[str] = ()) -> list[str]:
    """Return the laws that the ledgers of a run worn by `law` serve: that one first, those of `others`, by which other
    parts of it wear, and all that take no parameters and no contact kernels but theirs.
    """
    summed = {kernel for each in (law, *others) for kernel in LAWS[each].kernels}
    served = [name for name, each in LAWS.items() if not each.parameters and summed.issuperset(each.kernels)]
    return list(dict.fromkeys((law, *others, *served)))


@dataclass(frozen=True, eq=False)
class CycleMaps:
    """What laws make of the ledger of one cycle, (m,) per face that wears.

    volumes: {law: m3}; laws are left out whose columns the ledger, of an older program, lacks
    area: m2; front: of bumps, faces that look against the flow; None without bumps or a flow
    surface: that the cycle began with; faces: of it, (m,)
    """

    volumes: dict[str, np.ndarray]
    area: np.ndarray
    front: np.ndarray | None
    surface: SurfaceMesh
    faces: np.ndarray


def maps_of_cycles(folder: Path, worn: WornBy, flow: Sequence[float] | None = None) -> list[CycleMaps]:
    """Return the maps of all wear cycles of a run that count, by all laws that its ledgers serve.

    folder: of the run; a cycle whose first surface was not kept, as of a pin within its revolutions, is left out
    flow: (3,) direction in which material passes
    """
    before, found = folder / SURFACE, []
    for cycle in cycle_folders(folder):
        if not (cycle / LEDGER).is_file():
            continue
        if before.is_file() and _counts(folder, cycle):
            found.append(_maps(read_surface(before), pd.read_parquet(cycle / LEDGER), worn, flow))
        before = cycle / SURFACE
    return found


def _counts(folder: Path, cycle: Path) -> bool:
    """Return whether a cycle's wear counts: not of the start-up of a machine."""
    if not (folder / WEAR).is_file():
        return True
    rows = pd.read_csv(folder / WEAR)
    number = int(cycle.name.removeprefix("cycle_"))
    return PHASE not in rows or not (rows[rows["cycle"] == number][PHASE] == UNCOUNTED).any()


def _maps(surface: SurfaceMesh, ledger: pd.DataFrame, worn: WornBy, flow: Sequence[float] | None) -> CycleMaps:
    faces = worn_faces(surface)
    labels = surface.cell_data.get("part", np.zeros(len(faces), dtype=int))
    faces = faces if worn.label is None else faces & (labels == worn.label)
    columns = {name: values[faces] for name, values in _on_faces(ledger, len(faces)).items()}
    volumes = {law: _volume(law, columns, worn.sums, given) for law, given in worn.beside().items()}
    front, bumps = None, labels[faces] > 0
    if flow is not None and bumps.any():
        normals = unit_normals(surface.points, surface.triangles)[faces]
        front = bumps & (normals @ np.asarray(flow, float) < 0.0)
    area = areas(surface.points, surface.triangles)[faces]
    there = {law: volume for law, volume in volumes.items() if volume is not None}
    return CycleMaps(there, area, front, surface, np.flatnonzero(faces))


def _on_faces(ledger: pd.DataFrame, count: int) -> dict[str, np.ndarray]:
    """Return the columns of a ledger (count,): nothing on faces that it, of touched ones alone, does not name."""
    if "triangle" not in ledger:
        return {name: ledger[name].to_numpy() for name in ledger}
    found = {name: np.zeros(count) for name in ledger if name != "triangle"}
    for name, values in found.items():
        values[ledger["triangle"].to_numpy()] = ledger[name].to_numpy()
    return found


def _volume(law: str, columns: Mapping[str, np.ndarray], sums: Any, parameters: Mapping[str, float]) -> Any:
    """Return (m,) m3 by a law; None where a ledger does not suffice for it."""
    try:
        own = columns_of_law(columns, sums, law, parameters) if sums else columns
        return worn_volume(law, own, parameters)
    except KeyError:
        return None


def told_laws(maps: Sequence[CycleMaps]) -> list[str]:
    """Return the laws that the ledgers of all cycles serve."""
    return [law for law in (maps[0].volumes if maps else ()) if all(law in each.volumes for each in maps)]


def law_measures(maps: Sequence[CycleMaps]) -> dict[str, dict[str, float]]:
    """Return {law: its measures} of a run, NaN where nothing wears.

    worn_volume_m3: of all cycles; over_archard: that over Archard's with the same coefficient, NaN where the law's is
        another quantity; overlap: share of the wear that lies where Archard's does, face by face and cycle by cycle,
        sum(min(v, w)) of volumes over their totals, 1 where maps are alike, 0 where they are apart; correlation: of the
        two depths, weighted by area; front_share: of the volume on faces of bumps that look against the flow
    """
    found = {}
    every = {law: np.concatenate([each.volumes[law] for each in maps]) for law in told_laws(maps)}
    for law, volume in every.items():
        archard, area = every[NEUTRAL_LAW], np.concatenate([each.area for each in maps])
        total, whole = volume.sum(), archard.sum()
        bumps = [each.volumes[law][each.front].sum() for each in maps if each.front is not None]
        found[law] = {
            "worn_volume_m3": float(total),
            "over_archard": _ratio(total, whole) if LAWS[law].comparable else np.nan,
            "overlap": float(np.minimum(volume / total, archard / whole).sum()) if total > 0.0 < whole else np.nan,
            "correlation": _correlation(volume, archard, area),
            "front_share": _ratio(sum(bumps), total) if bumps else np.nan,
        }
    return found


def _ratio(value: float, total: float) -> float:
    return float(value / total) if total > 0.0 else np.nan


def _correlation(volume: np.ndarray, other: np.ndarray, area: np.ndarray) -> float:
    """Return the correlation of two depths, volumes over areas, weighted by area; NaN of a depth that is the same
    everywhere.
    """
    if not area.any():
        return np.nan
    depths = [np.divide(each, area, out=np.zeros_like(area), where=area > 0.0) for each in (volume, other)]
    first, second = (depth - np.average(depth, weights=area) for depth in depths)
    spread = np.sqrt(np.average(first**2, weights=area) * np.average(second**2, weights=area))
    mean_product = np.prod([np.average(depth, weights=area) for depth in depths])
    return float(np.average(first * second, weights=area) / spread) if spread > EVEN * mean_product else np.nan


def law_volumes(
    design: str | Path,
    folders: Sequence[Path],
    laws: Mapping[str, Sequence[WornBy]],
    flow: Sequence[float] | None = None,
) -> pd.DataFrame:
    """Return RUN, part, law, cycles, over_study_law (-) and what `law_measures` tells, a line per run, part and law,
    the study's own law first; no part where no part has a name.

    folders: of the runs, in the order of the design
    laws: {run: what wears in it}; the coefficient is that of all laws of a part
    flow: as for `maps_of_cycles`
    """
    rows = []
    for run, folder in zip(runs_of(design).to_dict("records"), folders, strict=True):
        for worn in laws[run["run"]]:
            maps = maps_of_cycles(folder, worn, flow)
            measures = law_measures(maps)
            for law, found in measures.items():
                own = _ratio(found["worn_volume_m3"], measures[worn.law]["worn_volume_m3"])
                part = {"part": worn.part} if worn.part else {}
                rows.append({**run, **part, "law": law, "cycles": len(maps), "over_study_law": own, **found})
    return pd.DataFrame(rows)


def laws_of_settings(volumes: pd.DataFrame) -> pd.DataFrame:
    """Return setting, surface, part where there are any, law, packings, and each of MEASURES and over_first with its
    interval over packings (`_low`, `_high`), a line per setting, surface, part and law.

    over_first: volume over that of the first setting and surface with the same part and law, of machines per block;
        needs no coefficient, and is NaN of the first one itself
    volumes: as from `law_volumes`; words that are not there are ""
    """
    by = [name for name in ("setting", "surface", "part", "law") if name in volumes]
    found = None
    for name, by_factor in MEASURES.items():
        table = over_packings(volumes[[*by, name]].fillna({"surface": ""}), name, by_factor, by=by)
        table = table.rename(columns={"interval_low": f"{name}_low", "interval_high": f"{name}_high"})
        if found is None:
            found = table
            continue
        found = found.join(table[[name, f"{name}_low", f"{name}_high"]])
    counts = volumes.fillna({"surface": ""}).groupby(by, sort=False)["packing"].nunique()
    return found.assign(packings=counts.to_numpy(), **_over_first(volumes, by))


def _over_first(volumes: pd.DataFrame, by: Sequence[str]) -> dict[str, list[float]]:
    """Return the columns of `over_first`, a value per group in their order."""
    of_cycles = volumes["cycles"] if "part" in volumes else 1.0  # blocks of a machine are equal, their number is not
    table = volumes.fillna({"surface": ""}).assign(rate=volumes["worn_volume_m3"] / of_cycles)
    first: dict[tuple, Estimate] = {}
    columns: dict[str, list[float]] = {name: [] for name in ("over_first", "over_first_low", "over_first_high")}
    for names, rows in table.groupby(list(by), sort=False):
        key = tuple(name for name, column in zip(names, by, strict=True) if column in ("part", "law"))
        found, is_first = estimate(rows["rate"], log=True), key not in first
        ratio = difference(found, first.setdefault(key, found))
        ends = (np.nan, np.nan) if is_first else ratio.interval()
        for column, value in zip(columns, (np.nan if is_first else ratio.value, *ends), strict=True):
            columns[column].append(value)
    return columns


@dataclass(frozen=True, eq=False)
class LawMap:
    """Where a law wears a run: depth (m,) of each face over the mean depth of all that wear, NaN elsewhere.

    surface: that the first of these cycles began with; cycles: how many in a row, all on the same triangles
    """

    law: str
    surface: SurfaceMesh
    relative_depth: np.ndarray
    cycles: int


def law_maps(folder: Path, worn: Sequence[WornBy]) -> list[LawMap]:
    """Return the maps of a run by law, of the most cycles in a row on the same triangles; of a machine all parts
    together, by laws that serve all of them.

    folder, worn: as for `maps_of_cycles`; no map of a law by which nothing wears
    """
    parts = [maps_of_cycles(folder, each) for each in worn]
    if not all(parts):
        return []
    first, last = _longest_stretch([each.surface.triangles for each in parts[0]])
    surface = parts[0][first].surface
    laws = [law for law in told_laws(parts[0]) if all(law in told_laws(maps) for maps in parts)]
    found = []
    for law in laws:
        volume, area = np.zeros(len(surface.triangles)), np.full(len(surface.triangles), np.nan)
        for maps in parts:
            area[maps[first].faces] = maps[first].area
            for each in maps[first:last]:
                volume[each.faces] += each.volumes[law]
        mean = volume.sum() / np.nansum(area)
        if mean > 0.0:
            found.append(LawMap(law, surface, volume / area / mean, last - first))
    return found


def _longest_stretch(triangles: Sequence[np.ndarray]) -> tuple[int, int]:
    """Return first and one past last of the most equal ones in a row, the later of several such rows."""
    starts = [0, *(k for k in range(1, len(triangles)) if not np.array_equal(triangles[k - 1], triangles[k]))]
    ends = [*starts[1:], len(triangles)]
    return max(zip(starts, ends, strict=True), key=lambda ends: (ends[1] - ends[0], ends[0]))


def map_table(run: str, maps: Sequence[LawMap]) -> pd.DataFrame:
    """Return run, law, x_mm, y_mm, z_mm of the centroid, area_mm2 and relative_depth (-) of every face that wears."""
    tables = []
    for each in maps:
        worn = np.isfinite(each.relative_depth)
        places = each.surface.points[each.surface.triangles[worn]].mean(axis=1)
        area = areas(each.surface.points, each.surface.triangles)[worn]
        columns = {f"{axis}_m": places[:, number] for number, axis in enumerate("xyz")} | {"area_m2": area}
        table = pd.DataFrame({"run": run, "law": each.law, **columns, "relative_depth": each.relative_depth[worn]})
        tables.append(in_display_units(table))
    return (
        pd.concat(tables, ignore_index=True) if tables else pd.DataFrame({"run": [], "law": [], "relative_depth": []})
    )
