"""One wear step of a run: a cycle's ledger becomes wear, and the wear a new surface that the solver can take."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import (
    HOLDER_PART,
    SurfaceMesh,
    areas,
    node_area_vectors,
    read_surface,
    smallest_angles,
    unit_normals,
    worn_faces,
    write_surface,
)
from bulkwear.postproc.mesh_checks import LEAST_SOLVER_ANGLE
from bulkwear.postproc.wear.balance import GrowthError, lost_volume, volume_balance
from bulkwear.postproc.wear.bodies import body, together
from bulkwear.postproc.wear.caps import Caps, next_cycle_factor, wanted_step
from bulkwear.postproc.wear.displacement import StepTooLargeError
from bulkwear.postproc.wear.fields import CARRIED_VOLUME
from bulkwear.postproc.wear.ledger import pressed_sides
from bulkwear.postproc.wear.mesh_faults import TARGET_EDGE, Bounds, with_target_edges
from bulkwear.postproc.wear.patch import ContactPatch, chosen_radius
from bulkwear.postproc.wear.remesh import RemeshError, remesh
from bulkwear.postproc.wear.side import TouchedSideError, with_sides
from bulkwear.postproc.wear.thickness import with_thickness
from bulkwear.postproc.wear.update import wear_update, with_depths
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.case import Case
from bulkwear.workflows.engine.chain import SURFACE, Chain
from bulkwear.workflows.engine.schedule import Span

SUMMED = ("sliding_work_J", "normal_impulse_N_s", "rolling_work_J", "impact_energy_J")
SUMS = (*SUMMED, "finnie_volume_m3", "worn_volume_m3")  # cell data of the surface, over all cycles so far
MEANS = ("contact_position", "contact_radius")  # columns of a ledger that are no sums: nothing where nothing touched
TOTALS = {  # columns of wear.csv that are sums over all cycles -> what each cycle adds
    "total_worn_volume_m3": "worn_volume_m3",
    "total_applied_volume_m3": "applied_volume_m3",
    "total_excess_volume_m3": "excess_volume_m3",
    "total_beyond_back_volume_m3": "beyond_back_volume_m3",
}
# columns of wear.csv that are no sums over parts
LARGEST = (
    *("largest_step_m", "largest_depth_m", "rim_recession_m"),
    *("step_limit_m", "step_demand", "largest_outward_edge_fraction"),
)
SMALLEST = ("smallest_angle_deg", "next_cycle_factor")
IMPULSE = "impulse_x_N_s"  # a column of ledgers that know from which side a face was pressed


class WearError(RuntimeError):
    """The worn surface cannot go back into the solver; the message names run and cycle.

    places: (k, 3) m, of the faces at fault; None where they are not told
    """

    def __init__(self, message: str, places: np.ndarray | None = None):
        super().__init__(message)
        self.places = places


def wear(
    chain: Chain, span: Span, folder: Path, surface: SurfaceMesh, ledger: pd.DataFrame
) -> dict[str, float | int | bool]:
    """Wear the surface by a cycle's ledger, write it, and return the cycle's row of wear.csv.

    The balance closes on the geometry: pristine minus present volume, plus carried, is the law's volume of all cycles,
    plus what a scheme that does not conserve has removed beyond it. Raises WearError, BalanceError.
    """
    parameters, case = chain.parameters, chain.case
    pristine = read_surface(chain.surface)
    ledger = on_whole_surface(ledger, len(surface.triangles))
    surface = prepared(case, parameters, surface)
    volume = case.law_volume(parameters, span, surface, ledger)
    worn, update, asked = (moved_by_part if case.by_part else moved)(chain, span, surface, ledger, volume)
    if fault := case.worn_through(worn):
        raise WearError(
            f"{chain.name}, cycle {span.cycle}: {fault}; wear is accelerated too much, or the travel too long."
        )
    write_surface(folder / SURFACE, worn)
    row = wear_row(chain, span, surface, ledger, volume) | update_row(chain, span, update) | asked
    lost, rounding = lost_volume(pristine, worn)
    due = lost - row["total_excess_volume_m3"] + row["total_beyond_back_volume_m3"]
    error = volume_balance(due, row["carried_volume_m3"], row["total_worn_volume_m3"], rounding)
    return {**row, "balance_error": error}


def prepared(case: Case, parameters: Mapping[str, Any], surface: SurfaceMesh) -> SurfaceMesh:
    """Return the surface with what its updates need: pieces, and in the first cycle target edges, for the elements as
    built are what remeshing aims at, and the local thickness where the case knows it.
    """
    surface = with_sides(surface)
    if TARGET_EDGE not in surface.point_data:
        surface = with_target_edges(surface)
        if (thickness := case.local_thickness(parameters, surface)) is not None:
            surface = with_thickness(surface, thickness)
    return surface


def moved(
    chain: Chain, span: Span, surface: SurfaceMesh, ledger: pd.DataFrame, volume: np.ndarray
) -> tuple[SurfaceMesh, dict[str, float], dict[str, float | int]]:
    """Return the surface after a cycle's wear, remeshed, the record of the update, and what caps and remeshing tell.

    A surface that would grow, fold or be beyond repair is worn again with smaller caps there, or everywhere; what it
    does not lose now is carried. Raises WearError when the smallest ones do not help.
    """
    parameters, case = chain.parameters, chain.case
    caps = Caps(node_limits(case, parameters, surface, span), surface)
    options = {
        "wall": case.rim_direction,
        "slice_ends": case.slice_ends(parameters),
        "patch": contact_patch(parameters, ledger),
        "scheme": parameters["wear"]["scheme"],
        "pressed": pressed(surface, ledger),
        "back": "go_on" if parameters["wear"].get("worn_through") == "go_on" else "cap",
    }
    while True:
        cap = caps.cap
        try:
            worn, update = update_of_cycle(chain, span, surface, volume, cap, options)
            asked = {"step_limit_m": float(cap.max()), **planned(case, parameters, span, surface, worn)}
            asked |= case.geometry_columns(surface, worn, volume > 0.0)
            worn, remeshing = remeshed(chain, span, with_sums(worn, surface, ledger, volume), surface)
            break
        except WearError as fault:
            if not caps.shrunk(fault.places):
                raise
    return worn, update, asked | remeshing


def moved_by_part(
    chain: Chain, span: Span, surface: SurfaceMesh, ledger: pd.DataFrame, volume: np.ndarray
) -> tuple[SurfaceMesh, dict[str, float], dict[str, float | int]]:
    """Return what `moved` does of a surface of parts, each worn alone: parts may touch, and stand in one another's way
    in the frames they are drawn in. Parts that do not wear stay as they are.
    """
    part, bodies, updates, told = surface.cell_data["part"], [], [], []
    for label in dict.fromkeys(part.tolist()):
        faces = part == label
        alone = body(surface, faces)
        if label > HOLDER_PART:
            try:
                alone, update, asked = moved(chain, span, alone, ledger[faces].reset_index(drop=True), volume[faces])
            except WearError as fault:
                raise WearError(f"part {chain.case.part_name(chain.parameters, label)}: {fault}") from fault
            updates.append(update)
            told.append(asked)
        else:
            alone = with_sums(alone, alone, ledger[faces], volume[faces])
        bodies.append(alone)
    return together(bodies), _of_parts(updates), _of_parts(told)


def _of_parts(rows: list[dict[str, float | int]]) -> dict[str, float | int]:
    """Return what rows of parts make of the whole: the extremes of some columns, the sums of all others."""
    extremes = {name: max for name in LARGEST} | {name: min for name in SMALLEST}
    return {name: extremes.get(name, sum)(row[name] for row in rows) for name in rows[0]}


def update_of_cycle(
    chain: Chain, span: Span, surface: SurfaceMesh, volume: np.ndarray, cap: np.ndarray, options: Mapping[str, Any]
) -> tuple[SurfaceMesh, dict[str, float]]:
    """Return what `wear_update` does. Raises WearError with run and cycle where a face would grow or turn over, or is
    touched from within the body.
    """
    try:
        return wear_update(surface, volume, cap, **options)
    except (TouchedSideError, GrowthError, StepTooLargeError) as fault:
        raise WearError(f"{chain.name}, cycle {span.cycle}: {fault}") from fault


def pressed(surface: SurfaceMesh, ledger: pd.DataFrame) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the impulse (N s) on front and back of each face (m,), None where the ledger does not know it."""
    if IMPULSE not in ledger:
        return None
    normals = unit_normals(surface.points, surface.triangles)
    return pressed_sides({name: ledger[name].to_numpy() for name in ledger}, normals)


