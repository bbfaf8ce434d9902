"""Checks of a machine with its drawings, before any solver starts.

Nothing is said of parts that cut one another, as brackets, shafts and flanges do: particles touch each of them.
Neither of facets that look inward: closed bodies are turned outward when they are read, and of open ones the touched
side is found. What cannot be mended is a body that is drawn as the room for the material in place of the walls round
it: material would be placed within a body, which is what is looked for.
"""

from __future__ import annotations

import itertools
import math
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bulkwear.meshes.own.read import check_file, read_solids
from bulkwear.meshes.own.solids import UNITS
from bulkwear.meshes.own.weld import compacted
from bulkwear.postproc.mesh import SurfaceMesh, areas, boundary_nodes
from bulkwear.postproc.wear.bodies import body
from bulkwear.postproc.wear.directions import ON_END
from bulkwear.postproc.wear.thickness import thickness_to_back
from bulkwear.workflows.cases.equipment.bodies import closed_faces, diagonal, first_within, is_within, share_a_piece
from bulkwear.workflows.cases.equipment.change_out import BY_MASS, REMAINING, asked_by, rule_of, settings_key
from bulkwear.workflows.cases.equipment.checks import LEFT_TO_WEAR, thin_phrase
from bulkwear.workflows.cases.equipment.decks import (
    LARGEST_CELL,
    SOLVER_CELL,
    domain,
    largest_cell,
    longest_s,
    moving_mesh,
)
from bulkwear.workflows.cases.equipment.drawings import drawing
from bulkwear.workflows.cases.equipment.drum_checks import check_drums
from bulkwear.workflows.cases.equipment.motions import motion_of
from bulkwear.workflows.cases.equipment.placing import filling_box, placing_room
from bulkwear.workflows.cases.equipment.stream_checks import check_stream
from bulkwear.workflows.cases.equipment.surfaces import faces_of, looks, rectangle, room_needed
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.config.run_checks import millimetres

LARGEST_PART = 200.0  # m, diagonal: larger than any machine that particles are simulated in
LIKELY_UNITS = ("mm", "m", "cm", "in", "ft")  # of drawings, the likeliest first
MOST_CELLS = 2**31 - 1  # by which the solver sorts particles in memory, a small integer of its; 8 GB
OUTSIDE = 1e-8  # m; a facet whose middle is farther out is lost to the solver (SMALL_DMBRDR of LIGGGHTS 3.8.0)
GRAZING = 0.05  # -, of the smallest diameter: particles that overlap a wall by less are not thrown off
FINEST = 0.01  # -, of half the longest side of such room: parts that are narrower there may be missed
MEASURED = 0.1  # -, by which a thickness along normals may be less than the one drawn: a flight leans, a vault is bent
THICKER = 4.0  # -, that a thickness which is given may be over that of half the body's area: ribs and bars are thicker
WAY_OF_RADIUS = 0.5  # -, that a part, or a particle at the inlet, may go in a time step
MOST_SHARED = 0.9  # -, of a body's area that may lie on another part's: a thin plate on a wall has half of it there
AXES = "xyz"

Parameters = Mapping[str, Any]


def check_machine(run: Parameters, surface: SurfaceMesh) -> None:
    """Raise ConfigError, one sentence with part and key, for a machine that cannot be simulated.

    run: the sections that `surface_sections` returns; surface: all parts as one, as they are drawn
    """
    parts = [body(surface, faces_of(surface, number, part)) for number, part in enumerate(run["parts"])]
    for part, mesh in zip(run["parts"], parts, strict=True):
        _check_size(run, part, diagonal(mesh.points))
    _check_drawn_once(run, parts)
    _check_cells(run, surface)
    for part, mesh in zip(run["parts"], parts, strict=True):
        _check_within(run, surface, part, mesh)
        _check_speed(run, part, mesh)
    _check_stays(run, parts)
    check_drums(run["parts"], parts)
    _check_feed_speed(run)
    _check_inlet(run, parts)
    check_stream(run, parts)
    _check_filling(run, surface, parts)
    for part, mesh in zip(run["parts"], parts, strict=True):
        _check_thickness(run, part, mesh)


