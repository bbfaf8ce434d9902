"""How far time step and softness of particles can go before wear changes by 2 %: a small bed slides round a channel,
over a plain sample, and with each time step over a convex one as well, whose front ends particles strike.

    python -m benchmarks.time_step_and_stiffness --output docs        # in the root of the repository
    python -m benchmarks.time_step_and_stiffness --output docs --redraw

Every packing (a seed) slides over the plain sample once with each time step, at the modulus of the studies, and once
with each modulus, at the Rayleigh fraction of the studies; over the convex one with each time step. Packings are done
one after another until `--minutes` of processor time are spent; started again it goes on where it was. Writes
time_step_and_stiffness.csv (every run), .png and .md; `--redraw` makes the last two from the first.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from benchmarks.changes import BEYOND, FAILED, WITHIN, changes
from benchmarks.plots.figures import Panel, deviation_figure
from benchmarks.runs import FIRST_SEED, PUBLISHED_PAIR, SMALL_BUMPS, changed
from bulkwear.postproc.mesh import PLAIN, write_surface
from bulkwear.postproc.plots.style import save
from bulkwear.workflows.config.design import Run, load_study
from bulkwear.workflows.config.packings import SEED_SPACING
from bulkwear.workflows.engine.chain import Chain
from bulkwear.workflows.engine.cycles import fill_bed, run_chain
from bulkwear.workflows.engine.solver import SolverError
from bulkwear.workflows.report.markdown import bullet, prose

STUDY, ROW = "demo", "R9"
CONVEX = "convex"
BED_THICKNESS = 0.022  # m: four layers, because only the lowest wear the sample
ELEMENT_SIZE = 0.005  # m, of the plain sample, coarser than studies allow: the sum over the sample is all that counts
VELOCITY = 2.0  # m/s, the fastest of the study `screening`
FRACTION, MODULUS = 0.2, 7.0e7  # -, Pa: of filling the beds, and of runs that vary the other one
MINUTES = 60.0  # of processor time
MOST_PACKINGS = 12
PERCENT = 100.0
LIMIT = 0.02  # -, change of wear that matters
SOURCE_STEP = 5e-6  # s (Yan 2022, section 3.4)
CASE = {
    **SMALL_BUMPS,
    "fidelity": "quick",
    "particle_scale": 2.0,
    "sample": {
        **{"width_mm": 60, "length_mm": 60, "element_size_mm": 2.0},
        **{"height_above_floor_mm": 0.05, "skirt_radius_mm": 0},
    },
    "bed": {"material": PUBLISHED_PAIR, "ends": "periodic", "width_mm": 80, "ahead_mm": 50, "behind_mm": 30},
    "sliding": {"run_in_mm": 200, "travel_mm": 1000, "cycles": 2},
    "wear": {"acceleration": 1.0, "deform": False},
    "solver": {"rolling_friction": "cdt", "picture_interval_mm": 100, "wear_interval_mm": 50},
}
FRACTIONS = (
    0.07,
    0.14,
    0.2,
    0.3,
    0.4,
    0.6,
    0.8,
    1.0,
    1.25,
)  # -, time step over the Rayleigh time of the smallest particle
# Pa -> time step over the Rayleigh time, larger where steps are very short. LIGGGHTS takes no Young's modulus below
# 5 MPa; the last is that of the stone (config/materials.yaml).
MODULI = {**dict.fromkeys((2.5e6, 7.0e6, 2.0e7, 7.0e7, 2.8e8), FRACTION), 2.8e9: 0.4, 3.1e10: 0.4}


@dataclass(frozen=True)
class Variant:
    """A way to simulate a packing: Rayleigh fraction (-), shear modulus of the particles (Pa), seed of the packing, and
    the sample's surface.
    """

    fraction: float
    modulus: float
    seed: int
    surface: str = PLAIN

    @property
    def folder(self) -> str:
        """Name of its folder."""
        ending = "" if self.surface == PLAIN else f"_{self.surface}"
        return f"seed_{self.seed}/fraction_{self.fraction:g}_modulus_{self.modulus:g}{ending}"


def variants(seed: int) -> list[Variant]:
    """Return all variants of a packing, cheap ones first."""
    found = {Variant(fraction, MODULUS, seed) for fraction in FRACTIONS}
    found |= {Variant(fraction, modulus, seed) for modulus, fraction in MODULI.items()}
    found |= {Variant(fraction, MODULUS, seed, CONVEX) for fraction in FRACTIONS}
    return sorted(found, key=lambda each: math.sqrt(each.modulus) / each.fraction)


def with_derived(run: Run, fraction: float, modulus: float, seed: int) -> Run:
    """Return the run with that Rayleigh fraction, shear modulus and packing, whatever the configuration allows."""
    change = {
        "bed": {"thickness_m": BED_THICKNESS, "seed": seed},
        **({"sample": {"element_size_m": ELEMENT_SIZE}} if run.surface == PLAIN else {}),
        "particle": {"shear_modulus_pa": modulus},
        "sliding": {"velocity_m_per_s": VELOCITY},
        "solver": {"rayleigh_fraction": fraction},
    }
    return changed(run, change)


def chain_of(variant: Variant, folder: Path) -> Chain:
    """Return the chain of a variant; its surface is made and its bed filled unless that was done before.

    All variants of a packing start from the bed that was filled with one time step and modulus: the same
    particles.
    """
    study = load_study(STUDY, overrides=CASE)
    run = with_derived(study.run(f"{ROW}_{variant.surface}"), variant.fraction, variant.modulus, variant.seed)
    at_rest = [with_derived(study.run(f"{ROW}_{each}"), FRACTION, MODULUS, variant.seed) for each in (PLAIN, CONVEX)]
    (bed,) = study.case.beds(at_rest)[0].values()  # settled above the bumps
    bed_folder = folder / f"seed_{variant.seed}" / "bed"
    if not (bed_folder / "cost.csv").exists():
        fill_bed(study.case, "bed", bed, bed_folder)
    surface = folder / f"{variant.surface}.vtu"
    if not surface.exists():
        write_surface(surface, study.case.surface_mesh(run.parameters))
    place = folder / variant.folder
    place.mkdir(parents=True, exist_ok=True)
    return Chain(variant.folder, place, study.case, run.parameters, surface, bed, bed_folder / "bed.restart")


def row_of(variant: Variant, folder: Path) -> dict[str, float]:
    """Return what a variant found, simulated unless that was done before; NaN where the solver failed."""
    chain, failed = chain_of(variant, folder), folder / variant.folder / "failed.txt"
    done = folder / variant.folder / "wear.csv"
    if not done.exists() and not failed.exists():
        try:
            run_chain(chain)
        except SolverError as fault:
            failed.write_text(str(fault))
    derived = chain.parameters["derived"]
    row = {
        "seed": variant.seed,
        "surface": variant.surface,
        "rayleigh_fraction": variant.fraction,
        "shear_modulus_pa": variant.modulus,
        "time_step_s": derived["time_step_s"],
        "particles": pd.read_csv(chain.bed_restart.with_name("cost.csv"))["particles"].iloc[0],
        "travel_m": chain.parameters["sliding"]["travel_m"],
    }
    if failed.exists():
        return row
    wear, cost = pd.read_csv(done), pd.read_csv(folder / variant.folder / "cost.csv")
    return row | {
        "sliding_work_J": wear["sliding_work_J"].sum(),
        "first_half_sliding_work_J": wear["sliding_work_J"].iloc[0],
        "mean_normal_force_N": wear["mean_normal_force_N"].mean(),
        "bed_over_floor_velocity": wear["bed_over_floor_velocity"].mean(),
        "processor_s": cost["processor_s"].sum(),
    }


def rows(folder: Path, minutes: float, packings: int) -> Iterator[dict[str, float]]:
    """Give the row of one variant after the other, packing by packing, until the processor time (min) is spent."""
    spent = 0.0
    for seed in range(FIRST_SEED, FIRST_SEED + SEED_SPACING * packings, SEED_SPACING):
        for variant in variants(seed):
            if spent > 60.0 * minutes and not (folder / variant.folder / "wear.csv").exists():
                return
            row = row_of(variant, folder)
            spent += row.get("processor_s", 0.0)
            yield row


def answers(table: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Return what time steps change, also over the convex sample, and what moduli; wear per metre in J, times in s.

    What each is compared with, the smallest time step and the stiffest particle, comes first.
    """
    plain, usual = table["surface"] == PLAIN, table["shear_modulus_pa"] == MODULUS
    of_modulus = table["rayleigh_fraction"] == table["shear_modulus_pa"].map(MODULI)
    kept = {
        "rayleigh_fraction": ("rayleigh_fraction", plain & usual),
        CONVEX: ("rayleigh_fraction", ~plain & usual),
        "shear_modulus_pa": ("shear_modulus_pa", plain & of_modulus),
    }
    found = {}
    for name, (column, chosen) in kept.items():
        runs = table[chosen]
        wear, stiffness = runs["sliding_work_J"] / runs["travel_m"], column == "shear_modulus_pa"
        done = runs.loc[wear.notna(), column]
        told = changes(runs[column], wear, runs["seed"], done.max() if stiffness else done.min(), LIMIT)
        means = runs.groupby(column)[["time_step_s", "processor_s"]].mean().reset_index(names="value")
        found[name] = told.merge(means, on="value").sort_values("value", ascending=not stiffness, ignore_index=True)
    return found