def remeshed(
    chain: Chain, span: Span, worn: SurfaceMesh, before: SurfaceMesh
) -> tuple[SurfaceMesh, dict[str, float | int]]:
    """Return the worn surface within the study's bounds, and what a cycle's row of wear.csv tells of that.

    The surface `before` is one that an earlier cycle left without faces that cut one another, or the pristine one, of
    which nobody has looked. Raises WearError for a surface that cannot be repaired; the message names run, cycle,
    place and cause.
    """
    try:
        apart = (worn.points != before.points).any(axis=1)[worn.triangles].any(axis=1) if span.cycle > 1 else None
        outcome = remesh(as_densities(worn), bounds(chain.parameters), apart)
    except RemeshError as fault:
        raise WearError(f"{chain.name}, cycle {span.cycle}: {fault}", fault.places) from fault
    mesh = as_sums(outcome.mesh, worn) if outcome.faces_changed else worn
    if fault := sliver(mesh):
        raise WearError(f"{chain.name}, cycle {span.cycle}: {fault}", slivers(mesh))
    return mesh, {
        "carried_volume_m3": float(mesh.point_data[CARRIED_VOLUME].sum()),
        "smallest_angle_deg": outcome.faults.smallest_angle_deg,
        "remeshed_faces": outcome.faces_changed,
        "bad_faces_left": int(outcome.faults.faces.sum()),
        "advanced_volume_m3": outcome.advanced_volume_m3,
        "largest_outward_edge_fraction": outcome.largest_outward,
    }


