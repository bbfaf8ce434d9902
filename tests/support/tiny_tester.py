"""A circular wear tester small enough for tests: 700 particles, a sample of 40 mm, two cycles, some seconds."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from bulkwear.workflows.config.design import Study, load_study
from bulkwear.workflows.report.products import job_of, outputs_of, paths_of, products_of, told_to, write_product
from tests import REPOSITORY
from tests.support.tiny import OF_ANY_MODEL

TINY = {
    "packings": 1,
    "particle_scale": 4,
    "sample": {"width_mm": 40, "length_mm": 40, "thickness_mm": 4, "element_size_mm": 2},
    "tester": {
        "inner_radius_mm": 100,
        "outer_radius_mm": 196,
        "channel_deg": 56,
        "bed_height_mm": 72,
        "depth_mm": 35,
        "consolidator_level_mm": 72,
        "consolidator_rise_mm": 10,
        "consolidator_ramp_mm": 20,
        "consolidator_flat_mm": 10,
    },
    "bed": {"material": OF_ANY_MODEL},
    "sliding": {
        "angular_speed_deg_per_s": 235,
        "revolution_deg": 30,
        "steady_revolutions": 4.0,  # until the consolidator has levelled the bed
        "run_in_revolutions": 0.2,
        "revolutions": 2,
        "cycles_per_revolution": 2,
    },
    "solver": {"pictures_per_revolution": 8, "looks_per_revolution": 8},
}
ROWS = ("plain", "convex")


def tiny_tester(**changes) -> Study:
    """Return the quick study, shrunk; `changes` are further settings, merged by section."""
    settings = {key: dict(value) if isinstance(value, dict) else value for key, value in TINY.items()}
    for key, value in changes.items():
        settings[key] = {**settings.get(key, {}), **value} if isinstance(value, dict) else value
    return load_study("circular_tester", overrides={"fidelity": "quick", "rows": list(ROWS), **settings})


def make_products(
    study: Study, root: Path, names: Iterable[str], remarks: list[str], told: Mapping[str, Any] = MappingProxyType({})
) -> None:
    """Make figures and tables of a study by name, as their rules do; its results lie below root/results.

    told: what they are told instead of what the study says
    """
    for name in names:
        product = products_of(study.case)[name]
        files = {key: _below(root, paths_of(source, study)) for key, source in product.inputs.items()}
        outputs = {key: root / path for key, path in outputs_of(product, study.name).items()}
        for path in outputs.values():
            path.parent.mkdir(parents=True, exist_ok=True)
        asked = json.loads(json.dumps(told_to(product, study)))
        instead = {name: value for name, value in told.items() if name in asked}
        write_product(product, job_of(files, asked | instead, remarks), outputs)


def _below(root: Path, paths: str | list[str]) -> str | list[str]:
    """Return paths of results below root, and others below the repository."""
    if isinstance(paths, list):
        return [_below(root, path) for path in paths]
    return str((root if paths.startswith("results/") else REPOSITORY) / paths)
