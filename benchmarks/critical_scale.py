"""Why does a convex sample in coarse particles wear less here than in the source? A row of the study `particle_size`,
convex and plain, as it is and with one thing changed at a time: what the source leaves open, what the simulation
chooses, and, for their size, some things that are published.

    python -m benchmarks.critical_scale --cores 2    # in the root of the repository
    python -m benchmarks.critical_scale --finished   # while it runs, or after it was stopped: of the runs so far
    python -m benchmarks.critical_scale --redraw

Runs stay in `--folder`, where a stopped one goes on; more packings, scales and candidates are added to those that are
there, and to those of the table that an earlier version of the code simulated. Writes into docs: critical_scale.csv
(every run), figure and critical_scale_results.md; `--redraw` makes the last two from the first.
"""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from datetime import date
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd

from benchmarks.command_line import at_least_one, command, output_folder, read_table
from benchmarks.plots.critical_scale import ratio_by_candidate, ratio_by_scale
from benchmarks.ratios import ASSUMED, ratio_intervals, scatter_of_groups
from benchmarks.runs import (
    BY,
    attempted,
    failure_file,
    is_simulated,
    simulated_by,
    simulated_run,
    with_bed,
    with_earlier,
)
from benchmarks.scale_case import CANDIDATES, REFERENCE, SETTINGS, Case, cases, chain_of, particle_steps
from benchmarks.scale_page import CURVES, FIGURE, results_page, source_ratio
from benchmarks.window_case import PARTICLE_STEPS_PER_SECOND
from bulkwear.postproc.plots.style import save
from bulkwear.postproc.statistics.crossing import FEWEST_PLACES, Crossing, crossing
from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.postproc.tables.summary import run_summary
from bulkwear.workflows.cases.sliding_sample.flow_history import (
    RunFlow,
    along_travel,
    run_bins,
    settled_value,
    undisturbed_particles,
)
from bulkwear.workflows.cases.sliding_sample.parameters import flow_measures
from bulkwear.workflows.engine.chain import Chain
from bulkwear.workflows.engine.solver import die_with
from bulkwear.workflows.engine.state import StateError

SCALES, PACKINGS, OF_REFERENCE = (6,), 1, 3
LEVEL = 0.95  # of intervals
MM3 = 1e9  # mm3 in a m3
KEYS = ["particle_scale", "candidate", "surface", "seed"]  # of a row in the table of every run
PERCENT = 100.0


# ---------------------------------------------------------------- runs


def filled(chain: Chain) -> None:
    """Fill the bed of a run unless it is there."""
    kept(chain, lambda: with_bed(chain, chain.name))


def simulated(chain: Chain) -> None:
    """Simulate a run from where it stopped, unless it is finished or failed before."""
    kept(chain, lambda: simulated_run(chain, chain.name))


def kept(chain: Chain, task: Callable[[], object]) -> None:
    """Do the task, or say and keep why it failed: one candidate that cannot be simulated stops no other."""
    chain.folder.mkdir(exist_ok=True)
    failed = failure_file(chain)
    attempted(task, failed, (StateError, ValueError))
    if failed.exists():
        print(f"{chain.name} failed: {failed.read_text(encoding='utf-8')}", flush=True)


def simulate_all(chains: Sequence[Chain], cores: int, each: Callable[[], object]) -> None:
    """Fill all beds, then simulate all runs, as many side by side as there are cores; call `each` after every run."""
    beds, runs = ({getattr(chain, name): chain for chain in chains} for name in ("bed_restart", "folder"))
    with ProcessPoolExecutor(cores, initializer=die_with(os.getpid())) as pool:
        list(pool.map(filled, beds.values()))
        for _ in pool.map(simulated, runs.values()):
            each()


def said_beforehand(chains: Sequence[Chain]) -> str:
    """Return in a phrase how much there is to simulate, and about how long a core takes for it."""
    runs = {chain.folder: chain for chain in chains}
    steps = sum(map(particle_steps, runs.values()))
    minutes = steps / PARTICLE_STEPS_PER_SECOND / 60.0
    return f"{len(runs)} runs: {steps:.2g} particle-steps, some {minutes:.0f} minutes of a core without triangles"


# ---------------------------------------------------------------- what came out


