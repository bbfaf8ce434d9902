"""Parameters of the decks of beds and sliding samples, and what all decks share; templates.py renders them.

Everything that has to be computed is computed here, so that templates only substitute.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.postproc.wear.kernels import kernel_of
from bulkwear.workflows.engine.derived import neighbour_skin, run_kernels
from bulkwear.workflows.engine.grains import grain_kind
from bulkwear.workflows.engine.neighbour_lists import list_sizes
from bulkwear.workflows.engine.templates import SOLVER, whole_sections

DOMAIN_MARGIN_DIAMETERS = 2.0  # -, room between the bed and the domain's faces, in largest diameters
REPORTS_PER_RUN = 50  # lines of progress per run command
SMALLEST_SEED = 10_000  # LIGGGHTS refuses smaller ones
STATE_COLUMNS = "id x y z vx vy vz omegax omegay omegaz radius"  # of a dump of particles at rest
STEP_CHECK_MARGIN = 1.25  # -, of the chosen time step over the Rayleigh time, before the solver's check stops the run

# ---------------------------------------------------------------- parameters of the three decks


def exact_ledger(run: Mapping[str, Any], history_steps: int = 0) -> dict[str, Any]:
    """Return what a deck needs to sum every contact in the solver, and to write the sums so far every so many steps."""
    return {
        "ledger_history": f" history {history_steps}" if history_steps else "",
        "ledger_kernels": kernel_words(run_kernels(run)),
    }


def kernel_words(sums: Mapping[str, Mapping[str, float]]) -> str:
    """Return how a deck asks a ledger for sums of contact kernels, as from `kernel_sums`; nothing for none."""
    words = [
        word
        for label, given in sums.items()
        for word in (kernel_of(label), *(f"{name} {value!r}" for name, value in given.items()))
    ]
    return " ".join(["", "kernels", *words]) if words else ""


def travelled(run: Mapping[str, Any], steps: int) -> float:
    """Return how far (m) the bed has travelled after that many time steps since it was set in motion."""
    return run["sliding"]["velocity_m_per_s"] * run["derived"]["time_step_s"] * steps


def steps(duration: float, time_step: float) -> int:
    """Return the whole number of time steps, at least one, that last a duration; both in s."""
    return max(math.ceil(duration / time_step), 1)


def primes(above: int, count: int) -> list[int]:
    """Return the first `count` primes above a number; LIGGGHTS takes only primes above 10,000 as random seeds."""
    found: list[int] = []
    candidate = max(above, SMALLEST_SEED)
    while len(found) < count:
        candidate += 1
        if (candidate % np.arange(2, math.isqrt(candidate) + 1)).all():
            found.append(candidate)
    return found


# ---------------------------------------------------------------- shared blocks


def integration(
    parameters: Mapping[str, Any], time_step: float, particle: Mapping[str, Any], longest_run: int
) -> dict[str, Any]:
    """Return what every deck needs to integrate, and the `whole_sections` of its run, bed or test.

    time_step: s; longest_run: time steps
    """
    skin = neighbour_skin(particle)
    return {
        **whole_sections(parameters),
        "time_step_s": time_step,
        "largest_time_fraction": STEP_CHECK_MARGIN * parameters[SOLVER]["rayleigh_fraction"],
        "grains": grain_kind(particle),
        "skin_m": skin,
        **list_sizes(parameters, particle, skin),
        "gravity_m_per_s2": GRAVITY,
        "report_steps": max(longest_run // REPORTS_PER_RUN, 1),
    }


def material_tables(
    particle: Mapping[str, Any],
    sample: Mapping[str, Any],
    floor: Mapping[str, Any],
    derived: Mapping[str, Any],
) -> dict[str, Any]:
    """Return the property tables for the types particle, sample, floor. Wall on wall repeats the wall's value."""
    moduli, rolling = derived["youngs_modulus_pa"], derived["rolling_friction_for_solver"]
    sample_key = "sample_material" if "sample_material" in moduli else "floor_material"
    keys = ("particle", sample_key, "floor_material")
    contacts = [section["contact"] for section in (particle, sample, floor)]
    return {
        "type_names": ["particle", "sample", "floor and end walls"],
        "youngs_modulus_pa": [moduli[key] for key in keys],
        "poissons_ratio": [section["poissons_ratio"] for section in (particle, sample, floor)],
        "restitution": symmetric_table(contact["restitution"] for contact in contacts),
        "sliding_friction": symmetric_table(contact["sliding_friction"] for contact in contacts),
        "rolling_friction_coefficient": symmetric_table(rolling[key] for key in keys),
    }


def symmetric_table(with_particle: Iterable[float]) -> list[list[float]]:
    """Return the symmetric table of a property that is known for particle, sample and floor against a particle."""
    particle, sample, floor = with_particle
    return [[particle, sample, floor], [sample, sample, floor], [floor, floor, floor]]


def size_distribution(fractions: Sequence[float]) -> str:
    return " ".join(f"size_{index} {fraction:.9g}" for index, fraction in enumerate(fractions, start=1))
