"""Whether runs have a time step that their rolling model is shown to allow."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bulkwear.workflows.report.sections import CARE, SOUND, Light

# -, of the Rayleigh time of the smallest particle: the longest step of which it is shown that sliding work and impact
# energy on a plain and on a convex sample stay within 2 %; docs/time_step_limits_results.md
SHOWN = {"cdt": 0.1, "epsd2": 0.1, "own_spin": 0.1, "rvd": 0.1}


def time_step_light(study: Mapping[str, Any]) -> Light:
    """Return whether all runs' time steps are shown to be short enough.

    study: as from `page_parameters.page_parameters`
    """
    what, solvers = "Time step", [run["solver"] for run in study["parameters"].values()]
    longest: dict[str, float] = {}
    for solver in solvers:
        model, fraction = solver["rolling_friction"], solver["rayleigh_fraction"]
        longest[model] = max(fraction, longest.get(model, 0.0))
    said = {
        model: f"{fraction:g} of the Rayleigh time under {model}, "
        + (f"shown up to {SHOWN[model]:g}" if model in SHOWN else "of which no limit is known")
        for model, fraction in longest.items()
    }
    beyond = [model for model, fraction in longest.items() if fraction > SHOWN.get(model, 0.0)]
    if not beyond:
        return Light(what, SOUND, f"It is {' and '.join(said.values())} to change wear by less than 2 %.")
    told = " and ".join(said[model] for model in beyond)
    return Light(what, CARE, f"It is {told}: longer ones may change sliding work and impact energy by more than 2 %.")
