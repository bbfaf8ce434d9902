"""Bulk tests, boxes that are filled and come to rest: what the decks of all kinds share. Cases have kinds of their own.

The parameters of a test, all SI:

    kind       of those registered
    box        length_m, width_m, fill_height_m; ends: periodic along y, else walls; front_and_back: walls, else
               periodic; fill_mass_kg_per_m: mass of the filling, else by its height and the bulk density;
               and what its kind adds
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
from bulkwear.workflows.engine.derived import WALLS, derived_materials, smallest_rayleigh_time
from bulkwear.workflows.engine.grains import largest_extent
from bulkwear.workflows.engine.pouring import bulk_density, fill_gap, fill_height, periodic_gap, poured_particles
from bulkwear.workflows.engine.solver import DECK
from bulkwear.workflows.engine.templates import render

MARGIN_DIAMETERS = 2.0  # -, room between the boxes and the domain, in largest diameters
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
    return MARGIN_DIAMETERS * largest_extent(test["particle"])


def rest_energy(test: Mapping[str, Any]) -> float:
    """Return the mean kinetic energy (J) of a particle, that of its centre, below which all counts as being at rest.

    It is a fraction of m g d, what the median particle gains when it falls by its own diameter.
    """
    particle = test["particle"]
    diameter = particle["median_diameter_m"]
    mass = particle["density_kg_per_m3"] * math.pi / 6.0 * diameter**3
    return test["rest"]["energy_fraction"] * mass * GRAVITY * diameter


def time_step(test: Mapping[str, Any]) -> float:
    """Return the time step (s): a fraction of the Rayleigh time of the smallest particle, or sphere of a clump."""
    return test["solver"]["rayleigh_fraction"] * smallest_rayleigh_time(test["particle"])


def filled_box(test: Mapping[str, Any], type_names: Sequence[str]) -> dict[str, Any]:
    """Return what all decks need: materials, particles, filling, and when all is at rest.

    type_names: what the types of its materials are
    """
    particle, box, rest = (test[key] for key in ("particle", "box", "rest"))
    step = time_step(test)
    materials = derived_materials(bulk_materials(test))
    integration = deck.integration(test, step, particle, 1)
    integration.pop("report_steps")  # the looks for rest are the lines of progress
    return {
        **integration,
        **deck.material_tables(particle, test["wall_material"], test["floor_material"], materials),
        "type_names": list(type_names),
        "ends": box.get("ends", WALLS),
        "outflow": "weighed",
        "state_columns": deck.STATE_COLUMNS,
        "half_width_m": box["width_m"] / 2.0,
        "fill_half_width_m": box["width_m"] / 2.0 - _gap_across(test),
        "box_length_m": box["length_m"],
        "fill_bottom_m": fill_gap(particle),
        "fill_top_m": fill_top(test),
        "fill_gap_m": _gap_along(test),
        **poured_particles(particle, test["seed"], filled_mass(test)),
        "check_steps": deck.steps(rest["check_interval_s"], step),
        "most_checks": math.ceil(rest["longest_s"] / rest["check_interval_s"]),
        "calm_checks": rest["calm_checks"],
        "rest_energy_j": rest_energy(test),
    }


def bulk_materials(test: Mapping[str, Any]) -> dict[str, Any]:
    """Return the sections of a test under the names that the sliding sample's have."""
    names = {"particle": "particle", "sample_material": "wall_material", "floor_material": "floor_material"}
    return {**{name: test[key] for name, key in names.items()}, "solver": test["solver"]}


def filled_mass(test: Mapping[str, Any]) -> float:
    """Return the mass (kg) that is poured into a box: told per width, or that of its filling at the bulk density."""
    box = test["box"]
    told = box.get("fill_mass_kg_per_m")
    per_width = bulk_density(test["particle"]) * box["length_m"] * box["fill_height_m"] if told is None else told
    return per_width * box["width_m"]


def fill_top(test: Mapping[str, Any]) -> float:
    """Return the height (m) up to which centres are poured; they keep off the walls."""
    box = test["box"]
    across, along = (gap or periodic_gap(test["particle"]) for gap in (_gap_across(test), _gap_along(test)))
    area = (box["width_m"] - 2.0 * across) * (box["length_m"] - 2.0 * along)
    return fill_height(test["particle"], filled_mass(test), area)


def _gap_along(test: Mapping[str, Any]) -> float:
    """Return how far (m) poured centres keep off the ends along y, where these are walls."""
    return fill_gap(test["particle"]) if test["box"].get("ends", WALLS) == WALLS else 0.0


def _gap_across(test: Mapping[str, Any]) -> float:
    """Return how far (m) poured centres keep off front and back, where these are walls."""
    return fill_gap(test["particle"]) if test["box"].get("front_and_back") == WALLS else 0.0
