"""Checks of the ranges in which a calibration looks for parameters, and of their values, before any solver starts."""

from __future__ import annotations

from typing import Any

from bulkwear.workflows.cases.calibration.checks import TABLE_CHECKS
from bulkwear.workflows.config.run_checks import Check, CheckedRun, Fault
from bulkwear.workflows.config.schema import load_schema, validator
from bulkwear.workflows.config.validation import allowed_text

NO_MODEL = "none"  # value of solver.rolling_friction


def _contact_schema(parameter: str) -> dict[str, Any]:
    """Return the schema of a parameter that is looked for, that of the contact in the file of materials."""
    return load_schema("materials")["$defs"]["contact"]["properties"][parameter.rpartition(".")[2]]


def may_be(value: Any, parameter: str) -> bool:
    """Return whether a parameter of a contact may have that value."""
    return validator()(_contact_schema(parameter)).is_valid(value)


def allowed_value(parameter: str) -> str:
    """Return in words which values that are."""
    return allowed_text(_contact_schema(parameter))


def ranges_in_order(run: CheckedRun) -> Fault | None:
    """A parameter's low is below its high, and each parameter stands once."""
    seen: set[str] = set()
    for each in run.settings["calibration"]["parameters"]:
        name, low, high = each["name"], each["low"], each["high"]
        if low >= high:
            allowed = f"a low below the high of every parameter; {name} has low {low:g} and high {high:g}"
            return "calibration.parameters", allowed
        if name in seen:
            return "calibration.parameters", f"each parameter once; {name} stands there twice"
        seen.add(name)
    return None


def ranges_are_of_contacts(run: CheckedRun) -> Fault | None:
    """A range holds values alone that a contact may have in the file of materials, which are those of the solver."""
    for each in run.settings["calibration"]["parameters"]:
        for end in ("low", "high"):
            if not may_be(each[end], each["name"]):
                allowed = f"{each['name']} {allowed_value(each['name'])}"
                return "calibration.parameters", f"{allowed}; its {end} is {each[end]:g}"
    return None


def rolling_has_a_model(run: CheckedRun) -> Fault | None:
    """Rolling friction is looked for under a model of it: under none, every value has the same responses."""
    sought = [each["name"] for each in run.settings["calibration"]["parameters"]]
    rolling = next((name for name in sought if name.endswith(".rolling_friction")), None)
    if rolling is None or run.parameters["solver"]["rolling_friction"] != NO_MODEL:
        return None
    return "solver.rolling_friction", f"a model, where calibration.parameters has {rolling}"


RANGE_CHECKS: tuple[Check, ...] = (ranges_in_order, ranges_are_of_contacts, rolling_has_a_model, *TABLE_CHECKS)