# ---------------------------------------------------------------- sizes


def check_units(run: Parameters) -> None:
    """Raise ConfigError for a part whose unit makes it far too large or too small; what cannot be read is left alone.

    It needs few elements, of CAD files: those of a wrong unit may be too many for anything else.
    """
    with tempfile.TemporaryDirectory() as folder:
        for part in run["parts"]:
            try:
                check_file(path := drawing(part["file"], Path(folder)))
                solids, scale = read_solids(path, part["unit"], LARGEST_PART, part.get("solid"))
            except (ValueError, OSError):
                continue
            _check_size(run, part, scale * diagonal(compacted(solids).points))


def _check_size(run: Parameters, part: Parameters, size: float) -> None:
    """Raise ConfigError for a part of a size (m) that no part has, with the unit that would make sense."""
    least = run["particle"]["median_diameter_m"]
    if least <= size <= LARGEST_PART:
        return
    drawn = size / UNITS[part["unit"]]
    fitting = [f"in {unit} it is {_length(drawn * UNITS[unit])}" for unit in LIKELY_UNITS]
    fits = [least <= drawn * UNITS[unit] <= LARGEST_PART for unit in LIKELY_UNITS]
    hint = next((text for text, fit in zip(fitting, fits, strict=True) if fit), "no unit makes sense of it")
    raise ConfigError(
        f"parts.{part['name']}.unit is {part['unit']}, in which {part['file']} is {_length(size)} large, allowed are"
        f" {millimetres(least)}, a median particle as coarse-grained, to {LARGEST_PART:g} m: {hint}."
    )


def _check_drawn_once(run: Parameters, parts: Sequence[SurfaceMesh]) -> None:
    """Raise ConfigError for a body that two parts have, as a liner of its own beside an assembly that holds it still.

    A liner has half of its surface on the wall behind it, the same body nearly all; a wall drawn as a sheet lies on the
    liner with all of its own, but not the liner on it.
    """
    for (one, mesh), (other, beside) in itertools.combinations(zip(run["parts"], parts, strict=True), 2):
        if one["motion"] != other["motion"]:
            continue
        if share_a_piece(mesh, beside, MOST_SHARED):
            raise ConfigError(
                f"parts.{other['name']}.file is {other['file']}, of which a body lies where parts.{one['name']}"
                f" ({one['file']}) is and would press on particles once more, allowed is each body once: name what is"
                " meant of a drawing of several by parts.<name>.solid."
            )


def _length(metres: float) -> str:
    """Return a length as people say it."""
    return f"{metres:.4g} m" if metres >= 1.0 else f"{1e3 * metres:.4g} mm"


def _check_cells(run: Parameters, surface: SurfaceMesh) -> None:
    """Raise ConfigError for room that takes more cells than the solver counts: their side is half a reach, always."""
    sides, cell = [high - low for low, high in domain(run, surface)], SOLVER_CELL / LARGEST_CELL * largest_cell(run)
    cells = math.prod(side / cell for side in sides)
    if cells <= MOST_CELLS:
        return
    rooms = {part["name"]: diagonal(np.array(_room_of(run, surface, part))) for part in run["parts"]}
    largest = max(rooms, key=rooms.__getitem__)
    found = f"{' x '.join(f'{side:.3g}' for side in sides)} m, {cells:.1e} cells of {millimetres(cell)}"
    raise ConfigError(
        f"{'domain' if run['domain'] else 'parts'}: what is simulated is {found} by which particles are sorted,"
        f" allowed are {MOST_CELLS:.1e}: a part is in a wrong unit or far from the others (parts.{largest} needs the"
        f" most room, {_length(rooms[largest])}), an outlet or domain is too large, or particle_scale is too small."
    )


def _room_of(run: Parameters, surface: SurfaceMesh, part: Parameters) -> tuple[np.ndarray, np.ndarray]:
    faces = surface.triangles[faces_of(surface, run["parts"].index(part), part)]
    return room_needed(surface.points[np.unique(faces)], part, longest_s(run))


