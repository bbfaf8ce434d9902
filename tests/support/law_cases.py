"""Settings of every wear law for tests, and a law with parameters of its own."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from bulkwear.postproc.wear.kernels import KERNELS, Kernel
from bulkwear.postproc.wear.laws import LAWS, Law, Parameter
from bulkwear.workflows.config.schema import case_schema, load_schema
from bulkwear.workflows.config.units import to_si

OKA = {  # constants of Oka's law of no pair of materials
    "angle_exponent": 0.7,
    "hardness_exponent": 2.0,
    "hardness_pa": 1.5e9,
    "velocity_exponent": 2.3,
    "reference_velocity_m_per_s": 100.0,
}
ALPHA = 6.3e-13  # 1/Pa, steel on a pin-on-disc rig (Yan 2022, chapter 5)


def told_of(setting: str, packing: int, law: str, volume_m3: float) -> dict[str, Any]:
    """Return a line of volume_by_law.csv, of a run of two blocks: as much as by Archard, and in the same places."""
    run = {"run": f"{setting}-{packing}", "row": setting, "setting": setting, "packing": packing, "surface": ""}
    ratios = {"over_archard": 1.0, "overlap": 1.0, "correlation": 1.0}
    return run | {"law": law, "cycles": 2, "worn_volume_m3": volume_m3} | ratios


def wear_settings(law: str) -> dict[str, Any]:
    """Keys of `wear` that choose a law; its parameters have their defaults, or the middle of their range."""
    middle = {p.name: 0.5 * (p.lowest + p.highest) if p.default is None else p.default for p in LAWS[law].parameters}
    return {"law": law, "parameters": middle}


def parameters_of(law: str) -> dict[str, float]:
    """The same parameters as the law's function takes them: SI, with a wear coefficient."""
    return {"wear_coefficient_per_pa": ALPHA, **to_si(wear_settings(law)["parameters"])}


def long_slip(contacts, motion, face_normal, exponent, length_m):
    """|v_t| (L / 1 mm)^n in m/s: not a power, and both parameters matter."""
    return motion.sliding_speed * (length_m / 1e-3) ** exponent


LONG_SLIP_KERNEL = Kernel(long_slip, unit="m", parameters=("exponent", "length_m"))
LONG_SLIP = Law(
    lambda columns, given: given["wear_coefficient_per_pa"] * np.asarray(columns["long_slip_m"], np.float64),
    "coefficient {wear_coefficient_per_pa} 1/Pa, exponent {exponent}, length {length_mm} mm.",
    "nobody",
    kernels=("long_slip",),
    parameters=(
        Parameter("exponent", "of the length", 0.5, 3.0, unit="-"),
        Parameter("length_mm", "a length", 0.1, 50.0, default=2.0, unit="mm"),
    ),
)


@contextmanager
def long_slip_registered() -> Iterator[None]:
    """Within it there is the law `long_slip`, with a kernel and parameters of its own."""
    LAWS["long_slip"], KERNELS["long_slip"] = LONG_SLIP, LONG_SLIP_KERNEL
    schemas = (load_schema, case_schema)  # they remember the laws
    try:
        for schema in schemas:
            schema.cache_clear()
        yield
    finally:
        del LAWS["long_slip"], KERNELS["long_slip"]
        for schema in schemas:
            schema.cache_clear()
