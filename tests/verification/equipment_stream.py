"""A stream of one layer that slides down a plate at the speed it was fed with, and what it must wear.

The slope is that of wall friction, tan(slope) = mu: gravity along the plate and friction of what slides on it balance,
whatever bounces or lies on other particles, so that the mean speed stays. Rolling friction of constant torque above mu
keeps particles from rolling, in impacts too. A head and a tail that do not wear lie before and behind the liner, which
so has the same load everywhere:

    recession = alpha m'' g cos(slope) v = alpha (rate / width) g cos(slope)

as the mass m'' on an area is the rate over width and speed. The slice is periodic across the stream.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from bulkwear.postproc.wear.caps import GRAVITY
from tests.support.own_machine_project import Machine, turned
from tests.support.own_solids import box

FRICTION = 0.3  # -, of the wall
SLOPE = math.atan(FRICTION)
WIDTH, THICKNESS = 100.0, 30.0  # mm
DIAMETER = 12.0  # mm, of all particles
SPEED = 1.2  # m/s
RATE = 2.0  # t/h: a quarter of the plate is covered
INLET_HEIGHT = 40.0  # mm, over the plate
ENDS = {"head": (-60.0, 340.0), "liner": (340.0, 740.0), "tail": (740.0, 800.0)}  # mm, along the slope from the inlet
SHORT = {"head": (-60.0, 240.0), "liner": (240.0, 480.0), "tail": (480.0, 540.0)}  # the same, for many repeats
DOWN = np.array([math.cos(SLOPE), 0.0, -math.sin(SLOPE)])
CONTACT = {"restitution": 0.3, "rolling_friction": 1.0}
MATERIALS = {
    "particles": {
        "ball": {
            **{
                "density_kg_per_m3": 2500,
                "poissons_ratio": 0.24,
                "shear_modulus_pa": 4.0e6,
                "bulk_solid_fraction": 0.6,
            },
            "median_diameter_mm": DIAMETER,
            "size_distribution": {"relative_diameter": [1.0], "mass_fraction": [1.0]},
            "contact": {**CONTACT, "sliding_friction": 0.5},
        }
    },
    "walls": {
        "plate": {
            **{"density_kg_per_m3": 7850, "poissons_ratio": 0.3, "shear_modulus_pa": 78.0e9},
            "contact": {**CONTACT, "sliding_friction": FRICTION},
        }
    },
}


def on_plate(along: float, over: float) -> list[float]:
    """Return the place (mm) so far along the slope and over the plate."""
    return turned(np.array([[along, 0.0, over]]), math.degrees(SLOPE))[0].tolist()


def bodies(ends: Mapping[str, tuple[float, float]] = ENDS) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return head, liner and tail, one behind the other along the slope."""
    found = {}
    for name, (begin, end) in ends.items():
        points, triangles = box((end - begin, WIDTH, THICKNESS), (begin, -0.5 * WIDTH, -THICKNESS))
        found[name] = (turned(points, math.degrees(SLOPE)), triangles)
    return found


def settings(blocks: int, block_s: float) -> dict[str, Any]:
    """Return the settings of a study that samples so many blocks."""
    part = {"unit": "mm", "material": "plate", "edge_mm": 25}
    far = on_plate(1000.0, 0.0)
    return {
        "title": "A stream on a plate",
        "question": "Does it wear as its weight says?",
        "case": "equipment",
        "design": "machine.csv",
        "packings": 1,
        "particle_scale": 1,
        "parts": {
            name: {**part, "file": f"{name}.stl", "role": "wears" if name == "liner" else "rigid"} for name in ENDS
        },
        "bulk": {"material": "ball"},
        "inlet": {
            "rate_t_per_h": RATE,
            "centre_mm": on_plate(0.0, 1.0 + 0.5 * INLET_HEIGHT),
            "normal": DOWN.tolist(),
            "size_mm": [WIDTH, INLET_HEIGHT],
            "velocity_m_per_s": (SPEED * DOWN).tolist(),
        },
        "outlets": {"end": {"centre_mm": [far[0], 0, far[2] - 60.0], "normal": [0, 0, -1], "size_mm": [800, WIDTH]}},
        "periodic": {"axis": "y", "low_mm": -0.5 * WIDTH, "high_mm": 0.5 * WIDTH},
        "start_up": {"most_s": 0.9},
        "sampling": {"block_s": block_s, "fewest_blocks": blocks, "most_blocks": blocks, "patch_mm": 100},
        "updates": {"most": 0},
        "operation": {"duration_h": 1000, "change_out_remaining_mm": 0},
        "wear": {"wear_coefficient_error": 0},
        "solver": {"rayleigh_fraction": 0.3},
    }


def stream(blocks: int, block_s: float = 0.3, ends: Mapping[str, tuple[float, float]] = ENDS) -> Machine:
    """Return the stream, sampled for so many blocks of that time (s)."""
    return Machine(settings(blocks, block_s), bodies(ends), MATERIALS)


def expected_recession(coefficient: float, rate_kg_per_s: float) -> float:
    """Return what the liner must lose (m/h) by a coefficient (1/Pa)."""
    return 3600.0 * coefficient * rate_kg_per_s / (1e-3 * WIDTH) * GRAVITY * math.cos(SLOPE)
