"""What runs of a pin on a disc will cost the solver, see `workflows.engine.work`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from meshes.estimate import disc_triangles, stretch_triangles
from postproc.reference.sphere_contact import touching_reach
from workflows.cases.pin_on_disc import decks as pin_deck
from workflows.cases.pin_on_disc.parameters import REST_OSCILLATIONS
from workflows.engine import decks as deck
from workflows.engine.work import CYCLE_BYTES, RESTART_TRIANGLE, RUN_TRIANGLE, SURFACE_TRIANGLE, Stage

# Time steps that the solver takes per time step of a run, over the whole run: the driver splits them where many
# triangles are touched at once. Measured over twelve revolutions at 1.7e-11 1/Pa; without wear none is split.
SPLIT_STEPS = {"per_triangle": 1.6, "conserving": 1.0}
LEDGER_STRETCH_TRIANGLE = 11.0  # bytes, of the ledger of a stretch, most of which is never touched
FORCES_BYTES = 50_000.0  # of a cycle, beside those of all cases

Parameters = Mapping[str, Any]


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
    rest = deck.steps(REST_OSCILLATIONS * derived["pin_oscillation_s"], derived["time_step_s"])
    steps = split * (derived["travel_steps"] + number * rest)
    whole = disc_triangles(*sizes)
    set_down, arc = (stretch_triangles(*sizes, angle, reach) for angle in (set_down_arc, derived["arc_rad"]))
    return (
        Stage(1, pin_deck.settling_steps(run), 1.0, min(set_down, whole)),
        Stage(number, steps, 1.0, min(arc, whole), surface_triangles=whole),
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