def contact_patch(parameters: Mapping[str, Any], ledger: pd.DataFrame) -> ContactPatch | None:
    """Return where and how far the study spreads the wear of each triangle; None where it does not."""
    wear_parameters = parameters["wear"]
    if wear_parameters["patch"] == "none":
        return None
    position = ledger[[f"contact_position_{axis}_m" for axis in "xyz"]].to_numpy()
    choice = wear_parameters["patch_radius_m"] if wear_parameters["patch"] == "radius" else wear_parameters["patch"]
    simulated, factor = ledger["contact_radius_m"].to_numpy(), parameters["derived"]["physical_patch_factor"]
    return ContactPatch(position, chosen_radius(choice, simulated, factor))


def on_whole_surface(ledger: pd.DataFrame, triangles: int) -> pd.DataFrame:
    """Return a ledger with a row per triangle of the surface, where the solver got a piece of it only."""
    if len(ledger) == triangles:
        return ledger
    whole = ledger.set_index("triangle").reindex(range(triangles))
    sums = [name for name in whole if not name.startswith(MEANS)]
    return whole.fillna(dict.fromkeys(sums, 0.0)).reset_index()


def node_limits(case: Case, parameters: Mapping[str, Any], surface: SurfaceMesh, span: Span) -> np.ndarray:
    """Return how far (m) each node may move in a cycle; nowhere when the study keeps the surface rigid, or the cycle
    stands for no operation: it keeps the shape, and what is carried stays so.
    """
    keeps = bool(span.phase) and not span.stands_for_s
    if keeps or not parameters["wear"]["deform"]:
        return np.zeros(len(surface.points))
    gap = case.closing_gap(parameters, span.steps * parameters["derived"]["time_step_s"])
    return np.fmin(case.lasting_limit(parameters, surface), gap)


def with_sums(worn: SurfaceMesh, before: SurfaceMesh, ledger: pd.DataFrame, volume: np.ndarray) -> SurfaceMesh:
    """Return the worn surface with sums over all cycles so far per triangle: loads, and the wear law's volume."""
    finnie = ledger["finnie_wear"].to_numpy() * areas(before.points, before.triangles)
    added = [*(ledger[name].to_numpy() for name in SUMMED), finnie, volume]
    sums = {name: before.cell_data.get(name, 0.0) + values for name, values in zip(SUMS, added, strict=True)}
    return replace(worn, cell_data={**worn.cell_data, **sums})


def slivers(mesh: SurfaceMesh) -> np.ndarray:
    """Return the places (k, 3) m of the worn triangles that the solver would refuse."""
    refused = worn_faces(mesh) & (smallest_angles(mesh.points, mesh.triangles) <= LEAST_SOLVER_ANGLE)
    return mesh.points[mesh.triangles[refused]].mean(axis=1)


def sliver(mesh: SurfaceMesh) -> str | None:
    """Return a phrase with the place of a worn triangle that the solver would refuse, None without one."""
    angle = np.where(worn_faces(mesh), smallest_angles(mesh.points, mesh.triangles), np.inf)
    at = int(np.argmin(angle))
    if angle[at] > LEAST_SOLVER_ANGLE:
        return None
    place = ", ".join(f"{1e3 * value:.4g}" for value in mesh.points[mesh.triangles[at]].mean(axis=0))
    return (
        f"a worn triangle at ({place}) mm has an angle of {angle[at]:.3g} degrees and remeshing could not mend it, "
        f"allowed is above {LEAST_SOLVER_ANGLE} degrees; wear it in smaller steps, or with larger elements"
    )


def bounds(parameters: Mapping[str, Any]) -> Bounds:
    """Return the bounds beyond which the study remeshes a worn triangle."""
    given = dict(parameters["remeshing"])
    return Bounds(smallest_angle_deg=math.degrees(given.pop("smallest_angle_rad")), **given)


