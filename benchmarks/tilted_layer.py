"""A layer of grains without walls that is tilted until it flows: its deck, and what is measured on it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from bulkwear.postproc.readers.solver_log import last_step
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.beds import BedMeasure, bed_fault, level_measure, mass_measure
from bulkwear.workflows.engine.decks import primes
from bulkwear.workflows.engine.derived import (
    neighbour_skin,
    rolling_coefficient_for_solver,
    smallest_rayleigh_time,
    youngs_modulus,
)
from bulkwear.workflows.engine.provenance import PROVENANCE, code_of_cases, provenance
from bulkwear.workflows.engine.solver import DECK, LOG, executable_of, run_deck

LENGTH, WIDTH = 8.0, 6.0  # of the layer, in median diameters
HELD = 1.0  # median diameters: grains whose centres lie lower are held
GRAINS, LOWEST, POURED = 340, 1.0, 12.0  # grains, some seven deep; poured from and to, in median diameters
SETTLED = 1.0  # s in which they come to rest
LOOK = 0.1  # s between two looks whether it flows, so under 1 degree/s the answer has steps of 0.1 degrees
FLOWING = 0.1  # m/s, mean of the grains that are not held
CREEPING = 5.0  # degrees from the first one in which creep is measured; no layer flows there
MILLIMETRES = 1e3  # per metre
GRAVITY = 9.81  # m/s2
TRACE, COLUMNS = "tilt.txt", ("angle_deg", "speed_m_per_s", "mass_kg", "level_m")
CASE = "calibration"  # of the grains, whose code is told in the record


@dataclass(frozen=True)
class Tilt:
    """How many grains a layer has, and from where to where (degrees) and how fast (degrees/s) it is tilted."""

    grains: int = GRAINS
    start_deg: float = 20.0
    end_deg: float = 60.0
    rate_deg_per_s: float = 1.0

    @property
    def poured(self) -> float:
        """How high grains are poured from `LOWEST` on, in median diameters: alike loose, however many they are."""
        return LOWEST + (POURED - LOWEST) * self.grains / GRAINS


class TiltError(RuntimeError):
    """A layer did what cannot be measured; the message says what."""


def tilt_deck(test: Mapping[str, Any], tilt: Tilt) -> str:
    """Return the deck that pours, settles and tilts the layer of a bulk test's grains; it leaves `TRACE`."""
    step = test["solver"]["rayleigh_fraction"] * smallest_rayleigh_time(test["particle"])
    return "\n".join([*_material(test, tilt, step), *_poured(test, tilt, step), *_tilting(test, tilt, step)]) + "\n"


def _look_steps(step: float) -> int:
    return math.ceil(LOOK / step)


def _material(test: Mapping[str, Any], tilt: Tilt, step: float) -> list[str]:
    """Return the lines of domain, contact model and floor; step: s."""
    grain, solver = test["particle"], test["solver"]
    diameter, contact = grain["median_diameter_m"], grain["contact"]
    rolling = rolling_coefficient_for_solver(contact["rolling_friction"], solver, "particle_particle")
    young = youngs_modulus(grain["shear_modulus_pa"], grain["poissons_ratio"])
    model = f"hertz tangential history rolling_friction {solver['rolling_friction']}"
    length, width, top = LENGTH * diameter, WIDTH * diameter, (tilt.poured + 2.0) * diameter
    return [
        "units si",
        "atom_style granular",
        "atom_modify map array",
        "boundary p p fm",
        "newton off",
        "communicate single vel yes",
        f"region layer block 0.0 {length:.9g} 0.0 {width:.9g} {-diameter:.9g} {top:.9g} units box",
        "create_box 1 layer",
        f"fix youngs_modulus all property/global youngsModulus peratomtype {young:.9g}",
        f"fix poissons_ratio all property/global poissonsRatio peratomtype {grain['poissons_ratio']}",
        f"fix restitution all property/global coefficientRestitution peratomtypepair 1 {contact['restitution']}",
        f"fix friction all property/global coefficientFriction peratomtypepair 1 {contact['sliding_friction']}",
        f"fix rolling all property/global coefficientRollingFriction peratomtypepair 1 {rolling:.9g}",
        f"pair_style gran model {model}",
        "pair_coeff * *",
        f"neighbor {neighbour_skin(grain):.9g} bin",
        "neigh_modify delay 0",
        f"timestep {step:.9g}",
        f"fix floor all wall/gran model {model} primitive type 1 zplane 0.0",
    ]


