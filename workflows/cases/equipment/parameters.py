"""Parameters of a run of equipment, and what follows from them. SI throughout."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from bulkwear.postproc.flow.size_classes import size_classes
from bulkwear.postproc.wear.kernel_sums import kernel_sums
from bulkwear.workflows.cases.equipment.drawings import drawing_digest
from bulkwear.workflows.config.law_settings import completed
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.engine.derived import (
    ADAPTIVE,
    ROUNDING,
    laws_beside,
    particle_section,
    physical_patch_factor,
    rolling_coefficient_for_solver,
    smallest_rayleigh_time,
    template_sections,
    wall_section,
    wear_section,
    whole_steps,
    youngs_modulus,
)
from bulkwear.workflows.engine.pouring import bulk_density, particles_of_mass
from bulkwear.workflows.engine.worn_pair import BESIDE

REPORTS = 20  # rows of the table of the flow in a block
SHARED = ("inlet", "filling", "outlets", "periodic", "domain")  # sections that a study may leave out
PART_DEFAULTS = ("wear_coefficient_per_pa", "wear_coefficient_error", "law")  # of the section `wear`
SECONDS_PER_HOUR = 3600.0


def run_parameters(settings: Mapping[str, Any], materials: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of a run, derived ones included; settings of its row, SI."""
    particle = bulk_particle(settings, materials)
    walls = wall_materials(settings["parts"], materials)
    types = [wall["name"] for wall in walls]
    parts = [part_section(name, part, settings["wear"], types) for name, part in settings["parts"].items()]
    worn = next((part for part in parts if part["wears"]), parts[0])
    parameters = {
        "ledger": settings["ledger"],
        "parts": parts,
        "bulk": {"seed": settings["bulk"]["seed"]},
        **{name: settings.get(name) for name in SHARED},
        **{name: settings[name] for name in ("start_up", "sampling", "updates", "operation", "remeshing")},
        "wear": wear_section(settings["wear"], materials["particles"][settings["bulk"]["material"]]),
        **template_sections(settings),
        "particle": particle,
        "walls": walls,
        "sample_material": walls[worn["type"] - 2],
        "sliding": {"cycles": ADAPTIVE},
    }
    derived, updates = derived_parameters(parameters), parameters["updates"]
    # other hours wear the shape in other steps: a run with updates is simulated from them too
    worn_for = derived["operation_s"] if updates["most"] else 0.0
    return {**parameters, "updates": {**updates, "operation_s": worn_for}, "derived": derived}


def bulk_particle(settings: Mapping[str, Any], materials: Mapping[str, Any]) -> dict[str, Any]:
    """Return the bulk material, coarse-grained; its sizes by sieves where the study gives them."""
    bulk, scale = settings["bulk"], settings["particle_scale"]
    particle = particle_section(bulk["material"], materials, scale)
    if "passing" not in bulk:
        return {"sizes": "classes of the material"} | particle
    passing = bulk["passing"]
    try:
        found = size_classes(passing["sieve_m"], passing["fraction"], bulk["finest_fraction"], bulk["size_classes"])
    except ValueError as fault:
        raise ConfigError(f"bulk.passing: {fault}.") from None
    return particle | {
        "diameters_m": [scale * float(value) for value in found.diameters_m],
        "mass_fractions": [float(value) for value in found.mass_fractions],
        "median_diameter_m": scale * float(found.median_m),
        "sizes": found.told,
    }


