"""What a study will have to do, before any of it is done: jobs, and the stages that the solver goes through in them.

Cases tell it (`Case.jobs`), `forecast.py` makes seconds, memory and disk of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from bulkwear.workflows.engine.derived import neighbour_skin
from bulkwear.workflows.engine.disk import FEW, LAST_RESTARTS, RESTART_EVERY
from bulkwear.workflows.engine.state import DIGEST_LETTERS, digest

# bytes on disk, of files that the solver and the driver write; measured
RESTART_PARTICLE, RESTART_TRIANGLE = 250.0, 120.0  # restart file
PICTURE_PARTICLE = 110.0  # dump of all particles
SOLVER_TRIANGLE = 355.0  # surface as STL, and loads per triangle, of a cycle
LEDGER_TRIANGLE = 36.0  # ledger of a cycle, of a surface that is touched nearly everywhere
SURFACE_TRIANGLE = 56.0  # surface of a cycle, labels and depths included
RUN_TRIANGLE = 100.0  # pristine and worn surface of a run
CYCLE_BYTES = 50_000.0  # deck, logs, state and forces of a cycle


@dataclass(frozen=True)
class Stage:
    """A part of a job in which nothing changes but the number of particles, of which the mean counts.

    decks: starts of the solver; 0 where it goes on with the deck of the stage before
    steps: time steps, of all decks together
    particles, triangles: that the solver has
    builds: of the neighbour list, of all decks together
    moving: the bulk flows or slides, it neither falls nor rests
    surface_triangles: of the whole surface, where each deck is followed by a wear update; 0 where none is
    wall_triangles: further ones whose time a step takes, without their memory: what walls that move cost
    """

    decks: int
    steps: float
    particles: float
    triangles: float = 0.0
    builds: float = 0.0
    moving: bool = False
    surface_triangles: float = 0.0
    wall_triangles: float = 0.0

    def terms(self) -> dict[str, float]:
        """Return the amounts of work by term, see `workflows.forecast.rates`."""
        particle_steps = self.particles * self.steps
        triangle_steps = (self.triangles + self.wall_triangles) * self.steps
        cycles = self.decks if self.surface_triangles else 0
        return {
            "decks": self.decks,
            "triangles_read": self.decks * self.triangles,
            "steps": self.steps,
            "particle_steps": particle_steps,
            "moving_particle_steps": particle_steps if self.moving else 0.0,
            "particle_builds": self.particles * self.builds,
            "triangle_steps": triangle_steps,
            "loaded_triangle_steps": triangle_steps if self.particles > 1.0 else 0.0,
            "jobs": 0,
            "meshed_triangles": 0.0,
            "cycles": cycles,
            "worn_triangles": cycles * self.surface_triangles,
        }


@dataclass(frozen=True)
class Work:
    """A job that calls the solver.

    rule, wildcards: as the workflow knows it, without the study; needs: name of the job that must be done before
    stages: none where another job has simulated the same
    ranks: MPI ranks of a simulation; parallel: simulations at the same time
    disk_bytes: of what stays
    """

    rule: str
    wildcards: tuple[str, ...]
    stages: tuple[Stage, ...]
    needs: str = ""
    ranks: int = 1
    parallel: int = 1
    disk_bytes: float = 0.0

    @property
    def surface_triangles(self) -> float:
        """Triangles of the surface that is meshed for it and worn, 0 without one."""
        return max((stage.surface_triangles for stage in self.stages), default=0.0)

    @property
    def name(self) -> str:
        """The name of the job's log and benchmark files."""
        return "_".join([self.rule, *self.wildcards])


class Jobs(tuple):
    """Jobs of a study, each `Work`. Snakemake compares what they look like, which is one word however many they are."""

    def __repr__(self) -> str:
        return f"{len(self)} jobs {digest(tuple.__repr__(self))[:DIGEST_LETTERS]}"


def builds_per_step(run: Mapping[str, Any]) -> float:
    """Return the builds of the neighbour list per time step (-): one when particles have moved by half its skin."""
    skin = neighbour_skin(run["particle"])
    return 2.0 * run["sliding"]["velocity_m_per_s"] * run["derived"]["time_step_s"] / skin


def bytes_of_bed(particles: float) -> float:
    """Return what a bed leaves on disk."""
    return RESTART_PARTICLE * particles + CYCLE_BYTES


def bytes_of_run(
    run: Mapping[str, Any], particles: float, triangles: float, surface_triangles: float, cycles: int
) -> float:
    """Return what a run leaves on disk: surface and last picture of the bed of every cycle, restart files of cycle 0
    and of those cycles that keep them.

    triangles: that the solver has; surface_triangles: of the worn surface
    """
    restart = RESTART_PARTICLE * particles + RESTART_TRIANGLE * triangles
    few = min(cycles, LAST_RESTARTS + cycles // RESTART_EVERY)
    restarts = 1 + (few if run["solver"]["kept_restarts"] == FEW else cycles)
    of_cycle = SOLVER_TRIANGLE + LEDGER_TRIANGLE + SURFACE_TRIANGLE
    cycle = CYCLE_BYTES + of_cycle * surface_triangles + PICTURE_PARTICLE * particles
    once = CYCLE_BYTES + (SOLVER_TRIANGLE + RUN_TRIANGLE) * surface_triangles
    return once + restarts * restart + cycles * cycle
