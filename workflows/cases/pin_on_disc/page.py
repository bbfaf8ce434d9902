"""The page of a study of a pin on a disc: table of runs, remarks, what is simplified."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from workflows.report.text import range_text

if TYPE_CHECKING:
    from workflows.config.design import Study

KEY_NUMBERS = "key_numbers_pin_on_disc.html.j2"
FURTHER_TEMPLATES = ()  # that it includes
RUNS_NOTE = (
    "Overlap: of pin and flat disc as simulated (Hertz); contact radius: of the same. Time step: the stated fraction "
    "of the Rayleigh time. Empty cells of the design leave a setting as it is."
)
DECKS = (
    ("Setting the pin down", "{run}/cycle_000/deck.in"),
    ("First wear cycle", "{run}/cycle_001/deck.in"),
)


def remarks(study: Study) -> list[str]:
    """Return what figures must say: revolutions, wear cycles and elements of the rows, where fewer or larger."""
    now, full = study.settings, study.paper_settings
    said = []
    for section, key, words in (
        ("sliding", "revolutions", "revolutions"),
        ("sliding", "cycles_per_revolution", "wear cycles per revolution"),
    ):
        if now[section][key] != full[section][key]:
            said.append(f"{now[section][key]:g} {words} instead of {full[section][key]:g}")
    size, whole = (settings["disc"]["element_size_mm"] for settings in (now, full))
    if size != whole:
        said.append(f"elements of {size:g} mm instead of {whole:g} mm")
    return said


def update_remark(study: Study) -> str:
    """Return how long a wear update is, on which Eq 5.9 over touched triangles depends."""
    arc = 360.0 / study.settings["sliding"]["cycles_per_revolution"]
    return (
        f"wear updates of {arc:g} degrees: on a flat disc Eq 5.9 over touched triangles gives the law's volume with "
        "one triangle per update, about 3 times it with an arc of many"
    )


def run_columns(run: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the table of runs tells of a run's parameters."""
    derived, pin = run["derived"], run["pin"]
    return {
        "overlap_um": derived["overlap_m"] * 1e6,
        "contact_radius_um": (pin["radius_m"] * derived["overlap_m"]) ** 0.5 * 1e6,
        "sliding_distance_mm": derived["sliding_distance_m"] * 1e3,
        "time_step_us": derived["time_step_s"] * 1e6,
        "wear_cycles": run["sliding"]["cycles"],
        "steps_of_first_cycle": derived["first_cycle_steps"],
    }


def simplifications(study: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return (what, how) of what is simpler here than on a rig, besides scale, wear and comparison."""
    runs = list(study["parameters"].values())
    overlap = range_text([run["derived"]["overlap_m"] * 1e6 for run in runs])
    moduli = range_text([run["particle"]["shear_modulus_pa"] for run in runs])
    restitution = range_text([run["sample_material"]["contact"]["restitution"] for run in runs])
    return [
        (
            "Softened pin",
            f"The pin's shear modulus is {moduli} Pa, as in the source and far below that of iron ore: it "
            f"sinks {overlap} µm into the flat disc. The contact is as wide as that of the soft pin. "
            "The pin does not wear.",
        ),
        (
            "The pin goes round",
            "The disc rests and the pin is taken round, seen from a disc that turns under a pin at rest; the solver "
            "gets the stretch of the track that a wear cycle needs. There is no gravity: the pin's weight is 0.1 % of "
            "the load.",
        ),
        (
            "Damping assumed",
            f"The coefficient of restitution, {restitution}, is that of particle and steel (Table 3.2); the source "
            "leaves it blank for the pin. Means do not depend on it; how far the pin swings from triangle to triangle "
            "does. In a groove, where it has many contacts at once, the solver takes smaller time steps.",
        ),
        (
            "Wear cycle by cycle",
            f"The disc is worn {study['settings']['sliding']['cycles_per_revolution']} times in a revolution, after "
            "each arc, not at every time step.",
        ),
    ]


def further_cap(settings: Mapping[str, Any]) -> str:
    """Return how far a node may move in one update, besides what its edges allow."""
    fraction = settings["wear"]["largest_step_overlap_fraction"]
    return f"{fraction:g} of the pin's overlap, so that the pin keeps contact"
