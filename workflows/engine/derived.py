"""Sections of a run's parameters that cases share, and values that follow from them. SI throughout."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from bulkwear.postproc.wear.coefficient import PER_PA
from bulkwear.postproc.wear.kernel_sums import kernel_sums
from bulkwear.postproc.wear.laws import worn_volume
from bulkwear.workflows.engine.grains import smallest_radius
from bulkwear.workflows.engine.worn_pair import BESIDE

HEADROOM_DIAMETERS = 0.1  # between the sample's highest point and the bed that settles above it, in largest diameters
STRIP_DIAMETERS = 2.0  # of the strip that is held in a window, in largest diameters: nothing reaches through it
SKIN_OVER_RADIUS = 0.6  # -, neighbour skin over the smallest radius; a list then lasts about 90 steps at 1 m/s
ADAPTIVE = "adaptive"  # value of sliding.cycles: each cycle as long as its predecessor lets expect
OF_WEAR = ("hardness_pa", "wear")  # keys of a wall: no bed is filled again for them
ROUNDING = 1e-9  # relative; keeps rounding from turning exactly three layers into fewer, n samples into n + 1
FULL, REDUCED = "full", "reduced"  # values of solver.rolling_radius
RADIUS_BETWEEN = {FULL: 1.0, REDUCED: 0.5}  # -, over the radius of equal spheres that touch
FULL_RADIUS_MODELS = ("own_spin",)  # rolling models with the particle's own radius between particles
# Values of bed.ends: two walls that push the bed along, none, or a window that travels with the sample.
WALLS, PERIODIC, WINDOW = "walls", "periodic", "window"


def youngs_modulus(shear_modulus: float, poissons_ratio: float) -> float:
    """Return E = 2 G (1 + nu) in Pa, from G in Pa."""
    return 2.0 * shear_modulus * (1.0 + poissons_ratio)


def rayleigh_time(radius: float, density: float, shear_modulus: float, poissons_ratio: float) -> float:
    """Return the Rayleigh time of a sphere in s, from radius (m), density (kg/m3) and shear modulus (Pa).

    T_R = pi R sqrt(rho/G) / (0.1631 nu + 0.8766), the time a surface wave needs for half the circumference;
    Li, Xu and Thornton, Powder Technology 160 (2005) 219-228.
    """
    return math.pi * radius * math.sqrt(density / shear_modulus) / (0.1631 * poissons_ratio + 0.8766)


def rolling_coefficient_for_solver(coefficient: float, solver: Mapping[str, Any], contact: str) -> float:
    """Return the rolling friction coefficient (-) that makes the solver apply the torque meant.

    LIGGGHTS' rolling models, and `rvd`, limit the torque to mu_r F_n R_reduced, R_reduced = R1 R2 / (R1 + R2): half
    the radius for two equal spheres, the whole radius against a wall; `own_spin` has the particle's radius everywhere.
    A coefficient calibrated with the other radius (`rolling_radius` full: M_r = mu_r R F_n, Yan 2022, Eq 3.3) is
    therefore doubled or halved between particles, and unchanged at walls. For unequal spheres the factor is a
    compromise (radii 1.2 to 0.8: the torque is 4 % less than with the mean radius): recalibrate where that matters.

    solver: settings, with `rolling_friction` and `rolling_radius`; contact: "particle_particle" or "particle_wall".
    Raises ValueError for other words.
    """
    model, meant = solver["rolling_friction"], solver["rolling_radius"]
    if meant not in RADIUS_BETWEEN or contact not in ("particle_particle", "particle_wall"):
        raise ValueError(
            f"rolling_radius is {meant!r} and contact {contact!r}, allowed are full or reduced"
            " and particle_particle or particle_wall."
        )
    if contact == "particle_wall":
        return coefficient
    acting = FULL if model in FULL_RADIUS_MODELS else REDUCED
    return coefficient * RADIUS_BETWEEN[meant] / RADIUS_BETWEEN[acting]


def whole_steps(duration: float, largest_time_step: float, multiple: int) -> tuple[int, float]:
    """Return (steps, time step in s) of a duration: a multiple of `multiple` steps, and exactly the duration asked for.

    The time step is the largest one, not above `largest_time_step` (s), of which that many steps last `duration` (s).
    """
    count = math.ceil(duration / (largest_time_step * multiple) * (1.0 - ROUNDING))
    steps = max(count, 1) * multiple
    return steps, duration / steps


def physical_patch_factor(parameters: dict[str, Any]) -> float:
    """Return the true contact's Hertz radius over the simulated one (-); 1 where the study does not ask for it."""
    modulus = parameters["wear"].get("physical_shear_modulus_pa")
    if modulus is None:
        return 1.0
    from bulkwear.postproc.wear.patch import physical_radius  # slow to import, and every job reads its study first

    particle, wall = parameters["particle"], parameters["sample_material"]
    pair = [(particle["shear_modulus_pa"], modulus), (wall["shear_modulus_pa"],) * 2]
    compliances = [
        sum(
            (1.0 - section["poissons_ratio"] ** 2) / youngs_modulus(moduli[kind], section["poissons_ratio"])
            for section, moduli in zip((particle, wall), pair, strict=True)
        )
        for kind in (0, 1)
    ]
    return float(physical_radius(1.0, 1.0 / compliances[0], 1.0 / compliances[1], particle["scale"]))


