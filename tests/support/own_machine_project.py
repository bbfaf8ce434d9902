"""A project with a machine of its own, small enough for tests: ore falls on a liner, a plate and a turning paddle.

Some hundred particles come in, a dozen blocks are simulated in a few seconds.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from bulkwear.postproc.mesh import write_surface
from bulkwear.workflows.config.design import Study, load_study
from bulkwear.workflows.engine.chain import Chain
from bulkwear.workflows.engine.project import enter_project, leave_project
from tests.support.own_solids import box, write_ascii

STUDY = "machine"
ORE = {
    "density_kg_per_m3": 2500,
    "poissons_ratio": 0.24,
    "shear_modulus_pa": 4.0e6,  # soft, for large time steps
    "bulk_solid_fraction": 0.6,
    "median_diameter_mm": 3,
    "size_distribution": {"relative_diameter": [0.8, 1.2], "mass_fraction": [0.5, 0.5]},
    "contact": {"restitution": 0.45, "sliding_friction": 0.3, "rolling_friction": 0.2},
}
SIZES = {"liner": (240, 100, 30), "plate": (30, 100, 120), "paddle": (100, 100, 20), "hood": (10, 100, 60)}  # mm
CORNERS = {"liner": (-120, -50, -30), "plate": (140, -50, -120), "paddle": (0, -50, -10), "hood": (-150, -50, 20)}  # mm
SLOPE_DEG = 35.0  # of the liner, about y: what slides on it goes along +x
SHAFT = (60.0, 0.0, -220.0)  # mm, about which the paddle turns, along y
SPEED_RPM = 60.0
FASTER = {"paddle": {"motion": {"speed_rpm": 75}}}  # of parts; a turn in a run without updates
PARTS: dict[str, Any] = {
    "liner": {"file": "liner.stl", "role": "wears", "edge_mm": 25, "thickness_mm": 30, "wear_coefficient_error": 0.2},
    "plate": {"file": "plate.stl", "role": "wears", "edge_mm": 30, "law": "finnie", "wear_coefficient_per_pa": 1.0e-12},
    "paddle": {
        "file": "paddle.stl",
        "role": "wears",
        "edge_mm": 20,
        "motion": {"kind": "rotation", "point_mm": list(SHAFT), "axis": [0, 1, 0], "speed_rpm": SPEED_RPM},
    },
    "hood": {"file": "hood.stl", "role": "rigid", "edge_mm": 30, "material": "perspex"},
}
SETTINGS: dict[str, Any] = {
    "title": "A tiny machine",
    "question": "Where does it wear?",
    "case": "equipment",
    "design": "machine.csv",
    "packings": 1,
    "particle_scale": 4,
    "parts": {name: {"unit": "mm", "material": "steel", **part} for name, part in PARTS.items()},
    "bulk": {"material": "ore"},
    "inlet": {
        "rate_t_per_h": 1.5,
        "centre_mm": [-60, 0, 160],
        "normal": [0, 0, -1],
        "size_mm": [80, 80],
        "velocity_m_per_s": [0, 0, -1.0],
    },
    "outlets": {"below": {"centre_mm": [0, 0, -345], "normal": [0, 0, -1], "size_mm": [900, 800]}},
    "start_up": {"most_s": 0.45},
    "sampling": {"block_s": 0.15, "fewest_blocks": 3, "most_blocks": 3, "patch_mm": 60, "pictures_per_block": 2},
    "updates": {"most": 2, "worn_blocks": 1},
    "operation": {"duration_h": 400, "change_out_remaining_mm": 2},
    "solver": {"rayleigh_fraction": 0.3},
}


def turned(points: np.ndarray, angle_deg: float) -> np.ndarray:
    """Return points (n, 3) turned about y through the origin; +x goes to -z."""
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    return points @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]).T


def drawings() -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return points (n, 3) mm and triangles of the parts by name, as they are drawn."""
    found = {name: box(SIZES[name], CORNERS[name]) for name in SIZES}
    found["liner"] = (turned(found["liner"][0], SLOPE_DEG), found["liner"][1])
    found["paddle"] = (found["paddle"][0] + SHAFT, found["paddle"][1])
    return found


@dataclass(frozen=True)
class Machine:
    """A study's settings, the bodies of its parts {name: (points mm, triangles)} as drawn, and its materials."""

    settings: Mapping[str, Any]
    bodies: Mapping[str, tuple[np.ndarray, np.ndarray]]
    materials: Mapping[str, Any]


TINY = Machine(SETTINGS, drawings(), {"particles": {"ore": ORE}})


def merged(settings: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return settings with changes, block by block; None takes a key away."""
    found = deepcopy(dict(settings))
    for key, value in changes.items():
        if value is None:
            found.pop(key, None)
        elif isinstance(value, Mapping) and isinstance(found.get(key), Mapping):
            found[key] = merged(found[key], value)
        else:
            found[key] = deepcopy(value)
    return found


def machine_project(folder: Path, rows: str = "row\nA\n", machine: Machine = TINY, **changes: Any) -> Path:
    """Write the project into a folder and return it; changes are of the study, merged by block, None takes away."""
    for name in ("config/studies", "config/designs", "meshes"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    settings = merged(machine.settings, changes)
    (folder / f"config/studies/{STUDY}.yaml").write_text(yaml.safe_dump(settings, sort_keys=False))
    (folder / "config/designs/machine.csv").write_text(rows)
    (folder / "config/materials.yaml").write_text(yaml.safe_dump(dict(machine.materials)))
    for name, body in machine.bodies.items():
        write_ascii(folder / f"meshes/{name}.stl", {name: body})
    return folder


@contextmanager
def machine_study(folder: Path, rows: str = "row\nA\n", machine: Machine = TINY, **changes: Any) -> Iterator[Study]:
    """Write the project, work in it, and yield its study."""
    enter_project(machine_project(folder, rows, machine, **changes))
    try:
        yield load_study(STUDY)
    finally:
        leave_project()


def machine_chain(study: Study, folder: Path, run: str = "") -> Chain:
    """Return a run of a study in a folder, the first one by default, its surface built unless it is there."""
    name = run or study.runs[0].name
    parameters, surface = study.run(name).parameters, folder / name / "surface.vtu"
    if not surface.exists():
        surface.parent.mkdir(parents=True, exist_ok=True)
        write_surface(surface, study.case.surface_mesh(study.case.surface_sections(parameters)))
    return Chain(name, surface.parent, study.case, parameters, surface)
