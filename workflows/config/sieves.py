"""Sizes of a bulk material in the file of materials: as classes about its median, or as what passes sieves.

    size_distribution:
      passing: {sieve_mm: [6, 8, 10, 12], fraction: [0.05, 0.4, 0.8, 1.0]}
      finest_fraction: 0.1      # by mass, counted to the smallest class
      size_classes: 3

What passes sieves becomes classes by the rule of postproc/flow/size_classes.py, which also gives the median.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bulkwear.postproc.flow.size_classes import size_classes
from bulkwear.workflows.config.layers import ConfigError, KeyPath, Layer, dotted
from bulkwear.workflows.config.schema import load_schema, subschema
from bulkwear.workflows.config.validation import allowed_text

DISTRIBUTION, MEDIAN, TOLD = "size_distribution", "median_diameter_mm", "told"
CLASSES = ("relative_diameter", "mass_fraction")
SIEVES = ("passing", "finest_fraction", "size_classes")
MM = 1e3  # per m


def by_sieves(particle: Mapping[str, Any]) -> bool:
    """Return whether a material's sizes are what passes sieves."""
    return any(key in particle[DISTRIBUTION] for key in SIEVES)


def check_sizes(layer: Layer, path: KeyPath, particle: Mapping[str, Any]) -> None:
    """Raise ConfigError for a material whose sizes are given in both ways or not wholly, and for sieves that are none.

    layer: a file of materials; path: of the material in it
    """
    sieved = by_sieves(particle)
    needed = [(DISTRIBUTION, key) for key in SIEVES] if sieved else [(MEDIAN,), *((DISTRIBUTION, k) for k in CLASSES)]
    for keys in needed:
        if not layer.holds((*path, *keys)):
            schema = subschema(load_schema("materials"), (*path, *keys))
            where = layer.where((*path, *keys[:-1]))
            raise ConfigError(f"{where}: {dotted((*path, *keys))} is missing, allowed is {allowed_text(schema)}.")
    for keys in ((MEDIAN,), *((DISTRIBUTION, key) for key in CLASSES)) if sieved else ():
        if layer.holds((*path, *keys)):
            place = (*path, *keys)
            raise ConfigError(
                f"{layer.where(place)}: {dotted(place)} stands beside {dotted((*path, DISTRIBUTION, SIEVES[0]))}, from"
                " which it follows, allowed is one of them."
            )
    if sieved:
        _classes(layer, path, particle)


def _classes(layer: Layer, path: KeyPath, particle: Mapping[str, Any]) -> Any:
    given = particle[DISTRIBUTION]
    sieves = [float(each) / MM for each in given["passing"]["sieve_mm"]]
    try:
        return size_classes(sieves, given["passing"]["fraction"], given["finest_fraction"], given["size_classes"])
    except ValueError as fault:
        place = (*path, DISTRIBUTION, "passing")
        raise ConfigError(f"{layer.where(place)}: {dotted(place)}: {fault}.") from None


def with_classes(particle: Mapping[str, Any]) -> dict[str, Any]:
    """Return a checked material with median and classes, in the units of the file, and the rule told."""
    if not by_sieves(particle):
        return dict(particle)
    found = _classes(Layer("", {}, {}), (), particle)
    classes = {
        "relative_diameter": [float(value) for value in found.diameters_m / found.median_m],
        "mass_fraction": [float(value) for value in found.mass_fractions],
        TOLD: found.told,
    }
    return {**particle, MEDIAN: MM * found.median_m, DISTRIBUTION: classes}
