"""How far softness of particles can go before wear changes by 2 %: a small bed slides round a channel, over a plain
sample and over a convex one, whose front ends particles strike.

    python -m benchmarks.stiffness             # in the root of the repository
    python -m benchmarks.stiffness --redraw

Every packing (a seed) slides over both samples once with each modulus, all with the same share of the Rayleigh time
(how long that may be: `benchmarks.time_step_limits`). Packings are done one after another until `--minutes` of
processor time are spent; started again it goes on where it was. Writes stiffness.csv (every run), .png and .md into
docs; `--redraw` makes the last two from the first.
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
from benchmarks.command_line import at_least_one, command, output_folder, read_table
from benchmarks.plots.figures import Panel, deviation_figure
from benchmarks.runs import (
    FIRST_SEED,
    PUBLISHED_PAIR,
    SMALL_BUMPS,
    attempted,
    changed,
    failure_file,
    is_simulated,
    shared_chain,
    simulated_run,
)
from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.plots.style import save
from bulkwear.workflows.config.design import Run, load_study
from bulkwear.workflows.config.packings import SEED_SPACING
from bulkwear.workflows.engine.chain import Chain
from bulkwear.workflows.report.markdown_text import bullet, prose

STUDY, ROW = "demo", "R9"
CONVEX = "convex"
BED_THICKNESS = 0.022  # m: four layers, because only the lowest wear the sample
ELEMENT_SIZE = 0.005  # m, of the plain sample, coarser than studies allow: the sum over the sample is all that counts
VELOCITY = 2.0  # m/s, the fastest of the study `screening`
FRACTION = 0.2  # -, time step over the Rayleigh time of the smallest particle, of beds and runs
MODULUS = 7.0e7  # Pa, of filling the beds
MINUTES = 60.0  # of processor time
MOST_PACKINGS = 12
PERCENT = 100.0
FORMS = ("{:.4g}", "{:+.1f}", "{:.0f}")  # of sliding work, change and processor time
LIMIT = 0.02  # -, change of wear that matters
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
    "solver": {"rolling_friction": "own_spin", "picture_interval_mm": 100, "wear_interval_mm": 50},
}
MODULI = (7.0e6, 2.0e7, MODULUS, 2.8e8)  # Pa; LIGGGHTS takes no Young's modulus below 5 MPa
SURFACES = (PLAIN, CONVEX)


@dataclass(frozen=True)
class Variant:
    """A way to simulate a packing: shear modulus of the particles (Pa), seed of the packing, the sample's surface."""

    modulus: float
    seed: int
    surface: str

    @property
    def folder(self) -> str:
        """Name of its folder."""
        return f"seed_{self.seed}/{self.surface}_modulus_{self.modulus:g}"


def variants(seed: int) -> list[Variant]:
    """Return all variants of a packing, cheap ones first."""
    return [Variant(modulus, seed, surface) for modulus in sorted(MODULI) for surface in SURFACES]


def with_derived(run: Run, modulus: float, seed: int) -> Run:
    """Return the run with that shear modulus and packing, whatever the configuration allows."""
    change = {
        "bed": {"thickness_m": BED_THICKNESS, "seed": seed},
        **({"sample": {"element_size_m": ELEMENT_SIZE}} if run.surface == PLAIN else {}),
        "particle": {"shear_modulus_pa": modulus},
        "sliding": {"velocity_m_per_s": VELOCITY},
        "solver": {"rayleigh_fraction": FRACTION},
    }
    return changed(run, change)


def chain_of(variant: Variant, folder: Path) -> Chain:
    """Return the chain of a variant; nothing is made but its folder.

    All variants of a packing start from the bed that was filled with one modulus: the same particles.
    """
    study = load_study(STUDY, overrides=CASE)
    run = with_derived(study.run(f"{ROW}_{variant.surface}"), variant.modulus, variant.seed)
    at_rest = [with_derived(study.run(f"{ROW}_{each}"), MODULUS, variant.seed) for each in SURFACES]
    (bed,) = study.case.beds(at_rest)[0].values()  # settled above the bumps
    return shared_chain(variant.folder, folder, study.case, run, bed)


def row_of(variant: Variant, folder: Path) -> dict[str, float]:
    """Return what a variant found, simulated unless that was done before; NaN where the solver failed."""
    chain = chain_of(variant, folder)
    failed = failure_file(chain)
    attempted(lambda: simulated_run(chain, "bed"), failed)
    derived = chain.parameters["derived"]
    row = {
        "seed": variant.seed,
        "surface": variant.surface,
        "shear_modulus_pa": variant.modulus,
        "time_step_s": derived["time_step_s"],
        "particles": pd.read_csv(chain.bed_restart.with_name("cost.csv"))["particles"].iloc[0],
        "travel_m": chain.parameters["sliding"]["travel_m"],
    }
    if failed.exists():
        return row
    wear, cost = (pd.read_csv(chain.folder / name) for name in ("wear.csv", "cost.csv"))
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
            if spent > 60.0 * minutes and not is_simulated(chain_of(variant, folder)):
                return
            row = row_of(variant, folder)
            spent += row.get("processor_s", 0.0)
            yield row


