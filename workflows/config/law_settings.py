"""Parameters of wear laws in the configuration: `wear.parameters` holds what the chosen law of postproc/wear/laws.py
declares, and nothing else.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bulkwear.postproc.wear.coefficient import PER_PA
from bulkwear.postproc.wear.kernel_sums import law_kernels
from bulkwear.postproc.wear.kernels import kernel_column
from bulkwear.postproc.wear.laws import LAWS, worn_volume
from bulkwear.postproc.wear.ledger import LEDGER_FIELDS, MEAN_FIELDS
from bulkwear.workflows.config.layers import ConfigError, KeyPath, Layer, dotted
from bulkwear.workflows.config.schema import without_required
from bulkwear.workflows.config.validation import UNIT_OF_SUFFIX, allowed_text, check_layer, locate, show, unknown_key
from bulkwear.workflows.engine.project import current_project

WEAR, LAW, PARAMETERS = "wear", "law", "parameters"
PROPORTIONAL = 1e-9  # relative; rounding of a law's function, far below any power but 1


def parameters_schema(law: str) -> dict[str, Any]:
    """Return the schema of `wear.parameters` with a law; required are those without a default.

    Raises ConfigError for a parameter whose unit is not the one that its name ends in.
    """
    properties = {}
    for parameter in LAWS[law].parameters:
        suffix = max((s for s in UNIT_OF_SUFFIX if parameter.name.endswith(f"_{s}")), key=len, default="")
        unit = UNIT_OF_SUFFIX.get(suffix, "-")
        if parameter.unit != unit:
            where = ": ".join(filter(None, [current_project().law_file(law), f"law {law}"]))
            raise ConfigError(
                f"{where}: the unit of its parameter {parameter.name} is {parameter.unit!r}, allowed is {unit!r}, by "
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


def check_volume(law: str, parameters: Mapping[str, float], file: str) -> None:
    """Raise ConfigError where a law's function fails, or does not return what it should, on a ledger of two triangles
    of which one has no load, the other 1 in every column: 0 of the first, and of the other a volume that is not
    negative, twice as much after twice the load, and by twice the coefficient.

    parameters: of the law, SI, the coefficient included; file: that the law stands in
    """
    try:
        kernels = law_kernels(law, parameters)
    except KeyError as fault:
        raise ConfigError(
            f"{file}: a contact kernel of the law {law} takes {fault.args[0]}, allowed are the law's parameters, in SI:"
            f" {', '.join(sorted(parameters))}."
        ) from None
    names = (*LEDGER_FIELDS, *map(kernel_column, kernels))
    once = {name: np.array([0.0, 1.0]) for name in names}
    twice = {name: column if name in MEAN_FIELDS else 2.0 * column for name, column in once.items()}
    double = {**parameters, PER_PA: 2.0 * parameters[PER_PA]}
    try:
        volumes = [
            np.asarray(worn_volume(law, *given), float)
            for given in ((once, parameters), (twice, parameters), (once, double))
        ]
    except Exception as fault:  # a law of a project's own may fail in any way
        words = str(fault).removesuffix(".")
        raise ConfigError(
            f"{file}: the law {law} ends in {type(fault).__name__}: {words}; allowed are columns of the ledger and the"
            " law's parameters, in SI."
        ) from None
    volume, after_twice, by_twice = volumes
    if volume.shape != (2,) or volume[0] != 0.0 or not 0.0 <= volume[1] < np.inf:
        raise ConfigError(
            f"{file}: of two triangles, the first without load, the law {law} returns {volume.tolist()} m3, allowed are"
            " two volumes, 0 for the first and no negative one."
        )
    kernel = "; a law that is not linear brings a contact kernel"
    for found, more, advice in ((after_twice, "twice the load", kernel), (by_twice, "twice the coefficient", "")):
        if not np.allclose(found, 2.0 * volume, rtol=PROPORTIONAL, atol=0.0):
            raise ConfigError(
                f"{file}: by {more} the law {law} makes {found[1]:.4g} of {volume[1]:.4g} m3, allowed is twice as"
                f" much{advice}."
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
