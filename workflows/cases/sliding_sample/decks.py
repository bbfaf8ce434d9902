"""Words of the decks of a sliding sample: its bed, lowering and run-in, wear cycles, and contacts counted in a bed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bulkwear.postproc.readers.cycle_folders import PACKING
from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.engine.decks import (
    DOMAIN_MARGIN_DIAMETERS,
    STATE_COLUMNS,
    exact_ledger,
    integration,
    material_tables,
    steps,
    symmetric_table,
    travelled,
)
from bulkwear.workflows.engine.derived import ROUNDING, WALLS, WINDOW, neighbour_skin, window_lengths
from bulkwear.workflows.engine.grains import largest_extent
from bulkwear.workflows.engine.neighbour_lists import list_sizes
from bulkwear.workflows.engine.pouring import bulk_density, fill_gap, fill_height, periodic_gap, poured_particles
from bulkwear.workflows.engine.schedule import Span
from bulkwear.workflows.engine.templates import whole_sections

SETTLING_FREE_FALLS = 1.5  # -, times sqrt(2 h/g), of what is poured
PACKING_FREE_FALLS = 7.5  # -, the same for a bed that nothing moves afterwards: after 6 the last grain had tumbled down
LOWERING_FREE_FALLS = 2.5  # -, times sqrt(2 h/g): after 2 the pilot beds had lost 99 % of their kinetic energy
PILE_UP = 3.0  # -, the bed's height where it piles up at a sample, over its thickness; room for it is left
END_WALL_CLEARANCE = 1e-6  # m, between the end walls' upper edge and the domain: a mesh must lie inside it
ID_COLUMNS = range(13, 16)  # of these, counted from 1: mesh, triangle, particle


def settled_bed(bed: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of the deck that fills and settles a bed; `bed` as in design.bed_parameters."""
    particle, floor, step = (bed[name] for name in ("particle", "temporary_floor_m", "time_step_s"))
    settling = steps(SETTLING_FREE_FALLS * math.sqrt(2.0 * _filled(bed) / GRAVITY), step)
    return {
        **integration(bed, step, particle, settling),
        **material_tables(particle, bed["floor_material"], bed["floor_material"], bed),
        **_domain(bed),
        "temporary_floor_m": floor,
        "fill_bottom_m": floor + fill_gap(particle),
        "fill_top_m": floor + _filled(bed),
        "fill_gap_m": fill_gap(particle) if bed["ends"] == WALLS else 0.0,
        **poured_particles(particle, bed["seed"], bed_mass(bed)),
        "settling_steps": settling,
        **({"packing_steps": falling_steps(bed, step, PACKING_FREE_FALLS)} if bed["ends"] == WINDOW else {}),
    }


def bed_mass(bed: Mapping[str, Any]) -> float:
    """Return the mass (kg) of a level bed of the thickness that is asked for."""
    return bulk_density(bed["particle"]) * bed["length_m"] * bed["width_m"] * bed["thickness_m"]


def _filled(bed: Mapping[str, Any]) -> float:
    """Return how far (m) over the temporary floor centres are poured."""
    particle = bed["particle"]
    across, along = periodic_gap(particle), fill_gap(particle) if bed["ends"] == WALLS else periodic_gap(particle)
    area = (bed["width_m"] - 2.0 * across) * (bed["length_m"] - 2.0 * along)
    return fill_height(particle, bed_mass(bed), area)


def lowered_bed(run: Mapping[str, Any], bed: Mapping[str, Any], bed_restart: str) -> dict[str, Any]:
    """Return the parameters of the deck that lowers a settled bed on to the sample and runs it in.

    `run` is Run.parameters, `bed` the bed's, `bed_restart` the path of its restart file as seen from the deck.
    """
    derived = run["derived"]
    step = derived["time_step_s"]
    lowering = falling_steps(bed, step, LOWERING_FREE_FALLS)
    packing = {"bed_packing_file": str(Path(bed_restart).parent / PACKING)} if bed["ends"] == WINDOW else {}
    return {
        **integration(run, step, run["particle"], max(lowering, derived["run_in_steps"])),
        **_of_both(run, bed, cycle=0, steps_before=0),
        "begin": bed_restart,
        "lowering_steps": lowering,
        "end_step": lowering + derived["run_in_steps"],
        **window(run, bed, -lowering, lowering + derived["run_in_steps"], PACKING),
        **packing,
    }


