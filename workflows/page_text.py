"""Words of a study's page that depend on its settings: names and units, what is simplified, decks."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from workflows.derived import PERIODIC

NO_UNIT = "-"
# suffix of a key -> unit; the longest that fits counts, so they stand in that order
UNITS = (
    ("_per_pa", "1/Pa"),
    ("_kg_per_m3", "kg/m³"),
    ("_m_per_s", "m/s"),
    ("_fraction", NO_UNIT),
    ("_steps", "steps"),
    ("_percent", "%"),
    ("_deg", "°"),
    ("_mm", "mm"),
    ("_um", "µm"),
    ("_us", "µs"),
    ("_pa", "Pa"),
    ("_s", "s"),
    ("_h", "h"),
)
LAW_WORDS = {
    "archard": "volume = coefficient times normal force times sliding path, coefficient {} 1/Pa, the same for all "
    "particles and places. Rolling and impact are recorded but take no volume.",
    "finnie": "volume = coefficient times a function of the impact angle times force and velocity of the particle's "
    "centre, coefficient {} 1/Pa, the same for all particles and places. Where figures and columns name Archard's "
    "volume, it is this law's.",
}  # what a law takes, the coefficient left open
SPOKEN = {"_fraction", "_steps"}  # suffixes that belong to the name as well
EXTRA_UNITS = {
    "particle_scale": NO_UNIT,
    "acceleration": NO_UNIT,
    "cycles": NO_UNIT,
    "ranks": NO_UNIT,
    "layers": NO_UNIT,
    "equivalent_size_ratio": NO_UNIT,
}


def name_and_unit(key: str) -> tuple[str, str]:
    """Return what a setting is called and its unit, from the suffix of its key."""
    for suffix, unit in UNITS:
        if key.endswith(suffix):
            stem = key if suffix in SPOKEN else key.removesuffix(suffix)
            return stem.replace("_", " "), unit
    return key.replace("_", " "), EXTRA_UNITS.get(key, "")


def setting_rows(settings: Mapping[str, Any], paper: Mapping[str, Any]) -> dict[str, list[dict[str, Any]]]:
    """Return all settings by section: name, value, unit, and the value at paper fidelity, None where it is
    the same.
    """
    sections: dict[str, list[dict[str, Any]]] = {}
    for key, value in settings.items():
        nested = isinstance(value, Mapping)
        full = paper.get(key, {}) if nested else paper
        for inner, found in (value if nested else {key: value}).items():
            name, unit = name_and_unit(inner)
            other = full.get(inner)
            same = other == found or inner == "fidelity"
            row = {"name": name, "value": found, "unit": unit, "paper": None if same else other}
            sections.setdefault(key if nested else "study", []).append(row)
    return sections


def simplifications(study: Mapping[str, Any], summary: pd.DataFrame) -> list[tuple[str, str]]:
    """Return (what, how) of everything that is simpler here than on a machine, with the numbers of this
    study.
    """
    settings = study["settings"]
    reduced = "; ".join(study["remarks"]) or "nothing: all sizes and the travel are those of the paper fidelity"
    return [
        ("Reduced scale", f"{reduced}."),
        *_wear_simplifications(settings, summary),
        ("Particles", _particles(study)),
        *_sampling(study),
        (
            "Skirt not counted",
            f"A ramp of {settings['sample']['skirt_slope_deg']:g}° leads from the floor on to the sample. It is not "
            "worn and its wear is not counted, but it carries part of the bed: forces include it, wear does not.",
        ),
        (
            "One packing",
            f"Each bed is one random packing (seed {settings['bed']['seed']}), periodic across the travel"
            f"{' and along it, so that it passes the sample again and again' * (settings['bed']['ends'] == PERIODIC)}. "
            "Runs of equal bed share it. Ranges in the tables are over the cycles of one run, not over repetitions.",
        ),
        *_comparison(settings["wear"]["law"]),
    ]


def _comparison(law: str) -> list[tuple[str, str]]:
    """Return what the solver's own wear measure is; nothing where the study wears by that law itself."""
    if law == "finnie":
        return []
    how = (
        "The solver's own wear model is Finnie's impact wear with the velocity of the particle's centre, without "
        "spin; it tends to zero for pure sliding. It stands beside Archard's law for comparison and wears nothing."
    )
    return [("LIGGGHTS' Finnie differs", how)]


