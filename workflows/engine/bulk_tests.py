"""Decks of bulk tests: a shear box and a draw-down test, on which contact parameters are calibrated, and a container
that is shaken, in which packings are compared.

The parameters of a test, all SI:

    kind       shear_box, draw_down or packed_container
    box        length_m, width_m, fill_height_m; the draw-down test also opening_m, lower_height_m, front_and_back
    shaking    of the container: amplitude_m, frequency_rad_per_s, duration_s, axis (x, y or z)
    rest       energy_fraction, check_interval_s, calm_checks, longest_s: when all counts as being at rest
    particle, wall_material, floor_material    as in Run.parameters; the draw-down test's floor_material is its front's
    solver, deck    those of the run, or what the test's template uses of them
    seed       of the packing
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from postproc.mesh import write_stl
from postproc.wear.caps import GRAVITY
from workflows.engine import decks as deck
from workflows.engine.derived import PERIODIC, WALLS, derived_materials, rayleigh_time
from workflows.engine.solver import DECK
from workflows.engine.templates import render

MARGIN_DIAMETERS = 2.0  # -, room between the boxes and the domain, in largest diameters
PIT_DIAMETERS = 10.0  # -, domain below the floor of a shear box, where what flows out is taken out
EMPTY_ANNULUS = 1.4  # -, of a slot no particle's centre passes, in particle diameters; Beverloo et al. 1961
# What the types of each deck's materials are.
TYPE_NAMES = {
    "shear_box": ["particle", "side walls", "floor"],
    "draw_down": ["particle", "side walls and floors", "front and back walls"],
    "packed_container": ["particle", "floor", "floor"],
}
AXES = {"x": "1. 0. 0.", "y": "0. 1. 0.", "z": "0. 0. 1."}
WIDTH_PERIODIC = "periodic"  # value of front_and_back, and what a shear box always is
LEAST_WIDTH_DIAMETERS = 4.0  # -, of a periodic slice
MESH_CLEARANCE = 1e-6  # m, between a mesh and the domain's faces
FILL_EXCESS = 1.1  # -, poured over levelled volume: loose packings of rough particles still fill the box


def deck_text(test: Mapping[str, Any]) -> str:
    """Return the deck of a test. Raises DeckError."""
    return render(test["kind"], DECKS[test["kind"]](test))


def write_test(test: Mapping[str, Any], folder: Path) -> None:
    """Write the deck of a test and the meshes that it reads into its folder, where it runs by hand."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / DECK).write_text(deck_text(test))
    for name, (points, triangles) in surfaces(test).items():
        write_stl(folder / f"{name}.stl", points, triangles)