def derived_materials(parameters: dict[str, Any]) -> dict[str, Any]:
    """Return Young's moduli, and the rolling coefficients in the solver's convention."""
    sections = {name: parameters[name] for name in ("particle", "sample_material", "floor_material")}
    return {
        "youngs_modulus_pa": {
            name: youngs_modulus(section["shear_modulus_pa"], section["poissons_ratio"])
            for name, section in sections.items()
        },
        "rolling_friction_for_solver": {
            name: rolling_coefficient_for_solver(
                section["contact"]["rolling_friction"],
                parameters["solver"],
                "particle_particle" if name == "particle" else "particle_wall",
            )
            for name, section in sections.items()
        },
    }


def neighbour_skin(particle: Mapping[str, Any]) -> float:
    """Return the skin (m) of the neighbour lists."""
    return SKIN_OVER_RADIUS * smallest_radius(particle)


def window_lengths(particle: Mapping[str, Any]) -> tuple[float, float]:
    """Return the length (m) of the strip that holds the fresh bed of a window, and how far other bed stays off it.

    Centres of other bed are further off than a particle reaches, and than they move before their list is made anew.
    """
    largest = max(particle["diameters_m"])
    return STRIP_DIAMETERS * largest, largest + neighbour_skin(particle)


def smallest_rayleigh_time(particle: Mapping[str, Any]) -> float:
    """Return the Rayleigh time (s) of the smallest particle, of clumps that of their smallest sphere."""
    return rayleigh_time(
        smallest_radius(particle),
        particle["density_kg_per_m3"],
        particle["shear_modulus_pa"],
        particle["poissons_ratio"],
    )


def wear_section(wear: Mapping[str, Any], particle: Mapping[str, Any]) -> dict[str, Any]:
    """Return the section with the accelerated coefficient, and of the patch only what its choice needs.

    particle: the material that wears, which may know its true modulus (physical_shear_modulus_pa)
    """
    kept = {k: v for k, v in wear.items() if k != "patch_radius_m" or wear["patch"] == "radius"}
    if wear["patch"] == "physical":
        kept["physical_shear_modulus_pa"] = particle.get("physical_shear_modulus_pa")
    return {**kept, "accelerated_wear_coefficient_per_pa": wear["wear_coefficient_per_pa"] * wear["acceleration"]}


def law_parameters(run: Mapping[str, Any]) -> dict[str, float]:
    """Return what the wear law of a run takes: the coefficient, acceleration included, and parameters of its own."""
    wear = run["wear"]
    return {"wear_coefficient_per_pa": wear["accelerated_wear_coefficient_per_pa"], **wear.get("parameters", {})}


def law_volume(run: Mapping[str, Any], ledger: Mapping[str, Any]) -> Any:
    """Return the volume (m,) m3 per triangle that the wear law of a run makes of a ledger, acceleration included.

    ledger: {column: (m,)}, as a table
    """
    return worn_volume(run["wear"]["law"], {name: np.asarray(ledger[name]) for name in ledger}, law_parameters(run))


def laws_beside(run: Mapping[str, Any]) -> list[tuple[str, dict[str, float]]]:
    """Return name and parameters (SI), the run's coefficient included, of each law by which nothing need wear and whose
    sums the ledgers of a run hold too.
    """
    if BESIDE not in run.get("wear", {}):
        return []
    coefficient = {PER_PA: run["wear"]["accelerated_wear_coefficient_per_pa"]}
    return [(law, {**coefficient, **given}) for law, given in run["wear"][BESIDE].items()]


def run_kernels(run: Mapping[str, Any]) -> dict[str, dict[str, float]]:
    """Return `kernel_sums` of the wear law of a run and those beside it."""
    return kernel_sums([(run["wear"]["law"], law_parameters(run)), *laws_beside(run)])


def template_sections(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the sections that reach templates whole: `solver`, and `deck` with the user's own words, if any.

    The stride of sampled contacts is there only where contacts are sampled.
    """
    sampled = settings["ledger"] == "dumps"
    solver = {k: v for k, v in settings["solver"].items() if sampled or k != "sampling_interval_steps"}
    return {"solver": solver, "deck": settings.get("deck", {})}


def particle_section(name: str, materials: Mapping[str, Any], scale: float) -> dict[str, Any]:
    """Return a bulk material; its lengths are coarse-grained, `scale` times the real ones."""
    particle = dict(materials["particles"][name])
    particle.pop("physical_shear_modulus_pa", None)  # concerns wear alone, and no bed is filled again for it
    particle.pop("calibrated", None)  # provenance
    distribution = particle.pop("size_distribution")
    median_diameter = scale * particle.pop("median_diameter_m")
    return {
        "name": name,
        **particle,
        "scale": scale,
        "median_diameter_m": median_diameter,
        "diameters_m": [median_diameter * relative for relative in distribution["relative_diameter"]],
        "mass_fractions": list(distribution["mass_fraction"]),
        **({"sizes": distribution["told"]} if "told" in distribution else {}),
    }


def wall_section(name: str, materials: Mapping[str, Any]) -> dict[str, Any]:
    """Return a wall's material and its contact, without what concerns wear alone."""
    return {"name": name, **{key: value for key, value in materials["walls"][name].items() if key not in OF_WEAR}}
