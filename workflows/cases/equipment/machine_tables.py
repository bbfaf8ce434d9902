"""What a study's machines are: their parts, motions and feeds, in words and tables of the page.

A run's parameters are those of `parameters.run_parameters`, SI.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from bulkwear.postproc.tables.display import DEGREES, MILLIMETRES
from bulkwear.postproc.wear.laws import LAWS
from bulkwear.workflows.cases.equipment.change_out import BY_MASS, rule_of, rule_words
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.engine.worn_pair import ONLY_TOLD
from bulkwear.workflows.report.sentences import listed, spoken
from bulkwear.workflows.report.text import HARDNESS, hardness_words, law_words, number, range_text

SECONDS_PER_HOUR, TONNES_PER_KG, KG_PER_MT = 3600.0, 1e-3, 1e9
RPM = 60.0 / (2.0 * math.pi)  # per rad/s

Parameters = Mapping[str, Any]


def parts_table(runs: Mapping[str, Parameters]) -> pd.DataFrame:
    """Return a row per part; runs: {setting: parameters of its first run}. Settings with equal parts share rows."""
    rows: dict[str, dict[str, Any]] = {}
    for setting, run in runs.items():
        for part in run["parts"]:
            row = _part_row(part)
            rows.setdefault(repr(row), {"setting": [], **row})["setting"].append(setting)
    found = [{**row, "setting": ", ".join(row["setting"])} for row in rows.values()]
    table = pd.DataFrame(found)
    alike = len(runs) == 1 or set(table["setting"]) == {", ".join(runs)}
    table = table.drop(columns=[key for key in ONLY_TOLD if table[key].isna().all()])
    return table.drop(columns="setting") if alike else table


def _part_row(part: Mapping[str, Any]) -> dict[str, Any]:
    wears = part["wears"]
    return {
        "part": part["name"],
        "role": "wears" if wears else "rigid",
        "file": ": ".join(filter(None, [part["file"], part.get("solid")])),  # which is no word, and told as it is
        "material": part["material"],
        "thickness_mm": part.get("thickness_m", math.nan) * MILLIMETRES,
        "edge_mm": part["edge_m"] * MILLIMETRES,
        "law": _law_words(part) if wears else "",
        "wear_coefficient_per_pa": part["wear_coefficient_per_pa"] if wears else math.nan,
        **{key: part.get(key, math.nan) for key in ONLY_TOLD},
        "coefficient_error_percent": 100.0 * part["wear_coefficient_error"] if wears else math.nan,
        "motion": motion_words(part["motion"]),
    }


def _law_words(part: Mapping[str, Any]) -> str:
    """Return the wear law of a part, with its parameters in SI."""
    given = part["law_parameters"]
    return f"{part['law']} ({number(given, 3)})" if given else part["law"]


def laws_of_parts(runs: Sequence[Parameters]) -> dict[str, str]:
    """Return {law: what a volume is by it} of all parts that wear in some runs, with the coefficients of those parts;
    of several laws each names its parts.
    """
    of_law: dict[str, list[Mapping[str, Any]]] = {}
    for part in (part for run in runs for part in run["parts"] if part["wears"]):
        of_law.setdefault(part["law"], []).append(part)
    return {law: _words_of_law(law, parts, len(of_law) > 1) for law, parts in of_law.items()}


def _words_of_law(law: str, parts: Sequence[Mapping[str, Any]], several: bool) -> str:
    """Return what a volume is by the law of some parts; several: whether other parts have another one."""
    coefficients = [part["wear_coefficient_per_pa"] for part in parts]
    said = [law_words({"law": law, "parameters": _parameter_ranges(law, parts)}, range_text(coefficients, 3))]
    if all(HARDNESS in part for part in parts):
        said.append(hardness_words(parts).strip())
    if min(coefficients) < max(coefficients):
        said.append("Which part has which coefficient stands in the table of parts.")
    if several:
        names = dict.fromkeys(spoken(part["name"]) for part in parts)
        said.append(f"It is the law of the {listed([*names])}.")
    return " ".join(said)


def _parameter_ranges(law: str, parts: Sequence[Mapping[str, Any]]) -> dict[str, str]:
    """Return the values of a law's parameters over some parts, in the units that their names spell."""
    found = {}
    for parameter in LAWS[law].parameters:
        ((name, factor),) = to_si({parameter.name: 1.0}).items()
        found[parameter.name] = range_text([part["law_parameters"][name] / factor for part in parts], 4)
    return found