def source_fraction() -> float:
    """Return the source's time step over the Rayleigh time of the smallest particle of real size (-)."""
    particle = load_study(STUDY, overrides=CASE | {"particle_scale": 1.0}).run(f"{ROW}_{PLAIN}").parameters["derived"]
    return SOURCE_STEP / particle["rayleigh_time_s"]


def setting(table: pd.DataFrame) -> str:
    """Return in one phrase what was simulated."""
    bed, sample, first = CASE["bed"], CASE["sample"], table.iloc[0]
    return (
        f"some {first['particles']:.0f} particles of {CASE['particle_scale']:g} times the real size, four layers, in a"
        f" channel {bed['width_mm']} mm wide that is closed on itself; samples of {sample['width_mm']} mm by"
        f" {sample['length_mm']} mm, {first['travel_m']:g} m of travel at {VELOCITY:g} m/s per run,"
        f" {table['seed'].nunique()} packings"
    )


def draw(table: pd.DataFrame, path: Path) -> None:
    """Write the figure: changes against time step and against modulus."""
    found = answers(table)
    marks = {"studies": default_fraction(), f"source, {SOURCE_STEP:g} s at real size": source_fraction()}
    panels = [
        Panel("Time step over Rayleigh time (-), plain", found["rayleigh_fraction"], marks),
        Panel("Time step over Rayleigh time (-), convex", found[CONVEX], marks),
        Panel("Shear modulus of the particles (Pa)", found["shear_modulus_pa"], {"studies and source": MODULUS}),
    ]
    remarks = [
        f"reduced scale: {setting(table)}",
        "bars: 95 % intervals from the scatter of packings, of the ratio to the smallest time step and to the stiffest"
        f" particle; grey: up to {PERCENT * LIMIT:g} %",
        f"made by benchmarks/time_step_and_stiffness.py, {date.today():%Y-%m-%d}",
    ]
    save(deviation_figure(panels, "sliding work", LIMIT, remarks), path)


