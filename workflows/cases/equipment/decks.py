"""The words of the decks of equipment, see templates/README.md. SI throughout."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, write_stl
from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.cases.equipment.motions import motion_of, surface_runs
from bulkwear.workflows.cases.equipment.parameters import filled_mass, sums_of
from bulkwear.workflows.cases.equipment.surfaces import faces_of, feed_face, rectangle, room_needed
from bulkwear.workflows.engine import decks as deck
from bulkwear.workflows.engine.derived import neighbour_skin
from bulkwear.workflows.engine.neighbour_lists import list_sizes
from bulkwear.workflows.engine.schedule import Span

Parameters = Mapping[str, Any]

INLET = "feed-face.stl"  # in a cycle's folder; no part can have a name with a hyphen
DOMAIN = "domain.in"  # in the run's folder
EXTRUDED_DIAMETERS = 2.0  # of the room before the inlet in which particles are placed, in largest diameters
FASTEST = 10.0  # m/s, that a particle may have where it leaves the domain, to be seen there before
MOVING_SKIN_OVER_RADIUS = 1.0  # -, skin of neighbour lists over the smallest radius, where meshes move
FED_SKIN_OVER_RADIUS = (
    2.0  # -, the most that a fast feed asks for; beyond, dense flow pays more for its lists than it saves
)
LIST_STEPS = 16.0  # time steps that a list is to last at the fall's speed
CELLS_PER_PARTICLE = 8.0  # of the room in which neighbours are looked for: dense flow has fewer
SOLVER_CELL, LARGEST_CELL = 0.5, 4.0  # -, a cell's side over how far neighbours are looked for: the solver's, the most
STRAY_STEPS = 200  # between two looks at particles near the domain's faces
MARGIN_DIAMETERS = 4.0  # room round the parts, in largest diameters
SHELL_SHARE = 0.75  # of that room, from the domain's faces, in which particles count as strays


def equipment_start(run: Parameters) -> dict[str, Any]:
    """Return the words of the deck of the first block: filling, or the feed begins."""
    filling, bulk = run["filling"], run["particle"]
    words = {"filling": "yes" if filling else "no", "domain_file": f"../{DOMAIN}"}
    if filling:
        axis = "xyz".index(filling["axis"])
        across = [filling["centre_m"][k] for k in range(3) if k != axis]
        radius = 0.5 * max(bulk["diameters_m"])
        half = 0.5 * filling["length_m"] - (0.0 if _boundary(run, filling["axis"]) == "p" else radius)
        ends = [filling["centre_m"][axis] + sign * half for sign in (-1.0, 1.0)]
        words |= {
            "filling_axis": filling["axis"],
            "filling_centre_m": across,
            "filling_radius_m": filling["radius_m"] - radius,
            "filling_ends_m": ends,
            "filled_mass_kg": filled_mass(run),
        }
    return {**words, **_common(run, 0, 0)}


def equipment(run: Parameters, span: Span, restart: str) -> dict[str, Any]:
    """Return the words of the deck of a wear cycle: one block."""
    begin = run["derived"]["run_in_steps"] + span.first_step
    return {"begin": restart, "block_steps": span.steps, **_common(run, span.cycle, begin)}


def _common(run: Parameters, cycle: int, begin: int) -> dict[str, Any]:
    """Return what both decks say; begin: steps of the run before the cycle."""
    derived, particle, inlet = run["derived"], run["particle"], run["inlet"]
    seeds = deck.primes(run["bulk"]["seed"], len(particle["diameters_m"]) + 4)
    feed: dict[str, Any] = {"fed": "yes" if inlet else "no"}
    if inlet:
        feed |= {
            "inlet_file": INLET,
            "rate_kg_per_s": inlet["rate_kg_per_s"],
            "feed_velocity_m_per_s": inlet["velocity_m_per_s"],
            "extruded_m": EXTRUDED_DIAMETERS * max(particle["diameters_m"]),
        }
    integration = deck.integration(run, derived["time_step_s"], particle, derived["first_cycle_steps"])
    return {
        "cycle": cycle,
        "begin_step": begin,
        "end_step": begin + derived["first_cycle_steps"],
        "parts": [part_words(run, number, cycle, begin) for number in range(len(run["parts"]))],
        "outlets": outlet_words(run),
        **feed,
        "density_kg_per_m3": particle["density_kg_per_m3"],
        "particle_diameter_m": particle["diameters_m"],
        "size_distribution": deck.size_distribution(particle["mass_fractions"]),
        "size_count": len(particle["mass_fractions"]),
        "seeds": seeds,
        "boundary": " ".join(_boundary(run, axis) for axis in "xyz"),
        **material_words(run),
        **integration,
        "skin_m": skin(run),
        **list_sizes(run, particle, skin(run)),
        "report_steps": derived["report_steps"],
        "picture_steps": derived["picture_steps"],
        "stray_steps": STRAY_STEPS,
    }


def moving_mesh(part: Parameters) -> bool:
    """Return whether the mesh of a part moves; that of a belt rests, its surface runs."""
    return bool(part["motion"]) and not surface_runs(part["motion"])


def skin(run: Parameters) -> float:
    """Return the skin (m) of the neighbour lists.

    A mesh that moves makes new lists every few steps, however still the particles are: with a skin of a whole radius
    a mill took two thirds of the processor time. A feed that falls makes them as often as it has fallen half a skin:
    with two radii instead of 0.4 a chute took three fifths, a thin stream of 8 m/s a sixth.
    """
    radius = 0.5 * min(run["particle"]["diameters_m"])
    least = neighbour_skin(run["particle"])
    if any(moving_mesh(part) for part in run["parts"]):
        least = MOVING_SKIN_OVER_RADIUS * radius
    way = 2.0 * LIST_STEPS * run["derived"]["time_step_s"] * fall_speed(run)
    return max(least, min(way, FED_SKIN_OVER_RADIUS * radius))


def fall_speed(run: Parameters) -> float:
    """Return the speed (m/s) that the feed has where it has fallen to the lowest outlet, 0 without a feed."""
    inlet, outlets = run["inlet"], run["outlets"]
    if not inlet:
        return 0.0
    lowest = min((given["centre_m"][2] for given in (outlets or {}).values()), default=inlet["centre_m"][2])
    fall = max(0.0, inlet["centre_m"][2] - lowest)
    return math.sqrt(float(np.square(inlet["velocity_m_per_s"]).sum()) + 2.0 * GRAVITY * fall)


def cell_side(run: Parameters, ends: Sequence[Sequence[float]]) -> float:
    """Return the side (m) of the cells in which neighbours are looked for.

    The solver's own is half of how far they are looked for. Where few particles are in a large room it goes through
    empty cells, for each mesh and list: those of a thin stream took three quarters of the time.

    ends: of the room along x, y and z (m)
    """
    room = math.prod(high - low for low, high in ends)
    wide = (room / (CELLS_PER_PARTICLE * max(1.0, run["derived"]["held_particles"]))) ** (1.0 / 3.0)
    return min(max(SOLVER_CELL * _reach(run), wide), largest_cell(run))


def largest_cell(run: Parameters) -> float:
    """Return the largest side (m) that a cell in which neighbours are looked for may have."""
    return LARGEST_CELL * _reach(run)


def _reach(run: Parameters) -> float:
    """Return how far (m) neighbours are looked for."""
    return max(run["particle"]["diameters_m"]) + skin(run)


def _boundary(run: Parameters, axis: str) -> str:
    return "p" if run["periodic"] and run["periodic"]["axis"] == axis else "f"


def part_words(run: Parameters, number: int, cycle: int, begin: int) -> dict[str, Any]:
    """Return what a deck says of a part: its mesh, how it goes on from that step, its ledger."""
    part = run["parts"][number]
    motion, mesh = motion_of(part["motion"]), f"{mesh_name(part)}_{cycle}"
    return {
        "name": part["name"],
        "mesh": mesh,
        "type": part["type"],
        "surface_words": motion.mesh_words(),
        "motion_lines": list(motion.deck_lines(mesh, begin * run["derived"]["time_step_s"])),
        "kernels": deck.kernel_words(sums_of(run)),  # of all parts: a run's ledger is one table
    }


def mesh_name(part: Parameters) -> str:
    """Return what the decks call the mesh of a part, before the number of the cycle: no other fix begins alike."""
    return f"part_{part['name']}"


def outlet_words(run: Parameters) -> list[dict[str, Any]]:
    """Return what a deck says of each outlet."""
    return [
        {"name": name, "file": f"../{outlet_file(name)}", "normal": given["normal"]}
        for name, given in (run["outlets"] or {}).items()
    ]


def outlet_file(name: str) -> str:
    """Return the name of an outlet's file in the folder of a run."""
    return f"outlet_{name}.stl"


