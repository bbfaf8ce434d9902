"""The page of a study of equipment: its sections, table of runs, remarks, what is simplified."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.postproc.tables.law_volumes import laws_of_settings
from bulkwear.postproc.tables.summary import read_named, read_summary
from bulkwear.postproc.wear.laws import LAWS
from bulkwear.workflows.cases.equipment import findings, heads, page_blocks
from bulkwear.workflows.cases.equipment.heads import shown
from bulkwear.workflows.cases.equipment.machine_tables import laws_of_parts
from bulkwear.workflows.cases.equipment.page_blocks import read_tables
from bulkwear.workflows.cases.equipment.phases import PRISTINE
from bulkwear.workflows.cases.equipment.surfaces import label_of
from bulkwear.workflows.cases.equipment.tables import FIRST_WALL
from bulkwear.workflows.report.figure_findings import laws_on_designs
from bulkwear.workflows.report.sections import Pictures, Section
from bulkwear.workflows.report.sentences import friction_between
from bulkwear.workflows.report.text import range_text

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Study

RUNS_NOTE = (
    "Particles: estimate of what the machine holds. Block: simulated time of each. Empty cells of the design "
    "leave a setting as it is."
)
DECKS = (
    ("First block of the start-up", "{run}/cycle_000/deck.in"),
    ("A block with wear counted", "{run}/cycle_001/deck.in"),
)
SECONDS_PER_HOUR = 3600.0
SUMMARY, VOLUMES = "summary.csv", "volume_by_law.csv"
SEVERAL = 2  # laws of a study that compares laws, without those that every ledger tells
WEIGHTIEST = "Wear coefficient"  # every life is in proportion to it
# Figures of the sections, by name; a study has those that its modules of figures declare
LIFE_FIGURES = ("life_bars", "recession_against_time")
FLOW_FIGURES = ("flow_over_time", "flow_pictures", "velocity_fields", "charge_shape")
WEAR_FIGURES = ("wear_map", "remaining_thickness", "worn_surface_3d", "wear_by_law", "maps_by_law")
LOAD_FIGURES = ("impact_and_sliding",)
WORN_FIGURES = ("profile_sections",)
LIFTER_FIGURES = ("lifter_profiles",)


def told(study: Study) -> dict[str, Any]:
    """Return what the page is told besides what every page is: {run: its setting}."""
    return {"settings": {run.name: study.setting_of[run.row] for run in study.runs}}


def sections(study: Mapping[str, Any], folder: Path) -> list[Section]:
    """Return the sections of a study's page: answers first, then how the runs come to them. Any rows will do."""
    found, summary = read_tables(folder), read_summary(folder / SUMMARY)
    machines = first_runs(study)
    worst = shown(found["worst_places"], heads.WORST_COLUMNS, "worst_places", page_blocks.WORST_NOTE)
    steel = shown(found["steel"], heads.STEEL_COLUMNS, "steel", page_blocks.INTERVALS)
    parts = [
        ("When what has to be changed", page_blocks.life(found), LIFE_FIGURES),
        ("The machine", page_blocks.machine(machines), ()),
        ("Flow", page_blocks.flow(found), FLOW_FIGURES),
        ("Where it wears", [worst], WEAR_FIGURES),
        ("Impact and sliding", page_blocks.impacts(found), LOAD_FIGURES),
        ("The worn shape", page_blocks.worn_shape(found, summary, machines), WORN_FIGURES),
        ("Lifters", page_blocks.lifters(found), LIFTER_FIGURES if "lifters" in found else ()),
        ("Designs side by side", page_blocks.designs(found, machines), ()),
        ("Steel lost", [steel], ()),
        ("Balance of particles", page_blocks.balance(found), ()),
        ("Beside published values", page_blocks.anchors(found), ()),
    ]
    return [Section(title, [*blocks, Pictures(pictures)]) for title, blocks, pictures in parts if blocks or pictures]


def answers(folder: Path) -> list[str]:
    """Return in sentences what a study that is done answers."""
    return [
        *_answer_on_laws(folder / VOLUMES),
        *findings.all_answers(read_tables(folder), read_summary(folder / SUMMARY)),
    ]


def _answer_on_laws(file: Path) -> list[str]:
    """Return on which design laws disagree, of a study that compares them: by parts or beside its own."""
    if not file.is_file():
        return []
    volumes = read_named(file)
    asked = volumes["law"].map(lambda law: bool(LAWS[law].kernels or LAWS[law].parameters))
    if volumes.loc[asked | (volumes["over_study_law"] == 1.0), "law"].nunique() < SEVERAL:
        return []
    said = laws_on_designs(laws_of_settings(volumes))
    return [said] if said else []


def steadiness(folder: Path) -> list[str]:
    """Return of each run whether its flow is steady on the shape as built."""
    flow = read_tables(folder)["flow"]
    return flow.loc[flow["phase"] == PRISTINE, "answer"].tolist()


