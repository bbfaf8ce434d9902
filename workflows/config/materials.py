"""Check the materials of a study: their size distributions, and whether a run names and uses them as they hold."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Sequence
from functools import reduce
from typing import Any

from bulkwear.workflows.config.clumps import ROUND
from bulkwear.workflows.config.coefficients import check_pairs
from bulkwear.workflows.config.layers import ConfigError, Layer, dotted
from bulkwear.workflows.config.schema import coerce_numbers, load_schema
from bulkwear.workflows.config.sieves import by_sieves, check_sizes, with_classes
from bulkwear.workflows.config.validation import check_layer, locate, show, unknown_name

CALIBRATED_WITH = ("rolling_radius", "rolling_friction")  # settings that a calibrated material holds for
ROLLING = "particle.contact.rolling_friction"  # the parameter that holds for them alone
MASS_FRACTION_TOLERANCE = 1e-9  # rounding of a sum of decimal fractions
SHAPE = "shape"  # of particles: key beside a material's name, and of what it was calibrated for
MEDIAN_FACTOR = 1.5  # -, within which the classes of a size distribution have their median, in which layers are counted


def check_materials(layers: Sequence[Layer]) -> dict[str, Any]:
    """Return the materials of all files as floats after all checks; those of a later file stand for the earlier's of
    their name. Raises ConfigError.
    """
    schema = load_schema("materials")
    check_layer(layers[0], schema)
    for layer in layers[1:]:
        check_layer(layer, {**schema, "required": []})
    for layer in layers:
        _check_distributions(layer)
    kinds = dict.fromkeys(kind for layer in layers for kind in layer.values)
    together = {kind: {k: v for each in layers for k, v in each.values.get(kind, {}).items()} for kind in kinds}
    check_pairs(layers, together)
    particles = {name: with_classes(particle) for name, particle in together["particles"].items()}
    return coerce_numbers({**together, "particles": particles}, schema)


def _check_distributions(layer: Layer) -> None:
    for name, particle in layer.values.get("particles", {}).items():
        check_sizes(layer, ("particles", name), particle)
        if by_sieves(particle):
            continue
        distribution = particle["size_distribution"]
        path = ("particles", name, "size_distribution", "mass_fraction")
        fractions, count = distribution["mass_fraction"], len(distribution["relative_diameter"])
        if len(fractions) != count:
            raise ConfigError(
                f"{layer.where(path)}: {dotted(path)} has {len(fractions)} values, allowed are {count},"
                " one per relative_diameter."
            )
        if abs(math.fsum(fractions) - 1.0) > MASS_FRACTION_TOLERANCE:
            raise ConfigError(
                f"{layer.where(path)}: {dotted(path)} has the sum {math.fsum(fractions):.10g}, allowed is 1."
            )
        if fault := _fault_of_diameters(distribution["relative_diameter"], fractions):
            path = (*path[:-1], "relative_diameter")
            raise ConfigError(f"{layer.where(path)}: {dotted(path)} {fault}.")


def _fault_of_diameters(diameters: Sequence[float], fractions: Sequence[float]) -> str | None:
    """Return what is wrong with relative diameters: they are over the median by mass, which they so have about 1."""
    if any(later <= earlier for earlier, later in itertools.pairwise(diameters)):
        return f"is {show(list(diameters))}, allowed are rising numbers"
    below = list(itertools.accumulate(fractions))
    half = 0.5 - MASS_FRACTION_TOLERANCE
    least = next(d for d, share in zip(diameters, below, strict=True) if share >= half)
    most = next(d for d, share in zip(diameters, below, strict=True) if share > 1.0 - half)
    if least <= MEDIAN_FACTOR and most >= 1.0 / MEDIAN_FACTOR:
        return None
    return (
        f"is {show(list(diameters))} with a median of {least:.4g} by mass, allowed are diameters over the median, whose"
        f" own median is 1 within a factor of {MEDIAN_FACTOR:g}"
    )


def check_material_names(
    layers: tuple[Layer, ...],
    settings: dict[str, Any],
    materials: dict[str, Any],
    keys: tuple[tuple[str, ...], ...],
) -> None:
    """Raise ConfigError if a setting names a material that config/materials.yaml does not have.

    keys: path of the settings that name one, and its kind of material
    """
    for *path, kind in keys:
        value, known = reduce(dict.__getitem__, path, settings), materials.get(kind, {})
        if value not in known:
            raise ConfigError(unknown_name(locate(layers, tuple(path)), dotted(tuple(path)), value, sorted(known)))


def check_calibrated_for(
    layers: tuple[Layer, ...],
    settings: dict[str, Any],
    materials: dict[str, Any],
    keys: tuple[tuple[str, ...], ...],
    looked_for: Collection[str] = (),
) -> None:
    """Raise ConfigError if a bulk material was calibrated in another rolling friction model or convention.

    A rolling coefficient is a number of the model and of the radius that it was found with; keys as for
    `check_material_names`. looked_for: parameters that the study itself looks for, whatever they were before
    """
    for *path, kind in () if ROLLING in looked_for else keys:
        name = reduce(dict.__getitem__, path, settings)
        found = materials.get(kind, {}).get(name, {}).get("calibrated")
        if found and kind == "particles":
            _check_shape(layers, settings, tuple(path), name, found.get(SHAPE, ROUND))
        for word in CALIBRATED_WITH if found and kind == "particles" else ():
            if settings["solver"][word] != found[word]:
                raise ConfigError(
                    f"{locate(layers, ('solver', word))}: solver.{word} is '{settings['solver'][word]}', allowed is"
                    f" {found[word]}, in which study {found['study']} calibrated {name}, or another"
                    f" {dotted(tuple(path))}."
                )


def _check_shape(
    layers: tuple[Layer, ...], settings: dict[str, Any], path: tuple[str, ...], name: str, calibrated: str
) -> None:
    """Raise ConfigError where friction that was calibrated for clumps is that of other particles.

    path: of the setting that names the material, beside which the shape stands
    """
    shape = reduce(dict.__getitem__, path[:-1], settings).get(SHAPE, ROUND)
    if calibrated not in (ROUND, shape):
        where = (*path[:-1], SHAPE)
        place = locate(layers, where if any(layer.holds(where) for layer in layers) else path)
        raise ConfigError(
            f"{place}: {dotted(where)} is '{shape}', allowed is {calibrated}, for which {name} was calibrated, or"
            f" another {dotted(path)}."
        )
