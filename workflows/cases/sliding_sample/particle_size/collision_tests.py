"""Collisions of single particles with LIGGGHTS: does a scaled one do the same as a real one (Yan 2022, section 4.2)?

The parameters of a test, all SI: particle, wall_material, solver and deck as those of a bulk test (bulk_tests.py), and
collision with speed_m_per_s and sideways_speed_m_per_s, before contact.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from workflows.cases.sliding_sample.particle_size.collision import COLUMNS, DUMP, Spheres
from workflows.engine import decks as deck
from workflows.engine.bulk_tests import bulk_materials, time_step
from workflows.engine.derived import WALLS, derived_materials, youngs_modulus
from workflows.engine.solver import DECK, run_deck
from workflows.engine.templates import render

GAP_RADII = 0.005  # -, between the spheres at the start
DOMAIN_RADII = 10.0  # -, half the domain's width
AFTER = 1.1  # -, times the longest collision: all have parted
NUMBER_FORMAT = " ".join(["%.12g"] * (len(COLUMNS) - 1))


def collision(test: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of the deck of collisions."""
    particle, asked = test["particle"], test["collision"]
    spheres, step = spheres_of(test), time_step(test)
    materials = derived_materials(bulk_materials({**test, "floor_material": test["wall_material"]}))
    integration = {**deck.integration(test, step, particle, 1), "gravity_m_per_s2": 0.0}
    integration.pop("report_steps")
    return {
        **integration,
        **deck.material_tables(particle, test["wall_material"], test["wall_material"], materials),
        "type_names": ["particle", "wall", "wall"],
        "ends": WALLS,
        "radius_m": spheres.radius,
        "smaller_radius_m": spheres.smaller_radius,
        "gap_m": GAP_RADII * spheres.radius,
        "speed_m_per_s": asked["speed_m_per_s"],
        "sideways_speed_m_per_s": asked["sideways_speed_m_per_s"],
        "spin_rad_per_s": asked["sideways_speed_m_per_s"] / spheres.radius,
        "half_width_m": DOMAIN_RADII * spheres.radius,
        "density_kg_per_m3": particle["density_kg_per_m3"],
        "number_format": NUMBER_FORMAT,
        "collision_steps": deck.steps(AFTER * _longest(test), step),
    }


def spheres_of(test: Mapping[str, Any]) -> Spheres:
    """Return what the analysis of a test needs to know: the median particle, the smallest one, and the wall."""
    particle, wall = test["particle"], test["wall_material"]
    return Spheres(
        radius=particle["median_diameter_m"] / 2.0,
        smaller_radius=min(particle["diameters_m"]) / 2.0,
        density=particle["density_kg_per_m3"],
        modulus=youngs_modulus(particle["shear_modulus_pa"], particle["poissons_ratio"]),
        poissons_ratio=particle["poissons_ratio"],
        wall_modulus=youngs_modulus(wall["shear_modulus_pa"], wall["poissons_ratio"]),
        wall_poissons_ratio=wall["poissons_ratio"],
        restitution=particle["contact"]["restitution"],
        wall_restitution=wall["contact"]["restitution"],
    )


def _longest(test: Mapping[str, Any]) -> float:
    """Return how long (s) it takes from the start until all have parted."""
    speed = test["collision"]["speed_m_per_s"]
    lasting = [each.time[-1] for each in spheres_of(test).closed_forms(speed).values()]
    return GAP_RADII * test["particle"]["median_diameter_m"] / 2.0 / speed + max(lasting)


def simulate(test: Mapping[str, Any], folder: Path) -> Path:
    """Run a test in a folder and return the path of its dump. Raises SolverError."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / DECK).write_text(render("collision", collision(test)))
    run_deck(folder)
    return folder / DUMP
