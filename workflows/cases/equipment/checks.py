"""Checks of a run of equipment that need no drawing: parts, wear, what is predicted, and what it would take."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from typing import Any

from bulkwear.postproc.wear.coefficient import DIMENSIONLESS, PER_PA
from bulkwear.postproc.wear.laws import LAWS
from bulkwear.workflows.cases.equipment.change_out import REMAINING, RULES, asked_by, rule_of, settings_key
from bulkwear.workflows.cases.equipment.motion_checks import COUNTED_MOTION_CHECKS, MOTION_CHECKS
from bulkwear.workflows.cases.equipment.parameters import REPORTS, SECONDS_PER_HOUR, most_blocks, start_up_blocks
from bulkwear.workflows.cases.equipment.placing import largest_diameter
from bulkwear.workflows.cases.equipment.room_checks import ROOM_CHECKS, T_PER_H
from bulkwear.workflows.config.law_settings import parameters_schema
from bulkwear.workflows.config.run_checks import (
    Check,
    CheckedRun,
    Fault,
    millimetres,
    patch_too_wide,
    physical_modulus_known,
)
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.config.validation import allowed_text
from bulkwear.workflows.engine.derived import whole_steps
from bulkwear.workflows.engine.pouring import particles_of_mass

LONGEST_NAME = 100  # letters of a part's or an outlet's name: texts of the solver hold 200, with a word of its own
LEAST_PATCH_DIAMETERS = 2.5  # of an area patch, in median particles: a smaller one is hit by single particles
SHORTEST_BLOCK_CONTACTS = 10.0  # of a block, in contacts of the largest particles: what is shorter counts single hits
IMPACT_VELOCITY = 1.0  # m/s, of such a contact; its time depends on the fifth root of it
HERTZ_TIME = 2.87  # -, of the time that an elastic impact of spheres takes (Johnson, Contact Mechanics, 1985, 11.24)
FEWEST_PARTICLES = 10.0  # that come in within a block, or that a machine is filled with: fewer tell nothing of wear
MOST_FOR_PICTURES = 1.25  # -, time steps of a block, over those that it has without pictures
LEFT_TO_WEAR = 0.01  # -, of its thickness, that a liner may wear before it is changed: of less no hours can be told
LONGEST_OPERATION = 500_000.0  # h, as of operation.duration_h
MOST_STEPS = 50_000_000  # of a run: with ten thousand particles they take a core about a week
MOST_PARTICLES = 20_000_000  # in a machine: some 20 GB of memory
CHANGE_OUT = tuple(map(settings_key, RULES))  # keys of the operation and of parts
HOW_IT_WEARS = (PER_PA, DIMENSIONLESS, "wear_coefficient_error", "law", "parameters", *CHANGE_OUT)  # keys of a part


def summed_by_the_solver(run: CheckedRun) -> Fault | None:
    """The ledger is the solver's, which is what the decks are written for."""
    return None if run.settings["ledger"] == "solver" else ("ledger", "solver for equipment")


# ---------------------------------------------------------------- parts


def names_short_enough(run: CheckedRun) -> Fault | None:
    """The names of parts and outlets are as short as the solver needs them."""
    for section in ("parts", "outlets"):
        for name in run.settings.get(section) or {}:
            if len(name) > LONGEST_NAME:
                return f"{section}.{name}", f"a name of at most {LONGEST_NAME} letters, found {len(name)}"
    return None


def some_part_wears(run: CheckedRun) -> Fault | None:
    """A part wears."""
    if any(part["wears"] for part in run.parameters["parts"]):
        return None
    return "parts", "one part or more with role: wears, found none"


def bodies_named_once(run: CheckedRun) -> Fault | None:
    """No body of a file is two parts, one of them perhaps with all bodies: it would press on particles twice."""
    seen: dict[str, list[Mapping[str, Any]]] = {}
    for part in run.parameters["parts"]:
        file = os.path.normpath(part["file"])
        for other in seen.setdefault(file, []):
            named = {part.get("solid"), other.get("solid")}
            if len(named) == 1 and (None not in named or part["motion"] == other["motion"]):
                key = "file" if None in named else "solid"
                return f"parts.{part['name']}.{key}", f"a {key} of its own, that one is parts.{other['name']}"
            if len(named) == 2 and None in named:
                whole, single = (part, other) if "solid" not in part else (other, part)
                return f"parts.{whole['name']}.file", (
                    f"a file of its own, or parts.{whole['name']}.solid, the body that is meant: without it all bodies"
                    f" are, and solid {single['solid']} is parts.{single['name']} already"
                )
        seen[file].append(part)
    return None


