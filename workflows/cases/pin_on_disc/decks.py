"""What a run of a pin on a disc gives the solver to do: parameters of its two decks, and how much work they are."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bulkwear.meshes.estimate import disc_triangles, stretch_triangles
from bulkwear.postproc.reference.sphere_contact import touching_reach
from bulkwear.workflows.cases.pin_on_disc.parameters import (
    PIN_RADII_BESIDE_TRACK,
    REST_OSCILLATIONS,
    SETTLING_OSCILLATIONS,
)
from bulkwear.workflows.engine.decks import REPORTS_PER_RUN, STEP_CHECK_MARGIN, exact_ledger, steps, whole_sections
from bulkwear.workflows.engine.neighbour_lists import list_sizes
from bulkwear.workflows.engine.schedule import Span
from bulkwear.workflows.engine.work import CYCLE_BYTES, RESTART_TRIANGLE, RUN_TRIANGLE, SURFACE_TRIANGLE, Stage

SKIN_OVER_RADIUS = 0.2  # -, neighbour skin over the pin's radius
# Time steps that the solver takes per time step of a run, over the whole run: the driver splits them where many
# triangles are touched at once. Measured over twelve revolutions at 1.7e-11 1/Pa; without wear none is split.
SPLIT_STEPS = {"per_triangle": 1.6, "conserving": 1.0}
LEDGER_STRETCH_TRIANGLE = 11.0  # bytes, of the ledger of a stretch, most of which is never touched
FORCES_BYTES = 50_000.0  # of a cycle, beside those of all cases

Parameters = Mapping[str, Any]


def pin_set_down(run: Parameters) -> dict[str, Any]:
    """Return the parameters of the deck that sets the pin down on the flat disc; `run` is Run.parameters."""
    radius, settling = run["pin"]["radius_m"], settling_steps(run)
    return {
        **_both(run, cycle=0),
        "report_steps": max(settling // REPORTS_PER_RUN, 1),
        "settling_steps": settling,
        "pin_radius_m": radius,
        "pin_height_m": radius,
        "density_kg_per_m3": run["particle"]["density_kg_per_m3"],
        "domain_half_width_m": domain_half_width(run),
        "domain_bottom_m": -radius,
        "domain_top_m": PIN_RADII_BESIDE_TRACK * radius,
    }


def domain_half_width(run: Parameters) -> float:
    """Return half the domain's width (m): room beside the track, and the disc, whose elements may reach its rim."""
    radius, disc = run["pin"]["radius_m"], run["disc"]
    return max(disc["track_radius_m"] + PIN_RADII_BESIDE_TRACK * radius, disc["radius_m"] + radius)


def pin_on_disc(run: Parameters, span: Span, restart: str) -> dict[str, Any]:
    """Return the parameters of the deck of one wear cycle. A line of progress per window of the forces."""
    derived = run["derived"]
    window, time_step = derived["force_interval_steps"] * span.substeps, derived["time_step_s"] / span.substeps
    return {
        **_both(run, span.cycle),
        "time_step_s": time_step,
        "solver": {**run["solver"], "rayleigh_fraction": run["solver"]["rayleigh_fraction"] / span.substeps},
        "report_steps": window,
        "force_interval_steps": window,
        "run_restart": restart,
        "rest_steps": steps(REST_OSCILLATIONS * derived["pin_oscillation_s"], time_step),
        "cycle_steps": span.solver_steps,
        "start_angle_rad": angle(run, span.first_step),
        "angular_velocity_rad_per_s": run["sliding"]["angular_speed_rad_per_s"],
        "ledger": run["ledger"],
        **exact_ledger(run),
    }


def settling_steps(run: Parameters) -> int:
    """Return the time steps until the pin rests on the flat disc."""
    derived = run["derived"]
    return steps(SETTLING_OSCILLATIONS * derived["pin_oscillation_s"], derived["time_step_s"])