def frictions(run: Mapping[str, Any]) -> dict[int, float]:
    """Return the sliding friction (-) of each part of a run by the label of its faces."""
    materials = [run["walls"][part["type"] - FIRST_WALL]["contact"] for part in run["parts"]]
    labels = [label_of(number, part) for number, part in enumerate(run["parts"])]
    return {label: contact["sliding_friction"] for label, contact in zip(labels, materials, strict=True)}


def part_names(run: Mapping[str, Any]) -> dict[int, str]:
    """Return what each part is called by the label of its faces."""
    return {label_of(number, part): part["name"].replace("_", " ") for number, part in enumerate(run["parts"])}


def first_runs(study: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """Return {setting: parameters of its first run}."""
    found: dict[str, Mapping[str, Any]] = {}
    for run, setting in study["told"]["settings"].items():
        found.setdefault(setting, study["parameters"][run])
    return found


# ---------------------------------------------------------------- setting


def remarks(study: Study) -> list[str]:
    """Return what figures must say: particle scale, and for how long the shape was worn at most."""
    scales = sorted({run.parameters["particle"]["scale"] for run in study.runs})
    said = [f"particles at scale {range_text(scales)}"] if scales != [1.0] else []
    now, full = study.settings["sampling"], study.paper_settings["sampling"]
    if now["most_blocks"] != full["most_blocks"]:
        blocks = f"{now['most_blocks']} block{'s' * (now['most_blocks'] > 1)}"
        said.append(f"at most {blocks} on the shape as built instead of {full['most_blocks']}")
    return said


def run_columns(run: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the table of runs tells of a run's parameters."""
    derived, inlet = run["derived"], run["inlet"]
    return {
        "feed_t_per_h": inlet["rate_kg_per_s"] * SECONDS_PER_HOUR / 1e3 if inlet else None,
        "particles": derived["held_particles"],
        "time_step_us": 1e6 * derived["time_step_s"],
        "block_s": run["sampling"]["block_s"],
        "operation_h": derived["operation_s"] / SECONDS_PER_HOUR,
    }


def further_cap(settings: Mapping[str, Any]) -> str:
    """Return how far a node may move in one update, besides what its edges allow."""
    return "as far as an even share of the operation that is left wears it"


def update_words(most: int) -> str:
    """Return what a block's wear stands for in so many updates of the shape at most."""
    if not most:
        return "The shape is kept as built."
    return (
        f"In up to {most} update{'s' * (most > 1)} a block's wear stands for as many hours as a step of the shape"
        " allows, and for an even share of the operation that is asked for at most."
    )


def updates_words(most: Sequence[int]) -> str:
    """Return what a block's wear stands for; most: updates of the shape of each run, at most."""
    kept = "In some designs the shape is kept as built. " if min(most) < 1 <= max(most) else ""
    return kept + update_words(max(most))


def laws_told(study: Mapping[str, Any]) -> dict[str, str]:
    """Return {law: what a volume is by it} of all parts that wear."""
    return laws_of_parts(list(study["parameters"].values()))


def simplifications(study: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return (what, how) of what is simpler here than in the plant, besides scale and wear."""
    settings, runs = study["settings"], list(study["parameters"].values())
    scales = range_text([run["particle"]["scale"] for run in runs], 4)
    diameters = [1e3 * diameter for run in runs for diameter in run["particle"]["diameters_m"]]
    patches = [1e3 * run["sampling"]["patch_m"] for run in runs]
    errors = [100.0 * part["wear_coefficient_error"] for run in runs for part in run["parts"] if part["wears"]]
    return [
        (
            "Coarse-grained particles",
            f"Spheres of {min(diameters):.3g} to {max(diameters):.3g} mm, {scales} times the "
            "real ones, of the same density and feed in t/h. Shape that is not round is represented by rolling "
            f"friction ({settings['solver']['rolling_friction']}) alone. "
            f"{friction_between([run['particle'] for run in runs])} Impacts are fewer and harder than real ones.",
        ),
        (
            "Hours from seconds",
            "Each block of simulated time tells the rate of wear per hour of operation, with the true coefficient. "
            + updates_words([run["updates"]["most"] for run in runs]),
        ),
        (
            "Steady operation",
            "Feed, material and motion stay as they are for all hours. Start and stop, moisture, build-up and "
            "corrosion are left out.",
        ),
        (
            "Wear coefficient",
            f"As given, to be that of the part's law; half of its 95 % interval is {range_text(errors)} % of it, "
            "stated or assumed, and is in the interval of every life. Ratios of designs with one coefficient do not "
            "depend on it.",
        ),
        (
            "Patches",
            f"Rates are means over patches of about {range_text(patches, 4)} mm: deeper spots within one are not told.",
        ),
    ]