def _poured(test: Mapping[str, Any], tilt: Tilt, step: float) -> list[str]:
    """Return the lines that pour the layer and let it come to rest."""
    grain = test["particle"]
    diameter = grain["median_diameter_m"]
    seeds = primes(test["seed"], len(grain["diameters_m"]) + 2)
    shares = " ".join(f"size_{number} {share}" for number, share in enumerate(grain["mass_fractions"]))
    sizes = [
        f"fix size_{number} all particletemplate/sphere {seeds[2 + number]} atom_type 1 density constant"
        f" {grain['density_kg_per_m3']} radius constant {0.5 * size:.9g}"
        for number, size in enumerate(grain["diameters_m"])
    ]
    length, width, low, high = (each * diameter for each in (LENGTH, WIDTH, LOWEST, tilt.poured))
    return [
        *sizes,
        f"fix sizes all particledistribution/discrete {seeds[1]} {len(sizes)} {shares}",
        f"region fill block 0.0 {length:.9g} 0.0 {width:.9g} {low:.9g} {high:.9g} units box",
        f"fix pour all insert/pack seed {seeds[0]} distributiontemplate sizes insert_every once overlapcheck yes"
        f" maxattempt 1000 particles_in_region {tilt.grains} region fill",
        f"fix weight all gravity {GRAVITY} vector 0.0 0.0 -1.0",
        "fix motion all nve/sphere",
        "thermo 5000",
        "run 1",
        "unfix pour",
        f"run {_settling_steps(step) - 1}",
    ]


def _settling_steps(step: float) -> int:
    return _look_steps(step) * math.ceil(SETTLED / LOOK)  # looks come at whole multiples


def _tilting(test: Mapping[str, Any], tilt: Tilt, step: float) -> list[str]:
    """Return the lines that hold the lowest grains and turn gravity about y until the others flow."""
    look = _look_steps(step)
    return [
        "# --- the lowest grains are held; gravity turns about y",
        f"region low block INF INF INF INF INF {HELD * test['particle']['median_diameter_m']:.9g} units box",
        "group held region low",
        "group layer subtract all held",
        "velocity held set 0.0 0.0 0.0",
        "set group held omegax 0.0 omegay 0.0 omegaz 0.0",
        "unfix motion",
        "fix motion layer nve/sphere",
        "unfix weight",
        f"variable angle equal {tilt.start_deg}+{tilt.rate_deg_per_s}*dt*(step-{_settling_steps(step)})",
        f"variable along equal {GRAVITY}*sin(v_angle*PI/180.0)",
        f"variable down equal -{GRAVITY}*cos(v_angle*PI/180.0)",
        f"fix weight all gravity {GRAVITY} vector v_along 0.0 v_down",
        "variable speed equal vcm(layer,x)",
        "variable mass equal mass(all)",
        "variable level equal 2.0*xcm(all,z)",
        "thermo_style custom step atoms ke v_angle v_speed",
        f"thermo {look}",
        f'fix trace all print {look} "${{angle}} ${{speed}} ${{mass}} ${{level}}" file {TRACE} screen no'
        f' title "{" ".join(COLUMNS)}"',
        f"variable look loop {math.ceil((tilt.end_deg - tilt.start_deg) / tilt.rate_deg_per_s / LOOK)}",
        "run 0",
        "label tilting",
        f"run {look} pre no post no",
        f'if "${{speed}} > {FLOWING}" then "jump SELF flows"',
        "next look",
        "jump SELF tilting",
        "label flows",
    ]


