"""Checks of one run that compare several settings, before any solver starts.

Each check returns None, or (key at fault, what is allowed). To add one: a function, listed in the checks of its case;
those of every case and those of a sliding sample are here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from meshes.lattice import pattern_faults
from postproc.wear.caps import GRAVITY
from workflows.config.layers import ConfigError, Layer
from workflows.config.patterns import highest_point, pattern_of
from workflows.config.schema import load_schema
from workflows.config.units import to_si
from workflows.config.validation import allowed_text, locate, show
from workflows.engine.derived import ADAPTIVE, PERIODIC, THIN_BED_LAYERS, WINDOW, window_lengths
from workflows.engine.schedule import LEAST_CYCLE_STEPS
from workflows.engine.templates import DeckError, solver_settings, template_variables

if TYPE_CHECKING:
    from workflows.engine.case import Case

Fault = tuple[str, str]  # key at fault (empty: the row as a whole) and what is allowed

CONTACT_MODEL = "_shared/contact_model"  # template
TINY_FRICTION = 1e-3  # -, of a floor that drives nothing
LARGEST_TRAVEL = 100.0  # m, as the schema has it for sliding.travel_mm
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
            found = f"{show(_value(run, key))}{_for_row(run, key)}"
            raise ConfigError(f"{_where(run, key)} is {found}, allowed is {allowed}.")


def check_needed(
    layers: tuple[Layer, ...], settings: dict[str, Any], schema: dict[str, Any], block: str, keys: list[str]
) -> None:
    """Raise ConfigError if a block of a run's settings lacks one of the keys that its surface needs."""
    for key in (key for key in keys if key not in settings[block]):
        allowed = allowed_text(schema["properties"][block]["properties"][key])
        where = locate(layers, (block,))
        raise ConfigError(f"{where}: {block}.{key} is missing, allowed is {allowed}, which its surface needs.")


def _where(run: CheckedRun, key: str) -> str:
    source = locate(run.layers, tuple(key.split("."))) if _is_setting(run, key) else run.row.where()
    return f"{source}: {key}"


def _value(run: CheckedRun, key: str) -> Any:
    section, _, name = key.rpartition(".")
    values = run.settings if _is_setting(run, key) else run.row.values
    return values[section][name] if section else values[name]


def _for_row(run: CheckedRun, key: str) -> str:
    return f" for row {run.row.values['row']}" if _is_setting(run, key) else ""


def _is_setting(run: CheckedRun, key: str) -> bool:
    """Return whether a key is one of the settings; else it is a column of the row."""
    return "." in key or key not in run.row.values


def millimetres(metres: float) -> str:
    return f"{metres * 1000.0:.6g} mm"


def model_properties_given(run: CheckedRun) -> Fault | None:
    """Every property that the chosen contact, cohesion and rolling models need is given in the solver's section."""
    known = load_schema("settings")["properties"]["solver"]["properties"]
    given = to_si(run.settings["solver"])
    for name, chosen_by in solver_settings(CONTACT_MODEL, words={"solver": given}).items():
        if name not in given:
            key = next(key for key in known if name in to_si({key: 0.0}))
            missing = f"solver.{key} ({allowed_text(known[key])}) is missing"
            return f"solver.{chosen_by}", f"one whose properties stand beside it: {missing}"
    return None


def check_own_words(layers: tuple[Layer, ...], case: Case, words: Mapping[str, Any], decks: Callable[[], Any]) -> None:
    """Raise ConfigError for a word of the user's own that no template of a case uses, or that is one of ours.

    decks: renders a deck of each kind
    """
    if not words:
        return
    bed = (case.bed_template,) if case.bed_template else ()
    templates = (*case.run_templates, *bed, *case.more_templates)
    for word in sorted(set(words).difference(*map(template_variables, templates))):
        raise ConfigError(
            f"{locate(layers, ('deck', word))}: deck.{word} stands in no template, allowed is a word that one of"
            f" {', '.join(templates)} uses."
        )
    try:
        decks()
    except DeckError as fault:
        raise ConfigError(f"{locate(layers, ('deck',))}: {fault}") from None


def sample_in_bed(run: CheckedRun) -> Fault | None:
    """The sample and its skirt on both sides lie within the bed's width."""
    sample, skirt = run.parameters["sample"], run.parameters["derived"]["skirt_width_m"]
    room = run.parameters["bed"]["width_m"] - 2.0 * skirt
    if sample["width_m"] <= room:
        return None
    return (
        "sample.width_mm",
        f"at most {millimetres(room)}, bed.width_mm less a skirt of {millimetres(skirt)} on each side",
    )


