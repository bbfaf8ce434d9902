"""One quiet, reproducible gmsh model that is always closed again."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

FRONTAL_DELAUNAY = 6  # gmsh's number of the plane algorithm with the best angles


@contextmanager
def gmsh_model() -> Iterator[ModuleType]:
    """Yield gmsh with a fresh model: silent, one thread, fixed seed, so that equal input gives equal bits."""
    import gmsh  # half a second, and needed by the builders only

    gmsh.initialize(readConfigFiles=False, interruptible=False)  # no signal handler: works off the main thread
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.option.setNumber("Mesh.RandomSeed", 1)
        gmsh.option.setNumber("Mesh.Algorithm", FRONTAL_DELAUNAY)
        gmsh.model.add("surface")
        yield gmsh
    finally:
        gmsh.finalize()