def rigid_parts_do_not_wear(run: CheckedRun) -> Fault | None:
    """A part that keeps its shape has nothing that says how it wears, unless a design asks for both of it."""
    for name, part in run.settings["parts"].items():
        given = next((key for key in HOW_IT_WEARS if key in part), None)
        if part["role"] == "rigid" and given and f"parts.{name}.role" not in run.columns:
            return f"parts.{name}.{given}", "none for a part with role: rigid, which does not wear, or role: wears"
    return None


def thin_phrase(thickness: float, source: str) -> str:
    """Return which edges are allowed on a liner of that thickness (m), and why."""
    reason = "a liner that is thinner than an element would be worn through in a few updates"
    return f"at most {millimetres(thickness)}, {source}: {reason}"


def liner_thicker_than_elements(run: CheckedRun) -> Fault | None:
    """A liner is at least as thick as its elements are long: an update may take a good part of an edge."""
    for part in run.parameters["parts"]:
        if part["wears"] and part.get("thickness_m", math.inf) < part["edge_m"]:
            return f"parts.{part['name']}.edge_mm", thin_phrase(part["thickness_m"], "its thickness_mm")
    return None


# ---------------------------------------------------------------- wear and operation


def wear_as_predicted(run: CheckedRun) -> Fault | None:
    """Wear is not accelerated: an update stands for hours of operation; parts have their own thickness."""
    wear = run.settings["wear"]
    if wear["acceleration"] != 1.0:
        return "wear.acceleration", "1: each update of the surface stands for hours of operation"
    if "local_thickness_mm" in wear:
        return "wear.local_thickness_mm", "none: each part has a thickness_mm of its own, or its drawing's"
    return None


def walls_of_one_patch(run: CheckedRun) -> Fault | None:
    """One factor leads from simulated to physical contacts of all parts that wear: their walls have the same moduli."""
    worn = [run.parameters["walls"][part["type"] - 2] for part in run.parameters["parts"] if part["wears"]]
    moduli = {(wall["shear_modulus_pa"], wall["poissons_ratio"]): wall["name"] for wall in worn}
    if run.settings["wear"]["patch"] != "physical" or len(moduli) < 2:
        return None
    first, second = list(moduli.values())[:2]
    return "wear.patch", (
        f"none, simulated or radius where parts that wear have walls of different moduli, as {first} and {second}: the "
        "factor from simulated to physical contacts is one for all of them"
    )


def updates_deform(run: CheckedRun) -> Fault | None:
    """A shape that is updated may change."""
    most = run.parameters["updates"]["most"]
    if not most or run.settings["wear"]["deform"]:
        return None
    return "wear.deform", f"true where the shape is updated (updates.most: {most}), or updates.most: 0"


def parameters_are_the_law_s(run: CheckedRun) -> Fault | None:
    """What a part gives its wear law is a parameter of that law, within its range."""
    for part in run.parameters["parts"]:
        known = parameters_schema(part["law"])["properties"]
        for key, value in run.settings["parts"][part["name"]].get("parameters", {}).items():
            place = f"parts.{part['name']}.parameters.{key}"
            if key not in known:
                allowed = f"one of {', '.join(known)}" if known else "none"
                return place, f"{allowed}: what the law {part['law']} takes"
            if not known[key]["minimum"] <= value <= known[key]["maximum"]:
                return place, allowed_text(known[key])
    return None


def laws_have_parameters(run: CheckedRun) -> Fault | None:
    """Each part's wear law finds its parameters: with the part, in wear.beside, or, of wear.law, in wear.parameters."""
    for part in run.parameters["parts"]:
        if part["wears"] and not _has_parameters(part):
            law, own = run.settings["wear"]["law"], run.settings["parts"][part["name"]].get("law")
            without = [name for name, each in LAWS.items() if not each.parameters]
            return (f"parts.{part['name']}.law" if own else "wear.law"), (
                f"wear.law ({law}), whose parameters stand in wear.parameters, one of wear.beside with its own, one"
                f" whose parameters all stand in parts.{part['name']}.parameters, or one without any:"
                f" {', '.join(without)}"
            )
    return None


def _has_parameters(part: Mapping[str, Any]) -> bool:
    """Return whether all parameters of a part's law are there, each within its range."""
    given = part["law_parameters"]
    ends = [
        {each.name: each.lowest for each in LAWS[part["law"]].parameters},
        {each.name: each.highest for each in LAWS[part["law"]].parameters},
    ]
    lowest, highest = map(to_si, ends)
    return all(name in given and low <= given[name] <= highest[name] for name, low in lowest.items())


