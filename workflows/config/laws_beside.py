"""Laws beside that of a study: `wear.beside` holds, by name, the parameters of each.

The ledgers of its runs hold the sums of all of them, so that figures set them side by side without another simulation;
a part of a machine may wear by one of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import Any

from bulkwear.postproc.wear.laws import LAWS
from bulkwear.workflows.config.law_settings import (
    LAW,
    WEAR,
    completed,
    parameters_schema,
)
from bulkwear.workflows.config.layers import ConfigError, Layer, dotted, merge
from bulkwear.workflows.config.schema import without_required
from bulkwear.workflows.config.validation import allowed_text, check_layer, locate
from bulkwear.workflows.engine.worn_pair import BESIDE

PLACE = (WEAR, BESIDE)


def beside_settings(layers: Sequence[Layer]) -> dict[str, dict[str, float]]:
    """Return {law: its parameters} of the laws beside that of a study, with their defaults."""
    return {law: completed(law, given) for law, given in _given(layers).items()}


def check_beside(layers: Sequence[Layer]) -> None:
    """Raise ConfigError for a law beside the study's that there is not, or that is the study's own, for parameters as
    `check_law` does.
    """
    laws = {law: {**parameters_schema(law), "additionalProperties": False} for law in LAWS}
    block = {"type": "object", "additionalProperties": False, "properties": laws}
    schema = without_required({"properties": {WEAR: {"properties": {BESIDE: block}}}})
    for layer in layers:
        if layer.holds(PLACE):
            check_layer(
                Layer(layer.source, {WEAR: {BESIDE: layer.values[WEAR][BESIDE]}}, layer.lines, layer.block), schema
            )
    own = next(layer.values[WEAR][LAW] for layer in reversed(layers) if layer.holds((WEAR, LAW)))
    for law, given in _given(layers).items():
        where = locate(tuple(layers), (*PLACE, law))
        if law == own:
            raise ConfigError(f"{where}: {dotted(PLACE)} has {law}, which is {WEAR}.{LAW}, allowed are other laws.")
        for key in parameters_schema(law)["required"]:
            if key not in given:
                allowed = allowed_text(parameters_schema(law)["properties"][key])
                raise ConfigError(f"{where}: {dotted((*PLACE, law, key))} is missing, allowed is {allowed}.")


def _given(layers: Sequence[Layer]) -> dict[str, dict[str, Any]]:
    return reduce(merge, (layer.values[WEAR][BESIDE] for layer in layers if layer.holds(PLACE)), {})
