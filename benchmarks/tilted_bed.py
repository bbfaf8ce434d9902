"""At which slope does a bed begin to flow, and does it stand before? A layer of grains without walls is tilted slowly,
under each rolling model.

    python -m benchmarks.tilted_bed --cores 2    # in the root of the repository; an hour
    python -m benchmarks.tilted_bed --finished    # of the layers so far
    python -m benchmarks.tilted_bed --redraw

Its grains are those of `benchmarks.rolling_models`, in the source's calibrated pair. Layers stay in `--folder`. Writes
into docs: tilted_bed.csv (every layer; those not asked for stay in it, with the version of the code that tilted them),
figure and tilted_bed_results.md; `--redraw` makes the last two from the first.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from datetime import date
from pathlib import Path
from typing import Any

import pandas as pd

from benchmarks.plots.rolling_models import packings_by_model
from benchmarks.rolling_models import CALIBRATED, SHEAR_BOX, wanted
from benchmarks.rolling_page import MODELS, less
from benchmarks.runs import BY, at_least_one, side_by_side, simulated_by, with_earlier
from bulkwear.postproc.plots.style import save, save_small
from bulkwear.postproc.readers.solver_log import last_step
from bulkwear.postproc.statistics.intervals import UNKNOWN, Estimate, estimate
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.beds import BedMeasure, bed_fault, level_measure, mass_measure
from bulkwear.workflows.engine.decks import primes
from bulkwear.workflows.engine.derived import (
    neighbour_skin,
    rolling_coefficient_for_solver,
    smallest_rayleigh_time,
    youngs_modulus,
)
from bulkwear.workflows.engine.job import Progress
from bulkwear.workflows.engine.provenance import PROVENANCE, code_of_cases, provenance
from bulkwear.workflows.engine.solver import DECK, LOG, executable_of, run_deck
from bulkwear.workflows.report.markdown import bullet, markdown, prose

LENGTH, WIDTH, GRAINS = 8.0, 6.0, 340  # of the layer, in median diameters, and how many grains: some seven deep
HELD = 1.0  # median diameters: grains whose centres lie lower are held
POURED, SETTLED = 12.0, 1.0  # median diameters that grains are poured high, and s in which they come to rest
START, END, RATE = 20.0, 60.0, 1.0  # degrees, degrees, degrees/s
LOOK = 0.1  # s between two looks whether it flows, so the answer has steps of 0.1 degrees
FLOWING = 0.1  # m/s, mean of the grains that are not held
CREEPING = 5.0  # degrees from START in which creep is measured; no layer flows there
MILLIMETRES = 1e3  # per metre
GRAVITY = 9.81  # m/s2
PACKINGS = 5
REFERENCE = "own_spin"  # the studies' own: the others are compared with it
REFUSED = "refused"  # column with the reason why nothing is measured on a layer
KEYS = ["model", "packing"]  # of a row in the table of every layer
TRACE, COLUMNS = "tilt.txt", ("angle_deg", "speed_m_per_s", "mass_kg", "level_m")
CASE = "calibration"  # of the grains, whose code is told in the record
FILE, PAGE, FIGURE = "tilted_bed.csv", "tilted_bed_results.md", "tilted_bed.png"


class TiltError(RuntimeError):
    """A layer did what cannot be measured; the message says what."""


def tilt_deck(test: Mapping[str, Any]) -> str:
    """Return the deck that pours, settles and tilts the layer of a bulk test's grains; it leaves `TRACE`."""
    step = test["solver"]["rayleigh_fraction"] * smallest_rayleigh_time(test["particle"])
    return "\n".join([*_material(test, step), *_poured(test, step), *_tilting(test, step)]) + "\n"


def _look_steps(step: float) -> int:
    return math.ceil(LOOK / step)


def _material(test: Mapping[str, Any], step: float) -> list[str]:
    """Return the lines of domain, contact model and floor; step: s."""
    grain, solver = test["particle"], test["solver"]
    diameter, contact = grain["median_diameter_m"], grain["contact"]
    rolling = rolling_coefficient_for_solver(contact["rolling_friction"], solver, "particle_particle")
    young = youngs_modulus(grain["shear_modulus_pa"], grain["poissons_ratio"])
    model = f"hertz tangential history rolling_friction {solver['rolling_friction']}"
    length, width, top = LENGTH * diameter, WIDTH * diameter, (POURED + 2.0) * diameter
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