def _check_within(run: Parameters, surface: SurfaceMesh, part: Parameters, mesh: SurfaceMesh) -> None:
    """Raise ConfigError for a part that stands out of the domain or the slice, at any time."""
    low, high = room_needed(mesh.points, part, longest_s(run))
    for k, (first, last) in enumerate(domain(run, surface)):
        beyond = max(first - low[k], high[k] - last)
        if beyond > OUTSIDE:
            sliced = run["periodic"] and run["periodic"]["axis"] == AXES[k]
            section = "periodic" if sliced else "domain"
            moving = " on its way" if part["motion"] else ""
            mend = "cut the drawing there" if sliced and not part["motion"] else "make room for it"
            found = f"{part['file']} stands out by {millimetres(beyond)} along {AXES[k]}{moving}"
            raise ConfigError(
                f"parts.{part['name']}.file: {found}, from {millimetres(low[k])} to {millimetres(high[k])}, allowed is"
                f" {millimetres(first)} to {millimetres(last)}, {section}.low_mm and {section}.high_mm: {mend}."
            )


def _check_speed(run: Parameters, part: Parameters, mesh: SurfaceMesh) -> None:
    """Raise ConfigError for a part that goes through particles within a time step."""
    if not moving_mesh(part):
        return
    motion, step = motion_of(part["motion"]), run["derived"]["time_step_s"]
    ways = [
        np.linalg.norm(motion.placed(mesh.points, time + step) - motion.placed(mesh.points, time), axis=1).max()
        for time in looks(part["motion"], longest_s(run))
    ]
    most = WAY_OF_RADIUS * 0.5 * min(run["particle"]["diameters_m"])
    if max(ways) > most:
        raise ConfigError(
            f"parts.{part['name']}.motion takes {part['file']} {1e3 * max(ways):.4g} mm far in a time step, at"
            f" {max(ways) / step:.4g} m/s, allowed are {1e3 * most:.4g} mm, {WAY_OF_RADIUS:g} of the smallest radius:"
            " it would go through particles."
        )


def _check_stays(run: Parameters, parts: Sequence[SurfaceMesh]) -> None:
    """Raise ConfigError for a part whose motion takes it out of the machine, farther than it is long itself."""
    end, openings = longest_s(run), filter(None, [run["inlet"], *(run["outlets"] or {}).values()])
    rooms = [*(rectangle(each).points for each in openings), *([filling_box(run)] if run["filling"] else [])]
    for part, mesh in zip(run["parts"], parts, strict=True):
        if not part["motion"] or part["motion"]["kind"] != "translation":
            continue
        motion, others = motion_of(part["motion"]), [each.points for each in parts if each is not mesh]
        if not (rooms or others):
            continue
        machine = np.concatenate([*rooms, *others])
        way = _apart(motion.placed(mesh.points, end), machine) - _apart(mesh.points, machine)
        if way > diagonal(mesh.points):
            raise ConfigError(
                f"parts.{part['name']}.motion.velocity_m_per_s takes {part['file']} out of the machine, {_length(way)}"
                f" away from all else after {end:.4g} s, the longest that the run may get, allowed is a way within it:"
                " wear would be counted in empty air; let it stop (stop_s), go slower, or the run be shorter"
                " (start_up.most_s, sampling.block_s)."
            )


def _apart(points: np.ndarray, others: np.ndarray) -> float:
    """Return the largest gap (m) between the boxes of two sets of points along an axis, 0 where they overlap."""
    return float(
        np.maximum(points.min(axis=0) - others.max(axis=0), others.min(axis=0) - points.max(axis=0)).max(initial=0.0)
    )


# ---------------------------------------------------------------- where material is placed


