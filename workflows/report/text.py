"""Words of a study's page that depend on its settings: names and units, what is simplified, decks."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from bulkwear.postproc.tables.summary import THROUGH
from bulkwear.postproc.wear.laws import LAWS, NEUTRAL_LAW

if TYPE_CHECKING:
    import pandas as pd

NO_UNIT = "-"
HARDNESS = "wall_hardness_pa"  # of what wears, where it is known
ROUND_OFF_PERCENT = 1e-9  # %, of a run's worn volume: less is round-off of what was taken off step by step
WITH_EXPONENT = 1e6  # from which numbers are told with one
UNDEFINED = "\u2013"  # shown for numbers that are not there
# suffix of a key -> unit; the longest that fits counts, so they stand in that order
UNITS = (
    ("_per_pa", "1/Pa"),
    ("_mm3_per_m", "mm³/m"),
    ("_mm3", "mm³"),
    ("_cm3", "cm³"),
    ("_mm2", "mm²"),
    ("_N", "N"),
    ("_kg_per_m3", "kg/m³"),
    ("_j_per_m3", "J/m³"),
    ("_n_per_m", "N/m"),
    ("_pa_s", "Pa s"),
    ("_m_per_s", "m/s"),
    ("_t_per_h", "t/h"),
    ("_rpm", "rpm"),
    ("_mt", "Mt"),
    ("_fraction", NO_UNIT),
    ("_steps", "steps"),
    ("_percent", "%"),
    ("_deg", "°"),
    ("_mm", "mm"),
    ("_um", "µm"),
    ("_deg_per_s", "°/s"),
    ("_n", "N"),
    ("_us", "µs"),
    ("_pa", "Pa"),
    ("_s", "s"),
    ("_h", "h"),
)
NAMED_ELSEWHERE = f" Where figures and columns name {NEUTRAL_LAW.capitalize()}'s volume, it is this law's."
OF_ITS_OWN = (
    " Its coefficient is another quantity than Archard's: volumes and hours hold where it is of a test by this law."
)
SPOKEN = {"_fraction", "_steps"}  # suffixes that belong to the name as well
EXTRA_UNITS = {
    "particle_scale": NO_UNIT,
    "wear_coefficient_k": NO_UNIT,
    "acceleration": NO_UNIT,
    "cycles": NO_UNIT,
    "ranks": NO_UNIT,
    "revolutions": NO_UNIT,
    "cycles_per_revolution": NO_UNIT,
    "wear_cycles": NO_UNIT,
    "layers": NO_UNIT,
    "equivalent_size_ratio": NO_UNIT,
}


def number(value: Any, digits: int = 4) -> str:
    """Return a number as people read it: few digits, no exponent between 0.001 and 1e6; a name as words."""
    if isinstance(value, str):
        return value.replace("_", " ") if value.isidentifier() else value
    if isinstance(value, list):
        return ", ".join(number(item, digits) for item in value)
    if isinstance(value, Mapping):
        return ", ".join(f"{number(name)} {number(item, digits)}" for name, item in value.items())
    if value is None or not math.isfinite(value):
        return UNDEFINED
    if isinstance(value, bool):
        return "yes" if value else "no"
    if value == int(value) and (isinstance(value, int) or abs(value) < 1e7):
        return _grouped(value)
    rounded = float(f"{value:.{digits}g}")
    if 10.0**digits <= abs(rounded) < WITH_EXPONENT:
        return _grouped(rounded)
    return f"{value:.{digits}g}" if 1e-3 <= abs(value) < WITH_EXPONENT else f"{value:.{digits - 1}e}"


def _grouped(value: float) -> str:
    return f"{int(value):,}".replace(",", "\u202f")


def data_uri(content: bytes, kind: str) -> str:
    """Return content as an address that needs no network."""
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"


def name_and_unit(key: str) -> tuple[str, str]:
    """Return what a setting is called and its unit, from the suffix of its key."""
    for suffix, unit in UNITS:
        if key.endswith(suffix):
            stem = key if suffix in SPOKEN else key.removesuffix(suffix)
            return stem.replace("_", " "), unit
    return key.replace("_", " "), EXTRA_UNITS.get(key, "")


def number_and_unit(key: str, value: float) -> str:
    """Return a setting as people say it: name, value, unit."""
    name, unit = name_and_unit(key)
    return f"{name} {number(value)} {unit}".rstrip(f" {NO_UNIT}")


def setting_rows(settings: Mapping[str, Any], paper: Mapping[str, Any]) -> dict[str, list[dict[str, Any]]]:
    """Return all settings by section, blocks within it included: name, value, unit, and the value at paper fidelity,
    None where it is the same.
    """
    sections: dict[str, list[dict[str, Any]]] = {}
    for key, value in settings.items():
        nested = isinstance(value, Mapping)
        full = _flat(paper.get(key, {})) if nested else paper
        for inner, found in (_flat(value) if nested else {key: value}).items():
            name, unit = name_and_unit(inner)
            other = full.get(inner)
            same = other == found or inner == "fidelity"
            row = {"name": name, "value": found, "unit": unit, "paper": None if same else other}
            sections.setdefault(key if nested else "study", []).append(row)
    return sections


def _flat(section: Mapping[str, Any]) -> dict[str, Any]:
    """Return a section with the keys of its blocks among its own; blocks of equal keys give them their names."""
    blocks = {key: value for key, value in section.items() if isinstance(value, Mapping)}
    keys = [inner for block in blocks.values() for inner in block] + [key for key in section if key not in blocks]
    named = len(set(keys)) < len(keys)
    found: dict[str, Any] = {}
    for key, value in section.items():
        inner = {f"{key}_{name}" if named else name: each for name, each in blocks.get(key, {}).items()}
        found |= inner if key in blocks else {key: value}
    return found


def simplifications(study: Mapping[str, Any], summary: pd.DataFrame, page: ModuleType) -> list[tuple[str, str]]:
    """Return (what, how) of everything that is simpler here than on a machine, with the numbers of this
    study. page: the words of its case, which may tell laws of its own; nothing is said about wear where nothing wears.
    """
    settings = study["settings"]
    reduced = "; ".join(study["remarks"]) or "nothing: all sizes and the travel are those of the paper fidelity"
    if not study["wears"]:
        return [("Reduced scale", f"{reduced}."), *page.simplifications(study)]
    laws = getattr(page, "laws_told", _law_of_study)(study)
    return [
        ("Reduced scale", f"{reduced}."),
        *_wear_simplifications(study, summary, " ".join(laws.values()), page.further_cap(settings)),
        *page.simplifications(study),
        *_comparison(laws),
    ]


def _law_of_study(study: Mapping[str, Any]) -> dict[str, str]:
    """Return {law: what a volume is by it} of a study of one law."""
    wear, sections = study["settings"]["wear"], [run["wear"] for run in study["parameters"].values()]
    coefficient = range_text([each["wear_coefficient_per_pa"] for each in sections], 3)
    return {wear["law"]: f"{law_words(wear, coefficient)}{hardness_words([e for e in sections if HARDNESS in e])}"}


def _comparison(laws: Iterable[str]) -> list[tuple[str, str]]:
    """Return what the solver's own wear measure is; nothing where something wears by that law itself."""
    if any(LAWS[law].is_solver_measure for law in laws):
        return []
    how = (
        "The solver's own wear model is Finnie's impact wear with the velocity of the particle's centre, without "
        "spin; it tends to zero for pure sliding. It stands beside the study's law for comparison and wears nothing."
    )
    return [("LIGGGHTS' Finnie differs", how)]