def run_row(case: Case, chain: Chain) -> dict[str, Any]:
    """Return what a finished run found.

    Wear per metre of counted travel (mm3/m), whole and of the bumps; mean normal force (N); slip_percent: sliding work
    per metre over that force, the mean velocity of contacts over the sample's; velocity_percent: of the bed over the
    sample, likewise (Yan 2022, Eq 4.10); processor_s: of the solver; simulated_by: version of the code
    """
    found, cost = run_summary(pd.read_csv(chain.folder / "wear.csv")), pd.read_csv(chain.folder / "cost.csv")
    flow, travel = RunFlow(**flow_measures(chain.parameters)), found["travel_m"]
    along = along_travel(run_bins(chain.folder, flow), flow, undisturbed_particles(chain.folder))
    force = found["mean_normal_force_N"]
    return {
        "particle_scale": case.scale,
        "candidate": case.candidate,
        "surface": case.surface,
        "seed": case.seed,
        "wear_mm3_per_m": MM3 * found["worn_volume_m3"] / travel,
        "bumps_mm3_per_m": MM3 * found["pattern_worn_volume_m3"] / travel,
        "normal_force_N": force,
        "slip_percent": PERCENT * found["sliding_work_J"] / travel / force,
        "velocity_percent": PERCENT * settled_value(along["travel_m"], along["relative_velocity"])[0],
        "layers": chain.parameters["derived"]["layers"],
        "particles": int(cost["particles"].iloc[-1]),
        "triangles": int(cost["triangles"].iloc[-1]),
        "processor_s": cost["processor_s"].sum(),
        BY: simulated_by(chain.folder),
    }


def finished(wanted: Sequence[Case], folder: Path) -> pd.DataFrame:
    """Return the rows of those runs that are finished; nothing is simulated."""
    chains = [(case, chain_of(case, folder, SETTINGS)) for case in wanted]
    return pd.DataFrame([run_row(case, chain) for case, chain in chains if is_simulated(chain)])


def comparison(runs: pd.DataFrame) -> pd.DataFrame:
    """Return a row per particle scale and candidate: wear, convex over plain, its interval, and over the reference's.

    runs: as from `run_row`; those of candidates that there are no more are left out. A packing is what is repeated,
    convex and plain sample together; one scatter is assumed for all candidates and scales (`ratio_intervals`), and one
    packing has no interval. Columns in the order of the page.
    """
    runs = runs[runs["candidate"].isin(CANDIDATES)]
    pairs = pd.merge(
        *(runs[runs["surface"] == name].drop(columns="surface") for name in ("convex", "plain")),
        on=["particle_scale", "candidate", "seed"],
        suffixes=("_convex", "_plain"),
    )
    plain = pairs["wear_mm3_per_m_plain"]
    pairs["wear_over_plain"] = pairs["wear_mm3_per_m_convex"] / plain
    pairs["bumps_over_plain"] = pairs["bumps_mm3_per_m_convex"] / plain
    pairs["base_over_plain"] = pairs["wear_over_plain"] - pairs["bumps_over_plain"]
    pairs["share_of_bumps_percent"] = PERCENT * pairs["bumps_over_plain"] / pairs["wear_over_plain"]
    pairs["force_over_plain"] = pairs["normal_force_N_convex"] / pairs["normal_force_N_plain"]
    pairs["processor_s"] = pairs["processor_s_convex"] + pairs["processor_s_plain"]
    kept = [
        "processor_s",
        *("wear_mm3_per_m_convex", "wear_mm3_per_m_plain", "base_over_plain", "bumps_over_plain"),
        *("share_of_bumps_percent", "force_over_plain", "slip_percent_convex", "slip_percent_plain"),
        *("velocity_percent_convex", "velocity_percent_plain"),
    ]
    told = ratio_intervals(pairs["candidate"], pairs["wear_over_plain"], REFERENCE, LEVEL, pairs["particle_scale"])
    names = {"ratio": "over_reference", "ratio_low": "over_reference_low", "ratio_high": "over_reference_high"}
    ends = {"mean": "wear_over_plain", "low": "ratio_low", "high": "ratio_high"}
    told = told.rename(columns=names | ends | {"group": "particle_scale", "setting": "candidate"})
    scatter = scatter_of_groups(pairs["candidate"], pairs["wear_over_plain"], pairs["particle_scale"])
    told = told.join(scatter.add_suffix("_of_scale"), on="particle_scale")
    means = pairs.groupby(["particle_scale", "candidate"], sort=False)[kept].mean().reset_index()
    of_reference = means[means["candidate"] == REFERENCE].set_index("particle_scale")["processor_s"]
    means["processor_over_reference"] = means["processor_s"] / means["particle_scale"].map(of_reference)
    table = told.merge(means, on=["particle_scale", "candidate"])
    kinds = table["candidate"].map({name: candidate.kind for name, candidate in CANDIDATES.items()})
    place = table["candidate"].map({name: number for number, name in enumerate(CANDIDATES)})
    return table.assign(kind=kinds, place=place).sort_values(["particle_scale", "place"], ignore_index=True)