def page(table: pd.DataFrame) -> str:
    """Return the page of the answers (Markdown)."""
    found = answers(table)
    steps, convex, moduli = (found[name] for name in ("rayleigh_fraction", CONVEX, "shear_modulus_pa"))
    rolling, phrase = load_study(STUDY, overrides=CASE).settings["solver"]["rolling_friction"], setting(table)
    columns = "packings | sliding work (J/m) | change (%) | 95 % interval | verdict | processor time of a run (s) |"
    return "\n".join(
        [
            "# Time step and softness of the particles",
            "",
            prose(
                "Written by `python -m benchmarks.time_step_and_stiffness`, every run in"
                " [time_step_and_stiffness.csv](time_step_and_stiffness.csv)."
            ),
            "",
            *conclusions(steps, convex, moduli),
            "",
            "![Change of the sliding work with the time step and with the modulus](time_step_and_stiffness.png)",
            "",
            prose(
                f"{phrase[:1].upper()}{phrase[1:]}. Rolling friction is `{rolling}`. All runs of a packing start from"
                f" one bed, filled with {FRACTION:g} of the Rayleigh time and {MODULUS:.2g} Pa. What is compared is the"
                " sliding work on the sample, to which Archard's wear is proportional."
            ),
            "",
            *step_table("plain sample", steps, columns),
            *step_table("convex sample", convex, columns),
            f"| shear modulus (Pa) | time step (s) | {columns}",
            "|---|---|---|---|---|---|---|---|",
            *(f"| {row.value:.2g} | {row.time_step_s:.2g} | {cells(row)} |" for row in moduli.itertuples()),
            "",
        ]
    )


