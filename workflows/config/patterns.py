"""Surfaces of samples: what a configuration may say of them, and which builder of meshes/ makes them.

A surface is called `plain`, or as a registered pattern is (`meshes.pattern.PATTERNS`); all else follows from that.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import Field
from typing import Any

from bulkwear.meshes.lattice import Pattern
from bulkwear.meshes.pattern import PATTERNS
from bulkwear.meshes.sample import sliding_sample
from bulkwear.postproc.mesh import PLAIN, SurfaceMesh
from bulkwear.postproc.reference.size_ratios import equivalent_size_ratio
from bulkwear.workflows.config.units import to_si

SURFACES = (*PATTERNS, PLAIN)
SHAPE = "shape"  # key of the section `pattern` of a run's parameters: the name of its surface
LATTICE = {"column_spacing_m": "column_spacing", "row_offset_fraction": "row_offset"}
ROW_SPACING, ROW_SPACING_BETWEEN = "row_spacing_m", "row_spacing_between"
# What the row spacing c of a source lies between, and how often one row comes after another in it: docs/decisions.md.
ROWS_PER_SPACING = {"rows_in_phase": 2, "neighbouring_rows": 1}
# Places in a schema that the registered patterns fill: properties or items, items, words.
DIMENSIONS, OPTIONS, LISTED, NAMED = "<dimensions>", "<options>", "<surfaces>", "<patterns>"


def _key(field: Field) -> str:
    """Return a setting's key, or the column of a design, that gives a field of a pattern."""
    return f"{field.name}_{field.metadata['unit']}" if "unit" in field.metadata else field.name


def dimension_columns(surface: str) -> list[str]:
    """Return the columns of the lengths and angles that a surface needs."""
    return [] if surface == PLAIN else [_key(each) for each in PATTERNS[surface].dimensions()]


def option_keys(surface: str) -> list[str]:
    """Return the keys of the words that a surface needs."""
    return [] if surface == PLAIN else [_key(each) for each in PATTERNS[surface].options()]


def _fields_in_si(shape: type[Pattern]) -> dict[str, str]:
    """Return {key in SI: field} of a shape and its lattice, the distance between rows aside."""
    own = [*shape.dimensions(), *shape.options()]
    return {next(iter(to_si({_key(each): 0.0}))): each.name for each in own} | LATTICE


def pattern_section(surface: str, values: Mapping[str, Any]) -> dict[str, Any] | None:
    """Return the section `pattern` of a run's parameters, of what its surface needs of `values` (SI); None if plain."""
    if surface == PLAIN:
        return None
    keys = [*_fields_in_si(PATTERNS[surface]), ROW_SPACING, ROW_SPACING_BETWEEN]
    return {SHAPE: surface, **{key: values[key] for key in keys}}


def surface_name(section: Mapping[str, Any] | None) -> str:
    """Return the surface of a run by its section `pattern`."""
    return PLAIN if section is None else section[SHAPE]


def pattern_of(section: Mapping[str, Any] | None) -> Pattern | None:
    """Return the pattern that a section `pattern` of a run's parameters (SI) stands for; None for a plain sample."""
    if section is None:
        return None
    shape = PATTERNS[section[SHAPE]]
    row_spacing = section[ROW_SPACING] / ROWS_PER_SPACING[section[ROW_SPACING_BETWEEN]]
    return shape(row_spacing=row_spacing, **{field: section[key] for key, field in _fields_in_si(shape).items()})


def highest_point(section: Mapping[str, Any] | None) -> float:
    """Return how high (m) a sample rises over its plane."""
    pattern = pattern_of(section)
    return 0.0 if pattern is None else pattern.highest_point


def sample_surface(sample: Mapping[str, Any], pattern: Mapping[str, Any] | None) -> SurfaceMesh:
    """Return the pristine surface of a sliding sample with its skirt; sections of a run's parameters, SI."""
    return sliding_sample(
        sample["width_m"],
        sample["length_m"],
        sample["element_size_m"],
        pattern_of(pattern),
        sample["height_above_floor_m"],
        sample["skirt_slope_rad"],
        sample["skirt_radius_m"],
    )


def with_patterns(schema: Any) -> Any:
    """Return a schema whose places for the registered patterns are filled in."""
    if isinstance(schema, dict):
        filled: dict[str, Any] = {}
        for key, inner in schema.items():
            filled |= _declared(key) if key in (DIMENSIONS, OPTIONS) else {key: with_patterns(inner)}
        return filled
    if isinstance(schema, list):
        known = {LISTED: SURFACES, NAMED: PATTERNS, DIMENSIONS: _declared(DIMENSIONS)}
        items = [known.get(item) if isinstance(item, str) else None for item in schema]
        return [each for item, own in zip(schema, items, strict=True) for each in own or [with_patterns(item)]]
    return schema.replace(NAMED, ", ".join(PATTERNS)) if isinstance(schema, str) else schema


def _declared(place: str) -> dict[str, dict[str, Any]]:
    """Return the schemas of all dimensions or options, by key; what several shapes declare holds for all of them."""
    found: dict[str, list[Field]] = {}
    for shape in PATTERNS.values():
        for each in shape.dimensions() if place == DIMENSIONS else shape.options():
            found.setdefault(_key(each), []).append(each)
    return {key: _schema([each.metadata for each in same]) for key, same in found.items()}


def _schema(declared: list[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the schema of one dimension or option that shapes declare."""
    meaning = {"description": "; ".join(dict.fromkeys(each["meaning"] for each in declared))}
    if "allowed" in declared[0]:
        return {"enum": list(dict.fromkeys(word for each in declared for word in each["allowed"])), **meaning}
    limits = {"minimum": min(each["least"] for each in declared), "maximum": max(each["most"] for each in declared)}
    return {"type": "number", **limits, "x-unit": declared[0]["unit"], **meaning}


def size_ratio(parameters: dict[str, Any]) -> float | None:
    """Return alpha_ER, the particle's size over a bump's (-); None for a surface that has none."""
    pattern = pattern_of(parameters["pattern"])
    if pattern is None or pattern.bump_axes is None:
        return None
    return equivalent_size_ratio(parameters["particle"]["median_diameter_m"], *pattern.bump_axes)
