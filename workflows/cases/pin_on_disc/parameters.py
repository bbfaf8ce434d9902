"""Parameters of a pin on a disc, what follows from them, and what is checked before any solver starts. SI."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from bulkwear.postproc.reference.sphere_contact import effective_modulus, hertz_overlap
from bulkwear.workflows.config.run_checks import CheckedRun, Fault, millimetres, physical_modulus_known, shown_inside
from bulkwear.workflows.engine.derived import (
    physical_patch_factor,
    rayleigh_time,
    template_sections,
    wall_section,
    wear_section,
    whole_steps,
    youngs_modulus,
)
from bulkwear.workflows.engine.schedule import LEAST_CYCLE_STEPS

FORCE_WINDOW = math.radians(0.25)  # rad of the track over which a row of forces.csv is a mean
SETTLING_OSCILLATIONS = 60  # of the pin on its contact, until it rests on the flat disc; each leaves 0.83 at e = 0.9
REST_OSCILLATIONS = 20  # until it rests on the surface that a wear update has lowered by less than the overlap
PIN_RADII_BESIDE_TRACK = 4.0  # -, room in the domain
WITHOUT_PATCH = "none"  # wear.patch of the per-triangle rule, which the source applies to single triangles
ELEMENTS_ACROSS_CONTACT = 0.25  # -, a coarser mesh than four contact radii shows no groove
ROUNDING = 1e-9  # relative; of revolutions times cycles


def run_parameters(settings: Mapping[str, Any], materials: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of a run, derived ones included; settings of its row, SI."""
    pin, disc, scale = settings["pin"], settings["disc"], settings["particle_scale"]
    wear = dict(settings["wear"])
    if wear["scheme"] == "per_triangle":
        wear["patch"] = WITHOUT_PATCH
    material = materials["pins"][pin["material"]]
    speed = settings["sliding"]["angular_speed_rad_per_s"]
    parameters = {
        "ledger": settings["ledger"],
        "pin": {**pin, "radius_m": scale * pin["radius_m"]},
        "disc": {**disc, "inner_radius_m": 2.0 * disc["track_radius_m"] - disc["radius_m"]},
        "sliding": {
            **settings["sliding"],
            "cycles": round(settings["sliding"]["revolutions"] * settings["sliding"]["cycles_per_revolution"]),
            "velocity_m_per_s": speed * disc["track_radius_m"],
        },
        "wear": wear_section(wear, material),
        "remeshing": settings["remeshing"],
        **template_sections(settings),
        "particle": {
            "name": pin["material"],
            **{k: v for k, v in material.items() if k != "physical_shear_modulus_pa"},
            "scale": scale,
            "diameters_m": [2.0 * scale * pin["radius_m"]],
        },
        "sample_material": wall_section(disc["material"], materials),
    }
    return {**parameters, "derived": derived_parameters(parameters)}