def falling_steps(bed: Mapping[str, Any], time_step: float, free_falls: float) -> int:
    """Return the time steps (of s) in which a bed could fall so many times from its temporary floor to the true one."""
    return steps(free_falls * math.sqrt(2.0 * bed["temporary_floor_m"] / GRAVITY), time_step)


def sliding_sample(run: Mapping[str, Any], bed: Mapping[str, Any], span: Span, run_restart: str) -> dict[str, Any]:
    """Return the parameters of the deck of one wear cycle; arguments as for `lowered_bed`."""
    derived = run["derived"]
    look = wear_interval_steps(run, span) if run["ledger"] == "solver" else 0
    return {
        **integration(run, derived["time_step_s"], run["particle"], span.steps),
        **_of_both(run, bed, span.cycle, derived["run_in_steps"] + span.first_step),
        "begin": run_restart,
        "end_step": span.steps,
        "picture_steps": min(derived["picture_interval_steps"], span.steps),
        "ledger": run["ledger"],
        **LEDGERS[run["ledger"]](run, span),
        **window(run, bed, derived["run_in_steps"] + span.first_step, span.steps, f"../cycle_000/{PACKING}", look),
    }


def bed_contacts(run: Mapping[str, Any], restart: str) -> dict[str, Any]:
    """Return the parameters of the deck that counts contacts in a restart file; arguments as for `lowered_bed`."""
    skin = neighbour_skin(run["particle"])
    return {
        **whole_sections(run),
        "time_step_s": run["derived"]["time_step_s"],
        "skin_m": skin,
        **list_sizes(run, run["particle"], skin),
        **material_tables(run["particle"], run["sample_material"], run["floor_material"], run["derived"]),
        "ends": run["bed"]["ends"],
        "begin": restart,
        "state_columns": f"{STATE_COLUMNS} c_contacts",
    }


def wear_interval_steps(run: Mapping[str, Any], span: Span) -> int:
    """Return the steps between two looks at the wear of a cycle: equal parts of it of about solver.wear_interval_m."""
    parts = max(round(travelled(run, span.steps) / run["solver"]["wear_interval_m"]), 1)
    return math.ceil(span.steps / parts)


def _exact_ledger_of_sample(run: Mapping[str, Any], span: Span) -> dict[str, Any]:
    return exact_ledger(run, wear_interval_steps(run, span))


def _sampled_contacts(run: Mapping[str, Any], span: Span) -> dict[str, Any]:
    """Return what a deck needs to write sampled contacts."""
    from bulkwear.postproc.readers.contacts import (
        CONTACT_COLUMNS,  # slow to import, and every job reads its study first
    )

    columns = range(1, CONTACT_COLUMNS + 1)
    return {
        "contact_columns": " ".join(f"c_wall_contact[{column}]" for column in columns),
        "contact_format": " ".join("%.0f" if column in ID_COLUMNS else "%g" for column in columns),
    }


# Producers of the load ledger -> what their part of the deck is filled with.
LEDGERS = {"solver": _exact_ledger_of_sample, "dumps": _sampled_contacts}


