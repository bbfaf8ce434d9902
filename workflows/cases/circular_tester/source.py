"""Which samples of a study are the source's, beside whose runs its published numbers may stand (Yan 2022, chapter 6).

Pattern, machine and gravel count. What the source does not publish may be any: friction, rolling model, height of the
bed, thickness; so may what a fidelity reduces: particle scale, elements, the channel's length, revolutions.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Mapping
from dataclasses import fields
from functools import cache
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.circular_tester.runs import VARIED
from bulkwear.workflows.config.layers import read_yaml
from bulkwear.workflows.config.patterns import pattern_of, pattern_section, surface_name
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.engine.project import PACKAGE

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Study

SETTINGS = PACKAGE / "config" / "cases" / "circular_tester.yaml"  # numbers are the source's
MATERIALS, GRAVEL = PACKAGE / "config" / "materials.yaml", "river_gravel_published"
PUBLISHED = PACKAGE / "config" / "published" / "circular_tester.csv"
CONVEX = "convex"  # the source's pattern
SECONDS_PER_HOUR = 3600.0
MACHINE = (
    *(("sample", key) for key in ("width_mm", "length_mm")),
    *(("tester", key) for key in ("inner_radius_mm", "outer_radius_mm", "depth_mm", "incline_deg")),
    *(("sliding", key) for key in ("angular_speed_deg_per_s", "revolution_deg")),
)
LABORATORY = {("tester", "depth_mm"): 85.0}  # where the source's experiment has another number than its model
ROUNDING = 1e-6  # relative; of numbers that are converted


def unlike_source(study: Study) -> dict[str, str]:
    """Return {surface: why its runs are not the source's}, empty where all are; rows of series varied do not count."""
    varied = {row["row"] for row in study.design_rows if row["series"] == VARIED}
    found: dict[str, str] = {}
    for run in (run for run in study.runs if run.row not in varied):
        if why := list(_differences(run.parameters)):
            first, *others = why
            said = "; ".join([first, *(each.removeprefix("found ") for each in others)])
            found.setdefault(surface_name(run.parameters["pattern"]), said)
    return found


def _differences(parameters: Mapping[str, Any]) -> Iterator[str]:
    """Yield in words how a run differs from the source's."""
    settings, gravel = _source()
    for section, key in MACHINE:
        in_si, unit = next(iter(to_si({key: 1.0}).items()))
        own, theirs = parameters[section][in_si] / unit, settings[section][key]
        if not any(_alike(own, each) for each in (theirs, LABORATORY.get((section, key), theirs))):
            yield f"found with {section}.{key} {own:.4g}, the source's is {theirs:.4g}"
    particle = parameters["particle"]
    own_sizes = {
        "median_diameter_mm": 1e3 * particle["median_diameter_m"] / particle["scale"],
        "density_kg_per_m3": particle["density_kg_per_m3"],
    }
    for key, own in own_sizes.items():
        if not _alike(own, gravel[key]):
            yield f"found of particles with {key} {own:.4g}, the source's is {gravel[key]:.4g}"
    yield from _pattern_differences(parameters["pattern"], pattern_section(CONVEX, to_si(settings["pattern"])))


def _pattern_differences(section: Mapping[str, Any] | None, source: Mapping[str, Any] | None) -> Iterator[str]:
    if section is None:
        return
    if (name := surface_name(section)) != CONVEX:
        yield f"found of a {name} sample, the source's is {CONVEX}"
        return
    for each in fields(pattern_of(source)):
        own, theirs = (getattr(pattern_of(one), each.name) for one in (section, source))
        if own != theirs if isinstance(theirs, str) else not _alike(own, theirs):
            words = [_said(each.name, value) for value in (own, theirs)]
            yield f"found of bumps with {each.name.replace('_', ' ')} {words[0]}, the source's is {words[1]}"


def _said(name: str, value: float | str) -> str:
    if isinstance(value, str):
        return value
    return f"{value:.4g}" if name == "row_offset" else f"{1e3 * value:.4g} mm"


def _alike(own: float, theirs: float) -> bool:
    return math.isclose(own, theirs, rel_tol=ROUNDING, abs_tol=ROUNDING)


@cache
def material_coefficient() -> float:
    """Return the wear coefficient (1/Pa) of the source's plain sample in its own test, by pressure and distance."""
    with open(PUBLISHED, encoding="utf-8", newline="") as stream:
        found = {row["quantity"]: float(row["value"]) for row in csv.DictReader(stream) if row["of"] == "laboratory"}
    sample = _source()[0]["sample"]
    load = 1e3 * found["normal_pressure"] * 1e-6 * sample["width_mm"] * sample["length_mm"]
    distance = found["velocity_at_centre"] * found["short_test"] * SECONDS_PER_HOUR
    return 1e-9 * found["plain_volume_56_h"] / (load * distance)


@cache
def _source() -> tuple[Mapping[str, Any], Mapping[str, Any]]:
    """Return the settings of the source's tester and its gravel, in the units of their keys."""
    return read_yaml(SETTINGS, PACKAGE).values, read_yaml(MATERIALS, PACKAGE).values["particles"][GRAVEL]
