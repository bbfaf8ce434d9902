"""What a time step of a pin on a disc of some 80,000 triangles costs: the disc turning, at rest, and its stretches.

    python -m benchmarks.pin_cost        # in the root of the repository

Each way runs twice, over few and over more time steps; the difference of the processor times is that of the steps
alone. A turning disc is run with the frame deck of the ledger's tests, the others with the study's.
"""

from __future__ import annotations

import argparse
import math
import resource
import tempfile
from collections.abc import Callable
from pathlib import Path

from benchmarks.command_line import command
from bulkwear.meshes.disc import track_disc, track_stretch
from bulkwear.postproc.mesh import SurfaceMesh, write_stl
from bulkwear.postproc.reference.sphere_contact import touching_reach
from tests.verification.ledger_cases import PIN_MOTION, RADIUS, hertz_overlap, pin, run, run_case
from tests.verification.pin_cases import (
    ANGULAR_VELOCITY,
    DISC_RADIUS,
    INNER_RADIUS,
    TIME_STEP,
    TRACK_RADIUS,
    PinCase,
    set_down,
    write_arc,
)

ELEMENT, BAND = 1e-4, 0.8e-3  # m; some 80,000 triangles
GROOVE = 5e-5  # m, depth of groove that a stretch must leave room for
BOX = {"domain": "-0.03 0.03 -0.03 0.03 -0.01 0.02", "time_step": TIME_STEP}
ARCS = (90.0, 30.0, 10.0)  # degrees, of a cycle


def processor_seconds(task: Callable[[], object]) -> float:
    """Processor time (s) of the programs that a task runs."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    task()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime


def per_step(way: Callable[[int], object], few: int, many: int) -> float:
    """Processor time (ms) of one time step of a way to run that many steps."""
    short, long = (processor_seconds(lambda steps=steps: way(steps)) for steps in (few, many))
    return 1e3 * (long - short) / (many - few)


def turning(folder: Path, mesh: SurfaceMesh, steps: int) -> None:
    """The whole disc turns under a held pin."""
    period = 2.0 * math.pi / ANGULAR_VELOCITY
    turn = f"fix turn all move/mesh mesh sample rotate origin 0. 0. 0. axis 0. 0. -1. period {period!r}"
    run_case(folder / "turning", mesh, pin(TRACK_RADIUS, 0.0), PIN_MOTION, mesh_lines=[turn], steps=steps, **BOX)


def going_round(folder: Path, mesh: SurfaceMesh, arc: float, reach: float, steps: int) -> int:
    """The pin goes round on a disc at rest, of which the solver has the stretch for an arc (rad); its triangles."""
    write_arc(folder / "cycle_1", PinCase(), mesh, 1, 0, steps)
    chosen = track_stretch(mesh, TRACK_RADIUS, 0.0, arc, reach)
    write_stl(folder / "cycle_1" / "surface.stl", mesh.points, mesh.triangles[chosen])
    run(folder / "cycle_1")
    return len(chosen)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--few", type=int, default=50)
    parser.add_argument("--many", type=int, default=550, help="time steps; ten times the difference at rest")
    given = parser.parse_args()
    mesh = track_disc(TRACK_RADIUS, INNER_RADIUS, DISC_RADIUS, ELEMENT, BAND)
    reach = touching_reach(RADIUS, GROOVE + 2.0 * hertz_overlap())
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        set_down(folder, PinCase(), mesh)
        whole = per_step(lambda steps: turning(folder, mesh, steps), given.few, given.many)
        print(f"disc of {len(mesh.triangles)} triangles turning: {whole:.2f} ms a step", flush=True)
        more = given.few + 10 * (given.many - given.few)
        for title, arc, far in (
            ("the whole at rest", 2.0 * math.pi, DISC_RADIUS),
            *((f"stretch for {arc:g} degrees, pin's radius", math.radians(arc), RADIUS) for arc in ARCS),
            *((f"stretch for {arc:g} degrees, {1e3 * reach:.2f} mm", math.radians(arc), reach) for arc in ARCS),
        ):
            count = going_round(folder, mesh, arc, far, 1)
            cost = per_step(lambda steps, arc=arc, far=far: going_round(folder, mesh, arc, far, steps), given.few, more)
            print(f"{title}, {count} triangles: {cost:.3f} ms a step, 1/{whole / cost:.0f}", flush=True)


if __name__ == "__main__":
    command(main)