def _check_feed_speed(run: Parameters) -> None:
    """Raise ConfigError for a feed whose particles go through others, or through a part, within a time step."""
    if not run["inlet"]:
        return
    speed, step = float(np.linalg.norm(run["inlet"]["velocity_m_per_s"])), run["derived"]["time_step_s"]
    most = WAY_OF_RADIUS * 0.5 * min(run["particle"]["diameters_m"])
    if speed * step > most:
        raise ConfigError(
            f"inlet.velocity_m_per_s is {speed:.4g} m/s fast, {1e3 * speed * step:.4g} mm in a time step, allowed are"
            f" {most / step:.4g} m/s: {1e3 * most:.4g} mm, {WAY_OF_RADIUS:g} of the smallest radius."
        )


def _check_inlet(run: Parameters, parts: Sequence[SurfaceMesh]) -> None:
    """Raise ConfigError for an inlet within a part, or with a part in the room where particles are placed."""
    if not run["inlet"]:
        return
    corners = placing_room(run)
    centre, sides = corners.mean(axis=0), corners[[1, 3, 4]] - corners[0]
    lengths = np.linalg.norm(sides, axis=1)
    turned, half = (sides / lengths[:, None]).T, 0.5 * lengths - _grazed(run)
    found = f"inlet.centre_mm is {_place(run['inlet']['centre_m'])}"
    room = " x ".join(f"{1e3 * length:.4g}" for length in lengths)
    for part, mesh in zip(run["parts"], parts, strict=True):
        motion, closed = motion_of(part["motion"]), closed_faces(mesh.triangles)
        for time in looks(part["motion"], longest_s(run)):
            points = motion.placed(mesh.points, time)
            hit = first_within((points - centre) @ turned, mesh.triangles, half, _spacing(run, half))
            if hit is not None:
                place = _place(hit @ turned.T + centre) + (f" at {time:.3g} s" if part["motion"] else "")
                raise ConfigError(
                    f"{found}, allowed is a place where the room of {room} mm behind the inlet, in which particles are"
                    f" placed, is free: parts.{part['name']} reaches into it at {place}."
                )
            if is_within(points, mesh.triangles[closed], centre):
                raise ConfigError(f"{found}, {_inside(part, 'an inlet')}.")


def _check_filling(run: Parameters, surface: SurfaceMesh, parts: Sequence[SurfaceMesh]) -> None:
    """Raise ConfigError for a filling that a part reaches into at the start, or out of what is simulated."""
    filling = run["filling"]
    if not filling:
        return
    low, high = filling_box(run)
    for k, (first, last) in enumerate(domain(run, surface)):
        if (beyond := max(first - low[k], high[k] - last)) > OUTSIDE:
            raise ConfigError(
                f"filling.centre_mm is {_place(filling['centre_m'])}, from where the cylinder stands out of what is"
                f" simulated by {millimetres(beyond)} along {AXES[k]}, allowed is none of it: give domain, or a smaller"
                " cylinder."
            )
    centre, half = 0.5 * (low + high), 0.5 * (high - low) - _grazed(run)
    across = [k for k in range(3) if AXES[k] != filling["axis"]]
    radius = filling["radius_m"] - _grazed(run)
    for part, mesh in zip(run["parts"], parts, strict=True):
        points = motion_of(part["motion"]).placed(mesh.points, 0.0) - centre
        hit = first_within(
            points, mesh.triangles, half, _spacing(run, half), lambda at: np.hypot(*at[:, across].T) < radius
        )
        if hit is not None:
            place = f"{_place(hit + centre)}, {millimetres(np.hypot(*hit[across]))} from its axis"
            raise ConfigError(
                f"filling.radius_mm is {1e3 * filling['radius_m']:.6g}, allowed is a cylinder that is free at the"
                f" start: parts.{part['name']} reaches into it at {place}."
            )
        if is_within(points, mesh.triangles[closed_faces(mesh.triangles)], np.zeros(3)):
            found = f"filling.centre_mm is {_place(filling['centre_m'])}"
            raise ConfigError(f"{found}, {_inside(part, 'a filling')}.")


def _inside(part: Parameters, what: str) -> str:
    return (
        f"within the closed body parts.{part['name']}, allowed is {what} in the room where material flows: if"
        f" {part['file']} is that room, draw the walls round it in its place"
    )


