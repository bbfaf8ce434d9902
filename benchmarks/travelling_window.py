"""Wear and cost of a sample in a window that travels with it, against a bed of 2 m as the source ran it, with LIGGGHTS'
search for wall contacts and a bed of its own: sliding work per metre of travel, and the solver's processor time. Every
bed is filled several times; the scatter between packings is what the intervals rest on.

    python -m benchmarks.travelling_window --cores 2    # in the root of the repository
    python -m benchmarks.travelling_window --finished   # while it runs, or after it was stopped: of the runs so far
    python -m benchmarks.travelling_window --redraw

Runs stay in `--folder`, where a stopped one goes on; more `--packings` are added to those that are there. After each
packing it writes into docs: travelling_window.csv (every run), travelling_window_blocks.csv (along the travel), figure
and travelling_window_results.md; `--redraw` makes the last two from the first.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from datetime import date
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.command_line import at_least_one, command, output_folder, read_table
from benchmarks.plots.figures import wear_side_by_side
from benchmarks.ratios import ratio_intervals
from benchmarks.runs import BY, is_simulated, simulated_by, with_earlier
from benchmarks.window_case import (
    BEDS,
    BUMPS,
    ELEMENT_SIZE,
    FULL,
    OWN_SEARCH,
    SETTINGS,
    SOURCE_FRACTION,
    SURFACES,
    WHOLE,
    Case,
    chain_of,
    packing,
    said_beforehand,
    simulated,
)
from bulkwear.postproc.plots.style import save
from bulkwear.postproc.readers.cycle_folders import cycle_files, cycle_folders
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.accounting import HISTORY
from bulkwear.workflows.engine.chain import Chain
from bulkwear.workflows.engine.derived import WALLS
from bulkwear.workflows.engine.project import PACKAGE
from bulkwear.workflows.engine.solver import die_with
from bulkwear.workflows.forecast.forecast import forecast_table, work_of
from bulkwear.workflows.forecast.rates import DEFAULT, read_rates
from bulkwear.workflows.report.markdown_text import bullet, markdown, prose

PLACE = "travelling_window"  # of the runs, in the folder of simulations of all benchmarks
PACKINGS = 3
BLOCK = 0.1  # m of travel
LEVEL = 0.95  # of intervals
SOURCE_EXCHANGE = 20  # mm of travel, at the source's particles
LATE = {"ratio": "second_half_over_full", "ratio_low": "second_half_low", "ratio_high": "second_half_high"}
CHEAPER_COLUMNS = ["cheaper_in_particle_steps", "cheaper_in_processor_time", "cheaper_low", "cheaper_high"]
CHEAPER_COLUMNS += ["cheaper_with_its_run_in", "with_its_run_in_low", "with_its_run_in_high"]
CHEAPER = {"particle_steps": "particle_steps", "core_hours": "core_hours"}  # column -> what it is the cost in


# ---------------------------------------------------------------- what came out


def block_rows(case: Case, chain: Chain) -> list[dict[str, Any]]:
    """Return a row per block of the counted travel: sliding work (J) and mean normal force (N) on the sample.

    Looks at the wear end with blocks, but for a rounding of the last time step.
    """
    history = pd.concat(map(pd.read_csv, cycle_files(chain.folder, HISTORY)), ignore_index=True)
    stretch = history["travel_m"].diff().fillna(history["travel_m"].iloc[0])
    number = ((history["travel_m"] - 0.5 * stretch) // BLOCK).astype(int) + 1
    table = history.assign(block=number, stretch=stretch, impulse=history["mean_normal_force_N"] * stretch)
    sums = table.groupby("block")[["sliding_work_J", "stretch", "impulse"]].sum()
    names = {"surface": case.surface, "bed": case.bed, "seed": case.seed}
    return [
        {
            **names,
            "block": row.Index,
            "sliding_work_J": row.sliding_work_J / row.stretch * BLOCK,
            "normal_force_N": row.impulse / row.stretch,
        }
        for row in sums.itertuples()
    ]


def run_row(case: Case, chain: Chain) -> dict[str, Any]:
    """Return what a run found and what it cost.

    Sliding work per metre over the whole counted travel and over its second half, mean normal force; particles: mean
    over the cycles; processor_s: of the solver; bed_processor_s: of filling its bed
    """
    wear, travel = pd.read_csv(chain.folder / "wear.csv"), chain.parameters["sliding"]["travel_m"]
    records = [state.read_state(chain.folder, cycle)["cost"] for cycle in range(len(cycle_folders(chain.folder)))]
    bed = pd.read_csv(chain.bed_restart.with_name("cost.csv")).iloc[0]
    return {
        "surface": case.surface,
        "bed": case.bed,
        "seed": case.seed,
        "sliding_work_J_per_m": wear["sliding_work_J"].sum() / travel,
        "second_half_J_per_m": wear["sliding_work_J"].iloc[len(wear) // 2 :].sum() / (0.5 * travel),
        "normal_force_N": wear["mean_normal_force_N"].mean(),  # cycles are equally long
        "bed_length_m": chain.bed["length_m"],
        "settled_particles_per_m": bed["particles"] / chain.bed["length_m"],
        "time_step_s": chain.parameters["derived"]["time_step_s"],
        "triangles": records[-1]["triangles"],
        "particles": sum(record["particles"] for record in records) / len(records),
        "particle_steps": float(sum(record["particles"] * record["steps"] for record in records)),
        "processor_s": sum(record["processor_s"] for record in records),
        "bed_processor_s": bed["processor_s"],
        BY: simulated_by(chain.folder),
    }


def comparison(runs: pd.DataFrame) -> pd.DataFrame:
    """Return a row per surface and bed: sliding work per metre, and over the full bed's, with intervals; and the cost.

    runs: as from `run_row`. A packing is what is repeated; one scatter between packings is assumed for the beds of a
    surface (`ratio_intervals`). scatter: standard deviation of ln(work) between packings; second_half_...: the same
    ratio over the second half of the travel; force_over_full: mean normal force over the full bed's; cheaper_in_...:
    cost of the full bed over the bed's own, of particle-steps the ratio of means; processor time is that of the run and
    of its bed, which the plain twin shares but in the full bed, with cheaper_low and cheaper_high;
    cheaper_with_its_run_in, with_its_run_in_low, _high: per counted metre, the full bed with the source's run-in;
    second_half_over_whole: sliding work per metre, 1 where the wear is steady after the run-in
    """
    parts = []
    for surface, of in runs.groupby("surface", sort=False):
        found, late = over_full(of, "sliding_work_J_per_m"), over_full(of, "second_half_J_per_m")
        means = of.groupby("bed", sort=False).mean(numeric_only=True).reset_index(names="setting")
        means = means.drop(columns="seed")
        table = found.merge(late[["setting", *LATE]].rename(columns=LATE), on="setting").merge(means, on="setting")
        full = table[table["setting"] == FULL].iloc[0]
        cost = ratio_intervals(of["bed"].to_numpy(), cost_s(of).to_numpy(), FULL, LEVEL).set_index("setting")
        cost = cost.loc[table["setting"]].reset_index()
        over = {
            "force_over_full": table["normal_force_N"] / full["normal_force_N"],
            "cheaper_in_particle_steps": full["particle_steps"] / table["particle_steps"],
            "cheaper_in_processor_time": 1.0 / cost["ratio"],
            "cheaper_low": 1.0 / cost["ratio_high"],
            "cheaper_high": 1.0 / cost["ratio_low"],
            "cheaper_with_its_run_in": run_in_factor() / cost["ratio"],
            "with_its_run_in_low": run_in_factor() / cost["ratio_high"],
            "with_its_run_in_high": run_in_factor() / cost["ratio_low"],
            "second_half_over_whole": table["second_half_J_per_m"] / table["sliding_work_J_per_m"],
        }
        parts.append(table.drop(columns="sliding_work_J_per_m").assign(surface=surface, **over))
    names = {
        "setting": "bed",
        "mean": "sliding_work_J_per_m",
        "ratio": "wear_over_full",
    }
    return pd.concat(parts, ignore_index=True).rename(columns=names)


def over_full(of: pd.DataFrame, column: str) -> pd.DataFrame:
    """Return `ratio_intervals` of a column (J/m) over the full bed's, beds of one surface in their order.

    Where our search finds the stock search's values in every packing, it is no sample of its own: it adds nothing to
    the scatter, and its ratio of 1 has no interval.
    """
    values = of.pivot(index="seed", columns="bed", values=column)
    repeats = [OWN_SEARCH] if OWN_SEARCH in values and values[OWN_SEARCH].equals(values[FULL]) else []
    own = of[~of["bed"].isin(repeats)]
    found = ratio_intervals(own["bed"].to_numpy(), own[column].to_numpy(), FULL, LEVEL).set_index("setting")
    rows = pd.concat([found, *(found.loc[[FULL]].rename(index={FULL: bed}) for bed in repeats)])
    return rows.loc[of["bed"].unique()].reset_index(names="setting")


def run_in_factor() -> float:
    """Return how many times as far the source travels for a counted metre, of its run-in and travel and of these."""
    ours, source = SETTINGS["sliding"], load_study("screening", overrides={"fidelity": "paper"}).settings["sliding"]
    of_source, of_ours = (1.0 + each["run_in_mm"] / each["travel_mm"] for each in (source, ours))
    return of_source / of_ours


def cost_s(runs: pd.DataFrame) -> pd.Series:
    """Return the processor time (s) of each run with its share of the bed: a half, for the plain twin lies in the same;
    all of it in the full bed, as the source ran it."""
    return runs["processor_s"] + runs["bed_processor_s"] * np.where(runs["bed"] == FULL, 1.0, 0.5)


def at_source_size() -> pd.DataFrame:
    """Return what the source's screening costs in its bed and in the same windows, by the forecast's default rates,
    which are of our search for wall contacts: a bed with another one is left out.

    Length of the bed (m), forecast core hours of all runs, beds included, and how much cheaper than the source's bed
    particle-steps and core hours are. Width, thickness and sample are the same, so a bed's length times its steps
    stands for the particle-steps.
    """
    rates, rows = read_rates(PACKAGE / DEFAULT).rates, []
    for name, given in ((name, given) for name, given in BEDS.items() if "search" not in given):
        bed = {"ends": WALLS} if given["bed"] is WHOLE else given["bed"]
        overrides = {"bed": {**bed, "exchange_mm": SOURCE_EXCHANGE}, "solver": {"rayleigh_fraction": given["fraction"]}}
        study = load_study("screening", overrides={"fidelity": "paper", "packings": 1, **overrides})
        derived = study.runs[0].parameters["derived"]
        row = {
            "bed": name,
            "length_m": derived["bed_length_m"],
            "particle_steps": derived["bed_length_m"] * (derived["run_in_steps"] + derived["travel_steps"]),
            "core_hours": forecast_table(work_of(study), rates)["core_h"].sum(),
        }
        rows.append(row)
    table = pd.DataFrame(rows)
    cheaper = {f"cheaper_in_{to}": table[of].iloc[0] / table[of] for of, to in CHEAPER.items()}
    return table.assign(**cheaper).drop(columns="particle_steps")


# ---------------------------------------------------------------- page


def remarks(runs: pd.DataFrame) -> list[str]:
    """Return what must be known about the figure."""
    sample, bed, sliding = (SETTINGS[name] for name in ("sample", "bed", "sliding"))
    return [
        f"reduced scale: particles {SETTINGS['particle_scale']:g} times their size, sample {sample['width_mm']} x"
        f" {sample['length_mm']} mm of elements of {1e3 * ELEMENT_SIZE:g} mm, bed {bed['width_mm']} mm wide and 40 mm"
        " thick, 1 m/s; the sample keeps its shape; wear is proportional to the sliding work",
        f"{packings_of(runs)} packings per bed, {sliding['travel_mm']:g} mm of counted travel each after"
        f" {sliding['run_in_mm']:g} mm",
        "windows are named by the bed ahead of and behind the sample in mm; time steps are"
        f" {SOURCE_FRACTION:g} of the Rayleigh time, the source's, where nothing else is said",
        f"made by benchmarks/travelling_window.py, {date.today():%Y-%m-%d}",
    ]


def packings_of(runs: pd.DataFrame) -> str:
    """Return how many packings beds have, a range where not all have as many."""
    counts = runs.groupby(["surface", "bed"]).size()
    return f"{counts.min()} to {counts.max()}" if counts.min() < counts.max() else str(counts.max())


def results_page(table: pd.DataFrame, runs: pd.DataFrame) -> str:
    """Return the page of results; table: as from `comparison`, runs: what it was made from."""
    names, freedom = ["surface", "bed"], " and ".join(f"{number:g}" for number in table["freedom"].unique() if number)
    wear = ["packings", "sliding_work_J_per_m", "low", "high", "scatter", "wear_over_full", "ratio_low", "ratio_high"]
    cost = ["bed_length_m", "time_step_s", "triangles", "particles", "particle_steps", "processor_s", "bed_processor_s"]
    surfaces, minutes = list(dict.fromkeys(runs["surface"])), runs["processor_s"].sum() / 60.0
    planned = said_beforehand(surfaces, int(table["packings"].max()), SETTINGS)
    bumps = ", ".join(
        f"{name.removesuffix('_m').replace('_', ' ')} {1e3 * value:g} mm" for name, value in BUMPS.items()
    )
    digits = dict.fromkeys(table, 4)
    parts = [
        "# A travelling window against a full bed: results",
        prose(
            "Generated by `python -m benchmarks.travelling_window`; not to be edited. What a window is, is said in"
            " [travelling_window.md](travelling_window.md). Tables: [every run](travelling_window.csv),"
            " [blocks of travel](travelling_window_blocks.csv)."
        ),
        "\n".join(bullet(text) for text in remarks(runs)),
        "## Wear",
        prose(
            f"Low and high are {100 * LEVEL:g} % intervals by Student's t on {freedom or 0} degrees of freedom: what is"
            " repeated is the packing, runs of two beds are independent samples even where their seeds are equal, and"
            " the scatter between packings (standard deviation of the logarithm) is assumed to be one for all beds of a"
            " surface. Ratios are of geometric means. Runs that another search repeats to the last digit count once."
        ),
        markdown(table[[*names, *wear]], digits),
        prose(
            "A rate is steady where it no longer changes with the travel: the same ratio over the second half of the"
            " travel alone, and that half over the whole; the mean normal force on the sample over that in the full"
            " bed; and how many particles a metre of settled bed has."
        ),
        markdown(
            table[[*names, *LATE.values(), "second_half_over_whole", "force_over_full", "settled_particles_per_m"]],
            digits,
        ),
        "![Sliding work along the travel in a full bed and in windows](travelling_window.png)",
        "## Cost",
        prose(
            f"{planned}. They took {minutes:.0f} minutes of the solver's processor time. Elements are"
            f" {1e3 * ELEMENT_SIZE:g} mm, no more than half a particle, and the convex sample has bumps that such"
            f" elements resolve ({bumps}), because the triangles weigh more beside few particles than at the source's"
            " size. With one scatter for all beds, each needs as many packings for the same error: the ratios of cost"
            " are those at equal error. Cheaper in processor time: of a run with its bed, which its twin shares but in"
            " the bed that others are compared with, and the 95 % interval of that ratio; with its run-in: per counted"
            " metre, where that bed has the source's run-in and travel, likewise. Means over the packings:"
        ),
        markdown(table[[*names, *cost, *CHEAPER_COLUMNS]]),
        "## The source's bed",
        prose(
            "The same windows and time steps round the source's samples of 200 x 200 mm in particles of true size, all"
            f" runs of its screening, bed exchanged every {SOURCE_EXCHANGE} mm; forecast by the default rates, which"
            " are of our search for wall contacts, not simulated."
        ),
        markdown(at_source_size()),
    ]
    return "\n\n".join(part.rstrip("\n") for part in parts) + "\n"


def publish(output: Path, runs: pd.DataFrame, blocks: pd.DataFrame) -> str:
    """Write figure and page of the runs' tables; return the page."""
    table = comparison(runs)
    page = results_page(table, runs)
    (output / "travelling_window_results.md").write_text(page, encoding="utf-8")
    save(wear_side_by_side(blocks, table, BLOCK, remarks(runs)), output / "travelling_window.png")
    return page


