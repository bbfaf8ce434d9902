"""The page of a study of the circular wear tester: sections, table of runs, remarks, what is simplified."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.circular_tester import decks as tester_deck
from bulkwear.workflows.cases.circular_tester import key_numbers
from bulkwear.workflows.cases.circular_tester.beds import NOTE
from bulkwear.workflows.cases.circular_tester.figures import BEDS_IN_USE
from bulkwear.workflows.cases.circular_tester.runs import has_pairs
from bulkwear.workflows.cases.circular_tester.sensitivity_figures import EFFECTS, NUMBERS, SENSITIVITY, SETTINGS_SAID
from bulkwear.workflows.cases.circular_tester.source import material_coefficient, unlike_source
from bulkwear.workflows.report.beds import blocks_of_beds
from bulkwear.workflows.report.sections import Block, Pictures, Points, Section, Table, Text
from bulkwear.workflows.report.sentences import friction_between
from bulkwear.workflows.report.text import range_text

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Study

RUNS_NOTE = (
    "Layers: over the sample, its depth over the median diameter of the (scaled) particles, and under it. Particles: "
    "estimate from the trough's volume; the solver's number is under Cost. Pressure: of a bed at rest of that depth."
)
IN_USE_NOTE = (
    "In use: mass, mean level past the consolidator and mean height over the sample's middle (of both, twice that of "
    "the centre of mass), while the sample that took the block's place is run in."
)
SENSITIVITY_NOTE = (
    "Over: value over the nearest one that agrees, 1 where it does itself. Reached: whether the value agrees; of one "
    "packing that is this packing's, and there is no verdict."
)
NUMBERS_NOTE = (
    "Means of the main pair over its revolutions; of the patterned sample, where it is said, of the first one. Losses "
    "of bumps are those when the sample has lost what the laboratory's had, between the wear cycles around that volume."
)
EFFECTS_NOTE = (
    "Factor: by which a change multiplies a number, least squares of the logarithm over all settings; interval: 95 %, "
    "from how far the settings are off a product of such factors, packings included."
)
FAR_ABOVE = 10.0  # -, of wear coefficients: a revolution then stands for ten and more
STEEL = "steel"  # wall whose contact the source's model has
UNPAIRED = "No packing of these rows has a plain and a patterned run of series volume: nothing is compared."
DECKS = (  # {bed} and {run} are those of the first run
    ("Filling the trough and turning it until the flow is steady", "beds/{bed}/deck.in"),
    ("Run-in with the sample", "{run}/cycle_000/deck.in"),
    ("First wear cycle", "{run}/cycle_001/deck.in"),
)


def told(study: Study) -> dict[str, Any]:
    """Return what the page is told besides what every page is: whether there is anything to compare, and which samples
    are not the source's.
    """
    return {"paired": has_pairs(study), "foreign": unlike_source(study)}


def facts(study: Mapping[str, Any], folder: Path) -> list[str]:
    """Return in sentences what a study that is done answers, whatever tables an earlier choice of rows has left."""
    import pandas as pd

    from bulkwear.workflows.cases.circular_tester import answers  # every job reads this page

    told = study["told"]
    if told["paired"]:
        return answers.all_answers(folder, study["figures"], told["foreign"])
    return [*answers.each_setting(pd.read_csv(folder / "summary.csv")), UNPAIRED]


def beds(folder: Path) -> list[Block]:
    """Return the beds of a study, asked and found, and as the samples have them."""
    import pandas as pd

    return [*blocks_of_beds(folder, NOTE), Table(pd.read_csv(folder / BEDS_IN_USE), "beds_in_use", IN_USE_NOTE)]


def sections(study: Mapping[str, Any], folder: Path) -> list[Section]:
    """Return the sections of a study's page: the answer beside the experiment first, then how the runs come to it.

    Of a choice of rows in which no packing has a plain and a patterned run there are its runs alone.
    """
    if not study["told"]["paired"]:
        runs = [Text(UNPAIRED), *key_numbers.every_run(folder), Pictures(("worn_surface", "worn_surface_3d"))]
        return [Section("Every run", runs), Section("Beds", beds(folder))]
    columns = ("tester_columns", "tester_bumps", "tester_contours", "tester_force_columns")
    places = (*columns, "wear_by_law", "maps_by_law")
    layer = ("tester_spin", "tester_velocity", "tester_force", "tester_spin_map", "tester_velocity_map")
    thickness_mm, figures = study["settings"]["sample"]["thickness_mm"], study["figures"]
    parts = (
        (
            "Experiment, thesis' model and ours",
            key_numbers.beside_the_experiment(folder),
            ("tester_hours", "tester_benchmark"),
        ),
        ("Findings of the source", [*key_numbers.findings(study, folder), *published_numbers(folder)], ()),
        ("Volume by revolution", key_numbers.rates(study, folder), ("tester_volume", "tester_increments")),
        ("Patterned over plain at equal distance", key_numbers.ratios(folder), ("tester_ring",)),
        ("Every run", key_numbers.every_run(folder), ("worn_surface", "worn_surface_3d")),
        ("Beds", beds(folder), ()),
        ("Steadiness", key_numbers.steadiness(folder), ("tester_steadiness",)),
        ("Where it wears", key_numbers.by_column(folder), places),
        (
            "Until the pattern is gone",
            key_numbers.until_worn_out(folder, thickness_mm) if "tester_worn_out" in figures else [],
            ("tester_worn_out",),
        ),
        ("The lowest layer", [], layer),
        (
            "Elements",
            key_numbers.by_elements(folder) if "tester_mesh" in figures else [],
            ("tester_mesh", "tester_mesh_contours"),
        ),
    )
    if "tester_sensitivity" in figures:
        parts = (("What the source does not tell", what_is_open(folder), ("tester_sensitivity",)), *parts)
    return [Section(title, [*blocks, Pictures(pictures)]) for title, blocks, pictures in parts]


def published_numbers(folder: Path) -> list[Block]:
    """Return the published numbers that findings, which are ratios and trends, do not hold, beside ours."""
    import pandas as pd

    table = pd.read_csv(folder / NUMBERS).fillna({"reason": "", "found": ""})
    return [Table(table, "numbers", NUMBERS_NOTE, beside_source=True)] if len(table) else []


def what_is_open(folder: Path) -> list[Block]:
    """Return what each setting reaches of the published numbers, and what each change does to them."""
    import pandas as pd

    table, effects = (pd.read_csv(folder / name) for name in (SENSITIVITY, EFFECTS))
    said = (folder / SETTINGS_SAID).read_text(encoding="utf-8").splitlines()
    shown = table.drop(columns=["key", "published_low", "published_high"])
    blocks: list[Block] = [Points(tuple(said)), Table(shown, "sensitivity", SENSITIVITY_NOTE)]
    return [*blocks, Table(effects.drop(columns="key"), "effects", EFFECTS_NOTE)] if len(effects) else blocks


def remarks(study: Study) -> list[str]:
    """Return what figures must say about particles, machine, elements, coefficient, samples not the source's."""
    runs = study.runs
    scales = sorted({run.parameters["particle"]["scale"] for run in runs})
    said = [f"particles at scale {range_text(scales)}"]
    if any(run.parameters["tester"]["shape"] == tester_deck.CHANNEL for run in runs):
        length = study.settings["tester"]["channel_deg"]
        said.append(f"straight channel as long as {length:g} degrees of the annulus, unless a ring is named")
    size, whole = (settings["sample"]["element_size_mm"] for settings in (study.settings, study.paper_settings))
    if size != whole:
        said.append(f"elements of {size:g} mm instead of {whole:g} mm")
    wear = runs[0].parameters["wear"] | study.settings["wear"]
    coefficient = wear["wear_coefficient_per_pa"] * wear["acceleration"]
    accelerated = coefficient > FAR_ABOVE * material_coefficient()
    far = ", far above the material's: a revolution stands for many hours" if accelerated else ""
    said.append(f"wear coefficient {coefficient:g} 1/Pa{far}")
    unlike = list(dict.fromkeys(unlike_source(study).values()))
    return [*said, *(each for each in unlike if not any(other.startswith(f"{each}; ") for other in unlike))]


