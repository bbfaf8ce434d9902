"""The page of a study of the circular wear tester: table of runs, remarks, what is simplified."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from workflows.cases.circular_tester import decks as tester_deck
from workflows.report.text import range_text

if TYPE_CHECKING:
    from workflows.config.design import Run, Study

KEY_NUMBERS = "key_numbers_circular_tester.html.j2"
FURTHER_TEMPLATES = ()  # that it includes
RUNS_NOTE = (
    "Layers: over the sample, its depth over the median diameter of the (scaled) particles, and under it. Particles: "
    "estimate from the trough's volume; the solver's number is under Cost. Pressure: of a bed at rest of that depth."
)
DECKS = (  # {bed} and {run} are those of the first run
    ("Filling the trough and turning it until the flow is steady", "beds/{bed}/deck.in"),
    ("Run-in with the sample", "{run}/cycle_000/deck.in"),
    ("First wear cycle", "{run}/cycle_001/deck.in"),
)
THESIS_SCALE = 3.0  # particle scale of the source's model, beside 1, 2 and 4


def remarks(study: Study) -> list[str]:
    """Return what figures must say about particles, machine, elements, coefficient."""
    runs = study.runs
    scales = sorted({run.parameters["particle"]["scale"] for run in runs})
    said = [f"particles at scale {range_text(scales)}"]
    if any(run.parameters["tester"]["shape"] == tester_deck.CHANNEL for run in runs):
        length = study.settings["tester"]["channel_deg"]
        said.append(f"straight channel as long as {length:g} degrees of the annulus, unless a ring is named")
    size, whole = (settings["sample"]["element_size_mm"] for settings in (study.settings, study.paper_settings))
    if size != whole:
        said.append(f"elements of {size:g} mm instead of {whole:g} mm")
    coefficient = study.settings["wear"]["wear_coefficient_per_pa"] * study.settings["wear"]["acceleration"]
    said.append(f"wear coefficient {coefficient:g} 1/Pa, far above the material's: a revolution stands for many hours")
    return said


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


def values_of_runs(study: Study) -> list[dict[str, Any]]:
    """Return what the analysis of every run of a study needs to know of it."""
    return [run_values(study, run) for run in study.runs]


def run_values(study: Study, run: Run) -> dict[str, Any]:
    """Return what the analysis of a run needs, JSON-able, see `workflows.cases.circular_tester.runs.TesterRun`."""
    parameters, bed = run.parameters, study.beds[study.bed_of(run.name)]
    sample, sliding, derived = (parameters[name] for name in ("sample", "sliding", "derived"))
    series = next(row["series"] for row in study.design_rows if row["row"] == run.row)
    return {
        "name": run.name,
        "bed": study.bed_of(run.name),
        "surface": "convex" if parameters["pattern"] else "plain",
        "series": series,
        "shape": parameters["tester"]["shape"],
        "particle_scale": parameters["particle"]["scale"],
        "element_size_mm": 1e3 * sample["element_size_m"],
        "coefficient": parameters["wear"]["accelerated_wear_coefficient_per_pa"],
        "patch": patch_words(parameters["wear"]),
        "bed_revolution_steps": round(bed["revolution_s"] / bed["time_step_s"]),
        "revolution_steps": derived["revolution_steps"],
        "revolution_s": derived["revolution_s"],
        "bed_revolutions": sliding["steady_revolutions"],
        "run_in_revolutions": sliding["run_in_revolutions"],
        "width": sample["width_m"],
        "length": sample["length_m"],
        "layer_height": parameters["particle"]["median_diameter_m"],
        "rotation": tester_deck.pose(parameters["tester"]).tolist(),
        "distance_per_revolution": sliding["velocity_m_per_s"] * derived["revolution_s"],
    }


def patch_words(wear: Mapping[str, Any]) -> str:
    """Return over what a contact wears."""
    return {
        "none": "single elements",
        "simulated": "its Hertz patch in the solver",
        "physical": "the Hertz patch of the real material",
        "radius": f"{1e3 * wear.get('patch_radius_m', 0.0):g} mm round it",
    }[wear["patch"]]


def simplifications(study: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return (what, how) of what is simpler here than on the machine, besides scale, wear and comparison."""
    settings, runs = study["settings"], list(study["parameters"].values())
    tester, sliding = settings["tester"], settings["sliding"]
    diameters = [1e3 * diameter for run in runs for diameter in run["particle"]["diameters_m"]]
    ratios = [run["derived"]["equivalent_size_ratio"] for run in runs if run["pattern"]]
    return [
        (
            "Coarse-grained particles",
            f"Spheres of {min(diameters):.3g} to {max(diameters):.3g} mm. Shape that is not round is represented by "
            f"rolling friction ({settings['solver']['rolling_friction']}) alone. Particle over bump "
            f"(alpha_ER, Eq 4.18): {range_text(ratios)}; the source finds that a pattern helps below 1.",
        ),
        (
            "Straight channel",
            "Rows of shape channel have the trough's width and are periodic along the travel; their walls go straight "
            f"on at the velocity of the mean radius. Inside and outside are alike there: {_inside_outside(runs)}.",
        ),
        (
            "Not published",
            f"Height of the bed over the floor ({tester['bed_height_mm']:g} mm), thickness of sample and holder "
            f"({settings['sample']['thickness_mm']:g} mm) and the consolidator's dimensions are assumptions. What "
            "holds the sample is left out. The sample's contact with particles is that of steel, as in the model that "
            "chapter 6 refers to.",
        ),
        (
            "Wear cycle by cycle",
            f"The sample is worn {sliding['cycles_per_revolution']:g} times in a revolution unless its row says "
            f"otherwise. A revolution is {sliding['revolution_deg']:g} degrees, as in the source's sector.",
        ),
        (
            "One packing",
            "Rows of equal machine and particles start from one bed in motion. Deviations in figures are over the "
            "revolutions of one run, not over repetitions.",
        ),
    ]


def _inside_outside(runs: list[Mapping[str, Any]]) -> str:
    """Return how much slower and faster the ring is at the sample's sides."""
    mean, half = tester_deck.mean_radius(runs[0]["tester"]), 0.5 * runs[0]["sample"]["width_m"]
    slow, fast = 1.0 - half / mean, 1.0 + half / mean
    return f"in the ring the sample's sides meet the bed at {slow:.2f} and {fast:.2f} times its speed"


def further_cap(settings: Mapping[str, Any]) -> str:
    """Return how far a node may move in one update, besides what its edges allow."""
    return f"as far as particles fall in {settings['wear']['gap_closing_fraction']:g} of the cycle's duration"