def _wear_simplifications(
    study: Mapping[str, Any], summary: pd.DataFrame, laws: str, further_cap: str
) -> list[tuple[str, str]]:
    """Return what concerns wear: laws, acceleration, rigid sample or caps and what they hold back; nothing of caps
    where no shape was worn.
    """
    wear, law = study["settings"]["wear"], ("Wear law", laws)
    factor = wear["acceleration"]
    accelerated = (
        f"The coefficient is multiplied by {factor:g}: one second of simulation stands for {factor:g} s of test. "
        "Volumes are accelerated unless a column says otherwise."
    )
    acceleration = ("Wear acceleration", "None." if factor == 1.0 else accelerated)
    if not wear["deform"]:
        rigid = ("Rigid sample", "The surface keeps its shape: depths are worn volume over area, not applied.")
        return [law, acceleration, rigid]
    carried = 100.0 * largest_carried_share(summary)
    if math.isnan(carried):
        return [law, acceleration]
    left = f"up to {carried:.3g} % of a run's worn volume is not yet applied to the shape"
    caps = (
        "Capped steps",
        f"In one wear cycle a node moves at most {wear['largest_step_edge_fraction']:g} of its shortest edge, and at "
        f"most {further_cap}. The rest is carried into later cycles: at the end "
        f"{left if carried > ROUND_OFF_PERCENT else 'nothing is left'}.",
    )
    return [law, acceleration, caps, *worn_through_words(wear, summary)]