def run_columns(run: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the table of runs tells of a run's parameters."""
    derived = run["derived"]
    return {
        "shape": run["tester"]["shape"],
        "particle_scale": run["particle"]["scale"],
        "element_size_mm": 1e3 * run["sample"]["element_size_m"],
        "wear_coefficient_per_pa": run["wear"]["accelerated_wear_coefficient_per_pa"],
        "revolutions": run["sliding"]["revolutions"],
        "wear_cycles": run["sliding"]["cycles"],
        "layers": derived["layers"],
        "layers_below": derived["layers_below"],
        "equivalent_size_ratio": derived["equivalent_size_ratio"],
        "particles": derived["bed_particles"],
        "pressure_pa": derived["bulk_pressure_pa"],
        "time_step_us": 1e6 * derived["time_step_s"],
    }


def simplifications(study: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return (what, how) of what is simpler here than on the machine, besides scale, wear and comparison."""
    settings, runs = study["settings"], list(study["parameters"].values())
    sliding, solver = settings["sliding"], [run["solver"]["rolling_friction"] for run in runs]
    diameters = [1e3 * diameter for run in runs for diameter in run["particle"]["diameters_m"]]
    ratios = [ratio for run in runs if (ratio := run["derived"]["equivalent_size_ratio"]) is not None]
    helps = "the source finds that a pattern helps below 1"
    over_bump = f" Particle over bump (alpha_ER, Eq 4.18): {range_text(ratios)}; {helps}." if ratios else ""
    return [
        (
            "Coarse-grained particles",
            f"Spheres of {min(diameters):.3g} to {max(diameters):.3g} mm. Shape that is not round is represented by "
            f"rolling friction ({_listed(solver)}) alone. "
            f"{friction_between([run['particle'] for run in runs])}{over_bump}",
        ),
        (
            "Straight channel",
            "Rows of shape channel have the trough's width and are periodic along the travel; their walls go straight "
            f"on at the velocity of the mean radius. Inside and outside are alike there: {_inside_outside(runs)}.",
        ),
        (
            "Not published",
            f"Height of the bed over the floor ({_millimetres(runs, 'tester', 'bed_height_m')}), thickness of sample "
            f"and holder ({_millimetres(runs, 'sample', 'thickness_m')}) and the consolidator's dimensions are "
            f"assumptions. What holds the sample is left out. {_contact_words(runs)}",
        ),
        (
            "Wear cycle by cycle",
            f"The sample is worn {sliding['cycles_per_revolution']:g} times in a revolution unless its row says "
            f"otherwise. A revolution is {sliding['revolution_deg']:g} degrees, as in the source's sector.",
        ),
        (
            "Packings",
            "Rows of equal machine, particles and packing start from one bed in motion. Intervals are over packings: "
            "each counts as one value, however long it is. Of one packing the scatter is unknown.",
        ),
    ]


def _listed(words: Iterable[str]) -> str:
    return " or ".join(dict.fromkeys(words))


def _millimetres(runs: list[Mapping[str, Any]], section: str, key: str) -> str:
    """Return all that a length is in some runs."""
    return f"{_listed(f'{each:g}' for each in sorted({1e3 * run[section][key] for run in runs}))} mm"


def _contact_words(runs: list[Mapping[str, Any]]) -> str:
    """Return what the contact of samples with particles is: the floor's, or their own friction."""
    said = []
    for sample, floor in ((run["sample_material"], run["floor_material"]) for run in runs):
        own, as_floor = sample["contact"], sample["contact"] == floor["contact"]
        model = ", as in the model that chapter 6 refers to" if floor["name"] == STEEL else ""
        friction = f"sliding friction {own['sliding_friction']:g}, rolling friction {own['rolling_friction']:g}"
        said.append(f"that of {floor['name']}{model}" if as_floor else f"that of {sample['name']} ({friction})")
    return f"The sample's contact with particles is {', or '.join(dict.fromkeys(said))}."


def _inside_outside(runs: list[Mapping[str, Any]]) -> str:
    """Return how much slower and faster the ring is at the sample's sides."""
    mean, half = tester_deck.mean_radius(runs[0]["tester"]), 0.5 * runs[0]["sample"]["width_m"]
    slow, fast = 1.0 - half / mean, 1.0 + half / mean
    return f"in the ring the sample's sides meet the bed at {slow:.2f} and {fast:.2f} times its speed"


def further_cap(settings: Mapping[str, Any]) -> str:
    """Return how far a node may move in one update, besides what its edges allow."""
    return f"as far as particles fall in {settings['wear']['gap_closing_fraction']:g} of the cycle's duration"