def skirt_in_bed(run: CheckedRun) -> Fault | None:
    """The bed is longer than the sample's skirt, ahead of the sample and behind it."""
    skirt = run.parameters["derived"]["skirt_width_m"]
    for key in ("ahead", "behind"):
        if run.parameters["bed"][f"{key}_m"] < skirt:
            return f"bed.{key}_mm", f"at least {millimetres(skirt)}, the width of the sample's skirt"
    return None


def ramp_holds_bed(run: CheckedRun) -> Fault | None:
    """A curved ramp up to the sample is curved so gently that particles follow it: its radius is at least v^2/g."""
    radius, least = (
        run.parameters["sample"]["skirt_radius_m"],
        run.parameters["sliding"]["velocity_m_per_s"] ** 2 / GRAVITY,
    )
    if radius == 0.0 or radius >= least:
        return None
    return (
        "sample.skirt_radius_mm",
        f"at least {millimetres(least)}, velocity squared over gravity, or 0 for a straight ramp",
    )


def floor_drives_bed(run: CheckedRun) -> Fault | None:
    """In a periodic bed the friction of the moving floor exceeds that of the sample and its skirt, which stand still.

    Each carries the weight of the bed above it: mu_floor (L W - A) >= mu_sample A, A the area of sample and skirt.
    """
    bed, sample, skirt = (run.parameters[name] for name in ("bed", "sample", "derived"))
    if bed["ends"] != PERIODIC:
        return None
    covered = math.prod(sample[side] + 2.0 * skirt["skirt_width_m"] for side in ("width_m", "length_m"))
    floor, own = (run.parameters[name]["contact"]["sliding_friction"] for name in ("floor_material", "sample_material"))
    if floor * (bed["width_m"] * skirt["bed_length_m"] - covered) >= own * covered:
        return None
    missing = covered * (floor + own) / max(floor, TINY_FRICTION) / bed["width_m"] - skirt["bed_length_m"]
    return (
        "bed.ahead_mm",
        f"at least {millimetres(bed['ahead_m'] + missing)} with bed.ends: periodic, so that the friction of the floor"
        " exceeds that of the sample and its skirt",
    )


def exchange_holds(run: CheckedRun) -> Fault | None:
    """A window exchanges at least as much bed as the strip that holds the fresh bed is long."""
    bed = run.parameters["bed"]
    if bed["ends"] != WINDOW:
        return None
    least = window_lengths(run.parameters["particle"])[0]
    if bed["exchange_m"] >= least:
        return None
    return (
        "bed.exchange_mm",
        f"at least {millimetres(least)} with bed.ends: window, the length of the strip that is held",
    )


def enough_layers(run: CheckedRun) -> Fault | None:
    """A bed has three layers of particles, unless thin beds are allowed."""
    if run.settings["bed"]["allow_thin_bed"] or not run.parameters["derived"]["thin_bed"]:
        return None
    particle = run.parameters["particle"]
    diameter, scale = particle["median_diameter_m"], particle["scale"]
    return "bed_thickness_mm", (
        f"at least {millimetres(THIN_BED_LAYERS * diameter)}, three layers of particles of {millimetres(diameter)}"
        f" (particle_scale {scale:g}), or bed.allow_thin_bed: true"
    )


def no_particle_between(run: CheckedRun) -> Fault | None:
    """The sample's top is less than a particle's radius above the floor."""
    radius = min(run.parameters["particle"]["diameters_m"]) / 2.0
    if run.parameters["sample"]["height_above_floor_m"] < radius:
        return None
    return (
        "sample.height_above_floor_mm",
        f"below {millimetres(radius)}, the radius of the smallest particle",
    )


def element_resolves_pattern(run: CheckedRun) -> Fault | None:
    """The feet of a pattern are at least two elements across their narrow side.

    Height and depth set no limit: a low bump is a gentle slope, which large elements follow.
    """
    pattern = pattern_of(run.parameters["pattern"])
    if pattern is None:
        return None
    radius = min(pattern.half_width, pattern.half_length)
    if run.parameters["sample"]["element_size_m"] <= radius:
        return None
    return "sample.element_size_mm", f"at most {millimetres(radius)}, the smaller radius of a {pattern.noun}"


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


def pattern_in_bed(run: CheckedRun) -> Fault | None:
    """The bed is thicker than a pattern is high."""
    highest = highest_point(run.parameters["pattern"])
    if highest < run.parameters["bed"]["thickness_m"]:
        return None
    return "bed_thickness_mm", f"above {millimetres(highest)}, the height of the pattern"


