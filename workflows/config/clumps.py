"""Clumps of spheres that a bed's particles may be: tables config/clumps/<name>.csv of a project or the package."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from bulkwear.postproc.clump import Clump, unit_clump
from bulkwear.workflows.config.layers import ConfigError, Layer, display_name, read_csv_rows
from bulkwear.workflows.config.schema import load_schema
from bulkwear.workflows.config.validation import cell_value, check_columns, check_layer, show
from bulkwear.workflows.engine.grains import with_clump
from bulkwear.workflows.engine.project import current_project

CLUMPS = "config/clumps"  # folder of project and package
ROUND = "sphere"  # the shape that needs no table
SCHEMA = "clump"
MOST_SPHERES = 50  # of a clump: its volume is measured in 4 s, of 100 in 15
ROUND_OFF = 1e-9  # relative; spheres that touch as written
SETTING = "bed.shape"  # that says which clump a bed's particles are


def shaped(particle: Mapping[str, Any], shape: str, setting: str = SETTING) -> dict[str, Any]:
    """Return a bulk material with particles of that shape, see `find_clump`. Raises ConfigError."""
    clump = find_clump(shape, setting)
    return dict(particle) if clump is None else with_clump(particle, shape, clump)


def find_clump(shape: str, setting: str = SETTING) -> Clump | None:
    """Return the clump that particles are, None for spheres; setting: that gives the shape. Raises ConfigError."""
    project = current_project()
    if project.every(f"{CLUMPS}/{ROUND}.csv"):
        raise ConfigError(f"{CLUMPS}/{ROUND}.csv: found a clump of that name, allowed is another name.")
    if shape == ROUND:
        return None
    shapes = [ROUND, *(name.removesuffix(".csv") for name in project.names(CLUMPS, ".csv"))]
    if shape not in shapes:
        raise ConfigError(f"{setting} is {show(shape)}, allowed is one of {', '.join(shapes)}.")
    return read_clump(project.file(f"{CLUMPS}/{shape}.csv"), project.folder)


def read_clump(path: Path, root: Path) -> Clump:
    """Return the clump of a table; root: folder from which it is named. Raises ConfigError."""
    return _clump(path, root, path.stat().st_mtime_ns)


@cache
def _clump(path: Path, root: Path, _written: int) -> Clump:
    """Read a table once for all runs of a study; written: when, in ns."""
    header, rows = read_csv_rows(path, root)
    schema, source = load_schema(SCHEMA), display_name(path, root)
    check_columns(header, schema, source)
    spheres = []
    for line, cells in rows:
        values = {name: cell_value(text, schema["properties"][name]) for name, text in cells.items()}
        check_layer(Layer(source, values, {(): line}), schema)
        spheres.append([float(values[name]) for name in schema["required"]])
    if len(spheres) < 2:
        raise ConfigError(f"{source}: found one sphere, allowed are two or more; a sphere is {SETTING}: {ROUND}.")
    if len(spheres) > MOST_SPHERES:
        raise ConfigError(
            f"{source}: found {len(spheres)} spheres, allowed are {MOST_SPHERES}: every job of a study measures them."
        )
    table = np.array(spheres)
    if len(np.unique(table, axis=0)) < len(table):
        raise ConfigError(f"{source}: found a sphere twice, allowed is each once.")
    if (line := _hidden(table[:, :3], table[:, 3])) is not None:
        raise ConfigError(f"{source}, line {rows[line][0]}: found a sphere within another, allowed is none.")
    if not _hangs_together(table[:, :3], table[:, 3]):
        raise ConfigError(f"{source}: found spheres apart from the others, allowed are spheres that touch or overlap.")
    return unit_clump(table[:, :3], table[:, 3])


def _hidden(centres: np.ndarray, radii: np.ndarray) -> int | None:
    """Return the number of a sphere that lies within another one and so touches nothing, if there is any."""
    apart = np.linalg.norm(centres[:, None] - centres[None], axis=2)
    within = apart + radii[:, None] <= radii[None]
    np.fill_diagonal(within, False)
    return int(np.argmax(within.any(axis=1))) if within.any() else None


def _hangs_together(centres: np.ndarray, radii: np.ndarray) -> bool:
    """Return whether every sphere can be reached from the first one over spheres that touch or overlap."""
    apart = np.linalg.norm(centres[:, None] - centres[None], axis=2)
    touching = apart <= (1.0 + ROUND_OFF) * (radii[:, None] + radii[None])
    reached = np.arange(len(radii)) == 0
    for _ in radii:
        reached = touching[reached].any(axis=0)
    return bool(reached.all())