def _poured(test: Mapping[str, Any], step: float) -> list[str]:
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
    length, width = LENGTH * diameter, WIDTH * diameter
    return [
        *sizes,
        f"fix sizes all particledistribution/discrete {seeds[1]} {len(sizes)} {shares}",
        f"region fill block 0.0 {length:.9g} 0.0 {width:.9g} {diameter:.9g} {POURED * diameter:.9g} units box",
        f"fix pour all insert/pack seed {seeds[0]} distributiontemplate sizes insert_every once overlapcheck yes"
        f" maxattempt 1000 particles_in_region {GRAINS} region fill",
        f"fix weight all gravity {GRAVITY} vector 0.0 0.0 -1.0",
        "fix motion all nve/sphere",
        "thermo 5000",
        "run 1",
        "unfix pour",
        f"run {_settling_steps(step) - 1}",
    ]


def _settling_steps(step: float) -> int:
    return _look_steps(step) * math.ceil(SETTLED / LOOK)  # looks come at whole multiples


def _tilting(test: Mapping[str, Any], step: float) -> list[str]:
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
        f"variable angle equal {START}+{RATE}*dt*(step-{_settling_steps(step)})",
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
        f"variable look loop {math.ceil((END - START) / RATE / LOOK)}",
        "run 0",
        "label tilting",
        f"run {look} pre no post no",
        f'if "${{speed}} > {FLOWING}" then "jump SELF flows"',
        "next look",
        "jump SELF tilting",
        "label flows",
    ]


def layer_measures(grain: Mapping[str, Any], mass: float, level: float) -> tuple[BedMeasure, BedMeasure]:
    """Return mass and level of a layer of grains at rest, beside those asked; mass: kg, level: m, as found.

    The mass asked is that of `GRAINS` of the grains, the level asked that of the mass found at the bulk density.
    """
    density, area = grain["density_kg_per_m3"], LENGTH * WIDTH * grain["median_diameter_m"] ** 2
    of_each = [density * math.pi / 6.0 * size**3 for size in grain["diameters_m"]]
    mean = 1.0 / sum(share / one for share, one in zip(grain["mass_fractions"], of_each, strict=True))
    height = mass / (density * grain["bulk_solid_fraction"] * area)
    return mass_measure(grain, GRAINS * mean, mass), level_measure(grain, height, level)


def measured(trace: Path, grain: Mapping[str, Any]) -> dict[str, float]:
    """Return flow_angle_deg, at which the layer of a trace first flowed, and creep_mm_per_s: how fast it moves downhill
    before, the median over CREEPING degrees, which slips of a moment do not move; and its level_mm, found and asked.

    Raises TiltError, also where mass or level of the layer are not as asked.
    """
    rows = pd.read_csv(trace, sep=r"\s+")
    angle, speed, mass, level = (rows[name] for name in COLUMNS)
    measures = layer_measures(grain, mass.iloc[0], level.iloc[0])
    if fault := bed_fault(measures):
        raise TiltError(f"{trace}: {fault}.")
    flows = speed > FLOWING
    if not flows.any():
        raise TiltError(f"{trace}: the bed does not flow at {angle.iloc[-1]:.1f} degrees, where the run ends.")
    flow_angle = float(angle[flows.idxmax()])
    if flow_angle < START + CREEPING:
        raise TiltError(
            f"{trace}: the bed flows at {flow_angle:.1f} degrees, before its creep is measured at"
            f" {START:g} to {START + CREEPING:g}."
        )
    creep = float(speed[angle < START + CREEPING].median())
    levels = {"level_mm": MILLIMETRES * measures[1].found, "level_asked_mm": MILLIMETRES * measures[1].asked}
    return {"flow_angle_deg": flow_angle, "creep_mm_per_s": MILLIMETRES * creep} | levels


def tilted(test: Mapping[str, Any], root: Path) -> dict[str, float]:
    """Return what is `measured` on a layer, tilted unless it was before. Raises SolverError, TiltError."""
    deck = tilt_deck(test)
    inputs, kept = state.digest(deck), layer_folder(deck, root)
    if state.finished_cycles(kept, inputs) == 0:
        code = code_of_cases((CASE,))
        with state.working_folder(kept, 0) as folder:
            (folder / DECK).write_text(deck, encoding="utf-8")
            cost = {"solver_s": round(run_deck(folder, executable=executable_of(test)), 3)}
            cost |= {"steps": last_step(folder / LOG), "particles": GRAINS}
            record = {"cost": cost, PROVENANCE: provenance(code, executable_of(test), cost)}
            state.write_state(folder, inputs, (TRACE, LOG), record)
    return measured(state.cycle_folder(kept, 0) / TRACE, test["particle"])


