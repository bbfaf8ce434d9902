"""The page of a study of pins on discs: its sections and key numbers, table of runs, remarks, what is simplified."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from bulkwear.postproc.statistics.intervals import estimate
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES, MICROMETRES
from bulkwear.postproc.tables.summary import read_summary
from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.cases.pin_on_disc import findings
from bulkwear.workflows.report.predictions import Foreseen, error_of, foreseen, prediction_blocks
from bulkwear.workflows.report.sections import Block, Cards, Pictures, Section, Table
from bulkwear.workflows.report.text import range_text

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Study

ROLLS = False  # pins are held
RUNS_NOTE = (
    "Overlap: of pin and flat disc as simulated (Hertz); contact radius: of the same. Time step: the stated fraction "
    "of the Rayleigh time. Empty cells of the design leave a setting as it is."
)
DECKS = (
    ("Setting the pin down", "{run}/cycle_000/deck.in"),
    ("First wear cycle", "{run}/cycle_001/deck.in"),
)
SECTIONS = (  # title, its figures, the first of which a study must have, and what makes its other blocks
    ("Depth, width and volume", ("pin_comparison", "laboratory_contour"), findings.comparison_blocks),
    ("What exceeds alpha F L", ("excess_volume", "force_rise", "normal_force"), findings.excess_blocks),
    ("Growth of the volume with the revolutions", ("wear_volume",), findings.fit_blocks),
    ("Wear coefficient", ("calibration",), findings.coefficient_blocks),
    ("Wear by several laws", ("wear_by_law", "maps_by_law"), lambda folder: []),
    ("Run-in", ("run_in", "contour_distribution", "contour_examples"), findings.run_in_blocks),
    ("Dependence on the mesh", ("mesh_series", "mesh_contours"), findings.mesh_blocks),
    ("Size invariance", ("size_invariance",), findings.size_blocks),
    ("Disc and track", ("disc_setup", "contour_extraction", "worn_disc", "unrolled_track"), lambda folder: []),
)
KEY_HEADS = {
    "alpha_F_L_volume_mm3": ("alpha F L", "mm³"),
    "law_over_alpha_F_L": ("law", "over alpha F L"),
    "removed_over_alpha_F_L": ("removed", "over alpha F L"),
    "centroid_path_over_alpha_F_L": ("centroid paths", "over alpha F L"),
    "largest_depth_um": ("thickness", "largest, µm"),
    "mean_normal_force_N": ("normal force", "mean sum, N"),
    "mean_vertical_force_N": ("vertical force", "mean, N"),
    "most_contacts": ("contacts", "most, mean of a cycle"),
    "carried_share_percent": ("not applied", "%"),
}
KEY_DIGITS = {
    **dict.fromkeys(("revolutions", "alpha_F_L_volume_mm3"), 4),
    **dict.fromkeys(("mean_normal_force_N", "mean_vertical_force_N"), 5),
    **dict.fromkeys(("law_over_alpha_F_L", "removed_over_alpha_F_L", "centroid_path_over_alpha_F_L"), 6),
}  # significant ones, else 3
KEY_NOTE = (
    "alpha F L: wear coefficient times load times sliding distance, Archard's volume of a pin on a flat disc. Law: the "
    "same with the summed normal forces of all contacts. Removed: pristine less worn disc. Centroid paths: areas of "
    "the triangles times the paths of their centroids, summed over all updates, as Yan 2022 counts (Eq 5.8 to 5.10). A "
    "disc that keeps its shape (series size) loses nothing."
)


def told(study: Study) -> dict[str, Any]:
    """Return what the page is told besides what every page is: nothing."""
    return {}


def facts(study: Mapping[str, Any], folder: Path) -> list[str]:
    """Return in sentences what a study that is done answers, whatever tables an earlier choice of rows has left."""
    from bulkwear.workflows.cases.pin_on_disc.answers import (
        all_answers,
    )  # slow to import, and every job reads this page

    return all_answers(folder, study["figures"])


def sections(study: Mapping[str, Any], folder: Path) -> list[Section]:
    """Return the sections of a study's page: its key numbers, then those of which the study has the figures."""
    summary, error = read_summary(folder / "summary.csv"), error_of(study["settings"])
    found = [Section("Key numbers", [*key_numbers(summary), *prediction_blocks(predictions(summary, error), error)])]
    if set(findings.NEEDED_OF_VERDICTS) <= set(study["figures"]):
        found.append(Section("Findings of the source", findings.verdict_blocks(folder)))
    for title, figures, blocks in SECTIONS:
        if figures[0] in study["figures"]:
            found.append(Section(title, [*blocks(folder), Pictures(figures)]))
    return found