def largest_carried_share(summary: pd.DataFrame) -> float:
    """Return the largest share (-) of a run's worn volume that caps hold back at its end, of those whose shape wears:
    rows of a design may keep it, column `deform`. NaN without such runs.
    """
    wears = summary["worn_volume_m3"] > 0.0
    if "deform" in summary:
        wears &= summary["deform"].astype("boolean").fillna(True)
    return float((summary["carried_volume_m3"] / summary["worn_volume_m3"])[wears].max())


def worn_through_words(wear: Mapping[str, Any], summary: pd.DataFrame) -> list[tuple[str, str]]:
    """Return which runs are worn through, nothing where the thickness is not known."""
    if "local_thickness_mm" not in wear:
        return []
    through = summary[summary[THROUGH] > 0]
    how = {"stop": "The run ends then.", "cap": "The surface stops there.", "go_on": "The run goes on."}
    rows = zip(through["run"], through[THROUGH], through["time_s"], strict=True)
    runs = [f"{run} ({nodes} node{'s' * (nodes > 1)} by {time:.3g} s)" for run, nodes, time in rows]
    found = f"Worn through: {', '.join(runs)}." if runs else "No run is worn through."
    meaning = f"A place is worn through when {wear['local_thickness_mm']:g} mm of thickness are removed."
    return [("Worn through", f"{meaning} {how[wear.get('worn_through', 'stop')]} {found}")]


def law_words(wear: Mapping[str, Any], coefficient: str) -> str:
    """Return what a volume is by the law of a study.

    wear: its settings; coefficient: the wear coefficient as the sentence shows it
    """
    given = {key: number(value) for key, value in wear.get("parameters", {}).items()}
    words = LAWS[wear["law"]].words.format(wear_coefficient_per_pa=coefficient, **given)
    own = "" if LAWS[wear["law"]].comparable else OF_ITS_OWN
    named = "" if wear["law"] == NEUTRAL_LAW else NAMED_ELSEWHERE
    return f"{wear['law'].replace('_', ' ').capitalize()}: {words}{own}{named}"


def hardness_words(scaled: Sequence[Mapping[str, float]]) -> str:
    """Return what a coefficient is over the hardness of the wall, nothing where no hardness is known.

    scaled: sections `wear` of the runs whose hardness is known
    """
    if not scaled:
        return ""
    k, hardness = (range_text([wear[key] for wear in scaled], 3) for key in ("wear_coefficient_k", "wall_hardness_pa"))
    return f" That is k over the Vickers hardness of the wall: k {k}, hardness {hardness} Pa."


def range_text(values: list[float], digits: int = 2) -> str:
    """Return a number, or the lowest and highest where they differ; few digits, without an exponent up to 1e6."""
    found = [float(f"{value:.{digits}g}") for value in (min(values), max(values))]
    shown_whole = [10.0**digits <= abs(value) < WITH_EXPONENT for value in found]
    low, high = (
        number(value) if whole else f"{value:.{digits}g}" for value, whole in zip(found, shown_whole, strict=True)
    )
    return low if low == high else f"{low} to {high}"


def decks_of(study: Mapping[str, Any], folder: Path, places: Iterable[tuple[str, str]]) -> list[dict[str, str]]:
    """Return the decks of the first run as the solver read them.

    places: title and path below `folder` of each, in which {run} and {bed} stand for that run and its bed
    """
    run = next(iter(study["runs"]))
    paths = [(title, place.format(run=run, bed=study["bed_of"][run])) for title, place in places]
    return [
        {"title": title, "path": path, "text": (folder / path).read_text(encoding="utf-8")}
        for title, path in paths
        if (folder / path).is_file()
    ]
