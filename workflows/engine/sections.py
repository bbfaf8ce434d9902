"""Sections of a run's parameters that cases share; everything in SI, given and returned."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from postproc.wear.laws import law_kernels


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


def run_kernels(run: Mapping[str, Any]) -> dict[str, dict[str, float]]:
    """Return {contact kernel: {parameter: value}} whose sums the wear law of a run needs."""
    return law_kernels(run["wear"]["law"], law_parameters(run))


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
    }


def wall_section(name: str, materials: Mapping[str, Any]) -> dict[str, Any]:
    """Return a wall's material and its contact."""
    return {"name": name, **materials["walls"][name]}
