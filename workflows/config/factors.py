"""The factors of the regression that a study asks for, and whether the rows of its design can tell of them."""

from __future__ import annotations

from bulkwear.postproc.mesh import PLAIN
from bulkwear.workflows.config.layers import ConfigError, Layer
from bulkwear.workflows.config.packings import Packings
from bulkwear.workflows.config.sources import Sources

FACTORS = "factors"  # key of a study
FEWEST_SETTINGS = 5  # for which a regression is made: AICc needs four more than a model has terms


def can_tell(factors: dict[str, str], designed: Packings, rows: list[Layer]) -> bool:
    """Return whether the chosen rows are enough for a regression on the factors."""
    settings = {designed.setting_of[row.values["row"]] for row in rows}
    told = all(len({row.values[name] for row in rows}) > 1 for name in factors.values())
    return len(settings) >= FEWEST_SETTINGS and told


def factors_of(sources: Sources, designed: Packings, chosen: list[str]) -> dict[str, str]:
    """Return the factors of the study's regression; the rows must be able to tell of each, and the surfaces must have a
    pattern. Raises ConfigError.

    Where rows are chosen, those that have a fault are left out, and nothing is asked of the others together.
    """
    factors, rows = sources.study.values.get(FACTORS, {}), designed.rows
    if chosen:
        told = all(column in row.values for column in factors.values() for row in rows)
        _check_patterned(sources, factors)
        return dict(factors) if told else {}
    settings = set(designed.setting_of.values())
    for name, column in factors.items():
        if any(column not in row.values for row in rows):
            raise ConfigError(
                f"{sources.study.where((FACTORS, name))}: {FACTORS}.{name} is {column}, allowed are columns that the"
                " design gives in every row."
            )
        levels = {row.values[column] for row in rows}
        if len(levels) < 2:
            raise ConfigError(
                f"{sources.study.where((FACTORS, name))}: {FACTORS}.{name} is {column}, which is"
                f" {levels.pop():g} in every row of the design, allowed are columns with two levels or more."
            )
    _check_patterned(sources, factors)
    if factors and len(settings) < FEWEST_SETTINGS:
        raise ConfigError(
            f"{sources.study.where((FACTORS,))}: {FACTORS} ask for a regression, found a design of {len(settings)}"
            f" settings, allowed are {FEWEST_SETTINGS} or more."
        )
    return dict(factors)


def _check_patterned(sources: Sources, factors: dict[str, str]) -> None:
    """Raise ConfigError where factors are named and no surface has a pattern: a regression is of the patterned runs."""
    surfaces = sources.case.surfaces(sources.head)
    if factors and not set(surfaces) - {PLAIN}:
        raise ConfigError(
            f"{sources.study.where((FACTORS,))}: {FACTORS} ask for a regression of the wear of patterned samples, found"
            f" surfaces {', '.join(surfaces)}, allowed are surfaces with a pattern among them."
        )