def as_densities(mesh: SurfaceMesh) -> SurfaceMesh:
    """Return the mesh with its sums per triangle as sums per area, which remeshing can hand on to other triangles."""
    area = areas(mesh.points, mesh.triangles)
    return replace(mesh, cell_data={k: v / area if k in SUMS else v for k, v in mesh.cell_data.items()})


def as_sums(mesh: SurfaceMesh, before: SurfaceMesh) -> SurfaceMesh:
    """Return a remeshed surface with sums per triangle again; each part of the sample keeps its sum of before."""
    area, part, old_part = areas(mesh.points, mesh.triangles), mesh.cell_data["part"], before.cell_data["part"]
    first, count = int(old_part.min()), int(old_part.max() - old_part.min()) + 1
    sums = {}
    for name in SUMS:
        values = mesh.cell_data[name] * area
        now, then = (
            np.bincount(labels - first, weights, count)
            for labels, weights in ((part, values), (old_part, before.cell_data[name]))
        )
        sums[name] = values * np.divide(then, now, out=np.ones(count), where=now != 0.0)[part - first]
    return replace(mesh, cell_data={**mesh.cell_data, **sums})


def planned(
    case: Case, parameters: Mapping[str, Any], span: Span, before: SurfaceMesh, worn: SurfaceMesh
) -> dict[str, float]:
    """Return the largest step that the cycle asked for over the cap from the mesh (-), and what that plans."""
    if not parameters["wear"]["deform"]:
        return {"step_demand": 0.0, "next_cycle_factor": 1.0}
    step = np.linalg.norm(worn.points - before.points, axis=1)
    area = np.linalg.norm(node_area_vectors(before.points, before.triangles[worn_faces(before)]), axis=1)
    carried = before.point_data.get(CARRIED_VOLUME, np.zeros(len(step)))
    wanted = wanted_step(step, carried, worn.point_data[CARRIED_VOLUME], area)
    limit = case.lasting_limit(parameters, before)
    gap = case.closing_gap(parameters, span.steps * parameters["derived"]["time_step_s"])
    return {
        "step_demand": float((wanted / limit).max()),
        "next_cycle_factor": next_cycle_factor(wanted, limit, gap),
    }


def wear_row(
    chain: Chain, span: Span, surface: SurfaceMesh, ledger: pd.DataFrame, volume: np.ndarray
) -> dict[str, float | int]:
    """Return what a cycle's row of wear.csv tells of its loads and of the wear law's volume."""
    worn = worn_faces(surface)
    time_step = chain.parameters["derived"]["time_step_s"]
    time_s = span.end * time_step
    finnie = ledger["finnie_wear"].to_numpy() * areas(surface.points, surface.triangles)
    sums = load_sums(surface, ledger)
    return {
        "cycle": span.cycle,
        "time_s": time_s,
        **chain.case.travel_columns(chain.parameters, time_s),
        "sliding_work_J": sums["sliding_work_J"],
        **chain.case.label_columns(surface, volume * worn),
        "finnie_volume_m3": float(finnie[worn].sum()),
        "mean_normal_force_N": sums["normal_impulse_N_s"] / (span.steps * time_step),
    }


def load_sums(surface: SurfaceMesh, ledger: pd.DataFrame) -> dict[str, float]:
    """Return the loads summed over the faces that wear; ledger: a row per triangle of the surface."""
    worn = worn_faces(surface)
    return {name: float(ledger[name].to_numpy()[worn].sum()) for name in ("sliding_work_J", "normal_impulse_N_s")}


def update_row(chain: Chain, span: Span, update: Mapping[str, float]) -> dict[str, float]:
    """Return what a cycle's row of wear.csv tells of the update: volumes, of all cycles so far too, and the mesh."""
    before = state.read_state(chain.folder, span.cycle - 1)["wear"] if span.cycle > 1 else {}
    totals = {name: before.get(name, 0.0) + update[part] for name, part in TOTALS.items()}
    return {**update, **totals}


def worn_surface(chain: Chain, last: Span) -> SurfaceMesh:
    """Return the surface after the last cycle with its mean normal traction (Pa) beside the sums over all cycles, and
    with all depths.
    """
    surface = read_surface(state.cycle_folder(chain.folder, last.cycle) / SURFACE)
    duration = last.end * chain.parameters["derived"]["time_step_s"]
    traction = surface.cell_data["normal_impulse_N_s"] / duration / areas(surface.points, surface.triangles)
    surface = replace(surface, cell_data={**surface.cell_data, "normal_traction_Pa": traction})
    pristine = read_surface(chain.surface)
    if not chain.case.by_part:
        return with_depths(surface, pristine)
    labels = dict.fromkeys(pristine.cell_data["part"].tolist())
    pairs = [[body(mesh, mesh.cell_data["part"] == label) for mesh in (surface, pristine)] for label in labels]
    return together([with_depths(*pair) for pair in pairs])