def critical_scales(runs: pd.DataFrame, table: pd.DataFrame) -> pd.DataFrame:
    """Return by candidate where its ratio passes one: critical_scale, its interval over forms, of which scales and how
    many packings, and in words what an end beyond the scales means. Candidates of fewer than three scales are left out.

    runs: as from `run_row`; table: as from `comparison`. See `postproc.statistics.crossing`.
    """
    pairs = runs.pivot(
        index=["candidate", "particle_scale", "seed"], columns="surface", values="wear_mm3_per_m"
    ).dropna()
    over, rows = (pairs["convex"] / pairs["plain"]).rename("ratio").reset_index(), []
    for candidate in [name for name in CANDIDATES if name in set(over["candidate"])]:
        of = over[over["candidate"] == candidate]
        scales = sorted(of["particle_scale"].unique())
        if len(scales) < FEWEST_PLACES:
            continue
        found = crossing(of["particle_scale"].to_numpy(), of["ratio"].to_numpy())
        ends = {"interval_low": found.low, "interval_high": found.high}
        said = where_it_lies(found, table[table["candidate"] == candidate])
        rows.append(
            {"candidate": candidate, "scales": ", ".join(f"{scale:g}" for scale in scales), "packings": packings_of(of)}
            | {"critical_scale": found.value, **ends, "forms": found.forms, "where": said}
        )
    return pd.DataFrame(rows)


def packings_of(pairs: pd.DataFrame) -> str:
    """Return how many packings the scales of a candidate have, least and most."""
    counts = pairs.groupby("particle_scale")["seed"].nunique()
    return f"{counts.min()}" if counts.min() == counts.max() else f"{counts.min()} to {counts.max()}"


def where_it_lies(found: Crossing, rows: pd.DataFrame) -> str:
    """Return in words where a ratio passes one; rows: of `comparison`, of one candidate, a scale each.

    Where forms leave an end open, a scale whose own interval tells a side closes it.
    """
    if not math.isnan(found.low):
        of = rows["particle_scale"]
        less, more = of[rows["ratio_high"] < 1.0].max(), of[rows["ratio_low"] > 1.0].min()
        below = f"below {of.min():g}" if math.isnan(less) else f"{less:g}"
        beyond = f"beyond {of.max():g}" if math.isnan(more) else f"{more:g}"
        low = f"{found.low:.3g}" if math.isfinite(found.low) else below
        high = f"{found.high:.3g}" if math.isfinite(found.high) else beyond
        return f"{low} to {high}"
    known, single = rows[rows["ratio_low"].notna()], rows[rows["ratio_low"].isna()]
    told = known["particle_scale"]
    by_one = "".join(
        f"; in one packing at {row.particle_scale:g} it wears {'more' if row.wear_over_plain > 1.0 else 'less'}"
        for row in single.itertuples()
    )
    if len(known) and (known["ratio_high"] < 1.0).all():
        return f"above {told.max():g}, if anywhere: the convex sample wears less from {told.min():g} on{by_one}"
    if len(known) and (known["ratio_low"] > 1.0).all():
        return f"below {told.min():g}, if anywhere: the convex sample wears more up to {told.max():g}{by_one}"
    if not found.forms and found.below < found.above:
        return f"between {found.below:g} and {found.above:g}, each by its own packings; {found.reason}"
    return f"not told: {found.reason}"


# ---------------------------------------------------------------- page