def answers(table: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Return by surface what moduli change, the stiffest particle first, which the others are compared with; wear per
    metre in J, times in s.
    """
    found = {}
    for surface, runs in table.groupby("surface", sort=False):
        wear = runs["sliding_work_J"] / runs["travel_m"]
        stiffest = runs.loc[wear.notna(), "shear_modulus_pa"].max()
        told = changes(runs["shear_modulus_pa"], wear, runs["seed"], stiffest, LIMIT)
        means = runs.groupby("shear_modulus_pa")[["time_step_s", "processor_s"]].mean().reset_index(names="value")
        found[str(surface)] = told.merge(means, on="value").sort_values("value", ascending=False, ignore_index=True)
    return found


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
    """Write the figure: changes against the modulus."""
    panels = [
        Panel(f"Shear modulus of the particles (Pa), {surface}", found, {"studies and source": MODULUS})
        for surface, found in answers(table).items()
    ]
    remarks = [
        f"reduced scale: {setting(table)}",
        "bars: 95 % intervals from the scatter of packings, of the ratio to the stiffest particle;"
        f" grey: up to {PERCENT * LIMIT:g} %",
        f"made by benchmarks/stiffness.py, {date.today():%Y-%m-%d}",
    ]
    save(deviation_figure(panels, "sliding work", LIMIT, remarks), path)


def page(table: pd.DataFrame) -> str:
    """Return the page of the answers (Markdown)."""
    found, phrase = answers(table), setting(table)
    rolling = load_study(STUDY, overrides=CASE).settings["solver"]["rolling_friction"]
    scatter = {surface: PERCENT * each["scatter"].max() for surface, each in found.items()}
    told = ", ".join(f"{surface} {value:.1f} %" for surface, value in scatter.items() if not math.isnan(value))
    chance = f"{told} (standard deviation)" if told else "unknown, of one packing"
    lines = [
        "# Softness of the particles",
        "",
        prose(
            "Written by `python -m benchmarks.stiffness`, every run in [stiffness.csv](stiffness.csv). How long a time"
            " step may be: [by rolling model](time_step_limits_results.md)."
        ),
        "",
        prose(
            f"How soft may particles be before wear changes by {PERCENT * LIMIT:g} %? What a run is off by chance alone"
            f" from what its packing and its modulus let expect: {chance}."
        ),
        "",
        *(conclusion(surface, moduli) for surface, moduli in found.items()),
        "",
        "![Change of the sliding work with the modulus](stiffness.png)",
        "",
        prose(
            f"{phrase[:1].upper()}{phrase[1:]}. Rolling friction is `{rolling}`, the time step {FRACTION:g} of the"
            f" Rayleigh time. All runs of a packing start from one bed, filled with {MODULUS:.2g} Pa. What is compared"
            " is the sliding work on the sample, to which Archard's wear is proportional."
        ),
        "",
    ]
    columns = "packings | sliding work (J/m) | change (%) | 95 % interval | verdict | processor time of a run (s) |"
    for surface, moduli in found.items():
        lines += [f"| {surface}: shear modulus (Pa) | time step (s) | {columns}", "|---|---|---|---|---|---|---|---|"]
        lines += [f"| {row.value:.2g} | {row.time_step_s:.2g} | {cells(row)} |" for row in moduli.itertuples()]
        lines.append("")
    return "\n".join(lines)


def conclusion(surface: str, moduli: pd.DataFrame) -> str:
    """Return how soft particles can be under a sample, and what the studies' modulus changes there."""
    reached = within(moduli)
    sure = (
        f"within {PERCENT * LIMIT:g} % down to {reached:.2g} Pa" if reached < moduli["value"][0] else "not shown of any"
    )
    said = f"{surface.capitalize()} sample, against {moduli['value'][0]:.2g} Pa: {sure}; {beyond(moduli)}."
    for used in moduli[moduli["value"] == MODULUS].itertuples():  # none where time was spent before
        low, high = PERCENT * used.change_low, PERCENT * used.change_high
        interval = "one packing" if math.isnan(low) else f"95 %: {low:+.1f} to {high:+.1f}"
        said += f" Studies and source, {MODULUS:.2g} Pa: {PERCENT * used.change:+.1f} % ({interval})."
    return bullet(said)


def cells(row: NamedTuple) -> str:
    """Return what the tables of the page say of a modulus."""
    numbers = (row.mean, PERCENT * row.change, row.processor_s)
    mean, change, seconds = (
        "-" if math.isnan(value) else form.format(value) for value, form in zip(numbers, FORMS, strict=True)
    )
    interval = f"{PERCENT * row.change_low:+.1f} to {PERCENT * row.change_high:+.1f}"
    interval = "unknown" if math.isnan(row.change_low) else interval
    return f"{row.runs} | {mean} | {change} | {interval} | {row.verdict} | {seconds}"


def within(found: pd.DataFrame) -> float:
    """Return the value furthest from the first that is within the limit with all between them; NaN where the first
    failed.
    """
    reached = found.loc[(found["verdict"] == WITHIN).cummin(), "value"]
    return float(reached.iloc[-1]) if len(reached) else math.nan


def beyond(found: pd.DataFrame) -> str:
    """Return in words from which value on the limit is passed, or a run failed."""
    passed = found[found["verdict"].isin([BEYOND, FAILED])]
    if passed.empty:
        return f"down to {found['value'].iloc[-1]:.3g} it is nowhere surely beyond that"
    return f"surely beyond that it is first at {passed['value'].iloc[0]:.3g} ({passed['verdict'].iloc[0]})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, default=Path("results/benchmarks/stiffness"))
    parser.add_argument("--output", type=output_folder, default="docs")
    parser.add_argument("--minutes", type=float, default=MINUTES, help="processor time of the solver at most")
    parser.add_argument("--packings", type=at_least_one, default=MOST_PACKINGS, help="at most")
    parser.add_argument("--redraw", action="store_true", help="from the table of an earlier run")
    given = parser.parse_args()
    file = given.output / "stiffness.csv"
    if not given.redraw:
        found = rows(given.folder, given.minutes, given.packings)
        pd.DataFrame(found).to_csv(file, index=False, float_format="%.6g")
    table = read_table(file)
    draw(table, file.with_suffix(".png"))
    file.with_suffix(".md").write_text(page(table))


if __name__ == "__main__":
    command(main)