def _place(point: Sequence[float]) -> str:
    return f"({', '.join(f'{1e3 * value + 0.0:.4g}' for value in point)}) mm"


def _grazed(run: Parameters) -> float:
    return GRAZING * min(run["particle"]["diameters_m"])


def _spacing(run: Parameters, half: np.ndarray) -> float:
    return max(0.5 * min(run["particle"]["diameters_m"]), FINEST * float(half.max()))


# ---------------------------------------------------------------- liners


def _check_thickness(run: Parameters, part: Parameters, mesh: SurfaceMesh) -> None:
    """Raise ConfigError for a liner that is thinner, over half of its area, than its elements are long, or no thicker
    than what shall remain of it, and for an open surface without a thickness: what is measured in it is the way across.
    """
    if not part["wears"]:
        return
    rule, asked = rule_of(run, part), asked_by(part["name"], part)
    if BY_MASS in rule and not _is_closed(run, mesh):
        raise ConfigError(
            f"{asked}.{BY_MASS} is given, and parts.{part['name']} has no mass, allowed are closed bodies: the surface"
            f" of {part['file']} is open; change it by change_out_remaining_mm."
        )
    if "thickness_m" in part:
        if part["thickness_m"] > (size := diagonal(mesh.points)):
            raise ConfigError(
                f"parts.{part['name']}.thickness_mm is {1e3 * part['thickness_m']:.6g}, allowed is at most"
                f" {millimetres(size)}, the size of {part['file']}."
            )
        if _is_closed(run, mesh) and part["thickness_m"] > THICKER * (drawn := thickness_of(mesh)):
            raise ConfigError(
                f"parts.{part['name']}.thickness_mm is {1e3 * part['thickness_m']:.6g}, allowed is at most"
                f" {millimetres(THICKER * drawn)}, {THICKER:g} of the thickness that {part['file']} has, over half of"
                " its area; without the key it is measured."
            )
        return
    if not _is_closed(run, mesh):
        raise ConfigError(
            f"parts.{part['name']}.thickness_mm is missing, allowed is the thickness of the liner: the surface of"
            f" {part['file']} is open, first at {_place(mesh.points[boundary_nodes(mesh.triangles)[0]])}, and has no"
            " back to be measured to."
        )
    thickness, source = thickness_of(mesh), f"the thickness in {part['file']}"
    if thickness < part["edge_m"] * (1.0 - MEASURED):
        allowed = thin_phrase(thickness, source)
        raise ConfigError(f"parts.{part['name']}.edge_mm is {1e3 * part['edge_m']:.6g}, allowed is {allowed}.")
    if (remaining := rule.get(REMAINING, 0.0)) > (most := (1.0 - LEFT_TO_WEAR) * thickness):
        raise ConfigError(
            f"{asked}.{settings_key(REMAINING)} is {1e3 * remaining:.6g}, allowed is at most {millimetres(most)}: of"
            f" {millimetres(thickness)}, {source}, of parts.{part['name']}, a hundredth at least is there to wear."
        )


def _is_closed(run: Parameters, mesh: SurfaceMesh) -> bool:
    """Return whether a part has no open edge but at an end of the slice."""
    rim, periodic = mesh.points[boundary_nodes(mesh.triangles)], run["periodic"]
    if not len(rim) or not periodic:
        return not len(rim)
    along = rim[:, AXES.index(periodic["axis"])]
    return bool((np.minimum(abs(along - periodic["low_m"]), abs(along - periodic["high_m"])) < ON_END).all())


def thickness_of(mesh: SurfaceMesh) -> float:
    """Return the thickness (m) to the back that half of a part's area has less of; infinite for one without a back."""
    size = areas(mesh.points, mesh.triangles)
    distance = thickness_to_back(mesh.points, mesh.triangles)[0]
    known = np.isfinite(distance).any(axis=1)
    if not known.any():
        return math.inf
    values, size = np.nanmean(distance[known], axis=1), size[known]
    order = np.argsort(values)
    return float(values[order][np.searchsorted(np.cumsum(size[order]), 0.5 * size.sum())])
