"""What follows from the settings of a sliding sample; SI throughout."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from bulkwear.meshes.sample import skirt_width
from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.config.patterns import highest_point, size_ratio
from bulkwear.workflows.engine.derived import (
    ADAPTIVE,
    HEADROOM_DIAMETERS,
    ROUNDING,
    WALLS,
    WINDOW,
    derived_materials,
    physical_patch_factor,
    smallest_rayleigh_time,
    whole_steps,
    window_lengths,
)
from bulkwear.workflows.engine.grains import largest_extent, spheres_per_grain
from bulkwear.workflows.engine.pouring import bulk_density, particles_of_mass

THIN_BED_LAYERS = 3.0  # below three layers of particles a bed is no bed
RAMP = ("height_above_floor_m", "skirt_slope_rad", "skirt_radius_m")  # what the sample's skirt depends on


def ramp_hop(velocity: float, slope: float) -> float:
    """Return how far (m) a particle flies off the top of a ramp: 2 v^2 tan(slope) / g, ballistic, small slope.

    velocity in m/s along the floor, slope in rad. The sample is hardly loaded over this length.
    """
    return 2.0 * velocity**2 * math.tan(slope) / GRAVITY


def last_slope(sample: Mapping[str, Any]) -> float:
    """Return the slope (rad) at which the ramp reaches the sample; of a curved one that of its last element."""
    radius, slope = sample["skirt_radius_m"], sample["skirt_slope_rad"]
    return min(slope, math.atan(sample["element_size_m"] / (2.0 * radius))) if radius else slope


def flow_measures(parameters: Mapping[str, Any]) -> dict[str, float]:
    """Return what the bins of a run's flow need (SI), see `workflows.cases.sliding_sample.flow_history.RunFlow`."""
    return {
        "width": parameters["sample"]["width_m"],
        "length": parameters["sample"]["length_m"],
        "bed_width": parameters["bed"]["width_m"],
        "bed_length": parameters["derived"]["bed_length_m"],
        "bed_thickness": parameters["bed"]["thickness_m"],
        "velocity": parameters["sliding"]["velocity_m_per_s"],
        "time_step": parameters["derived"]["time_step_s"],
        "particle_scale": parameters["particle"]["scale"],
    }


def derived_parameters(parameters: dict[str, Any]) -> dict[str, Any]:
    """Return what follows from the other sections (SI)."""
    layers = parameters["bed"]["thickness_m"] / parameters["particle"]["median_diameter_m"]
    return {
        "layers": layers,
        "thin_bed": layers < THIN_BED_LAYERS * (1.0 - ROUNDING),
        "equivalent_size_ratio": size_ratio(parameters),
        "physical_patch_factor": physical_patch_factor(parameters),
        **derived_materials(parameters),
        **_derived_geometry(parameters),
        **_derived_times(parameters),
    }


def _derived_geometry(parameters: dict[str, Any]) -> dict[str, float]:
    """Return the skirt's width, and the bed's length, mass and particles.

    A bed between end walls is as long as the whole travel and its ends; a periodic one comes round again; one in a
    window has room for the fresh bed of an exchange, for the strip that holds it and for what keeps it off the wake.
    """
    sample, bed, sliding = parameters["sample"], parameters["bed"], parameters["sliding"]
    particle = parameters["particle"]
    travel = sliding["run_in_m"] + sliding["travel_m"] if bed["ends"] == WALLS else 0.0  # of the bed within its domain
    window = [bed["exchange_m"], *window_lengths(particle)] if bed["ends"] == WINDOW else []
    length = math.fsum([bed["ahead_m"], bed["behind_m"], sample["length_m"], travel, *window])
    mass = bulk_density(particle) * length * bed["width_m"] * bed["thickness_m"]
    return {
        "ramp_hop_m": ramp_hop(sliding["velocity_m_per_s"], last_slope(sample)),
        "skirt_width_m": skirt_width(*(sample[key] for key in RAMP)),
        "bed_length_m": length,
        "bed_start_m": sample["length_m"] / 2.0 + bed["behind_m"] - length,
        "bed_travel_m": travel,
        "highest_point_m": sample["height_above_floor_m"]
        + highest_point(parameters["pattern"])
        + HEADROOM_DIAMETERS * largest_extent(particle),
        "bed_mass_kg": mass,
        "bed_particles": spheres_per_grain(particle) * round(particles_of_mass(particle, mass)),
    }


def _derived_times(parameters: dict[str, Any]) -> dict[str, Any]:
    """Return time steps (s) and numbers of steps."""
    particle, sliding, solver = parameters["particle"], parameters["sliding"], parameters["solver"]
    rayleigh = smallest_rayleigh_time(particle)
    largest = solver["rayleigh_fraction"] * rayleigh
    sampled = solver.get("sampling_interval_steps", 1)  # only sampled contacts ask for whole samples in a cycle
    cycles = 1 if sliding["cycles"] == ADAPTIVE else sliding["cycles"]
    steps, time_step = whole_steps(sliding["travel_m"] / sliding["velocity_m_per_s"], largest, sampled * cycles)
    travel_per_step = sliding["velocity_m_per_s"] * time_step
    first = steps // cycles
    if sliding["cycles"] == ADAPTIVE:
        first = min(max(round(sliding["first_cycle_m"] / travel_per_step / sampled), 1) * sampled, steps)
    return {
        "rayleigh_time_s": rayleigh,
        "largest_time_step_s": largest,
        "time_step_s": time_step,
        "travel_steps": steps,
        "first_cycle_steps": first,
        "run_in_steps": round(sliding["run_in_m"] / travel_per_step),
        "picture_interval_steps": max(round(solver["picture_interval_m"] / travel_per_step), 1),
    }
