"""The page of a study of sliding samples: table of runs, remarks, what is simplified."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.postproc.reference.size_ratios import LARGEST_RATIO
from bulkwear.postproc.tables.summary import read_summary
from bulkwear.workflows.cases.sliding_sample import grain_shape, key_numbers
from bulkwear.workflows.cases.sliding_sample.study import finds_regimes, replicate_settings, varies_scale
from bulkwear.workflows.engine.derived import PERIODIC, WINDOW
from bulkwear.workflows.engine.grains import CLUMP
from bulkwear.workflows.report.beds import blocks_of_beds
from bulkwear.workflows.report.predictions import error_of
from bulkwear.workflows.report.sections import Pictures, Section
from bulkwear.workflows.report.sentences import friction_between
from bulkwear.workflows.report.text import range_text

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Study

RUNS_NOTE = (
    "Layers: thickness of the bed over the median diameter of the (scaled) particles. Equivalent size ratio: particle "
    "over bump (Yan 2022, Eq 4.18). Particles: estimate from mass; the solver's number is under Cost."
)
DECKS = (  # {bed} and {run} are those of the first run
    ("Filling and settling the bed", "beds/{bed}/deck.in"),
    ("Lowering and run-in", "{run}/cycle_000/deck.in"),
    ("First wear cycle", "{run}/cycle_001/deck.in"),
)
TOLD_HOP = 0.05  # of the sample's length; a shorter hop off the ramp hides less than a row of elements or two
ALONG = {  # bed.ends -> what it makes of the packing along the travel
    PERIODIC: " and along it, so that it passes the sample again and again",
    WINDOW: " and along it: the same packing comes again, undisturbed, after each length of the window",
}
BEYOND_BUMPS = "particles scaled beyond the size of the bumps, which by the source ride over them (Yan 2022, Fig 4.17)"
MOST_NAMED = 4  # rows that a remark on every figure names; of more it says how many, the table of runs has them
FIGURES_OF_ALL = {  # of every study, by section
    "Where and when it wears": (
        "wear_against_travel",
        "wear_split",
        "depth_distribution",
        "worn_surface_3d",
        "worn_film",
        "wear_updates",
    ),
    "Bed and forces": ("bed", "flow_views", "forces"),
    "Wear laws": ("wear_law_comparison", "wear_by_law", "maps_by_law"),
}
REDUCED = (
    ("bed", "width_mm", "bed width"),
    ("bed", "ahead_mm", "bed ahead of the sample"),
    ("sliding", "run_in_mm", "run-in"),
)  # settings whose reduction every figure tells


def told(study: Study) -> dict[str, Any]:
    """Return what the page is told besides what every page is."""
    from bulkwear.workflows.cases.sliding_sample.particle_size import page as particle_size
    from bulkwear.workflows.cases.sliding_sample.screening import page as screening
    from bulkwear.workflows.cases.sliding_sample.search import page as search

    by_regime, by_scale = finds_regimes(study), varies_scale(study)
    return {
        "replicates": replicate_settings(study),
        "finds_regimes": by_regime,
        "varies_scale": by_scale,
        "compares_shapes": grain_shape.compares_shapes(study),
        **search.told(study),
        **(screening.told(study) if by_regime else {}),
        **(particle_size.told(study) if by_scale else {}),
    }


def answers(folder: Path) -> list[str]:
    """Return in sentences what the patterns of a study do to the wear."""
    from bulkwear.workflows.cases.sliding_sample.particle_size import page as particle_size
    from bulkwear.workflows.cases.sliding_sample.search import page as search

    said = key_numbers.answers(read_summary(folder / "summary.csv"))
    by_scale = particle_size.answers(folder) if said else []  # all that it answers is of wear over plain
    of_study = [*by_scale, *said[-1:]] if by_scale else search.answers(folder) or said
    return [*grain_shape.answers(folder), *of_study]


def facts(study: Mapping[str, Any], folder: Path) -> list[str]:
    """Return in sentences how deep the samples wear per hour, and for how long the runs stand."""
    from bulkwear.workflows.cases.sliding_sample.search import page as search

    acceleration, error = study["settings"]["wear"]["acceleration"], error_of(study["settings"])
    shown = search.of_best(read_summary(folder / "summary.csv"), folder)
    return key_numbers.facts(shown, key_numbers.depths_of(folder), acceleration, error)


def sections(study: Mapping[str, Any], folder: Path) -> list[Section]:
    """Return the sections of a page: what particle size asks, key numbers, screening, then wear and bed of any."""
    from bulkwear.workflows.cases.sliding_sample.particle_size import page as particle_size
    from bulkwear.workflows.cases.sliding_sample.screening import page as screening
    from bulkwear.workflows.cases.sliding_sample.search import page as search

    of_study = study["told"]
    return _each_figure_once(
        [
            *(search.sections(study, folder) if "search" in of_study else []),
            *(particle_size.sections(study, folder) if of_study["varies_scale"] else []),
            Section(
                "Key numbers", [*key_numbers.key_numbers(study, folder), Pictures(["relative_wear", "worn_surface"])]
            ),
            *([Section("Shape of grains", grain_shape.blocks(folder))] if of_study["compares_shapes"] else []),
            *(screening.sections(study, folder) if of_study["finds_regimes"] else []),
            *(Section(title, [Pictures(names)]) for title, names in FIGURES_OF_ALL.items()),
            Section("Beds", blocks_of_beds(folder)),
        ]
    )


def _each_figure_once(found: list[Section]) -> list[Section]:
    """Return sections whose figures stand where they are named first: several kinds of study show some of them."""
    seen: set[str] = set()
    kept = []
    for section in found:
        blocks = []
        for block in section.blocks:
            if isinstance(block, Pictures):
                block = Pictures([name for name in block.names if name not in seen])
                seen |= set(block.names)
            blocks.append(block)
        kept.append(Section(section.title, blocks))
    return kept


def remarks(study: Study) -> list[str]:
    """Return what figures must say about particles, sample, bed and travel."""
    now, full = study.settings, study.paper_settings
    said = []
    scales = sorted({round(run.parameters["particle"]["scale"], 3) for run in study.runs})
    if scales[0] != scales[-1]:
        said.append(f"particles at scale {scales[0]:g} to {scales[-1]:g}, different from row to row")
    elif scales != [1.0]:
        said.append(f"particles at scale {scales[0]:g}")
    sizes, whole = (f"{s['sample']['width_mm']:g} x {s['sample']['length_mm']:g} mm" for s in (now, full))
    if sizes != whole:
        said.append(f"sample {sizes} of {whole}")
    for section, key, words in REDUCED:
        if now[section][key] < full[section][key]:
            said.append(f"{words} {now[section][key]:g} mm of {full[section][key]:g} mm")
    (kind, length), (full_kind, full_length) = (travel_words(settings["sliding"]) for settings in (now, full))
    if (kind, length) != (full_kind, full_length):
        said.append(f"{kind} {length} {'of' if kind == full_kind else f'instead of a {full_kind} of'} {full_length}")
    if now["bed"]["ends"] == PERIODIC:
        length = study.runs[0].parameters["derived"]["bed_length_m"]
        said.append(f"bed in a channel of {1000.0 * length:g} mm that closes on itself")
    if now["bed"]["ends"] == WINDOW:
        lengths = sorted({f"{1000.0 * run.parameters['derived']['bed_length_m']:.0f}" for run in study.runs})
        ends = " to ".join(lengths[:: max(len(lengths) - 1, 1)])
        said.append(f"bed in a window of {ends} mm that travels with the sample")
    of_settings = {study.setting_of[run.row]: run.parameters for run in study.runs}
    layers = {setting: parameters["derived"]["layers"] for setting, parameters in of_settings.items()}
    if varies_scale(study):
        said.append(f"layers of particles in the bed: {', '.join(f'{row} {each:.1f}' for row, each in layers.items())}")
    elif thin := {setting: layers[setting] for setting in of_settings if of_settings[setting]["derived"]["thin_bed"]}:
        rows = _named({row: f"{each:.1f}" for row, each in thin.items()}, len(layers))
        said.append(f"fewer than three layers of particles in the bed: {rows}")
    if larger := _beyond_bumps(study):
        rows = _named({row: f"{scale:.3g}, {most:.2g}" for row, (scale, most) in larger.items()}, len(layers))
        said.append(f"{BEYOND_BUMPS}, {'row with scale and limit' if len(larger) <= MOST_NAMED else 'rows'}: {rows}")
    hop = max(run.parameters["derived"]["ramp_hop_m"] for run in study.runs)
    if hop > TOLD_HOP * study.runs[0].parameters["sample"]["length_m"]:
        said.append(f"particles hop off the ramp, up to {1000.0 * hop:.0f} mm at the highest velocity")
    return said


def _named(rows: Mapping[str, str], count: int) -> str:
    """Return rows with what is said of each, or how many of all rows they are where that would be long."""
    if len(rows) > MOST_NAMED:
        return f"{len(rows)} of {count}"
    return ", ".join(f"{row} ({said})" for row, said in rows.items())


def _beyond_bumps(study: Study) -> dict[str, tuple[float, float]]:
    """Return {setting: (particle scale, largest one)} of patterns whose bumps only scaled particles are larger than."""
    found = {}
    for run in study.runs:
        ratio, scale = run.parameters["derived"]["equivalent_size_ratio"], run.parameters["particle"]["scale"]
        if ratio is not None and ratio >= LARGEST_RATIO > ratio / scale:
            found[study.setting_of[run.row]] = (scale, LARGEST_RATIO * scale / ratio)
    return found


def travel_words(sliding: Mapping[str, Any]) -> tuple[str, str]:
    """Return what says how long a study's runs are, and how long: travel in mm, or the duration of the real test."""
    if "test_duration_h" in sliding:
        return "test duration", f"{sliding['test_duration_h']:g} h"
    return "travel", f"{sliding['travel_mm']:g} mm"


