"""The shape of a bed's particles, and the rolling friction that stands in for it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bulkwear.workflows.cases.sliding_sample.study import PARTICLE_SCALE
from bulkwear.workflows.config.run_checks import CheckedRun, Fault
from bulkwear.workflows.engine.derived import WINDOW
from bulkwear.workflows.engine.grains import SPHERE, grain_kind
from bulkwear.workflows.engine.solver import OWN_ROLLING_MODELS


def rolling(body: Mapping[str, Any], factor: float) -> dict[str, Any]:
    """Return a particle or a wall with that many times (-) its rolling friction."""
    contact = {**body["contact"], "rolling_friction": factor * body["contact"]["rolling_friction"]}
    return {**body, "contact": contact}


def solver_for(solver: Mapping[str, Any], particle: Mapping[str, Any], factor: float) -> dict[str, Any]:
    """Return the section `solver` of a run: clumps without rolling friction have no model of it where the study's acts
    on spheres alone.

    factor: -, on the rolling friction of the materials
    """
    if factor or grain_kind(particle) == SPHERE or solver["rolling_friction"] not in OWN_ROLLING_MODELS:
        return dict(solver)
    return {**solver, "rolling_friction": "none"}


def clumps_stay_whole(run: CheckedRun) -> Fault | None:
    """Clumps lie in a bed that keeps its particles; models of rolling friction, and the ledger, know of bodies."""
    if grain_kind(run.parameters["particle"]) == SPHERE:
        return None
    if run.parameters["bed"]["ends"] == WINDOW:
        return "bed.ends", "walls or periodic with clumps, because a window takes single spheres out and puts them in"
    if run.parameters["solver"]["rolling_friction"] in OWN_ROLLING_MODELS:
        own = " and ".join(OWN_ROLLING_MODELS)
        allowed = (
            f"a model of LIGGGHTS, or bed.rolling_friction_factor 0, with clumps, because {own} act on spheres alone"
        )
        return "solver.rolling_friction", allowed
    if PARTICLE_SCALE in run.row.values:
        return "bed.shape", "sphere in a study of particle size, whose packings count the contacts of spheres"
    if run.parameters["ledger"] != "solver":
        return "ledger", "solver with clumps, because sampled contacts do not tell which spheres are one body"
    return None
