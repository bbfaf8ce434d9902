"""Checks of one run of a pin on a disc, before any solver starts."""

from __future__ import annotations

import math

from workflows.config.run_checks import CheckedRun, Fault, millimetres, physical_modulus_known
from workflows.engine.schedule import LEAST_CYCLE_STEPS

ELEMENTS_ACROSS_CONTACT = 0.25  # -, a coarser mesh than four contact radii shows no groove
ROUNDING = 1e-9  # relative; of revolutions times cycles


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
        f"at least {millimetres(least)}, the track and two contact radii, and below {millimetres(most)}, two tracks"
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
    return "disc.element_size_mm", f"at most {millimetres(largest)}, four radii of the pin's contact"


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