def derived_parameters(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Return what follows from the other sections: moduli, overlap, how the pin swings, time steps."""
    particle, disc = parameters["particle"], parameters["sample_material"]
    moduli = {
        name: youngs_modulus(parameters[name]["shear_modulus_pa"], parameters[name]["poissons_ratio"])
        for name in ("particle", "sample_material")
    }
    pair = effective_modulus(
        moduli["particle"], particle["poissons_ratio"], moduli["sample_material"], disc["poissons_ratio"]
    )
    radius, load = parameters["pin"]["radius_m"], parameters["pin"]["load_n"]
    overlap = hertz_overlap(load, radius, pair)
    mass = 4.0 / 3.0 * math.pi * radius**3 * particle["density_kg_per_m3"]
    return {
        "youngs_modulus_pa": moduli,
        "effective_modulus_pa": pair,
        "physical_patch_factor": physical_patch_factor(parameters),
        "overlap_m": overlap,
        "pin_mass_kg": mass,
        "pin_oscillation_s": 2.0 * math.pi * math.sqrt(mass * overlap / (1.5 * load)),
        "sliding_distance_m": 2.0
        * math.pi
        * parameters["disc"]["track_radius_m"]
        * parameters["sliding"]["revolutions"],
        **_derived_times(parameters),
    }


def _derived_times(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Return time steps (s) and numbers of steps; a cycle has whole windows of forces, a revolution whole cycles."""
    particle, sliding = parameters["particle"], parameters["sliding"]
    rayleigh = rayleigh_time(
        parameters["pin"]["radius_m"],
        particle["density_kg_per_m3"],
        particle["shear_modulus_pa"],
        particle["poissons_ratio"],
    )
    largest = parameters["solver"]["rayleigh_fraction"] * rayleigh
    arc = 2.0 * math.pi / sliding["cycles_per_revolution"]
    windows = max(round(arc / FORCE_WINDOW), 1)
    steps, time_step = whole_steps(arc / sliding["angular_speed_rad_per_s"], largest, windows)
    return {
        "rayleigh_time_s": rayleigh,
        "largest_time_step_s": largest,
        "time_step_s": time_step,
        "arc_rad": arc,
        "first_cycle_steps": steps,
        "travel_steps": steps * sliding["cycles"],
        "force_interval_steps": steps // windows,
    }


def summed_by_the_solver(run: CheckedRun) -> Fault | None:
    """The ledger is the solver's: sampled contacts of a single sphere leave holes in its groove."""
    return None if run.settings["ledger"] == "solver" else ("ledger", "solver for a pin on a disc")


def one_rank(run: CheckedRun) -> Fault | None:
    """One MPI rank simulates one pin."""
    return None if run.settings["solver"]["ranks"] == 1 else ("solver.ranks", "1 for a single pin")


def hertzian(run: CheckedRun) -> Fault | None:
    """A pin's contact is Hertz': caps, time steps and rest times follow from its overlap."""
    return None if run.settings["solver"]["contact_model"] == "hertz" else ("solver.contact_model", "hertz for a pin")


def track_on_disc(run: CheckedRun) -> Fault | None:
    """The track lies on the disc, and the pin's contact with it too; the ring inside the track has a hole."""
    disc = run.parameters["disc"]
    margin = 2.0 * math.sqrt(run.parameters["pin"]["radius_m"] * run.parameters["derived"]["overlap_m"])
    least, most = disc["track_radius_m"] + margin, 2.0 * disc["track_radius_m"]
    if least <= disc["radius_m"] < most:
        return None
    return "disc.radius_mm", (
        f"at least {shown_inside(least, 1)}, the track and two contact radii, and below {millimetres(most)}, two tracks"
    )


def whole_cycles(run: CheckedRun) -> Fault | None:
    """The revolutions are a whole number of wear cycles; contours and volumes are those of whole revolutions."""
    sliding = run.settings["sliding"]
    cycles = sliding["revolutions"] * sliding["cycles_per_revolution"]
    if sliding["revolutions"] >= 1.0 and abs(cycles - round(cycles)) <= ROUNDING * cycles:
        return None
    return "sliding.revolutions", (
        f"a multiple of 1/{sliding['cycles_per_revolution']} from 1 on, so that wear cycles are whole and a revolution "
        "has its contours"
    )


def cycle_long_enough(run: CheckedRun) -> Fault | None:
    """A wear cycle has at least a hundred time steps."""
    derived, sliding = run.parameters["derived"], run.parameters["sliding"]
    steps = derived["arc_rad"] / sliding["angular_speed_rad_per_s"] / derived["largest_time_step_s"]
    if steps >= LEAST_CYCLE_STEPS:
        return None
    most = int(steps * sliding["cycles_per_revolution"] / LEAST_CYCLE_STEPS)
    return "sliding.cycles_per_revolution", f"at most {most}, so that a cycle has {LEAST_CYCLE_STEPS} time steps"


def element_resolves_contact(run: CheckedRun) -> Fault | None:
    """An element on the track of a disc that wears is at most four contact radii."""
    contact = math.sqrt(run.parameters["pin"]["radius_m"] * run.parameters["derived"]["overlap_m"])
    largest = contact / ELEMENTS_ACROSS_CONTACT
    if not run.parameters["wear"]["deform"] or run.parameters["disc"]["element_size_m"] <= largest:
        return None
    return "disc.element_size_mm", f"at most {shown_inside(largest, -1)}, four radii of the pin's contact"


PIN_CHECKS = (
    summed_by_the_solver,
    one_rank,
    hertzian,
    track_on_disc,
    element_resolves_contact,
    whole_cycles,
    cycle_long_enough,
    physical_modulus_known,
)
