"""Checks of one sphere that is pressed on what wears: it rests there, and wear by the law is neither none nor endless.

Runs of other things pass: their parameters have no `pin`.
"""

from __future__ import annotations

import math

from bulkwear.postproc.wear.kernels import is_per_impact
from bulkwear.postproc.wear.laws import LAWS
from bulkwear.workflows.config.run_checks import SHOWN, Check, CheckedRun, Fault, patch_too_wide

# -, of a pin's overlap with the flat disc, over its radius: there its contact is half as wide as itself, beyond what
# Hertz' parabola describes, and soon it is through the surface; studies have 0.014.
LARGEST_OVERLAP = 0.25


def pin_rests_on_disc(run: CheckedRun) -> Fault | None:
    """A pin sinks into the flat disc by a quarter of its radius at most; its overlap grows with the load to 2/3."""
    if "pin" not in run.parameters:
        return None
    pin = run.parameters["pin"]
    share = run.parameters["derived"]["overlap_m"] / pin["radius_m"]
    if share <= LARGEST_OVERLAP * (1.0 + SHOWN):
        return None
    most = pin["load_n"] * (LARGEST_OVERLAP / share) ** 1.5
    return "pin.load_n", (
        f"at most {most:.6g} N, under which the pin sinks into the disc by {LARGEST_OVERLAP:g} of its radius, by the"
        f" moduli as simulated (found {share:.3g})"
    )


def pin_law_counts_sliding(run: CheckedRun) -> Fault | None:
    """A pin that slides makes no impacts, so a law that counts nothing else would wear nothing."""
    law = run.parameters.get("wear", {}).get("law")
    if "pin" not in run.parameters or not _only_impacts(law):
        return None
    others = [name for name in sorted(LAWS) if not _only_impacts(name)]
    return "wear.law", f"one of {', '.join(others)}: a pin slides, and makes no impacts"


def groove_taken_up(run: CheckedRun) -> Fault | None:
    """The groove of a pin, by Archard, is at the end no deeper than all updates may wear.

    Its section is alpha F times the revolutions, a segment of the pin's circle: 4/3 sqrt(2 R) depth^1.5.
    """
    if "pin" not in run.parameters or not run.parameters["wear"]["deform"]:
        return None
    pin, wear, sliding = (run.parameters[name] for name in ("pin", "wear", "sliding"))
    if not LAWS[wear["law"]].comparable:
        return None
    updates, segment = sliding["cycles"], 4.0 / 3.0 * math.sqrt(2.0 * pin["radius_m"])
    step = min(
        wear["largest_step_edge_fraction"] * run.parameters["disc"]["element_size_m"],
        wear["largest_step_overlap_fraction"] * run.parameters["derived"]["overlap_m"],
    )
    most = segment * (updates * step) ** 1.5 / (pin["load_n"] * sliding["revolutions"])
    found = wear["accelerated_wear_coefficient_per_pa"]
    if found <= most * (1.0 + SHOWN):
        return None
    return "", (
        f"a wear coefficient, with its acceleration, of {found:.6g} 1/Pa wears a deeper groove than {updates} updates"
        f" of {step * 1e6:.3g} um can take, allowed is at most {most:.6g} 1/Pa"
    )


def patch_on_disc(run: CheckedRun) -> Fault | None:
    """A patch of a pin whose radius is given is no wider than the ring of the disc that is meshed."""
    if "pin" not in run.parameters:
        return None
    disc = run.parameters["disc"]
    beside = disc["radius_m"] - disc["track_radius_m"]
    reason = "disc.radius_mm less disc.track_radius_mm: a wider patch spreads the wear beyond the disc"
    return patch_too_wide(run, beside, reason) if beside > 0.0 else None  # a track beside its disc is told as that


def _only_impacts(law: str | None) -> bool:
    """Return whether a law counts nothing but impacts."""
    declared = LAWS.get(law)
    if declared is None or declared.comparable or not declared.kernels:
        return False
    return all(is_per_impact(name) for name in declared.kernels)


PIN_RANGE_CHECKS: tuple[Check, ...] = (
    pin_rests_on_disc,
    pin_law_counts_sliding,
    patch_on_disc,
    groove_taken_up,
)