def simulate_all(
    surfaces: Sequence[str],
    packings: int,
    folder: Path,
    cores: int,
    each: Callable[[pd.DataFrame, pd.DataFrame], object],
) -> None:
    """Simulate packing by packing, as many runs side by side as there are cores; give all runs and blocks so far."""
    done: list[tuple[Case, Chain]] = []
    with ProcessPoolExecutor(cores, initializer=die_with(os.getpid())) as pool:
        for number in range(packings):
            cases = packing(surfaces, number)
            chains = pool.map(partial(simulated, folder=folder, settings=SETTINGS), cases)
            done += zip(cases, chains, strict=True)
            each(*tables_of(done))


def finished(surfaces: Sequence[str], packings: int, folder: Path) -> list[tuple[Case, Chain]]:
    """Return the runs of a folder that are finished; nothing is simulated."""
    cases = [case for number in range(packings) for case in packing(surfaces, number)]
    chains = [(case, chain_of(case, folder, SETTINGS)) for case in cases]
    return [(case, chain) for case, chain in chains if is_simulated(chain)]


def tables_of(done: Sequence[tuple[Case, Chain]]) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the rows of runs, and of their blocks of travel."""
    blocks = [row for case, chain in done for row in block_rows(case, chain)]
    return pd.DataFrame([run_row(case, chain) for case, chain in done]), pd.DataFrame(blocks)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=output_folder, default="docs")
    parser.add_argument("--surface", choices=SURFACES, help="only this one; else both")
    parser.add_argument(
        "--packings", type=at_least_one, default=PACKINGS, help=f"of each bed, {PACKINGS} if it is not given"
    )
    parser.add_argument("--folder", type=Path, default=Path("results/benchmarks/full") / PLACE)
    parser.add_argument("--cores", type=at_least_one, default=1, help="runs side by side")
    parser.add_argument("--finished", action="store_true", help="simulate nothing, take the runs that are finished")
    parser.add_argument("--redraw", action="store_true", help="from the tables of an earlier run")
    given = parser.parse_args()
    files = [given.output / f"travelling_window{part}.csv" for part in ("", "_blocks")]
    keys = ["surface", "bed", "seed"]

    def write(runs: pd.DataFrame, blocks: pd.DataFrame) -> None:
        for file, table, key in zip(files, (runs, blocks), (keys, [*keys, "block"]), strict=True):
            with_earlier(file, table, key).to_csv(file, index=False, float_format="%.6g")
        print(publish(given.output, *(read_table(file, keys) for file in files)), flush=True)

    if given.redraw:
        print(publish(given.output, *(read_table(file, keys) for file in files)))
        return
    surfaces = (given.surface,) if given.surface else SURFACES
    if given.finished:
        if not (done := finished(surfaces, given.packings, given.folder)):
            parser.error(f"{given.folder}: no run is finished; without --finished they are simulated.")
        write(*tables_of(done))
        return
    print(said_beforehand(surfaces, given.packings, SETTINGS), flush=True)
    simulate_all(surfaces, given.packings, given.folder, given.cores, write)


if __name__ == "__main__":
    command(main)