def material_words(run: Parameters) -> dict[str, Any]:
    """Return the property tables: type 1 is the bulk material, then the materials of the parts."""
    sections, derived = [run["particle"], *run["walls"]], run["derived"]
    contacts = [section["contact"] for section in sections]
    return {
        "type_names": [section["name"] for section in sections],
        "youngs_modulus_pa": derived["youngs_moduli_pa"],
        "poissons_ratio": [section["poissons_ratio"] for section in sections],
        "restitution": _pairs([contact["restitution"] for contact in contacts]),
        "sliding_friction": _pairs([contact["sliding_friction"] for contact in contacts]),
        "rolling_friction_coefficient": _pairs(derived["rolling_frictions"]),
        "finnie_coefficient_per_pa": _pairs([run["wear"]["wear_coefficient_per_pa"]] * len(sections)),
    }


def _pairs(with_particle: list[float]) -> list[list[float]]:
    """Return the symmetric table of a property that is known for every type against a particle; walls never touch."""
    count = len(with_particle)
    return [[with_particle[max(i, j)] for j in range(count)] for i in range(count)]


# ---------------------------------------------------------------- files that all decks of a run read


def domain(run: Parameters, surface: SurfaceMesh) -> list[list[float]]:
    """Return the ends (m) of what is simulated along x, y and z: as given, or room round parts, inlet and outlets."""
    ends = [list(pair) for pair in zip(*given, strict=True)] if (given := _given_domain(run)) else _room(run, surface)
    if periodic := run["periodic"]:
        ends["xyz".index(periodic["axis"])] = [periodic["low_m"], periodic["high_m"]]
    return ends