def run_columns(run: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the table of runs tells of a run's parameters."""
    derived = run["derived"]
    return {
        "particle_scale": run["particle"]["scale"],
        "layers": derived["layers"],
        "equivalent_size_ratio": derived["equivalent_size_ratio"],
        "particles_about": derived["bed_particles"],
        "time_step_us": derived["time_step_s"] * 1e6,
        "steps_of_first_cycle": derived["first_cycle_steps"],
    }


def simplifications(study: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return (what, how) of what is simpler here than on a machine, besides scale, wear and comparison."""
    settings = study["settings"]
    packings = range_text(list(Counter(study["told"]["replicates"].values()).values()))
    return [
        ("Particles", _particles(study)),
        *_sampling(study),
        (
            "Skirt not counted",
            f"{_ramp(settings['sample'])} leads from the floor on to the sample. It is not "
            "worn and its wear is not counted, but it carries part of the bed: forces include it, wear does not.",
        ),
        (
            "Random packings",
            f"Beds of each setting: {packings}. They differ in their seed alone, and are periodic across the travel"
            f"{ALONG.get(settings['bed']['ends'], '')}. Runs of equal bed share it.",
        ),
    ]


def further_cap(settings: Mapping[str, Any]) -> str:
    """Return how far a node may move in one update, besides what its edges allow."""
    return f"as far as particles fall in {settings['wear']['gap_closing_fraction']:g} of the cycle's duration"


def _ramp(sample: Mapping[str, Any]) -> str:
    """Return what the ramp up to a sample is like."""
    slope, radius = (f"{sample[key]:g}" for key in ("skirt_slope_deg", "skirt_radius_mm"))
    if not sample["skirt_radius_mm"]:
        return f"A ramp of {slope}°"
    return f"A ramp of at most {slope}°, curved by a radius of {radius} mm at top and foot,"


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
    scale = range_text([particle["scale"] for particle in particles], 3)
    moduli = range_text([particle["shear_modulus_pa"] for particle in particles])
    return (
        f"{_shapes(particles)} of {min(diameters):.3g} to {max(diameters):.3g} mm in diameter, {scale} times the real "
        f"ones, in {_number_of_sizes(particles[0])}. {_sizes(particles)}{_stands_for_shape(particles, study)} "
        f"{friction_between(particles)} Contacts are "
        f"softened: shear modulus {moduli} Pa."
    )


def _number_of_sizes(particle: Mapping[str, Any]) -> str:
    count = len(particle["diameters_m"])
    return f"{count} sizes" if count > 1 else "one size"


def _sizes(particles: Sequence[Mapping[str, Any]]) -> str:
    """Return how classes were made of what passes sieves, of true diameters; "" where materials give classes."""
    return "".join(f"True sizes: {told} " for told in dict.fromkeys(each.get("sizes") for each in particles) if told)


def _shapes(particles: Sequence[Mapping[str, Any]]) -> str:
    """Return what the particles of all runs are."""
    names = list(dict.fromkeys(particle[CLUMP]["name"] for particle in particles if CLUMP in particle))
    if not names:
        return "Spheres"
    clumps = f"lumps of spheres ({', '.join(names)}) as large as spheres"
    return f"C{clumps}" if all(CLUMP in particle for particle in particles) else f"Spheres, and c{clumps},"


def _stands_for_shape(particles: Sequence[Mapping[str, Any]], study: Mapping[str, Any]) -> str:
    """Return what is told of shape that is not round."""
    model = study["settings"]["solver"]["rolling_friction"]
    if any(CLUMP in particle for particle in particles):
        return f"Rolling friction ({model}) stands for shape where particles are round."
    return f"Shape that is not round is represented by rolling friction ({model}) alone."


def _sampled_travel(study: Mapping[str, Any]) -> str:
    """Return the travel (mm) between two samples of the contacts; a range where velocities differ."""
    travels = [
        1e3
        * run["solver"]["sampling_interval_steps"]
        * run["derived"]["time_step_s"]
        * run["sliding"]["velocity_m_per_s"]
        for run in study["parameters"].values()
    ]
    return range_text(travels)
