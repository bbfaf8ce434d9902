"""Closed forms of a loaded sphere on a mesh, against plain arithmetic and a swinging mass."""

import math

import numpy as np
import pytest

from bulkwear.postproc.reference.sphere_contact import (
    SAFE_FRACTION,
    effective_modulus,
    hertz_overlap,
    safe_time_step,
    stable_time_step,
    touching_reach,
)

RADIUS, MASS, LOAD = 0.003, 5.485e-4, 5.0  # m, kg, N; the pin of Yan 2022, Table 5.2
MODULUS = effective_modulus(2.48e8, 0.24, 2.028e11, 0.3)  # Pa
ROUNDING = 1e-12  # relative
NEAR_LIMIT = 0.01  # -, of the time step to both sides of the limit
SWINGS = 4000  # steps in which a factor of 1.01 beyond the limit shows


def test_modulus_of_two_bodies():
    """Two equal bodies: half of E / (1 - nu^2); beside a rigid one, all of it."""
    assert effective_modulus(1e9, 0.3, 1e9, 0.3) == pytest.approx(0.5e9 / 0.91, rel=ROUNDING)
    assert effective_modulus(1e9, 0.3, 1e30, 0.3) == pytest.approx(1e9 / 0.91, rel=ROUNDING)


def test_overlap_carries_the_load():
    """F = 4/3 E* sqrt(R) d^1.5 at the overlap found; 41 um for the pin."""
    overlap = hertz_overlap(LOAD, RADIUS, MODULUS)
    assert 4.0 / 3.0 * MODULUS * math.sqrt(RADIUS) * overlap**1.5 == pytest.approx(LOAD, rel=ROUNDING)
    assert overlap == pytest.approx(40.8e-6, rel=1e-2)


def test_reach_is_half_the_chord():
    """The sphere's surface is `depth` above its lowest point at that distance; a sunk sphere reaches its radius."""
    reach = touching_reach(RADIUS, 2e-4)
    assert RADIUS - math.sqrt(RADIUS**2 - reach**2) == pytest.approx(2e-4, rel=ROUNDING)
    assert touching_reach(RADIUS, 0.0) == 0.0
    assert touching_reach(RADIUS, RADIUS) == touching_reach(RADIUS, 5 * RADIUS) == RADIUS


def test_one_undamped_contact_is_stable_to_two_over_w():
    """e = 1: dt = 2 sqrt(m / S), S = 3/2 F / overlap; half of it for eight times the contacts, as n^(-1/3)."""
    stiffness = 1.5 * LOAD / hertz_overlap(LOAD, RADIUS, MODULUS)
    expected = 2.0 * math.sqrt(MASS / stiffness)
    assert stable_time_step(LOAD, RADIUS, MODULUS, MASS, 1.0) == pytest.approx(expected, rel=ROUNDING)
    assert stable_time_step(LOAD, RADIUS, MODULUS, MASS, 1.0, 8.0) == pytest.approx(expected / 2.0, rel=ROUNDING)


def test_many_damped_contacts_go_as_n_to_minus_five_sixths():
    """Where damping rules, the limit falls with n^(-1/3) of the stiffness times n^(-1/2) of the damping ratio."""
    few, many = (stable_time_step(LOAD, RADIUS, MODULUS, MASS, 0.1, n) for n in (1e6, 64e6))
    assert few / many == pytest.approx(64.0 ** (5.0 / 6.0), rel=1e-4)


@pytest.mark.parametrize("restitution", [0.2, 0.5, 0.9])
@pytest.mark.parametrize("contacts", [1, 14, 90])
def test_a_mass_on_n_contacts_swings_up_beyond_the_limit_only(restitution, contacts):
    """The solver's own scheme on n equal contacts in parallel, near equilibrium: dies out below, grows above."""
    overlap = hertz_overlap(LOAD / contacts, RADIUS, MODULUS)
    stiffness = 2.0 * MODULUS * math.sqrt(RADIUS * overlap)
    beta = -math.log(restitution) / math.hypot(math.log(restitution), math.pi)
    damping = 2.0 * math.sqrt(5.0 / 6.0) * beta * math.sqrt(stiffness * MASS)
    limit = stable_time_step(LOAD, RADIUS, MODULUS, MASS, restitution, contacts)
    swing = {}
    for factor in (1.0 - NEAR_LIMIT, 1.0 + NEAR_LIMIT):
        place, speed, step = 1e-9, 0.0, factor * limit
        for _ in range(SWINGS):
            force = -contacts * (stiffness * place + damping * speed)  # of the velocity of half a step before
            speed += step * force / MASS
            place += step * speed
            if abs(place) > 1.0:
                break
        swing[factor] = abs(place)
    assert swing[1.0 - NEAR_LIMIT] < 1e-9 < swing[1.0 + NEAR_LIMIT]


def test_the_safe_step_is_the_largest_until_contacts_forbid_it():
    """On the flat the study's own step; with 60 contacts 0.7 of the limit; no contact counts as one."""
    rest = (LOAD, RADIUS, MODULUS, MASS, 0.5)
    assert safe_time_step(1.4e-5, 1.0, *rest) == safe_time_step(1.4e-5, 0.0, *rest) == 1.4e-5
    expected = SAFE_FRACTION * stable_time_step(*rest, contacts=60.0)
    assert safe_time_step(1.4e-5, 60.0, *rest) == pytest.approx(expected, rel=ROUNDING)
    steps = [safe_time_step(1.4e-5, n, *rest) for n in np.linspace(1.0, 100.0, 50)]
    assert (np.diff(steps) <= 0.0).all()


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"load": 0.0}, "load of a contact must be greater than 0, found 0.0"),
        ({"mass": float("nan")}, "mass of a contact must be greater than 0, found nan"),
        ({"restitution": 0.0}, "0 < restitution <= 1 and contacts >= 1, found 0.0 and 1.0"),
        ({"contacts": 0.5}, "0 < restitution <= 1 and contacts >= 1, found 0.5 and 0.5"),
    ],
)
def test_senseless_contacts_are_refused(change, sentence):
    """One sentence: what, allowed, found."""
    given = {"load": LOAD, "radius": RADIUS, "modulus": MODULUS, "mass": MASS, "restitution": 0.5, "contacts": 1.0}
    with pytest.raises(ValueError, match=sentence):
        stable_time_step(**{**given, **change})
