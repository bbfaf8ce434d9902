"""Checks of one run that compare several settings, before any solver starts.

Each check returns None, or (key at fault, what is allowed). To add one: a function, listed in the checks of its case;
those of every case and those of a sliding sample are here.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce
from typing import TYPE_CHECKING, Any

from bulkwear.meshes.lattice import narrowest_gap, pattern_faults
from bulkwear.workflows.config.layers import ConfigError, Layer
from bulkwear.workflows.config.patterns import pattern_of
from bulkwear.workflows.config.validation import allowed_text, files_of, locate, show

if TYPE_CHECKING:
    from bulkwear.workflows.engine.case import Case, Run

Fault = tuple[str, str]  # key at fault (empty: the row as a whole) and what is allowed

MOST_STEPS = 2**31 - 1  # of a run of LIGGGHTS, a small integer of its
LEAST_GAP = 0.18  # between shapes, in elements: a triangle across it has the angle that a mesh promises, tan 10 degrees
# Names that pandas reads as no value, and those that it reads as a truth value or a number, in any case of letters: a
# table of rows 007 and 12 would name them 7 and 12, and look for rows of that name.
NO_VALUES = (
    *("#N/A", "#N/A N/A", "#NA", "-1.#IND", "-1.#QNAN", "-NaN", "-nan", "1.#IND", "1.#QNAN", "<NA>", "N/A", "NA"),
    *("NULL", "NaN", "None", "n/a", "nan", "null"),
)
OTHER_VALUES = ("true", "false", "inf", "infinity")
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", re.ASCII | re.IGNORECASE)
SHOWN_DIGITS = 6  # of a length in a sentence
SHOWN = 5e-6  # relative: lengths are shown to six digits, and the one that a sentence names is enough
SAMPLE_ELEMENTS = 4  # elements along the shorter side of a sample; fewer give no map


@dataclass(frozen=True)
class CheckedRun:
    """A run to be checked: settings with the layers they come from, design row, parameters in SI.

    columns: {setting: column} of the settings that the row overrides
    """

    layers: tuple[Layer, ...]
    settings: dict[str, Any]
    row: Layer
    parameters: dict[str, Any]
    columns: Mapping[str, str] = field(default_factory=dict)


Check = Callable[[CheckedRun], Fault | None]


def check_run(run: CheckedRun, checks: tuple[Check, ...]) -> None:
    """Raise ConfigError for the first fault of a run: file, line, key, value, row, allowed."""
    for check in checks:
        fault = check(run)
        if fault is not None:
            key, allowed = run.columns.get(fault[0], fault[0]), fault[1]
            if not key:
                raise ConfigError(f"{run.row.where()}: {allowed}.")
            raise ConfigError(f"{_where(run, key)} is {_found(run, key)}{_for_row(run, key)}, allowed is {allowed}.")


def check_files(study: str, case: Case, runs: Sequence[Run]) -> None:
    """Look into the files that the runs of a study name. Raises ConfigError with the study and the row."""
    for run in runs:
        try:
            case.check_files([run])
        except ConfigError as fault:
            raise ConfigError(f"study {study}, row {run.row}: {fault}") from None


def check_needed(
    layers: tuple[Layer, ...], settings: dict[str, Any], schema: dict[str, Any], block: str, keys: list[str]
) -> None:
    """Raise ConfigError if a block of a run's settings lacks one of the keys that its surface needs."""
    for key in (key for key in keys if key not in settings[block]):
        allowed = allowed_text(schema["properties"][block]["properties"][key])
        where = locate(layers, (block,))
        raise ConfigError(f"{where}: {block}.{key} is missing, allowed is {allowed}, which its surface needs.")


def _where(run: CheckedRun, key: str) -> str:
    """Return where a key stands, or where the block stands in which it is missing: the strongest layer that has it."""
    path = tuple(key.split("."))
    if not _is_setting(run, key):
        return f"{run.row.where()}: {key}"
    while path and not any(layer.holds(path) for layer in run.layers):
        path = path[:-1]
    return f"{locate(run.layers if path else files_of(run.layers), path)}: {key}"


def _found(run: CheckedRun, key: str) -> str:
    """Return what a key is, as a message shows it; `missing` where nobody gives it."""
    if not _is_setting(run, key):
        return show(run.row.values[key])
    try:
        return show(reduce(operator.getitem, key.split("."), run.settings))
    except KeyError:
        return "missing"


def _for_row(run: CheckedRun, key: str) -> str:
    return f" for row {run.row.values['row']}" if _is_setting(run, key) else ""


def _is_setting(run: CheckedRun, key: str) -> bool:
    """Return whether a key is one of the settings; else it is a column of the row."""
    return key not in run.row.values


def is_stronger(run: CheckedRun, key: str, other: str) -> bool:
    """Return whether a setting stands in a stronger layer than another one, as on the command line: it is at fault."""
    return _strength(run, key) > _strength(run, other)


def _strength(run: CheckedRun, key: str) -> int:
    """Return the number of the layer that a setting stands in, of the row's own the highest."""
    if key in run.columns:
        return len(run.layers)
    path = tuple(key.split("."))
    return max((number for number, layer in enumerate(run.layers) if layer.holds(path)), default=-1)


def millimetres(metres: float) -> str:
    return f"{metres * 1000.0:.6g} mm"