def _given_domain(run: Parameters) -> tuple[list[float], list[float]] | None:
    return (run["domain"]["low_m"], run["domain"]["high_m"]) if run["domain"] else None


def _room(run: Parameters, surface: SurfaceMesh) -> list[list[float]]:
    """Return the ends (m) along x, y and z of the room round parts, inlet and outlets."""
    margin = room_round(run)
    corners = [np.asarray(rectangle(each).points) for each in (run["outlets"] or {}).values()]
    if run["inlet"]:
        corners.append(inlet_room(run))
    if filling := run["filling"]:
        corners.append(np.asarray([filling["centre_m"]]))
    for number, part in enumerate(run["parts"]):
        faces = surface.triangles[faces_of(surface, number, part)]
        corners.append(np.array(room_needed(surface.points[np.unique(faces)], part, longest_s(run))))
    points = np.concatenate(corners)
    return [[float(low) - margin, float(high) + margin] for low, high in zip(points.min(0), points.max(0), strict=True)]


def room_round(run: Parameters) -> float:
    """Return the room (m) round the parts: no particle crosses it between two looks unseen."""
    seen = FASTEST * STRAY_STEPS * run["derived"]["time_step_s"] / SHELL_SHARE
    return max(MARGIN_DIAMETERS * max(run["particle"]["diameters_m"]), seen)


def inlet_room(run: Parameters) -> np.ndarray:
    """Return the corners (8, 3) m of the room in which particles are placed before they go through the inlet."""
    corners, inlet = rectangle(run["inlet"]).points, run["inlet"]
    normal = np.asarray(inlet["normal"]) / np.linalg.norm(inlet["normal"])
    return np.concatenate([corners, corners - EXTRUDED_DIAMETERS * max(run["particle"]["diameters_m"]) * normal])


def longest_s(run: Parameters) -> float:
    """Return the longest that a run may last (s)."""
    derived = run["derived"]
    return (derived["run_in_steps"] + derived["travel_steps"]) * derived["time_step_s"]


def write_shared(run: Parameters, surface: SurfaceMesh, folder: Path) -> None:
    """Write outlets and domain into the folder of a run."""
    for name, given in (run["outlets"] or {}).items():
        mesh = rectangle(given)
        write_stl(folder / outlet_file(name), mesh.points, mesh.triangles)
    ends = domain(run, surface)
    shell = [end for pair, axis in zip(ends, "xyz", strict=True) for end in _shell(run, pair, axis)]
    lines = [
        "# What is simulated, and the room near its faces in which particles count as strays (m).",
        f"region  domain block {' '.join(f'{end:.9g}' for pair in ends for end in pair)} units box",
        f"region  near_faces block {' '.join(shell)} side out units box",
        *_cell_lines(run, ends),
    ]
    (folder / DOMAIN).write_text("\n".join(lines) + "\n")


def _cell_lines(run: Parameters, ends: Sequence[Sequence[float]]) -> list[str]:
    """Return what a deck says of the cells of neighbours, nothing where they are the solver's own."""
    side = cell_side(run, ends)
    if side <= SOLVER_CELL * _reach(run):
        return []
    return [
        "# Neighbours are looked for in cells of this side (m): the room is large for its particles.",
        f"neigh_modify binsize {side:.9g}",
    ]


def write_feed(run: Parameters, cycle: int, folder: Path) -> None:
    """Write the inlet of a cycle into its folder, where there is one."""
    if run["inlet"]:
        mesh = feed_face(run["inlet"], run["bulk"]["seed"], cycle)
        write_stl(folder / INLET, mesh.points, mesh.triangles)


def _shell(run: Parameters, ends: list[float], axis: str) -> list[str]:
    """Return where the room of strays begins at the two ends of an axis; a periodic one has none."""
    inside = SHELL_SHARE * room_round(run)
    if _boundary(run, axis) == "p":
        inside = ends[0] - ends[1]  # beyond both
    return [f"{ends[0] + inside:.9g}", f"{ends[1] - inside:.9g}"]