def motion_words(motion: Mapping[str, Any] | None) -> str:
    """Return how a part moves."""
    if not motion:
        return "at rest"
    kind = motion["kind"]
    about = (
        f"about {_vector(motion['axis'])} through {_vector(motion['point_m'], MILLIMETRES)} mm"
        if "axis" in motion
        else ""
    )
    words = {
        "rotation": lambda: f"turns at {number(motion['speed_rad_per_s'] * RPM, 3)} rpm {about}",
        "turning_surface": lambda: f"its surface turns at {number(motion['speed_rad_per_s'] * RPM, 3)} rpm {about}",
        "translation": lambda: f"moves at {_vector(motion['velocity_m_per_s'])} m/s",
        "belt": lambda: f"its surface runs at {_vector(motion['velocity_m_per_s'])} m/s",
        "oscillation": lambda: (
            f"swings by {_vector(motion['amplitude_m'], MILLIMETRES)} mm in {motion['period_s']:g} s"
        ),
        "angular_oscillation": lambda: (
            f"swings by {number(motion['amplitude_rad'] * DEGREES, 3)} degrees in {motion['period_s']:g} s {about}"
        ),
    }[kind]()
    start, ramp, stop = (motion.get(f"{name}_s") for name in ("start", "ramp", "stop"))
    course = [f"from {start:g} s on" if start else "", f"ramp {ramp:g} s" if ramp else ""]
    course.append(f"until {stop:g} s" if stop is not None else "")
    return ", ".join(filter(None, [words, *course]))


def _vector(values: Sequence[float], factor: float = 1.0) -> str:
    return f"({', '.join(number(factor * value, 4) for value in values)})"


def feed_table(runs: Mapping[str, Parameters]) -> pd.DataFrame:
    """Return a row per setting: bulk material, feed and filling, sizes of the particles as simulated."""
    rows = []
    for setting, run in runs.items():
        particle, inlet, filling = run["particle"], run["inlet"], run["filling"]
        rows.append(
            {
                "setting": setting,
                "feed_t_per_h": inlet["rate_kg_per_s"] * SECONDS_PER_HOUR * TONNES_PER_KG if inlet else math.nan,
                "feed_velocity_m_per_s": math.hypot(*inlet["velocity_m_per_s"]) if inlet else math.nan,
                "filled_percent": 100.0 * filling["fraction"] if filling else math.nan,
                "particle_scale": particle["scale"],
                "smallest_mm": min(particle["diameters_m"]) * MILLIMETRES,
                "median_mm": particle["median_diameter_m"] * MILLIMETRES,
                "largest_mm": max(particle["diameters_m"]) * MILLIMETRES,
                "held_particles": run["derived"]["held_particles"],
            }
        )
    return pd.DataFrame(rows).dropna(axis="columns", how="all")


def change_out_words(run: Parameters) -> list[str]:
    """Return by which rules the parts that wear are changed, a sentence each; of several rules which parts."""
    of_rule: dict[tuple[str, str], list[str]] = {}
    for part in (each for each in run["parts"] if each["wears"]):
        rule = rule_of(run["operation"], part)
        where = "by its mass" if BY_MASS in rule else "at its worst place"
        of_rule.setdefault((where, rule_words(rule)), []).append(part["name"])
    if len(of_rule) == 1:
        return [f"A part is changed {where}: {words}." for where, words in of_rule]
    said = []
    for (where, words), names in of_rule.items():
        each = "The" if len(names) == 1 else "Each of"
        said.append(f"{each} {listed([spoken(name) for name in names])} is changed {where}: {words}.")
    return said


def operation_words(run: Parameters) -> str:
    """Return what operation a run predicts, and when its liners are changed."""
    operation, asked = run["operation"], run["derived"]["operation_s"] / SECONDS_PER_HOUR
    said = change_out_words(run)
    if asked > 0.0:
        fed = operation.get("throughput_kg")
        said.append(f"{asked:,.0f} h of operation are asked for{f', {fed / KG_PER_MT:g} Mt' if fed else ''}.")
    said.append(f"A year has {operation['hours_per_year_s'] / SECONDS_PER_HOUR:,.0f} h of operation.")
    return " ".join(said)
