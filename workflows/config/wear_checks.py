"""Checks of the wear of a sample that slides in a bed, which cases give their own lengths."""

from __future__ import annotations

from bulkwear.postproc.wear.caps import GRAVITY, gap_closing_step
from bulkwear.postproc.wear.laws import LAWS
from bulkwear.workflows.config.run_checks import CheckedRun, Fault, millimetres, reaches

# -, on the wear of a bed that slides its whole way under its own weight: one that mostly rides along slides a tenth
LEAST_SLIDING = 0.1

Room = tuple[float, str]  # depth (m) that may be worn off, and what sets it


def worn_within(run: CheckedRun, pressure: float, travel: float, *rooms: Room) -> Fault | None:
    """Return the fault of a run whose bed, by its weight alone, wears more off a sample than the least of these rooms.

    pressure: Pa, of the bed on the sample; travel: m. None where the shape is kept, or the law is none of sliding work
    """
    wear = run.parameters["wear"]
    law = LAWS.get(wear["law"])
    if not wear["deform"] or law is None or not law.comparable:
        return None
    coefficient = wear["accelerated_wear_coefficient_per_pa"]
    depth, (room, why) = LEAST_SLIDING * coefficient * pressure * travel, min(rooms)
    if reaches(room, depth):
        return None
    return "", (
        f"the bed's weight alone would wear {millimetres(depth)} or more off the sample, allowed are"
        f" {millimetres(room)}, {why}: a wear coefficient, with its acceleration, of {coefficient * room / depth:.6g}"
        f" 1/Pa at most (found {coefficient:.6g})"
    )


def taken_up(run: CheckedRun, updates: int, duration: float) -> Room:
    """Return how deep (m) the updates of a run can wear, each after a cycle of that duration (s), and words for it."""
    wear = run.parameters["wear"]
    step = min(
        wear["largest_step_edge_fraction"] * run.parameters["sample"]["element_size_m"],
        gap_closing_step(wear["gap_closing_fraction"], duration, GRAVITY),
    )
    return updates * step, f"what {updates} updates can take"