def shown_inside(length: float, sign: int) -> str:
    """Return a length (m) as a sentence names it, rounded down (sign -1) or up (1), so that it is within its bound."""
    if not length:
        return millimetres(length)
    digit = 10.0 ** (math.floor(math.log10(abs(length))) - SHOWN_DIGITS + 1)
    return millimetres(digit * (math.floor, math.ceil)[sign > 0](length / digit))


def reaches(length: float, least: float) -> bool:
    """Return whether a length (m) is at least another one, as `millimetres` shows that."""
    return length >= least - SHOWN * abs(least)


def element_resolves_pattern(run: CheckedRun) -> Fault | None:
    """The feet of a pattern are at least two elements across their narrow side, and not too close for them.

    Height and depth set no limit: a low bump is a gentle slope, which large elements follow.
    """
    pattern, sample = pattern_of(run.parameters["pattern"]), run.parameters["sample"]
    if pattern is None:
        return None
    radius, element = min(pattern.half_width, pattern.half_length), sample["element_size_m"]
    if element > radius:
        return "sample.element_size_mm", f"at most {millimetres(radius)}, the smaller radius of a {pattern.noun}"
    gap = narrowest_gap(pattern, sample["width_m"], sample["length_m"])
    if element * LEAST_GAP <= gap:
        return None
    allowed = f"at most {millimetres(gap / LEAST_GAP)} where {pattern.noun}s are {millimetres(gap)} apart"
    return "sample.element_size_mm", allowed


def element_resolves_sample(run: CheckedRun) -> Fault | None:
    """A sample's shorter side is several elements long."""
    sample = run.parameters["sample"]
    largest = min(sample["width_m"], sample["length_m"]) / SAMPLE_ELEMENTS
    if sample["element_size_m"] <= largest:
        return None
    return (
        "sample.element_size_mm",
        f"at most {millimetres(largest)}, a quarter of the sample's shorter side",
    )


def patch_too_wide(run: CheckedRun, most: float, reason: str) -> Fault | None:
    """Return the fault of a patch whose radius is given and above a length (m)."""
    if reaches(most, run.parameters["wear"].get("patch_radius_m", 0.0)):
        return None
    return "wear.patch_radius_mm", f"at most {shown_inside(most, -1)}, {reason}"


def patch_within_sample(run: CheckedRun) -> Fault | None:
    """A patch whose radius is given is no wider than the sample's shorter side."""
    shorter = min(run.parameters["sample"][side] for side in ("width_m", "length_m"))
    reason = "half of the sample's shorter side: a wider patch spreads the wear of each contact over all of the sample"
    return patch_too_wide(run, 0.5 * shorter, reason)


def deeper_than(run: CheckedRun, length: str) -> Fault | None:
    """Return the fault of a pattern at least as deep as a length of the sample."""
    pattern, room = pattern_of(run.parameters["pattern"]), run.parameters["sample"][f"{length}_m"]
    if pattern is None or pattern.deepest_point < room:
        return None
    return f"sample.{length}_mm", f"above {millimetres(pattern.deepest_point)}, the depth of a {pattern.noun}"


def physical_modulus_known(run: CheckedRun) -> Fault | None:
    """A patch of the true contact needs the particle's true modulus."""
    wear = run.parameters["wear"]
    if wear["patch"] != "physical" or wear["physical_shear_modulus_pa"] is not None:
        return None
    return (
        "wear.patch",
        f"none, simulated or radius, because {run.parameters['particle']['name']} has no physical_shear_modulus_pa",
    )


def pattern_fits(run: CheckedRun) -> Fault | None:
    """The shapes of a pattern neither overlap nor leave the sample (bulkwear.meshes.lattice decides)."""
    pattern, sample = pattern_of(run.parameters["pattern"]), run.parameters["sample"]
    if pattern is None:
        return None
    fault = pattern_faults(pattern, sample["width_m"], sample["length_m"])
    return None if fault is None else ("", fault)


def names_stay_names(run: CheckedRun) -> Fault | None:
    """No row or part has a name that tables are read with as no value, as a truth value or as a number."""
    named = {"row": run.row.values["row"]} | {f"parts.{name}": name for name in run.settings.get("parts", {})}
    for key, name in named.items():
        if name in NO_VALUES or name.casefold() in OTHER_VALUES or NUMBER.fullmatch(name):
            taken = "no value" if name in NO_VALUES else "a truth value or a number"
            return key, f"another name: in a table '{name}' is taken for {taken}"
    return None


def thickness_known(run: CheckedRun) -> Fault | None:
    """What happens where a part is worn through can only be said where its thickness is known: given, or of parts, each
    of which has its own.
    """
    wear = run.parameters.get("wear", {})
    if "worn_through" not in wear or "local_thickness_m" in wear or "parts" in run.parameters:
        return None
    return "wear.worn_through", "a study that gives wear.local_thickness_mm as well, or neither"


def steps_countable(run: CheckedRun) -> Fault | None:
    """The time steps of a run are no more than the solver can be told to make."""
    steps = run.parameters.get("derived", {}).get("travel_steps", 0)
    if steps <= MOST_STEPS:
        return None
    return "", f"{steps:.4g} time steps, allowed are at most {MOST_STEPS}, which the solver counts"


COMMON_CHECKS: tuple[Check, ...] = (names_stay_names, thickness_known)
LAST_CHECKS: tuple[Check, ...] = (steps_countable,)  # after those of the case, which say more of what they know
