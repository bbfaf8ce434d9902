"""Checks of how long a circular wear tester turns and how fast, and what is worn meanwhile."""

from __future__ import annotations

import math

from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.cases.circular_tester.decks import CHANNEL, bed_length, mean_radius
from bulkwear.workflows.config.run_checks import MOST_STEPS, Check, CheckedRun, Fault, millimetres, reaches
from bulkwear.workflows.config.wear_checks import taken_up, worn_within
from bulkwear.workflows.engine.schedule import LEAST_CYCLE_STEPS

LEAST_STEPS = 10.0  # in which the trough passes the smallest particle; in fewer a contact is over before it is resolved
# -, times as long as friction alone takes to bring a bed to the speed of the trough it turns before runs start.
SPIN_UPS = 1.5
ROUNDING = 1e-9  # relative; of revolutions times cycles, and of what is rounded up


def rounded_up(value: float) -> float:
    """Return a least value to two decimals, which is enough where it is given."""
    return math.ceil(100.0 * value * (1.0 - ROUNDING)) / 100.0


def whole_cycles(run: CheckedRun) -> Fault | None:
    """The revolutions are a whole number of wear cycles."""
    sliding = run.settings["sliding"]
    cycles = sliding["revolutions"] * sliding["cycles_per_revolution"]
    if cycles >= 1.0 - ROUNDING and abs(cycles - round(cycles)) <= ROUNDING * cycles:
        return None
    return "sliding.revolutions", f"a multiple of 1/{sliding['cycles_per_revolution']}, so that wear cycles are whole"


def cycle_long_enough(run: CheckedRun) -> Fault | None:
    """A wear cycle has at least a hundred time steps."""
    derived = run.parameters["derived"]
    steps = derived["revolution_s"] / derived["largest_time_step_s"]
    most = int(steps / LEAST_CYCLE_STEPS)
    if run.settings["sliding"]["cycles_per_revolution"] <= most:
        return None
    return "sliding.cycles_per_revolution", f"at most {most}, so that a cycle has {LEAST_CYCLE_STEPS} time steps"


def speed_resolved(run: CheckedRun) -> Fault | None:
    """The trough passes the smallest particle in ten time steps or more."""
    step, particle = run.parameters["derived"]["largest_time_step_s"], run.parameters["particle"]
    fastest = min(particle["diameters_m"]) / (LEAST_STEPS * step)
    return _too_fast(run, fastest / mean_radius(run.parameters["tester"]), "ten time steps for the smallest particle")


def bed_stays_down(run: CheckedRun) -> Fault | None:
    """At the outer wall of a ring the bed is pressed on the floor more than it is thrown outwards."""
    tester = run.parameters["tester"]
    if tester["shape"] == CHANNEL:
        return None
    reason = "where the centrifugal acceleration at tester.outer_radius_mm is that of gravity"
    return _too_fast(run, math.sqrt(GRAVITY / tester["outer_radius_m"]), reason)


def _too_fast(run: CheckedRun, most: float, reason: str) -> Fault | None:
    """Return the fault of a trough that turns faster than so many rad/s."""
    if run.parameters["sliding"]["angular_speed_rad_per_s"] <= most:
        return None
    return "sliding.angular_speed_deg_per_s", f"at most {math.floor(math.degrees(most))} deg/s, {reason}"


def turns_countable(run: CheckedRun) -> Fault | None:
    """Bed, run-in and run have no more time steps than the solver can be told to make."""
    derived, sliding = run.parameters["derived"], run.parameters["sliding"]
    most = MOST_STEPS * derived["largest_time_step_s"] / derived["revolution_s"]
    for key in ("steady_revolutions", "run_in_revolutions", "revolutions"):
        if sliding[key] > most:
            return f"sliding.{key}", f"at most {math.floor(most)}, {MOST_STEPS} time steps, which the solver counts"
    return None


def bed_spun_up(run: CheckedRun) -> Fault | None:
    """The bed turns longer before runs start than friction takes to bring it to the trough's speed."""
    sliding = run.parameters["sliding"]
    friction = min(run.parameters[name]["contact"]["sliding_friction"] for name in ("floor_material", "particle"))
    if friction <= 0.0:
        return "bed.floor_material", "a wall on which the particles of bed.material have friction, which turns them"
    spin_up = sliding["velocity_m_per_s"] / (friction * GRAVITY)
    least = rounded_up(SPIN_UPS * spin_up / run.parameters["derived"]["revolution_s"])
    if sliding["steady_revolutions"] >= least:
        return None
    return "sliding.steady_revolutions", (
        f"at least {least:g}, {SPIN_UPS:g} times the {spin_up:.3g} s in which friction brings the bed to the trough's"
        f" {sliding['velocity_m_per_s']:.3g} m/s"
    )


def level_measured(run: CheckedRun) -> Fault | None:
    """The quarter of the bed whose level is measured has left the consolidator a revolution before runs start."""
    tester, sliding = run.parameters["tester"], run.parameters["sliding"]
    quarter = 0.25 * bed_length(tester) / mean_radius(tester)
    least = rounded_up(1.0 + quarter / sliding["revolution_rad"])
    if sliding["steady_revolutions"] >= least:
        return None
    turn = math.degrees(sliding["revolution_rad"])
    return "sliding.steady_revolutions", (
        f"at least {least:g} where sliding.revolution_deg is {turn:.6g}: a quarter of the bed has then left the"
        " consolidator before the last revolution, over which its level is measured"
    )


def local_thickness_in_sample(run: CheckedRun) -> Fault | None:
    """The thickness that may be worn through is no more than the sample's."""
    thickness = run.parameters["sample"]["thickness_m"]
    if reaches(thickness, run.parameters["wear"].get("local_thickness_m", 0.0)):
        return None
    return "wear.local_thickness_mm", f"at most {millimetres(thickness)}, sample.thickness_mm"


def wear_within_reason(run: CheckedRun) -> Fault | None:
    """The bed's weight over the sample wears, by a fraction of its travel, neither through the sample nor more than
    updates take.
    """
    derived, sliding = run.parameters["derived"], run.parameters["sliding"]
    cycle_s = derived["revolution_s"] / sliding["cycles_per_revolution"]
    travel = sliding["velocity_m_per_s"] * derived["revolution_s"] * sliding["revolutions"]
    rooms = (
        (run.parameters["sample"]["thickness_m"], "sample.thickness_mm"),
        taken_up(run, sliding["cycles"], cycle_s),
    )
    return worn_within(run, derived["bulk_pressure_pa"], travel, *rooms)


TURNING_CHECKS: tuple[Check, ...] = (
    whole_cycles,
    cycle_long_enough,
    speed_resolved,
    bed_stays_down,
    turns_countable,
    bed_spun_up,
    level_measured,
    local_thickness_in_sample,
    wear_within_reason,
)