def _wear_simplifications(settings: Mapping[str, Any], summary: pd.DataFrame) -> list[tuple[str, str]]:
    """Return what concerns wear: law, acceleration, rigid sample or caps and what they hold back."""
    wear = settings["wear"]
    law = (
        "Wear law",
        f"{wear['law'].capitalize()}: " + LAW_WORDS[wear["law"]].format(f"{wear['wear_coefficient_per_pa']:.3g}"),
    )
    factor = wear["acceleration"]
    accelerated = (
        f"The coefficient is multiplied by {factor:g}: one second of simulation stands for {factor:g} s of test. "
        "Volumes are accelerated unless a column says otherwise."
    )
    acceleration = ("Wear acceleration", "None." if factor == 1.0 else accelerated)
    if not wear["deform"]:
        rigid = ("Rigid sample", "The sample keeps its shape: depths are worn volume over area, not applied.")
        return [law, acceleration, rigid]
    carried = 100.0 * (summary["carried_volume_m3"] / summary["archard_volume_m3"]).max()
    caps = (
        "Capped steps",
        f"In one of {settings['sliding']['cycles']} cycles a node moves at most {wear['largest_step_edge_fraction']:g} "
        "of its shortest edge, and at most as far as particles fall in "
        f"{wear['gap_closing_fraction']:g} of the cycle's duration. The rest is carried into later cycles: at the end "
        f"up to {carried:.3g} % of a run's worn volume is not yet applied to the shape.",
    )
    return [law, acceleration, caps]


def _sampling(study: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return what sampled contacts leave out; nothing where the solver sums every step."""
    settings = study["settings"]
    if settings["ledger"] == "solver":
        return []
    how = (
        f"Loads are summed from contacts sampled every {settings['solver']['sampling_interval_steps']} steps "
        f"({_sampled_travel(study)} mm of travel), not from every step."
    )
    return [("Sampled contacts", how)]


def _particles(study: Mapping[str, Any]) -> str:
    """Return what the particles are made simpler in; ranges where the runs differ."""
    particles = [run["particle"] for run in study["parameters"].values()]
    diameters = [1e3 * diameter for particle in particles for diameter in particle["diameters_m"]]
    scale = _range([particle["scale"] for particle in particles])
    moduli = _range([particle["shear_modulus_pa"] for particle in particles])
    return (
        f"Spheres of {min(diameters):.3g} to {max(diameters):.3g} mm in diameter, {scale} times the real ones, in "
        f"{len(particles[0]['diameters_m'])} sizes. Shape that is not round is represented by rolling friction "
        f"({study['settings']['solver']['rolling_friction']}) alone. Contacts are softened: shear modulus {moduli} Pa."
    )


def _range(values: list[float]) -> str:
    """Return a number, or the lowest and highest where they differ."""
    low, high = f"{min(values):.2g}", f"{max(values):.2g}"
    return low if low == high else f"{low} to {high}"


def _sampled_travel(study: Mapping[str, Any]) -> str:
    """Return the travel (mm) between two samples of the contacts; a range where velocities differ."""
    travels = [
        1e3
        * run["solver"]["sampling_interval_steps"]
        * run["derived"]["time_step_s"]
        * run["sliding"]["velocity_m_per_s"]
        for run in study["parameters"].values()
    ]
    return _range(travels)


def decks_of(study: Mapping[str, Any], folder: Path) -> list[dict[str, str]]:
    """Return the decks of the first run as the solver read them: bed, lowering and run-in, first wear cycle."""
    run = next(iter(study["runs"]))
    places = (
        ("Filling and settling the bed", Path("beds") / study["bed_of"][run] / "deck.in"),
        ("Lowering and run-in", Path(run) / "cycle_000" / "deck.in"),
        ("First wear cycle", Path(run) / "cycle_001" / "deck.in"),
    )
    return [
        {"title": title, "path": place.as_posix(), "text": (folder / place).read_text(encoding="utf-8")}
        for title, place in places
        if (folder / place).is_file()
    ]
