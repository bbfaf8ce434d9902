"""What a contact model may be given: attraction, bridges and springs that leave particles apart and in sight."""

import math
import re

import pytest

from bulkwear.workflows.config.contact_checks import (
    FEWEST_STEPS_OF_IMPACT,
    LARGEST_STUCK_OVERLAP,
    unused_properties,
)
from bulkwear.workflows.config.design import ConfigError
from bulkwear.workflows.engine.derived import smallest_rayleigh_time
from tests.support.tiny import tiny_study

TOLD = 0.01  # relative; bounds are told with three digits
WET = {
    **{"cohesion": "washino/capillary/viscous", "liquid_volume_fraction": 0.05, "surface_tension_n_per_m": 0.07},
    **{"fluid_viscosity_pa_s": 1e-3, "contact_angle_deg": 60},
}


def sticky(model, density, wall=0.0):
    """Settings of a cohesion model."""
    return {
        "cohesion": model,
        "cohesion_energy_density_j_per_m3": density,
        "wall_cohesion_energy_density_j_per_m3": wall,
    }


def refused(**solver) -> str:
    with pytest.raises(ConfigError) as caught:
        tiny_study(solver=solver)
    return str(caught.value)


def told(message: str) -> float:
    """The number that is allowed at most."""
    return float(re.search(r"at most (\S+)", message)[1])


def particle_of(**solver):
    return tiny_study(solver=solver).runs[0].parameters["particle"]


def modulus_of(particle) -> float:
    """E* of two of the particles."""
    return particle["shear_modulus_pa"] / (1.0 - particle["poissons_ratio"])


@pytest.mark.parametrize(("model", "circles"), [("sjkr", 1.0), ("sjkr2", 2.0)])
def test_cohesion_leaves_spheres_apart(model, circles):
    """Two spheres that only cohesion presses overlap by the part of their reduced radius that is allowed."""
    most = told(refused(**sticky(model, 1e12)))
    particle = particle_of(**sticky(model, 0.99 * most, 0.99 * most))
    radius, modulus = 0.25 * particle["diameters_m"][0], modulus_of(particle)
    overlap = LARGEST_STUCK_OVERLAP * radius
    attraction = most * circles * 2.0 * math.pi * radius * overlap
    assert attraction == pytest.approx(4.0 / 3.0 * modulus * math.sqrt(radius) * overlap**1.5, rel=TOLD)
    assert told(refused(**sticky(model, 0.0, 1.01 * most))) == pytest.approx(most, rel=TOLD)


def test_a_spring_is_soft_enough_for_its_time_step():
    """At the velocity that is told an impact of the smallest particles takes the least number of time steps."""
    hooke = {"contact_model": "hooke", "rayleigh_fraction": 0.2}
    message = refused(**hooke, characteristic_velocity_m_per_s=1000)
    most = told(message)
    assert "or a smaller solver.rayleigh_fraction" in message
    particle = particle_of(**hooke, characteristic_velocity_m_per_s=0.99 * most)
    radius = 0.5 * min(particle["diameters_m"])
    mass = 0.5 * particle["density_kg_per_m3"] * 4.0 / 3.0 * math.pi * radius**3
    spring = 16.0 / 15.0 * math.sqrt(0.5 * radius) * modulus_of(particle)
    stiffness = spring * (mass * most**2 / spring) ** 0.2
    steps = math.pi * math.sqrt(mass / stiffness) / (0.2 * smallest_rayleigh_time(particle))
    assert steps == pytest.approx(FEWEST_STEPS_OF_IMPACT, rel=TOLD)


def test_a_bridge_reaches_further_than_its_least_separation():
    """It would else break before it pulls."""
    message = refused(**WET, least_separation_ratio=1.2, most_separation_ratio=1.1)
    assert "solver.least_separation_ratio is 1.2" in message
    assert message.endswith("allowed is below 1.1, solver.most_separation_ratio.")
    assert tiny_study(solver=WET | {"least_separation_ratio": 1.01, "most_separation_ratio": 1.1}).runs


def test_properties_that_no_model_uses_are_told():
    """Of a model that is not chosen, by any run; those of a chosen one are not told, nor what is no model's."""
    dry = tiny_study(solver={"cohesion_energy_density_j_per_m3": 2e4, "kept_restarts": "all"})
    solvers = [run.parameters["solver"] for run in dry.runs]
    assert unused_properties(dry.settings, solvers) == [
        "solver.cohesion_energy_density_j_per_m3 is given and used by nothing: solver.cohesion is none."
    ]
    wet = tiny_study(solver=sticky("sjkr", 2e4))
    assert unused_properties(wet.settings, [run.parameters["solver"] for run in wet.runs]) == []
    assert unused_properties(dry.settings, [*solvers, wet.runs[0].parameters["solver"]]) == []