def remarks(runs: pd.DataFrame, table: pd.DataFrame) -> list[str]:
    """Return what must be known about the figure."""
    packings = table.set_index("candidate")["packings"]
    others = packings.drop(REFERENCE)
    return [
        "runs of the study particle_size at quick fidelity with the source's pair of frictions, changed as each is"
        " named: particles at scale"
        f" {', '.join(f'{scale:g}' for scale in runs['particle_scale'].unique())}, wear over 800 mm of travel after"
        " 500 mm",
        "green line: the source's lines, whose reading of the pattern and whose code are not known",
        f"at most {packings[REFERENCE].max()} packings of {REFERENCE}, {others.max() if len(others) else 0} of the"
        " others;"
        + (
            f" bars: {PERCENT * LEVEL:g} % intervals, {ASSUMED} candidates and scales; without a bar: {UNKNOWN}"
            if table["ratio_low"].notna().any()
            else f" {UNKNOWN}"
        ),
        f"made by benchmarks/critical_scale.py, {date.today():%Y-%m-%d}",
    ]


def publish(output: Path, runs: pd.DataFrame) -> str:
    """Write figure and page of the runs; return the page."""
    table = comparison(runs)
    page = results_page(table, critical_scales(runs, table), runs)
    (output / "critical_scale_results.md").write_text(page, encoding="utf-8")
    source = {scale: source_ratio(scale) for scale in table["particle_scale"]}
    save(ratio_by_candidate(table, source, remarks(runs, table)), output / FIGURE)
    if (table.groupby("candidate").size() >= FEWEST_PLACES).any():
        save(ratio_by_scale(table, source, remarks(runs, table)), output / CURVES)
    return page


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=output_folder, default="docs")
    parser.add_argument("--scales", type=int, nargs="+", default=SCALES, help="particle scales, rows S1 to S8")
    parser.add_argument("--candidates", nargs="+", choices=CANDIDATES, default=list(CANDIDATES), metavar="NAME")
    parser.add_argument("--packings", type=at_least_one, default=PACKINGS, help=f"of each candidate, else {PACKINGS}")
    parser.add_argument("--reference-packings", type=at_least_one, default=OF_REFERENCE, help=f"else {OF_REFERENCE}")
    parser.add_argument("--folder", type=Path, default=Path("results/benchmarks/full/critical_scale"))
    parser.add_argument("--cores", type=at_least_one, default=1, help="runs side by side")
    parser.add_argument("--finished", action="store_true", help="simulate nothing, take the runs that are finished")
    parser.add_argument("--redraw", action="store_true", help="from the table of an earlier run")
    given = parser.parse_args()
    file = given.output / "critical_scale.csv"
    if not given.redraw:
        of_reference = max(given.packings, given.reference_packings)
        wanted = cases(given.scales, given.candidates, given.packings, of_reference)
        if alone := without_reference(wanted, file):
            parser.error(
                f"--candidates: at scale {', '.join(f'{scale:g}' for scale in alone)} nothing is compared with"
                f" {REFERENCE!r}, allowed is with it, or where {file} has it"
            )
        if not given.finished:
            chains = [chain_of(case, given.folder, SETTINGS) for case in wanted]
            print(said_beforehand(chains), flush=True)
            simulate_all(chains, given.cores, partial(write_table, file, wanted, given.folder))
        write_table(file, wanted, given.folder)
        if not file.is_file():
            parser.error(f"{given.folder}: no run is finished; without --finished they are simulated.")
    print(publish(given.output, read_table(file, KEYS)), flush=True)


def without_reference(wanted: Sequence[Case], file: Path) -> list[float]:
    """Return the scales of runs for which neither these nor the table of earlier ones has the reference."""
    there: set[float] = set()
    if file.is_file():
        known = read_table(file, KEYS)
        there = set(known.loc[known["candidate"] == REFERENCE, "particle_scale"])
    there |= {case.scale for case in wanted if case.candidate == REFERENCE}
    return sorted({case.scale for case in wanted} - there)


def write_table(file: Path, wanted: Sequence[Case], folder: Path) -> None:
    """Write the rows of the runs that are finished, beside those of earlier runs that are not among them, if any."""
    found = finished(wanted, folder)
    if len(found):
        ordered(with_earlier(file, found, KEYS)).to_csv(file, index=False, float_format="%.6g")


def ordered(table: pd.DataFrame) -> pd.DataFrame:
    """Return a table of runs by scale, packing and candidate; one whose name is no candidate's any more stands last."""
    place = table["candidate"].map({name: number for number, name in enumerate(CANDIDATES)}).fillna(len(CANDIDATES))
    order = ["particle_scale", "seed", "place", "surface"]
    return table.assign(place=place).sort_values(order, ignore_index=True).drop(columns="place")


if __name__ == "__main__":
    command(main)
