"""Bulk tests, boxes that are filled and come to rest: what the decks of all kinds share. Cases have kinds of their own.

The parameters of a test, all SI:

    kind       of those registered
    box        length_m, width_m, fill_height_m, and what its kind adds
    rest       energy_fraction, check_interval_s, calm_checks, longest_s: when all counts as being at rest
    particle, wall_material, floor_material    as in Run.parameters
    solver, deck    those of the run, or what the test's template uses of them
    seed       of the packing
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bulkwear.postproc.mesh import write_stl
from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.engine import decks as deck
from bulkwear.workflows.engine.derived import WALLS, derived_materials, rayleigh_time
from bulkwear.workflows.engine.solver import DECK
from bulkwear.workflows.engine.templates import render

MARGIN_DIAMETERS = 2.0  # -, room between the boxes and the domain, in largest diameters
FILL_EXCESS = 1.1  # -, poured over levelled volume: loose packings of rough particles still fill the box
Meshes = Mapping[str, tuple[np.ndarray, np.ndarray]]  # {name: (points (n, 3) in m, triangles (m, 3))}


@dataclass(frozen=True)
class Kind:
    """A kind of bulk test; its template has its name.

    deck: parameters of its deck from a test
    surfaces: the meshes that its deck reads, from a test
    """

    deck: Callable[[Mapping[str, Any]], dict[str, Any]]
    surfaces: Callable[[Mapping[str, Any]], Meshes] = lambda test: {}


_REGISTERED: dict[str, Kind] = {}


def register(name: str, kind: Kind) -> None:
    """Make a kind of test known under its name; the module that makes such tests does it."""
    _REGISTERED[name] = kind


def kind_of(test: Mapping[str, Any]) -> Kind:
    """Return the kind of a test."""
    return _REGISTERED[test["kind"]]


def deck_text(test: Mapping[str, Any]) -> str:
    """Return the deck of a test. Raises DeckError."""
    return render(test["kind"], kind_of(test).deck(test))


def write_test(test: Mapping[str, Any], folder: Path) -> None:
    """Write the deck of a test and the meshes that it reads into its folder, where it runs by hand."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / DECK).write_text(deck_text(test))
    for name, (points, triangles) in kind_of(test).surfaces(test).items():
        write_stl(folder / f"{name}.stl", points, triangles)


# ---------------------------------------------------------------- what the decks of all kinds share


def margin_of(test: Mapping[str, Any]) -> float:
    """Return the room (m) between a box and the end of the domain."""
    return MARGIN_DIAMETERS * max(test["particle"]["diameters_m"])


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


def filled_box(test: Mapping[str, Any], type_names: Sequence[str]) -> dict[str, Any]:
    """Return what all decks need: materials, particles, filling, and when all is at rest.

    type_names: what the types of its materials are
    """
    particle, box, rest = (test[key] for key in ("particle", "box", "rest"))
    step = time_step(test)
    materials = derived_materials(bulk_materials(test))
    integration = deck.integration(test, step, particle, 1)
    integration.pop("report_steps")  # the looks for rest are the lines of progress
    gap = max(particle["diameters_m"]) * deck.FILL_GAP_DIAMETERS
    return {
        **integration,
        **deck.material_tables(particle, test["wall_material"], test["floor_material"], materials),
        "type_names": list(type_names),
        "ends": WALLS,
        "outflow": "weighed",
        "state_columns": deck.STATE_COLUMNS,
        "half_width_m": box["width_m"] / 2.0,
        "box_length_m": box["length_m"],
        "fill_bottom_m": gap,
        "fill_top_m": fill_top(test),
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


def fill_top(test: Mapping[str, Any]) -> float:
    """Return the height (m) up to which a box is poured before it is levelled."""
    height, packed = test["box"]["fill_height_m"], test["particle"]["bulk_solid_fraction"]
    return height * packed / deck.FILL_FRACTION * FILL_EXCESS
