"""Checks of the containers in which packings of particle scales are compared, before any solver starts."""

from __future__ import annotations

import math

from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.cases.sliding_sample.study import PARTICLE_SCALE
from bulkwear.workflows.config.run_checks import Check, CheckedRun, Fault, millimetres, reaches
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.engine.derived import smallest_rayleigh_time
from bulkwear.workflows.engine.grains import smallest_radius

PACKING = "packing"  # block of settings, of containers
SLABS_DIAMETERS = 12.0  # -, of the filling, in median diameters: three slabs of four of which solid fractions are told
FEWEST_STEPS_OF_PERIOD = 20.0  # in which a container swings once
WAY_OF_RADIUS = 0.5  # -, that its walls may go in a time step, over the smallest radius


def containers_given(run: CheckedRun) -> Fault | None:
    """Where rows give their particle scale, settings say in what containers packings are compared."""
    if PARTICLE_SCALE not in run.row.values or PACKING in run.settings:
        return None
    return PACKING, "a block of keys, as in config/studies/particle_size.yaml, where rows give particle_scale"


def container_holds_slabs(run: CheckedRun) -> Fault | None:
    """A container is filled as high as the slabs are that it is looked at in."""
    if PACKING not in run.settings:
        return None
    particle = run.parameters["particle"]
    least = SLABS_DIAMETERS * particle["median_diameter_m"]
    if reaches(to_si(run.settings[PACKING])["fill_height_m"], least):
        return None
    reason = f"{SLABS_DIAMETERS:g} median diameters (particle_scale {particle['scale']:g})"
    return f"{PACKING}.fill_height_mm", f"at least {millimetres(least)}, {reason}"


def container_comes_to_rest(run: CheckedRun) -> Fault | None:
    """The longest time of a filling is enough for a fall from its height and the looks that must find rest."""
    if PACKING not in run.settings:
        return None
    packing = to_si(run.settings[PACKING])
    height = min(
        packing["fill_height_m"], packing["most_fill_diameters"] * run.parameters["particle"]["median_diameter_m"]
    )
    looks = packing["rest_calm_checks"] * packing["rest_check_interval_s"]
    fall = math.sqrt(2.0 * height / GRAVITY)
    if packing["rest_longest_s"] >= looks + fall:
        return None
    return f"{PACKING}.rest_longest_s", (
        f"at least {math.ceil(100.0 * (looks + fall)) / 100.0:g} s: a fall from the height that is filled takes"
        f" {fall:.3g} s, and the looks that {PACKING}.rest_calm_checks asks for {looks:.3g} s"
    )


def container_is_shaken(run: CheckedRun) -> Fault | None:
    """A container that is shaken swings once or more, in many time steps, and its floor goes through no particle."""
    if PACKING not in run.settings:
        return None
    packing, particle = to_si(run.settings[PACKING]), run.parameters["particle"]
    amplitude = packing["amplitude_diameters"] * particle["median_diameter_m"]
    if not amplitude:
        return None
    pace, step = (
        packing["frequency_rad_per_s"],
        run.settings["solver"]["rayleigh_fraction"] * smallest_rayleigh_time(particle),
    )
    if packing["shaking_s"] * pace < 2.0 * math.pi:
        return (
            f"{PACKING}.shaking_s",
            f"at least {2.0 * math.pi / pace:.3g} s, a swing at {PACKING}.frequency_deg_per_s",
        )
    way = WAY_OF_RADIUS * smallest_radius(particle)
    fastest = min(2.0 * math.pi / FEWEST_STEPS_OF_PERIOD, way / amplitude) / step
    if pace <= fastest:
        return None
    return f"{PACKING}.frequency_deg_per_s", (
        f"at most {math.floor(math.degrees(fastest))} deg/s: a swing of {millimetres(amplitude)} then takes"
        f" {FEWEST_STEPS_OF_PERIOD:g} time steps or more, and its walls pass through no particle in one"
    )


CONTAINER_CHECKS: tuple[Check, ...] = (
    containers_given,
    container_holds_slabs,
    container_comes_to_rest,
    container_is_shaken,
)