def _domain(bed: Mapping[str, Any]) -> dict[str, float]:
    """Return the box of a bed, long enough for its whole travel and high enough for bulk piling up at a sample."""
    margin = DOMAIN_MARGIN_DIAMETERS * largest_extent(bed["particle"])
    beyond = margin if bed["ends"] == WALLS else 0.0
    return {
        "ends": bed["ends"],
        "half_width_m": bed["width_m"] / 2.0,
        "bed_start_m": bed["start_m"],
        "bed_end_m": bed["start_m"] + bed["length_m"],
        "domain_start_m": bed["start_m"] - beyond,
        "domain_end_m": bed["start_m"] + bed["length_m"] + bed["travel_m"] + beyond,
        "domain_margin_m": margin,
        "domain_top_m": bed["temporary_floor_m"] + max(_filled(bed), PILE_UP * bed["thickness_m"]) + 2.0 * margin,
    }


def end_wall_corners(bed: Mapping[str, Any]) -> tuple[float, float, float]:
    """Return half width, bottom and top (m) of the walls at the bed's ends; they fill the domain's cross-section."""
    domain = _domain(bed)
    return domain["half_width_m"], -0.5 * domain["domain_margin_m"], domain["domain_top_m"] - END_WALL_CLEARANCE


def _of_both(run: Mapping[str, Any], bed: Mapping[str, Any], cycle: int, steps_before: int) -> dict[str, Any]:
    """Return what both sliding decks need: materials, where the bed's ends are, the sample's fix id."""
    coefficient = run["wear"]["accelerated_wear_coefficient_per_pa"]
    return {
        **material_tables(run["particle"], run["sample_material"], run["floor_material"], run["derived"]),
        "finnie_coefficient_per_pa": symmetric_table([coefficient] * 3),
        "velocity_m_per_s": run["sliding"]["velocity_m_per_s"],
        "cycle": cycle,
        **_ends(bed, travelled(run, steps_before)),
    }


def _ends(bed: Mapping[str, Any], ahead: float) -> dict[str, Any]:
    """Return where the walls at the bed's ends are when it has travelled so far (m); a periodic bed has none."""
    if bed["ends"] != WALLS:
        return {"ends": bed["ends"]}
    return {
        "ends": bed["ends"],
        "upstream_end_m": bed["start_m"] + ahead,
        "downstream_end_m": bed["start_m"] + bed["length_m"] + ahead,
        "end_wall_file": "../end_wall.stl",
    }


def window(
    run: Mapping[str, Any], bed: Mapping[str, Any], steps_before: int, steps: int, packing: str, look: int = 0
) -> dict[str, Any]:
    """Return what the travelling window needs in a deck (SI); nothing where there is none.

    steps_before: of the bed in motion, before the deck's step 0; steps: of the deck; packing: path of its file
    look: steps between two looks at the wear inside the deck, 0: none
    """
    if bed["ends"] != WINDOW:
        return {}
    strip, clearance = window_lengths(bed["particle"])
    per_step = run["sliding"]["velocity_m_per_s"] * run["derived"]["time_step_s"]
    every = max(int(run["bed"]["exchange_m"] / per_step * (1.0 + ROUNDING)), 1)
    return {
        "face_m": bed["start_m"] + clearance,
        "strip_length_m": strip,
        "clearance_m": clearance,
        "period_m": bed["length_m"],
        "packing_file": packing,
        "travel_per_step_m": per_step,
        "steps_before": steps_before,
        "exchange_steps": [*exchange_steps(steps_before, steps, every, look), steps + 1],
    }


def exchange_steps(steps_before: int, steps: int, every: int, look: int = 0) -> list[int]:
    """Return the steps of a deck at which a window exchanges bed: every so many of the bed in motion, from its start.

    The deck begins after `steps_before` steps of the bed in motion, less than none where it is set in motion within it.
    What falls on a look at the wear (every `look` steps, 0: none) is done one step later: a run that ended with a look
    would take it for the ledger of the whole cycle. An exchange at the deck's first instant is of the deck before.
    """
    first = max(-(-(steps_before + 1) // every), 0) * every - steps_before
    return [step + (look > 0 and step < steps and step % look == 0) for step in range(first, steps + 1, every)]
