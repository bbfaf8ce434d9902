"""When a part is changed: by its own rule, or by that of the operation where it has none. SI."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.postproc.wear.service_life import allowed_depth

REMAINING, FRACTION = "change_out_remaining_m", "change_out_remaining_fraction"
BY_MASS = "change_out_worn_mass_fraction"
RULES = (REMAINING, FRACTION, BY_MASS)  # keys of the operation and of parts
Rule = Mapping[str, float]


def given_rule(section: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the operation, or a part, says on change-out itself; nothing where it is silent."""
    return {name: section[name] for name in RULES if section.get(name) is not None}


def rule_of(operation: Mapping[str, Any], part: Mapping[str, Any]) -> dict[str, Any]:
    """Return the rule by which a part is changed; empty where it is worn through until then."""
    return given_rule(part) or given_rule(operation)


def settings_key(name: str) -> str:
    """Return one of RULES as studies write it, in mm."""
    return f"{name.removesuffix('_m')}_mm" if name.endswith("_m") else name


def asked_by(name: str, part: Mapping[str, Any]) -> str:
    """Return the section of a study in which the rule of a part stands; name: of the part."""
    return f"parts.{name}" if given_rule(part) else "operation"


def remaining_m(rule: Rule, thickness_m: float | None) -> float:
    """Return the thickness (m) at which a part is changed; NaN by its mass, or of an unknown thickness."""
    due = [rule[REMAINING]] if REMAINING in rule else []
    if FRACTION in rule and thickness_m is not None:
        due.append(rule[FRACTION] * thickness_m)
    return max(due, default=np.nan)


def allowed_depths(thickness: np.ndarray, rule: Rule) -> np.ndarray:
    """Return the depth (p,) m that places may lose by a rule, their thickness (p,) m without one; NaN where the
    thickness is not known or no more than what shall remain.
    """
    return allowed_depth(thickness, rule.get(REMAINING, 0.0), rule.get(FRACTION, 0.0))


def rule_words(rule: Rule) -> str:
    """Return a rule as a phrase: 10 mm left."""
    if rule.get(REMAINING, 0.0) > 0.0:
        return f"{rule[REMAINING] * MILLIMETRES:g} mm left"
    if rule.get(FRACTION, 0.0) > 0.0:
        return f"{100.0 * rule[FRACTION]:g} % of the thickness left"
    if BY_MASS in rule:
        return f"{100.0 * rule[BY_MASS]:g} % of the mass worn"
    return "worn through"