def operation_within_reason(run: CheckedRun) -> Fault | None:
    """Hours of operation are a block or more, by which they are told, and megatonnes take no more than may be given."""
    operation, hours = run.parameters["operation"], run.parameters["derived"]["operation_s"] / SECONDS_PER_HOUR
    block_h = run.parameters["sampling"]["block_s"] / SECONDS_PER_HOUR
    if hours < block_h:
        if "throughput_kg" not in operation:
            return "operation.duration_h", f"at least {block_h:.3g} h, a block (sampling.block_s)"
        least = run.settings["operation"]["throughput_mt"] * block_h / hours
        return "operation.throughput_mt", f"at least {least:.3g} Mt, a block (sampling.block_s) at inlet.rate_t_per_h"
    if "throughput_kg" not in operation or hours <= LONGEST_OPERATION:
        return None
    most = run.settings["operation"]["throughput_mt"] * LONGEST_OPERATION / hours
    return "operation.throughput_mt", f"at most {most:.3g} Mt, {LONGEST_OPERATION:g} h at inlet.rate_t_per_h"


def fed_what_is_predicted(run: CheckedRun) -> Fault | None:
    """Megatonnes are those of a feed."""
    if "throughput_kg" not in run.parameters["operation"] or run.parameters["inlet"]:
        return None
    return "operation.throughput_mt", "operation.duration_h in its place where there is no inlet to count tonnes at"


def one_change_out_rule(run: CheckedRun) -> Fault | None:
    """A liner is changed by one rule."""
    sections = {"operation": run.settings["operation"]}
    sections |= {f"parts.{name}": part for name, part in run.settings["parts"].items()}
    for name, section in sections.items():
        if len(given := [key for key in CHANGE_OUT if key in section]) > 1:
            return f"{name}.{given[1]}", f"one rule of change-out, {name}.{given[0]} is there already"
    return None


def liner_left_to_wear(run: CheckedRun) -> Fault | None:
    """What remains of a liner when it is changed leaves a hundredth of its thickness at least to wear."""
    given = [part for part in run.parameters["parts"] if part["wears"] and "thickness_m" in part]
    for part in sorted(given, key=lambda each: each["thickness_m"]):
        remaining = rule_of(run.parameters["operation"], part).get(REMAINING, 0.0)
        if remaining > (most := (1.0 - LEFT_TO_WEAR) * part["thickness_m"]):
            key = f"{asked_by(part['name'], part)}.{settings_key(REMAINING)}"
            least = f"parts.{part['name']}.thickness_mm"
            return key, f"at most {millimetres(most)}, of {least} all but a hundredth"
    return None


# ---------------------------------------------------------------- what it takes


def patches_large_enough(run: CheckedRun) -> Fault | None:
    """Area patches are two and a half median particles or more, and an element of what wears or more."""
    median = LEAST_PATCH_DIAMETERS * run.parameters["particle"]["median_diameter_m"]
    edges = {part["edge_m"]: f"parts.{part['name']}.edge_mm" for part in run.parameters["parts"] if part["wears"]}
    least, reason = max(
        (median, f"{LEAST_PATCH_DIAMETERS:g} median particles, as coarse-grained"),
        (max(edges), edges[max(edges)]),
    )
    if run.parameters["sampling"]["patch_m"] >= least:
        return None
    return "sampling.patch_mm", f"at least {millimetres(least)}, {reason}"


def contacts_within_patches(run: CheckedRun) -> Fault | None:
    """A patch of a contact whose radius is given is no wider than the area patches that lives are told of."""
    reason = "half of sampling.patch_mm: a wider patch spreads the wear of each contact over several of those areas"
    return patch_too_wide(run, 0.5 * run.parameters["sampling"]["patch_m"], reason)


def blocks_in_order(run: CheckedRun) -> Fault | None:
    """The most blocks are not fewer than the fewest."""
    sampling = run.parameters["sampling"]
    if sampling["fewest_blocks"] <= sampling["most_blocks"]:
        return None
    return "sampling.fewest_blocks", f"at most {sampling['most_blocks']}, sampling.most_blocks"


def blocks_see_particles(run: CheckedRun) -> Fault | None:
    """A block of a machine that is fed sees some particles come in, a machine that is filled holds some."""
    inlet, filling = run.parameters["inlet"], run.parameters["filling"]
    few, least = f"{FEWEST_PARTICLES:g} particles", FEWEST_PARTICLES
    if filling:
        found = run.parameters["derived"]["held_particles"]
        return None if inlet or found >= least else ("filling.fraction", f"{few} or more, found {found:.2g}")
    rate = inlet["rate_kg_per_s"]
    found = particles_of_mass(run.parameters["particle"], rate * run.parameters["sampling"]["block_s"])
    if found >= least:
        return None
    return "inlet.rate_t_per_h", (
        f"at least {T_PER_H * rate * least / found:.3g} t/h, {few} in a block, found {found:.2g}; or a longer"
        " sampling.block_s"
    )