def layer_measures(grain: Mapping[str, Any], grains: int, mass: float, level: float) -> tuple[BedMeasure, BedMeasure]:
    """Return mass and level of a layer of grains at rest, beside those asked; mass: kg, level: m, as found.

    The mass asked is that of so many grains, the level asked that of the mass found at the bulk density.
    """
    density, area = grain["density_kg_per_m3"], LENGTH * WIDTH * grain["median_diameter_m"] ** 2
    of_each = [density * math.pi / 6.0 * size**3 for size in grain["diameters_m"]]
    mean = 1.0 / sum(share / one for share, one in zip(grain["mass_fractions"], of_each, strict=True))
    height = mass / (density * grain["bulk_solid_fraction"] * area)
    return mass_measure(grain, grains * mean, mass), level_measure(grain, height, level)


def measured(trace: Path, grain: Mapping[str, Any], tilt: Tilt) -> dict[str, float]:
    """Return flow_angle_deg, at which the layer of a trace first flowed, and creep_mm_per_s: how fast it moves downhill
    before, the median over CREEPING degrees, which slips of a moment do not move; and its level_mm, found and asked.

    Raises TiltError, also where mass or level of the layer are not as asked.
    """
    rows = pd.read_csv(trace, sep=r"\s+")
    angle, speed, mass, level = (rows[name] for name in COLUMNS)
    measures = layer_measures(grain, tilt.grains, mass.iloc[0], level.iloc[0])
    if fault := bed_fault(measures):
        raise TiltError(f"{trace}: {fault}.")
    flows = speed > FLOWING
    if not flows.any():
        raise TiltError(f"{trace}: the bed does not flow at {angle.iloc[-1]:.1f} degrees, where the run ends.")
    flow_angle = float(angle[flows.idxmax()])
    if flow_angle < tilt.start_deg + CREEPING:
        raise TiltError(
            f"{trace}: the bed flows at {flow_angle:.1f} degrees, before its creep is measured at"
            f" {tilt.start_deg:g} to {tilt.start_deg + CREEPING:g}."
        )
    creep = float(speed[angle < tilt.start_deg + CREEPING].median())
    levels = {"level_mm": MILLIMETRES * measures[1].found, "level_asked_mm": MILLIMETRES * measures[1].asked}
    return {"flow_angle_deg": flow_angle, "creep_mm_per_s": MILLIMETRES * creep} | levels


def tilted(test: Mapping[str, Any], tilt: Tilt, root: Path) -> dict[str, float]:
    """Return what is `measured` on a layer, tilted unless it was before. Raises SolverError, TiltError."""
    deck = tilt_deck(test, tilt)
    inputs, kept = state.digest(deck), layer_folder(deck, root)
    if state.finished_cycles(kept, inputs) == 0:
        code = code_of_cases((CASE,))
        with state.working_folder(kept, 0) as folder:
            (folder / DECK).write_text(deck, encoding="utf-8")
            cost = {"solver_s": round(run_deck(folder, executable=executable_of(test)), 3)}
            cost |= {"steps": last_step(folder / LOG), "particles": tilt.grains}
            record = {"cost": cost, PROVENANCE: provenance(code, executable_of(test), cost)}
            state.write_state(folder, inputs, (TRACE, LOG), record)
    return measured(state.cycle_folder(kept, 0) / TRACE, test["particle"], tilt)


def layer_folder(deck: str, root: Path) -> Path:
    """Return where the layer of a deck is kept."""
    return root / f"tilt_{state.digest(deck)[: state.DIGEST_LETTERS]}"


def is_tilted(deck: str, root: Path) -> bool:
    """Return whether the layer of a deck was tilted."""
    return state.finished_cycles(layer_folder(deck, root), state.digest(deck)) > 0