def key_numbers(summary: pd.DataFrame) -> list[Block]:
    """Return the cards that answer a study's question, and the numbers of every run."""
    results = result_table(summary)
    table = Table(results, "key_numbers", KEY_NOTE, KEY_DIGITS, KEY_HEADS)
    return [*([Cards(found)] if (found := cards(results)) else []), table]


def predictions(summary: pd.DataFrame, error: float) -> list[Foreseen]:
    """Return what discs lose with the error (-) of the coefficient; no run is repeated, so scatter is unknown. Discs
    that keep their shape lose nothing.
    """
    found = []
    for row in summary[summary["removed_volume_m3"] > 0.0].itertuples():
        removed, whose = CUBIC_MILLIMETRES * row.removed_volume_m3, {"run": row.run}
        for what, volume in (("removed volume", removed), ("per revolution", removed / row.revolutions)):
            found.append(foreseen(whose, what, "mm³", estimate([volume], log=True), error))
    return found


def result_table(summary: pd.DataFrame) -> pd.DataFrame:
    """Return the key numbers of each run in display units: volumes, their ratios to alpha F L, forces, contacts."""
    due = summary["alpha_F_L_volume_m3"]
    names = ["run", "series", "scheme", "wear_coefficient_per_pa", "element_size_mm", "particle_scale", "revolutions"]
    return summary[names].assign(
        alpha_F_L_volume_mm3=due * CUBIC_MILLIMETRES,
        law_over_alpha_F_L=summary["worn_volume_m3"] / due,
        removed_over_alpha_F_L=summary["removed_volume_m3"] / due,
        centroid_path_over_alpha_F_L=summary["centroid_path_volume_m3"] / due,
        largest_depth_um=summary["largest_depth_m"] * MICROMETRES,
        mean_normal_force_N=summary["mean_normal_force_N"],
        mean_vertical_force_N=summary["mean_vertical_force_N"],
        most_contacts=summary["most_contacts_per_step"],
        carried_share_percent=100.0 * (summary["carried_volume_m3"] / summary["worn_volume_m3"]).abs(),
    )


def cards(results: pd.DataFrame) -> list[tuple[str, str]]:
    """Return (number, what it is) of the few that answer the question: the first row of the coefficients by each
    scheme.
    """
    found = []
    for scheme, words in (("conserving", "conserving"), ("per_triangle", "by the per-triangle rule")):
        rows = results[(results["series"] == "coefficient") & (results["scheme"] == scheme)]
        if rows.empty:
            continue
        row = rows.iloc[0]
        removed = f"volume removed over coefficient x load x distance, {words}, {row['run']}"
        found.append((f"{row['removed_over_alpha_F_L']:.4g}", removed))
        found.append((f"{row['largest_depth_um']:.3g}", f"µm, largest thickness removed, {words}"))
    return found


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
    weights = range_text([_weight_percent(run) for run in runs])
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
            "gets the stretch of the track that a wear cycle needs. There is no gravity: the pin's weight would be "
            f"{weights} % of the load.",
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


def _weight_percent(run: Mapping[str, Any]) -> float:
    """Return the weight of a run's pin, which is not simulated, over its load (%)."""
    return 100.0 * run["derived"]["pin_mass_kg"] * GRAVITY / run["pin"]["load_n"]


def further_cap(settings: Mapping[str, Any]) -> str:
    """Return how far a node may move in one update, besides what its edges allow."""
    fraction = settings["wear"]["largest_step_overlap_fraction"]
    return f"{fraction:g} of the pin's overlap, so that the pin keeps contact"
