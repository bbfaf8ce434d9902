"""Parameters of wear laws in the configuration: `wear.parameters` holds what the chosen law of postproc/wear/laws.py
declares, and nothing else.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bulkwear.postproc.wear.kernel_sums import law_kernels
from bulkwear.postproc.wear.kernels import kernel_column
from bulkwear.postproc.wear.laws import LAWS, worn_volume
from bulkwear.postproc.wear.ledger import LEDGER_FIELDS
from bulkwear.workflows.config.layers import ConfigError, KeyPath, Layer, dotted
from bulkwear.workflows.config.schema import without_required
from bulkwear.workflows.config.validation import UNIT_OF_SUFFIX, allowed_text, check_layer, locate, show, unknown_key

WEAR, LAW, PARAMETERS = "wear", "law", "parameters"


def parameters_schema(law: str) -> dict[str, Any]:
    """Return the schema of `wear.parameters` with a law; required are those without a default.

    Raises ConfigError for a parameter whose unit is not the one that its name ends in.
    """
    properties = {}
    for parameter in LAWS[law].parameters:
        suffix = max((s for s in UNIT_OF_SUFFIX if parameter.name.endswith(f"_{s}")), key=len, default="")
        unit = UNIT_OF_SUFFIX.get(suffix, "-")
        if parameter.unit != unit:
            raise ConfigError(
                f"law {law}: the unit of its parameter {parameter.name} is {parameter.unit!r}, allowed is {unit!r}, by "
                f"the end of its name; names end in {', '.join(UNIT_OF_SUFFIX)}, or in none of a pure number."
            )
        properties[parameter.name] = {
            "type": "number",
            "minimum": parameter.lowest,
            "maximum": parameter.highest,
            "x-unit": unit,
            "description": parameter.meaning,
        }
    required = [parameter.name for parameter in LAWS[law].parameters if parameter.default is None]
    return {"type": "object", "properties": properties, "required": required}


def law_settings(layers: Sequence[Layer]) -> dict[str, float]:
    """Return the parameters of the law that the layers choose: what they give, defaults for the rest."""
    law, own = _layers_of_law(layers)
    return completed(law, {key: value for layer in own for key, value in _given(layer).items()})


def completed(law: str, given: Mapping[str, Any]) -> dict[str, float]:
    """Return the parameters of a law: what is given, defaults for the rest, nothing for what has neither."""
    values = {parameter.name: given.get(parameter.name, parameter.default) for parameter in LAWS[law].parameters}
    return {
        key: float(value) if isinstance(value, int) else value for key, value in values.items() if value is not None
    }


def check_law(layers: Sequence[Layer]) -> None:
    """Raise ConfigError for a parameter that the chosen law does not have, one out of its range, and a missing one."""
    law, own = _layers_of_law(layers)
    schema = parameters_schema(law)
    nested = {"properties": {WEAR: {"properties": {PARAMETERS: schema}}}}
    for layer in own:
        given = _given(layer)
        for path in ((WEAR, PARAMETERS, key) for key in given if key not in schema["properties"]):
            raise ConfigError(f"{layer.where(path)}: {_unknown(path, show(given[path[-1]]), law, nested)}.")
        part = Layer(layer.source, {WEAR: {PARAMETERS: given}}, layer.lines, layer.block)
        check_layer(part, without_required(nested))
    for key in schema["required"]:
        if not any(key in _given(layer) for layer in own):
            allowed = allowed_text(schema["properties"][key])
            where = locate(tuple(layers), (WEAR, LAW))
            raise ConfigError(f"{where}: {WEAR}.{PARAMETERS}.{key} is missing for the law {law}, allowed is {allowed}.")


def check_volume(law: str, parameters: Mapping[str, float]) -> None:
    """Raise ConfigError where a law's function fails on a ledger without load, or does not return what it should.

    parameters: of the law, SI, the coefficient included
    """
    try:
        kernels = law_kernels(law, parameters)
        names = (*LEDGER_FIELDS, *map(kernel_column, kernels))
        volume = np.asarray(worn_volume(law, {name: np.zeros(2) for name in names}, parameters), float)
    except Exception as fault:  # a law of a project's own may fail in any way
        words = f"{type(fault).__name__}: {fault}"
        raise ConfigError(
            f"law {law}: on a ledger without load it ends in {words}; allowed is a volume of 0."
        ) from None
    if volume.shape != (2,) or volume.any():
        raise ConfigError(
            f"law {law}: on a ledger of two triangles without load it returns {volume.tolist()}, allowed is 0 for each."
        )


def _unknown(path: KeyPath, value: str, law: str, schema: dict[str, Any]) -> str:
    if LAWS[law].parameters:
        return unknown_key(path, schema, value, noun=f"parameter of the law {law}")
    return f"{dotted(path)} ({value}) is no known parameter of the law {law}, which has none"


def _given(layer: Layer) -> Mapping[str, Any]:
    return layer.values.get(WEAR, {}).get(PARAMETERS, {})


def _layers_of_law(layers: Sequence[Layer]) -> tuple[str, Sequence[Layer]]:
    """Return the chosen law and the layers from where it is chosen on; parameters in weaker ones are another law's."""
    law, first = "", 0
    for number, layer in enumerate(layers):
        here = layer.values.get(WEAR, {}).get(LAW, law)
        law, first = (law, first) if here == law else (here, number)
    return law, layers[first:]