def wall_materials(parts: Mapping[str, Any], materials: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the materials of the parts, each once, in the order of the solver's types from 2 on."""
    known = materials["walls"]
    for name, part in parts.items():
        if part["material"] not in known:
            allowed = ", ".join(sorted(known))
            raise ConfigError(f"parts.{name}.material is '{part['material']}', allowed is one of {allowed}.")
    return [wall_section(name, materials) for name in dict.fromkeys(part["material"] for part in parts.values())]


def part_section(name: str, part: Mapping[str, Any], wear: Mapping[str, Any], types: list[str]) -> dict[str, Any]:
    """Return a part: as given, with what the section `wear` says where it says nothing itself."""
    given = {key: value for key, value in part.items() if key not in ("role", "motion", "parameters")}
    law = given.get("law", wear["law"])
    beside, own = wear.get(BESIDE, {}), part.get("parameters", {})
    shared = beside[law] if law in beside else wear.get("parameters", {}) if law == wear["law"] else {}
    return {
        "name": name,
        **{key: wear[key] for key in PART_DEFAULTS if key in wear},
        **given,
        "wears": part["role"] == "wears",
        "motion": part.get("motion"),
        "type": types.index(part["material"]) + 2,
        "law_parameters": {**to_si(completed(law, {})), **shared, **own},
        "drawing": _drawn(name, part["file"]),
    }


def _drawn(name: str, file: str) -> str:
    """Return the hash of the drawing of a part. Raises ConfigError."""
    try:
        return drawing_digest(file)
    except ConfigError as fault:
        raise ConfigError(f"parts.{name}.file: {fault}") from None


def laws_of(run: Mapping[str, Any]) -> list[tuple[str, dict[str, float]]]:
    """Return the name of the wear law of each part that wears, with `law_values`."""
    return [(part["law"], law_values(part)) for part in run["parts"] if part["wears"]]


def sums_of(run: Mapping[str, Any]) -> dict[str, dict[str, float]]:
    """Return `kernel_sums` of the laws of all parts that wear, and those beside them."""
    return kernel_sums([*laws_of(run), *laws_beside(run)])


def law_values(part: Mapping[str, Any]) -> dict[str, float]:
    """Return the parameters (SI) of a part's wear law, its true coefficient included."""
    return {"wear_coefficient_per_pa": part["wear_coefficient_per_pa"], **part["law_parameters"]}


def derived_parameters(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Return what follows from the other sections: moduli, time step, lengths of cycles, what is predicted."""
    particle, walls, solver = parameters["particle"], parameters["walls"], parameters["solver"]
    names = {"particle": particle, "sample_material": parameters["sample_material"]}
    rayleigh = smallest_rayleigh_time(particle)
    largest, sampling = solver["rayleigh_fraction"] * rayleigh, parameters["sampling"]
    multiple = math.lcm(REPORTS, sampling["pictures_per_block"])
    steps, time_step = whole_steps(sampling["block_s"], largest, multiple)
    return {
        "youngs_modulus_pa": {key: _modulus(section) for key, section in names.items()},
        "youngs_moduli_pa": [_modulus(section) for section in (particle, *walls)],
        "rolling_frictions": [
            rolling_coefficient_for_solver(section["contact"]["rolling_friction"], solver, contact)
            for section, contact in zip(
                (particle, *walls), ("particle_particle", *("particle_wall" for _ in walls)), strict=True
            )
        ],
        "physical_patch_factor": physical_patch_factor(dict(parameters) | {"derived": {}}),
        "rayleigh_time_s": rayleigh,
        "largest_time_step_s": largest,
        "time_step_s": time_step,
        "first_cycle_steps": steps,
        "run_in_steps": steps,
        "travel_steps": (most_blocks(parameters) - 1) * steps,
        "report_steps": steps // REPORTS,
        "picture_steps": steps // sampling["pictures_per_block"],
        "operation_s": operation_s(parameters),
        "held_particles": held_particles(parameters),
    }


def _modulus(section: Mapping[str, Any]) -> float:
    return youngs_modulus(section["shear_modulus_pa"], section["poissons_ratio"])


def start_up_blocks(parameters: Mapping[str, Any]) -> int:
    """Return the most blocks that a start-up may take, the first one included: the second one is always part of it."""
    return max(math.ceil(parameters["start_up"]["most_s"] / parameters["sampling"]["block_s"] * (1.0 - ROUNDING)), 2)


def most_blocks(parameters: Mapping[str, Any]) -> int:
    """Return the most blocks that a run may take."""
    updates = parameters["updates"]
    worn = updates["most"] + updates["worn_blocks"] if updates["most"] else 0
    return start_up_blocks(parameters) + parameters["sampling"]["most_blocks"] + worn


def operation_s(parameters: Mapping[str, Any]) -> float:
    """Return the operation that is predicted (s)."""
    operation, inlet = parameters["operation"], parameters["inlet"]
    if "duration_s" in operation:
        return operation["duration_s"]
    if "throughput_kg" in operation and inlet:
        return operation["throughput_kg"] / inlet["rate_kg_per_s"]
    return 0.0


def filled_mass(parameters: Mapping[str, Any]) -> float:
    """Return the mass that the machine is filled with (kg); 0 without a filling."""
    filling, particle = parameters["filling"], parameters["particle"]
    if not filling:
        return 0.0
    volume = math.pi * filling["radius_m"] ** 2 * filling["length_m"]
    return filling["fraction"] * volume * bulk_density(particle)


def drawn_mass_scatter(particle: Mapping[str, Any], mass: float) -> float:
    """Return the standard deviation (kg) of the mass of as many particles, their sizes drawn by number, as have that
    mass (kg) on average.
    """
    classes = list(zip(particle["diameters_m"], particle["mass_fractions"], strict=True))
    masses = [particle["density_kg_per_m3"] * math.pi / 6.0 * diameter**3 for diameter, _ in classes]
    numbers = [fraction / each for each, (_, fraction) in zip(masses, classes, strict=True)]
    mean, square = (
        sum(number * each**power for number, each in zip(numbers, masses, strict=True)) / sum(numbers)
        for power in (1, 2)
    )
    return math.sqrt(mass / mean * max(square - mean**2, 0.0))


def held_particles(parameters: Mapping[str, Any]) -> float:
    """Return about how many particles a machine holds: its filling, and what comes in within half the longest start-up,
    which lasts twice as long as material needs through the machine.
    """
    inlet = parameters["inlet"]
    fed = inlet["rate_kg_per_s"] * 0.5 * parameters["start_up"]["most_s"] if inlet else 0.0
    return particles_of_mass(parameters["particle"], filled_mass(parameters) + fed)
