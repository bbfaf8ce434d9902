"""Checks of the contact model of a run, before any solver starts: its properties are there and particles stay apart."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from bulkwear.workflows.config.run_checks import Check, CheckedRun, Fault
from bulkwear.workflows.config.schema import load_schema
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.config.validation import allowed_text
from bulkwear.workflows.engine.derived import smallest_rayleigh_time, youngs_modulus
from bulkwear.workflows.engine.grains import smallest_radius
from bulkwear.workflows.engine.templates import solver_settings

CONTACT_MODEL = "_shared/contact_model"  # template
CHOICES = ("contact_model", "cohesion", "rolling_friction")  # settings that choose a model
HOOKE, BRIDGES = "hooke", "washino/capillary/viscous"
# -, of the contact's area in each model, over 2 pi R* times the overlap, the circle in which two spheres meet
AREA_OF_MODEL = {"sjkr": 1.0, "sjkr2": 2.0}
# -, over the reduced radius, of two particles that only their cohesion presses: Hertz' law is one of small overlaps
LARGEST_STUCK_OVERLAP = 0.1
# time steps of the impact of two of the smallest particles; Hertz' has eight at 1 m/s and 0.4 of the Rayleigh time, the
# largest time step that is allowed
FEWEST_STEPS_OF_IMPACT = 7.0


def model_properties_given(run: CheckedRun) -> Fault | None:
    """Every property that the chosen contact, cohesion and rolling models need is given in the solver's section."""
    known = load_schema("settings")["properties"]["solver"]["properties"]
    given = to_si(run.settings["solver"])
    for name, chosen_by in solver_settings(CONTACT_MODEL, words={"solver": given}).items():
        if name not in given:
            key = next(key for key in known if name in to_si({key: 0.0}))
            missing = f"solver.{key} ({allowed_text(known[key])}) is missing"
            return f"solver.{chosen_by}", f"one whose properties stand beside it: {missing}"
    return None


def unused_properties(settings: Mapping[str, Any], solvers: Iterable[Mapping[str, Any]]) -> list[str]:
    """Return a sentence per property of a model that a study gives and that none of its runs uses: no fault, as models
    change by row and from the command line.

    settings: of the study; solvers: the section of each run
    """
    chosen = {tuple(solver[name] for name in CHOICES): solver for solver in solvers}
    used = set().union(*(solver_settings(CONTACT_MODEL, words={"solver": solver}) for solver in chosen.values()))
    chosen_by = {name: model for name, model in solver_settings(CONTACT_MODEL).items() if model}
    said = []
    for key in settings["solver"]:
        name = next(iter(to_si({key: 0.0})))
        if name in chosen_by and name not in used:
            model = chosen_by[name]
            models = ", ".join(dict.fromkeys(solver[model] for solver in chosen.values()))
            said.append(f"solver.{key} is given and used by nothing: solver.{model} is {models}.")
    return said


def cohesion_keeps_particles_apart(run: CheckedRun) -> Fault | None:
    """Particles that hang together by cohesion alone overlap little: it is weak beside their modulus.

    The attraction c k 2 pi R* d equals Hertz' 4/3 E* sqrt(R*) d^1.5 where d / R* = (3/2 pi c k / E*)^2, d the overlap.
    """
    solver, particle = run.settings["solver"], run.parameters.get("particle")
    area = AREA_OF_MODEL.get(solver["cohesion"])
    if area is None or particle is None:
        return None
    modulus = _effective_modulus(particle)
    most = modulus * math.sqrt(LARGEST_STUCK_OVERLAP) / (1.5 * math.pi * area)
    for key in ("cohesion_energy_density_j_per_m3", "wall_cohesion_energy_density_j_per_m3"):
        if solver[key] > most:
            return f"solver.{key}", (
                f"at most {most:.3g} J/m3 with {solver['cohesion']} and the modulus of {particle['name']} as simulated:"
                " under more, particles that touch are drawn into each other"
            )
    return None


def bridges_have_a_reach(run: CheckedRun) -> Fault | None:
    """The separation at which a liquid bridge breaks is above the one that bounds its viscous force."""
    solver = run.settings["solver"]
    if solver["cohesion"] != BRIDGES or solver["least_separation_ratio"] < solver["most_separation_ratio"]:
        return None
    return "solver.least_separation_ratio", f"below {solver['most_separation_ratio']:g}, solver.most_separation_ratio"


def impact_resolved(run: CheckedRun) -> Fault | None:
    """A linear spring lets two of the smallest particles part again in several time steps: its stiffness grows with the
    characteristic velocity.
    """
    solver, particle = run.settings["solver"], run.parameters.get("particle")
    if solver["contact_model"] != HOOKE or particle is None:
        return None
    velocity = solver["characteristic_velocity_m_per_s"]
    steps = _spring_time(particle, velocity) / (solver["rayleigh_fraction"] * smallest_rayleigh_time(particle))
    if steps >= FEWEST_STEPS_OF_IMPACT:
        return None
    most = velocity * (steps / FEWEST_STEPS_OF_IMPACT) ** 5  # the time goes with the fifth root
    return "solver.characteristic_velocity_m_per_s", (
        f"at most {most:.3g} m/s, where an impact of the smallest particles takes {FEWEST_STEPS_OF_IMPACT:g} time steps"
        f" (found {steps:.2g}), or a smaller solver.rayleigh_fraction"
    )


def _spring_time(particle: Mapping[str, Any], velocity: float) -> float:
    """Return the time (s) that two of the smallest particles touch by LIGGGHTS' linear spring of that velocity (m/s):
    k = 16/15 sqrt(R*) E* (15 m* v^2 / (16 sqrt(R*) E*))^(1/5).
    """
    radius, modulus = smallest_radius(particle), _effective_modulus(particle)
    reduced_mass = 0.5 * particle["density_kg_per_m3"] * 4.0 / 3.0 * math.pi * radius**3
    hertz = 16.0 / 15.0 * math.sqrt(0.5 * radius) * modulus
    return math.pi * math.sqrt(reduced_mass / (hertz * (reduced_mass * velocity**2 / hertz) ** 0.2))


def _effective_modulus(particle: Mapping[str, Any]) -> float:
    """Return E* (Pa) of two particles of one material."""
    ratio = particle["poissons_ratio"]
    return 0.5 * youngs_modulus(particle["shear_modulus_pa"], ratio) / (1.0 - ratio**2)


CONTACT_CHECKS: tuple[Check, ...] = (
    model_properties_given,
    cohesion_keeps_particles_apart,
    bridges_have_a_reach,
    impact_resolved,
)