def layer_folder(deck: str, root: Path) -> Path:
    """Return where the layer of a deck is kept."""
    return root / f"tilt_{state.digest(deck)[: state.DIGEST_LETTERS]}"


def is_finished(row: Mapping[str, Any], root: Path) -> bool:
    """Return whether the layer of a row was tilted."""
    deck = tilt_deck(row["asked"])
    return state.finished_cycles(layer_folder(deck, root), state.digest(deck)) > 0


def all_tilted(rows: Sequence[Mapping[str, Any]], root: Path, cores: int, alone: bool = True) -> pd.DataFrame:
    """Return model, packing, what is `measured` of layers, or why it is not (REFUSED), and the version of the code that
    simulated them, up to `cores` of them at the same time.

    alone: waits until nobody else simulates in that folder; else what is finished is read beside them
    """
    name = "tilted bed"
    with state.only_driver(root, Progress(name, 1).say) if alone else nullcontext():
        found = side_by_side(name, rows, lambda row: is_finished(row, root), lambda row: told_of(row, root), cores)
    keys = [{"model": row["model"], "packing": row["packing"]} for row in rows]
    return pd.DataFrame([row | layer for row, layer in zip(keys, found, strict=True)])


def told_of(row: Mapping[str, Any], root: Path) -> dict[str, Any]:
    """Return what is `measured` on the layer of a row, or why it is not, which ends no other layer; and its version."""
    try:
        found: dict[str, Any] = dict(tilted(row["asked"], root))
    except TiltError as fault:
        found = {REFUSED: str(fault).partition(": ")[2]}
    return found | {BY: simulated_by(layer_folder(tilt_deck(row["asked"]), root))}


def angles(runs: pd.DataFrame) -> dict[str, pd.Series]:
    """Return the flow angles (degrees) of each model by packing."""
    of_packings = runs.reindex(columns=[*KEYS, "flow_angle_deg"]).dropna().set_index("packing")
    return {model: of["flow_angle_deg"] for model, of in of_packings.groupby("model", sort=False)}


def means(runs: pd.DataFrame) -> dict[str, Estimate]:
    """Return the mean flow angle (degrees) of each model over its packings."""
    return {model: estimate(of.to_numpy()) for model, of in angles(runs).items()}


def creep_table(runs: pd.DataFrame) -> pd.DataFrame:
    """Return a row per model: its mean creep (mm/s), and that of the slowest and the fastest packing."""
    creep = runs.groupby("model", sort=False)["creep_mm_per_s"]
    return creep.agg(packings="count", creep_mm_per_s="mean", slowest="min", fastest="max").reset_index()


def summary(runs: pd.DataFrame) -> pd.DataFrame:
    """Return a row per model: its mean with interval, and what it is more or less than REFERENCE, with interval."""
    rows, found = [], angles(runs)
    for model, mean in means(runs).items():
        low, high = mean.interval()
        rows.append({"model": model, "packings": mean.packings, "flow_angle_deg": mean.value, "low": low, "high": high})
        if REFERENCE in found and model != REFERENCE:
            apart = less(found[model], found[REFERENCE])
            ends = dict(zip(("less_low", "less_high"), apart.interval(), strict=True))
            rows[-1] |= {"less_reference_deg": apart.value, **ends}
    return pd.DataFrame(rows)


def said_of(model: str, found: pd.Series, reference: pd.Series) -> str:
    """Return in a sentence at what slope a model's bed flows, and whether that is told from the reference's.

    found, reference: degrees, by packing
    """
    mean = estimate(found.to_numpy())
    if not mean.known:
        return f"`{model}`: {mean.value:.1f} degrees ({UNKNOWN})."
    low, high = mean.interval()
    said = f"`{model}`: {mean.value:.1f} degrees (95 %: {low:.1f} to {high:.1f})"
    apart = less(found, reference)
    if found is reference or not apart.known:
        return f"{said}."
    low, high = apart.interval()
    told = "not told from" if low <= 0.0 <= high else f"{apart.value:+.1f} ({low:+.1f} to {high:+.1f}) of"
    return f"{said}, {told} `{REFERENCE}`."


def refused(runs: pd.DataFrame) -> list[str]:
    """Return a sentence for each layer on which nothing is measured."""
    if REFUSED not in runs:
        return []
    return [
        f"`{row.model}`, packing {row.packing}: {row.refused}" for row in runs.dropna(subset=[REFUSED]).itertuples()
    ]


