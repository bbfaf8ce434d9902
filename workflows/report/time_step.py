"""Whether runs have a time step that their rolling model is shown to allow."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bulkwear.workflows.report.sections import CARE, SOUND, Light

# -, of the Rayleigh time of the smallest particle, by rolling model: the longest step of which it is shown that sliding
# work and impact energy on a plain and on a convex sample stay within 2 % of those of the shortest that ran, SHORTEST.
# docs/time_step_limits_results.md has none so far.
SHOWN: Mapping[str, float] = {}
SHORTEST = 0.1


def time_step_light(study: Mapping[str, Any], shown: Mapping[str, float] = SHOWN) -> Light:
    """Return whether all runs' time steps are shown to be short enough.

    study: as from `page_parameters.page_parameters`
    shown: longest step (-) by rolling model
    """
    what, solvers = "Time step", [run["solver"] for run in study["parameters"].values()]
    longest: dict[str, float] = {}
    for solver in solvers:
        model, fraction = solver["rolling_friction"], solver["rayleigh_fraction"]
        longest[model] = max(fraction, longest.get(model, 0.0))
    said = {
        model: f"{fraction:g} of the Rayleigh time under {model}, "
        + (f"shown up to {shown[model]:g}" if model in shown else "of which no limit is shown")
        for model, fraction in longest.items()
    }
    beyond = [model for model, fraction in longest.items() if fraction > shown.get(model, 0.0)]
    if not beyond:
        return Light(what, SOUND, f"It is {' and '.join(said.values())} to change wear by less than 2 %.")
    told = " and ".join(said[model] for model in beyond)
    return Light(
        what,
        CARE,
        f"It is {told}: sliding work and impact energy may be more than 2 % off those of {SHORTEST:g}, the shortest"
        " step that was tried.",
    )