def blocks_long_enough(run: CheckedRun) -> Fault | None:
    """A block is longer than some contacts of particles."""
    least = SHORTEST_BLOCK_CONTACTS * contact_time(run.parameters)
    if run.parameters["sampling"]["block_s"] >= least:
        return None
    return "sampling.block_s", f"at least {least:.2g} s, {SHORTEST_BLOCK_CONTACTS:g} contacts of the largest particles"


def contact_time(parameters: Mapping[str, Any]) -> float:
    """Return the time (s) that two of the largest particles touch when they meet at 1 m/s, by Hertz."""
    particle, radius = parameters["particle"], 0.5 * largest_diameter(parameters)
    mass = particle["density_kg_per_m3"] * math.pi / 6.0 * (2.0 * radius) ** 3
    modulus = 0.5 * parameters["derived"]["youngs_moduli_pa"][0] / (1.0 - particle["poissons_ratio"] ** 2)
    return HERTZ_TIME * ((0.5 * mass) ** 2 / (0.5 * radius * modulus**2 * IMPACT_VELOCITY)) ** 0.2


def pictures_divide_a_block(run: CheckedRun) -> Fault | None:
    """Pictures are at equal steps, as rows of the flow's table are: their number makes time steps hardly shorter."""
    derived = run.parameters["derived"]
    steps, needed = derived["first_cycle_steps"], derived["largest_time_step_s"]
    alone, _ = whole_steps(run.parameters["sampling"]["block_s"], needed, REPORTS)
    if steps <= MOST_FOR_PICTURES * alone:
        return None
    return "sampling.pictures_per_block", (
        f"a number that divides {REPORTS}, or another one that makes no more than {MOST_FOR_PICTURES * alone:.4g} time"
        f" steps of a block, as this makes {steps}"
    )


def steps_within_reason(run: CheckedRun) -> Fault | None:
    """A run has fewer time steps than take weeks."""
    derived, blocks = run.parameters["derived"], most_blocks(run.parameters)
    steps, block_s = derived["run_in_steps"] + derived["travel_steps"], run.parameters["sampling"]["block_s"]
    if steps <= MOST_STEPS:
        return None
    finest = 1e3 * min(run.parameters["particle"]["diameters_m"])
    found = (
        f"it takes {steps:.2g} time steps of {derived['time_step_s']:.2g} s, by its particles of {finest:.3g} mm, at"
        f" most {MOST_STEPS:.2g} are allowed"
    )
    starting = start_up_blocks(run.parameters)
    left = MOST_STEPS / derived["first_cycle_steps"] - (blocks - starting)
    if 2 * starting > blocks and left >= 2.0:
        return "start_up.most_s", f"at most {math.floor(left) * block_s:.4g} s: {found}"
    most = block_s * MOST_STEPS / steps
    return "sampling.block_s", f"at most {most:.2g} s in up to {blocks} blocks: {found}"


def particles_within_reason(run: CheckedRun) -> Fault | None:
    """A machine holds fewer particles than fit into a computer's memory."""
    held, scale = run.parameters["derived"]["held_particles"], run.parameters["particle"]["scale"]
    if held <= MOST_PARTICLES:
        return None
    least = scale * (held / MOST_PARTICLES) ** (1.0 / 3.0)
    found = f"a filling, and what comes in within half of start_up.most_s, are about {held:.2g} particles"
    return "particle_scale", f"at least {least:.3g}: {found}, {MOST_PARTICLES:.2g} fit into memory"


EQUIPMENT_CHECKS: tuple[Check, ...] = (
    summed_by_the_solver,
    names_short_enough,
    some_part_wears,
    bodies_named_once,
    rigid_parts_do_not_wear,
    *MOTION_CHECKS,
    *ROOM_CHECKS,
    liner_thicker_than_elements,
    wear_as_predicted,
    updates_deform,
    parameters_are_the_law_s,
    laws_have_parameters,
    physical_modulus_known,
    walls_of_one_patch,
    fed_what_is_predicted,
    operation_within_reason,
    one_change_out_rule,
    liner_left_to_wear,
    patches_large_enough,
    contacts_within_patches,
    blocks_in_order,
    blocks_long_enough,
    *COUNTED_MOTION_CHECKS,
    blocks_see_particles,
    pictures_divide_a_block,
    steps_within_reason,
    particles_within_reason,
)