def angle(run: Parameters, steps_done: int) -> float:
    """Return how far (rad) the pin has gone round after that many time steps of the wear cycles."""
    return run["sliding"]["angular_speed_rad_per_s"] * run["derived"]["time_step_s"] * steps_done


def revolutions(run: Parameters, steps_done: int) -> float:
    """Return the same in revolutions; rounding apart whole at the end of each."""
    return steps_done / run["derived"]["first_cycle_steps"] / run["sliding"]["cycles_per_revolution"]


def _both(run: Parameters, cycle: int) -> dict[str, Any]:
    """Return what both decks need: time step, load, and the tables of the types pin and disc."""
    pin, disc, moduli = run["particle"], run["sample_material"], run["derived"]["youngs_modulus_pa"]
    contact, skin = disc["contact"], SKIN_OVER_RADIUS * run["pin"]["radius_m"]
    return {
        **whole_sections(run),
        "time_step_s": run["derived"]["time_step_s"],
        "largest_time_fraction": STEP_CHECK_MARGIN * run["solver"]["rayleigh_fraction"],
        "skin_m": skin,
        **list_sizes(run, pin, skin),
        "load_n": run["pin"]["load_n"],
        "track_radius_m": run["disc"]["track_radius_m"],
        "cycle": cycle,
        "type_names": ["pin", "disc"],
        "youngs_modulus_pa": [moduli["particle"], moduli["sample_material"]],
        "poissons_ratio": [pin["poissons_ratio"], disc["poissons_ratio"]],
        "restitution": _table(contact["restitution"]),
        "sliding_friction": _table(contact["sliding_friction"]),
        "rolling_friction_coefficient": _table(contact["rolling_friction"]),
        "finnie_coefficient_per_pa": _table(run["wear"]["accelerated_wear_coefficient_per_pa"]),
    }


def _table(value: float) -> list[list[float]]:
    """Return the table of a property of pin against disc; there is no other pair."""
    return [[value] * 2] * 2


def mesh_sizes(run: Parameters) -> tuple[float, float, float, float, float]:
    """Return track, inner and outer radius, element size and half width of the fine band (m)."""
    names = ("track_radius_m", "inner_radius_m", "radius_m", "element_size_m", "band_half_width_m")
    return tuple(run["disc"][name] for name in names)


def run_stages(run: Parameters, headroom: float, set_down_arc: float) -> tuple[Stage, ...]:
    """Return the stages of a run: setting the pin down, then cycles on stretches of the track.

    headroom: -, overlaps below the surface that the pin may reach; set_down_arc: rad, of the track where it is set down
    """
    derived, sizes = run["derived"], mesh_sizes(run)
    reach = touching_reach(run["pin"]["radius_m"], headroom * derived["overlap_m"])
    number, split = run["sliding"]["cycles"], SPLIT_STEPS[run["wear"]["scheme"]] if run["wear"]["deform"] else 1.0
    rest = steps(REST_OSCILLATIONS * derived["pin_oscillation_s"], derived["time_step_s"])
    whole = disc_triangles(*sizes)
    set_down, arc = (stretch_triangles(*sizes, angle, reach) for angle in (set_down_arc, derived["arc_rad"]))
    return (
        Stage(1, settling_steps(run), 1.0, min(set_down, whole)),
        Stage(number, split * (derived["travel_steps"] + number * rest), 1.0, min(arc, whole), surface_triangles=whole),
    )


def run_bytes(run: Parameters, stretch: float) -> float:
    """Return what a run leaves on disk; surface and restart file stay of the last cycle of a revolution only.

    stretch: triangles that the solver has in a cycle
    """
    whole, sliding = disc_triangles(*mesh_sizes(run)), run["sliding"]
    cycle = CYCLE_BYTES + FORCES_BYTES + LEDGER_STRETCH_TRIANGLE * stretch
    revolution = SURFACE_TRIANGLE * whole + RESTART_TRIANGLE * stretch
    revolutions = sliding["cycles"] // sliding["cycles_per_revolution"]
    return RUN_TRIANGLE * whole + sliding["cycles"] * cycle + revolutions * revolution
