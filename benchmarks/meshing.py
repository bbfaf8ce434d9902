"""Speed of meshing the pristine surfaces of studies, by one core."""

from __future__ import annotations

from pathlib import Path

from benchmarks.measure import Measure, measured, processor_times
from bulkwear.workflows.config.design import load_study

SURFACES = (("demo", "R5_convex"), ("demo", "R5_plain"), ("pin_on_disc", "c17-conserving"))
REPEATS, QUICK_REPEATS = 3, 1


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return the triangles per second of processor time, of standard fidelity."""
    told = []
    for name, run in SURFACES:
        study = load_study(name, overrides={"fidelity": "quick" if quick else "standard"})
        parameters, count = study.run(run).parameters, []
        times = processor_times(
            lambda study=study, parameters=parameters, count=count: count.append(
                len(study.case.surface_mesh(parameters).triangles)
            ),
            QUICK_REPEATS if quick else REPEATS,
        )
        told.append(measured(f"{name}, {run}, {count[0]} triangles", "triangles/s", [count[0] / t for t in times]))
    return told