def level_said(runs: pd.DataFrame) -> str:
    """Return in a sentence how deep the layers lie, beside what was asked; nothing of those that did not tell."""
    if "level_mm" not in runs:
        return ""
    low, high = runs["level_mm"].min(), runs["level_mm"].max()
    return f"Layers lie {low:.1f} to {high:.1f} mm deep at rest; asked are {runs['level_asked_mm'].mean():.1f} mm."


def results_page(runs: pd.DataFrame) -> str:
    """Return the page; runs: as from `all_tilted`."""
    found = angles(runs)
    reference = found.get(REFERENCE, next(iter(found.values())))
    parts = [
        "# At which slope does a bed begin to flow?",
        prose(
            "Generated by `python -m benchmarks.tilted_bed`; not to be edited. The models are those of [rolling"
            " friction](rolling_friction.md). [Every layer](tilted_bed.csv)."
        ),
        "\n".join(map(bullet, (*(said_of(model, of, reference) for model, of in found.items()), *refused(runs)))),
        f"![Slope at which a bed flows, by rolling model]({FIGURE})",
        prose(
            f"A layer of {GRAINS} grains, {LENGTH:g} by {WIDTH:g} median diameters, lies on grains that are held, and"
            " is periodic along and across; the material and time steps of [the rolling models]"
            "(rolling_models_results.md), with the source's calibrated pair. After rest it is tilted from"
            f" {START:g} degrees by {RATE:g} degree/s until its grains move downhill at {MILLIMETRES * FLOWING:g} mm/s"
            f" in the mean, looked at every {LOOK * RATE:g} degrees. It has neither walls nor a toe: that is no angle"
            f" of repose, and tells what a model does alone. {level_said(runs)}".rstrip()
        ),
        markdown(summary(runs)),
        "## Does it stand before?",
        prose(
            f"How fast the layer moves downhill while it is tilted from {START:g} to {START + CREEPING:g} degrees: of"
            " each packing the median of all looks, which a slip of a moment does not move; the mean, the least and the"
            " most of the packings."
        ),
        markdown(creep_table(runs)),
    ]
    return "\n\n".join(part.rstrip("\n") for part in parts) + "\n"


def publish(output: Path, runs: pd.DataFrame) -> str:
    """Write figure and page of the layers; return the page."""
    page = results_page(runs)
    (output / PAGE).write_text(page, encoding="utf-8")
    remarks = [
        f"layers of {GRAINS} grains on held ones, periodic; small: packings, large: mean and its 95 % interval",
        f"made by benchmarks/tilted_bed.py, {date.today():%Y-%m-%d}",
    ]
    figure = packings_by_model(runs, "flow_angle_deg", "Slope at which the bed flows (degrees)", means(runs), remarks)
    save(figure, output / FIGURE)
    save_small(output / FIGURE, output / FIGURE)
    return page


def main() -> None:
    """Simulate what is missing, then write table, figure and page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=Path("docs"))
    parser.add_argument("--packings", type=at_least_one, default=PACKINGS, help=f"of each model, else {PACKINGS}")
    parser.add_argument("--models", nargs="+", choices=MODELS, default=MODELS, help="else all")
    parser.add_argument("--folder", type=Path, default=Path("results/benchmarks/full/tilted_bed"))
    parser.add_argument("--cores", type=at_least_one, default=1, help="simulations side by side")
    parser.add_argument("--finished", action="store_true", help="simulate nothing, take what is finished")
    parser.add_argument("--redraw", action="store_true", help="from the table of an earlier run")
    given = parser.parse_args()
    file = given.output / FILE
    given.output.mkdir(parents=True, exist_ok=True)
    if not given.redraw:
        rows = wanted(given.packings, given.models, (SHEAR_BOX,), (CALIBRATED,))
        rows = [row for row in rows if is_finished(row, given.folder)] if given.finished else rows
        if not rows:
            parser.error(f"{given.folder}: no layer asked for is finished; without --finished they are tilted.")
        found = all_tilted(rows, given.folder, given.cores, alone=not given.finished)
        with_earlier(file, found, KEYS).sort_values(KEYS).to_csv(file, index=False, float_format="%.6g")
    elif not file.is_file():
        parser.error(f"{file} is missing, allowed is --redraw where an earlier run has written it.")
    if not means(runs := pd.read_csv(file)):
        parser.error(f"{file}: no layer tells at which slope it flows: {' '.join(refused(runs))}")
    print(publish(given.output, runs), flush=True)


if __name__ == "__main__":
    main()
