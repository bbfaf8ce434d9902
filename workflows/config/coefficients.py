"""Wear coefficients of a run: in 1/Pa, or k over the hardness of the wall, given by part, section or pair of materials.

The file of materials may give the coefficient of a pair, `walls.<wall>.wear.<particle>`, and the wall's `hardness_pa`.
A pair's stands above config/default.yaml, below whatever else gives one, and serves the law that it names; its error
goes with it, unless a study gives one.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import reduce
from typing import Any

from bulkwear.postproc.wear.coefficient import (
    DIMENSIONLESS,
    PER_PA,
    coefficient_per_pa,
    dimensionless_coefficient,
)
from bulkwear.postproc.wear.laws import NEUTRAL_LAW
from bulkwear.workflows.config.layers import ConfigError, KeyPath, Layer, dotted, merge
from bulkwear.workflows.config.validation import check_alternatives, locate, show, unknown_name
from bulkwear.workflows.engine.case import Case
from bulkwear.workflows.engine.worn_pair import COEFFICIENT_ERROR, WALL_HARDNESS, WornPair

COEFFICIENTS = (PER_PA, DIMENSIONLESS)
WEAR, HARDNESS, LAW = "wear", "hardness_pa", "law"  # keys of the settings and of a wall
TOLD = (*COEFFICIENTS, WALL_HARDNESS)


def alternatives_of(case: Case, values: Mapping[str, Any]) -> list[tuple[KeyPath, ...]]:
    """Return the groups of settings of which one stands for all others: the case's, and ways to give a coefficient.

    values: of a layer, which names the parts
    """
    parts = values.get("parts", {}) if case.by_part else {}
    blocks = [(WEAR,), *(("parts", name) for name in parts)]
    return [case.alternatives, *(tuple((*block, key) for key in COEFFICIENTS) for block in blocks)]


def with_coefficients(
    case: Case, settings: dict[str, Any], materials: Mapping[str, Any], named: Collection[str]
) -> dict[str, Any]:
    """Return the settings of a run with the coefficient (1/Pa) of everything that wears; where the wall's hardness is
    known with k and hardness too. A coefficient that needs a hardness which is not known stays as it is.

    named: keys of the section `wear` that stand above a pair's, as of `Sources.of_coefficient`
    """
    settings = merge(settings, {})
    shared = settings[WEAR] | {}
    for pair in case.worn_pairs(settings):
        block = reduce(dict.__getitem__, pair.block, settings)
        own = {} if pair.block == (WEAR,) else block
        of_pair = {} if _given(own) or set(COEFFICIENTS) & set(named) else _of_pair(materials, pair)
        given = _given(own) or _given(of_pair) or _given(shared)
        found = _complete(given, materials["walls"].get(pair.wall, {}).get(HARDNESS))
        if _given(own) or found != _given(shared):
            block.pop(PER_PA, None)
            block.update(found)
        if COEFFICIENT_ERROR in of_pair and COEFFICIENT_ERROR not in {*own, *named}:
            block[COEFFICIENT_ERROR] = of_pair[COEFFICIENT_ERROR]
        if PER_PA in found:
            settings[WEAR].setdefault(PER_PA, found[PER_PA])  # of several parts the first one's
    return settings


def check_hardness(layers: tuple[Layer, ...], case: Case, settings: Mapping[str, Any]) -> None:
    """Raise ConfigError for a coefficient k where the hardness of what wears is not known.

    settings: as from `with_coefficients`
    """
    for pair in case.worn_pairs(settings):
        own, shared = _given(reduce(dict.__getitem__, pair.block, settings)), _given(settings[WEAR])
        # a shared k that could be completed stands in the part's block
        block = own or {key: shared[key] for key in shared if key == DIMENSIONLESS}
        if DIMENSIONLESS in block and PER_PA not in block:
            path = (*pair.block, DIMENSIONLESS)
            path = path if any(layer.holds(path) for layer in layers) else (WEAR, DIMENSIONLESS)
            raise ConfigError(
                f"{locate(layers, path)}: {dotted(path)} is {show(block[DIMENSIONLESS])}, allowed is {PER_PA}, or a"
                f" {HARDNESS} of the wall {pair.wall} in the file of materials, over which k is taken."
            )


def check_pairs(layers: tuple[Layer, ...] | list[Layer], materials: Mapping[str, Any]) -> None:
    """Raise ConfigError for a pair of materials with both or none of the coefficients, with k and no hardness of its
    wall, or with a particle that there is not.

    layers: files of materials; materials: of all of them
    """
    known = sorted({*materials.get("particles", {}), *materials.get("pins", {})})
    for layer in layers:
        for wall, values in layer.values.get("walls", {}).items():
            for particle, pair in values.get(WEAR, {}).items():
                path = ("walls", wall, WEAR, particle)
                if particle not in known:
                    raise ConfigError(unknown_name(layer.where(path), dotted(path[:-1]), particle, known))
                check_alternatives(layer, tuple((*path, key) for key in COEFFICIENTS), required=True)
                if DIMENSIONLESS in pair and HARDNESS not in values:
                    raise ConfigError(
                        f"{layer.where(path)}: {dotted((*path, DIMENSIONLESS))} is {show(pair[DIMENSIONLESS])}, allowed"
                        f" is {PER_PA}, or a {HARDNESS} of the wall {wall}, over which k is taken."
                    )


def coefficient_columns(parameters: Mapping[str, Any]) -> dict[str, float]:
    """Return the coefficient of a run in all ways where its wall's hardness is known, nothing else."""
    wear = parameters.get(WEAR, {})
    return {key: wear[key] for key in TOLD} if WALL_HARDNESS in wear else {}


def _given(block: Mapping[str, Any]) -> dict[str, float]:
    return {key: block[key] for key in COEFFICIENTS if key in block}


def _of_pair(materials: Mapping[str, Any], pair: WornPair) -> dict[str, Any]:
    """Return what a pair of materials says of its coefficient, nothing where there is none for the law."""
    found = materials["walls"].get(pair.wall, {}).get(WEAR, {}).get(pair.particle, {})
    return found if found.get(LAW, NEUTRAL_LAW) == pair.law else {}


def _complete(given: Mapping[str, float], hardness: float | None) -> dict[str, float]:
    """Return a coefficient in 1/Pa, as k, and the hardness (Pa), or as it is where that is not known."""
    if hardness is None:
        return dict(given)
    if PER_PA in given:
        alpha = given[PER_PA]
        return {PER_PA: alpha, DIMENSIONLESS: dimensionless_coefficient(alpha, hardness), WALL_HARDNESS: hardness}
    k = given[DIMENSIONLESS]
    return {PER_PA: coefficient_per_pa(k, hardness), DIMENSIONLESS: k, WALL_HARDNESS: hardness}