def step_table(name: str, steps: pd.DataFrame, columns: str) -> list[str]:
    """Return the lines of a table of time steps; name: of the sample."""
    return [
        f"| {name}: time step over Rayleigh time (-) | time step (s) | {columns}",
        "|---|---|---|---|---|---|---|---|",
        *(f"| {row.value:g} | {row.time_step_s:.2g} | {cells(row)} |" for row in steps.itertuples()),
        "",
    ]


def default_fraction() -> float:
    """Return the time step over the Rayleigh time (-) that sliding samples have unless a study says otherwise."""
    return float(load_study(STUDY).settings["solver"]["rayleigh_fraction"])


def conclusions(steps: pd.DataFrame, convex: pd.DataFrame, moduli: pd.DataFrame) -> list[str]:
    """Return how far each choice can go, and the defaults beside it."""
    scatter, limit = max(table["scatter"].max() for table in (steps, convex, moduli)), f"{PERCENT * LIMIT:g} %"
    default = default_fraction()
    step = steps.set_index("value")["time_step_s"][default]
    softened = PERCENT * moduli.set_index("value")["change"][MODULUS]
    off = "" if moduli["value"][0] == MODULUS else f", whose wear is {softened:+.1f} % off"
    return [
        prose(
            f"How far can each go before wear changes by {limit}? By chance alone a run is {PERCENT * scatter:.1f} %"
            " (standard deviation) off what its packing, its time step and its modulus let expect."
        ),
        "",
        bullet(
            f"Time step, plain sample: against {steps['value'][0]:g} of the Rayleigh time of the smallest particle,"
            f" wear is within {limit}, its 95 % interval included, up to {within(steps):g}; {beyond(steps)}. Default:"
            f" `solver.rayleigh_fraction: {default:g}`, here {step:.2g} s; the source's {SOURCE_STEP:g} s are"
            f" {source_fraction():.2g} of that time at its particle size."
        ),
        bullet(f"Time step, convex sample: within {limit} up to {within(convex):g}; {beyond(convex)}."),
        bullet(
            f"Shear modulus: against {moduli['value'][0]:.2g} Pa, wear is within {limit} down to"
            f" {within(moduli):.2g} Pa; {beyond(moduli)}. Default: {MODULUS:.2g} Pa, that of the source{off}."
        ),
    ]


def cells(row: NamedTuple) -> str:
    """Return what both tables of the page say of a value."""
    change, low, high = (f"{PERCENT * value:+.1f}" for value in (row.change, row.change_low, row.change_high))
    return f"{row.runs} | {row.mean:.4g} | {change} | {low} to {high} | {row.verdict} | {row.processor_s:.0f}"


def within(found: pd.DataFrame) -> float:
    """Return the value furthest from the first that is within the limit with all between them."""
    return float(found.loc[(found["verdict"] == WITHIN).cummin(), "value"].iloc[-1])


def beyond(found: pd.DataFrame) -> str:
    """Return in words from which value on the limit is passed, or a run failed."""
    passed = found[found["verdict"].isin([BEYOND, FAILED])]
    if passed.empty:
        return f"up to {found['value'].iloc[-1]:.3g} it is nowhere surely beyond that"
    return f"surely beyond that it is first at {passed['value'].iloc[0]:.3g} ({passed['verdict'].iloc[0]})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, default=Path("results/benchmarks/time_step_and_stiffness"))
    parser.add_argument("--output", type=Path, default=Path("docs"))
    parser.add_argument("--minutes", type=float, default=MINUTES, help="processor time of the solver at most")
    parser.add_argument("--packings", type=int, default=MOST_PACKINGS, help="at most")
    parser.add_argument("--redraw", action="store_true", help="from the table of an earlier run")
    given = parser.parse_args()
    file = given.output / "time_step_and_stiffness.csv"
    if not given.redraw:
        found = rows(given.folder, given.minutes, given.packings)
        pd.DataFrame(found).to_csv(file, index=False, float_format="%.6g")
    table = pd.read_csv(file)
    draw(table, file.with_suffix(".png"))
    file.with_suffix(".md").write_text(page(table))


if __name__ == "__main__":
    main()