def pattern_above_floor(run: CheckedRun) -> Fault | None:
    """A pattern is less deep than the sample's top is above the floor."""
    return deeper_than(run, "height_above_floor")


def deeper_than(run: CheckedRun, length: str) -> Fault | None:
    """Return the fault of a pattern at least as deep as a length of the sample."""
    pattern, room = pattern_of(run.parameters["pattern"]), run.parameters["sample"][f"{length}_m"]
    if pattern is None or pattern.deepest_point < room:
        return None
    return f"sample.{length}_mm", f"above {millimetres(pattern.deepest_point)}, the depth of a {pattern.noun}"


def cycle_long_enough(run: CheckedRun) -> Fault | None:
    """A wear cycle has at least a hundred time steps."""
    steps = _raw_steps(run)
    if steps >= LEAST_CYCLE_STEPS:
        return None
    if run.settings["sliding"]["cycles"] == ADAPTIVE and steps < _raw_steps(run, whole_travel=True):
        return (
            "sliding.first_cycle_mm",
            f"at least {millimetres(_least_travel(run))}, {LEAST_CYCLE_STEPS} time steps",
        )
    most = int(_raw_steps(run, whole_travel=True) / LEAST_CYCLE_STEPS)
    if most < 1:
        return _travel_fault(run, "least", _least_travel(run), f"{LEAST_CYCLE_STEPS} time steps")
    return "sliding.cycles", f"at most {most}, so that a cycle has {LEAST_CYCLE_STEPS} time steps"


def travel_within_reason(run: CheckedRun) -> Fault | None:
    """The travel that a test duration makes is at most 100 m."""
    travel = run.parameters["sliding"]["travel_m"]
    return _travel_fault(run, "most", LARGEST_TRAVEL, "100 m of travel") if travel > LARGEST_TRAVEL else None


def _travel_fault(run: CheckedRun, bound: str, travel: float, reason: str) -> Fault:
    """Return the fault of a travel (m), in terms of the key that the study gives it by."""
    if "test_duration_h" not in run.settings["sliding"]:
        return "sliding.travel_mm", f"at {bound} {millimetres(travel)}, {reason}"
    hours = run.settings["sliding"]["test_duration_h"] * travel / run.parameters["sliding"]["travel_m"]
    return "sliding.test_duration_h", f"at {bound} {hours:.6g} h at this acceleration and velocity, {reason}"


def sampled_in_cycle(run: CheckedRun) -> Fault | None:
    """Contacts are sampled more than once in a cycle, where they are sampled (`ledger: dumps`)."""
    steps = _raw_steps(run)
    if run.settings["ledger"] != "dumps" or run.settings["solver"]["sampling_interval_steps"] < steps:
        return None
    return "solver.sampling_interval_steps", f"below {int(steps)}, the time steps of a cycle"


def _raw_steps(run: CheckedRun, whole_travel: bool = False) -> float:
    """Time steps of the first wear cycle, or of the whole travel, before rounding to whole ones."""
    derived, sliding = run.parameters["derived"], run.parameters["sliding"]
    travel = sliding["travel_m"]
    if not whole_travel:
        adaptive = sliding["cycles"] == ADAPTIVE
        travel = min(sliding["first_cycle_m"], travel) if adaptive else travel / sliding["cycles"]
    return travel / sliding["velocity_m_per_s"] / derived["largest_time_step_s"]


def _least_travel(run: CheckedRun) -> float:
    step = run.parameters["derived"]["largest_time_step_s"]
    return LEAST_CYCLE_STEPS * step * run.parameters["sliding"]["velocity_m_per_s"]


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
    """The shapes of a pattern neither overlap nor leave the sample (meshes.lattice decides)."""
    pattern, sample = pattern_of(run.parameters["pattern"]), run.parameters["sample"]
    if pattern is None:
        return None
    fault = pattern_faults(pattern, sample["width_m"], sample["length_m"])
    return None if fault is None else ("", fault)


COMMON_CHECKS: tuple[Check, ...] = (model_properties_given,)
SLIDING_CHECKS: tuple[Check, ...] = (
    enough_layers,
    pattern_in_bed,
    pattern_fits,
    pattern_above_floor,
    no_particle_between,
    sample_in_bed,
    skirt_in_bed,
    ramp_holds_bed,
    floor_drives_bed,
    exchange_holds,
    element_resolves_sample,
    element_resolves_pattern,
    travel_within_reason,
    cycle_long_enough,
    sampled_in_cycle,
    physical_modulus_known,
)
