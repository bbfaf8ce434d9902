"""Parameters of a run of the circular wear tester, and what follows from them. SI throughout."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.cases.circular_tester.decks import bed_length, half_width, mean_radius
from bulkwear.workflows.config.patterns import highest_point, pattern_section, size_ratio
from bulkwear.workflows.engine.derived import (
    HEADROOM_DIAMETERS,
    derived_materials,
    particle_section,
    physical_patch_factor,
    smallest_rayleigh_time,
    template_sections,
    wall_section,
    wear_section,
    whole_steps,
)
from bulkwear.workflows.engine.pouring import bulk_density, particles_of_mass
from bulkwear.workflows.engine.templates import used_sections

REPORTS_PER_REVOLUTION = 60  # lines of a log, of which the coefficient of variation of a revolution is made


def run_parameters(settings: Mapping[str, Any], materials: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of a run, derived ones included; settings of its row, SI."""
    sample = dict(settings["sample"])
    surface = sample.pop("surface")
    sliding, tester = settings["sliding"], settings["tester"]
    particle = materials["particles"][settings["bed"]["material"]]
    parameters = {
        "ledger": settings["ledger"],
        "sample": sample,
        "pattern": pattern_section(surface, settings["pattern"]),
        "tester": tester,
        "bed": settings["bed"],
        "sliding": {
            **sliding,
            "cycles": round(sliding["revolutions"] * sliding["cycles_per_revolution"]),
            "velocity_m_per_s": sliding["angular_speed_rad_per_s"] * mean_radius(tester),
        },
        "wear": wear_section(settings["wear"], particle),
        "remeshing": settings["remeshing"],
        **template_sections(settings),
        "particle": particle_section(settings["bed"]["material"], materials, settings["particle_scale"]),
        "sample_material": wall_section(sample["material"], materials),
        "floor_material": wall_section(settings["bed"]["floor_material"], materials),
    }
    return {**parameters, "derived": derived_parameters(parameters)}


def derived_parameters(parameters: dict[str, Any]) -> dict[str, Any]:
    """Return what follows from the other sections: moduli, bed, pressure on the sample, time steps."""
    tester, particle = parameters["tester"], parameters["particle"]
    return {
        "equivalent_size_ratio": size_ratio(parameters),
        "physical_patch_factor": physical_patch_factor(parameters),
        **derived_materials(parameters),
        "layers": tester["depth_m"] / particle["median_diameter_m"],
        "layers_below": (tester["bed_height_m"] - tester["depth_m"] - parameters["sample"]["thickness_m"])
        / particle["median_diameter_m"],
        "bed_length_m": bed_length(tester),
        "bed_particles": bed_particles(parameters),
        "bulk_pressure_pa": bulk_density(particle) * GRAVITY * tester["depth_m"],
        "headroom_m": highest_point(parameters["pattern"]) + HEADROOM_DIAMETERS * max(particle["diameters_m"]),
        **_derived_times(parameters),
    }


def bed_particles(parameters: Mapping[str, Any]) -> int:
    """Return about how many particles the trough holds: its volume less the sample's, at the bulk's solid fraction."""
    tester, particle, sample = (parameters[name] for name in ("tester", "particle", "sample"))
    volume = bed_length(tester) * 2.0 * half_width(tester) * tester["bed_height_m"]
    volume -= sample["width_m"] * sample["length_m"] * sample["thickness_m"]
    return round(particles_of_mass(particle, bulk_density(particle) * volume))


def _derived_times(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Return time steps (s) and numbers of steps; a revolution has whole wear cycles."""
    particle, sliding, solver = (parameters[name] for name in ("particle", "sliding", "solver"))
    rayleigh = smallest_rayleigh_time(particle)
    largest = solver["rayleigh_fraction"] * rayleigh
    duration = sliding["revolution_rad"] / sliding["angular_speed_rad_per_s"]
    of_revolution, time_step = whole_steps(duration, largest, sliding["cycles_per_revolution"])
    first = of_revolution // sliding["cycles_per_revolution"]
    return {
        "rayleigh_time_s": rayleigh,
        "largest_time_step_s": largest,
        "time_step_s": time_step,
        "revolution_s": duration,
        "revolution_steps": of_revolution,
        "travel_steps": first * sliding["cycles"],
        "first_cycle_steps": first,
        "run_in_steps": max(round(sliding["run_in_revolutions"] * of_revolution), 1),
        "picture_interval_steps": max(round(of_revolution / solver["pictures_per_revolution"]), 1),
        "report_steps": max(of_revolution // REPORTS_PER_REVOLUTION, 1),
    }


def bed_parameters(parameters: Mapping[str, Any], headroom: float) -> dict[str, Any]:
    """Return exactly what determines a steady bed (SI); runs with equal ones share it.

    headroom: m, of the block in the sample's place over the plane of the sample.
    """
    derived, tester, sample = parameters["derived"], parameters["tester"], parameters["sample"]
    names = ("particle", "sample_material", "floor_material")
    step, sliding = derived["largest_time_step_s"], parameters["sliding"]
    revolution = round(derived["revolution_s"] / step)
    return {
        **{name: parameters[name] for name in names},
        **{key: value for key, value in tester.items() if tester["shape"] == "channel" or key != "channel_rad"},
        "sample_width_m": sample["width_m"],
        "sample_length_m": sample["length_m"],
        "thickness_m": sample["thickness_m"],
        "headroom_m": headroom,
        "velocity_m_per_s": sliding["velocity_m_per_s"],
        "seed": parameters["bed"]["seed"],
        **used_sections("tester_bed", parameters, shape=tester["shape"]),
        "rolling_friction_for_solver": derived["rolling_friction_for_solver"],
        "youngs_modulus_pa": derived["youngs_modulus_pa"],
        "coefficient_per_pa": 1.0,  # of the solver's own wear, which nobody reads here
        "time_step_s": step,
        "revolution_s": derived["revolution_s"],
        "steady_steps": max(round(sliding["steady_revolutions"] * revolution), 1),
        "report_steps": max(revolution // REPORTS_PER_REVOLUTION, 1),
    }