def shear_box(test: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of the deck of a shear box."""
    return {**_filled_box(test), **_shear_box_domain(test)}


def draw_down(test: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of the deck of a draw-down test."""
    return {
        **_filled_box(test),
        **_draw_down_domain(test),
        "half_domain_m": _half_domain(test),
        "lower_floor_m": -test["box"]["lower_height_m"],
        "front_and_back": test["box"]["front_and_back"],
    }


def packed_container(test: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of the deck of a container that is filled and shaken."""
    shaking, margin = test["shaking"], MARGIN_DIAMETERS * max(test["particle"]["diameters_m"])
    return {
        **_filled_box(test),
        "ends": PERIODIC,
        "outflow": "none",
        "state_columns": f"{deck.STATE_COLUMNS} c_contacts",
        "fill_gap_m": 0.0,
        "domain_bottom_m": -margin,
        "domain_top_m": _fill_top(test) + margin,
        "shaking_amplitude_m": shaking["amplitude_m"],
        "shaking_frequency_rad_per_s": shaking["frequency_rad_per_s"],
        "shaking_steps": deck.steps(shaking["duration_s"], time_step(test)),
        "shaking_direction": AXES[shaking["axis"]],
    }


# Kind of test -> what its deck is filled with.
DECKS = {"shear_box": shear_box, "draw_down": draw_down, "packed_container": packed_container}


def slot_length(test: Mapping[str, Any]) -> float:
    """Return the length (m) of the simulated slot: that of the real one, wider for coarse-grained particles.

    A slot of length D discharges as (D - k d)^(3/2): no centre passes within k d / 2 of its edges (W. A. Beverloo, H.
    A. Leniger and J. van de Velde, Chemical Engineering Science 15 (1961) 260-269). D - k d is kept, k = 1.4.
    """
    particle = test["particle"]
    real = particle["median_diameter_m"] / particle["scale"]
    return test["box"]["opening_m"] + EMPTY_ANNULUS * (particle["median_diameter_m"] - real)


def simulated_width(box: Mapping[str, Any], particle: Mapping[str, Any]) -> float:
    """Return the width (m) of a box as simulated: a periodic slice holds at least four median diameters.

    Narrower ones hold a slope up (Yan 2022, section 3.3.2).
    """
    if box.get("front_and_back", WIDTH_PERIODIC) != WIDTH_PERIODIC:
        return box["width_m"]
    return max(box["width_m"], LEAST_WIDTH_DIAMETERS * particle["median_diameter_m"])


def rest_energy(test: Mapping[str, Any]) -> float:
    """Return the mean kinetic energy (J) of a particle, that of its centre, below which all counts as being at rest.

    It is a fraction of m g d, what the median particle gains when it falls by its own diameter.
    """
    particle = test["particle"]
    diameter = particle["median_diameter_m"]
    mass = particle["density_kg_per_m3"] * math.pi / 6.0 * diameter**3
    return test["rest"]["energy_fraction"] * mass * GRAVITY * diameter


def time_step(test: Mapping[str, Any]) -> float:
    """Return the time step (s): a fraction of the Rayleigh time of the smallest particle."""
    particle = test["particle"]
    return test["solver"]["rayleigh_fraction"] * rayleigh_time(
        min(particle["diameters_m"]) / 2.0,
        particle["density_kg_per_m3"],
        particle["shear_modulus_pa"],
        particle["poissons_ratio"],
    )


def surfaces(test: Mapping[str, Any]) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return {mesh: (points (4, 3) in m, triangles (2, 3))} of the flat meshes that a test's deck reads."""
    if test["kind"] == "packed_container":
        return {}
    length = test["box"]["length_m"]
    domain = shear_box(test) if test["kind"] == "shear_box" else draw_down(test)
    whole = domain["domain_back_m"] + MESH_CLEARANCE, domain["domain_front_m"] - MESH_CLEARANCE
    below = -MARGIN_DIAMETERS * max(test["particle"]["diameters_m"])
    half = _half_domain(test)
    if test["kind"] == "shear_box":
        return {"floor": _rectangle(half, 0.0, length, 0.0), "outflow": _rectangle(half, *whole, below)}
    back, front = (length - slot_length(test)) / 2.0, (length + slot_length(test)) / 2.0
    return {
        "back_floor": _rectangle(half, 0.0, back, 0.0),
        "front_floor": _rectangle(half, front, length, 0.0),
        "gate": _rectangle(half, back, front, 0.0),
        "outflow": _rectangle(half, *whole, below),
    }


def _rectangle(half_width: float, start: float, end: float, height: float) -> tuple[np.ndarray, np.ndarray]:
    points = [(-half_width, start), (half_width, start), (half_width, end), (-half_width, end)]
    return np.array([(x, y, height) for x, y in points]), np.array([[0, 1, 2], [0, 2, 3]])


def _half_domain(test: Mapping[str, Any]) -> float:
    """Return half the domain's width (m): that of the box, and room behind its front and back where they are walls."""
    behind = MARGIN_DIAMETERS * max(test["particle"]["diameters_m"])
    return test["box"]["width_m"] / 2.0 + (behind if test["box"].get("front_and_back") == "walls" else 0.0)


def _filled_box(test: Mapping[str, Any]) -> dict[str, Any]:
    """Return what both decks need: materials, particles, filling, and when all is at rest."""
    particle, box, rest = (test[key] for key in ("particle", "box", "rest"))
    step = time_step(test)
    materials = derived_materials(bulk_materials(test))
    integration = deck.integration(test, step, particle, 1)
    integration.pop("report_steps")  # the looks for rest are the lines of progress
    gap = max(particle["diameters_m"]) * deck.FILL_GAP_DIAMETERS
    return {
        **integration,
        **deck.material_tables(particle, test["wall_material"], test["floor_material"], materials),
        "type_names": TYPE_NAMES[test["kind"]],
        "ends": WALLS,
        "outflow": "weighed",
        "state_columns": deck.STATE_COLUMNS,
        "half_width_m": box["width_m"] / 2.0,
        "box_length_m": box["length_m"],
        "fill_bottom_m": gap,
        "fill_top_m": _fill_top(test),
        "fill_gap_m": gap,
        "fill_fraction": deck.FILL_FRACTION,
        "fall_speed_m_per_s": deck.FALL_SPEED,
        "level_m": box["fill_height_m"] - particle["median_diameter_m"] / 2.0,
        "density_kg_per_m3": particle["density_kg_per_m3"],
        "particle_diameter_m": particle["diameters_m"],
        "size_distribution": deck.size_distribution(particle["mass_fractions"]),
        "size_count": len(particle["mass_fractions"]),
        "seeds": deck.primes(test["seed"], len(particle["diameters_m"]) + 2),
        "check_steps": deck.steps(rest["check_interval_s"], step),
        "most_checks": math.ceil(rest["longest_s"] / rest["check_interval_s"]),
        "calm_checks": rest["calm_checks"],
        "rest_energy_j": rest_energy(test),
    }


def bulk_materials(test: Mapping[str, Any]) -> dict[str, Any]:
    """Return the sections of a test under the names that the sliding sample's have."""
    names = {"particle": "particle", "sample_material": "wall_material", "floor_material": "floor_material"}
    return {**{name: test[key] for name, key in names.items()}, "solver": test["solver"]}


def _fill_top(test: Mapping[str, Any]) -> float:
    height, packed = test["box"]["fill_height_m"], test["particle"]["bulk_solid_fraction"]
    return height * packed / deck.FILL_FRACTION * FILL_EXCESS


def _shear_box_domain(test: Mapping[str, Any]) -> dict[str, float]:
    """Return the domain of a shear box: what slides out over the edge flies no further than the box is high."""
    largest = max(test["particle"]["diameters_m"])
    return {
        "domain_back_m": -MARGIN_DIAMETERS * largest,
        "domain_front_m": test["box"]["length_m"] + test["box"]["fill_height_m"],
        "domain_bottom_m": -PIT_DIAMETERS * largest,
        "domain_top_m": _fill_top(test) + MARGIN_DIAMETERS * largest,
    }


def _draw_down_domain(test: Mapping[str, Any]) -> dict[str, float]:
    margin = MARGIN_DIAMETERS * max(test["particle"]["diameters_m"])
    return {
        "domain_back_m": -margin,
        "domain_front_m": test["box"]["length_m"] + margin,
        "domain_bottom_m": -test["box"]["lower_height_m"] - margin,
        "domain_top_m": _fill_top(test) + margin,
    }
